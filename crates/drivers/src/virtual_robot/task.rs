//! The steps of an order for the virtual robot, which may have to drive some way of its own before and after it.

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

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Aim {
    Step(Pose),
    Turn(Pose),
    Back,
    /// Back to the centre of its cell, beside which it stands: it turns towards it first, and then faces this way.
    Aside(Pose),
    /// Forward against what stands there, certainly or maybe, to find out where it is; then back to the centre.
    Touch {
        is_certain: bool,
        further: u8,
    },
    Return,
    /// Back from the first contact of a step, for as long as it drove, and forward against it again: the time that this
    /// takes too long is the latency.
    Retreat(Then),
    Measure(Then),
    /// Ahead until it meets what the scene has there, and back to its start.
    Gauge,
    Gauged,
    /// A little ahead, to find out whether a step without a report of its end is complete.
    Feel,
    Draw,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Then {
    /// The step to this pose was stopped.
    Met(Pose),
    Gauged,
}
