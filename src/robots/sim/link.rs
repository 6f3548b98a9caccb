//! Joins the simulated robot to the loop: channels, timers, the speed of time, the simulator's controls, and the threads on which photos are
//! drawn and the state file is written.
//! What the robot does is decided by `hallsweep_sim`; this is the only file of the simulated robot that waits.

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{oneshot, watch};
use tokio::task::JoinHandle;
use tokio::time::Instant;

use super::pair_link::Moved;
use super::remote::{Controls, Ground, News, Remote};
use super::sim_time::SimTime;
use super::state_file::SimStateFile;
use crate::robots::waits::{done, done_for, hand_over};
use crate::runtime::clock::Clock;
use crate::runtime::link::{RobotSide, Stamped};
use hallsweep_core::effect::Order;
use hallsweep_core::event::{Capabilities, Photo, RobotEvent};
use hallsweep_core::units::{Cell, Now, OrderId};
use hallsweep_sim::{Faults, Hall, Sim, SimSettings, Speed};

/// What drawing a photo may take of real time, whatever the speed; the core is told so. It takes some hundredths of a second, but the
/// machine may have much else to do, and a photo that is late counts as none.
const DEVELOPING: Duration = Duration::from_secs(3);

/// Timers are not set further ahead than this; then it is looked again.
const LONGEST_WAIT: Duration = Duration::from_secs(3600);

/// So long after the state file could not be written it is tried again, when nothing new has happened before.
const WRITTEN_AGAIN: Duration = Duration::from_secs(1);

/// A simulated robot before it runs, and what is to become of it.
pub(super) struct Begin {
    pub(super) sim: Sim,
    /// Of which another is made in another hall.
    pub(super) settings: SimSettings,
    pub(super) speed: Speed,
    /// What it must not forget goes there, when there is one, before anybody is told of it.
    pub(super) state_file: Option<SimStateFile>,
    pub(super) floor: Floor,
    pub(super) remote: Remote,
    /// Whether faults of robots are its own: they are of the one that searches.
    pub(super) has_faults: bool,
}

/// Runs a simulated robot until the loop's end of its channels is gone.
pub(super) async fn run(begin: Begin, side: RobotSide, clock: Clock) {
    let Begin { sim, settings, speed, state_file, floor, remote, has_faults } = begin;
    let link = Link {
        sim,
        settings,
        side,
        clock,
        usual_speed: speed,
        time: SimTime::begin(speed, clock.now().since_start),
        report: None,
        said: VecDeque::new(),
        developing: None,
        obeyed: 0,
        state_file,
        writing: None,
        write_again: None,
        floor,
        remote,
        has_faults,
        controls: Controls::default(),
        is_stepping: false,
    };
    link.run().await;
}

/// The hall as it was opened, what others have lifted since, and where something was put into the way.
#[derive(Clone, Debug)]
pub(super) struct Floor {
    pub(super) hall: Arc<Hall>,
    pub(super) moved: watch::Receiver<Moved>,
    /// The cells in which something stands that the hall does not have.
    pub(super) blocked: BTreeSet<Cell>,
}

impl Floor {
    pub(super) const fn new(hall: Arc<Hall>, moved: watch::Receiver<Moved>) -> Floor {
        Floor { hall, moved, blocked: BTreeSet::new() }
    }
}

struct Link {
    sim: Sim,
    settings: SimSettings,
    side: RobotSide,
    clock: Clock,
    /// While the controls name no other.
    usual_speed: Speed,
    time: SimTime,
    /// A report on its way. Until it is taken nothing but a halt is listened to, so that reports cannot pile up.
    report: Option<RobotEvent>,
    /// What the link itself has to report, before the robot's next report.
    said: VecDeque<RobotEvent>,
    developing: Option<(OrderId, JoinHandle<Photo>)>,
    /// The halts of which the last order that was begun knew.
    obeyed: u64,
    /// The state file, while it is not being written.
    state_file: Option<SimStateFile>,
    /// The state file being written: on a thread of its own, so that a disk that hangs delays no halt. Until it is done nothing else
    /// goes on.
    writing: Option<JoinHandle<SimStateFile>>,
    /// When what could not be written is tried again, by the real clock.
    write_again: Option<Duration>,
    floor: Floor,
    remote: Remote,
    has_faults: bool,
    /// The controls as far as they are obeyed.
    controls: Controls,
    /// Time stands, but for the order under way.
    is_stepping: bool,
}

