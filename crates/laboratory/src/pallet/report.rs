//! The result of a run of the pallet scenario as JSON. The command line and the page that plays the run use the same
//! text.

use schemars::JsonSchema;
use serde::Serialize;

use super::mishap::{AskedFault, Missed, missed};
use super::record::{Entry, Figures, News, PalletFault};
use super::run::PalletRun;
use super::words::{kind, words};
use hallsweep_sim::pair::Spread;

/// The request, the events and the figures of a run.
#[derive(Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct ReportJson {
    seed: u64,
    parcels: u32,
    /// Requested faults, as they are written in the address.
    faults: Vec<String>,
    /// Requested faults that have not happened.
    not_happened: Vec<NotHappenedJson>,
    /// Simulated time of the run, in seconds.
    seconds: f64,
    events: Vec<EventJson>,
    figures: FiguresJson,
    /// Why not all parcels arrived.
    fault: Option<FaultJson>,
}

#[derive(Serialize, JsonSchema)]
#[schemars(rename = "PalletFaultNotHappened")]
struct NotHappenedJson {
    /// The fault, as in `faults`.
    fault: String,
    /// The reason: `nobodyCalled` or `runEnded`.
    why: &'static str,
    words: &'static str,
}

#[derive(Serialize, JsonSchema)]
#[schemars(rename = "PalletEvent")]
struct EventJson {
    /// Simulated seconds since the run began.
    t: f64,
    /// Number of the current parcel, counted from 1.
    parcel: u32,
    /// `phase`, `alarm`, `acknowledged`, `start` or `lost`.
    kind: &'static str,
    /// Number of the phase that begins, from 1 to 8.
    #[serde(skip_serializing_if = "Option::is_none")]
    phase: Option<usize>,
    words: String,
}

#[derive(Serialize, JsonSchema)]
#[schemars(rename = "PalletFigures")]
#[serde(rename_all = "camelCase")]
struct FiguresJson {
    /// Number of parcels in the target area.
    delivered: usize,
    ticks: u64,
    losses: u32,
    force_n: SpreadJson,
    angle_rad: SpreadJson,
    gap_m: SpreadJson,
}

/// Statistics of the errors of one quantity while the grippers bore a parcel.
#[derive(Serialize, JsonSchema)]
struct SpreadJson {
    worst: f64,
    rms: f64,
}

#[derive(Serialize, JsonSchema)]
#[schemars(rename = "PalletFault")]
struct FaultJson {
    name: &'static str,
    words: &'static str,
}

impl ReportJson {
    pub fn new(run: &PalletRun, figures: &Figures, faults: &[AskedFault]) -> ReportJson {
        ReportJson {
            seed: figures.seed,
            parcels: figures.parcels,
            faults: faults.iter().map(ToString::to_string).collect(),
            not_happened: missed(faults, run).into_iter().map(NotHappenedJson::from).collect(),
            seconds: short(figures.took.as_secs_f64()),
            events: run.entries().iter().map(EventJson::from).collect(),
            figures: FiguresJson::from(figures),
            fault: figures.fault.map(FaultJson::from),
        }
    }
}

impl From<(AskedFault, Missed)> for NotHappenedJson {
    fn from((fault, why): (AskedFault, Missed)) -> NotHappenedJson {
        NotHappenedJson { fault: fault.to_string(), why: why.name(), words: why.in_words() }
    }
}

impl From<&Entry> for EventJson {
    fn from(entry: &Entry) -> EventJson {
        let phase = if let News::Began(phase) = entry.news { Some(phase.number()) } else { None };
        EventJson { t: short(entry.at.as_secs_f64()), parcel: entry.parcel, kind: kind(entry.news), phase, words: words(entry) }
    }
}

impl From<&Figures> for FiguresJson {
    fn from(figures: &Figures) -> FiguresJson {
        FiguresJson {
            delivered: figures.delivered,
            ticks: figures.ticks,
            losses: figures.losses,
            force_n: SpreadJson::from(&figures.holding.force_n),
            angle_rad: SpreadJson::from(&figures.holding.angle_rad),
            gap_m: SpreadJson::from(&figures.holding.gap_m),
        }
    }
}

impl From<&Spread> for SpreadJson {
    fn from(spread: &Spread) -> SpreadJson {
        SpreadJson { worst: short(spread.worst()), rms: short(spread.rms()) }
    }
}

impl From<PalletFault> for FaultJson {
    fn from(fault: PalletFault) -> FaultJson {
        FaultJson { name: fault.name(), words: fault.in_words() }
    }
}

/// Rounds to 0.0001, which is a tenth of a millimetre or of a milliradian. No drawing is finer.
pub(super) fn short(number: f64) -> f64 {
    (number * 1e4).round() / 1e4
}
