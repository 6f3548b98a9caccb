//! Handles the robots' reports. A report first changes the world, and is then passed to the mission.

use std::sync::Arc;

use super::Engine;
use crate::arm::{ArmAction, ArmState};
use crate::command::{Move, ROBOT};
use crate::effect::{Action, Order};
use crate::event::{Capabilities, Obstacle, OffCentre, RobotEvent, Whereabouts};
use crate::hold::{Hold, HoldReason};
use crate::mission::{Input, InputContext};
use crate::phase::FaultCause;
use crate::place::Place;
use crate::robot::{Part, RobotId};
use crate::search::costs::Costs;
use crate::search::plan::after;
use crate::snapshot::log::Tone;
use crate::snapshot::said::{Said, Trouble};
use crate::state::fact::Fact;
use crate::state::{Phase, Stage};
use crate::units::{Cell, Heading, OrderId, Pose};
use crate::world::hall_map::{Mark, is_in_reach};
use crate::world::resource::Resource;

impl Engine {
    pub(super) fn report(&mut self, robot: &RobotId, report: RobotEvent) {
        if self.robots.get(robot).is_none() {
            return;
        }
        match report {
            RobotEvent::Stands(whereabouts) => self.stands(robot, whereabouts),
            RobotEvent::StandsOutside(steps, heading, off_centre) => {
                self.stands_outside(robot, steps, heading, off_centre);
            }
            RobotEvent::Arm(arm) => self.arm_reported(robot, arm),
            RobotEvent::ParcelLost(parcel) => self.parcel_lost(robot, parcel),
            RobotEvent::Found(id, parcel) => self.found(robot, id, parcel),
            RobotEvent::LinkUp(can) => self.link_up(robot, can),
            RobotEvent::LinkLost(words) => self.link_lost(robot, words),
            RobotEvent::Paused => {
                if let Some(robot) = self.robots.get_mut(robot) {
                    robot.controller.pause();
                }
            }
            RobotEvent::Done(id) => self.done(robot, id),
            RobotEvent::Blocked(id, obstacle) => self.blocked(robot, id, obstacle),
            RobotEvent::Halted(id, off_centre) => {
                if self.close(robot, id).is_some() && off_centre {
                    self.set_off_centre(robot, true);
                }
            }
            RobotEvent::Photo(id, photo) => {
                if self.close(robot, id).is_some() && self.searches(robot) {
                    self.feed(Input::PhotoTaken, &InputContext { photo: Some(photo), ..InputContext::default() });
                }
            }
            RobotEvent::PhotoFailed(id, words) => {
                if self.close(robot, id).is_some() {
                    self.say_photo_failed(robot, words);
                }
            }
            RobotEvent::Failed(id, words) => self.failed(robot, id, words),
            RobotEvent::Sonar(cm) => self.sonar(robot, cm),
            RobotEvent::Ahead(ahead) => {
                if let Some(robot) = self.robots.get_mut(robot) {
                    robot.ahead = Some(ahead);
                }
            }
            RobotEvent::Temperature(celsius) => {
                self.read_temperature(&Arc::from(self.thermometer_of(robot)), celsius);
            }
        }
    }

    pub(super) fn searches(&self, robot: &RobotId) -> bool {
        self.robots.searching_id() == robot
    }

    /// Returns the robot's name as a source of readings. No sensor can have this name, because the name is `ROBOT` or
    /// contains a blank.
    fn thermometer_of(&self, robot: &RobotId) -> String {
        if self.searches(robot) { ROBOT.to_owned() } else { format!("{ROBOT} {robot}") }
    }

    pub(super) fn pose_of(&self, robot: &RobotId) -> Pose {
        if self.searches(robot) { self.state.pose } else { self.state.others.get(robot).copied().unwrap_or(Pose::START) }
    }

    fn set_off_centre(&mut self, robot: &RobotId, off_centre: OffCentre) {
        if let Some(robot) = self.robots.get_mut(robot) {
            robot.off_centre = off_centre;
        }
    }

    fn record_pose(&mut self, robot: &RobotId, pose: Pose) {
        let fact = if self.searches(robot) { Fact::Pose(pose) } else { Fact::RobotPose(robot.clone(), pose) };
        self.record(fact);
    }

