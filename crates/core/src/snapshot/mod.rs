//! A snapshot: the whole state at one revision, immutable and cheap to share. The interfaces show snapshots.

pub mod fact_words;
pub mod log;
pub mod retrieval;
pub mod robot;
pub mod said;
pub mod searched;

use std::collections::BTreeSet;
use std::sync::Arc;
use std::time::Duration;

use self::searched::SearchedHall;
use crate::closing::{Closed, OpenInArea, OpenPoints};
use crate::command::Strategy;
use crate::hall::HallId;
use crate::hold::Hold;
use crate::phase::{FaultCause, PhaseName};
use crate::refused::Refused;
use crate::robot::RobotState;
use crate::snapshot::log::LogLine;
use crate::snapshot::retrieval::RetrievalView;
use crate::snapshot::robot::{RobotShown, RobotView};
use crate::state::{Reach, Venue};
use crate::units::{Cell, Epoch, LuggageId, MissionId, Revision};
use crate::world::alarm::AlarmView;
use crate::world::areas::Area;
use crate::world::coverage::Coverage;
use crate::world::hall_map::HallMap;
use crate::world::keep_out::KeepOut;
use crate::world::luggage::Luggage;
use crate::world::records::LuggageRecords;
use crate::world::resource::Resource;
use crate::world::temperature::TemperatureView;

#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Identifies the run of the program. Revisions of different runs cannot be compared.
    pub run: Arc<str>,
    /// Name of this hall in its addresses; `None` for the default hall, whose addresses name no hall.
    pub hall: Option<HallId>,
    /// Number of changes so far.
    pub revision: Revision,
    /// The revision of the last change of each resource, in the order of `Resource::ALL`.
    pub revisions: [Revision; Resource::COUNT],
    pub mission: MissionView,
    pub robot: RobotView,
    /// All robots, the one that searches first.
    pub robots: Arc<[RobotShown]>,
    /// The map; its tiles are shared with the core.
    pub map: HallMap,
    /// Which cells were looked at, and from where.
    pub coverage: Coverage,
    /// The hall of the mission, its named areas and the sensor.
    pub venue: Venue,
    /// The luggage of this mission, by number.
    pub luggage: LuggageRecords,
    pub temperature: TemperatureView,
    /// All alarms, oldest first.
    pub alarms: Arc<[AlarmView]>,
    /// The retrieval that is under way or in fault, as far as it is recorded.
    pub retrieval: Option<Arc<RetrievalView>>,
    /// The latest lines, oldest first.
    pub log: Arc<[Arc<LogLine>]>,
}

impl Snapshot {
    /// Counts how far the hall and its areas have been searched. The work grows with the number of known cells.
    #[must_use]
    pub fn searched(&self) -> SearchedHall {
        SearchedHall::of(&self.map, &self.coverage, &self.venue)
    }

    #[must_use]
    pub fn revision_of(&self, resource: Resource) -> Revision {
        self.revisions[resource as usize]
    }

    #[must_use]
    pub fn luggage(&self, id: LuggageId) -> Option<&Arc<Luggage>> {
        self.luggage.get(id)
    }

    /// Returns the piece that waits for its verdict: the inspected piece, otherwise the oldest waiting piece.
    #[must_use]
    pub fn pending(&self) -> Option<&Arc<Luggage>> {
        let inspected = self.mission.inspected.and_then(|id| self.luggage(id)).filter(|luggage| luggage.is_pending());
        inspected.or_else(|| self.luggage.pending().next())
    }

