//! Decides what the robot does next. Orders are given one at a time, through one gate (safety S5).

use super::Engine;
use crate::command::Move;
use crate::effect::{Action, Effect, Stamp};
use crate::hold::Hold;
use crate::mission::{Input, InputContext};
use crate::phase::FaultCause;
use crate::place::Place;
use crate::robot::{Part, RobotId};
use crate::search::areas::AreaPlan;
use crate::search::plan::{Through, after};
use crate::search::{Goal, NextGoal, Search};
use crate::settings::Settings;
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::fact::Fact;
use crate::state::{Inspection, PersistentState, Phase, Stage, Venue};
use crate::units::{Cell, Now, OrderId};
use crate::world::hall_map::{Mark, is_in_reach};
use crate::world::keep_out::{KeepOut, Ring, USUAL_CELL_M};
use crate::world::resource::Resource;

/// Maximum number of consecutive decisions that lead to no order. A search that exceeds it has an error: a correct
/// search discards at most as many goals in a row as a large hall has unknown cells.
const TURNS: usize = 100_000;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Barred {
    Unknown,
    /// The robot searches, and takes orders from the mission only.
    Searching,
    NotCapable(Part),
    /// The robot is away from the centre of its cell and must be recentred first.
    OffCentre,
    Held,
    Ending,
    /// A record that must be stored before the order is not stored yet.
    Unrecorded,
    Unlinked,
    /// The robot has not answered its last order.
    Busy,
}

pub(super) enum Turn {
    /// An order was given, or nothing can be done until something happens.
    Rest,
    /// The mission has changed, so the next action must be decided again.
    Again,
}

impl Engine {
    pub(super) fn pump(&mut self) {
        self.draw_rings();
        for _ in 0..TURNS {
            if let Turn::Rest = self.turn() {
                return;
            }
        }
        self.feed(Input::NoWayHome, &InputContext { fault: Some(FaultCause::Undecided), ..InputContext::default() });
    }

    /// Whether a robot may move now. Every motion of a robot passes this gate. A lost link and the wait for START
    /// stop only the robot that they concern. Every other hold stops all robots.
    pub(super) fn may_move(&self, id: &RobotId) -> Result<(), Barred> {
        let Some(robot) = self.robots.get(id) else { return Err(Barred::Unknown) };
        let is_held = if self.searches(id) { !self.state.holds.is_empty() } else { !self.holds_of(robot).is_empty() };
        if is_held {
            Err(Barred::Held)
        } else if self.is_ending {
            Err(Barred::Ending)
        } else if !self.outbox.is_settled() {
            Err(Barred::Unrecorded)
        } else if robot.controller.capabilities.is_none() {
            Err(Barred::Unlinked)
        } else if robot.controller.open().is_some() {
            Err(Barred::Busy)
        } else {
            Ok(())
        }
    }

    /// Orders an action of a robot that does not search, if the gate allows it. The snapshot shows the outcome.
    ///
    /// # Errors
    /// The reason why the action must not be done now. In this case nothing has changed.
    pub fn propose(&mut self, robot: &RobotId, action: Action, now: Now) -> Result<OrderId, Barred> {
        self.begin(now);
        if self.searches(robot) {
            return Err(Barred::Searching);
        }
        self.may_do(robot, action)?;
        Ok(self.order_of(robot, action))
    }

    pub(super) fn may_do(&self, robot: &RobotId, action: Action) -> Result<(), Barred> {
        self.may_move(robot)?;
        let Some(known) = self.robots.get(robot) else { return Err(Barred::Unknown) };
        if known.off_centre && action.moves_base() && action != Action::Recentre {
            return Err(Barred::OffCentre);
        }
        let part = action.part();
        if known.controller.capabilities.is_some_and(|can| can.parts.has(part)) { Ok(()) } else { Err(Barred::NotCapable(part)) }
    }

    pub(super) fn order_of(&mut self, robot: &RobotId, action: Action) -> OrderId {
        let (epoch, now) = (self.state.epoch, self.now.since_start);
        let known = self.robots.get_mut(robot).expect("callers check that the robot exists before they order");
        // If the last order ended without a report, the stored view of the sonar was taken from another place.
        known.ahead = None;
        let order = known.controller.give(action, epoch, now);
        self.outbox.send(Effect::Order(robot.clone(), order));
        self.world.touch(Resource::Robot);
        order.id
    }

