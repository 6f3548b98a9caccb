//! What a mission is made of, beside the map it makes: number, phase, holds, search, goal, and what is on its way to the store.

use std::collections::{BTreeSet, VecDeque};

use super::{Hold, Holds, Phase};
use crate::command::{Move, Verdict};
use crate::effect::Fact;
use crate::explore::{Search, Strategy};
use crate::units::{Cell, Epoch, LuggageId, MissionId, Seq};
use crate::world::luggage::{Decision, Luggage};

/// How many cells of the way behind the robot are shown.
const TRAIL: usize = 48;

/// A mission, or the idle time between two.
#[derive(Clone, Debug)]
pub struct Mission {
    /// The number of this mission, or of the last.
    pub id: MissionId,
    /// Whether it has begun and is not archived yet.
    pub under_way: bool,
    /// Where it stands.
    pub phase: Phase,
    /// What holds it.
    pub holds: Holds,
    /// Raised by every stop.
    pub epoch: Epoch,
    /// The order of the search.
    pub strategy: Strategy,
    /// How far the search has come.
    pub search: Search,
    /// What the search is after; kept through every interruption.
    pub goal: Option<Goal>,
    /// The moves still to be made towards it; empty when they are to be planned anew.
    pub route: VecDeque<Move>,
    /// The cells behind the robot, the latest last.
    pub trail: VecDeque<Cell>,
    /// Cells that were free once and blocked later.
    pub blocked: BTreeSet<Cell>,
    /// The number of the last piece of luggage of all missions.
    pub last_luggage: LuggageId,
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
    /// What will be shown once it is on record.
    pub luggage: Luggage,
    /// What is being recorded, in case the store loses it.
    pub fact: Fact,
}

/// A verdict that is not yet on record.
#[derive(Clone, Debug)]
pub struct Deciding {
    /// Its place in the journal.
    pub seq: Seq,
    /// The piece.
    pub luggage: LuggageId,
    /// What it will be once it is on record.
    pub decision: Decision,
}

impl Mission {
    /// Before the first mission. No robot is linked yet, so nothing moves.
    #[must_use]
    pub fn new(strategy: Strategy) -> Mission {
        let mut holds = Holds::default();
        holds.raise(Hold::RobotLink);
        Mission {
            id: MissionId(0),
            under_way: false,
            phase: Phase::Idle,
            holds,
            epoch: Epoch(0),
            strategy,
            search: strategy.begin(),
            goal: None,
            route: VecDeque::new(),
            trail: VecDeque::new(),
            blocked: BTreeSet::new(),
            last_luggage: LuggageId(0),
            recording: Vec::new(),
            deciding: Vec::new(),
        }
    }

    /// Begins the search anew.
    pub fn restart_search(&mut self) {
        self.search = self.strategy.begin();
        self.goal = None;
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
        self.deciding
            .iter()
            .find(|deciding| deciding.luggage == luggage)
            .map(|deciding| (deciding.decision.verdict, deciding.seq))
    }
}
