//! The state that is kept when the program ends, and how each fact changes it (safety R1). The same code is used
//! live and when a journal is read back. Only `after_restart` changes the state in another way: some parts must be
//! reported again. The store writes facts and reads them back.

mod conditions;
pub mod fact;
mod phase;
pub(crate) mod readings;
mod retrieval;
mod team;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

pub use self::conditions::{Conditions, Participant, Reach, Venue};
use self::fact::{Entry, Fact};
pub use self::phase::{Inspection, Phase, Stage};
pub use self::readings::Speaking;
pub use self::retrieval::{Retrieval, RetrievalStage};
pub use self::team::{TeamStage, TeamState};
use super::search::Search;
use super::units::{AlarmId, Cell, Celsius, Epoch, LuggageId, MissionId, Pose, Revision, WallTime};
use super::world::alarm::{Alarm, AlarmCause};
use super::world::areas::Area;
use super::world::coverage::Coverage;
use super::world::hall_map::{HallMap, Mark};
use super::world::luggage::{Decision, Doubt, Judgement, Luggage};
use super::world::records::LuggageRecords;
use crate::closing::{Closed, OpenInArea};
use crate::command::{Again, OPERATOR, Strategy};
use crate::hold::{Hold, Holds};
use crate::robot::RobotId;
use crate::search::Goal;
use crate::units::Piece;

/// Number of map cells that need as much space on record as one entry. It is large, because equal cells in a row are
/// written together.
const CELLS_AN_ENTRY: usize = 64;

#[derive(Clone, Debug, PartialEq)]
pub struct PersistentState {
    /// The number of the present mission, or of the last one.
    pub mission: MissionId,
    /// Whether the mission has begun and is not archived yet.
    pub under_way: bool,
    pub phase: Phase,
    pub holds: Holds,
    /// A number that every stop increases.
    pub epoch: Epoch,
    pub strategy: Strategy,
    pub search: Search,
    pub goal: Option<Goal>,
    pub blocked: BTreeSet<Cell>,
    /// The searched cells that the robot has to visit once more. They stay visited, so the way home stays known.
    pub again: Arc<BTreeSet<Cell>>,
    /// The pose of the searching robot at the end of its last completed order.
    pub pose: Pose,
    /// The poses of the other robots that have moved, at the end of their last completed orders.
    pub others: BTreeMap<RobotId, Pose>,
    /// Number of steps from home of each robot that stands outside the entrance.
    pub outside: BTreeMap<RobotId, u8>,
    pub retrieval: Option<Retrieval>,
    pub led_blinking: bool,
    pub map: HallMap,
    pub coverage: Coverage,
    pub pieces: BTreeSet<Piece>,
    /// The cells where a known piece was met again.
    pub met_again: BTreeMap<Cell, Piece>,
    pub luggage: LuggageRecords,
    /// The highest luggage number in all missions so far.
    pub last_luggage: LuggageId,
    /// All alarms, oldest first.
    pub alarms: Vec<Arc<Alarm>>,
    /// The highest alarm number in all missions so far.
    pub last_alarm: AlarmId,
    /// The operator's last reading. It is stored because no thermometer repeats it.
    pub reading: Option<Celsius>,
    /// Who has closed the mission; `None` after a robot moves again or another piece is judged.
    pub closed: Option<Arc<Closed>>,
    /// The names of the areas that a person wants searched first, in this order.
    pub area_order: Arc<[Arc<str>]>,
    /// The areas that were closed, by name. The search leaves out the rest of them.
    pub closed_areas: Arc<BTreeMap<Arc<str>, Closed<OpenInArea>>>,
    /// The place and the threshold of the mission; `None` if no journal has recorded them yet.
    pub conditions: Option<Conditions>,
    /// Total of all clock changes since the mission began, in milliseconds.
    pub clock_set_ms: i64,
}

impl PersistentState {
    /// Maximum number of cells in `again`.
    pub(crate) const MOST_AGAIN: usize = 4096;

