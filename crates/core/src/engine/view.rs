//! Makes the snapshot: the state as the interfaces show it. `on_record` delays the parts that must be recorded first.

use std::sync::Arc;
use std::time::Duration;

use super::Engine;
use crate::closing::OpenPoints;
use crate::command::Move;
use crate::engine::robots::Robot;
use crate::hold::Hold;
use crate::mission::{Input, InputContext};
use crate::phase::PhaseName;
use crate::refused::Refused;
use crate::robot::{Part, RobotId, RobotState};
use crate::search::forecast::forecast;
use crate::search::grid::Square;
use crate::search::plan::cells_along;
use crate::snapshot::robot::{RobotShown, RobotView};
use crate::snapshot::{AreaView, MissionView, Progress, Refusals, Snapshot, TimeLeft};
use crate::state::{Phase, Stage};
use crate::units::Cell;
use crate::world::alarm::AlarmView;
use crate::world::areas::Area;
use crate::world::hall_map::{HallMap, Mark};
use crate::world::records::LuggageRecords;
use crate::world::resource::Resource;
use crate::world::temperature::{TemperatureStatus, TemperatureView};

/// The views that combine several parts of the state. `touch_derived` must compare them.
pub(super) struct Shown {
    pub(super) mission: MissionView,
    pub(super) robot: RobotView,
    pub(super) temperature: TemperatureView,
}

impl Engine {
    pub(super) fn shown(&self) -> Shown {
        let led_blinking = self.state.led_blinking && self.on_record.shown.led_blinking;
        let state = self.robot_state();
        let robot = RobotView { state, led_blinking, ..self.view_of(self.robots.searching_id(), self.robots.searching()) };
        let mission = self.mission_view();
        let temperature = self.temperature_view(&mission.holds);
        Shown { mission, robot, temperature }
    }

    fn view_of(&self, id: &RobotId, robot: &Robot) -> RobotView {
        RobotView {
            state: robot.controller.state(),
            halting: robot.controller.is_halting(),
            pose: self.pose_of(id),
            off_centre: robot.off_centre,
            outside: self.steps_outside(id),
            sonar_cm: robot.sonar_cm,
            led_blinking: false,
            unreached_since: robot.unreached_since,
        }
    }

    fn robots_shown(&self, shown: &Shown) -> Arc<[RobotShown]> {
        let robots = self.robots.iter().map(|(id, robot)| {
            let searches = self.searches(id);
            let (view, holds) = if searches {
                (shown.robot, shown.mission.holds.clone())
            } else {
                (self.view_of(id, robot), self.holds_of(robot))
            };
            let parts = robot.controller.capabilities.map(|can| can.parts);
            let arm = parts.filter(|parts| parts.has(Part::Gripper)).map(|_| robot.arm);
            RobotShown { id: id.clone(), view, parts, holds, arm, unreached: robot.unreached.clone() }
        });
        robots.collect()
    }

    /// Returns the holds of a robot that does not search: its own lost link, its own wait for START, and all other
    /// holds of the mission.
    pub(super) fn holds_of(&self, robot: &Robot) -> Vec<Hold> {
        let of_all = |hold: &Hold| !matches!(hold, Hold::RobotLink | Hold::AwaitingStart) && self.state.holds.contains(*hold);
        Hold::ALL.into_iter().filter(|hold| of_all(hold) || robot.holds.contains(*hold)).collect()
    }

    /// Returns the snapshot. Long lists that have not changed are shared with the previous snapshot.
    pub(super) fn view(&self, shown: Shown) -> Snapshot {
        let revisions = self.world.revisions();
        let same =
            |resource: Resource| self.taken.as_ref().filter(|taken| taken.revision_of(resource) == revisions[resource as usize]);
        Snapshot {
            run: Arc::clone(&self.world.run),
            hall: self.world.hall.clone(),
            revision: self.world.revision(),
            revisions,
            robots: self.robots_shown(&shown),
            mission: shown.mission,
            robot: shown.robot,
            map: self.shown_map().clone(),
            coverage: self.on_record.before.as_ref().map_or(&self.state.coverage, |(_, coverage)| coverage).clone(),
            venue: self.state.venue(),
            luggage: self.on_record.shown.luggage.clone(),
            temperature: shown.temperature,
            alarms: same(Resource::Alarms).map_or_else(|| self.alarms_shown(), |taken| Arc::clone(&taken.alarms)),
            retrieval: self.on_record.shown.retrieval.clone(),
            log: same(Resource::Log).map_or_else(|| self.world.log.lines(), |taken| Arc::clone(&taken.log)),
        }
    }

