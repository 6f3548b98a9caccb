//! Time of a STOP from the request to the robot's wire: with the line protocol while the robot moves and while its
//! photo of 100 kB comes, and with the virtual robot's protocol. The program is the real one in a separate process,
//! with its real store (safety S6).
#![expect(clippy::disallowed_methods, clippy::print_stdout, reason = "a benchmark looks at the clock and prints")]

#[path = "common/ask.rs"]
mod ask;
#[path = "common/coap.rs"]
#[expect(dead_code, reason = "nothing is observed")]
mod coap;
#[path = "../tests/service/mqtt_attacks/five.rs"]
mod five;
#[path = "common/goals.rs"]
#[expect(dead_code, reason = "nobody is compared with")]
mod goals;
#[path = "../tests/service/mqtt_attacks/client.rs"]
#[expect(dead_code, reason = "whoever presses STOP attacks nobody")]
mod mqtt;
#[path = "../tests/service/line_robots/paced.rs"]
#[expect(dead_code, reason = "the pace stays")]
mod paced;
#[path = "../tests/service/mqtt_attacks/packets.rs"]
#[expect(dead_code, reason = "whoever presses STOP attacks nobody")]
mod packets;
#[path = "common/program.rs"]
#[expect(dead_code, reason = "nothing is asked of the system")]
mod program;
#[path = "wire/virtual_server.rs"]
mod virtual_server;

use std::process::ExitCode;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};

use paced::{PacedRobot, Seen};
use program::Program;

/// Number of STOPs per door.
const STOPS: usize = 300;

/// Number of STOPs with the virtual robot, which needs a second to return to where it was stopped.
const VIRTUAL_STOPS: usize = 100;

/// Goals of safety S6.
const P99: Duration = Duration::from_millis(50);
const WORST: Duration = Duration::from_millis(100);

/// Speed at which photos come, in bytes per second: a photo of 100 kB takes 2.5 s.
const BYTES_A_SECOND: u64 = 40_000;

/// Pause between two attempts to request a photo.
const PAUSE: Duration = Duration::from_millis(20);

/// Pause between two STOPs while no order is written: a halt less than 100 ms old also serves the next STOP.
const SERVED: Duration = Duration::from_millis(120);

/// Part of the answer to an accepted command.
const ACCEPTED: &str = "\"accepted\":true";

/// Time limit of every wait, much longer than any should take.
const PATIENCE: Duration = Duration::from_secs(30);

/// Events at the robot's port, with their times.
type Sight = Receiver<(Seen, Instant)>;

fn main() -> ExitCode {
    println!("STOP, request → robot's wire:");
    over_each_door("it moves", &PacedRobot::listening(BYTES_A_SECOND, false), while_it_moves);
    over_each_door("a photo comes", &PacedRobot::listening(BYTES_A_SECOND, true), while_photos_come);
    let (place, seen) = virtual_server::listening();
    let program = Program::serve(&["--robot", &format!("virtual-tcp={place}")]);
    let stop = &mut || accepted(&post(&program.address, "commands/stop"));
    judge("HTTP, virtual-tcp", while_it_moves(&program.address, &seen, VIRTUAL_STOPS, stop));
    goals::exit()
}

/// Function that gives and times STOPs. Its arguments: the HTTP address for the other requests, the events at the
/// robot, the number of STOPs, and a function that gives one.
type Stops = fn(&str, &Sight, usize, &mut dyn FnMut()) -> Vec<Duration>;

