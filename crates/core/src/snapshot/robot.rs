//! The view of a robot: where it stands, what it does, what it last sensed. While the robot cannot be reached, this is
//! its last report.

use std::sync::Arc;

use crate::arm::ArmState;
use crate::hold::Hold;
use crate::robot::{Parts, RobotId, RobotState};
use crate::units::{Pose, WallTime};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobotView {
    pub state: RobotState,
    /// Whether the robot was told to halt, or lost its link on the move, and has not reported since that it stands
    /// (safety S8).
    pub halting: bool,
    /// The cell and heading of its last completed order.
    pub pose: Pose,
    /// Whether the robot stands away from that cell's centre (after a halt in mid-step).
    pub off_centre: bool,
    /// Number of steps from home at which the robot stands outside the entrance; 0: the robot is in the hall.
    pub outside: u8,
    /// The last reading of the front sonar, in centimetres; `None` beyond its range or before the first.
    pub sonar_cm: Option<u16>,
    pub led_blinking: bool,
    /// Since when the robot cannot be reached, so that all of this is as last reported; `None` while it can be reached.
    pub unreached_since: Option<WallTime>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotShown {
    pub id: RobotId,
    pub view: RobotView,
    /// `None` before its link is up.
    pub parts: Option<Parts>,
    /// The holds of all robots, and of this robot alone.
    pub holds: Vec<Hold>,
    pub arm: Option<ArmState>,
    /// Why the robot cannot be reached, while that is so and a reason is known.
    pub unreached: Option<Arc<str>>,
}