    /// Returns the view of the mission. Results of commands and found pieces are shown only as far as they are
    /// recorded. Warnings and halts are shown at once.
    fn mission_view(&self) -> MissionView {
        let shown = &self.on_record.shown;
        let as_it_is = (shown.mission, shown.phase) == (self.state.mission, self.phase_name());
        let route = if as_it_is { cells_along(self.state.pose, self.mission.route.iter().copied()) } else { Vec::new() };
        // A fault is a warning, so it is shown at once. It interrupts the phase that was shown before.
        let (phase, interrupted, fault) = match self.state.phase.fault() {
            Some(cause) => (PhaseName::Fault, shown.interrupted.or(Some(shown.phase)), Some(cause.clone())),
            None => (shown.phase, shown.interrupted, shown.fault.clone()),
        };
        MissionView {
            id: shown.mission,
            phase,
            interrupted,
            fault,
            holds: self.holds_shown(),
            store_failure: self.world.store_failure.clone(),
            goal: shown.goal,
            route: route.into(),
            trail: self.mission.trail.iter().copied().collect(),
            inspected: shown.inspected,
            is_viewing: shown.is_viewing,
            strategy: shown.strategy,
            epoch: self.state.epoch,
            progress: self.progress(),
            again: Arc::clone(&shown.again),
            areas: self.areas_shown(),
            open: self.open_points(self.shown_map(), &shown.luggage, shown.again.len()),
            closed: shown.closed.clone(),
            keep_out: self.keep_out(),
            is_exercise: self.state.conditions.as_ref().is_some_and(|conditions| conditions.venue.is_exercise),
            is_truth_hidden: self.is_truth_hidden(),
            clock_set_ms: self.state.clock_set_ms,
            refusals: self.refusals_shown(),
        }
    }

    fn areas_shown(&self) -> Arc<[AreaView]> {
        let shown = &self.on_record.shown;
        let view = |area: &Area| AreaView {
            area: area.clone(),
            order: shown.area_order.iter().position(|name| *name == area.name).map(|place| place + 1),
            closed: shown.closed_areas.get(&area.name).cloned(),
        };
        self.state.areas().iter().map(view).collect()
    }

    /// Returns the holds to show. A hold is shown as soon as it is raised. After a command has cleared a hold, the
    /// hold is still shown until the clearing is recorded.
    fn holds_shown(&self) -> Vec<Hold> {
        let by_command = |hold: &Hold| hold.cleared_by_start() || matches!(hold, Hold::TooHigh | Hold::Alarm);
        let stands =
            |hold: &Hold| self.state.holds.contains(*hold) || by_command(hold) && self.on_record.shown.holds.contains(hold);
        Hold::ALL.into_iter().filter(stands).collect()
    }

    fn alarms_shown(&self) -> Arc<[AlarmView]> {
        let unrecorded = self.state.alarms.iter().filter(|alarm| !self.is_on_record(alarm.id));
        let recorded = self.on_record.shown.alarms.iter().map(|alarm| AlarmView::recorded(alarm));
        recorded.chain(unrecorded.map(|alarm| AlarmView::unrecorded(alarm))).collect()
    }

    fn robot_state(&self) -> RobotState {
        match (self.robots.searching().controller.state(), self.stage()) {
            (RobotState::Stopped, Some(Stage::Recording(_))) => RobotState::SendingPhoto,
            (state, _) => state,
        }
    }

    fn temperature_view(&self, holds: &[Hold]) -> TemperatureView {
        let status = if holds.contains(&Hold::TooHigh) || holds.contains(&Hold::Temperature) {
            TemperatureStatus::TooHigh
        } else if holds.contains(&Hold::TemperatureStale) {
            TemperatureStatus::Stale
        } else {
            TemperatureStatus::Ok
        };
        self.world.thermometer.view(status)
    }

    pub(super) fn progress(&self) -> Progress {
        let map = self.shown_map();
        let reach = self.state.conditions.as_ref().and_then(|conditions| conditions.venue.reach);
        let kept_out = self.unsearched_in_rings(map);
        let unknown = map.unsearched() - kept_out - self.unsearched_in_closed_areas(map);
        Progress { visited: map.visited(), unknown, kept_out, left: self.time_left(), reach }
    }

    /// Number of places in closed areas, without those in rings.
    fn unsearched_in_closed_areas(&self, map: &HallMap) -> usize {
        let Some(areas) = self.planner.areas.as_ref().filter(|_| !self.state.closed_areas.is_empty()) else { return 0 };
        let keep_out = self.keep_out();
        unsearched(map).filter(|cell| areas.is_closed(*cell) && !keep_out.contains(*cell)).count()
    }

