//! Readable figures: medians of turns, with their ranges.

use std::time::Duration;

use crate::goals;
use crate::load::Outcome;
use crate::server::Kind;

/// Results of one server under one load, turn by turn.
pub(crate) struct Measured {
    kind: Kind,
    /// Messages received per second by all subscribers together.
    rates: Vec<f64>,
    cpu: Duration,
    came: u64,
    lost: u64,
    disordered: u64,
    /// Errors that ended turns early.
    failures: Vec<String>,
}

impl Measured {
    pub(crate) fn new(kind: Kind) -> Measured {
        Measured { kind, rates: Vec::new(), cpu: Duration::ZERO, came: 0, lost: 0, disordered: 0, failures: Vec::new() }
    }

    /// Adds a turn and the CPU that the server used in it.
    pub(crate) fn add(&mut self, outcome: std::io::Result<Outcome>, cpu: Duration) {
        match outcome {
            Ok(outcome) => {
                self.rates.push(outcome.came as f64 / outcome.elapsed.as_secs_f64().max(1e-9));
                self.cpu += cpu;
                self.came += outcome.came;
                self.lost += outcome.lost;
                self.disordered += outcome.disordered;
            }
            Err(error) => self.failures.push(error.to_string()),
        }
    }

    /// Whether every message arrived once and in order in every turn.
    pub(crate) fn is_whole(&self) -> bool {
        self.lost == 0 && self.disordered == 0 && self.failures.is_empty() && self.came > 0
    }

    fn line(&self) -> String {
        let least = self.rates.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.rates.iter().copied().fold(0.0, f64::max);
        let each = self.cpu.as_secs_f64() * 1e6 / self.came.max(1) as f64;
        let lost = 100.0 * self.lost as f64 / (self.came + self.lost).max(1) as f64;
        let mut line = format!(
            "  {:<12} {:>9.0}/s  CPU {each:>5.2} µs  lost {lost:>4.1} %  ({least:.0} to {most:.0})",
            self.kind.name(),
            median(&self.rates)
        );
        if self.disordered > 0 {
            line += &format!("; {} out of order", self.disordered);
        }
        self.failures.iter().for_each(|failure| line += &format!("; {failure}"));
        line
    }
}

/// Median of the values; 0 if there are none.
pub(crate) fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    sorted.get(sorted.len() / 2).copied().unwrap_or(0.0)
}

pub(crate) fn table(measured: &[Measured]) {
    measured.iter().for_each(|one| println!("{}", one.line()));
}

pub(crate) fn of(measured: &[Measured], kind: Kind) -> Option<&Measured> {
    measured.iter().find(|one| one.kind == kind)
}

/// Records the goal that hallsweep carries at least `at_least` times the messages per second of a rival.
pub(crate) fn faster(measured: &[Measured], than: Kind, at_least: f64) {
    let what = format!("messages a second, of {}", than.name());
    let (Some(own), Some(other)) = (of(measured, Kind::Hallsweep), of(measured, than)) else {
        return goals::not_judged(&what);
    };
    let ratio = median(&own.rates) / median(&other.rates).max(1e-9);
    goals::met(&format!("{what}: {ratio:.2} (at least {at_least})"), ratio >= at_least);
}

/// Load average of the machine.
pub(crate) fn busy() -> String {
    let text = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split(' ').take(3).collect::<Vec<_>>().join(" ")
}