    #[must_use]
    pub fn first(strategy: Strategy) -> PersistentState {
        PersistentState {
            mission: MissionId(0),
            under_way: false,
            phase: Phase::Idle,
            holds: Holds::default(),
            epoch: Epoch(0),
            strategy,
            search: strategy.begin(),
            goal: None,
            blocked: BTreeSet::new(),
            again: Arc::default(),
            pose: Pose::START,
            others: BTreeMap::new(),
            outside: BTreeMap::new(),
            retrieval: None,
            led_blinking: false,
            map: HallMap::new(Cell::HOME, Revision(1)),
            coverage: Coverage::default(),
            pieces: BTreeSet::new(),
            met_again: BTreeMap::new(),
            luggage: LuggageRecords::default(),
            last_luggage: LuggageId(0),
            alarms: Vec::new(),
            last_alarm: AlarmId(0),
            reading: None,
            closed: None,
            area_order: Arc::default(),
            closed_areas: Arc::default(),
            conditions: None,
            clock_set_ms: 0,
        }
    }

    /// The place of the mission. Nothing is known of it if no journal has recorded it yet.
    #[must_use]
    pub fn venue(&self) -> Venue {
        self.conditions.as_ref().map_or_else(Venue::default, |conditions| conditions.venue.clone())
    }

    /// Returns the size of a record of the whole state, as the number of entries that need the same space and time.
    /// Only luggage and the map count, because the rest is negligible.
    pub(crate) fn size_in_entries(&self) -> u64 {
        (self.luggage.len() + self.map.visited() / CELLS_AN_ENTRY) as u64
    }

    pub fn apply(&mut self, entry: &Entry) {
        self.follow(&entry.fact, entry.wall, Revision(1));
    }

    /// Applies a fact. Changes of the map get this revision.
    pub(crate) fn follow(&mut self, fact: &Fact, wall: WallTime, revision: Revision) {
        match fact {
            Fact::ProgramStarted(_)
            | Fact::ProgramEnded(_)
            | Fact::Command { .. }
            | Fact::HandedOver { .. }
            | Fact::WrittenOut(_)
            | Fact::Unpacked(_) => {}
            Fact::ClockSet(by) => self.set_clock(*by),
            Fact::State(state) => *self = PersistentState::clone(state),
            Fact::Conditions(conditions) => self.set_conditions(conditions),
            Fact::MissionBegan(mission, strategy) => {
                (self.mission, self.under_way, self.strategy, self.clock_set_ms) = (*mission, true, *strategy, 0);
                self.search_anew();
            }
            Fact::MissionArchived(..) => self.put_away(),
            Fact::Closed(closed) => self.closed = Some(Arc::new(Closed::clone(closed))),
            Fact::SearchAgain(again) => self.search_again(again),
            Fact::AreasOrdered(order) => self.area_order = Arc::clone(order),
            Fact::AreaClosed(name, closed) => self.close_area(name, closed),
            Fact::Phase(phase) => {
                self.phase = phase.clone();
                if phase.is_motion() {
                    self.closed = None;
                }
            }
            Fact::Holds(holds) => self.holds = holds.iter().copied().collect(),
            Fact::Epoch(epoch) => self.epoch = *epoch,
            Fact::Goal(goal, search) => (self.goal, self.search) = (*goal, search.clone()),
            Fact::Pose(pose) => {
                if self.again.contains(&pose.cell) {
                    self.coverage.look(self.pose.cell, pose.cell, wall);
                    self.not_again(pose.cell);
                }
                self.pose = *pose;
                self.look_ahead(wall);
            }
            Fact::Obstacle(cell, _) => self.coverage.look(self.pose.cell, *cell, wall),
            Fact::RobotPose(robot, pose) => drop(self.others.insert(robot.clone(), *pose)),
            Fact::Outside(robot, 0) => drop(self.outside.remove(robot)),
            Fact::Outside(robot, steps) => drop(self.outside.insert(robot.clone(), *steps)),
            Fact::Retrieval(retrieval) => self.retrieval = retrieval.as_deref().cloned(),
            Fact::MetAgain(cell, piece) => drop(self.met_again.insert(*cell, *piece)),
            // The piece is in the container, so nobody can meet it again.
            Fact::Secured(luggage) => self.luggage.change(*luggage, |record| record.secured = Some(wall)),
            Fact::Led(blinking) => self.led_blinking = *blinking,
            Fact::Mark(cell, mark) => {
                // A cell that the robot enters again was looked at when the robot entered it first.
                if mark.is_searched() && self.map.at(*cell) != Mark::Visited {
                    self.coverage.look(self.pose.cell, *cell, wall);
                }
                self.mark(*cell, *mark, revision);
            }
            Fact::Luggage { record, .. } => self.keep(record),
            Fact::Verdict { luggage, verdict, who, note, hot } => {
                let decision = Decision { verdict: *verdict, who: Arc::clone(who), wall, note: note.clone(), hot: *hot };
                self.luggage.change(*luggage, |record| record.verdict = Some(decision));
                self.closed = None;
            }
            Fact::Unsure { luggage, who, note, hot } => {
                let doubt = Doubt { who: Arc::clone(who), wall, note: note.clone(), hot: *hot };
                self.luggage.change(*luggage, |record| record.doubt(doubt));
            }
            Fact::Judged(judgement) => self.luggage.change(judgement.luggage, |record| {
                if !record.judged.contains(judgement) {
                    record.judged.push(Judgement::clone(judgement));
                }
            }),
            Fact::Revealed { luggage, is_test } => self.luggage.change(*luggage, |record| record.truth = Some(*is_test)),
            Fact::Temperature(source, celsius) if **source == *OPERATOR => self.reading = Some(*celsius),
            Fact::Temperature(..) | Fact::ThermometerSilent(_) => {}
            Fact::AlarmRaised(id, luggage, cause) => self.alarm(*id, *luggage, cause, wall),
            Fact::AlarmAcknowledged(id, who) => {
                if let Some(alarm) = self.alarms.iter_mut().find(|alarm| alarm.id == *id) {
                    *alarm = Arc::new(Alarm { acknowledged: Some((Arc::clone(who), wall)), ..Alarm::clone(alarm) });
                }
            }
            Fact::Strategy(strategy) => {
                self.strategy = *strategy;
                self.search_anew();
            }
            Fact::MapEmptied(_) => self.empty_map(revision),
        }
    }

