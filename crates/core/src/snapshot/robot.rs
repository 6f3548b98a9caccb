//! The view of a robot: where it stands, what it does, what it last sensed. While the robot cannot be reached, all of
//! this is what it last reported.

use std::sync::Arc;

use crate::arm::ArmState;
use crate::hold::Hold;
use crate::robot::{Parts, RobotId, RobotState};
use crate::units::{Pose, WallTime};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobotView {
    pub state: RobotState,
    /// Whether it was told to halt, or its link was lost on the move, and it has not reported since that it stands
    /// (safety S8).
    pub halting: bool,
    /// The cell and heading of its last completed order.
    pub pose: Pose,
    /// Whether it stands away from that cell's centre (after a halt in mid-step).
    pub off_centre: bool,
    /// Steps from home at which it stands before the entrance; 0: it is in the hall.
    pub outside: u8,
    /// The last reading of the front sonar, in centimetres; `None` beyond its range or before the first.
    pub sonar_cm: Option<u16>,
    pub led_blinking: bool,
    /// Since when it cannot be reached, so that all of this is what it last reported; `None` while it can.
    pub unreached_since: Option<WallTime>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotShown {
    pub id: RobotId,
    pub view: RobotView,
    /// `None` before its link is up.
    pub parts: Option<Parts>,
    /// The holds of all robots, and its own.
    pub holds: Vec<Hold>,
    pub arm: Option<ArmState>,
    /// Why it cannot be reached, while that is so and a reason is known.
    pub unreached: Option<Arc<str>>,
}
