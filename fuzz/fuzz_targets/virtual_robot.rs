//! The virtual robot in both dialects. With any messages of its server, cut anywhere, between orders, halts, lost and
//! new connections and pauses: an order is answered at most once, nothing begins after a halt, nothing grows without
//! bound, and the printed memory parses again.
#![no_main]

use std::collections::BTreeSet;
use std::time::Duration;

use hallsweep_drivers::{Dialect, Driver, Extent, Output, Room, Thing, VirtualRobot};
use hallsweep_fuzz::core::command::Move;
use hallsweep_fuzz::core::effect::{Action, Order, Stamp};
use hallsweep_fuzz::core::event::{Photo, RobotEvent};
use hallsweep_fuzz::core::units::{Epoch, Now, OrderId, Pose, WallTime};
use libfuzzer_sys::fuzz_target;

const STEP: Duration = Duration::from_millis(330);

/// Typical messages of its servers, so that the fuzzer need not find every message letter by letter.
const SAID: [&str; 15] = [
    r#";{"type":"webpage-ready","arg":{}};"#,
    r#";{"type":"collision","arg":{"objectName":"wallDown"}};"#,
    r#";{"type":"collision","arg":{"objectName":"plasticBox"}};"#,
    r#";{"type":"sonar-activated","arg":{"sonarName":"sonar2","distance":14,"axis":"x"}};"#,
    r#"{"endmove":true,"move":"moveForward"}"#,
    r#"{"endmove":true,"move":"moveBackward"}"#,
    r#"{"endmove":true,"move":"turnLeft"}"#,
    r#"{"endmove":true}"#,
    r#"{"endmove":false,"move":"moveForward_notallowed"}"#,
    r#"{"endmove":false,"move":"moveForward_halted"}"#,
    r#"{"collision":"moveForward","target":"wallDown"}"#,
    r#"{"collision":true,"move":"unknown"}"#,
    r#"{"endmove":"false","move":"moveForward_notallowed (asynch)"}"#,
    r#"{"endmove":"false","move":"moveBackward-interrupted"}"#,
    r#"{"endmove":"false","move":"moveForward-collision"}"#,
];

const ACTIONS: [Action; 9] = [
    Action::Move(Move::Forward),
    Action::Move(Move::Forward),
    Action::Move(Move::Backward),
    Action::Move(Move::TurnLeft),
    Action::Move(Move::TurnRight),
    Action::Move(Move::NudgeLeft),
    Action::Recentre,
    Action::Photograph(Stamp { pose: Pose::START, wall: WallTime { unix_ms: 0, offset_s: 0 } }),
    Action::Enter,
];

fuzz_target!(|bytes: &[u8]| {
    let Some((kind, mut rest)) = bytes.split_first() else { return };
    let mut run = Run::new(*kind);
    run.settle();
    while let [what, how, after @ ..] = rest {
        rest = run.happens(*what, *how, after);
        run.settle();
    }
});

fn room() -> Room {
    let thing = |name: &str, x, y| Thing { name: name.to_owned(), extent: Extent { x, y } };
    Room {
        floor: Extent { x: (-0.75, 7.5), y: (-0.8, 7.95) },
        things: vec![thing("wallDown", (-0.75, 7.5), (7.2, 8.0)), thing("plasticBox", (3.0, 4.5), (1.5, 3.0))],
        moving: vec!["bag".to_owned()],
    }
}

struct Run {
    dialect: Dialect,
    driver: VirtualRobot,
    memory: String,
    now: Now,
    is_connected: bool,
    /// Whether the robot was halted and got no order since.
    is_halted: bool,
    given: u64,
    open: BTreeSet<OrderId>,
    drawing: Option<OrderId>,
}

impl Run {
    fn new(kind: u8) -> Run {
        let dialect = if kind & 1 == 0 { Dialect::Semicolons } else { Dialect::Messages };
        let driver = VirtualRobot::new(dialect, STEP);
        let driver = if kind & 2 == 0 { driver } else { driver.in_room(room()) };
        Run {
            dialect,
            driver,
            memory: String::new(),
            now: Now::default(),
            is_connected: false,
            is_halted: false,
            given: 0,
            open: BTreeSet::new(),
            drawing: None,
        }
    }

