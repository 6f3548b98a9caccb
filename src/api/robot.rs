//! Robots in JSON, and the cell where each robot stands. While the link to a robot is down, its last reports are
//! shown.

use schemars::JsonSchema;
use serde::Serialize;

use super::robot_parts::{ReplacedJson, replaced};
use super::time::rfc3339;
use super::vocabulary;
use hallsweep_core::arm::ArmState;
use hallsweep_core::robot::Part;
use hallsweep_core::snapshot::robot::{RobotShown, RobotView};
use hallsweep_core::state::Participant;
use hallsweep_core::units::{Cell, Revision};

/// A cell, counted from home, as `{"x":1,"y":2}`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct PositionJson {
    /// Column, growing to the east.
    pub x: i32,
    /// Row, growing to the south.
    pub y: i32,
}

impl From<Cell> for PositionJson {
    fn from(cell: Cell) -> PositionJson {
        PositionJson { x: cell.x, y: cell.y }
    }
}

/// Known state of a robot.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct RobotJson {
    /// Revision at which a robot last changed.
    pub revision: u64,
    /// Activity: `stopped`, `movingForward`, `movingBackward`, `rotateLeft`, `rotateRight`, `takingPhoto`,
    /// `sendingPhoto` or `movingArm`.
    #[schemars(with = "vocabulary::RobotState")]
    pub state: &'static str,
    /// Whether the robot must halt and has not yet reported that it has stopped.
    pub halting: bool,
    /// Direction in which the robot faces: `north`, `east`, `south` or `west`.
    #[schemars(with = "vocabulary::Heading")]
    pub heading: &'static str,
    /// Cell of the robot.
    pub position: PositionJson,
    /// Whether the robot is away from the centre of its cell, after a halt within a step.
    pub off_centre: bool,
    /// Whether the robot is outside the hall, in front of the entrance. If so, `position` is home.
    pub outside: bool,
    /// Distance to the next obstacle, in centimetres; null beyond the sonar's range.
    pub sonar: Option<u16>,
    /// State of the LED: `off` or `blinking`.
    #[schemars(with = "vocabulary::Led")]
    pub led: &'static str,
    /// Time since which the robot cannot be reached, else null. Without contact, the other fields are its last
    /// report.
    pub unreached_since: Option<String>,
}

impl RobotJson {
    pub fn new(robot: &RobotView, revision: Revision) -> RobotJson {
        let cell = robot.pose.cell;
        RobotJson {
            revision: revision.0,
            state: robot.state.name(),
            halting: robot.halting,
            heading: robot.pose.heading.name(),
            position: PositionJson { x: cell.x, y: cell.y },
            off_centre: robot.off_centre,
            outside: robot.outside > 0,
            sonar: robot.sonar_cm,
            led: if robot.led_blinking { "blinking" } else { "off" },
            unreached_since: robot.unreached_since.map(rfc3339),
        }
    }
}

/// State of an arm, as its robot reports it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct ArmJson {
    /// State of the gripper: `open` or `closed`.
    #[schemars(with = "vocabulary::Gripper")]
    pub gripper: &'static str,
    /// Whether a parcel is in the gripper.
    pub holds: bool,
    /// Whether a parcel is in the gripper and off the floor.
    pub lifted: bool,
    /// Gripping force, in newtons; 0 when nothing is held.
    pub force_n: f64,
    /// Angle of the paddle from upright, in degrees.
    pub angle_deg: f64,
    /// Distance between the bases of the two robots, minus the wanted distance, in millimetres.
    pub gap_mm: f64,
}

impl From<ArmState> for ArmJson {
    fn from(arm: ArmState) -> ArmJson {
        let hundredths = |value: f64| (value * 100.0).round() / 100.0;
        ArmJson {
            gripper: arm.gripper.name(),
            holds: arm.holds.is_some(),
            lifted: arm.holds.is_some() && !arm.on_floor,
            force_n: hundredths(f64::from(arm.force_mn) / 1e3),
            angle_deg: hundredths((f64::from(arm.angle_urad) / 1e6).to_degrees()),
            gap_mm: hundredths(f64::from(arm.gap_um) / 1e3),
        }
    }
}

