//! Joins a driver to the core's loop and to the robot's connection. This file has the channels, the timers, the
//! reconnecting, and the threads that make drawings and write the small file. The driver decides what is sent to the
//! robot.

use std::io;
use std::pin::Pin;
use std::time::Duration;

use tokio::task::JoinHandle;
use tokio::time::Instant;

use super::drawing;
use super::memory_file::MemoryFile;
use super::wire::{Address, Wire};
use crate::robots::waits::{done, done_for, hand_over};
use crate::runtime::clock::Clock;
use crate::runtime::link::{RobotSide, Stamped};
use hallsweep_core::event::{Photo, RobotEvent};
use hallsweep_core::robot::RobotId;
use hallsweep_core::units::OrderId;
use hallsweep_drivers::{Driver, Output};

/// Pause before a new connection is made. It grows when connections end right after they are made.
const AGAIN: Duration = Duration::from_millis(500);

/// A connection that lasts less than this time counts as ended right after it was made.
const BRIEF: Duration = Duration::from_secs(2);

/// A failed write of the file is retried after this time, or earlier if there is something new to write.
const WRITTEN_AGAIN: Duration = Duration::from_secs(1);

/// The pause doubles at most this number of times, up to eight seconds.
const DOUBLED: u32 = 4;

/// Number of brief connections after which the error asks whether another program uses the robot.
const OFTEN: u32 = 3;

/// Maximum length of a timer. When it ends, the link checks its state again.
const LONGEST_WAIT: Duration = Duration::from_secs(3600);

/// Runs an external robot until the core's loop has dropped its end of the channels. If there is a file, it stores
/// everything that the next program must know. A change is written to the file before anything that follows from the
/// change is sent to the robot or to the core.
pub(super) async fn run(
    robot: RobotId,
    driver: Box<dyn Driver>,
    address: Address,
    side: RobotSide,
    clock: Clock,
    file: Option<MemoryFile>,
) {
    let connection = Connection::Calling(address.call());
    let link = ExternalLink {
        robot,
        driver,
        is_up: false,
        address,
        side,
        clock,
        connection,
        connected: Duration::ZERO,
        brief: 0,
        report: None,
        drawing: None,
        obeyed: 0,
        is_led_told: false,
        file,
        writing: None,
        write_again: None,
    };
    link.run().await;
}

struct ExternalLink {
    robot: RobotId,
    driver: Box<dyn Driver>,
    /// Whether the log says that the link is up. The driver may report this several times, and only the first report
    /// is logged.
    is_up: bool,
    address: Address,
    side: RobotSide,
    clock: Clock,
    connection: Connection,
    /// When the last connection was made. `brief` is the number of brief connections in a row.
    connected: Duration,
    brief: u32,
    /// A report that the core's loop has not taken yet. While it waits, no orders and no input are received, so that
    /// reports cannot pile up.
    report: Option<RobotEvent>,
    drawing: Option<(OrderId, JoinHandle<Photo>)>,
    /// Number of halts that the core knew of when it sent the latest order that this link began.
    obeyed: u64,
    is_led_told: bool,
    /// The file, while it is not being written.
    file: Option<MemoryFile>,
    /// The write in progress. It runs on a separate thread, so that a disk that hangs does not delay a halt.
    writing: Option<JoinHandle<MemoryFile>>,
    write_again: Option<Duration>,
}

enum Connection {
    Waiting(Instant),
    Calling(Pin<Box<dyn Future<Output = io::Result<Wire>> + Send>>),
    Stands(Wire),
    Closing(Pin<Box<dyn Future<Output = bool> + Send>>),
}

enum Happening {
    Due,
    Called(io::Result<Wire>),
    Received(io::Result<Vec<u8>>),
    /// The connection is closed; says whether the other side closed it too.
    Closed(bool),
}