/// Measures the STOPs over each door of a program with this robot.
fn over_each_door(what: &str, robot: &PacedRobot, stops: Stops) {
    let mut program = Program::serve(&["--robot", &format!("line={}", robot.place)]);
    let [coap, mqtt] = ["coap://", "mqtt://"].map(|scheme| program.door(scheme).parse().expect("it is an address"));
    let http = &program.address;
    let over = |door: &str, stop: &mut dyn FnMut()| judge(&format!("{door}, {what}"), stops(http, &robot.seen, STOPS, stop));
    over("HTTP", &mut || accepted(&post(http, "commands/stop")));
    let mut client = coap::Coap::at(coap);
    over("CoAP", &mut || accepted(&client.ask("POST", "commands/stop", "").expect("the door answers").text));
    let mut client = mqtt::Client::try_connect(mqtt, &packets::connect("operator", 60)).expect("the door lets a client in");
    client.subscribe("hallsweep/discovery/command/stop/result", 0);
    over("MQTT", &mut || {
        client.publish("hallsweep/discovery/command/stop", b"");
        accepted(&String::from_utf8_lossy(&client.message().payload));
    });
}

/// Gives each STOP during a step.
fn while_it_moves(http: &str, sight: &Sight, stops: usize, stop: &mut dyn FnMut()) -> Vec<Duration> {
    let took = |_| {
        accepted(&post(http, "commands/start"));
        until(sight, &[Seen::Moves]);
        let asked = Instant::now();
        stop();
        until(sight, &[Seen::Halt]).1.duration_since(asked)
    };
    (0..stops).map(took).collect()
}

/// Gives many STOPs during each photo, until there are enough.
fn while_photos_come(http: &str, sight: &Sight, stops: usize, stop: &mut dyn FnMut()) -> Vec<Duration> {
    let mut took = Vec::new();
    for photos in 0.. {
        if took.len() == stops {
            break;
        }
        assert!(photos < stops, "a STOP comes through while a photo does");
        take_photo(http, sight);
        while took.len() < stops {
            std::thread::sleep(SERVED);
            if sight.try_iter().any(|(seen, _)| seen == Seen::PhotoOver) {
                break;
            }
            let asked = Instant::now();
            stop();
            let (seen, at) = until(sight, &[Seen::Halt, Seen::PhotoOver]);
            if seen == Seen::Halt {
                took.push(at.duration_since(asked));
                continue;
            }
            // A STOP that was requested before the photo ended counts, however late it arrives.
            if at > asked {
                took.push(until(sight, &[Seen::Halt]).1.duration_since(asked));
            }
            break;
        }
    }
    took
}

/// Requests the photo again as soon as there is one, and waits until it comes. The mission takes the first photo by
/// itself.
fn take_photo(http: &str, sight: &Sight) {
    let since = Instant::now();
    while {
        sight.try_iter().for_each(drop);
        !post(http, "luggage/1/photo").contains(ACCEPTED)
    } {
        assert!(since.elapsed() < PATIENCE, "a photo can be taken again");
        // START is accepted before the mission begins; later it changes nothing.
        let _ = post(http, "commands/start");
        std::thread::sleep(PAUSE);
    }
    until(sight, &[Seen::PhotoBegins]);
}

/// Waits for the next event of these kinds.
fn until(sight: &Sight, wanted: &[Seen]) -> (Seen, Instant) {
    loop {
        let seen = sight.recv_timeout(PATIENCE).expect("what is waited for comes to the robot");
        if wanted.contains(&seen.0) {
            return seen;
        }
    }
}

fn post(http: &str, path: &str) -> String {
    ask::ask(http, "POST", &format!("/api/v1/{path}"), "").expect("the door answers")
}

fn accepted(answer: &str) {
    assert!(answer.contains(ACCEPTED), "{answer}");
}

/// Prints the times and compares them with the goals.
fn judge(what: &str, mut took: Vec<Duration>) {
    took.sort_unstable();
    let [p50, p99, worst] = [50, 99, 100].map(|percent| took[(took.len() * percent / 100).min(took.len() - 1)]);
    println!("  {what:<26} {:4} × p50 {p50:>9.2?}  p99 {p99:>9.2?}  worst {worst:>9.2?}", took.len());
    goals::met(&format!("{what}: p99 ≤ {P99:?}, worst ≤ {WORST:?}"), p99 <= P99 && worst <= WORST);
}
