//! What a robot reports, taken into the world first and then told to the mission.

use std::sync::Arc;

use super::Engine;
use crate::command::Move;
use crate::effect::{Action, Fact, Order};
use crate::event::{Capabilities, Obstacle, OffCentre, Photo, Piece, RobotEvent, Whereabouts};
use crate::explore::plan::after;
use crate::mission::{FaultCause, Input, InputContext, Phase, Stage};
use crate::units::{Cell, Heading, OrderId};
use crate::world::hall_map::{Mark, REACH};
use crate::world::log::Tone;
use crate::world::resource::Resource;
use crate::world::temperature::ROBOT;

impl Engine {
    pub(super) fn report(&mut self, report: RobotEvent) {
        match report {
            RobotEvent::Stands(whereabouts) => self.stands(whereabouts),
            RobotEvent::LinkUp(can) => self.link_up(can),
            RobotEvent::LinkLost(words) => self.link_lost(words),
            RobotEvent::Done(id) => self.done(id),
            RobotEvent::Blocked(id, obstacle) => self.blocked(id, obstacle),
            RobotEvent::Halted(id, off_centre) => self.halted(id, off_centre),
            RobotEvent::Photo(id, photo) => self.photo_taken(id, photo),
            RobotEvent::PhotoFailed(id, words) => self.photo_failed(id, words),
            RobotEvent::Failed(id, words) => self.failed(id, words),
            RobotEvent::Sonar(cm) => self.sonar(cm),
            RobotEvent::Temperature(celsius) => self.read_temperature(&Arc::from(ROBOT), celsius),
        }
    }

    /// The robot's own reckoning counts: it may have ended a move of which the record says nothing (safety R2).
    fn stands(&mut self, Whereabouts { pose, off_centre }: Whereabouts) {
        let is_elsewhere = self.state.pose != pose;
        if !is_elsewhere && self.world.robot.off_centre == off_centre {
            return;
        }
        self.world.robot.off_centre = off_centre;
        self.world.touch(Resource::Robot);
        if is_elsewhere {
            let text = format!("the robot says that it stands at {}, facing {}", pose.cell, pose.heading.name());
            self.world.write(self.now.wall, Tone::Info, text);
            self.mission.route.clear();
            self.mark(pose.cell, Mark::Visited);
            self.record(Fact::Pose(pose));
            self.leave_inspection();
        }
    }

    /// Carried away from the piece in front of it, the robot can take no photo of it: a piece without a record stays a target of
    /// the search, and one with a record keeps the photo it has.
    fn leave_inspection(&mut self) {
        match self.stage() {
            Some(Stage::BackingUp | Stage::TakingPhoto) => {
                let mut phase = self.state.phase.clone();
                *phase.underlying_mut() = Phase::Exploring;
                self.note_phase(phase);
            }
            Some(Stage::RetakingPhoto(id)) => self.set_stage(Stage::AwaitingVerdict(id)),
            Some(Stage::Recording(_) | Stage::AwaitingVerdict(_)) | None => {}
        }
    }

    fn link_up(&mut self, can: Capabilities) {
        self.controller.link_up(can);
        self.world.touch(Resource::Robot);
        self.feed(Input::LinkUp, &InputContext::default());
    }

    /// The robot halts by itself; where exactly it stands is not known before it is recentred.
    fn link_lost(&mut self, words: String) {
        self.world.robot.off_centre |= self.controller.lose();
        self.world.touch(Resource::Robot);
        self.feed(Input::LinkLost, &InputContext { words: Some(words), ..InputContext::default() });
    }

    fn close(&mut self, id: OrderId) -> Option<Order> {
        let order = self.controller.close(id)?;
        self.world.touch(Resource::Robot);
        Some(order)
    }

    fn done(&mut self, id: OrderId) {
        let Some(order) = self.close(id) else { return };
        match order.action {
            Action::Move(step) => self.moved(step),
            Action::Recentre => self.world.robot.off_centre = false,
            Action::Photograph(_) => {}
        }
        self.feed(Input::Done, &InputContext::default());
    }

    /// The robot stands where the move led; after a late answer too, so it is not off centre any more.
    fn moved(&mut self, step: Move) {
        self.world.robot.off_centre = false;
        let before = self.state.pose;
        let pose = after(before, step);
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
        self.record(Fact::Pose(pose));
    }