impl ExternalLink {
    async fn run(mut self) {
        loop {
            self.keep();
            if self.writing.is_none() {
                self.perform().await;
                // The next program must also know what was just sent.
                self.keep();
            }
            if self.report.is_none() && self.writing.is_none() {
                self.report = self.driver.poll_event();
                self.log();
            }
            let free = self.report.is_none() && self.writing.is_none();
            let wake = self.wake();
            if free && wake <= self.clock.instant(self.clock.now().since_start) {
                // Without this call, a robot that sends all the time would keep the timers from running.
                self.driver.handle_timeout(self.clock.now());
            }
            tokio::select! {
                biased;
                halts = self.side.halts.raised() => self.halt(halts.count).await,
                sent = hand_over(&self.side.reports, &mut self.report), if self.report.is_some() => if !sent { return },
                file = done(&mut self.writing) => self.written(file),
                Ok(()) = self.side.led.changed() => self.led(),
                given = self.side.orders.recv(), if free => match given {
                    Some(stamped) => self.order(stamped),
                    None => return,
                },
                // If no drawing comes, the order fails at its deadline.
                (order, drawn) = done_for(&mut self.drawing), if free => if let Some(drawing) = drawn {
                    self.driver.handle_drawing(order, drawing, self.clock.now());
                },
                // Input is read during a write too, because the driver needs the time at which it arrives.
                happening = self.connection.happening(), if self.report.is_none() => self.happened(happening),
                () = tokio::time::sleep_until(wake), if free => self.driver.handle_timeout(self.clock.now()),
            }
        }
    }

    /// Logs changes of the link, for operators without a console. The driver may report again that the link is up,
    /// when it knows more about the robot.
    fn log(&mut self) {
        let at = &self.address;
        match &self.report {
            Some(RobotEvent::LinkLost(words)) => {
                self.is_up = false;
                tracing::warn!(robot = %self.robot, %at, words, "no link to the robot");
            }
            Some(RobotEvent::LinkUp(_)) if !std::mem::replace(&mut self.is_up, true) => {
                tracing::info!(robot = %self.robot, %at, "the link to the robot is up");
            }
            Some(_) | None => {}
        }
    }

    fn wake(&self) -> Instant {
        let now = self.clock.now().since_start;
        let at = [self.driver.poll_timeout(), self.write_again].into_iter().flatten().min();
        self.clock.instant(at.unwrap_or(Duration::MAX).min(now + LONGEST_WAIT))
    }

    fn keep(&mut self) {
        let Some(mut file) = self.file.take() else {
            // There is no file, or it is being written.
            return;
        };
        let again = self.write_again.is_some_and(|at| at <= self.clock.now().since_start);
        let Some(memory) = self.driver.poll_memory().or_else(|| file.owed().filter(|_| again)) else {
            self.file = Some(file);
            return;
        };
        self.writing = Some(tokio::task::spawn_blocking(move || {
            file.keep(memory);
            file
        }));
    }

    fn written(&mut self, file: Option<MemoryFile>) {
        if file.is_none() {
            tracing::error!(robot = %self.robot, "the position of the robot is not stored any more");
        }
        let owes = file.as_ref().is_some_and(|file| file.owed().is_some());
        self.write_again = owes.then(|| self.clock.now().since_start + WRITTEN_AGAIN);
        self.file = file;
    }

    fn led(&mut self) {
        self.is_led_told = true;
        let blinks = *self.side.led.borrow_and_update();
        self.driver.handle_led(blinks, self.clock.now());
    }

    async fn perform(&mut self) {
        while let Some(output) = self.driver.poll_output() {
            match output {
                Output::Send(bytes) => self.send(bytes).await,
                Output::Draw(order, subject) => {
                    self.drawing = Some((order, tokio::task::spawn_blocking(move || drawing::draw(&subject))));
                }
                Output::Reconnect => self.reconnect(),
                Output::GiveUp(words) => self.lose(&words),
            }
        }
    }

    async fn send(&mut self, bytes: Vec<u8>) {
        let Connection::Stands(wire) = &mut self.connection else { return };
        match wire.send(bytes).await {
            Ok(()) => self.driver.handle_sent(self.clock.now()),
            Err(error) => self.lose(&self.cannot_be_reached(&error)),
        }
    }