impl Link {
    async fn run(mut self) {
        self.floor.moved.mark_changed();
        self.remote.controls.mark_changed();
        loop {
            self.write();
            self.put_obstacles();
            self.next_report();
            let settled = self.report.is_none() && self.writing.is_none();
            if settled {
                self.remote.say_ready();
            }
            let free = settled && !self.remote.is_moving();
            let jumps = free && self.jumps();
            let wake = self.wake();
            tokio::select! {
                biased;
                halts = self.side.halts.raised() => self.halt(halts.count),
                sent = hand_over(&self.side.reports, &mut self.report), if self.report.is_some() => if !sent { return },
                state_file = done(&mut self.writing) => self.written(state_file),
                news = self.remote.news(settled) => self.hear(news),
                Ok(()) = self.floor.moved.changed() => self.look_at_floor(),
                Ok(()) = self.side.led.changed() => self.led(),
                given = self.side.orders.recv(), if free => match given {
                    Some(stamped) => self.order(stamped),
                    None => return,
                },
                photo = done_for(&mut self.developing), if free => self.deliver(photo),
                () = std::future::ready(()), if jumps => self.jump(),
                () = tokio::time::sleep_until(wake), if free => self.sim.handle_timeout(self.now()),
            }
        }
    }

    fn now(&self) -> Now {
        let Now { since_start, wall } = self.clock.now();
        Now { since_start: self.time.at(since_start), wall }
    }

    /// When the simulation has to be looked at again, by the real clock.
    fn wake(&self) -> Instant {
        let now = self.clock.now().since_start;
        let wait = self.sim.poll_timeout().and_then(|at| self.time.until(at, now));
        let at = now + wait.unwrap_or(LONGEST_WAIT).min(LONGEST_WAIT);
        self.clock.instant(self.write_again.map_or(at, |again| again.min(at)))
    }

    /// Whether time is not waited for.
    fn jumps(&self) -> bool {
        let runs = self.time.speed() == Speed::Max && !self.time.is_paused();
        (runs || self.is_stepping) && self.sim.is_busy() && !self.sim.is_developing()
    }

    /// Begins to write down what has changed, or what is still owed when its time has come.
    fn write(&mut self) {
        let Some(mut state_file) = self.state_file.take() else { return };
        let again = self.write_again.is_some_and(|at| at <= self.clock.now().since_start);
        let Some(memory) = self.sim.poll_memory().or_else(|| state_file.owed().filter(|_| again)) else {
            self.state_file = Some(state_file);
            return;
        };
        self.writing = Some(tokio::task::spawn_blocking(move || {
            state_file.keep(memory);
            state_file
        }));
    }

    fn written(&mut self, state_file: Option<SimStateFile>) {
        let owes = state_file.as_ref().is_some_and(|state_file| state_file.owed().is_some());
        self.write_again = owes.then(|| self.clock.now().since_start + WRITTEN_AGAIN);
        self.state_file = state_file;
    }

    /// Takes the next report, unless one is on its way already, or what it follows from is not written down yet. Nobody hears what a robot
    /// says whose link is lost.
    fn next_report(&mut self) {
        if self.report.is_some() || self.writing.is_some() {
            return;
        }
        self.report = self.said.pop_front();
        if self.report.is_none() && !self.controls.is_link_lost {
            self.report = self.sim.poll_event();
        }
        if let Some(RobotEvent::LinkUp(capabilities)) = self.report {
            self.report = Some(RobotEvent::LinkUp(self.in_real_time(capabilities)));
            self.said.extend(self.time.is_paused().then_some(RobotEvent::Paused));
        }
    }

    fn in_real_time(&self, simulated: Capabilities) -> Capabilities {
        let (speed, Capabilities { step, turn, photo, arm, .. }) = (self.time.speed(), simulated);
        let photo = speed.to_real(photo) + DEVELOPING;
        Capabilities { step: speed.to_real(step), turn: speed.to_real(turn), photo, arm: speed.to_real(arm), ..simulated }
    }

