//! The steps of an order for the virtual robot. Before and after the order itself, the robot may have to drive
//! additional ways.

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
    /// Back to the centre of the cell, from a place to the side of the centre. The robot first turns towards the
    /// centre, and keeps that heading.
    Aside(Pose),
    /// Forward to a thing that stands there certainly or possibly, to find out where the robot is. After that, back
    /// to the centre.
    Touch {
        is_certain: bool,
        further: u8,
    },
    Return,
    /// Measures the latency after the first contact of a step. The robot drives back for as long as it drove before.
    /// It then drives to the same thing again. The additional time until the contact is the latency.
    Retreat(Then),
    Measure(Then),
    /// Measures the step. The robot drives ahead until it meets the thing in the scene file, and then back to its
    /// start.
    Gauge,
    Gauged,
    /// A short way ahead, to find out whether the last step is complete, because its end was not reported.
    Feel,
    Draw,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Then {
    /// The step to this pose was stopped by a contact.
    Met(Pose),
    Gauged,
}
