//! The port to a robot: a pair of bounded channels and the halt watch. Every adapter, the simulated one too, holds one end.

use tokio::sync::mpsc;

use super::halt::HaltWatch;
use crate::core::effect::Order;
use crate::core::event::RobotEvent;

/// Orders under way to a robot: one is open at a time, beside it LED changes.
pub const ORDERS: usize = 8;

/// Reports under way from a robot: a burst of sonar readings and an answer.
pub const REPORTS: usize = 64;

/// What the loop sends to a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToRobot {
    /// Do this, unless a halt has been raised since it was given.
    Order(Order),
    /// Halt where it is: something else than a stop holds the robot.
    Halt,
    /// Let the LED blink, or not.
    Led(bool),
}

/// The loop's end of the link.
#[derive(Debug)]
pub struct RobotLink {
    /// Orders to the robot.
    pub orders: mpsc::Sender<ToRobot>,
    /// Reports from it.
    pub reports: mpsc::Receiver<RobotEvent>,
}

/// The adapter's end of the link. The adapter halts whenever `halts` is raised, answers the order under way with `Halted`, and
/// answers an order whose epoch is older than the watch's with `Halted` without beginning it.
#[derive(Debug)]
pub struct RobotSide {
    /// Orders from the loop.
    pub orders: mpsc::Receiver<ToRobot>,
    /// Reports to it.
    pub reports: mpsc::Sender<RobotEvent>,
    /// Halts.
    pub halts: HaltWatch,
}

/// Both ends of a new link.
#[must_use]
pub fn link(halts: HaltWatch) -> (RobotLink, RobotSide) {
    let (orders, orders_in) = mpsc::channel(ORDERS);
    let (reports_out, reports) = mpsc::channel(REPORTS);
    (RobotLink { orders, reports }, RobotSide { orders: orders_in, reports: reports_out, halts })
}
