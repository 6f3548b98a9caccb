//! The sketch for a microcontroller in `docs/line-robot`, compiled as plain C++ with a stand-in for the board, and
//! driven by our driver, in simulated time. Without a C++ compiler these tests print a message and pass; with
//! `HALLSWEEP_REQUIRE_CLIENTS=1` they fail.

use std::io::{BufRead, BufReader, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::OnceLock;
use std::time::Duration;

use hallsweep_core::command::Move;
use hallsweep_core::effect::{Action, Order};
use hallsweep_core::event::{Obstacle, RobotEvent, Whereabouts};
use hallsweep_core::rng::RandomStream;
use hallsweep_core::units::{Cell, Epoch, Heading, Now, OrderId, Pose};
use hallsweep_drivers::line::{LineDriver, framed};
use hallsweep_drivers::{Driver, Output};

const STANDING: &str = "0000";
const AHEAD: &str = "1010";
const BACK: &str = "0101";

/// The sketch as a program, compiled once; `None`: there is no compiler.
fn sketch() -> Option<&'static Path> {
    static SKETCH: OnceLock<Option<PathBuf>> = OnceLock::new();
    SKETCH.get_or_init(compiled).as_deref()
}

fn compiled() -> Option<PathBuf> {
    if Command::new("c++").arg("--version").output().is_err() {
        let required = std::env::var("HALLSWEEP_REQUIRE_CLIENTS").is_ok_and(|value| value == "1");
        assert!(!required, "the tests of the sketch need a C++ compiler, as c++");
        // Written past the test harness, which would swallow it.
        let words = "the tests of the sketch are left out: they need a C++ compiler, as c++";
        writeln!(std::io::stderr(), "{words}").expect("standard error is open");
        return None;
    }
    let crate_root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("line-robot");
    let output = Command::new("c++")
        .args(["-std=c++11", "-Wall", "-Wextra", "-Werror", "-O1", "-include"])
        .arg(crate_root.join("tests/sketch/board.h"))
        .args(["-x", "c++"])
        .arg(crate_root.join("../../docs/line-robot/line-robot.ino"))
        .arg("-o")
        .arg(&program)
        .output()
        .expect("the compiler was there just now");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    Some(program)
}

struct Board {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    motors: String,
}

impl Board {
    fn switched_on(sketch: &Path) -> Board {
        let mut child = Command::new(sketch).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it was compiled");
        let to = child.stdin.take().expect("standard input is a pipe");
        let from = BufReader::new(child.stdout.take().expect("standard output is a pipe"));
        Board { child, to, from, motors: STANDING.to_owned() }
    }

    /// Sends the board a line, and returns what the sketch has sent since.
    fn tell(&mut self, what: &str) -> Vec<u8> {
        writeln!(self.to, "{what}").expect("the sketch runs");
        let mut line = String::new();
        self.from.read_line(&mut line).expect("the sketch runs");
        let (said, motors) = line.strip_prefix("said ").and_then(|line| line.split_once(" motors ")).expect("the sketch runs");
        self.motors = motors.trim_end().to_owned();
        let byte = |at: usize| u8::from_str_radix(&said[at..at + 2], 16).expect("it is hex");
        (0..said.len()).step_by(2).map(byte).collect()
    }

    fn hear(&mut self, bytes: &[u8]) {
        let hex: String = bytes.iter().map(|byte| format!("{byte:02x}")).collect();
        self.tell(&format!("hear {hex}"));
    }

    /// Lets this many milliseconds pass in which the sketch receives only this text, and returns what it sends.
    fn hears(&mut self, text: &str, ms: u64) -> String {
        self.hear(&framed(text));
        String::from_utf8(self.tell(&format!("pass {ms}"))).expect("it speaks ASCII")
    }
}

