//! Readable figures: medians of turns, and ratios to hallsweep's figures.

use std::time::Duration;

use crate::fan_out::{OBSERVERS, Round};
use crate::goals;
use crate::load::Outcome;
use crate::server::Kind;

/// One figure of one server, with its value in every turn.
pub(crate) struct Measured {
    kind: Kind,
    turns: Vec<Duration>,
    outcome: Outcome,
}

impl Measured {
    pub(crate) fn new(kind: Kind) -> Measured {
        Measured { kind, turns: Vec::new(), outcome: Outcome::default() }
    }

    pub(crate) fn add(&mut self, (each, outcome): (Duration, Outcome)) {
        self.turns.push(each);
        self.outcome += outcome;
    }

    pub(crate) fn median(&self) -> Duration {
        median(self.turns.clone())
    }

    fn best(&self) -> Duration {
        self.turns.iter().min().copied().unwrap_or_default()
    }

    /// Range of the turns, and the number of lost and wrong answers if there are any.
    fn remarks(&self) -> String {
        let least = self.best();
        let most = self.turns.iter().max().copied().unwrap_or_default();
        let spread = format!("{} to {}", micros(least), micros(most));
        match (self.outcome.lost, self.outcome.wrong) {
            (0, 0) => spread,
            (lost, wrong) => format!("{spread}; {lost} lost, {wrong} answered wrongly, {} right", self.outcome.right),
        }
    }
}

pub(crate) fn median(mut turns: Vec<Duration>) -> Duration {
    turns.sort_unstable();
    turns.get(turns.len() / 2).copied().unwrap_or_default()
}

/// Median of a server's figure.
pub(crate) fn of(measured: &[Measured], kind: Kind) -> Option<Duration> {
    measured.iter().find(|measured| measured.kind == kind).map(Measured::median)
}

/// Best turn of a rival, which the goals compare with.
pub(crate) fn best_of(measured: &[Measured], kind: Kind) -> Option<Duration> {
    measured.iter().find(|measured| measured.kind == kind).map(Measured::best)
}

/// Formats a duration as `12.4 µs`.
pub(crate) fn micros(duration: Duration) -> String {
    format!("{:.1} µs", duration.as_secs_f64() * 1e6)
}

/// Formats a duration as `8.5 ms`.
pub(crate) fn millis(duration: Duration) -> String {
    format!("{:.1} ms", duration.as_secs_f64() * 1e3)
}

/// Prints one line per server, with hallsweep's ratio to it.
pub(crate) fn table(measured: &[Measured], written: fn(Duration) -> String) {
    let own = of(measured, Kind::Hallsweep);
    for one in measured {
        let share = own.map_or(String::new(), |own| format!("hallsweep is {:.2} × this", ratio(own, one.median())));
        println!("  {:<13} {:>11}  {share:<25} ({})", one.kind.name(), written(one.median()), one.remarks());
    }
}

/// Prints the figures of one server with few and with many peers.
pub(crate) fn peers(few: &Measured, many: &Measured, memory: &[u64]) {
    let ratio = ratio(many.median(), few.median());
    let memory: Vec<String> = memory.iter().map(|kib| format!("{:.1}", *kib as f64 / 1024.0)).collect();
    println!(
        "  {:<13} {:>10} → {:>10}  {ratio:.2} ×  memory after each turn, in MiB: {}",
        few.kind.name(),
        micros(few.median()),
        micros(many.median()),
        memory.join(", ")
    );
    println!("                few: {}", few.remarks());
    println!("                many: {}", many.remarks());
}

/// Prints a summary of all rounds of one server.
pub(crate) fn fan_out(kind: Kind, last: Duration, rounds: &[Round], cpu: Duration) {
    let complete = rounds.iter().filter(|round| round.heard == OBSERVERS).count();
    let least = rounds.iter().map(|round| round.heard).min().unwrap_or(0);
    println!(
        "  {:<13} p50 {:>9}  complete {complete}/{}  (in the worst round {least} heard; CPU {} a change)",
        kind.name(),
        millis(last),
        rounds.len(),
        millis(cpu)
    );
}

/// Ratio of hallsweep's figure to a rival's, for the goal `what`. When either figure is missing, the function prints
/// that the goal is not judged and returns `None`; a missing hallsweep has already been reported as a failure.
pub(crate) fn share(what: &str, own: Option<Duration>, other: Option<Duration>) -> Option<f64> {
    let share = own.zip(other).map(|(own, other)| ratio(own, other));
    if share.is_none() {
        goals::not_judged(what);
    }
    share
}

/// Load average of the machine.
pub(crate) fn busy() -> String {
    let text = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split(' ').take(3).collect::<Vec<_>>().join(" ")
}

fn ratio(one: Duration, other: Duration) -> f64 {
    one.as_secs_f64() / other.as_secs_f64().max(1e-9)
}