    fn hear(&mut self, news: News) {
        match news {
            News::Controls => self.obey_controls(),
            News::Asked(asked) => self.remote.under_way = Some(asked),
            News::Decided(decided) => self.move_to(decided),
        }
    }

    /// Comes to be as the controls say.
    fn obey_controls(&mut self) {
        let wanted = self.remote.controls.borrow_and_update().clone();
        let wanted = if self.has_faults { wanted } else { Controls { is_link_lost: false, faults: Faults::default(), ..wanted } };
        let before = std::mem::replace(&mut self.controls, wanted);
        let Controls { speed, is_paused, steps, is_link_lost, faults, .. } = self.controls.clone();
        let runs_otherwise = self.time.run_at(speed.unwrap_or(self.usual_speed), is_paused, self.clock.now().since_start);
        self.is_stepping = is_paused && (self.is_stepping || steps != before.steps);
        self.sim.handle_faults(faults, self.now());
        match (before.is_link_lost, is_link_lost) {
            (false, true) => {
                self.sim.handle_link_lost(self.now());
                self.developing = None;
                self.said.push_back(RobotEvent::LinkLost("the simulator keeps it lost".to_owned()));
            }
            (true, false) => self.sim.handle_link_back(self.now()),
            (false, false) if runs_otherwise && is_paused => self.said.push_back(RobotEvent::Paused),
            (false, false) if runs_otherwise => self.sim.tell_capabilities(),
            (true, true) | (false, false) => {}
        }
    }

    /// What was lifted is not met any more.
    fn look_at_floor(&mut self) {
        let moved = self.floor.moved.borrow_and_update().clone();
        let hall = self.floor.hall.rearranged(&moved);
        let hall = if self.floor.blocked.is_empty() { hall } else { hall.blocked(&self.floor.blocked) };
        self.sim.handle_hall(Arc::new(hall));
    }

    /// Puts into the way what the controls want there, but for where the robot is: there it is put when the robot has left.
    fn put_obstacles(&mut self) {
        let wanted = &self.controls.blocked;
        if wanted.is_empty() && self.floor.blocked.is_empty() {
            return;
        }
        let free: BTreeSet<Cell> = wanted.iter().filter(|cell| !self.sim.is_in_or_enters(**cell)).copied().collect();
        if free != self.floor.blocked {
            self.floor.blocked = free;
            self.look_at_floor();
        }
    }

    /// The robot is put down in another hall, or goes on in this one.
    fn move_to(&mut self, decided: Option<(Ground, oneshot::Sender<()>)>) {
        let Some((Ground { hall, seed }, put_down)) = decided else { return };
        self.settings.seed = seed;
        self.sim = Sim::new(Arc::clone(&hall), self.settings);
        self.sim.handle_faults(self.controls.faults, Now::default());
        self.sim.handle_led(*self.side.led.borrow());
        let (speed, is_paused, now) = (self.time.speed(), self.time.is_paused(), self.clock.now().since_start);
        self.time = SimTime::begin(speed, now);
        self.time.run_at(speed, is_paused, now);
        (self.developing, self.is_stepping, self.write_again) = (None, false, None);
        if let Some(state_file) = &mut self.state_file {
            state_file.move_to(&hall);
        }
        if self.floor.moved.has_changed().is_err() {
            // Nobody lifts anything; what had been lifted was of the hall before.
            self.floor.moved = watch::channel(Moved::new()).1;
        }
        self.floor = Floor::new(hall, self.floor.moved.clone());
        self.look_at_floor();
        // Whoever waits for it may have gone.
        let _ = put_down.send(());
    }

    fn led(&mut self) {
        let blinks = *self.side.led.borrow_and_update();
        self.sim.handle_led(blinks);
    }

    /// A halt concerns what was begun before it was raised: an order may have overtaken the news of a halt that it knows of.
    fn halt(&mut self, count: u64) {
        if self.obeyed < count {
            self.sim.handle_halt(self.now());
        }
        self.is_stepping = false;
    }