    /// Takes the robot's report of its place. The report replaces the recorded place, because the robot may have
    /// ended a move that is not recorded (safety R2).
    fn stands(&mut self, robot: &RobotId, Whereabouts { pose, off_centre }: Whereabouts) {
        if !is_in_reach(pose.cell) {
            return self.went_too_far(robot, pose.cell);
        }
        self.note_outside(robot, 0);
        let is_elsewhere = self.pose_of(robot) != pose;
        if !is_elsewhere && self.robots.get(robot).is_some_and(|robot| robot.off_centre == off_centre) {
            return;
        }
        self.set_off_centre(robot, off_centre);
        self.world.touch(Resource::Robot);
        if !is_elsewhere {
            return;
        }
        let who = (!self.searches(robot)).then(|| robot.clone());
        self.world.write(self.now.wall, Tone::Info, Said::Stands(who, pose));
        if self.searches(robot) {
            self.mission.route.clear();
            self.mark(pose.cell, Mark::Visited);
            self.record_pose(robot, pose);
            self.leave_inspection();
        } else {
            self.record_pose(robot, pose);
        }
    }

    /// Takes the robot's report of its place outside the entrance. This report, too, replaces the recorded place.
    fn stands_outside(&mut self, robot: &RobotId, steps: u8, heading: Heading, off_centre: OffCentre) {
        self.set_off_centre(robot, off_centre);
        self.world.touch(Resource::Robot);
        self.note_outside(robot, steps.clamp(1, Place::FURTHEST));
        let pose = Pose { cell: Cell::HOME, heading };
        if self.pose_of(robot) != pose {
            self.record_pose(robot, pose);
        }
    }

    fn note_outside(&mut self, robot: &RobotId, steps: u8) {
        if self.steps_outside(robot) != steps {
            self.record(Fact::Outside(robot.clone(), steps));
        }
    }

    fn passed(&mut self, robot: &RobotId, action: Action) {
        self.set_off_centre(robot, false);
        let steps = self.steps_outside(robot);
        let steps = if action == Action::Leave { (steps + 1).min(Place::FURTHEST) } else { steps.saturating_sub(1) };
        self.note_outside(robot, steps);
    }

    /// Ends the inspection. A robot that was carried away from the piece cannot take a photo of it. A piece without a
    /// record stays a target of the search. A piece with a record keeps the photo that it has.
    fn leave_inspection(&mut self) {
        match self.stage() {
            Some(Stage::BackingUp | Stage::TakingPhoto) => {
                let mut phase = self.state.phase.clone();
                *phase.underlying_mut() = Phase::Exploring;
                self.note_phase(phase);
            }
            Some(Stage::RetakingPhoto(id)) => {
                // The photo of a view is taken from another place than the photo before. The robot drives back there.
                let place = self.state.phase.inspection().map(|inspection| inspection.pose);
                let is_view = self.state.luggage.get(id).is_some_and(|piece| Some(piece.pose) != place);
                if is_view { self.set_stage(Stage::Viewing(id)) } else { self.end_photo(id) }
            }
            Some(Stage::Recording(_) | Stage::AwaitingVerdict(_) | Stage::Viewing(_)) | None => {}
        }
    }

    fn link_up(&mut self, robot: &RobotId, can: Capabilities) {
        if !can.parts.has(Part::Thermometer) {
            self.fall_silent(&self.thermometer_of(robot));
            if self.world.thermometer.retire(&self.thermometer_of(robot)) {
                self.world.touch(Resource::Temperature);
                self.write_trouble(Tone::Warning, robot, Trouble::NoThermometer);
            }
        }
        let now = self.now.since_start;
        let Some(known) = self.robots.get_mut(robot) else { return };
        known.controller.link_up(can, now);
        (known.unreached, known.unreached_since) = (None, None);
        if self.robots.searching_id() == robot {
            self.planner.costs = self.settings.costs.unwrap_or_else(|| Costs::of(can.step, can.turn));
        }
        let Some(known) = self.robots.get_mut(robot) else { return };
        known.holds.clear(Hold::RobotLink);
        self.world.touch(Resource::Robot);
        // A retrieval needs all of its robots.
        let needed = self.searches(robot) || self.is_fetching(robot);
        let missing = self.state.retrieval.is_some() && self.unreached().is_some();
        if needed && !missing {
            self.feed(Input::LinkUp, &InputContext::default());
        }
    }

