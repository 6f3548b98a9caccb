//! The snapshot: the state as the doors show it.

use std::sync::Arc;

use super::Sweep;
use crate::core::explore::plan::cells_along;
use crate::core::mission::{Goal, Hold, Input, Matter, Phase, Stage};
use crate::core::units::Cell;
use crate::core::world::alarm::AlarmView;
use crate::core::world::resource::Resource;
use crate::core::world::robot::{RobotState, RobotView};
use crate::core::world::snapshot::{MissionView, Progress, Refusals, Snapshot};
use crate::core::world::temperature::{TemperatureStatus, TemperatureView};

/// What is shown of the mission and the robot: put together from several parts of the state.
pub(super) struct Shown {
    pub(super) mission: MissionView,
    pub(super) robot: RobotView,
    pub(super) temperature: TemperatureView,
}

impl Sweep {
    pub(super) fn shown(&self) -> Shown {
        let robot = RobotView { state: self.robot_state(), halting: self.helm.is_halting(), ..self.world.robot };
        Shown { mission: self.mission_view(), robot, temperature: self.temperature_view() }
    }

    /// The snapshot; long lists that have not changed since the last one are shared with it.
    pub(super) fn view(&self, shown: Shown) -> Snapshot {
        let revisions = self.world.revisions();
        let same =
            |resource: Resource| self.taken.as_ref().filter(|taken| taken.revision_of(resource) == revisions[resource as usize]);
        let luggage = || self.world.luggage.values().map(Arc::clone).collect();
        Snapshot {
            run: Arc::clone(&self.world.run),
            revision: self.world.revision(),
            revisions,
            mission: shown.mission,
            robot: shown.robot,
            map: self.world.map.clone(),
            luggage: same(Resource::Luggage).map_or_else(luggage, |taken| Arc::clone(&taken.luggage)),
            temperature: shown.temperature,
            alarms: self.world.alarms.iter().map(|alarm| AlarmView::recorded(alarm)).collect(),
            log: same(Resource::Log).map_or_else(|| self.world.log.lines(), |taken| Arc::clone(&taken.log)),
        }
    }

    fn mission_view(&self) -> MissionView {
        let phase = &self.mission.phase;
        MissionView {
            id: self.mission.id,
            phase: phase.name(),
            interrupted: phase.interrupted().map(Phase::name),
            fault: phase.fault().map(ToString::to_string),
            holds: self.mission.holds.to_vec(),
            store_failure: self.world.store_failure.clone(),
            goal: self.goal(),
            route: cells_along(self.world.robot.pose, self.mission.route.iter().copied()).into(),
            trail: self.mission.trail.iter().copied().collect(),
            inspected: self.inspected().filter(|id| self.world.luggage.contains_key(id)),
            strategy: self.mission.strategy,
            epoch: self.mission.epoch,
            progress: self.progress(),
            refusals: self.refusals(),
        }
    }

    /// The cell the robot is after: home on the ways home, the cell of a goto, else the goal of the search.
    fn goal(&self) -> Option<Cell> {
        match &self.mission.phase {
            Phase::ReturningHome | Phase::ReturningWithAlarm => Some(Cell::HOME),
            Phase::Driving { goal, .. } => *goal,
            Phase::Exploring | Phase::Inspecting(_) | Phase::AtHome | Phase::Fault { .. } => self.mission.goal.map(Goal::cell),
            Phase::Idle | Phase::BombLocated | Phase::Retrieving | Phase::BagSecured | Phase::Explored => None,
        }
    }

    fn robot_state(&self) -> RobotState {
        match (self.helm.state(), self.stage()) {
            (RobotState::Stopped, Some(Stage::Recording(_))) => RobotState::SendingPhoto,
            (state, _) => state,
        }
    }

    fn temperature_view(&self) -> TemperatureView {
        let holds = &self.mission.holds;
        let status = if holds.contains(Hold::TooHigh) || holds.contains(Hold::Temperature) {
            TemperatureStatus::TooHigh
        } else if holds.contains(Hold::TemperatureStale) {
            TemperatureStatus::Stale
        } else {
            TemperatureStatus::Ok
        };
        TemperatureView {
            celsius: self.world.thermometer.last(),
            status,
            threshold: self.world.thermometer.threshold(),
            cool: self.world.thermometer.cool(),
            hot: self.world.thermometer.hot(),
        }
    }

    fn progress(&self) -> Progress {
        let visited = self.world.map.visited();
        let unknown = self.world.map.frontier().len() + self.world.map.uninspected();
        Progress { visited, unknown }
    }

    fn refusals(&self) -> Refusals {
        let plain = Matter::default();
        let turn = Matter { step: Some(crate::core::command::Move::TurnLeft), ..Matter::default() };
        let piece = Matter { luggage: self.inspected(), ..Matter::default() };
        Refusals {
            start: self.would_refuse(Input::Start, &plain),
            back_home: self.would_refuse(Input::BackHome, &plain),
            retrieve: self.would_refuse(Input::Retrieve, &plain),
            reset: self.would_refuse(Input::Reset, &plain),
            drive: self.would_refuse(Input::Move, &turn),
            strategy: self.would_refuse(Input::Strategy, &plain),
            retake: self.would_refuse(Input::RetakePhoto, &piece),
        }
    }
}
