//! The actions of a robot arm, and the state that the arm reports. The robot itself decides how it does an action and
//! how it holds a parcel.
//!
//! Quantities are whole numbers in small units, because a whole number is read back exactly as it was written.

use crate::place::Place;
use crate::units::Piece;

/// One bounded action of a robot arm, or of the camera on the arm. A controller starts at once. It then runs by
/// itself, even while the robot is halted, until the parcel is released.
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
        /// The gripper is closed, with or without a parcel.
        Closed = "closed",
    }
}

/// A piece of luggage and its place. For a lifted piece, it is the place below the piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Parcel {
    pub piece: Piece,
    /// The place of the piece. If the piece covers several cells, this is the cell at which the piece is lifted.
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
    /// The place of the parcel that the gripper has reached. The gripper may still be open.
    pub aligned: Option<Place>,
    /// The parcel that is held. The grippers of both robots are closed round it.
    pub holds: Option<Parcel>,
    /// Whether the parcel is at its full height above the floor.
    pub lifted: bool,
    /// Whether the held parcel stands on the floor. While the parcel moves up or down, `on_floor` and `lifted` are
    /// both false.
    pub on_floor: bool,
    pub controllers: Controllers,
    /// The gripping force, in millinewtons; 0 when nothing is held.
    pub force_mn: i32,
    /// The angle between the paddle and its upright position, in microradians.
    pub angle_urad: i32,
    /// The distance between the two bases minus the wanted distance, in micrometres.
    pub gap_um: i32,
}
