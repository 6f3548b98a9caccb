//! What the leaves of the trees read, and what they return: proposals to the two robots, and calls to the operator. A
//! proposal by itself moves nothing. The engine decides at the gate whether it is carried out. A proposal is repeated
//! at each tick while it is wanted.

use std::collections::BTreeSet;

use crate::arm::{ArmAction, ArmState};
use crate::effect::Action;
use crate::pair::Which;
use crate::place::{BasePose, Place};
use crate::units::{Cell, Piece};
use crate::world::hall_map::HallMap;
use crate::world::keep_out::KeepOut;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BaseView {
    /// The place and heading of the robot at the end of its last completed order.
    pub stands: BasePose,
    /// Whether the robot is away from `stands` and must be recentred first.
    pub off_centre: bool,
    /// The order that the robot has not answered.
    pub open: Option<Action>,
    /// Number of consecutive orders, of any kind, that the robot answered with `Failed` or did not answer. Any other
    /// answer resets the count.
    pub failures: u32,
    pub arm: ArmState,
}

#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    pub map: &'a HallMap,
    /// Whether a way leads from home to the places outside.
    pub way_out: bool,
    /// The places of other robots, which both robots of the pair avoid.
    pub others: &'a [Place],
    /// The known cells of the piece that is to be fetched next; empty if nothing is left to fetch. While the robots
    /// hold the piece, these are the cells where it stood before, which are now free.
    pub piece: &'a BTreeSet<Cell>,
    /// The only piece that may be fetched; `None` if any piece may be fetched. If it is set, another piece counts
    /// neither as recognised nor as held.
    pub wanted: Option<Piece>,
    /// Where the parcel is to be put: the target area, or the container.
    pub target: Place,
    /// Both robots, in the order of `Which::ALL`.
    pub bases: [BaseView; 2],
    /// Whether a call to the operator has not been acknowledged yet.
    pub is_calling: bool,
    /// The rings of other bombs, which neither robot enters.
    pub kept_out: &'a KeepOut,
}

impl View<'_> {
    #[must_use]
    pub const fn base(&self, which: Which) -> &BaseView {
        &self.bases[which.index()]
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Proposal {
    pub which: Which,
    pub action: Action,
}

impl Proposal {
    #[must_use]
    pub const fn arm(which: Which, action: ArmAction) -> Proposal {
        Proposal { which, action: Action::Arm(action) }
    }
}
