//! Tests of the emulator: what a connected program sees.

use std::time::Duration;

use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpStream;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;

use super::*;
use crate::config::{Sources, load};
use crate::runtime::tests::within::within;
use hallsweep_core::effect::{Action, Order, Stamp};
use hallsweep_core::speed::Speed;
use hallsweep_core::units::{OrderId, Pose, WallTime};
use hallsweep_drivers::line::{LineDriver, LineReader, framed};
use hallsweep_drivers::{Driver, Output};

struct Test {
    place: String,
    played: JoinHandle<Result<(), EmulatorError>>,
}

impl Test {
    async fn begin(rows: &[&str], speed: Speed, faults: Faults, photo_bytes: usize) -> Test {
        let name = RobotName::new("emulator").unwrap();
        let emulation = Emulation { name, end: End::Port("127.0.0.1:0".to_owned()), photo_bytes, faults };
        let settings = RobotSettings { speed, ..load(&Sources::default()).unwrap().hall.robot };
        let hall = Arc::new(Hall::from_rows("test", rows).unwrap());
        let (say, place) = oneshot::channel();
        let announce = |place: &str| say.send(place.to_owned()).unwrap();
        let played = tokio::spawn(async move { play(hall, &settings, emulation, announce).await });
        Test { place: within("the port", place).await.unwrap(), played }
    }

    async fn connect(&self) -> Client {
        let stream = TcpStream::connect(&self.place).await.unwrap();
        Client { stream, lines: LineReader::default() }
    }
}

impl Drop for Test {
    fn drop(&mut self) {
        self.played.abort();
    }
}

struct Client {
    stream: TcpStream,
    lines: LineReader,
}

impl Client {
    async fn say(&mut self, text: &str) {
        self.stream.write_all(&framed(text)).await.unwrap();
    }

    /// The next line with this beginning; `None` when the connection has ended.
    async fn hears(&mut self, begins: &str) -> Option<String> {
        let coming = async {
            loop {
                let byte = self.stream.read_u8().await.ok()?;
                if let Some(text) = self.lines.take(byte).filter(|text| text.starts_with(begins)) {
                    return Some(text);
                }
            }
        };
        within(begins, coming).await
    }

    async fn begin(&mut self, from: u32) -> String {
        loop {
            self.say(&format!("from {from}")).await;
            let hello = self.hears("hello ").await.expect("the robot is there");
            if hello.ends_with(&format!(" last={from}")) {
                return hello;
            }
        }
    }
}

const CORRIDOR: [&str; 3] = ["S", ".", "."];

#[tokio::test]
async fn it_does_what_it_is_told_and_says_where_it_stands() {
    let test = Test::begin(&CORRIDOR, Speed::Max, Faults::default(), 0).await;
    let mut client = test.connect().await;
    let hello = client.begin(1).await;
    assert!(hello.starts_with("hello emulator base camera sonar led thermometer bump step="), "{hello}");
    for (order, answer) in [("w 2 5000", "done 2"), ("w 3 5000", "done 3"), ("w 4 5000", "blocked 4 "), ("c 5 5000", "done 5")] {
        client.say(order).await;
        client.hears(answer).await.expect(answer);
    }
    client.say("hello").await;
    assert!(client.hears("hello").await.unwrap().contains("at=0,2,south centred last=5"));
}

/// Safety S5.
#[tokio::test]
async fn one_that_moves_and_hears_nothing_halts_by_itself() {
    let test = Test::begin(&CORRIDOR, Speed::Times(0.1), Faults::default(), 0).await;
    let mut client = test.connect().await;
    client.begin(1).await;
    client.say("w 2 60000").await;
    assert_eq!(client.hears("halted").await.as_deref(), Some("halted 2 off"));
}

/// Safety S5.
#[tokio::test]
async fn one_whose_connection_is_gone_halts_and_says_so_to_the_next() {
    let test = Test::begin(&CORRIDOR, Speed::Times(0.5), Faults::default(), 0).await;
    let mut client = test.connect().await;
    client.begin(1).await;
    client.say("w 2 60000").await;
    client.say("hello").await;
    assert!(client.hears("hello").await.unwrap().contains("off last=2"), "it moves");
    drop(client);
    // Waits until the step would have ended. A new connection halts the robot too, so it is made only after this.
    tokio::time::sleep(Duration::from_secs(2)).await;
    let hello = test.connect().await.begin(3).await;
    assert!(hello.contains("at=0,0,south off last=3"), "{hello}");
}

#[tokio::test]
async fn a_newcomer_takes_the_place_of_whoever_was_there() {
    let test = Test::begin(&CORRIDOR, Speed::Max, Faults::default(), 0).await;
    let mut first = test.connect().await;
    first.begin(1).await;
    let mut second = test.connect().await;
    second.begin(2).await;
    assert_eq!(first.hears("anything").await, None);
}

