//! What a strategy reads, and what it can return. A strategy sees only the grid, never the map that the interfaces
//! show.

use super::areas::Focus;
use super::costs::Costs;
use super::grid::{Grid, Spot};
use crate::command::Move;
use crate::units::{Cell, Pose};

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Objective {
        #[default]
        Find = "find",
        /// Cover the whole hall with few moves.
        Cover = "cover",
    }
}

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Sensing {
        #[default]
        Bump = "bump",
        /// The robot sees obstacles by its front sonar before it reaches them.
        Sonar = "sonar",
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Terms {
    pub objective: Objective,
    /// Range of the robot's sonar, in cells; 0 for a robot that finds obstacles by driving into them.
    pub sonar_cells: u8,
    pub costs: Costs,
}

/// The robot's last turn, and how far it has driven straight on since this turn. The score of a cell depends on both.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Gait {
    /// The last turn: −1 to the left, 1 to the right, 0 if the robot has not turned yet.
    pub turn: i8,
    /// Number of cells driven straight on since the last turn.
    pub run: u8,
}

impl Gait {
    #[must_use]
    pub const fn after(self, step: Move) -> Gait {
        match step {
            Move::Forward => Gait { run: self.run.saturating_add(1), ..self },
            Move::TurnLeft => Gait { turn: -1, run: 0 },
            Move::TurnRight => Gait { turn: 1, run: 0 },
            Move::Backward | Move::NudgeLeft | Move::NudgeRight => self,
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub struct View<'a> {
    pub grid: &'a Grid,
    pub pose: Pose,
    pub gait: Gait,
    pub terms: Terms,
    /// `None` if the hall has no areas.
    pub areas: Option<Focus<'a>>,
}

impl View<'_> {
    /// Whether a strategy may choose this cell.
    pub(super) fn wants(&self, spot: Spot) -> bool {
        self.areas.is_none_or(|Focus { plan, wanted }| wanted >> plan.rows.at(self.grid.cell(spot)) & 1 == 1)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Goal {
    /// Visit a cell, or find that it is an obstacle.
    Visit(Cell),
    Home,
}

impl Goal {
    #[must_use]
    pub const fn cell(self) -> Cell {
        match self {
            Goal::Visit(cell) => cell,
            Goal::Home => Cell::HOME,
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NextGoal {
    /// Go to this cell by these moves, or find out what stands there. If there are no moves, take the cheapest
    /// way and assume that unknown cells are free.
    Visit(Cell, Vec<Move>),
    /// Go home. At home, ask the strategy again.
    GoHome,
    /// Nothing unknown can be reached.
    Finished,
}