impl Drop for Board {
    fn drop(&mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

struct Test {
    board: Board,
    driver: LineDriver,
    now: Now,
    /// The probability that a piece is lost on its way, with its random numbers.
    loses: f64,
    chance: RandomStream,
}

impl Test {
    /// A driver and the sketch, with the link up.
    fn up(sketch: &Path) -> Test {
        let (board, driver) = (Board::switched_on(sketch), LineDriver::new());
        let mut test = Test { board, driver, now: Now::default(), loses: 0.0, chance: RandomStream::new(1, "wire") };
        test.driver.handle_connected(test.now);
        let home = Whereabouts { pose: Pose::START, off_centre: false };
        assert_eq!(test.event(), RobotEvent::Stands(home));
        assert!(matches!(test.event(), RobotEvent::LinkUp(can) if can.step == Duration::from_millis(800)));
        test
    }

    fn order(&mut self, id: u64, action: Action) {
        let deadline = Duration::from_secs(10);
        self.driver.handle_order(Order { id: OrderId(id), action, epoch: Epoch(0), deadline }, self.now);
    }

    fn orders(&mut self, id: u64, action: Action) -> RobotEvent {
        self.order(id, action);
        self.event()
    }

    /// The next report that is no reading of the sonar.
    fn event(&mut self) -> RobotEvent {
        for _ in 0..2000 {
            match self.driver.poll_event() {
                Some(RobotEvent::Sonar(_)) => {}
                Some(event) => return event,
                None => self.pass(),
            }
        }
        panic!("nothing was reported within 20 s");
    }

    /// Advances both by 10 ms.
    fn pass(&mut self) {
        while let Some(output) = self.driver.poll_output() {
            let Output::Send(bytes) = output else { panic!("{output:?}") };
            if !self.chance.happens(self.loses) {
                self.board.hear(&bytes);
            }
        }
        let said = self.board.tell("pass 10");
        if !self.chance.happens(self.loses) {
            self.driver.handle_received(&said, self.now);
        }
        self.now.since_start += Duration::from_millis(10);
        self.driver.handle_timeout(self.now);
    }

    fn pass_until_motors(&mut self, motors: &str) {
        for _ in 0..100 {
            if self.board.motors == motors {
                return;
            }
            self.pass();
        }
        panic!("the motors never were {motors}, but {}", self.board.motors);
    }

    /// Where the sketch says that it stands, by a new connection.
    fn stands(&mut self) -> Whereabouts {
        self.driver.handle_lost("for a look", self.now);
        self.driver.handle_connected(self.now);
        loop {
            if let RobotEvent::Stands(whereabouts) = self.event() {
                while !matches!(self.event(), RobotEvent::LinkUp(_)) {}
                return whereabouts;
            }
        }
    }
}

const FORWARD: Action = Action::Move(Move::Forward);
const BACKWARD: Action = Action::Move(Move::Backward);
const LEFT: Action = Action::Move(Move::TurnLeft);
const RIGHT: Action = Action::Move(Move::TurnRight);

#[test]
fn the_sketch_does_what_it_is_told_and_knows_where_it_stands() {
    let Some(sketch) = sketch() else { return };
    let mut test = Test::up(sketch);
    for (id, action) in (1..).zip([FORWARD, LEFT, FORWARD, BACKWARD, FORWARD, RIGHT, FORWARD, Action::Recentre]) {
        assert_eq!(test.orders(id, action), RobotEvent::Done(OrderId(id)), "{action:?}");
    }
    let pose = Pose { cell: Cell::new(1, 2), heading: Heading::South };
    assert_eq!(test.stands(), Whereabouts { pose, off_centre: false });
}

#[test]
fn the_sketch_halts_where_it_is_and_goes_back_to_its_centre() {
    let Some(sketch) = sketch() else { return };
    for (action, back) in [(FORWARD, BACK), (BACKWARD, AHEAD), (LEFT, "1001"), (RIGHT, "0110")] {
        let mut test = Test::up(sketch);
        test.order(1, action);
        for _ in 0..30 {
            test.pass();
        }
        assert_ne!(test.board.motors, STANDING);
        test.driver.handle_halt(test.now);
        test.pass();
        assert_eq!(test.board.motors, STANDING);
        assert_eq!(test.event(), RobotEvent::Halted(OrderId(1), true));
        assert!(matches!(test.orders(2, FORWARD), RobotEvent::Failed(OrderId(2), words) if words.contains("recentre first")));
        test.order(3, Action::Recentre);
        test.pass_until_motors(back);
        assert_eq!(test.event(), RobotEvent::Done(OrderId(3)));
        assert_eq!(test.stands(), Whereabouts { pose: Pose::START, off_centre: false });
    }
}

#[test]
fn the_sketch_says_what_it_meets() {
    let Some(sketch) = sketch() else { return };
    let mut test = Test::up(sketch);
    test.board.tell("cm 4");
    test.order(1, FORWARD);
    test.pass_until_motors(AHEAD);
    test.board.tell("bump 1");
    assert_eq!(test.event(), RobotEvent::Blocked(OrderId(1), Obstacle::Unknown));
    test.board.tell("bump 0");
    assert_eq!(test.orders(2, Action::Recentre), RobotEvent::Done(OrderId(2)));
    assert_eq!(test.stands(), Whereabouts { pose: Pose::START, off_centre: false });
}

#[test]
fn over_a_wire_that_loses_much_of_what_is_said_every_order_of_the_sketch_is_done_once() {
    let Some(sketch) = sketch() else { return };
    let mut test = Test::up(sketch);
    test.loses = 0.4;
    for id in 1..=20 {
        while test.driver.poll_event().is_some() {}
        // Four repetitions lost in a row would halt it; this seed has none.
        assert_eq!(test.orders(id, if id % 2 == 0 { BACKWARD } else { FORWARD }), RobotEvent::Done(OrderId(id)));
    }
    test.loses = 0.0;
    assert_eq!(test.stands(), Whereabouts { pose: Pose::START, off_centre: false });
}

/// Safety S5.
#[test]
fn the_sketch_that_moves_and_hears_nothing_halts_by_itself() {
    let Some(sketch) = sketch() else { return };
    let mut test = Test::up(sketch);
    test.order(1, FORWARD);
    test.pass_until_motors(AHEAD);
    test.board.tell("pass 380");
    assert_eq!(test.board.motors, AHEAD);
    test.board.hear(b"w 2 9000*0000\n");
    let said = String::from_utf8(test.board.tell("pass 40")).unwrap();
    assert_eq!((test.board.motors.as_str(), said.starts_with("halted 2 off*")), (STANDING, true), "{said}");
}

#[test]
fn the_sketch_halts_when_its_deadline_has_passed() {
    let Some(sketch) = sketch() else { return };
    let mut board = Board::switched_on(sketch);
    board.hears("from 1", 1);
    assert_eq!(board.hears("w 2 500", 300), "");
    let said = board.hears("hello", 210);
    assert!(said.contains("off last=2*") && said.contains("failed 2 it did not finish in time*"), "{said}");
    assert_eq!(board.motors, STANDING);
}

/// The order may be one that it had begun before it was switched off.
#[test]
fn the_sketch_obeys_no_order_before_it_is_told_from_where() {
    let Some(sketch) = sketch() else { return };
    let mut board = Board::switched_on(sketch);
    assert_eq!((board.hears("w 2 9000", 50), board.hears("h 2", 50)), (String::new(), String::new()));
    assert_eq!(board.motors, STANDING);
    assert!(board.hears("hello", 1).contains("at=0,0,south centred last=0*"));
}

#[test]
fn whatever_comes_over_the_wire_the_sketch_goes_on() {
    let Some(sketch) = sketch() else { return };
    let mut board = Board::switched_on(sketch);
    let mut chance = RandomStream::new(1, "noise");
    for _ in 0..300 {
        let length = chance.below(200);
        let noise: Vec<u8> = (0..length).map(|_| chance.number().to_le_bytes()[0]).collect();
        board.hear(&noise);
        board.hear(&framed(&"x".repeat(usize::try_from(chance.below(100)).unwrap())));
        board.tell("pass 1");
    }
    board.hear(b"\n");
    assert!(board.hears("hello", 1).starts_with("hello ada base sonar led bump step=800 turn=650 photo=0 at=0,0,south"));
}
