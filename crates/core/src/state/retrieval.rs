//! The stored state of a retrieval. After a restart, this state and the robots' own reports of their places decide
//! their next actions.

use std::collections::BTreeSet;

use crate::not_fetched::{Fetcher, NotFetched};
use crate::state::TeamState;
use crate::units::{AlarmId, Cell, LuggageId};

/// A retrieval that is under way or in fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Retrieval {
    pub luggage: LuggageId,
    pub fetcher: Fetcher,
    pub stage: RetrievalStage,
    /// The known cells on which the piece stands; empty while it is off the floor.
    pub piece: BTreeSet<Cell>,
    /// The robots' last call to the operator. The robots are held until this call is acknowledged.
    pub call: Option<AlarmId>,
    /// The state of the pair's behaviour trees; `None` before their first tick.
    pub team: Option<TeamState>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RetrievalStage {
    /// The robot that searches leaves home, so that the others can come in.
    MakingRoom,
    Fetching,
    /// The robot that fetches by itself has the piece at home and is about to release it.
    LettingGo,
    /// The robots that fetched go back outside. With `None`, the piece is in the container. Otherwise the value says
    /// why the piece cannot be fetched.
    GoingOut(Option<NotFetched>),
    /// The robot that searches comes home, while all other robots are outside. With `None`, the piece then counts as
    /// secured. Otherwise the value says why it was not fetched.
    ComingHome(Option<NotFetched>),
}

impl RetrievalStage {
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            RetrievalStage::MakingRoom => "makingRoom",
            RetrievalStage::Fetching => "fetching",
            RetrievalStage::LettingGo => "lettingGo",
            RetrievalStage::GoingOut(_) => "goingOut",
            RetrievalStage::ComingHome(_) => "comingHome",
        }
    }

    #[must_use]
    pub const fn reason(&self) -> Option<&NotFetched> {
        match self {
            RetrievalStage::GoingOut(reason) | RetrievalStage::ComingHome(reason) => reason.as_ref(),
            RetrievalStage::MakingRoom | RetrievalStage::Fetching | RetrievalStage::LettingGo => None,
        }
    }
}