    fn order(&mut self, stamped: Stamped) {
        let Stamped { order, halts } = stamped;
        if stamped.is_void(self.side.halts.now().count) {
            self.report = Some(RobotEvent::Halted(order.id, self.sim.is_off_centre()));
            return;
        }
        if self.controls.is_link_lost {
            // It does not arrive, and the core knows that the link is lost before it waits for an answer.
            return;
        }
        self.obeyed = halts;
        let deadline = self.time.speed().to_simulated(order.deadline);
        self.sim.handle_order(Order { deadline, ..order }, self.now());
        if let Some((id, exposure)) = self.sim.take_exposure() {
            self.developing = Some((id, tokio::task::spawn_blocking(move || exposure.develop())));
        }
    }

    /// Brings a drawn photo to the simulation. One that could not be drawn is missed by its order's deadline.
    fn deliver(&mut self, (order, photo): (OrderId, Option<Photo>)) {
        if let Some(photo) = photo {
            self.sim.handle_photo(order, photo, self.now());
        }
    }

    fn jump(&mut self) {
        if let Some(at) = self.sim.poll_timeout() {
            self.time.jump_to(at, self.clock.now().since_start);
        }
        self.sim.handle_timeout(self.now());
        self.is_stepping &= self.sim.is_busy();
    }
}

#[cfg(test)]
#[path = "controlled_tests.rs"]
mod controlled_tests;

#[cfg(test)]
mod tests {
    use std::path::Path;
    use std::sync::Arc;

    use super::*;
    use crate::runtime::halt::Halter;
    use crate::runtime::link::{REPORTS, RobotLink, link};
    use crate::runtime::within::within;
    use crate::storage::scratch::Scratch;
    use hallsweep_core::command::Move;
    use hallsweep_core::effect::{Action, Stamp};
    use hallsweep_core::event::{RobotId, Whereabouts};
    use hallsweep_core::units::{Epoch, Pose, WallTime};
    use hallsweep_sim::{Camera, Hall, SimMemory, SimSettings};

    struct Test {
        link: RobotLink,
        halter: Halter,
        task: JoinHandle<()>,
        capabilities: Capabilities,
    }

    impl Test {
        async fn begin(rows: &[&str], speed: Speed) -> Test {
            let settings = SimSettings { sonar_noise_cm: 0.0, ..SimSettings::new(1, Camera::Rendered) };
            let sim = Sim::new(Arc::new(Hall::from_rows("test", rows).unwrap()), settings);
            Test::with(sim, speed, None).await.0
        }

        async fn with(sim: Sim, speed: Speed, state_file: Option<SimStateFile>) -> (Test, Whereabouts) {
            let halter = Halter::new(Epoch(0));
            let (mut link, side) = link(halter.watch());
            let begin = Begin {
                sim,
                settings: SimSettings::new(1, Camera::Rendered),
                speed,
                state_file,
                floor: still_floor(),
                remote: Remote::untouched(),
                has_faults: true,
            };
            let task = tokio::spawn(run(begin, side, Clock::default()));
            let Some(RobotEvent::Stands(whereabouts)) = within("where it is", link.reports.recv()).await else {
                panic!("first it says where it is")
            };
            let Some(RobotEvent::LinkUp(capabilities)) = within("the link", link.reports.recv()).await else {
                panic!("then the link comes up")
            };
            (Test { link, halter, task, capabilities }, whereabouts)
        }

        async fn give(&mut self, id: u64, action: Action, halts: u64) {
            let order = Order { id: OrderId(id), action, epoch: Epoch(0), deadline: Duration::from_secs(5) };
            self.link.orders.send(Stamped { order, halts }).await.unwrap();
        }

        /// The answer to the order under way, past what the sonar says.
        async fn answer(&mut self) -> RobotEvent {
            loop {
                let event = within("the robot's answer", self.link.reports.recv()).await.expect("the robot is running");
                if !matches!(event, RobotEvent::Sonar(_)) {
                    return event;
                }
            }
        }
    }