    /// Closes the connection and makes a new one. Does nothing without a connection, since a new one is already being
    /// made.
    fn reconnect(&mut self) {
        if matches!(self.connection, Connection::Stands(_)) {
            let call = Connection::Calling(self.address.call());
            if let Connection::Stands(wire) = std::mem::replace(&mut self.connection, call) {
                self.connection = Connection::Closing(wire.close());
            }
            // The driver ended the connection on purpose, so it does not count as brief.
            self.brief = 0;
        }
    }

    fn cannot_be_reached(&self, error: &io::Error) -> String {
        let fought_over = if self.brief >= OFTEN {
            "; the connection breaks repeatedly: check whether another program uses this robot"
        } else {
            ""
        };
        format!("the robot at {} cannot be reached: {error}{fought_over}", self.address)
    }

    fn lose(&mut self, words: &str) {
        let now = self.clock.now().since_start;
        let was_brief = matches!(self.connection, Connection::Stands(_)) && now.saturating_sub(self.connected) < BRIEF;
        self.brief = if was_brief { (self.brief + 1).min(DOUBLED + 1) } else { 0 };
        let wait = AGAIN * 2_u32.pow(self.brief.saturating_sub(1));
        let waiting = Connection::Waiting(self.clock.instant(now + wait));
        if let Connection::Stands(wire) = std::mem::replace(&mut self.connection, waiting) {
            wire.abandon();
        }
        self.driver.handle_lost(words, self.clock.now());
    }

    fn happened(&mut self, happening: Happening) {
        match happening {
            Happening::Due => self.connection = Connection::Calling(self.address.call()),
            Happening::Closed(by_both) => {
                self.connection = Connection::Calling(self.address.call());
                self.driver.handle_closed(by_both, self.clock.now());
            }
            Happening::Called(Ok(wire)) => {
                self.connection = Connection::Stands(wire);
                self.connected = self.clock.now().since_start;
                self.driver.handle_connected(self.clock.now());
            }
            Happening::Received(Ok(bytes)) => self.driver.handle_received(&bytes, self.clock.now()),
            Happening::Called(Err(error)) | Happening::Received(Err(error)) => self.lose(&self.cannot_be_reached(&error)),
        }
    }

    /// Halts the robot. Does nothing if the latest order was sent after the halt. Such an order may arrive here
    /// before the halt does. The driver's answer to a halt is sent even during a write.
    async fn halt(&mut self, count: u64) {
        if self.obeyed < count {
            self.driver.handle_halt(self.clock.now());
            self.perform().await;
        }
    }

    fn order(&mut self, stamped: Stamped) {
        let Stamped { order, halts } = stamped;
        if stamped.is_void(self.side.halts.now().count) {
            self.report = Some(RobotEvent::Halted(order.id, self.driver.is_off_centre()));
            return;
        }
        self.obeyed = halts;
        if !self.is_led_told {
            self.led();
        }
        self.driver.handle_order(order, self.clock.now());
    }
}

