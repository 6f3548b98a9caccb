//! A short storm: floods of every door by a viewer, a few at once, while an operator presses STOP 340 times in five
//! ways, with both versions of MQTT. Program, robot, floods and ways are those of `benches/storm.rs`, which measures
//! the time; this test does not depend on time. This file starts itself as the program and as the floods; therefore
//! it has no test harness and parses the usual arguments itself.
#![expect(clippy::print_stdout, reason = "without a harness a test says itself what became of it")]

#[path = "../benches/storm/clock.rs"]
mod clock;
#[path = "../benches/common/coap.rs"]
mod coap;
#[path = "../benches/storm/course.rs"]
#[expect(dead_code, reason = "no flood goes anywhere else here")]
mod course;
#[path = "../benches/storm/figures.rs"]
#[expect(dead_code, reason = "no time is judged here")]
mod figures;
#[path = "service/mqtt_attacks/five.rs"]
mod five;
#[path = "../benches/storm/floods.rs"]
mod floods;
#[path = "../benches/storm/honest.rs"]
mod honest;
#[path = "../benches/storm/http.rs"]
mod http;
#[path = "service/mqtt_attacks/packets.rs"]
#[expect(dead_code, reason = "these floods do without some")]
mod packets;
#[path = "../benches/storm/run.rs"]
#[expect(clippy::disallowed_methods, reason = "a test bounds its own patience by the real clock")]
mod run;
#[path = "../benches/storm/stage.rs"]
#[expect(clippy::disallowed_methods, reason = "a test bounds its own patience by the real clock")]
mod stage;
#[path = "../benches/storm/stops.rs"]
mod stops;
#[path = "../benches/storm/test_app.rs"]
mod test_app;
#[path = "../benches/storm/wire.rs"]
mod wire;

use course::Doors;
use floods::Flood;
use stops::Way;

/// Total number of STOPs.
const STOPS: usize = 340;

/// Concurrent floods; each group runs against a separate program. docs/testing.md says which floods only the
/// benchmark runs, and why.
const GROUPS: [&[&str]; 12] = [
    // Beside the silent connections, too few of these would be accepted to fill all places.
    &["http-bodies", "http-bodies-near"],
    &["http-heads", "http-heads-near", "http-silence", "http-silence-near"],
    &["http-refused", "http-strangers", "http-reads", "http-streams", "http-comings"],
    &["http-pipelines"],
    &["mqtt-refused", "mqtt-terms", "mqtt-pings"],
    &["mqtt-unsubscribe", "mqtt-filters", "mqtt-topics"],
    &["mqtt-sessions", "mqtt-stalled", "mqtt-comings"],
    &["mqtt-halves"],
    &["mqtt-halves-near"],
    &["mqtt-deaf"],
    &["web-refused", "web-sessions", "web-halves"],
    &["coap-gets", "coap-malformed"],
];

/// Groups that also run with MQTT 5 for all clients.
const IN_FIVE: [&[&str]; 5] = [GROUPS[4], GROUPS[5], GROUPS[6], GROUPS[7], GROUPS[9]];

/// Name of the test on the command line of `cargo test`.
const NAME: &str = "every_stop_gets_in_whatever_a_viewer_does";

fn main() {
    let words: Vec<String> = std::env::args().skip(1).collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [test_app::WORD] => test_app::serve(),
        [stage::FLOOD, name, ..] => stage::flood(name, Doors::read(&words[2..])),
        [stage::HONEST, ..] => stage::look_on(Doors::read(&words[1..])),
        _ if words.iter().any(|word| word == "--list") => println!("{NAME}: test"),
        _ if is_asked_for(&words) => {
            every_stop_gets_in_whatever_a_viewer_does();
            println!("test {NAME} ... ok");
        }
        _ => println!("test {NAME} ... not asked for"),
    }
}

/// Whether the arguments of the test harness select this test.
fn is_asked_for(words: &[String]) -> bool {
    let (mut filters, mut skipped, mut words) = (Vec::new(), Vec::new(), words.iter().map(String::as_str));
    while let Some(word) = words.next() {
        match word {
            "--ignored" => return false,
            "--skip" => skipped.extend(words.next()),
            // The value of such an option is not a filter.
            "--test-threads" | "--format" | "--color" | "--logfile" | "--shuffle-seed" | "-Z" => drop(words.next()),
            option if option.starts_with('-') => {}
            filter => filters.push(filter),
        }
    }
    (filters.is_empty() || filters.iter().any(|filter| NAME.contains(filter))) && !skipped.iter().any(|word| NAME.contains(word))
}

/// Safety S7, S9: whatever a viewer does, every STOP halts the robot, and no operator's connection for a STOP is
/// refused.
fn every_stop_gets_in_whatever_a_viewer_does() {
    let groups = GROUPS.into_iter().map(|group| (group, false)).chain(IN_FIVE.map(|group| (group, true)));
    let each = STOPS / (GROUPS.len() + IN_FIVE.len()) / Way::ALL.len();
    figures::head();
    let (mut halted, mut faults) = (0, Vec::new());
    for (group, is_five) in groups {
        wire::speak_five(is_five);
        let floods: Vec<&Flood> = group.iter().map(|name| floods::named(name).expect("a flood of this name")).collect();
        let row = run::run(group[0], &floods, true, each);
        row.print(false);
        halted += row.stops.took.iter().filter(|(_, halt)| halt.is_some()).count();
        faults.extend(row.shortcomings().into_iter().chain(row.failed).map(|fault| format!("{}: {fault}", group[0])));
    }
    assert_eq!((halted, faults), (STOPS, Vec::new()));
}
