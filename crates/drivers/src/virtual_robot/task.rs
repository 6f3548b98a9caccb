//! What an order comes to for the virtual robot, which may have to go some way of its own before and behind it.

use std::time::Duration;

use super::Leg;
use hallsweep_core::effect::Action;
use hallsweep_core::units::{OrderId, Pose};

#[derive(Clone, Copy, Debug)]
pub(super) struct OrderTask {
    pub(super) order: OrderId,
    pub(super) action: Action,
    pub(super) deadline: Duration,
    pub(super) aim: Aim,
    pub(super) leg: Option<Leg>,
    /// How often something unexpected was met on the way back to the centre.
    pub(super) hindered: u8,
}

/// What an order comes to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Aim {
    Step(Pose),
    Turn(Pose),
    /// Back to the centre of its cell.
    Back,
    /// The same, but it stands beside that and turns towards it first, to face this way in its cell.
    Aside(Pose),
    /// Forward against what stands there, certainly or maybe, so that it knows where it is; then back to the centre.
    Touch {
        is_certain: bool,
        further: u8,
    },
    Return,
    /// Back from what a step has met first, as long as it drove; and against it once more: how much longer that seems to take than it
    /// must is the latency.
    Retreat(Then),
    Measure(Then),
    /// Ahead until it meets what the scene says that it must, and back to its start.
    Gauge,
    Gauged,
    /// A little ahead: whether the step whose end was not heard is complete.
    Feel,
    Draw,
}

/// What comes of it when the latency is measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Then {
    /// The step to there was stopped.
    Met(Pose),
    /// The way from its start is measured.
    Gauged,
}