    /// Returns why the robots cannot be put down in another hall now, as far as this snapshot shows it; `None` if
    /// they can. `Engine::put_down_in` puts them down.
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
    /// The number of the mission; 0 before the first mission.
    pub id: MissionId,
    pub phase: PhaseName,
    /// The phase that a drive by hand or a fault has interrupted.
    pub interrupted: Option<PhaseName>,
    pub fault: Option<FaultCause>,
    pub holds: Vec<Hold>,
    pub store_failure: Option<String>,
    pub goal: Option<Cell>,
    /// The cells that the robot plans to pass on the way to its goal, the next one first.
    pub route: Arc<[Cell]>,
    /// The cells that the robot has passed, the latest last.
    pub trail: Arc<[Cell]>,
    /// The piece in front of the robot, once it has a number.
    pub inspected: Option<LuggageId>,
    /// Whether the robot goes round this piece, because a judge was unsure.
    pub is_viewing: bool,
    pub strategy: Strategy,
    /// A number that every stop increases.
    pub epoch: Epoch,
    pub progress: Progress,
    /// The searched cells that the robot has to visit once more.
    pub again: Arc<BTreeSet<Cell>>,
    /// The named areas of the hall, in the order of the hall file.
    pub areas: Arc<[AreaView]>,
    pub open: OpenPoints,
    /// Who has closed the mission; `None` while nobody has, and after a robot moves again or another piece is judged.
    pub closed: Option<Arc<Closed>>,
    /// The rings round the bombs in the hall that nobody is fetching.
    pub keep_out: KeepOut,
    /// Whether test pieces stand in the hall.
    pub is_exercise: bool,
    /// Whether no door may show the simulated hall, because an exercise is not over.
    pub is_truth_hidden: bool,
    /// Total of all clock changes since the mission began, in milliseconds.
    pub clock_set_ms: i64,
    pub refusals: Refusals,
}

/// An area of the hall, and what persons have decided about it.
#[derive(Clone, Debug, PartialEq)]
pub struct AreaView {
    pub area: Area,
    /// The place of the area in the order that a person has given, from 1. Areas without a place come after those with
    /// one, in an order that the search chooses.
    pub order: Option<usize>,
    pub closed: Option<Closed<OpenInArea>>,
}

/// The progress of the search. The size of the hall may be unknown until the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Number of visited cells.
    pub visited: usize,
    /// Number of places that can be searched next: unknown cells beside visited ones, and obstacles that are not
    /// inspected yet.
    pub unknown: usize,
    /// Number of such places inside keep-out rings. They are not searched while the rings are there.
    pub kept_out: usize,
    /// The remaining driving time of the search, without the time for photos and for the operator's answers. `None`
    /// while it cannot be estimated, or if nothing is left to search.
    pub left: Option<TimeLeft>,
    /// The known size of the hall; `None` if the hall is not known beforehand.
    pub reach: Option<Reach>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeLeft {
    /// Lower estimate. The remaining time is unlikely to be shorter.
    pub least: Duration,
    /// Upper estimate. The remaining time is unlikely to be longer. `None` while the hall may extend further.
    pub most: Option<Duration>,
}

impl MissionView {
    /// Whether a mission has begun and is not archived. A robot may move by hand, or fail, before the first mission.
    #[must_use]
    pub fn is_under_way(&self) -> bool {
        self.phase != PhaseName::Idle && self.interrupted != Some(PhaseName::Idle)
    }
}

impl Progress {
    /// Returns 100 when nothing is left to search. Before that, it returns `None`, because nobody knows how large the
    /// hall is.
    #[must_use]
    pub const fn percent(self) -> Option<u8> {
        if self.visited > 0 && self.unknown == 0 && self.kept_out == 0 { Some(100) } else { None }
    }
}

/// Why each of the operator's buttons would be refused now; `None` for a button that would be accepted.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Refusals {
    pub start: Option<Refused>,
    pub back_home: Option<Refused>,
    pub go_on: Option<Refused>,
    pub search_again: Option<Refused>,
    pub retrieve: Option<Refused>,
    pub reset: Option<Refused>,
    /// Moves by hand, in any direction.
    pub drive: Option<Refused>,
    pub strategy: Option<Refused>,
    pub retake: Option<Refused>,
}