    /// Handles the loss of a link. The robot halts by itself, and its exact place is unknown until it is recentred.
    /// The other robots continue.
    pub(super) fn link_lost(&mut self, robot: &RobotId, words: String) {
        let (searches, now) = (self.searches(robot), self.now.wall);
        self.fall_silent(&self.thermometer_of(robot));
        let Some(known) = self.robots.get_mut(robot) else { return };
        known.off_centre |= known.controller.lose();
        known.unreached_since.get_or_insert(now);
        known.arm_is_heard = false;
        known.unreached = Some(Arc::from(&*words));
        self.world.touch(Resource::Robot);
        let fetches = self.is_fetching(robot);
        let Some(known) = self.robots.get_mut(robot) else { return };
        if fetches {
            known.holds.raise(Hold::RobotLink);
        }
        if searches || fetches {
            let why = if searches { words.clone() } else { format!("{robot}: {words}") };
            if self.state.holds.contains(Hold::RobotLink) {
                // The hold is known already, but the reason may be new.
                self.write_trouble(Tone::Warning, robot, Trouble::StillUnreached(words));
            }
            self.feed(Input::LinkLost, &InputContext { why: Some(HoldReason::Words(why)), ..InputContext::default() });
        } else if known.holds.raise(Hold::RobotLink) {
            if self.state.phase.is_mission() {
                known.holds.raise(Hold::AwaitingStart);
            }
            self.write_trouble(Tone::Warning, robot, Trouble::Unreached(words));
        }
    }

    pub(super) fn close(&mut self, robot: &RobotId, id: OrderId) -> Option<Order> {
        let order = self.robots.get_mut(robot)?.controller.close(id)?;
        self.wake_team();
        self.world.touch(Resource::Robot);
        Some(order)
    }

    fn done(&mut self, robot: &RobotId, id: OrderId) {
        let Some(order) = self.close(robot, id) else { return };
        if let Some(robot) = self.robots.get_mut(robot) {
            // If the hook has closed without a piece, the order has failed.
            let is_empty = order.action == Action::Arm(ArmAction::CloseGripper) && robot.arm == ArmState::default();
            robot.failures = if is_empty { robot.failures.saturating_add(1) } else { 0 };
        }
        match order.action {
            Action::Move(step) => self.moved(robot, step),
            Action::Recentre => self.set_off_centre(robot, false),
            Action::Enter | Action::Leave => self.passed(robot, order.action),
            Action::Photograph(_) | Action::Arm(_) => {}
        }
        if self.searches(robot) {
            self.feed(Input::Done, &InputContext::default());
            self.look_ahead();
        }
    }

    /// Handles the report of a place that is too far away. Such a cell is not stored, so the recorded place of the
    /// robot stays the same.
    fn went_too_far(&mut self, robot: &RobotId, cell: Cell) {
        let said = Said::Robot(robot.clone(), Trouble::TooFar(cell));
        if self.searches(robot) {
            self.robot_failed(said.to_string());
        } else {
            self.world.write(self.now.wall, Tone::Alarm, said);
        }
    }

    /// Handles the end of a move, even if the robot reports it late. The robot now stands at the end of the move, and
    /// is no longer off centre.
    pub(super) fn moved(&mut self, robot: &RobotId, step: Move) {
        self.set_off_centre(robot, false);
        let before = self.pose_of(robot);
        let pose = after(before, step);
        if !is_in_reach(pose.cell) {
            return self.went_too_far(robot, pose.cell);
        }
        if self.searches(robot) {
            self.follow_move(step, before, pose);
        } else if self.is_fetching(robot) && self.state.map.at(pose.cell) != Mark::Visited {
            self.mark(pose.cell, Mark::Visited);
        }
        self.record_pose(robot, pose);
    }

    fn follow_move(&mut self, step: Move, before: Pose, pose: Pose) {
        self.mission.gait = self.mission.gait.after(step);
        if self.mission.route.front() == Some(&step) {
            self.mission.route.pop_front();
            self.world.touch(Resource::Mission);
        } else {
            self.mission.route.clear();
        }
        if pose.cell != before.cell {
            self.mission.leave(before.cell);
            if self.state.map.at(pose.cell) != Mark::Visited {
                self.mark(pose.cell, Mark::Visited);
            }
        }
        self.count(step);
    }

