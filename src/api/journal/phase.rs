//! Phases in the journal with their data. An interrupted phase is stored inside the phase that interrupts it.

use serde::{Deserialize, Serialize};

use super::Unparsed;
use super::coded::{CodeOrSentence, Form};
use super::names::Step;
use super::places::{Point, PoseShape};
use hallsweep_core::phase::FaultCause;
use hallsweep_core::state::{Inspection, Phase, Stage};
use hallsweep_core::units::{LuggageId, Piece};

/// A phase. Its name is the same as at the doors.
#[derive(Serialize, Deserialize)]
#[serde(tag = "name", rename_all = "camelCase")]
pub(super) enum PhaseShape {
    Idle,
    Exploring,
    Inspecting(InspectionShape),
    Driving { goal: Option<Point>, next: Option<Step>, interrupted: Box<PhaseShape> },
    ReturningHome,
    AtHome,
    ReturningWithAlarm,
    BombLocated,
    Retrieving,
    BagSecured,
    Explored,
    Fault { cause: CauseShape, interrupted: Box<PhaseShape> },
}

#[derive(Serialize, Deserialize)]
pub(super) struct InspectionShape {
    cell: Point,
    piece: Option<u32>,
    pose: PoseShape,
    stage: StageShape,
    /// Number of further photos from other places, for a judge who was unsure.
    #[serde(default, skip_serializing_if = "is_none_left")]
    views: u8,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it so")]
const fn is_none_left(views: &u8) -> bool {
    *views == 0
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
enum StageShape {
    BackingUp,
    TakingPhoto,
    Recording(u64),
    AwaitingVerdict(u64),
    RetakingPhoto(u64),
    Viewing(u64),
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) enum CauseShape {
    NoWayHome,
    Unanswered,
    Undecided,
    Robot(String),
    NotFetched(CodeOrSentence),
}

impl PhaseShape {
    pub(super) fn of(phase: &Phase, form: Form) -> PhaseShape {
        let of = |phase| Box::new(PhaseShape::of(phase, form));
        match phase {
            Phase::Idle => PhaseShape::Idle,
            Phase::Exploring => PhaseShape::Exploring,
            Phase::Inspecting(inspection) => PhaseShape::Inspecting(inspection.into()),
            Phase::Driving { goal, next, interrupted } => {
                PhaseShape::Driving { goal: goal.map(Point::from), next: next.map(Step::from), interrupted: of(interrupted) }
            }
            Phase::ReturningHome => PhaseShape::ReturningHome,
            Phase::AtHome => PhaseShape::AtHome,
            Phase::ReturningWithAlarm => PhaseShape::ReturningWithAlarm,
            Phase::BombLocated => PhaseShape::BombLocated,
            Phase::Retrieving => PhaseShape::Retrieving,
            Phase::BagSecured => PhaseShape::BagSecured,
            Phase::Explored => PhaseShape::Explored,
            Phase::Fault { cause, interrupted } => {
                PhaseShape::Fault { cause: CauseShape::of(cause, form), interrupted: of(interrupted) }
            }
        }
    }

    pub(super) fn phase(self) -> Result<Phase, Unparsed> {
        Ok(match self {
            PhaseShape::Idle => Phase::Idle,
            PhaseShape::Exploring => Phase::Exploring,
            PhaseShape::Inspecting(inspection) => Phase::Inspecting(inspection.inspection()?),
            PhaseShape::Driving { goal, next, interrupted } => Phase::Driving {
                goal: goal.map(Into::into),
                next: next.map(Into::into),
                interrupted: Box::new(interrupted.phase()?),
            },
            PhaseShape::ReturningHome => Phase::ReturningHome,
            PhaseShape::AtHome => Phase::AtHome,
            PhaseShape::ReturningWithAlarm => Phase::ReturningWithAlarm,
            PhaseShape::BombLocated => Phase::BombLocated,
            PhaseShape::Retrieving => Phase::Retrieving,
            PhaseShape::BagSecured => Phase::BagSecured,
            PhaseShape::Explored => Phase::Explored,
            PhaseShape::Fault { cause, interrupted } => {
                Phase::Fault { cause: cause.cause()?, interrupted: Box::new(interrupted.phase()?) }
            }
        })
    }
}

impl From<&Inspection> for InspectionShape {
    fn from(inspection: &Inspection) -> InspectionShape {
        InspectionShape {
            cell: inspection.cell.into(),
            piece: inspection.piece.map(|piece| piece.0),
            pose: inspection.pose.into(),
            stage: match inspection.stage {
                Stage::BackingUp => StageShape::BackingUp,
                Stage::TakingPhoto => StageShape::TakingPhoto,
                Stage::Recording(id) => StageShape::Recording(id.0),
                Stage::AwaitingVerdict(id) => StageShape::AwaitingVerdict(id.0),
                Stage::RetakingPhoto(id) => StageShape::RetakingPhoto(id.0),
                Stage::Viewing(id) => StageShape::Viewing(id.0),
            },
            views: inspection.views,
        }
    }
}

impl InspectionShape {
    fn inspection(self) -> Result<Inspection, Unparsed> {
        let stage = match self.stage {
            StageShape::BackingUp => Stage::BackingUp,
            StageShape::TakingPhoto => Stage::TakingPhoto,
            StageShape::Recording(id) => Stage::Recording(LuggageId(id)),
            StageShape::AwaitingVerdict(id) => Stage::AwaitingVerdict(LuggageId(id)),
            StageShape::RetakingPhoto(id) => Stage::RetakingPhoto(LuggageId(id)),
            StageShape::Viewing(id) => Stage::Viewing(LuggageId(id)),
        };
        Ok(Inspection { cell: self.cell.into(), piece: self.piece.map(Piece), pose: self.pose.pose()?, stage, views: self.views })
    }
}

impl CauseShape {
    pub(super) fn of(cause: &FaultCause, form: Form) -> CauseShape {
        match cause {
            FaultCause::NoWayHome => CauseShape::NoWayHome,
            FaultCause::Unanswered => CauseShape::Unanswered,
            FaultCause::Undecided => CauseShape::Undecided,
            FaultCause::Robot(words) => CauseShape::Robot(words.clone()),
            FaultCause::NotFetched(why) => CauseShape::NotFetched(CodeOrSentence::of(why, form)),
        }
    }

    pub(super) fn cause(self) -> Result<FaultCause, Unparsed> {
        Ok(match self {
            CauseShape::NoWayHome => FaultCause::NoWayHome,
            CauseShape::Unanswered => FaultCause::Unanswered,
            CauseShape::Undecided => FaultCause::Undecided,
            CauseShape::Robot(words) => FaultCause::Robot(words),
            CauseShape::NotFetched(why) => FaultCause::NotFetched(why.value()?),
        })
    }
}
