//! The engine's knowledge of one robot: its open order, its capabilities, and how it got off centre.

use std::time::Duration;

use crate::command::Move;
use crate::effect::{Action, Order};
use crate::event::Capabilities;
use crate::robot::RobotState;
use crate::units::{Epoch, OrderId};

/// Time to wait for an answer after the robot's own deadline. It covers the transfer of the messages to the robot and
/// back.
const GRACE: Duration = Duration::from_secs(2);

#[derive(Clone, Debug, Default)]
pub(crate) struct RobotController {
    /// What the robot can do; `None` while its link is not up.
    pub(crate) capabilities: Option<Capabilities>,
    open: Option<Open>,
    /// An order that was not answered in time. Its answer may still arrive.
    overdue: Option<Order>,
    last: OrderId,
    /// True after the robot was told to halt or could not be reached, until it reports that it stands.
    halting: bool,
    /// Whether the robot's time is paused. No order of this robot then becomes overdue.
    is_paused: bool,
    /// The state that the robot will show while it recentres. It is the opposite of the move that took the robot off
    /// centre.
    way_back: Option<RobotState>,
}

#[derive(Clone, Copy, Debug)]
struct Open {
    order: Order,
    sent: Duration,
}

impl RobotController {
    pub(crate) fn open(&self) -> Option<Order> {
        self.open.map(|open| open.order)
    }

    pub(crate) const fn is_free(&self) -> bool {
        self.capabilities.is_some() && self.open.is_none()
    }

    /// Whether the robot was told to move and has not answered yet.
    pub(crate) fn is_moving(&self) -> bool {
        self.open.is_some_and(|open| open.order.action.is_motion())
    }

    /// Whether the robot may still be moving after a halt or after the loss of its link (safety S8).
    pub(crate) const fn is_halting(&self) -> bool {
        self.halting
    }

    pub(crate) fn halt(&mut self) {
        self.halting |= self.may_be_moving();
    }

    /// Handles the loss of the link. Returns true if an open order was a motion. The robot halts by itself, and
    /// reports that when its link is up again.
    pub(crate) fn lose(&mut self) -> bool {
        self.capabilities = None;
        let halting = self.halting || self.may_be_moving();
        let was_moving = self.drop_open().is_some_and(|order| order.action.is_motion());
        (self.overdue, self.halting, self.is_paused) = (None, halting, false);
        was_moving
    }

    /// Handles a link that is up. A robot without an order stands. If there is an order, its deadline starts again,
    /// with the times that the robot now states.
    pub(crate) fn link_up(&mut self, can: Capabilities, since_start: Duration) {
        (self.capabilities, self.is_paused) = (Some(can), false);
        self.halting &= self.is_moving();
        if let Some(action) = self.open.map(|open| open.order.action) {
            let deadline = self.deadline(action);
            self.open = self.open.map(|open| Open { order: Order { deadline, ..open.order }, sent: since_start });
        }
    }

    /// Pauses the robot's time until its link is up again.
    pub(crate) const fn pause(&mut self) {
        self.is_paused = true;
    }

    /// Whether an ordered motion has not been answered, even if its answer is overdue.
    fn may_be_moving(&self) -> bool {
        self.is_moving() || self.overdue.is_some_and(|order| order.action.is_motion())
    }

    /// Makes a new open order, and ends the wait for a halt. The robot handles its messages in order, so it has
    /// halted before it begins this order. After a fault, a person has checked the robot before this order.
    pub(crate) fn give(&mut self, action: Action, epoch: Epoch, since_start: Duration) -> Order {
        self.last = self.last.next();
        let order = Order { id: self.last, action, epoch, deadline: self.deadline(action) };
        self.open = Some(Open { order, sent: since_start });
        self.halting = false;
        order
    }

    /// Closes the order with this id, if it is the open order or the overdue order. An answer to any other order is
    /// out of date.
    pub(crate) fn close(&mut self, id: OrderId) -> Option<Order> {
        let order = self.overdue.take_if(|order| order.id == id).or_else(|| self.close_open(id))?;
        self.halting &= self.may_be_moving();
        Some(order)
    }

