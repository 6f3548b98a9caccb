//! A retrieval in the journal: its piece, its fetcher and its stage, and the robots outside the hall.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::coded::{CodeOrSentence, Form};
use super::places::Point;
use super::team::TeamShape;
use super::{Unparsed, names};
use hallsweep_core::not_fetched::NotFetched;
use hallsweep_core::place::Place;
use hallsweep_core::robot::RobotId;
use hallsweep_core::state::{Retrieval, RetrievalStage};
use hallsweep_core::units::{AlarmId, LuggageId};

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct RetrievalShape {
    luggage: u64,
    fetcher: String,
    stage: StageShape,
    piece: Vec<Point>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    call: Option<u64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    team: Option<TeamShape>,
}

/// Stage of a retrieval, with the reason when the piece was not fetched.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
enum StageShape {
    MakingRoom,
    Fetching,
    LettingGo,
    GoingOut(Option<CodeOrSentence>),
    ComingHome(Option<CodeOrSentence>),
}

impl RetrievalShape {
    pub(super) fn of(retrieval: &Retrieval, form: Form) -> RetrievalShape {
        let why = |reason: &Option<NotFetched>| reason.as_ref().map(|reason| CodeOrSentence::of(reason, form));
        RetrievalShape {
            luggage: retrieval.luggage.0,
            fetcher: retrieval.fetcher.name().to_owned(),
            stage: match &retrieval.stage {
                RetrievalStage::MakingRoom => StageShape::MakingRoom,
                RetrievalStage::Fetching => StageShape::Fetching,
                RetrievalStage::LettingGo => StageShape::LettingGo,
                RetrievalStage::GoingOut(reason) => StageShape::GoingOut(why(reason)),
                RetrievalStage::ComingHome(reason) => StageShape::ComingHome(why(reason)),
            },
            piece: retrieval.piece.iter().copied().map(Point::from).collect(),
            call: retrieval.call.map(|alarm| alarm.0),
            team: retrieval.team.as_ref().map(TeamShape::from),
        }
    }

    pub(super) fn retrieval(self) -> Result<Retrieval, Unparsed> {
        Ok(Retrieval {
            luggage: LuggageId(self.luggage),
            fetcher: names::fetcher(&self.fetcher)?,
            stage: match self.stage {
                StageShape::MakingRoom => RetrievalStage::MakingRoom,
                StageShape::Fetching => RetrievalStage::Fetching,
                StageShape::LettingGo => RetrievalStage::LettingGo,
                StageShape::GoingOut(reason) => RetrievalStage::GoingOut(reason.map(CodeOrSentence::value).transpose()?),
                StageShape::ComingHome(reason) => RetrievalStage::ComingHome(reason.map(CodeOrSentence::value).transpose()?),
            },
            piece: self.piece.into_iter().map(Into::into).collect(),
            call: self.call.map(AlarmId),
            team: self.team.map(TeamShape::team).transpose()?,
        })
    }
}

/// Checks how far outside the hall a robot stands, in steps from home. A distance above `Place::FURTHEST` is refused.
pub(super) fn steps(steps: u8) -> Result<u8, Unparsed> {
    (steps <= Place::FURTHEST)
        .then_some(steps)
        .ok_or_else(|| Unparsed(format!("no robot can stand {steps} steps outside the hall")))
}

pub(super) fn outside(shapes: &BTreeMap<String, u8>) -> Result<BTreeMap<RobotId, u8>, Unparsed> {
    shapes.iter().map(|(robot, count)| Ok((names::robot(robot)?, steps(*count)?))).collect()
}
