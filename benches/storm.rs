//! The storm: everything that a viewer can do to every door, with honest clients beside it, while an operator presses
//! STOP in five ways and the robot moves. Measured is the time from the request to the robot's port, in a program as
//! `app` opens it, beside a run without the storm (safety S6, S7, S9). The MQTT floods are also compared with
//! mosquitto under the same flood. Everything is sent to loopback and ends by itself.
//!
//! `cargo bench --bench storm` runs everything; `-- http-bodies` runs that flood alone, with a line for each way of
//! STOP; `-- all` runs all floods at once; `-- calm` runs none; `-- list` prints their names; `--stops 20` sets the
//! number of STOPs in each way; `--equal` runs the senders of the named floods at the program's own priority, and
//! compares the MQTT floods with mosquitto.
#![expect(clippy::disallowed_methods, clippy::print_stdout, reason = "a benchmark looks at the clock and prints")]

#[path = "storm/beside.rs"]
mod beside;
#[path = "storm/clock.rs"]
mod clock;
#[path = "common/coap.rs"]
mod coap;
#[path = "storm/course.rs"]
mod course;
#[path = "storm/figures.rs"]
mod figures;
#[path = "../tests/service/mqtt_attacks/five.rs"]
mod five;
#[path = "storm/floods.rs"]
mod floods;
#[path = "storm/honest.rs"]
mod honest;
#[path = "storm/http.rs"]
mod http;
#[path = "../tests/service/mqtt_attacks/packets.rs"]
#[expect(dead_code, reason = "these floods do without some")]
mod packets;
#[path = "storm/run.rs"]
mod run;
#[path = "storm/stage.rs"]
mod stage;
#[path = "storm/stops.rs"]
mod stops;
#[path = "storm/test_app.rs"]
mod test_app;
#[path = "storm/wire.rs"]
mod wire;

use std::process::ExitCode;

use course::Doors;
use figures::{P99, Row, WORST};
use floods::{Door, FLOODS, Flood};
use run::run;

/// STOPs in each way: without the storm and under all floods, and under each flood alone.
const STOPS: usize = 300;
const STOPS_ALONE: usize = 60;

/// Exit codes: a goal was missed, or a part did not run.
const MISSED: u8 = 1;
const NOT_RUN: u8 = 2;

fn main() -> ExitCode {
    let words: Vec<String> = std::env::args().skip(1).filter(|word| word != "--bench").collect();
    match words.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [test_app::WORD] => test_app::serve(),
        [stage::FLOOD, name, ..] => stage::flood(name, Doors::read(&words[2..])),
        [stage::HONEST, ..] => stage::look_on(Doors::read(&words[1..])),
        ["list"] => FLOODS.iter().for_each(|flood| println!("{}", flood.name)),
        _ => return storm(&words),
    }
    ExitCode::SUCCESS
}

/// Options from the command line.
struct Asked {
    floods: Vec<&'static Flood>,
    /// Whether all floods run at once.
    is_all: bool,
    /// Whether the run without floods is requested.
    is_calm: bool,
    each: Option<usize>,
    is_equal: bool,
}

impl Asked {
    fn read(words: &[String]) -> Result<Asked, String> {
        let mut asked = Asked { floods: Vec::new(), is_all: false, is_calm: false, each: None, is_equal: false };
        let mut words = words.iter();
        while let Some(word) = words.next() {
            match word.as_str() {
                "--equal" => asked.is_equal = true,
                "all" => asked.is_all = true,
                "calm" => asked.is_calm = true,
                "--stops" => asked.each = Some(words.next().and_then(|n| n.parse().ok()).ok_or("--stops wants a number")?),
                name => asked.floods.push(floods::named(name).ok_or_else(|| format!("no flood is called {name}: try list"))?),
            }
        }
        Ok(asked)
    }
}

fn storm(words: &[String]) -> ExitCode {
    let asked = match Asked::read(words) {
        Ok(asked) => asked,
        Err(why) => {
            println!("{why}");
            return ExitCode::from(NOT_RUN);
        }
    };
    println!("STOP, request → robot port; goals: p99 ≤ {P99:?}, worst ≤ {WORST:?}, every STOP halts and is answered");
    let code = if asked.floods.is_empty() && !asked.is_all && !asked.is_calm { whole(&asked) } else { named(&asked) };
    println!("{}", ["every goal is met", "a goal is missed", "a part did not run"][usize::from(code)]);
    ExitCode::from(code)
}

/// Runs the named floods, each alone.
fn named(asked: &Asked) -> u8 {
    figures::head();
    let each = asked.each.unwrap_or(STOPS);
    let calm = if asked.is_calm { calm(each) } else { 0 };
    let judge = |flood: &&Flood| {
        if asked.is_equal && flood.door == Door::Mqtt {
            return beside(flood, each);
        }
        judged(&run(flood.name, &[flood], !asked.is_equal, each), true)
    };
    let alone = asked.floods.iter().map(judge).max().unwrap_or(0).max(calm);
    if asked.is_all { alone.max(at_once(!asked.is_equal, each)) } else { alone }
}

fn calm(each: usize) -> u8 {
    judged(&run("no storm", &[], true, each), true)
}

/// Runs all floods at once.
fn at_once(is_nice: bool, each: usize) -> u8 {
    judged(&run("all at once", &FLOODS.each_ref(), is_nice, each), true)
}

/// Runs without the storm, under each flood, under all of them, and beside mosquitto.
fn whole(asked: &Asked) -> u8 {
    let (many, few) = (asked.each.unwrap_or(STOPS), asked.each.unwrap_or(STOPS_ALONE));
    figures::head();
    let mut codes = vec![calm(many)];
    println!("senders at nice 10:");
    codes.extend(FLOODS.iter().map(|flood| judged(&run(flood.name, &[flood], true, few), false)));
    codes.push(at_once(true, many));
    println!("senders at equal priority, STOP over MQTT beside single messages through mosquitto, p50, p99 and worst in ms:");
    codes.extend(FLOODS.iter().filter(|flood| flood.door == Door::Mqtt).map(|flood| beside(flood, few)));
    codes.into_iter().max().unwrap_or(0)
}

/// Prints a run and returns its exit code.
fn judged(row: &Row, by_way: bool) -> u8 {
    row.print(by_way);
    let misses = row.misses();
    misses.iter().for_each(|miss| println!("      {miss}"));
    match (&row.failed, misses.is_empty() && row.shortcomings().is_empty()) {
        (Some(_), _) => NOT_RUN,
        (None, true) => 0,
        (None, false) => MISSED,
    }
}

fn beside(flood: &Flood, each: usize) -> u8 {
    let row = run(flood.name, &[flood], false, each);
    if let Some(why) = &row.failed {
        println!("  {:<18} did not run: {why}", flood.name);
        return NOT_RUN;
    }
    row.shortcomings().iter().for_each(|shortcoming| println!("      {shortcoming}"));
    let doors = Doors::nowhere();
    match beside::mosquitto(flood, &doors, 5 * each) {
        Err(why) => {
            println!("  {:<18} did not run: {why}", flood.name);
            NOT_RUN
        }
        Ok(other) if figures::beside(&row, &other) && row.shortcomings().is_empty() => 0,
        Ok(_) => MISSED,
    }
}