    fn close_open(&mut self, id: OrderId) -> Option<Order> {
        let open = self.open.take_if(|open| open.order.id == id)?;
        self.overdue = None;
        if let Action::Move(step) = open.order.action {
            self.way_back = Some(doing(step.reversed()));
        }
        Some(open.order)
    }

    pub(crate) fn drop_open(&mut self) -> Option<Order> {
        self.open.and_then(|open| self.close(open.order.id))
    }

    /// Makes the open order overdue. Its answer may still arrive late.
    pub(crate) fn give_up(&mut self) -> Option<Order> {
        self.overdue = self.drop_open();
        self.overdue
    }

    pub(crate) fn due(&self) -> Option<Duration> {
        self.open.filter(|_| !self.is_paused).map(|open| open.sent.saturating_add(open.order.deadline).saturating_add(GRACE))
    }

    pub(crate) fn state(&self) -> RobotState {
        match self.open.map(|open| open.order.action) {
            None => RobotState::Stopped,
            Some(Action::Photograph(_)) => RobotState::TakingPhoto,
            Some(Action::Arm(action)) if action.is_motion() => RobotState::MovingArm,
            Some(Action::Arm(_)) => RobotState::Stopped,
            Some(Action::Enter) => RobotState::MovingForward,
            Some(Action::Leave) => RobotState::MovingBackward,
            Some(Action::Recentre) => self.way_back.unwrap_or(RobotState::MovingBackward),
            Some(Action::Move(step)) => doing(step),
        }
    }

    /// Returns 3 × t + 1 s, where t is the time that the robot states for the action.
    fn deadline(&self, action: Action) -> Duration {
        let nominal = self.capabilities.map_or(Duration::ZERO, |can| match action {
            Action::Move(step) => can.time(step),
            Action::Recentre => can.step.max(can.turn),
            Action::Photograph(_) => can.photo,
            Action::Enter | Action::Leave => can.step,
            Action::Arm(_) => can.arm,
        });
        nominal.saturating_mul(3).saturating_add(Duration::from_secs(1))
    }
}

const fn doing(step: Move) -> RobotState {
    match step {
        Move::Forward => RobotState::MovingForward,
        Move::Backward => RobotState::MovingBackward,
        Move::TurnLeft | Move::NudgeLeft => RobotState::RotateLeft,
        Move::TurnRight | Move::NudgeRight => RobotState::RotateRight,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::Parts;

    fn can(step_s: u64) -> Capabilities {
        let step = Duration::from_secs(step_s);
        Capabilities { step, turn: step, photo: step, arm: Duration::ZERO, nudges: false, parts: Parts::ROUND_ROBOT }
    }

    #[test]
    fn nothing_is_overdue_while_time_stands_and_what_goes_on_is_waited_for_anew() {
        let mut robot = RobotController::default();
        robot.link_up(can(1), Duration::ZERO);
        robot.give(Action::Move(Move::Forward), Epoch(0), Duration::ZERO);
        assert_eq!(robot.due(), Some(Duration::from_secs(3 + 1 + 2)));
        robot.pause();
        assert_eq!(robot.due(), None);
        robot.link_up(can(10), Duration::from_secs(500));
        assert_eq!(robot.due(), Some(Duration::from_secs(500 + 30 + 1 + 2)), "it is slower now");
        assert!(robot.is_moving(), "the order is the same");
    }

    #[test]
    fn a_robot_that_is_lost_while_its_time_stands_is_waited_for_when_it_is_back() {
        let mut robot = RobotController::default();
        robot.link_up(can(1), Duration::ZERO);
        robot.pause();
        robot.lose();
        robot.link_up(can(1), Duration::from_secs(9));
        robot.give(Action::Recentre, Epoch(0), Duration::from_secs(9));
        assert!(robot.due().is_some());
    }
}
