//! The part of a mission that is lost when the program ends: the planned way, the past way, and the records that are
//! not stored yet. `crate::state` has the part that survives.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::command::{Hot, Move, Note, Verdict};
use crate::search::Gait;
use crate::search::pace::Pace;
use crate::state::fact::Fact;
use crate::units::{Cell, LuggageId, Seq, WallTime};
use crate::world::luggage::Judgement;

/// Maximum number of passed cells that are shown.
pub(crate) const TRAIL: usize = 48;

#[derive(Clone, Debug, Default)]
pub(crate) struct Mission {
    /// The remaining moves towards the goal; empty if they must be planned again.
    pub(crate) route: VecDeque<Move>,
    /// Whether the sonar has seen anything new since the strategy was last asked.
    pub(crate) has_news: bool,
    pub(crate) pace: Pace,
    pub(crate) gait: Gait,
    /// The cells that the robot has passed, the latest last.
    pub(crate) trail: VecDeque<Cell>,
    /// Whether the robot already has the order for the present move by hand.
    pub(crate) is_driven: bool,
    /// Number of moves on the way to the present view of a piece.
    pub(crate) view_moves: usize,
    pub(crate) recording: Vec<Recording>,
    /// The verdicts on their way to the store, at most one for each piece.
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
    pub(crate) hot: Hot,
    /// The answers of other judges, which become public with the verdict.
    pub(crate) judged: Vec<Judgement>,
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