    /// Returns the state after a restart. Holds with an outside cause are cleared until that cause is reported again.
    /// The hold for a lost link is raised, because no robot is linked yet.
    #[must_use]
    pub(crate) fn after_restart(mut self) -> PersistentState {
        for hold in [Hold::Temperature, Hold::TemperatureStale, Hold::Store] {
            self.holds.clear(hold);
        }
        self.holds.raise(Hold::RobotLink);
        self
    }

    /// Ends the mission. Alarms that are not acknowledged stay.
    pub(crate) fn put_away(&mut self) {
        (self.under_way, self.closed, self.again) = (false, None, Arc::default());
        (self.area_order, self.closed_areas) = Default::default();
        self.search_anew();
        self.luggage = LuggageRecords::default();
        self.alarms.retain(|alarm| alarm.acknowledged.is_none());
    }

    fn search_anew(&mut self) {
        (self.search, self.goal) = (self.strategy.begin(), None);
    }

    fn empty_map(&mut self, revision: Revision) {
        self.map = HallMap::new(Cell::HOME, revision);
        self.coverage = Coverage::default();
        self.pieces.clear();
        self.met_again.clear();
        self.blocked.clear();
        self.again = Arc::default();
        self.search_anew();
    }

    /// Returns the searched cells among these, without the cell where the robot stands.
    pub(crate) fn searched_in<'a>(&'a self, again: &Again) -> impl Iterator<Item = Cell> + use<'a> {
        let cells: Box<dyn Iterator<Item = Cell>> = match again {
            Again::Within(bounds) => {
                let bounds = *bounds;
                Box::new(self.map.known().map(|(cell, _)| cell).filter(move |cell| bounds.contains(*cell)))
            }
            Again::Area(name) => Box::new(self.area(name).into_iter().flat_map(Area::cells)),
        };
        cells.filter(|cell| self.map.at(*cell).is_searched() && *cell != self.pose.cell)
    }

    /// Returns the area of this name, if the hall has it.
    #[must_use]
    pub fn area(&self, name: &str) -> Option<&Area> {
        self.areas().iter().find(|area| &*area.name == name)
    }

    pub(crate) fn areas(&self) -> &[Area] {
        self.conditions.as_ref().map_or(&[], |conditions| &conditions.venue.areas)
    }

    fn search_again(&mut self, again: &Again) {
        let cells: BTreeSet<Cell> =
            self.searched_in(again).chain(self.again.iter().copied()).take(Self::MOST_AGAIN + 1).collect();
        // Only an area that is opened may be this large. Its unknown cells are searched, and no cell again.
        if cells.len() <= Self::MOST_AGAIN {
            self.again = Arc::new(cells);
        }
        if let Again::Area(name) = again {
            Arc::make_mut(&mut self.closed_areas).remove(name);
        }
    }

    fn close_area(&mut self, name: &Arc<str>, closed: &Closed<OpenInArea>) {
        let cells = self.area(name).into_iter().flat_map(Area::cells);
        let noted: Vec<Cell> = cells.filter(|cell| self.again.contains(cell)).collect();
        noted.into_iter().for_each(|cell| self.not_again(cell));
        Arc::make_mut(&mut self.closed_areas).insert(Arc::clone(name), closed.clone());
    }

    /// Also forgets what was decided about areas that the present hall does not have.
    fn set_conditions(&mut self, conditions: &Conditions) {
        let is_there = |name: &Arc<str>| conditions.venue.areas.iter().any(|area| area.name == *name);
        self.area_order = self.area_order.iter().filter(|name| is_there(name)).cloned().collect();
        Arc::make_mut(&mut self.closed_areas).retain(|name, _| is_there(name));
        self.conditions = Some(conditions.clone());
    }

    /// Notes that sonar and camera have looked at the known cells ahead, up to the first obstacle.
    fn look_ahead(&mut self, wall: WallTime) {
        let cells = self.conditions.as_ref().map_or(0, |conditions| conditions.venue.sensor.cells);
        for distance in 1..=u16::from(cells) {
            let cell = self.pose.cell.onward(self.pose.heading, distance);
            let mark = self.map.at(cell);
            if mark == Mark::Unknown {
                return;
            }
            self.coverage.look(self.pose.cell, cell, wall);
            if mark.is_obstacle() {
                return;
            }
        }
    }

    fn not_again(&mut self, cell: Cell) {
        if self.again.contains(&cell) {
            Arc::make_mut(&mut self.again).remove(&cell);
        }
    }

    /// Writes a mark on the map. Cells that were visited and are now blocked are noted, because they may be tried
    /// again after a fault.
    fn mark(&mut self, cell: Cell, mark: Mark, revision: Revision) {
        if mark.is_obstacle() {
            self.not_again(cell);
        }
        if self.map.at(cell) == Mark::Visited && mark.is_obstacle() {
            self.blocked.insert(cell);
        } else if mark == Mark::Visited {
            self.blocked.remove(&cell);
        }
        self.map.mark(cell, mark, revision);
    }

    /// Stores a luggage record. If the piece is known already, only its photo is new.
    fn keep(&mut self, record: &Arc<Luggage>) {
        self.pieces.extend(record.piece);
        self.last_luggage = self.last_luggage.max(record.id);
        self.luggage.insert(match self.luggage.get(record.id) {
            Some(known) => Arc::new(known.photographed_again(record)),
            None => Arc::clone(record),
        });
    }

    /// Adjusts recorded times, as if the clock had always been set as it is now.
    fn set_clock(&mut self, by_ms: i64) {
        self.clock_set_ms = self.clock_set_ms.saturating_add(by_ms);
        let waiting: Vec<LuggageId> = self.luggage.iter().filter(|record| record.is_pending()).map(|record| record.id).collect();
        for id in waiting {
            self.luggage.change(id, |record| record.clock_set_ms = record.clock_set_ms.saturating_add(by_ms));
        }
    }

    fn alarm(&mut self, id: AlarmId, luggage: Option<LuggageId>, cause: &AlarmCause, raised: WallTime) {
        self.alarms.push(Arc::new(Alarm { id, raised, cause: cause.clone(), luggage, acknowledged: None }));
        self.last_alarm = self.last_alarm.max(id);
    }
}