impl Connection {
    /// Waits for the next event of the connection. Nothing is lost if the caller stops waiting.
    async fn happening(&mut self) -> Happening {
        match self {
            Connection::Waiting(until) => {
                tokio::time::sleep_until(*until).await;
                Happening::Due
            }
            Connection::Calling(calling) => Happening::Called(calling.await),
            Connection::Stands(wire) => Happening::Received(wire.receive().await),
            Connection::Closing(closing) => Happening::Closed(closing.await),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::halt::Halter;
    use crate::runtime::link::link;
    use crate::runtime::tests::within::within;
    use crate::storage::tests::scratch::Scratch;
    use hallsweep_core::command::Move;
    use hallsweep_core::effect::{Action, Order, Stamp};
    use hallsweep_core::units::{Epoch, Now, Pose, WallTime};
    use hallsweep_drivers::line::LineDriver;

    /// Sends an order and then a halt to a robot that has not introduced itself; returns the report about the order.
    async fn sent_before_a_halt(action: Action) -> RobotEvent {
        let silent = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = Address::Tcp(silent.local_addr().unwrap().to_string(), None);
        let halter = Halter::new(Epoch(0));
        let (mut link, side) = link(halter.watch());
        let order = Order { id: OrderId(1), action, epoch: Epoch(0), deadline: Duration::from_secs(2) };
        link.orders.try_send(Stamped { order, halts: link.halts.now().count }).unwrap();
        halter.halt();
        tokio::spawn(run(RobotId::discovery(), Box::new(LineDriver::new()), address, side, Clock::default(), None));
        within("its answer", link.reports.recv()).await.unwrap()
    }

    #[derive(Debug, Default)]
    struct Recorder {
        told: Vec<String>,
        is_changed: bool,
        answers: Vec<OrderId>,
    }

    impl Recorder {
        fn note(&mut self, what: String) {
            self.told.push(what);
            self.is_changed = true;
        }
    }

    impl Driver for Recorder {
        fn handle_connected(&mut self, _: Now) {}
        fn handle_lost(&mut self, _: &str, _: Now) {}
        fn handle_received(&mut self, _: &[u8], _: Now) {}
        fn handle_sent(&mut self, _: Now) {}
        fn handle_order(&mut self, order: Order, _: Now) {
            self.note(format!("order {}", order.id));
            self.answers.push(order.id);
        }
        fn handle_halt(&mut self, _: Now) {
            self.note("halt".to_owned());
        }
        fn handle_led(&mut self, blinks: bool, _: Now) {
            self.note(format!("led {blinks}"));
        }
        fn handle_drawing(&mut self, _: OrderId, _: Photo, _: Now) {}
        fn handle_timeout(&mut self, _: Now) {}
        fn poll_output(&mut self) -> Option<Output> {
            None
        }
        fn poll_event(&mut self) -> Option<RobotEvent> {
            self.answers.pop().map(RobotEvent::Done)
        }
        fn poll_timeout(&self) -> Option<Duration> {
            None
        }
        fn poll_memory(&mut self) -> Option<String> {
            std::mem::take(&mut self.is_changed).then(|| self.told.join(", "))
        }
        fn is_off_centre(&self) -> bool {
            false
        }
    }

    /// Safety R2. The test also checks that the LED blinks before the first order of a search.
    #[tokio::test]
    async fn whoever_hears_of_an_answer_finds_in_the_file_what_it_follows_from_the_led_before_the_first_order() {
        let folder = Scratch::new();
        let (file, _) = MemoryFile::open(&folder.0, &RobotId::discovery(), "one").expect("there is none yet");
        let silent = tokio::net::TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = Address::Tcp(silent.local_addr().unwrap().to_string(), None);
        let halter = Halter::new(Epoch(0));
        let (mut link, side) = link(halter.watch());
        let driver = Box::new(Recorder::default());
        tokio::spawn(run(RobotId::discovery(), driver, address, side, Clock::default(), Some(file)));
        let mut told = "one\nled false".to_owned();
        for number in 1..=50 {
            let order = Order {
                id: OrderId(number),
                action: Action::Move(Move::Forward),
                epoch: Epoch(0),
                deadline: Duration::from_secs(2),
            };
            link.orders.try_send(Stamped { order, halts: link.halts.now().count }).unwrap();
            assert_eq!(within("its answer", link.reports.recv()).await, Some(RobotEvent::Done(OrderId(number))));
            told += &format!(", order {number}");
            let kept = std::fs::read_to_string(folder.0.join("robot-discovery.txt")).unwrap();
            assert!(kept.starts_with(&format!("{told}\n")), "{kept} is not {told}");
        }
    }

    /// Safety S6.
    #[tokio::test]
    async fn a_motion_that_was_sent_before_a_halt_is_not_given_to_the_driver_and_a_photo_is() {
        assert_eq!(sent_before_a_halt(Action::Move(Move::Forward)).await, RobotEvent::Halted(OrderId(1), false));
        let photo = Action::Photograph(Stamp { pose: Pose::START, wall: WallTime::default() });
        assert!(matches!(sent_before_a_halt(photo).await, RobotEvent::Failed(OrderId(1), _)));
    }
}
