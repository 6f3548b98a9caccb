//! What of a mission ends with the program: the way ahead and behind, and what is on its way to the store; and what a search is after.
//! What outlives the program is `crate::state`.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::command::{Move, Verdict};
use crate::effect::Fact;
use crate::units::{Cell, LuggageId, Seq, WallTime};

/// How many cells of the way behind the robot are shown.
const TRAIL: usize = 48;

/// What ends with the program.
#[derive(Clone, Debug, Default)]
pub struct Mission {
    /// The moves still to be made towards the goal; empty when they are to be planned anew.
    pub route: VecDeque<Move>,
    /// The cells behind the robot, the latest last.
    pub trail: VecDeque<Cell>,
    /// Whether the move by hand that the phase names has been ordered.
    pub is_driven: bool,
    /// Records on their way to the store.
    pub recording: Vec<Recording>,
    /// Verdicts on their way to the store; at most one a piece.
    pub deciding: Vec<Deciding>,
}

/// What a search is after.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// A cell to be visited, or found to be an obstacle.
    Visit(Cell),
    /// The home cell, before the search goes on.
    Home,
}

impl Goal {
    /// The cell it means.
    #[must_use]
    pub const fn cell(self) -> Cell {
        match self {
            Goal::Visit(cell) => cell,
            Goal::Home => Cell::HOME,
        }
    }
}

/// A piece that is not yet on record.
#[derive(Clone, Debug)]
pub struct Recording {
    /// Its place in the journal.
    pub seq: Seq,
    /// When it was found, or photographed again.
    pub wall: WallTime,
    /// What is being recorded.
    pub fact: Fact,
}

/// A verdict that is not yet on record.
#[derive(Clone, Debug)]
pub struct Deciding {
    /// Its place in the journal.
    pub seq: Seq,
    /// When it was given.
    pub wall: WallTime,
    /// The piece.
    pub luggage: LuggageId,
    /// What it will be once it is on record.
    pub verdict: Verdict,
    /// Who says so.
    pub who: Arc<str>,
}

impl Mission {
    /// Forgets the way of a search that ends.
    pub fn forget_way(&mut self) {
        self.route.clear();
        self.trail.clear();
    }

    /// Notes that the robot has left a cell.
    pub fn leave(&mut self, cell: Cell) {
        if self.trail.len() == TRAIL {
            self.trail.pop_front();
        }
        self.trail.push_back(cell);
    }

    /// The verdict on its way to the store for this piece.
    #[must_use]
    pub fn deciding(&self, luggage: LuggageId) -> Option<(Verdict, Seq)> {
        self.deciding.iter().find(|deciding| deciding.luggage == luggage).map(|deciding| (deciding.verdict, deciding.seq))
    }
}
