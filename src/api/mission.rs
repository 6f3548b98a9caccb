//! The mission in JSON: phase, holds, goal, progress, and the refusal that each button would get.

use schemars::JsonSchema;
use serde::Serialize;

use super::robot::PositionJson;
use super::vocabulary;
use hallsweep_core::command::{Refused, Strategy};
use hallsweep_core::phase::FaultCause;
use hallsweep_core::snapshot::{MissionView, Progress, Refusals, TimeLeft};
use hallsweep_core::units::Revision;

/// Where the mission stands.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct MissionJson {
    /// When it last changed.
    pub revision: u64,
    /// Its number; 0 before the first.
    pub id: u64,
    /// The phase, by its name in the protocol.
    #[schemars(with = "vocabulary::Phase")]
    pub phase: &'static str,
    /// The phase that is interrupted while driving by hand or in fault, or null.
    #[schemars(with = "Option<vocabulary::Phase>")]
    pub interrupted: Option<&'static str>,
    /// Why it is in fault, or null.
    pub fault: Option<String>,
    /// What holds the robot.
    #[schemars(with = "Vec<vocabulary::Hold>")]
    pub holds: Vec<&'static str>,
    /// Why nothing can be recorded just now, in words, or null.
    pub store_failure: Option<String>,
    /// The cell it is on its way to, or null.
    pub goal: Option<PositionJson>,
    /// The cells it means to pass, the next one first.
    pub route: Vec<PositionJson>,
    /// The order of the search.
    #[schemars(with = "vocabulary::StrategyName")]
    pub strategy: &'static str,
    /// Raised by every stop.
    pub epoch: u64,
    /// How far the search has come.
    pub progress: ProgressJson,
    /// For each button the sentence it would be refused with just now, or null.
    pub refusals: RefusalsJson,
}

/// How far the search has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct ProgressJson {
    /// Cells visited.
    pub visited: usize,
    /// What is to be looked at next: unknown cells beside visited ones, and obstacles still to be inspected.
    pub unknown: usize,
    /// 100 when nothing is open, else null: what the hall will come to nobody knows before.
    pub percent: Option<u8>,
    /// How long the search will go on driving, photos and answers left out, or null while nobody can tell.
    pub seconds_left: Option<SecondsLeftJson>,
    /// Free cells that can be reached from here; left out where the hall is not known beforehand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reachable: Option<u32>,
    /// All free cells; left out where the hall is not known beforehand.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub free: Option<u32>,
}

/// How long a search will go on, as a range.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct SecondsLeftJson {
    /// It will hardly be less.
    pub least: u64,
    /// Nor more, or null while the hall may go on.
    pub most: Option<u64>,
}

/// What each button would be refused with; null where it would not be.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct RefusalsJson {
    pub start: Option<String>,
    pub back_home: Option<String>,
    pub retrieve: Option<String>,
    pub reset: Option<String>,
    pub drive: Option<String>,
    pub strategy: Option<String>,
    pub retake: Option<String>,
}

/// The order of the search alone, in the shape in which it is chosen.
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
            refusals: (&mission.refusals).into(),
        }
    }
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
            retrieve: words(&refusals.retrieve),
            reset: words(&refusals.reset),
            drive: words(&refusals.drive),
            strategy: words(&refusals.strategy),
            retake: words(&refusals.retake),
        }
    }
}