    pub(super) fn is_home(&self) -> bool {
        let searching = self.robots.searching();
        self.place_of(self.robots.searching_id()) == Place::Cell(Cell::HOME) && !searching.off_centre
    }

    fn turn(&mut self) -> Turn {
        if self.has_come_home() {
            self.feed(Input::CameHome, &InputContext::default());
            return Turn::Again;
        }
        if self.has_backed_up() {
            self.feed(Input::Done, &InputContext::default());
            return Turn::Again;
        }
        if self.wants_photo() {
            return self.order(Action::Photograph(Stamp { pose: self.state.pose, wall: self.now.wall }));
        }
        if self.may_move(self.robots.searching_id()).is_err() {
            return Turn::Rest;
        }
        let moves = !matches!(
            self.state.phase,
            Phase::Idle | Phase::AtHome | Phase::BombLocated | Phase::BagSecured | Phase::Explored | Phase::Fault { .. }
        );
        if self.robots.searching().off_centre && moves {
            return self.order(Action::Recentre);
        }
        if moves && self.state.phase != Phase::Retrieving && self.steps_outside(self.robots.searching_id()) > 0 {
            return self.order(Action::Enter);
        }
        match self.state.phase {
            Phase::Exploring => self.explore(),
            Phase::ReturningHome | Phase::ReturningWithAlarm => self.go_home(),
            Phase::Driving { goal, next, .. } => self.drive(goal, next),
            Phase::Retrieving => self.retrieve(),
            Phase::Inspecting(Inspection { stage: Stage::Viewing(id), .. }) => self.view_piece(id),
            Phase::Idle
            | Phase::Inspecting(_)
            | Phase::AtHome
            | Phase::BombLocated
            | Phase::BagSecured
            | Phase::Explored
            | Phase::Fault { .. } => Turn::Rest,
        }
    }

    /// Whether the robot has come home. This needs no motion, so it is noticed even while something holds the robot.
    fn has_come_home(&self) -> bool {
        let on_the_way = matches!(self.state.phase, Phase::ReturningHome | Phase::ReturningWithAlarm);
        on_the_way && self.is_home() && self.robots.searching().controller.open().is_none()
    }

    /// Whether the robot has already backed up, although the phase still says that it is backing up. This happens if
    /// the program was killed after the robot had backed up.
    fn has_backed_up(&self) -> bool {
        let robot = self.robots.searching();
        let stands = robot.controller.is_free() && !robot.off_centre;
        stands && matches!(&self.state.phase, Phase::Inspecting(inspection) if inspection.stage == Stage::BackingUp)
    }

    /// Whether a photo must be taken. A photo is no motion, so holds do not prevent it. The exceptions are a lost
    /// link and a store that cannot write.
    fn wants_photo(&self) -> bool {
        let wanted = matches!(self.stage(), Some(Stage::TakingPhoto | Stage::RetakingPhoto(_)));
        let barred = [Hold::RobotLink, Hold::Store].into_iter().any(|hold| self.state.holds.contains(hold));
        wanted && self.robots.searching().controller.is_free() && !barred && !matches!(self.state.phase, Phase::Fault { .. })
    }

    pub(super) fn order(&mut self, action: Action) -> Turn {
        self.order_of(&self.robots.searching_id().clone(), action);
        Turn::Rest
    }

    /// Explores: goes first to a piece without a photo, then to the present goal, then to the goal that the strategy
    /// wants.
    fn explore(&mut self) -> Turn {
        // A robot that goes home may have to pass a ring. There it does not turn back.
        if self.state.goal != Some(Goal::Home)
            && self.planner.keep_out.contains(self.state.pose.cell)
            && let Some(turn) = self.leave_ring()
        {
            return turn;
        }
        if let Some(turn) = self.revisit() {
            return turn;
        }
        let asks = self.mission.has_news && self.state.search.strategy().heeds_news();
        let goal = self.state.goal.filter(|goal| !asks && self.is_wanted(*goal));
        let Some(goal) = goal.or_else(|| self.next_goal_again()).or_else(|| self.next_goal()) else {
            self.feed(Input::AllExplored, &InputContext::default());
            return Turn::Again;
        };
        self.pursue(goal);
        if self.follow_route() {
            return Turn::Rest;
        }
        if goal == Goal::Home {
            self.no_way_home();
        } else {
            self.set_goal(None, self.state.search.clone());
        }
        Turn::Again
    }