    pub(super) fn open_points(&self, map: &HallMap, luggage: &LuggageRecords, again: usize) -> OpenPoints {
        let reach = self.state.conditions.as_ref().and_then(|conditions| conditions.venue.reach);
        let kept_out = self.unsearched_in_rings(map);
        OpenPoints {
            pending: luggage.pending().count(),
            bombs: luggage.bombs_left().count(),
            places: map.unsearched() - kept_out,
            kept_out,
            again,
            unvisited: reach.map_or(0, |reach| (reach.reachable as usize).saturating_sub(map.visited())),
            unreachable: reach.map_or(0, |reach| (reach.free - reach.reachable) as usize),
        }
    }

    pub(super) fn unsearched_in_rings(&self, map: &HallMap) -> usize {
        let keep_out = self.keep_out();
        if keep_out.is_empty() { 0 } else { unsearched(map).filter(|cell| keep_out.contains(*cell)).count() }
    }

    /// Returns the remaining time. It is shown during a search, even while something holds or interrupts the search.
    /// The estimate uses everything that is known, recorded or not.
    fn time_left(&self) -> Option<TimeLeft> {
        let searches = matches!(self.state.phase.underlying(), Phase::Exploring | Phase::Inspecting(_));
        if !searches || self.searches_again() {
            return None;
        }
        let grid = &self.planner.grid;
        let a_cell = self.mission.pace.a_cell(grid.census().looked_at())?;
        let map = &self.state.map;
        if map.unsearched() == self.unsearched_in_rings(map) + self.unsearched_in_closed_areas(map) {
            return None;
        }
        let closed = self.state.areas().iter().filter(|area| self.state.closed_areas.contains_key(&area.name));
        let is_left_out = |cell: &Cell| grid.known().contains(*cell) && grid.at(*cell) == Square::Unknown;
        let left_out = closed.flat_map(Area::cells).filter(is_left_out).count();
        let forecast = forecast(grid, self.state.search.strategy(), self.state.pose.cell, a_cell.as_secs_f64(), left_out)?;
        let time = |seconds: f64| Duration::try_from_secs_f64(seconds).ok();
        Some(TimeLeft { least: time(forecast.least)?, most: forecast.most.and_then(time) })
    }

    pub(super) fn refusals(&self) -> Refusals {
        self.each_button(|input, context, _| self.decide(input, context).err().map(|(refused, _)| refused))
    }

    /// Returns the refusals to show. A refusal by holds is shown at once. Any other new refusal is shown as
    /// `NotOnRecord` until its cause is recorded.
    fn refusals_shown(&self) -> Refusals {
        if self.on_record.is_current() {
            return self.on_record.shown.refusals.clone();
        }
        self.each_button(|input, context, shown| match (self.decide(input, context), shown) {
            (Err((refused @ Refused::Held(..), _)), _) => Some(refused),
            (_, Some(refused)) => Some(refused.clone()),
            (Err(_), None) => Some(Refused::NotOnRecord),
            (Ok(_), None) => None,
        })
    }

    /// Calls `why` for each button, and returns the results. `why` also gets the refusal that the button shows.
    fn each_button(&self, why: impl Fn(Input, &InputContext, &Option<Refused>) -> Option<Refused>) -> Refusals {
        let plain = InputContext::default();
        let turn = InputContext { step: Some(Move::TurnLeft), ..InputContext::default() };
        let piece = InputContext { luggage: self.inspected(), ..InputContext::default() };
        let shown = &self.on_record.shown.refusals;
        Refusals {
            start: why(Input::Start, &plain, &shown.start),
            back_home: why(Input::BackHome, &plain, &shown.back_home),
            go_on: why(Input::GoOn, &plain, &shown.go_on),
            search_again: why(Input::SearchAgain, &plain, &shown.search_again),
            retrieve: why(Input::Retrieve, &plain, &shown.retrieve),
            reset: why(Input::Reset, &plain, &shown.reset),
            drive: why(Input::Move, &turn, &shown.drive),
            strategy: why(Input::Strategy, &plain, &shown.strategy),
            retake: why(Input::RetakePhoto, &piece, &shown.retake),
        }
    }
}

/// Returns the places that `HallMap::unsearched` counts.
fn unsearched(map: &HallMap) -> impl Iterator<Item = Cell> {
    let pieces = (map.uninspected() > 0).then(|| map.known().filter(|(_, mark)| *mark == Mark::NotInspected));
    map.frontier().chain(pieces.into_iter().flatten().map(|(cell, _)| cell))
}