    /// The cell that was to be entered is an obstacle; the robot stands against it until it is recentred.
    fn blocked(&mut self, id: OrderId, obstacle: Obstacle) {
        let Some(order) = self.close(id) else { return };
        self.world.robot.off_centre = true;
        self.mission.route.clear();
        let Action::Move(step @ (Move::Forward | Move::Backward)) = order.action else {
            let words = "something is in the way of a turn, or of the way back to the centre of its cell".to_owned();
            return self.robot_failed(words);
        };
        let obstacle = if self.settings.inspect_everything { Obstacle::Unknown } else { obstacle };
        let cell = after(self.state.pose, step).cell;
        self.meet(cell, obstacle);
        self.feed(Input::Blocked, &InputContext { cell: Some(cell), obstacle: Some(obstacle), ..InputContext::default() });
    }

    /// Marks the obstacle by what it was taken for (mission §3).
    fn meet(&mut self, cell: Cell, obstacle: Obstacle) {
        let mark = match obstacle {
            Obstacle::Wall { .. } => Mark::Wall,
            Obstacle::Luggage(piece) if self.state.pieces.contains(&piece) => Mark::Luggage,
            Obstacle::Luggage(_) | Obstacle::Unknown => Mark::NotInspected,
        };
        // A mark that was settled stays: an inspected bag is not asked about again because the camera could not tell this time.
        if !matches!(self.state.map.at(cell), Mark::Wall | Mark::Luggage) {
            self.mark(cell, mark);
        }
        let taken_for = match obstacle {
            Obstacle::Wall { .. } => "wall",
            Obstacle::Luggage(_) => "luggage",
            Obstacle::Unknown => "unknown",
        };
        self.record(Fact::Obstacle(cell, taken_for));
        if let (Obstacle::Wall { left, right }, Mark::Wall, true) = (obstacle, mark, self.settings.wall_lines) {
            let heading = self.state.pose.heading;
            self.reveal_wall(cell, heading.left(), left);
            self.reveal_wall(cell, heading.right(), right);
        }
    }

    /// Marks the straight wall that the camera sees beside the cell that was met.
    fn reveal_wall(&mut self, from: Cell, towards: Heading, count: u16) {
        let mut cell = from;
        for _ in 0..i32::from(count).min(REACH) {
            cell = cell.ahead(towards);
            if self.state.map.at(cell) == Mark::Unknown {
                self.mark(cell, Mark::Wall);
            }
        }
    }

    fn halted(&mut self, id: OrderId, off_centre: OffCentre) {
        if self.close(id).is_some() {
            self.world.robot.off_centre |= off_centre;
        }
    }

    fn photo_taken(&mut self, id: OrderId, photo: Photo) {
        if self.close(id).is_some() {
            self.feed(Input::PhotoTaken, &InputContext { photo: Some(photo), ..InputContext::default() });
        }
    }

    fn photo_failed(&mut self, id: OrderId, words: String) {
        if self.close(id).is_some() {
            self.feed(Input::PhotoFailed, &InputContext { words: Some(words), ..InputContext::default() });
        }
    }

    fn failed(&mut self, id: OrderId, words: String) {
        let Some(order) = self.close(id) else { return };
        if order.action.is_motion() {
            self.world.robot.off_centre = true;
            self.robot_failed(words);
        } else {
            self.feed(Input::PhotoFailed, &InputContext { words: Some(words), ..InputContext::default() });
        }
    }

    fn robot_failed(&mut self, words: String) {
        self.feed(Input::RobotFailed, &InputContext { fault: Some(FaultCause::Robot(words)), ..InputContext::default() });
    }

    /// The deadline of the open order and its grace have passed without an answer.
    pub(super) fn order_unanswered(&mut self) {
        let Some(order) = self.controller.give_up() else { return };
        self.world.touch(Resource::Robot);
        if order.action.is_motion() {
            self.world.robot.off_centre = true;
            self.send_halt();
            self.feed(Input::Unanswered, &InputContext { fault: Some(FaultCause::Unanswered), ..InputContext::default() });
        } else {
            let words = "the camera did not answer in time".to_owned();
            self.feed(Input::PhotoFailed, &InputContext { words: Some(words), ..InputContext::default() });
        }
    }

    fn sonar(&mut self, cm: Option<u16>) {
        if self.world.robot.sonar_cm != cm {
            self.world.robot.sonar_cm = cm;
            self.world.touch(Resource::Robot);
        }
    }
}

/// The piece an obstacle was recognised as.
pub(super) fn piece_of(obstacle: Obstacle) -> Option<Piece> {
    match obstacle {
        Obstacle::Luggage(piece) => Some(piece),
        Obstacle::Wall { .. } | Obstacle::Unknown => None,
    }
}
