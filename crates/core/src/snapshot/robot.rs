//! The view of a robot: its place, its action and its last readings. While the robot cannot be reached, the view
//! shows its last report.

use std::sync::Arc;

use crate::arm::ArmState;
use crate::hold::Hold;
use crate::robot::{Parts, RobotId, RobotState};
use crate::units::{Pose, WallTime};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobotView {
    pub state: RobotState,
    /// True after a halt, or after the link was lost during a move, until the robot reports that it stands
    /// (safety S8).
    pub halting: bool,
    /// The cell and heading at the end of its last completed order.
    pub pose: Pose,
    /// Whether the robot is off the centre of that cell, after a halt during a step.
    pub off_centre: bool,
    /// Number of steps from home if the robot stands outside the entrance; 0 if it is in the hall.
    pub outside: u8,
    /// The last reading of the front sonar, in centimetres. `None` if nothing was in range, or before the first
    /// reading.
    pub sonar_cm: Option<u16>,
    pub led_blinking: bool,
    /// When the link to the robot was lost. All values are then the last reported ones. `None` while the robot can be
    /// reached.
    pub unreached_since: Option<WallTime>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotShown {
    pub id: RobotId,
    pub view: RobotView,
    /// The parts of the robot; `None` before its link is up.
    pub parts: Option<Parts>,
    /// The holds on all robots and the holds on this robot alone.
    pub holds: Vec<Hold>,
    pub arm: Option<ArmState>,
    /// The reason why the robot cannot be reached, if known; `None` while it can be reached.
    pub unreached: Option<Arc<str>>,
}
