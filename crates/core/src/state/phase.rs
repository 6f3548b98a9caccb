//! The phases of a mission, each with exactly the data it needs (mission §4). `table` has the transitions.

use crate::command::Move;
use crate::phase::{FaultCause, PhaseName};
use crate::units::{Cell, LuggageId, Piece, Pose};

#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    Idle,
    /// Searching, including the last way home.
    Exploring,
    /// Inspecting a piece of luggage, from the moment when the robot meets it.
    Inspecting(Inspection),
    Driving {
        /// The destination of a goto; `None` for a single move.
        goal: Option<Cell>,
        next: Option<Move>,
        interrupted: Box<Phase>,
    },
    /// On the way home after backHome.
    ReturningHome,
    /// At home after backHome, waiting for START.
    AtHome,
    /// On the way home after danger.
    ReturningWithAlarm,
    /// The robot is home, and a dangerous piece is known to be in the hall.
    BombLocated,
    Retrieving,
    BagSecured,
    /// The whole hall is searched and the robot is home.
    Explored,
    Fault {
        cause: FaultCause,
        /// The phase to which START returns once the cause is gone.
        interrupted: Box<Phase>,
    },
}

impl Phase {
    #[must_use]
    pub const fn name(&self) -> PhaseName {
        match self {
            Phase::Idle => PhaseName::Idle,
            Phase::Exploring => PhaseName::Exploring,
            Phase::Inspecting(_) => PhaseName::Inspecting,
            Phase::Driving { .. } => PhaseName::Driving,
            Phase::ReturningHome => PhaseName::ReturningHome,
            Phase::AtHome => PhaseName::AtHome,
            Phase::ReturningWithAlarm => PhaseName::ReturningWithAlarm,
            Phase::BombLocated => PhaseName::BombLocated,
            Phase::Retrieving => PhaseName::Retrieving,
            Phase::BagSecured => PhaseName::BagSecured,
            Phase::Explored => PhaseName::Explored,
            Phase::Fault { .. } => PhaseName::Fault,
        }
    }

    #[must_use]
    pub fn interrupted(&self) -> Option<&Phase> {
        if let Phase::Driving { interrupted, .. } | Phase::Fault { interrupted, .. } = self { Some(interrupted) } else { None }
    }

    /// Returns the phase that continues when every interruption has ended. Without an interruption, returns this
    /// phase.
    pub(crate) fn underlying(&self) -> &Phase {
        self.interrupted().map_or(self, Phase::underlying)
    }

    /// Returns the phase below this many interruptions, or the innermost phase if there are fewer interruptions.
    pub(crate) fn below_mut(&mut self, depth: usize) -> &mut Phase {
        if depth == 0 || self.interrupted().is_none() {
            return self;
        }
        let (Phase::Driving { interrupted, .. } | Phase::Fault { interrupted, .. }) = self else { return self };
        interrupted.below_mut(depth - 1)
    }

    pub(crate) fn underlying_mut(&mut self) -> &mut Phase {
        self.below_mut(usize::MAX)
    }

    /// Returns the inspection under way, even if it is interrupted.
    #[must_use]
    pub fn inspection(&self) -> Option<&Inspection> {
        if let Phase::Inspecting(inspection) = self.underlying() { Some(inspection) } else { None }
    }

    pub(crate) const fn fault(&self) -> Option<&FaultCause> {
        if let Phase::Fault { cause, .. } = self { Some(cause) } else { None }
    }

    /// Whether the robot moves in this phase if nothing holds the robot.
    pub(crate) const fn is_motion(&self) -> bool {
        match self {
            Phase::Exploring | Phase::ReturningHome | Phase::ReturningWithAlarm | Phase::Driving { .. } | Phase::Retrieving => {
                true
            }
            Phase::Inspecting(inspection) => matches!(inspection.stage, Stage::BackingUp | Stage::Viewing(_)),
            Phase::Idle | Phase::AtHome | Phase::BombLocated | Phase::BagSecured | Phase::Explored | Phase::Fault { .. } => false,
        }
    }

    /// Whether a mission is under way. If so, raising a hold also raises `awaitingStart`.
    #[must_use]
    pub fn is_mission(&self) -> bool {
        !matches!(self.underlying(), Phase::Idle | Phase::Explored | Phase::BagSecured) || self.fault().is_some()
    }
}

#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    pub cell: Cell,
    /// The number that the camera recognised, if it recognised one.
    pub piece: Option<Piece>,
    /// Where the robot stands to take the photo.
    pub pose: Pose,
    pub stage: Stage,
    /// Number of further photos that the robot has to take from other places, because a judge was unsure.
    pub views: u8,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Returning to the centre of the cell from which the robot came.
    BackingUp,
    TakingPhoto,
    Recording(LuggageId),
    /// The record is in the store, and the operator must decide.
    AwaitingVerdict(LuggageId),
    /// The photo is being taken again, and the operator may decide meanwhile.
    RetakingPhoto(LuggageId),
    /// Driving to another side of the piece, because a judge was unsure. The operator may decide meanwhile.
    Viewing(LuggageId),
}

impl Inspection {
    /// Whether the robot goes round the piece, because a judge was unsure.
    #[must_use]
    pub const fn is_viewing(&self) -> bool {
        self.views > 0 || matches!(self.stage, Stage::Viewing(_))
    }

    #[must_use]
    pub const fn luggage(&self) -> Option<LuggageId> {
        match self.stage {
            Stage::Recording(id) | Stage::AwaitingVerdict(id) | Stage::RetakingPhoto(id) | Stage::Viewing(id) => Some(id),
            Stage::BackingUp | Stage::TakingPhoto => None,
        }
    }
}
