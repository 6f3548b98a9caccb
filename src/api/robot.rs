//! The robot and places in the hall in JSON.

use serde::Serialize;

use hallsweep_core::units::{Cell, Revision};
use hallsweep_core::world::robot::RobotView;

/// A cell: `{"x":1,"y":2}`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub struct Place {
    /// Column, growing to the east.
    pub x: i32,
    /// Row, growing to the south.
    pub y: i32,
}

impl From<Cell> for Place {
    fn from(cell: Cell) -> Place {
        Place { x: cell.x, y: cell.y }
    }
}

/// What is known of the robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "camelCase")]
pub struct RobotJson {
    /// When it last changed.
    pub revision: u64,
    /// `stopped`, `movingForward`, `movingBackward`, `rotateLeft`, `rotateRight`, `takingPhoto` or `sendingPhoto`.
    pub state: &'static str,
    /// Whether it was told to halt and has not said since that it stands.
    pub halting: bool,
    /// `north`, `east`, `south` or `west`.
    pub heading: &'static str,
    /// The cell it stands in.
    pub position: Place,
    /// Whether it stands away from the cell's centre, after a halt in mid-step.
    pub off_centre: bool,
    /// Centimetres to what is ahead, or null beyond the sonar's range.
    pub sonar: Option<u16>,
    /// `off` or `blinking`.
    pub led: &'static str,
}

impl RobotJson {
    /// The robot as it is at `revision`.
    #[must_use]
    pub const fn new(robot: &RobotView, revision: Revision) -> RobotJson {
        let cell = robot.pose.cell;
        RobotJson {
            revision: revision.0,
            state: robot.state.name(),
            halting: robot.halting,
            heading: robot.pose.heading.name(),
            position: Place { x: cell.x, y: cell.y },
            off_centre: robot.off_centre,
            sonar: robot.sonar_cm,
            led: if robot.led_blinking { "blinking" } else { "off" },
        }
    }
}
