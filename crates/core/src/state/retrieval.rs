//! The stored state of a retrieval, from which it goes on after a restart. The next actions of its robots follow from
//! this and from their own reports of where they stand.

use std::collections::BTreeSet;

use crate::not_fetched::{Fetcher, NotFetched};
use crate::state::TeamState;
use crate::units::{AlarmId, Cell, LuggageId};

/// A retrieval under way, or in fault.
#[derive(Clone, Debug, PartialEq)]
pub struct Retrieval {
    pub luggage: LuggageId,
    pub fetcher: Fetcher,
    pub stage: RetrievalStage,
    /// The known cells on which the piece stands; none while it is off the floor.
    pub piece: BTreeSet<Cell>,
    /// The robots' last call to the operator, which holds them until it is acknowledged.
    pub call: Option<AlarmId>,
    /// The state of the pair's trees, once they have been ticked.
    pub team: Option<TeamState>,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RetrievalStage {
    /// The robot that searches leaves home, so that the others can come in.
    MakingRoom,
    Fetching,
    /// The robot that fetches by itself has the piece at home and is about to release it.
    LettingGo,
    /// The robots that fetched go back outside. The piece is in the container, or cannot be fetched for this reason.
    GoingOut(Option<NotFetched>),
    /// The robot that searches comes home, while all others are outside. Then the piece counts as secured, or, for this
    /// reason, as not fetched.
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
