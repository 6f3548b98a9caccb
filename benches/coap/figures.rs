//! Figures as people read them: medians of turns, ratios to hallsweep's own.

use std::time::Duration;

use crate::fan_out::{OBSERVERS, Round};
use crate::goals;
use crate::load::Outcome;
use crate::server::Kind;

/// One figure of one server, turn by turn.
pub(crate) struct Measured {
    kind: Kind,
    turns: Vec<Duration>,
    outcome: Outcome,
}

impl Measured {
    pub(crate) fn new(kind: Kind) -> Measured {
        Measured { kind, turns: Vec::new(), outcome: Outcome::default() }
    }

    /// One turn more.
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

    /// What went wrong, when anything did, and how far the turns lie apart.
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

/// A server's figure among several.
pub(crate) fn of(measured: &[Measured], kind: Kind) -> Option<Duration> {
    measured.iter().find(|measured| measured.kind == kind).map(Measured::median)
}

/// A rival's best turn: a goal is held against that.
pub(crate) fn best_of(measured: &[Measured], kind: Kind) -> Option<Duration> {
    measured.iter().find(|measured| measured.kind == kind).map(Measured::best)
}

/// As `12.4 µs`.
pub(crate) fn micros(duration: Duration) -> String {
    format!("{:.1} µs", duration.as_secs_f64() * 1e6)
}

/// As `8.5 ms`.
pub(crate) fn millis(duration: Duration) -> String {
    format!("{:.1} ms", duration.as_secs_f64() * 1e3)
}

/// One line a server, with hallsweep's share of it.
pub(crate) fn table(measured: &[Measured], written: fn(Duration) -> String) {
    let own = of(measured, Kind::Hallsweep);
    for one in measured {
        let share = own.map_or(String::new(), |own| format!("hallsweep is {:.2} × this", ratio(own, one.median())));
        println!("  {:<13} {:>11}  {share:<25} ({})", one.kind.name(), written(one.median()), one.remarks());
    }
}

/// Few and many peers of one server.
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

/// All rounds of one server.
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

/// How many times a rival's figure hallsweep's is, for the goal of that name; `None`, with a printed word, when either is not there.
/// Of hallsweep that was said where it was left out.
pub(crate) fn share(what: &str, own: Option<Duration>, other: Option<Duration>) -> Option<f64> {
    let share = own.zip(other).map(|(own, other)| ratio(own, other));
    if share.is_none() {
        goals::not_judged(what);
    }
    share
}

/// How busy the machine is: its load average.
pub(crate) fn busy() -> String {
    let text = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split(' ').take(3).collect::<Vec<_>>().join(" ")
}

fn ratio(one: Duration, other: Duration) -> f64 {
    one.as_secs_f64() / other.as_secs_f64().max(1e-9)
}
