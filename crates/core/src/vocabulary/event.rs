//! What reaches the core from outside: robots' reports, sensors' readings, the store's reports. `effect` has what the
//! core sends out.

use std::sync::Arc;
use std::time::Duration;

use crate::arm::{ArmState, Parcel};
use crate::command::Move;
use crate::robot::{Parts, RobotId};
use crate::units::{Celsius, Heading, OrderId, Piece, Pose, Seq};

#[derive(Clone, Debug, PartialEq)]
pub enum Event {
    Robot(RobotId, RobotEvent),
    /// Everything up to this entry is stored for good.
    Recorded(Seq),
    StoreFailed(String),
    /// The store still cannot write, now for this reason.
    StoreReason(String),
    StoreRestored,
}

/// A robot's report. A robot answers every order with exactly one of `Done`, `Blocked`, `Halted`, `Photo`,
/// `PhotoFailed`, `Found` or `Failed`; the other reports may come at any time.
#[derive(Clone, Debug, PartialEq)]
pub enum RobotEvent {
    /// Where the robot stands by its own reckoning. A robot that knows its place reports it just before `LinkUp`.
    Stands(Whereabouts),
    /// Where a robot outside the entrance stands: the steps from home (`retrieval::Place::Outside`), its heading, and
    /// whether it stands away from that place.
    StandsOutside(u8, Heading, OffCentre),
    /// The link stands (again), with what this robot can do.
    LinkUp(Capabilities),
    /// The link is lost, for this reason; the robot halts by itself. No open order will be answered.
    LinkLost(String),
    /// The robot's time stands still, as that of a simulated robot may. The robot still obeys halts and answers them.
    /// Nothing that is under way is overdue before `LinkUp` reports that time goes on, and how long actions take now.
    Paused,
    /// A step, turn, recentring or movement of the arm is complete, or a controller is running.
    Done(OrderId),
    /// A step met an obstacle: the robot stands against it, away from the centre of the cell that it left, until it is
    /// recentred.
    Blocked(OrderId, Obstacle),
    /// A halt cut the order short, or came before it, so that the order was not begun. `off_centre` says whether the
    /// robot now stands away from a cell centre or between two headings, to be recentred before anything else.
    Halted(OrderId, OffCentre),
    Photo(OrderId, Photo),
    PhotoFailed(OrderId, String),
    Failed(OrderId, String),
    /// The answer to a look for a parcel; `None` when none was recognised.
    Found(OrderId, Option<Parcel>),
    /// The present state of the robot's arm. It is reported at every change of what the arm holds or does, before the
    /// answer to the order that changed it, and every now and then while the arm holds something.
    Arm(ArmState),
    /// The parcel has slipped out of the grippers and lies here now. Both robots of the pair report this.
    ParcelLost(Parcel),
    /// The front sonar: centimetres to what is ahead, `None` beyond its range.
    Sonar(Option<u16>),
    /// What the front sonar sees from the place where the current order leaves the robot. It is reported just before
    /// that order is `Done`.
    Ahead(Ahead),
    Temperature(Celsius),
}

/// What is ahead of a robot that stands in the centre of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ahead {
    /// Number of free cells, as far as the sonar is believed.
    pub free: u16,
    /// The obstacle in the cell after the free ones, as the camera recognises it.
    pub obstacle: Option<Obstacle>,
}

/// Whether a halted robot stands away from where its last completed order left it.
pub type OffCentre = bool;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Whereabouts {
    /// The cell and heading in which the last completed order left the robot.
    pub pose: Pose,
    /// Whether the robot stands away from there, to be recentred before anything else.
    pub off_centre: OffCentre,
}

/// What a robot can do and how long that takes; reported when the link comes up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Capabilities {
    pub step: Duration,
    /// Duration of a turn of 90°.
    pub turn: Duration,
    /// Duration of one photo, transfer included.
    pub photo: Duration,
    /// Duration of the longest movement of its arm; zero when it has none.
    pub arm: Duration,
    /// Whether the robot can make the moves `NudgeLeft` and `NudgeRight`, which are refused otherwise.
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

/// What the robot takes an obstacle for (mission §3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// A wall of the hall. The numbers say how many more cells of the same straight wall the camera sees to the robot's
    /// left and right of the cell that was met; zero when it cannot tell.
    Wall {
        left: u16,
        right: u16,
    },
    /// A piece of luggage. The piece has the same number from whichever side it is met.
    Luggage(Piece),
    Unknown,
}

#[derive(Clone, PartialEq, Eq)]
pub struct Photo {
    pub bytes: Arc<[u8]>,
    /// Such as `image/png`.
    pub media_type: &'static str,
}

impl std::fmt::Debug for Photo {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Photo({}, {} bytes)", self.media_type, self.bytes.len())
    }
}
