//! The mission in JSON: phase, holds, goal, progress, and the refusal that each button would get.

use schemars::JsonSchema;
use serde::Serialize;

use super::journal::{OpenInAreaShape, OpenShape};
use super::robot::PositionJson;
use super::time::rfc3339;
use super::{is_default, vocabulary};
use hallsweep_core::closing::Closed;
use hallsweep_core::command::Strategy;
use hallsweep_core::phase::FaultCause;
use hallsweep_core::refused::Refused;
use hallsweep_core::snapshot::{AreaView, MissionView, Progress, Refusals, TimeLeft};
use hallsweep_core::units::Revision;
use hallsweep_core::world::keep_out::{KeepOut, Ring};

/// State of the mission.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct MissionJson {
    /// Revision at which the mission last changed.
    pub revision: u64,
    /// Number of the mission; 0 before the first mission.
    pub id: u64,
    /// Phase of the mission.
    #[schemars(with = "vocabulary::Phase")]
    pub phase: &'static str,
    /// Phase that is interrupted by driving by hand or by a fault, or null.
    #[schemars(with = "Option<vocabulary::Phase>")]
    pub interrupted: Option<&'static str>,
    /// Cause of the fault, or null.
    pub fault: Option<String>,
    /// Reasons why the robot must not move.
    #[schemars(with = "Vec<vocabulary::Hold>")]
    pub holds: Vec<&'static str>,
    /// Reason why nothing can be recorded now, in words, or null.
    pub store_failure: Option<String>,
    /// Cell to which the robot is driving, or null.
    pub goal: Option<PositionJson>,
    /// Planned cells, beginning with the next cell.
    pub route: Vec<PositionJson>,
    /// Search strategy.
    #[schemars(with = "vocabulary::StrategyName")]
    pub strategy: &'static str,
    /// Epoch: a number that every stop raises.
    pub epoch: u64,
    /// Progress of the search.
    pub progress: ProgressJson,
    /// Keep-out rings round the bombs in the hall that nobody is fetching; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub keep_out: Vec<RingJson>,
    /// Number of searched cells that the robot has to visit once more; absent if there are none.
    #[serde(skip_serializing_if = "is_default")]
    pub search_again: usize,
    /// Whether this is an exercise with test pieces; absent otherwise.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub exercise: bool,
    /// Statement with which the mission was closed; absent if it is not closed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub closed: Option<ClosedJson>,
    /// Named areas of the hall, in the order of the hall file; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub areas: Vec<AreaJson>,
    /// For each button, the sentence that says why the button would be refused now, or null.
    pub refusals: RefusalsJson,
}

/// Named area of the hall.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "Area")]
pub struct AreaJson {
    pub name: String,
    /// Probability that the bomb is in this area, from 0 to 1.
    pub probability: f64,
    /// Two opposite corners of a rectangle, or the corners of a polygon in order. Corners are cells of the area.
    pub corners: Vec<PositionJson>,
    /// Place in the order that a person has given, from 1; null if the area comes after those with a place.
    pub order: Option<usize>,
    /// Statement with which the area was closed, or null.
    pub closed: Option<ClosedAreaJson>,
}

/// Statement of the person in charge that the search of an area is over.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ClosedAreaJson {
    /// Name of the person in charge.
    pub name: String,
    /// Name of the key, with the person's name in brackets if it is known.
    pub by: String,
    /// Time, RFC 3339 with zone.
    pub at: String,
    /// Remark, or null.
    pub note: Option<String>,
    /// What was left open.
    pub open: OpenInAreaShape,
}

impl From<&AreaView> for AreaJson {
    fn from(AreaView { area, order, closed }: &AreaView) -> AreaJson {
        let corners = area.corners.iter().copied().map(PositionJson::from).collect();
        let closed = closed.as_ref().map(|Closed { who, name, note, open, wall }| ClosedAreaJson {
            name: name.text().to_owned(),
            by: who.to_string(),
            at: rfc3339(*wall),
            note: note.as_ref().map(|note| note.text().to_owned()),
            open: (*open).into(),
        });
        AreaJson { name: area.name.to_string(), probability: area.probability, corners, order: *order, closed }
    }
}

/// Statement of the person in charge that the search is over.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ClosedJson {
    /// Name of the person in charge.
    pub name: String,
    /// Name of the key, with the person's name in brackets if it is known.
    pub by: String,
    /// Time, RFC 3339 with zone.
    pub at: String,
    /// Remark, or null.
    pub note: Option<String>,
    /// What was left open.
    pub open: OpenShape,
}

impl From<&Closed> for ClosedJson {
    fn from(Closed { who, name, note, open, wall }: &Closed) -> ClosedJson {
        ClosedJson {
            name: name.text().to_owned(),
            by: who.to_string(),
            at: rfc3339(*wall),
            note: note.as_ref().map(|note| note.text().to_owned()),
            open: (*open).into(),
        }
    }
}