/// State of one robot, with its name, parts and holds.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct NamedRobotJson {
    /// Name of the robot in the settings.
    pub name: String,
    /// Whether this is the robot that searches.
    pub searches: bool,
    /// Parts and abilities: `base`, `camera`, `sonar`, `led`, `thermometer`, `bump`, `arm`, `gripper`,
    /// `acknowledgedMoves`; null before the link is up.
    #[schemars(with = "Option<Vec<vocabulary::Part>>")]
    pub parts: Option<Vec<&'static str>>,
    /// Parts that the robot that searches does not have, and what replaces them. Empty for other robots; null before
    /// the link is up.
    pub replaced: Option<Vec<ReplacedJson>>,
    /// Reason why the robot cannot be reached; null while its link is up, or if no reason is known.
    pub unreached: Option<String>,
    /// Reasons why the robot must not move. Some are for all robots, others for this robot alone.
    #[schemars(with = "Vec<vocabulary::Hold>")]
    pub holds: Vec<&'static str>,
    /// Revision at which any robot last changed.
    pub revision: u64,
    /// Present activity of the robot.
    #[schemars(with = "vocabulary::RobotState")]
    pub state: &'static str,
    /// Whether the robot must halt and has not yet reported that it has stopped.
    pub halting: bool,
    /// Direction in which the robot faces.
    #[schemars(with = "vocabulary::Heading")]
    pub heading: &'static str,
    /// Cell of the robot.
    pub position: PositionJson,
    /// Whether the robot is away from the centre of its cell.
    pub off_centre: bool,
    /// Whether the robot is outside, in front of the entrance.
    pub outside: bool,
    /// Distance to the next obstacle, in centimetres, or null.
    pub sonar: Option<u16>,
    /// State of the LED: `off` or `blinking`.
    #[schemars(with = "vocabulary::Led")]
    pub led: &'static str,
    /// Time since which the robot cannot be reached, else null. Without contact, the other fields are its last
    /// report.
    pub unreached_since: Option<String>,
    /// State of the arm; null if the robot has no arm, and before the link is up.
    pub arm: Option<ArmJson>,
}

impl NamedRobotJson {
    /// The state of this robot. `revision` is the common revision of all robots.
    pub fn new(shown: &RobotShown, searches: bool, revision: Revision) -> NamedRobotJson {
        let RobotJson { revision, state, halting, heading, position, off_centre, outside, sonar, led, unreached_since } =
            RobotJson::new(&shown.view, revision);
        NamedRobotJson {
            name: shown.id.name().to_owned(),
            searches,
            parts: shown.parts.map(|parts| parts.iter().map(Part::name).collect()),
            replaced: shown.parts.map(|parts| if searches { replaced(parts) } else { Vec::new() }),
            unreached: shown.unreached.as_deref().map(str::to_owned),
            holds: shown.holds.iter().map(|hold| hold.name()).collect(),
            revision,
            state,
            halting,
            heading,
            position,
            off_centre,
            outside,
            sonar,
            led,
            unreached_since,
            arm: shown.arm.map(ArmJson::from),
        }
    }
}

/// State of one robot, with its kind and address from the settings.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RobotBySettingsJson {
    /// Kind of robot: `sim`, `virtual-tcp`, `virtual-ws` or `line`; null if the kind is not known.
    pub kind: Option<String>,
    /// Address of the robot, as `localhost:8999` or `/dev/ttyUSB0`; null for a robot that is part of this program.
    pub address: Option<String>,
    #[serde(flatten)]
    pub robot: NamedRobotJson,
}

impl RobotBySettingsJson {
    pub fn new(robot: NamedRobotJson, set: &[Participant]) -> RobotBySettingsJson {
        let set = set.iter().find(|set| *set.name == *robot.name);
        let address = set.and_then(|set| set.address.as_deref()).map(str::to_owned);
        RobotBySettingsJson { kind: set.map(|set| set.kind.to_string()), address, robot }
    }
}
