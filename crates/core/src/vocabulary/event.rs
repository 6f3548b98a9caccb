//! The inputs of the core: reports from robots, readings from sensors, and reports from the store. `effect` defines
//! the outputs of the core.

use std::sync::Arc;
use std::time::Duration;

use crate::arm::{ArmState, Parcel};
use crate::command::Move;
use crate::robot::{Parts, RobotId};
use crate::units::{Celsius, Heading, OrderId, Piece, Pose, Seq};

#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    Robot(RobotId, RobotEvent),
    /// All entries up to this one are stored durably.
    Recorded(Seq),
    StoreFailed(String),
    /// The store still cannot write, but now for this reason.
    StoreReason(String),
    /// The answers of judges up to the list with this number are stored.
    KeptBack(u64),
    StoreRestored,
}

/// A robot's report. A robot answers every order with exactly one of `Done`, `Blocked`, `Halted`, `Photo`,
/// `PhotoFailed`, `Found` or `Failed`. The other reports may arrive at any time.
#[derive(Clone, Debug, PartialEq)]
pub enum RobotEvent {
    /// The robot's own estimate of its place. A robot that knows its place reports it just before `LinkUp`.
    Stands(Whereabouts),
    /// The robot stands outside the entrance. The values are the number of steps from home, the heading, and whether
    /// the robot is away from the exact place.
    StandsOutside(u8, Heading, OffCentre),
    /// The link is up, for the first time or again. The report tells what this robot can do.
    LinkUp(Capabilities),
    /// The link is lost, for this reason. The robot halts by itself and will not answer its open order.
    LinkLost(String),
    /// The robot's time is paused, which is possible for a simulated robot. The robot still obeys and answers halts.
    /// No order becomes overdue until `LinkUp`, which reports that time runs again, and how long each action now
    /// takes.
    Paused,
    /// The order is complete: a step, a turn, a recentring, an arm movement, or the start of a controller.
    Done(OrderId),
    /// A step met an obstacle. The robot now stands against the obstacle, off the centre of the cell from which it
    /// came. It must be recentred.
    Blocked(OrderId, Obstacle),
    /// A halt ended the order early, or arrived before the order was begun. `off_centre` tells whether the robot is
    /// now off a cell centre or between two headings. If so, it must be recentred first.
    Halted(OrderId, OffCentre),
    Photo(OrderId, Photo),
    PhotoFailed(OrderId, String),
    Failed(OrderId, String),
    /// The answer to `FindParcel`; `None` if no parcel was recognised.
    Found(OrderId, Option<Parcel>),
    /// The present state of the robot's arm. It is reported at every change of what the arm holds or does, before the
    /// answer to the order that caused the change. While the arm holds something, the report is repeated from time to
    /// time.
    Arm(ArmState),
    /// The parcel slipped out of the grippers and now lies at this place. Both robots of the pair report this.
    ParcelLost(Parcel),
    /// The distance to the next thing ahead, from the front sonar, in centimetres; `None` if nothing is in range.
    Sonar(Option<u16>),
    /// What the front sonar sees from the place where the current order ends. It is reported just before that order
    /// is `Done`.
    Ahead(Ahead),
    Temperature(Celsius),
}

/// What is ahead of a robot that stands in the centre of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ahead {
    /// Number of free cells, up to the distance at which the sonar is trusted.
    pub free: u16,
    /// The obstacle in the cell behind the free cells, as the camera recognises it.
    pub obstacle: Option<Obstacle>,
}

/// Whether a halted robot is away from the place where its last completed order ended.
pub type OffCentre = bool;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Whereabouts {
    /// The cell and heading at the end of the last completed order.
    pub pose: Pose,
    /// Whether the robot is away from this pose and must be recentred first.
    pub off_centre: OffCentre,
}

/// What a robot can do, and how long each action takes. The robot reports this when its link comes up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities {
    pub step: Duration,
    /// Duration of a turn of 90°.
    pub turn: Duration,
    /// Duration of one photo, including its transfer.
    pub photo: Duration,
    /// Duration of the longest arm movement; zero if the robot has no arm.
    pub arm: Duration,
    /// Whether the robot can do the moves `NudgeLeft` and `NudgeRight`. Otherwise these moves are refused.
    pub nudges: bool,
    pub parts: Parts,
}

impl Capabilities {
    #[must_use]
    pub const fn time(&self, step: Move) -> Duration {
        match step {
            Move::Forward | Move::Backward => self.step,
            Move::TurnLeft | Move::TurnRight | Move::NudgeLeft | Move::NudgeRight => self.turn,
        }
    }
}

/// The kind of an obstacle, as the robot recognises it (mission §3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// A wall of the hall. The numbers count how many more cells of the same straight wall the camera sees to the
    /// robot's left and right. They are zero if the camera cannot tell.
    Wall {
        left: u16,
        right: u16,
    },
    /// A piece of luggage. It has the same number on every side.
    Luggage(Piece),
    Unknown,
}

#[derive(Clone, PartialEq, Eq)]
pub struct Photo {
    pub bytes: Arc<[u8]>,
    /// The media type, such as `image/png`.
    pub media_type: &'static str,
}

impl std::fmt::Debug for Photo {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Photo({}, {} bytes)", self.media_type, self.bytes.len())
    }
}
