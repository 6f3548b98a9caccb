//! What is known of a robot: where it stands, what it does, what it last sensed.

use std::sync::Arc;

use crate::arm::ArmState;
use crate::hold::Hold;
use crate::robot::{Parts, RobotId, RobotState};
use crate::units::{Pose, WallTime};

/// What is shown of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobotView {
    /// What it does just now.
    pub state: RobotState,
    /// Whether it was told to halt, or its link was lost on the move, and it has not said since that it stands (safety S8).
    pub halting: bool,
    /// Where it stands: the cell and heading of its last completed order.
    pub pose: Pose,
    /// Whether it stands away from that cell's centre (after a halt in mid-step).
    pub off_centre: bool,
    /// So many steps from home it stands before the entrance; 0: it is in the hall.
    pub outside: u8,
    /// The last reading of the front sonar, in centimetres; `None` beyond its range or before the first.
    pub sonar_cm: Option<u16>,
    /// Whether the LED blinks.
    pub led_blinking: bool,
    /// Since when it cannot be reached, so that all of this is what it last said; `None` while it can.
    pub unreached_since: Option<WallTime>,
}

/// One of all robots.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RobotShown {
    /// Which.
    pub id: RobotId,
    /// What is known of it.
    pub view: RobotView,
    /// What it has; `None` before its link is up.
    pub parts: Option<Parts>,
    /// What holds it: what holds all, and what holds it alone.
    pub holds: Vec<Hold>,
    /// Its arm, if it has one.
    pub arm: Option<ArmState>,
    /// Why it cannot be reached, while that is so and a reason is known.
    pub unreached: Option<Arc<str>>,
}
