//! How long STOP takes from the request to the halt on the wire of the line protocol (safety S6): while the robot moves, and while a photo
//! of 100 kB is on its way. The robot is played here, over TCP; the program is the real one.
#![expect(clippy::disallowed_methods, clippy::print_stdout, reason = "a benchmark looks at the clock and prints")]

#[path = "common/ask.rs"]
mod ask;
#[path = "common/goals.rs"]
#[expect(dead_code, reason = "nobody is compared with")]
mod goals;
#[path = "common/program.rs"]
#[expect(dead_code, reason = "nobody looks into its folder")]
mod program;
#[path = "line/robot.rs"]
mod robot;

use std::process::ExitCode;
use std::time::{Duration, Instant};

use program::Program;
use robot::{Robot, Seen};

/// So many stops in each part.
const STOPS: usize = 300;

/// The goals of safety S6.
const P99: Duration = Duration::from_millis(50);
const WORST: Duration = Duration::from_millis(100);

/// Within this time whatever is asked for is accepted.
const PATIENCE: Duration = Duration::from_secs(20);

fn main() -> ExitCode {
    let robot = Robot::listen();
    let place = format!("line={}", robot.place);
    let program = Program::serve(&["--robot", &place]);
    println!("STOP, request → halt on the wire of the line protocol:");
    judge("the robot moves", (0..STOPS).map(|_| stopped(&program, &robot, "commands/start", Seen::Motion)).collect());
    robot.meet_something();
    press(&program, "commands/start");
    robot.until(Seen::PhotoBegins);
    robot.until(Seen::PhotoEnds);
    let photos = (0..STOPS).map(|_| {
        let took = stopped(&program, &robot, "luggage/1/photo", Seen::PhotoBegins);
        robot.until(Seen::PhotoEnds);
        took
    });
    judge("a photo comes", photos.collect());
    goals::exit()
}

/// Presses this, waits until the robot is at it, and stops; how long that took to the wire.
fn stopped(program: &Program, robot: &Robot, begin: &str, seen: Seen) -> Duration {
    press(program, begin);
    robot.until(seen);
    let asked = Instant::now();
    press(program, "commands/stop");
    let Seen::Halt(at) = robot.until(Seen::Halt(asked)) else { unreachable!("a halt was waited for") };
    at.duration_since(asked)
}

/// Until it is accepted: what is recorded just now may be in its way.
fn press(program: &Program, what: &str) {
    let since = Instant::now();
    loop {
        let answer = ask::ask(&program.address, "POST", &format!("/api/v1/{what}"), "").expect("the door answers");
        if answer.contains("\"accepted\":true") {
            return;
        }
        assert!(since.elapsed() < PATIENCE, "{what}: {answer}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Prints how long they took, and holds them against the goals.
fn judge(what: &str, mut took: Vec<Duration>) {
    took.sort_unstable();
    let at = |percent: usize| took[(took.len() * percent / 100).min(took.len() - 1)];
    println!("  {what:<16} {:4} × p50 {:>9.2?}  p99 {:>9.2?}  worst {:>9.2?}", took.len(), at(50), at(99), at(100));
    goals::met(&format!("{what}: p99 ≤ {P99:?}, worst ≤ {WORST:?}"), at(99) <= P99 && at(100) <= WORST);
}
