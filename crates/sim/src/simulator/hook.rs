//! The hook of a simulated robot that fetches pieces alone. It takes the piece ahead onto the robot's back, even if
//! the piece covers several cells. It releases the piece at home, into the container. Taken pieces no longer stand in
//! the hall.

use super::super::hall::Truth;
use super::super::memory::Taken;
use super::{Sim, Work};
use hallsweep_core::arm::{ArmAction, ArmState, Gripper, Parcel};
use hallsweep_core::effect::Order;
use hallsweep_core::event::RobotEvent;
use hallsweep_core::place::Place;
use hallsweep_core::units::{Cell, OrderId, Piece};

/// The action that the hook is doing. If it is halted before its end, nothing has been done.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Handling {
    Take(Piece),
    LetGo,
}

impl Sim {
    #[must_use]
    pub fn hook(&self) -> ArmState {
        let holds = self.taken.carried.map(|piece| Parcel { piece, place: Place::Cell(self.pose.cell) });
        let gripper = if holds.is_some() { Gripper::Closed } else { Gripper::Open };
        ArmState { gripper, holds, lifted: holds.is_some(), ..ArmState::default() }
    }

    pub fn taken_in(&self) -> impl Iterator<Item = Piece> {
        self.taken.in_container()
    }

    pub(super) fn tell_hook(&mut self) {
        if self.settings.has_hook {
            self.events.push_back(RobotEvent::Arm(self.hook()));
        }
    }

    pub(super) fn begin_hook(&mut self, order: Order, action: ArmAction) {
        let piece = self.piece_ahead();
        match action {
            _ if !self.settings.has_hook => self.fail(order.id, "it has no arm"),
            _ if self.is_off_centre() => self.fail(order.id, "it stands away from the centre of its cell: recentre first"),
            ArmAction::FindParcel(_) => {
                let place = Place::Cell(self.pose.cell.ahead(self.pose.heading));
                self.events.push_back(RobotEvent::Found(order.id, piece.map(|piece| Parcel { piece, place })));
            }
            ArmAction::CloseGripper => match piece.filter(|piece| Taken::has_room_for(*piece)) {
                _ if self.taken.carried.is_some() => self.fail(order.id, "it carries a piece already"),
                Some(piece) => self.handle(order, Handling::Take(piece)),
                None => self.fail(order.id, "there is no piece ahead that it can take"),
            },
            ArmAction::Release if self.pose.cell == Cell::HOME && self.outside == 0 => self.handle(order, Handling::LetGo),
            ArmAction::Release => self.fail(order.id, "it can let go only at home, where the container is"),
            ArmAction::AlignEndEffector(_)
            | ArmAction::HoldForce
            | ArmAction::HoldAngle
            | ArmAction::HoldDistance
            | ArmAction::Lift
            | ArmAction::Lower => self.fail(order.id, "it has only a hook, not an arm"),
        }
    }

    fn piece_ahead(&self) -> Option<Piece> {
        match self.hall.truth(self.pose.cell.ahead(self.pose.heading)) {
            Truth::Luggage(piece) if self.outside == 0 => Some(piece),
            Truth::Luggage(_) | Truth::Free | Truth::Wall => None,
        }
    }

    fn handle(&mut self, order: Order, what: Handling) {
        self.begin(order, Work::Handle { ends: self.now + self.settings.hook, what });
    }

    pub(super) fn handled(&mut self, order: OrderId, what: Handling) {
        match what {
            Handling::Take(piece) => self.taken.carried = Some(piece),
            Handling::LetGo => drop(self.taken.let_go()),
        }
        self.look_at_floor();
        self.tell_hook();
        self.events.push_back(RobotEvent::Done(order));
    }
}

#[cfg(test)]
#[path = "tests/hook.rs"]
mod tests;
