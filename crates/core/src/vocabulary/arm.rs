//! Actions of an arm, and the state that it reports. How an action is done, and how well a parcel is held, is left to
//! the robot.
//!
//! Quantities are whole numbers of small units, so that every value is read back exactly as it was written.

use crate::place::Place;
use crate::units::Piece;

/// One bounded action of an arm, or of the camera on it. Starting a controller takes no time. The controller then goes
/// on by itself, even under a halt, until the parcel is released.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArmAction {
    /// Look for a parcel at this place, or near it. The answer is `RobotEvent::Found`.
    FindParcel(Place),
    /// Bring the gripper to the parcel at this place, which is beside the base.
    AlignEndEffector(Place),
    CloseGripper,
    /// Start to control the gripping force.
    HoldForce,
    /// Start to control the angle of the paddle.
    HoldAngle,
    /// Start to control the distance to the other base.
    HoldDistance,
    Lift,
    Lower,
    /// Release a parcel that stands on the floor.
    Release,
}

impl ArmAction {
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            ArmAction::FindParcel(_) => "findParcel",
            ArmAction::AlignEndEffector(_) => "alignEndEffector",
            ArmAction::CloseGripper => "closeGripper",
            ArmAction::HoldForce => "holdForce",
            ArmAction::HoldAngle => "holdAngle",
            ArmAction::HoldDistance => "holdDistance",
            ArmAction::Lift => "lift",
            ArmAction::Lower => "lower",
            ArmAction::Release => "release",
        }
    }

    #[must_use]
    pub const fn is_motion(self) -> bool {
        match self {
            ArmAction::AlignEndEffector(_)
            | ArmAction::CloseGripper
            | ArmAction::Lift
            | ArmAction::Lower
            | ArmAction::Release => true,
            ArmAction::FindParcel(_) | ArmAction::HoldForce | ArmAction::HoldAngle | ArmAction::HoldDistance => false,
        }
    }
}

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
    pub enum Gripper {
        #[default]
        Open = "open",
        /// The gripper is closed, round a parcel or round nothing.
        Closed = "closed",
    }
}

/// A piece, and the place where it lies, or over which it is held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parcel {
    pub piece: Piece,
    /// The place of the piece. For a piece that covers several cells, it is the cell by which the piece is lifted.
    pub place: Place,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Controllers {
    pub force: bool,
    pub angle: bool,
    pub distance: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ArmState {
    pub gripper: Gripper,
    /// The place of the parcel at which the gripper is, not necessarily closed.
    pub aligned: Option<Place>,
    /// The parcel that is held: both grippers are closed round it.
    pub holds: Option<Parcel>,
    /// Whether the parcel is off the floor, all the way up.
    pub lifted: bool,
    /// Whether the parcel that is held stands on the floor. On the way up or down it is neither on the floor nor
    /// lifted.
    pub on_floor: bool,
    pub controllers: Controllers,
    /// The gripping force, in millinewtons; 0 when nothing is held.
    pub force_mn: i32,
    /// How far the paddle is from upright, in microradians.
    pub angle_urad: i32,
    /// The distance of the bases minus the wanted distance, in micrometres.
    pub gap_um: i32,
}