/// Keep-out ring: the cells round a bomb that no robot enters by itself.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RingJson {
    /// Number of the dangerous piece.
    pub luggage: u64,
    /// Known cells of the piece.
    pub cells: Vec<PositionJson>,
    /// Radius round each of these cells, in cells, from middle to middle.
    pub radius: f64,
}

/// Progress of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct ProgressJson {
    /// Number of visited cells.
    pub visited: usize,
    /// Number of open places: unknown cells beside visited cells, and obstacles still to be inspected.
    pub unknown: usize,
    /// Number of open places inside keep-out rings, which are not in `unknown`; absent if there are no such places.
    #[serde(skip_serializing_if = "is_default")]
    pub kept_out: usize,
    /// 100 when no place is open any more. Null until then, because the size of the hall is not known yet.
    pub percent: Option<u8>,
    /// Remaining driving time of the search, without the time for photos and verdicts; null while there is no
    /// estimate.
    pub seconds_left: Option<SecondsLeftJson>,
    /// Number of free cells that can be reached from the start; absent if the hall is not known beforehand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reachable: Option<u32>,
    /// Number of all free cells; absent if the hall is not known beforehand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free: Option<u32>,
}

/// Estimate of the remaining time of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct SecondsLeftJson {
    /// Shortest likely time, in seconds.
    pub least: u64,
    /// Longest likely time, in seconds; null while the hall may extend further.
    pub most: Option<u64>,
}

/// For each button, the sentence that says why the button would be refused now; null for a button that would be
/// accepted.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct RefusalsJson {
    pub start: Option<String>,
    pub back_home: Option<String>,
    pub go_on: Option<String>,
    pub search_again: Option<String>,
    pub retrieve: Option<String>,
    pub reset: Option<String>,
    pub drive: Option<String>,
    pub strategy: Option<String>,
    pub retake: Option<String>,
}

/// Search strategy.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct StrategyJson {
    #[schemars(with = "vocabulary::StrategyName")]
    pub name: &'static str,
}

impl From<Strategy> for StrategyJson {
    fn from(strategy: Strategy) -> StrategyJson {
        StrategyJson { name: strategy.name() }
    }
}

impl MissionJson {
    pub fn new(mission: &MissionView, revision: Revision) -> MissionJson {
        MissionJson {
            revision: revision.0,
            id: mission.id.0,
            phase: mission.phase.name(),
            interrupted: mission.interrupted.map(|phase| phase.name()),
            fault: mission.fault.as_ref().map(FaultCause::to_string),
            holds: mission.holds.iter().map(|hold| hold.name()).collect(),
            store_failure: mission.store_failure.clone(),
            goal: mission.goal.map(PositionJson::from),
            route: mission.route.iter().copied().map(PositionJson::from).collect(),
            strategy: mission.strategy.name(),
            epoch: mission.epoch.0,
            progress: mission.progress.into(),
            search_again: mission.again.len(),
            exercise: mission.is_exercise,
            closed: mission.closed.as_deref().map(ClosedJson::from),
            keep_out: rings(&mission.keep_out),
            areas: mission.areas.iter().map(AreaJson::from).collect(),
            refusals: (&mission.refusals).into(),
        }
    }
}

fn rings(keep_out: &KeepOut) -> Vec<RingJson> {
    let radius = (keep_out.radius() * 100.0).round() / 100.0;
    let ring = |ring: &Ring| RingJson {
        luggage: ring.luggage.0,
        cells: ring.bomb.iter().copied().map(PositionJson::from).collect(),
        radius,
    };
    keep_out.rings().iter().map(ring).collect()
}

impl From<Progress> for ProgressJson {
    fn from(progress: Progress) -> ProgressJson {
        let seconds_left = |left: TimeLeft| SecondsLeftJson {
            least: left.least.as_secs(),
            // Rounded up, because it is an upper bound.
            most: left.most.map(|most| most.as_secs().saturating_add(1)),
        };
        ProgressJson {
            visited: progress.visited,
            unknown: progress.unknown,
            kept_out: progress.kept_out,
            percent: progress.percent(),
            seconds_left: progress.left.map(seconds_left),
            reachable: progress.reach.map(|reach| reach.reachable),
            free: progress.reach.map(|reach| reach.free),
        }
    }
}

impl From<&Refusals> for RefusalsJson {
    fn from(refusals: &Refusals) -> RefusalsJson {
        let words = |refused: &Option<Refused>| refused.as_ref().map(Refused::to_string);
        RefusalsJson {
            start: words(&refusals.start),
            back_home: words(&refusals.back_home),
            go_on: words(&refusals.go_on),
            search_again: words(&refusals.search_again),
            retrieve: words(&refusals.retrieve),
            reset: words(&refusals.reset),
            drive: words(&refusals.drive),
            strategy: words(&refusals.strategy),
            retake: words(&refusals.retake),
        }
    }
}
