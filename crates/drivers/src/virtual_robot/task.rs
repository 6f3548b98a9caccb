//! The steps of an order for the virtual robot, which may have to drive additional ways before and after the order
//! itself.

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
    /// Number of unexpected contacts on the way back to the centre.
    pub(super) hindered: u8,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Aim {
    Step(Pose),
    Turn(Pose),
    Back,
    /// Back to the centre of its cell, beside which the robot stands. It first turns towards the centre, and keeps that
    /// heading.
    Aside(Pose),
    /// Forward against a thing that certainly or possibly stands there, to find out where the robot is; then back to
    /// the centre.
    Touch {
        is_certain: bool,
        further: u8,
    },
    Return,
    /// Back from the first contact of a step, for as long as the robot drove, and forward against the same thing again.
    /// The time by which this takes too long is the latency.
    Retreat(Then),
    Measure(Then),
    /// Ahead until the robot meets the thing of the scene file, and back to its start.
    Gauge,
    Gauged,
    /// A little ahead, to find out whether a step is complete whose end was not reported.
    Feel,
    Draw,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Then {
    /// The step to this pose was stopped.
    Met(Pose),
    Gauged,
}