#[tokio::test]
async fn a_connection_is_cut_when_that_was_asked_for() {
    let faults = Faults { cut_after: Some(Duration::from_millis(100)), ..Faults::default() };
    let test = Test::begin(&CORRIDOR, Speed::Max, faults, 0).await;
    assert_eq!(test.connect().await.hears("anything").await, None);
    test.connect().await.begin(1).await;
}

/// An order arrives while a photo is being sent, and nobody reads the photo. The robot still obeys the order.
#[tokio::test]
async fn it_listens_while_a_photo_is_on_its_way() {
    let test = Test::begin(&CORRIDOR, Speed::Max, Faults::default(), MOST_BYTES as usize).await;
    let mut client = test.connect().await;
    client.begin(1).await;
    client.say("photo 2 60000").await;
    client.hears("photo 2 4194304").await.expect("the photo begins");
    client.say("w 3 60000").await;
    client.say("hello").await;
    // The robot's answers come after these bytes.
    let mut bytes = vec![0; MOST_BYTES as usize];
    within("the photo", client.stream.read_exact(&mut bytes)).await.unwrap();
    assert!(bytes.starts_with(b"\x89PNG"));
    client.hears("done 3").await.expect("it has moved meanwhile");
}

/// The program's driver over a wire with every fault: each order is answered, and the photo arrives.
#[tokio::test]
async fn over_a_bad_wire_the_driver_gets_its_answers() {
    let faults = Faults { lose: 0.1, garble: 0.1, delay: Duration::from_millis(20), cut_after: Some(Duration::from_secs(4)) };
    let test = Test::begin(&CORRIDOR, Speed::Times(20.0), faults, 0).await;
    let mut program = Program::connected(&test).await;
    for (id, action) in (1..=12).map(|id| (id, program_action(id))) {
        program.until_done(OrderId(id), action).await;
    }
}

fn program_action(id: u64) -> Action {
    use hallsweep_core::command::Move::{Backward, Forward, TurnLeft, TurnRight};
    match id % 6 {
        0 => Action::Photograph(Stamp { pose: Pose::START, wall: WallTime::default() }),
        1 => Action::Move(Forward),
        2 => Action::Move(TurnLeft),
        3 => Action::Move(TurnRight),
        4 => Action::Move(Backward),
        _ => Action::Recentre,
    }
}

struct Program<'t> {
    test: &'t Test,
    stream: TcpStream,
    driver: LineDriver,
    clock: Clock,
}

impl<'t> Program<'t> {
    async fn connected(test: &'t Test) -> Program<'t> {
        let stream = TcpStream::connect(&test.place).await.unwrap();
        let (mut driver, clock) = (LineDriver::new(), Clock::default());
        driver.handle_connected(clock.now());
        let mut program = Program { test, stream, driver, clock };
        program.until_up().await;
        program
    }

    /// Repeats the order until it is done. If the robot is off centre, recentres it first, as the core would.
    async fn until_done(&mut self, id: OrderId, action: Action) {
        let mut wanted = action;
        loop {
            let order = Order { id, action: wanted, epoch: Epoch(0), deadline: Duration::from_secs(10) };
            self.driver.handle_order(order, self.clock.now());
            let event = self.event().await;
            if matches!(event, RobotEvent::LinkLost(_)) {
                self.until_up().await;
            }
            let is_done = matches!(event, RobotEvent::Done(_) | RobotEvent::Photo(..));
            if is_done && wanted == action {
                return;
            }
            let recentres = !is_done && self.driver.is_off_centre();
            wanted = if recentres { Action::Recentre } else { action };
        }
    }

    async fn until_up(&mut self) {
        while !matches!(self.event().await, RobotEvent::LinkUp(_)) {}
    }

    /// The next report that is not about the sensors.
    async fn event(&mut self) -> RobotEvent {
        loop {
            match self.driver.poll_event() {
                Some(RobotEvent::Sonar(_) | RobotEvent::Temperature(_) | RobotEvent::Stands(_)) => {}
                Some(event) => return event,
                None => within("the robot", self.step()).await,
            }
        }
    }

    async fn step(&mut self) {
        while let Some(output) = self.driver.poll_output() {
            match output {
                Output::Send(bytes) => drop(self.stream.write_all(&bytes).await),
                Output::GiveUp(_) => return self.reconnect().await,
                other @ (Output::Reconnect | Output::Draw(..)) => panic!("{other:?}"),
            }
        }
        let mut bytes = [0; 1024];
        tokio::select! {
            read = self.stream.read(&mut bytes) => match read {
                Ok(count @ 1..) => self.driver.handle_received(&bytes[..count], self.clock.now()),
                Ok(_) | Err(_) => self.reconnect().await,
            },
            () = self.clock.reach(self.driver.poll_timeout()) => self.driver.handle_timeout(self.clock.now()),
        }
    }

    async fn reconnect(&mut self) {
        self.driver.handle_lost("it was cut", self.clock.now());
        self.stream = TcpStream::connect(&self.test.place).await.unwrap();
        self.driver.handle_connected(self.clock.now());
    }
}
