//! What a run of the pallet scenario came to, as lines for people and as JSON for programs.

use serde::Serialize;

use crate::api::laboratory::pallet::{rows, words};
use hallsweep_sim::pair::Spread;
use hallsweep_sim::pallet::{Entry, Figures, News, PalletRun};

/// The figures by the names under which programs read them.
#[derive(Serialize)]
struct RunJson {
    parcels: u32,
    seed: u64,
    /// Parcels that are in the target area.
    delivered: usize,
    /// Simulated seconds.
    seconds: f64,
    ticks: u64,
    losses: u32,
    force_n: SpreadJson,
    angle_rad: SpreadJson,
    gap_m: SpreadJson,
    fault: Option<FaultJson>,
    events: Vec<EntryJson>,
}

/// Errors while parcels were off the floor.
#[derive(Serialize)]
struct SpreadJson {
    worst: f64,
    rms: f64,
}

#[derive(Serialize)]
struct FaultJson {
    name: &'static str,
    words: &'static str,
}

#[derive(Serialize)]
struct EntryJson {
    /// Simulated seconds since the run began.
    at: f64,
    parcel: u32,
    /// The number of the phase that begins.
    #[serde(skip_serializing_if = "Option::is_none")]
    phase: Option<usize>,
    words: String,
}

/// One JSON object on one line.
pub(super) fn json(run: &PalletRun, figures: &Figures) -> String {
    let spread = |spread: &Spread| SpreadJson { worst: spread.worst(), rms: spread.rms() };
    let shape = RunJson {
        parcels: figures.parcels,
        seed: figures.seed,
        delivered: figures.delivered,
        seconds: figures.took.as_secs_f64(),
        ticks: figures.ticks,
        losses: figures.losses,
        force_n: spread(&figures.holding.force_n),
        angle_rad: spread(&figures.holding.angle_rad),
        gap_m: spread(&figures.holding.gap_m),
        fault: figures.fault.map(|fault| FaultJson { name: fault.name(), words: fault.in_words() }),
        events: run.entries().iter().map(EntryJson::from).collect(),
    };
    serde_json::to_string(&shape).expect("the figures are finite numbers and strings, which JSON can hold")
}

/// A line for each thing that passed, and one for each figure.
pub(super) fn for_people(run: &PalletRun, figures: &Figures) -> String {
    let passed = run.entries().iter().map(|entry| {
        let at = entry.at.as_secs_f64();
        format!("{at:>8.1} s  parcel {:>2}  {}", entry.parcel, words(entry))
    });
    let rows = rows(figures).map(|(name, value)| format!("{name:<20}{value}"));
    passed.chain([String::new()]).chain(rows).collect::<Vec<_>>().join("\n")
}

impl From<&Entry> for EntryJson {
    fn from(entry: &Entry) -> EntryJson {
        let phase = if let News::Began(phase) = entry.news { Some(phase.number()) } else { None };
        EntryJson { at: entry.at.as_secs_f64(), parcel: entry.parcel, phase, words: words(entry) }
    }
}