    /// Executes one event; returns the rest of the input.
    fn happens<'b>(&mut self, what: u8, how: u8, after: &'b [u8]) -> &'b [u8] {
        match what % 10 {
            0 => self.connect(),
            1 => self.lose(),
            2 => self.order(how),
            3 => {
                self.is_halted = true;
                self.driver.handle_halt(self.now);
            }
            4 => {
                let (piece, after) = after.split_at(usize::from(how).min(after.len()));
                self.receive(piece);
                return after;
            }
            5 => self.receive(SAID[usize::from(how) % SAID.len()].as_bytes()),
            6 => self.pass(Duration::from_millis(how.into())),
            7 => self.pass(Duration::from_millis(20) * how.into()),
            8 => self.driver.handle_led(how & 1 == 0, self.now),
            _ if how & 1 == 0 => self.draw(),
            _ => self.kill(),
        }
        after
    }

    fn connect(&mut self) {
        if !std::mem::replace(&mut self.is_connected, true) {
            self.driver.handle_connected(self.now);
        }
    }

    fn lose(&mut self) {
        self.is_connected = false;
        self.driver.handle_lost("the cable was pulled", self.now);
    }

    fn receive(&mut self, piece: &[u8]) {
        if self.is_connected {
            self.driver.handle_received(piece, self.now);
        }
    }

    fn order(&mut self, how: u8) {
        self.given += 1;
        let (id, action) = (OrderId(self.given), ACTIONS[usize::from(how) % ACTIONS.len()]);
        self.open.insert(id);
        self.is_halted = false;
        self.driver.handle_order(Order { id, action, epoch: Epoch(0), deadline: Duration::from_secs(3) }, self.now);
    }

    /// Advances the time and handles each event when it is due. An event may cause further events at the same time.
    fn pass(&mut self, time: Duration) {
        let (end, mut at_once) = (self.now.since_start + time, 0);
        while let Some(at) = self.driver.poll_timeout().filter(|at| *at <= end) {
            at_once = if at > self.now.since_start { 0 } else { at_once + 1 };
            assert!(at_once < 8, "it does not wait for what has happened");
            self.now.since_start = self.now.since_start.max(at);
            self.driver.handle_timeout(self.now);
            self.settle();
        }
        self.now.since_start = end;
    }

    fn draw(&mut self) {
        if let Some(order) = self.drawing.take() {
            self.driver.handle_drawing(order, Photo { bytes: [1].into(), media_type: "image/png" }, self.now);
        }
    }

    /// Restarts the driver from its printed memory, as in another process.
    fn kill(&mut self) {
        self.driver = read_back(self.dialect, &self.memory);
        self.open.clear();
        (self.is_connected, self.drawing) = (false, None);
    }

    fn settle(&mut self) {
        if let Some(memory) = self.driver.poll_memory() {
            read_back(self.dialect, &memory);
            self.memory = memory;
        }
        for count in 0.. {
            assert!(count < 16, "what is to be done is bounded");
            let Some(output) = self.driver.poll_output() else { break };
            match output {
                Output::Send(bytes) => self.sent(&bytes),
                Output::Reconnect => self.is_connected = false,
                Output::GiveUp(_) => self.lose(),
                Output::Draw(order, _) => self.drawing = Some(order),
            }
        }
        while let Some(event) = self.driver.poll_event() {
            match event {
                RobotEvent::Done(id)
                | RobotEvent::Blocked(id, _)
                | RobotEvent::Halted(id, _)
                | RobotEvent::Failed(id, _)
                | RobotEvent::Photo(id, _)
                | RobotEvent::PhotoFailed(id, _) => assert!(self.open.remove(&id), "an order is answered once"),
                RobotEvent::LinkLost(_) => self.open.clear(),
                _ => {}
            }
        }
    }

    fn sent(&mut self, bytes: &[u8]) {
        let text = String::from_utf8_lossy(bytes);
        let begins = !text.contains("alarm");
        assert!(!begins || !self.is_halted, "after a halt nothing begins: {text}");
        assert!(!begins || !self.open.is_empty(), "without an order nothing begins: {text}");
        if self.is_connected {
            self.driver.handle_sent(self.now);
        }
    }
}

fn read_back(dialect: Dialect, memory: &str) -> VirtualRobot {
    VirtualRobot::remembering(dialect, STEP, memory).expect("what was written can be read")
}
