//! The view of a past moment, made from the record by the same code as the present view. State that is never recorded
//! is missing: what the sonar saw, and a robot's action, planned way and arm.

use std::sync::Arc;

use super::Engine;
use super::mission::TRAIL;
use super::on_record::OnRecord;
use super::recall::RememberedLine;
use crate::robot::RobotId;
use crate::settings::Settings;
use crate::snapshot::Snapshot;
use crate::state::PersistentState;
use crate::state::fact::{Entry, Fact};
use crate::state::readings::recall;
use crate::units::{Cell, Revision, Seq};
use crate::world::resource::Resource;
use crate::world::temperature::{SourceReading, Thermometer};

#[derive(Clone, Debug, PartialEq)]
pub struct Past {
    /// The number of the last journal entry up to that moment. Every entry has its own snapshot.
    pub seq: Seq,
    /// The state after that entry.
    pub state: PersistentState,
    /// The cells that the searching robot has passed, the latest last.
    pub trail: Vec<Cell>,
    /// Recent entries with temperatures, oldest first.
    pub temperatures: Vec<Entry>,
    /// The latest actions of people and the latest pieces found, oldest first.
    pub latest: Vec<RememberedLine>,
}

/// Returns the cells that the robot has left, the latest last, as many as a snapshot shows. `entries` are the latest
/// entries of the journal, oldest first. Only poses, and facts that begin a new way, are used.
#[must_use]
pub fn way_behind<'a>(entries: impl IntoIterator<Item = &'a Entry>) -> Vec<Cell> {
    let mut cells = vec![Cell::HOME];
    for entry in entries {
        if let Fact::Pose(pose) = &entry.fact {
            if cells.last() != Some(&pose.cell) {
                cells.push(pose.cell);
            }
        } else if matches!(
            &entry.fact,
            Fact::ProgramStarted(_) | Fact::MissionBegan(..) | Fact::MapEmptied(_) | Fact::Strategy(_)
        ) {
            // A new way begins at the cell where the robot stands.
            cells.drain(..cells.len().saturating_sub(1));
        }
    }
    // The last cell is the one where the robot stands, so the robot has not left it. The first cell is assumed to be
    // home, which may be wrong.
    cells.pop();
    if let [first, second, ..] = cells[..]
        && !first.neighbours().contains(&second)
    {
        cells.remove(0);
    }
    cells.split_off(cells.len().saturating_sub(TRAIL))
}

impl Past {
    /// Returns the last reading in these entries. The settings do not change a reading, so the default settings are
    /// used.
    #[must_use]
    pub fn reading(&self) -> Option<SourceReading> {
        let mut thermometer = Thermometer::new(Settings::default().threshold, 0.0);
        recall(&mut thermometer, &self.temperatures);
        thermometer.latest()
    }

    /// Returns the state as the interfaces show it. `others` are the robots that do not search. The threshold
    /// recorded at that time decides what is too hot. If no threshold was recorded, the present one decides.
    #[must_use]
    pub fn snapshot(self, settings: Settings, others: impl IntoIterator<Item = RobotId>) -> Snapshot {
        let Past { seq, state, trail, temperatures, latest } = self;
        let threshold = state.conditions.as_ref().map_or(settings.threshold, |conditions| conditions.threshold);
        let rules = state.conditions.as_ref().map_or(settings.rules, |conditions| conditions.rules);
        let settings = Settings { threshold, rules, ..settings };
        let mut engine = Engine::new(settings, state.strategy, Arc::from("past"));
        let known: Vec<RobotId> = others.into_iter().chain(state.others.keys().chain(state.outside.keys()).cloned()).collect();
        for robot in known {
            if engine.robots.get(&robot).is_none() {
                engine.robots.add(robot, false);
            }
        }
        engine.state = state;
        engine.draw_areas();
        engine.recall_team();
        engine.mission.trail = trail.into();
        recall(&mut engine.world.thermometer, &temperatures);
        for RememberedLine { wall, tone, said } in latest {
            engine.world.log.put(wall, tone, said);
        }
        engine.on_record = OnRecord::of(engine.mission_as_it_is());
        let shown = engine.shown();
        let revision = Revision(seq.0);
        Snapshot { revision, revisions: [revision; Resource::COUNT], ..engine.view(shown) }
    }
}