    fn still_floor() -> Floor {
        let hall = Arc::new(Hall::from_rows("test", &["S.", ".."]).unwrap());
        Floor::new(hall, watch::channel(Moved::new()).1)
    }

    const FORWARD: Action = Action::Move(Move::Forward);
    const LEFT: Action = Action::Move(Move::TurnLeft);

    fn photograph() -> Action {
        Action::Photograph(Stamp { pose: Pose::START, wall: WallTime::default() })
    }

    #[tokio::test]
    async fn at_full_speed_a_thousand_steps_are_all_answered() {
        let mut test = Test::begin(&["S", "."], Speed::Max).await;
        for id in 0..1000 {
            test.give(id, Action::Move(if id % 2 == 0 { Move::Forward } else { Move::Backward }), 0).await;
            assert_eq!(test.answer().await, RobotEvent::Done(OrderId(id)));
        }
    }

    #[tokio::test]
    async fn durations_are_told_and_kept_in_real_time() {
        let mut test = Test::begin(&["S", "."], Speed::Times(10.0)).await;
        assert_eq!(test.capabilities.step, Duration::from_millis(33));
        let clock = Clock::default();
        test.give(1, FORWARD, 0).await;
        assert_eq!(test.answer().await, RobotEvent::Done(OrderId(1)));
        assert!(clock.now().since_start >= Duration::from_millis(32));
    }

    #[tokio::test]
    async fn a_halt_stops_the_order_under_way_at_once() {
        let mut test = Test::begin(&["S", "."], Speed::Times(0.1)).await;
        test.give(1, FORWARD, 0).await;
        tokio::time::sleep(Duration::from_millis(50)).await;
        test.halter.halt();
        assert_eq!(test.answer().await, RobotEvent::Halted(OrderId(1), true));
        test.give(2, Action::Recentre, 1).await;
        assert_eq!(test.answer().await, RobotEvent::Done(OrderId(2)));
    }

    #[tokio::test]
    async fn an_order_from_before_a_halt_is_not_begun_and_one_from_after_it_is() {
        let mut test = Test::begin(&["S", "."], Speed::Max).await;
        test.halter.halt();
        test.give(1, FORWARD, 0).await;
        assert_eq!(test.answer().await, RobotEvent::Halted(OrderId(1), false));
        test.halter.halt();
        test.give(2, FORWARD, 2).await;
        assert_eq!(test.answer().await, RobotEvent::Done(OrderId(2)));
    }

    #[tokio::test]
    async fn a_halt_gets_through_while_nobody_takes_the_reports() {
        let mut test = Test::begin(&["S", "."], Speed::Max).await;
        // Each turn makes an answer and a sonar reading at most: so many fill the channel, and the robot waits with the next.
        let orders = REPORTS as u64 + 8;
        let mut given = 0;
        while given < orders && tokio::time::timeout(Duration::from_millis(200), test.give(given, LEFT, 0)).await.is_ok() {
            given += 1;
        }
        assert!(given < orders, "the robot never had to wait");
        test.halter.halt();
        let mut last = RobotEvent::Sonar(None);
        for _ in 0..given {
            last = test.answer().await;
        }
        assert!(
            matches!(last, RobotEvent::Halted(id, _) if id == OrderId(given - 1)),
            "what was still queued did not begin: {last:?}"
        );
    }

    #[tokio::test]
    async fn a_photo_is_drawn_beside_the_loop_and_no_halt_cuts_it_short() {
        let mut test = Test::begin(&["S", "a"], Speed::Times(2.0)).await;
        test.give(1, photograph(), 0).await;
        tokio::time::sleep(Duration::from_millis(50)).await;
        test.halter.halt();
        let RobotEvent::Photo(OrderId(1), photo) = test.answer().await else { panic!("a photo was ordered") };
        assert_eq!(photo.media_type, "image/png");
    }

    fn hall() -> Arc<Hall> {
        Arc::new(Hall::from_rows("test", &["S", "."]).unwrap())
    }

