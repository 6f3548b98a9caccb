//! The part of a mission that ends with the program: the way ahead and behind, and the records on their way to the
//! store. `crate::state` has the part that outlives the program.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::command::{Move, Note, Verdict};
use crate::search::Gait;
use crate::search::pace::Pace;
use crate::state::fact::Fact;
use crate::units::{Cell, LuggageId, Seq, WallTime};

/// Number of cells behind the robot that are shown.
pub(crate) const TRAIL: usize = 48;

#[derive(Clone, Debug, Default)]
pub(crate) struct Mission {
    /// The moves still to be made towards the goal; empty when they are to be planned anew.
    pub(crate) route: VecDeque<Move>,
    /// Whether the sonar has seen anything new since the search was last asked.
    pub(crate) has_news: bool,
    pub(crate) pace: Pace,
    pub(crate) gait: Gait,
    /// The cells behind the robot, the latest last.
    pub(crate) trail: VecDeque<Cell>,
    /// Whether the move by hand that the phase names has been ordered.
    pub(crate) is_driven: bool,
    pub(crate) recording: Vec<Recording>,
    /// At most one verdict per piece.
    pub(crate) deciding: Vec<Deciding>,
}

#[derive(Clone, Debug)]
pub(crate) struct Recording {
    pub(crate) seq: Seq,
    /// When the piece was found, or photographed again.
    pub(crate) wall: WallTime,
    pub(crate) fact: Fact,
}

#[derive(Clone, Debug)]
pub(crate) struct Deciding {
    pub(crate) seq: Seq,
    pub(crate) wall: WallTime,
    pub(crate) luggage: LuggageId,
    pub(crate) verdict: Verdict,
    pub(crate) who: Arc<str>,
    pub(crate) note: Option<Note>,
}

impl Mission {
    pub(crate) fn forget_way(&mut self) {
        self.route.clear();
        self.trail.clear();
        self.pace = Pace::default();
    }

    pub(crate) fn leave(&mut self, cell: Cell) {
        if self.trail.len() == TRAIL {
            self.trail.pop_front();
        }
        self.trail.push_back(cell);
    }

    pub(crate) fn deciding(&self, luggage: LuggageId) -> Option<Verdict> {
        self.deciding.iter().find(|deciding| deciding.luggage == luggage).map(|deciding| deciding.verdict)
    }
}
