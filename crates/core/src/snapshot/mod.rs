//! The state of everything at one revision, immutable and cheap to share: what the doors show.

pub mod fact_words;
pub mod log;
pub mod retrieval;
pub mod robot;
pub mod said;

use std::sync::Arc;
use std::time::Duration;

use crate::command::Strategy;
use crate::hold::Hold;
use crate::phase::{FaultCause, PhaseName};
use crate::refused::Refused;
use crate::robot::RobotState;
use crate::snapshot::log::LogLine;
use crate::snapshot::retrieval::RetrievalView;
use crate::snapshot::robot::{RobotShown, RobotView};
use crate::state::Reach;
use crate::units::{Cell, Epoch, LuggageId, MissionId, Revision};
use crate::world::alarm::AlarmView;
use crate::world::hall_map::HallMap;
use crate::world::luggage::Luggage;
use crate::world::records::LuggageRecords;
use crate::world::resource::Resource;
use crate::world::temperature::TemperatureView;

#[derive(Clone, Debug)]
pub struct Snapshot {
    /// The run of the program: revisions of another run mean nothing here.
    pub run: Arc<str>,
    /// Number of changes so far.
    pub revision: Revision,
    /// For each resource the revision of its last change, in the order of `Resource::ALL`.
    pub revisions: [Revision; Resource::COUNT],
    pub mission: MissionView,
    pub robot: RobotView,
    /// All robots, the one that searches first.
    pub robots: Arc<[RobotShown]>,
    /// The map; its tiles are shared with the core.
    pub map: HallMap,
    /// The luggage of this mission, by number.
    pub luggage: LuggageRecords,
    pub temperature: TemperatureView,
    /// All alarms, oldest first.
    pub alarms: Arc<[AlarmView]>,
    /// The retrieval under way, or in fault, as far as it is on record.
    pub retrieval: Option<Arc<RetrievalView>>,
    /// The latest lines, oldest first.
    pub log: Arc<[Arc<LogLine>]>,
}

impl Snapshot {
    #[must_use]
    pub fn revision_of(&self, resource: Resource) -> Revision {
        self.revisions[resource as usize]
    }

    #[must_use]
    pub fn luggage(&self, id: LuggageId) -> Option<&Arc<Luggage>> {
        self.luggage.get(id)
    }

    /// The piece that waits for its verdict: the piece being inspected, else the oldest.
    #[must_use]
    pub fn pending(&self) -> Option<&Arc<Luggage>> {
        let inspected = self.mission.inspected.and_then(|id| self.luggage(id)).filter(|luggage| luggage.is_pending());
        inspected.or_else(|| self.luggage.pending().next())
    }

    /// Why the robots cannot be put down in another hall now, as far as that is shown (`Engine::put_down_in`); `None`
    /// when they can.
    #[must_use]
    pub fn bound_to_hall(&self) -> Option<Refused> {
        let is_over = matches!(self.mission.phase, PhaseName::Idle | PhaseName::Explored | PhaseName::BagSecured);
        let stands = |robot: &RobotShown| robot.view.state == RobotState::Stopped && !robot.view.halting;
        if !is_over {
            Some(Refused::NotInPhase(self.mission.phase))
        } else if !self.robots.iter().all(stands) {
            Some(Refused::Moving)
        } else {
            self.mission.holds.contains(&Hold::Store).then_some(Refused::StoreDown)
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct MissionView {
    /// 0 before the first.
    pub id: MissionId,
    pub phase: PhaseName,
    /// The phase that is interrupted by a drive by hand or a fault.
    pub interrupted: Option<PhaseName>,
    pub fault: Option<FaultCause>,
    pub holds: Vec<Hold>,
    pub store_failure: Option<String>,
    pub goal: Option<Cell>,
    /// The cells that the robot plans to pass on the way to its goal, the next one first.
    pub route: Arc<[Cell]>,
    /// The cells that the robot came through, the latest last.
    pub trail: Arc<[Cell]>,
    /// The piece in front of the robot, once it has a number.
    pub inspected: Option<LuggageId>,
    pub strategy: Strategy,
    /// The epoch, raised by every stop.
    pub epoch: Epoch,
    pub progress: Progress,
    /// Number of milliseconds by which the clock was set since the mission began.
    pub clock_set_ms: i64,
    pub refusals: Refusals,
}

/// The progress of the search. Nobody knows before the end how large the hall is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Number of visited cells.
    pub visited: usize,
    /// Number of places that can be looked at next: unknown cells beside visited ones, and obstacles still to be
    /// inspected.
    pub unknown: usize,
    /// The remaining driving time of the search, without photos and answers; `None` while it cannot be estimated, or
    /// nothing is open.
    pub left: Option<TimeLeft>,
    /// `None` where the hall is not known beforehand.
    pub reach: Option<Reach>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeLeft {
    /// The remaining time will hardly be shorter.
    pub least: Duration,
    /// The remaining time will hardly be longer; `None` while the hall may go on.
    pub most: Option<Duration>,
}

impl Progress {
    /// How much of the hall is searched: 100 when nothing is open. `None` before that, because nobody knows how large
    /// the hall is.
    #[must_use]
    pub const fn percent(self) -> Option<u8> {
        if self.visited > 0 && self.unknown == 0 { Some(100) } else { None }
    }
}

/// Why each of the operator's buttons would be refused now; `None` for a button that would be accepted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Refusals {
    pub start: Option<Refused>,
    pub back_home: Option<Refused>,
    pub retrieve: Option<Refused>,
    pub reset: Option<Refused>,
    /// Moves by hand, in any direction.
    pub drive: Option<Refused>,
    pub strategy: Option<Refused>,
    pub retake: Option<Refused>,
}
