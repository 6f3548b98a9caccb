//! Robots in JSON, and the cell where each stands. While its link is down, a robot is shown with its last reports.

use schemars::JsonSchema;
use serde::Serialize;

use super::retrieval::ArmJson;
use super::robot_parts::{ReplacedJson, replaced};
use super::time::rfc3339;
use super::vocabulary;
use hallsweep_core::robot::Part;
use hallsweep_core::snapshot::robot::{RobotShown, RobotView};
use hallsweep_core::state::Participant;
use hallsweep_core::units::{Cell, Revision};

/// A cell: `{"x":1,"y":2}`.
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

/// What is known of the robot.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct RobotJson {
    /// When it last changed.
    pub revision: u64,
    /// `stopped`, `movingForward`, `movingBackward`, `rotateLeft`, `rotateRight`, `takingPhoto` or `sendingPhoto`.
    #[schemars(with = "vocabulary::RobotState")]
    pub state: &'static str,
    /// Whether it was told to halt and has not said since that it stands.
    pub halting: bool,
    /// `north`, `east`, `south` or `west`.
    #[schemars(with = "vocabulary::Heading")]
    pub heading: &'static str,
    /// The cell it stands in.
    pub position: PositionJson,
    /// Whether it stands away from the cell's centre, after a halt in mid-step.
    pub off_centre: bool,
    /// Whether it is before the entrance; then its position is home's.
    pub outside: bool,
    /// Centimetres to what is ahead, or null beyond the sonar's range.
    pub sonar: Option<u16>,
    /// `off` or `blinking`.
    #[schemars(with = "vocabulary::Led")]
    pub led: &'static str,
    /// Since when it cannot be reached, so that all of this is what it last said; null while it can, and before it was first tried.
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

/// One of all robots: its name, what it has, what holds it, and beside these what is said of the one that searches.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct NamedRobotJson {
    /// Its name in the settings.
    pub name: String,
    pub searches: bool,
    /// What it has: `base`, `camera`, `sonar`, `led`, `thermometer`, `bump`, `arm`, `gripper`, `acknowledgedMoves`; null before its link is
    /// up.
    #[schemars(with = "Option<Vec<vocabulary::Part>>")]
    pub parts: Option<Vec<&'static str>>,
    /// What the robot that searches has not, and what is done instead; nothing of the others, and null before its link is up.
    pub replaced: Option<Vec<ReplacedJson>>,
    /// Why it cannot be reached; null while it is, and where no reason is known.
    pub unreached: Option<String>,
    /// What holds it: what holds all, and what holds it alone.
    #[schemars(with = "Vec<vocabulary::Hold>")]
    pub holds: Vec<&'static str>,
    /// When any robot last changed.
    pub revision: u64,
    /// What it does.
    #[schemars(with = "vocabulary::RobotState")]
    pub state: &'static str,
    /// Whether it was told to halt and has not said since that it stands.
    pub halting: bool,
    /// Where it looks.
    #[schemars(with = "vocabulary::Heading")]
    pub heading: &'static str,
    /// The cell it stands in.
    pub position: PositionJson,
    /// Whether it stands away from the cell's centre.
    pub off_centre: bool,
    /// Whether it is before the entrance.
    pub outside: bool,
    /// Centimetres to what is ahead, or null.
    pub sonar: Option<u16>,
    /// `off` or `blinking`.
    #[schemars(with = "vocabulary::Led")]
    pub led: &'static str,
    /// Since when it cannot be reached, so that all of this is what it last said; null while it can.
    pub unreached_since: Option<String>,
    /// Its arm; null where it has none, and before its link is up.
    pub arm: Option<ArmJson>,
}

impl NamedRobotJson {
    /// This robot at `revision`, the common revision of all robots.
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

/// One of all robots, with what the settings say of it.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct RobotBySettingsJson {
    /// `sim`, `virtual-tcp`, `virtual-ws` or `line`; null where it is not known.
    pub kind: Option<String>,
    /// Where it is reached, as `localhost:8999` or `/dev/ttyUSB0`; null for one that is part of this program.
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
