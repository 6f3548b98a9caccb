//! A retrieval in the journal: whom it is about, how far it has come, and who is before the entrance.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::places::Point;
use super::team::TeamShape;
use super::{Unparsed, names};
use hallsweep_core::event::RobotId;
use hallsweep_core::not_fetched::{Fetcher, NotFetched};
use hallsweep_core::place::Place;
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

/// How far it has come; the reason where it came to nothing.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
enum StageShape {
    MakingRoom,
    Fetching,
    LettingGo,
    GoingOut(Option<String>),
    ComingHome(Option<String>),
}

impl From<&Retrieval> for RetrievalShape {
    fn from(retrieval: &Retrieval) -> RetrievalShape {
        let words = |reason: &Option<NotFetched>| reason.as_ref().map(NotFetched::to_string);
        RetrievalShape {
            luggage: retrieval.luggage.0,
            fetcher: retrieval.fetcher.name().to_owned(),
            stage: match &retrieval.stage {
                RetrievalStage::MakingRoom => StageShape::MakingRoom,
                RetrievalStage::Fetching => StageShape::Fetching,
                RetrievalStage::LettingGo => StageShape::LettingGo,
                RetrievalStage::GoingOut(reason) => StageShape::GoingOut(words(reason)),
                RetrievalStage::ComingHome(reason) => StageShape::ComingHome(words(reason)),
            },
            piece: retrieval.piece.iter().copied().map(Point::from).collect(),
            call: retrieval.call.map(|alarm| alarm.0),
            team: retrieval.team.as_ref().map(TeamShape::from),
        }
    }
}

impl RetrievalShape {
    pub(super) fn retrieval(self) -> Result<Retrieval, Unparsed> {
        let read = |words: Option<String>| words.map(|words| NotFetched::from_words(&words));
        let fetcher = Fetcher::ALL.into_iter().find(|fetcher| fetcher.name() == self.fetcher);
        Ok(Retrieval {
            luggage: LuggageId(self.luggage),
            fetcher: fetcher.ok_or_else(|| Unparsed(format!("nobody called {:?} fetches", self.fetcher)))?,
            stage: match self.stage {
                StageShape::MakingRoom => RetrievalStage::MakingRoom,
                StageShape::Fetching => RetrievalStage::Fetching,
                StageShape::LettingGo => RetrievalStage::LettingGo,
                StageShape::GoingOut(reason) => RetrievalStage::GoingOut(read(reason)),
                StageShape::ComingHome(reason) => RetrievalStage::ComingHome(read(reason)),
            },
            piece: self.piece.into_iter().map(Into::into).collect(),
            call: self.call.map(AlarmId),
            team: self.team.map(TeamShape::team).transpose()?,
        })
    }
}

/// How many steps from home somebody is, where there are so many.
pub(super) fn steps(steps: u8) -> Result<u8, Unparsed> {
    (steps <= Place::FURTHEST).then_some(steps).ok_or_else(|| Unparsed(format!("nobody stands {steps} steps outside")))
}

pub(super) fn outside(shapes: &BTreeMap<String, u8>) -> Result<BTreeMap<RobotId, u8>, Unparsed> {
    shapes.iter().map(|(robot, count)| Ok((names::robot(robot)?, steps(*count)?))).collect()
}