    fn is_wanted(&self, goal: Goal) -> bool {
        match goal {
            Goal::Visit(cell) => {
                let is_open = matches!(self.state.map.at(cell), Mark::Unknown | Mark::Seen | Mark::NotInspected);
                (is_open || self.state.again.contains(&cell)) && !self.planner.keep_out.contains(cell)
            }
            Goal::Home => self.state.pose.cell != Cell::HOME,
        }
    }

    pub(super) fn searches_again(&self) -> bool {
        self.state.goal.is_some_and(|goal| self.state.again.contains(&goal.cell()))
    }

    /// Returns the nearest cell that is to be searched again; `None` if no such cell can be reached.
    fn next_goal_again(&mut self) -> Option<Goal> {
        let again = &self.state.again;
        if again.is_empty() {
            return None;
        }
        let (cell, route) = self.planner.way_to_nearest(self.state.pose, |cell| again.contains(&cell))?;
        self.mission.has_news = false;
        self.set_goal(Some(Goal::Visit(cell)), self.state.search.clone());
        self.mission.route = route.into();
        self.state.goal
    }

    /// Asks the strategy until it returns a goal that is not reached already. Returns `None` when the hall is
    /// explored and the robot is home.
    fn next_goal(&mut self) -> Option<Goal> {
        let mut search = self.state.search.clone();
        self.mission.has_news = false;
        let Settings { objective, sonar_cells, .. } = self.settings;
        loop {
            let next = self.planner.ask(&mut search, self.state.pose, self.mission.gait, objective, sonar_cells);
            let (goal, route) = match next {
                NextGoal::Visit(cell, route) => (Goal::Visit(cell), route),
                NextGoal::GoHome => (Goal::Home, Vec::new()),
                NextGoal::Finished if self.is_home() => {
                    self.set_goal(None, search);
                    return None;
                }
                NextGoal::Finished => (Goal::Home, Vec::new()),
            };
            if self.is_wanted(goal) {
                self.set_goal(Some(goal), search);
                self.mission.route = route.into();
                return Some(goal);
            }
        }
    }

    pub(super) fn set_goal(&mut self, goal: Option<Goal>, search: Search) {
        if self.state.goal != goal {
            self.mission.route.clear();
            self.world.touch(Resource::Mission);
            self.record(Fact::Goal(goal, search));
        }
    }

    fn pursue(&mut self, goal: Goal) {
        if !self.mission.route.is_empty() {
            return;
        }
        let way = match goal {
            Goal::Visit(cell) => self.planner.way_to_cell(self.state.pose, cell, Through::Unknown),
            Goal::Home => {
                let around = self.way_home(Through::Known).or_else(|| self.way_home(Through::Unknown));
                around.or_else(|| self.way_home_through_rings())
            }
        };
        self.set_route(way);
    }

    pub(super) fn set_route(&mut self, way: Option<Vec<Move>>) {
        self.mission.route = way.unwrap_or_default().into();
        self.world.touch(Resource::Mission);
    }

    /// Orders the next move of the route. Returns false if there is none.
    pub(super) fn follow_route(&mut self) -> bool {
        let Some(step) = self.mission.route.front().copied() else { return false };
        self.order(Action::Move(step));
        true
    }

    /// Drives back to a piece that was left behind because its photo failed.
    fn revisit(&mut self) -> Option<Turn> {
        let left_behind = self.state.luggage.photoless().next();
        let (id, pose) = left_behind.map(|luggage| (luggage.id, luggage.pose))?;
        if self.state.pose == pose {
            self.feed(Input::AtPiece, &InputContext { luggage: Some(id), ..InputContext::default() });
            return Some(Turn::Again);
        }
        if self.mission.route.is_empty() {
            let way = self.planner.way_to_pose(self.state.pose, pose)?;
            self.set_route(Some(way));
        }
        self.follow_route().then_some(Turn::Rest)
    }

    /// Leaves a keep-out ring over visited cells. Returns `None` if no way leads out.
    fn leave_ring(&mut self) -> Option<Turn> {
        if self.mission.route.is_empty() {
            let is_outside = |cell: Cell| !self.planner.keep_out.contains(cell);
            let way = self.planner.way_through_rings(&self.state.map, self.state.pose, is_outside)?;
            self.set_route(Some(way));
        }
        self.follow_route().then_some(Turn::Rest)
    }