    /// Begins with what the state file in this folder remembers.
    async fn begin_in(folder: &Path, speed: Speed) -> (Test, Whereabouts) {
        let (state_file, memory) = SimStateFile::open(folder, &RobotId::discovery(), &hall(), &hall()).unwrap();
        let settings = SimSettings::new(1, Camera::Stub);
        let sim = match memory {
            Some(memory) => Sim::remembering(hall(), settings, memory),
            None => Sim::new(hall(), settings),
        };
        Test::with(sim, speed, Some(state_file)).await
    }

    /// Looks into the folder until what is remembered there is as expected.
    async fn until_remembered(folder: &Path, expect: impl Fn(SimMemory) -> bool) {
        let seen = async {
            while !SimStateFile::open(folder, &RobotId::discovery(), &hall(), &hall()).unwrap().1.is_some_and(&expect) {
                tokio::time::sleep(Duration::from_millis(1)).await;
            }
        };
        within("what is to be remembered", seen).await;
    }

    /// Safety R2.
    #[tokio::test]
    async fn whatever_was_reported_before_the_program_died_is_known_to_the_next() {
        let folder = Scratch::new();
        let mut pose = Pose::START;
        for id in 0..20 {
            let (mut test, whereabouts) = begin_in(&folder.0, Speed::Max).await;
            assert_eq!(whereabouts, Whereabouts { pose, off_centre: false });
            let step = if pose.cell.y == 0 { Move::Forward } else { Move::Backward };
            test.give(id, Action::Move(step), 0).await;
            assert_eq!(test.answer().await, RobotEvent::Done(OrderId(id)));
            pose.cell.y = 1 - pose.cell.y;
            test.task.abort();
        }
    }

    /// Safety R2.
    #[tokio::test]
    async fn a_step_under_way_when_the_program_dies_leaves_it_off_centre() {
        let folder = Scratch::new();
        let (mut test, _) = begin_in(&folder.0, Speed::Times(0.1)).await;
        test.give(1, FORWARD, 0).await;
        until_remembered(&folder.0, |memory| memory.motion.is_some()).await;
        test.task.abort();
        let (mut test, whereabouts) = begin_in(&folder.0, Speed::Max).await;
        assert_eq!(whereabouts, Whereabouts { pose: Pose::START, off_centre: true });
        test.give(1, Action::Recentre, 0).await;
        assert_eq!(test.answer().await, RobotEvent::Done(OrderId(1)));
    }

    #[tokio::test]
    async fn without_a_folder_to_write_in_it_goes_on_and_writes_as_soon_as_there_is_one() {
        let folder = Scratch::new();
        let late = folder.0.join("late");
        let (mut test, _) = begin_in(&late, Speed::Max).await;
        test.give(1, FORWARD, 0).await;
        assert_eq!(test.answer().await, RobotEvent::Done(OrderId(1)));
        std::fs::create_dir(&late).unwrap();
        until_remembered(&late, |memory| memory.pose != Pose::START).await;
    }

    /// Safety S1.
    #[cfg(unix)]
    #[tokio::test]
    async fn a_disk_that_hangs_delays_no_halt() {
        let folder = Scratch::new();
        let late = folder.0.join("late");
        let (mut test, _) = begin_in(&late, Speed::Times(0.5)).await;
        // The next writing waits for somebody at the other end of a pipe.
        let pipe = late.join("simulated-robot.new");
        std::fs::create_dir(&late).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        test.give(1, FORWARD, 0).await;
        tokio::time::sleep(Duration::from_millis(200)).await;
        test.halter.halt();
        // By now the step would have ended.
        tokio::time::sleep(Duration::from_millis(800)).await;
        assert!(test.link.reports.try_recv().is_err(), "nothing is told that is not written");
        std::fs::rename(&pipe, folder.0.join("pipe")).unwrap();
        let other_end = tokio::task::spawn_blocking(move || std::fs::read(folder.0.join("pipe")).map(|_| folder));
        assert_eq!(test.answer().await, RobotEvent::Halted(OrderId(1), true));
        drop(other_end.await);
    }

    #[tokio::test]
    async fn it_ends_when_the_loop_is_gone() {
        let Test { link, task, .. } = Test::begin(&["S"], Speed::Times(1.0)).await;
        drop(link);
        within("its end", task).await.unwrap();
    }
}