    fn count(&mut self, step: Move) {
        let Some(can) = self.robots.searching().controller.capabilities else { return };
        // Cells that are searched again bring no new cell, so they say nothing about the rest of the search.
        if matches!(self.state.phase, Phase::Exploring) && !self.searches_again() {
            let took = can.time(step);
            self.mission.pace.count(took, self.planner.grid.census().looked_at());
        }
    }

    /// Handles an obstacle in the cell that was to be entered. The robot stands against it until it is recentred.
    fn blocked(&mut self, robot: &RobotId, id: OrderId, obstacle: Obstacle) {
        let Some(order) = self.close(robot, id) else { return };
        self.set_off_centre(robot, true);
        let pose = self.pose_of(robot);
        let cell = match order.action {
            Action::Move(step @ (Move::Forward | Move::Backward)) => Some(after(pose, step).cell),
            Action::Move(_) | Action::Recentre | Action::Photograph(_) | Action::Enter | Action::Leave | Action::Arm(_) => None,
        };
        let obstacle = if self.settings.inspect_everything { Obstacle::Unknown } else { obstacle };
        if !self.searches(robot) {
            self.write_trouble(Tone::Warning, robot, Trouble::MetObstacle(pose.cell));
            if let Some(cell) = cell.filter(|_| self.is_fetching(robot)) {
                self.meet(cell, pose.heading, obstacle);
            }
            return;
        }
        self.mission.route.clear();
        self.count(Move::Forward);
        let Some(cell) = cell else {
            let words = "an obstacle blocks the turn, or the way back to the centre of the cell".to_owned();
            return self.robot_failed(words);
        };
        self.meet(cell, pose.heading, obstacle);
        self.feed(Input::Blocked, &InputContext { cell: Some(cell), obstacle: Some(obstacle), ..InputContext::default() });
    }

    fn failed(&mut self, robot: &RobotId, id: OrderId, words: String) {
        let Some(order) = self.close(robot, id) else { return };
        self.count_failure(robot);
        if matches!(order.action, Action::Photograph(_)) {
            return self.say_photo_failed(robot, words);
        }
        if order.action.moves_base() {
            self.set_off_centre(robot, true);
        }
        if self.searches(robot) {
            self.robot_failed(words);
        } else {
            self.write_trouble(Tone::Alarm, robot, Trouble::Failed(words));
        }
    }

    fn count_failure(&mut self, robot: &RobotId) {
        if let Some(robot) = self.robots.get_mut(robot) {
            robot.failures = robot.failures.saturating_add(1);
        }
    }

    fn say_photo_failed(&mut self, robot: &RobotId, words: String) {
        if self.searches(robot) {
            self.feed(Input::PhotoFailed, &InputContext { words: Some(words), ..InputContext::default() });
        } else {
            self.write_trouble(Tone::Warning, robot, Trouble::NoPhoto(words));
        }
    }

    fn robot_failed(&mut self, words: String) {
        self.feed(Input::RobotFailed, &InputContext { fault: Some(FaultCause::Robot(words)), ..InputContext::default() });
    }

    /// Handles an open order that is still unanswered when its deadline and the time of grace (`GRACE`) are over.
    pub(super) fn order_unanswered(&mut self, robot: &RobotId) {
        let Some(order) = self.robots.get_mut(robot).and_then(|robot| robot.controller.give_up()) else { return };
        self.world.touch(Resource::Robot);
        self.count_failure(robot);
        if matches!(order.action, Action::Photograph(_)) {
            return self.say_photo_failed(robot, "the camera did not answer in time".to_owned());
        }
        if order.action.moves_base() {
            self.set_off_centre(robot, true);
        }
        self.send_halt_to(robot);
        if self.searches(robot) {
            self.feed(Input::Unanswered, &InputContext { fault: Some(FaultCause::Unanswered), ..InputContext::default() });
        } else {
            self.write_trouble(Tone::Alarm, robot, Trouble::Unanswered);
        }
    }

    fn write_trouble(&mut self, tone: Tone, robot: &RobotId, trouble: Trouble) {
        self.world.write(self.now.wall, tone, Said::Robot(robot.clone(), trouble));
    }

    fn sonar(&mut self, robot: &RobotId, cm: Option<u16>) {
        let Some(robot) = self.robots.get_mut(robot) else { return };
        if robot.sonar_cm != cm {
            robot.sonar_cm = cm;
            self.world.touch(Resource::Robot);
        }
    }
}