    /// Makes the rings follow the bombs that are known now.
    pub(super) fn draw_rings(&mut self) {
        let keep_out = self.keep_out();
        if self.planner.keep_out != keep_out {
            self.planner.set_keep_out(keep_out, &self.state.map);
            self.mission.route.clear();
            self.mission.has_news = true;
            self.world.touch(Resource::Mission);
        }
    }

    /// Makes the search follow the areas, their order and the closed areas as they are now.
    pub(super) fn draw_areas(&mut self) {
        let PersistentState { area_order, closed_areas, .. } = &self.state;
        let Venue { areas, sensor, .. } = self.state.venue();
        let plan = AreaPlan::new(&areas, area_order, |name| closed_areas.contains_key(name), sensor);
        self.planner.set_areas(plan, &self.state.map);
    }

    /// Returns the rings round all bombs in the hall. A retrieval ignores the ring of the piece that it fetches.
    pub(super) fn keep_out(&self) -> KeepOut {
        let radius_m = self.settings.rules.keep_out_m;
        if radius_m == 0.0 {
            return KeepOut::default();
        }
        let cell_m = self.state.conditions.as_ref().and_then(|conditions| conditions.venue.cell_m);
        let fetched = self.state.retrieval.as_ref().map(|retrieval| retrieval.luggage);
        let bombs = self.state.luggage.bombs_left().filter(|bomb| Some(bomb.id) != fetched);
        let rings = bombs.map(|bomb| Ring { luggage: bomb.id, bomb: self.cells_of(bomb).into_iter().collect() });
        KeepOut::new(rings.collect(), radius_m, cell_m.unwrap_or(USUAL_CELL_M))
    }

    /// Returns the way home through the rings, and says so, because there is no way round them.
    pub(super) fn way_home_through_rings(&mut self) -> Option<Vec<Move>> {
        if self.planner.keep_out.is_empty() {
            return None;
        }
        let way = self.planner.way_through_rings(&self.state.map, self.state.pose, |cell| cell == Cell::HOME)?;
        self.world.write(self.now.wall, Tone::Warning, Said::HomeThroughRings);
        Some(way)
    }

    pub(super) fn knows_way_home(&self) -> bool {
        let through_rings = || self.planner.way_through_rings(&self.state.map, self.state.pose, |cell| cell == Cell::HOME);
        self.planner.knows_way(self.state.pose, Cell::HOME) || !self.planner.keep_out.is_empty() && through_rings().is_some()
    }

    /// Goes home over visited cells only.
    fn go_home(&mut self) -> Turn {
        if self.mission.route.is_empty() {
            let way = self.way_home(Through::Known).or_else(|| self.way_home_through_rings());
            self.set_route(way);
        }
        if !self.follow_route() {
            self.no_way_home();
            return Turn::Again;
        }
        Turn::Rest
    }

    /// Returns the way home; `None` if there is no way, or if something stands in the home cell itself.
    pub(super) fn way_home(&mut self, through: Through) -> Option<Vec<Move>> {
        let free = !self.state.map.at(Cell::HOME).is_obstacle();
        free.then(|| self.planner.way_to_cell(self.state.pose, Cell::HOME, through))?
    }

    fn no_way_home(&mut self) {
        self.feed(Input::NoWayHome, &InputContext { fault: Some(FaultCause::NoWayHome), ..InputContext::default() });
    }

    fn drive(&mut self, goal: Option<Cell>, step: Option<Move>) -> Turn {
        let here = self.state.pose;
        if let Some(step) = step.filter(|_| !std::mem::replace(&mut self.mission.is_driven, true)) {
            let to = after(here, step).cell;
            if is_in_reach(to) {
                return self.order(Action::Move(step));
            }
            self.world.write(self.now.wall, Tone::Warning, Said::NoWay(to));
        }
        let wanted = goal.filter(|goal| here.cell != *goal && !self.state.map.at(*goal).is_obstacle());
        if let Some(goal) = wanted {
            if self.mission.route.is_empty() {
                let way = self.planner.way_to_cell(here, goal, Through::Unknown);
                self.set_route(way);
            }
            if self.follow_route() {
                return Turn::Rest;
            }
            self.world.write(self.now.wall, Tone::Warning, Said::NoWay(goal));
        }
        self.feed(Input::DriveEnded, &InputContext::default());
        Turn::Again
    }
}
