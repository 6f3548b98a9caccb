//! The places of robots during a retrieval: in a cell of the hall, or outside the entrance. The map says what a cell
//! contains.

use std::fmt;

use crate::units::{Cell, Heading};

/// The place of one robot base or of one parcel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Place {
    Cell(Cell),
    /// Outside the entrance, this number of steps from home, at most [`Place::FURTHEST`]. There is room for all
    /// robots.
    Outside(u8),
}

impl Place {
    /// Number of steps that the pair must go outside with a parcel between the two robots. The parcel then stands one
    /// step from home, beside the container.
    pub const FURTHEST: u8 = 2;

    /// The place where robots wait before they come in, and where the container stands.
    pub const ENTRANCE: Place = Place::Outside(1);

    /// Returns the cell, or `None` for a place outside the hall.
    #[must_use]
    pub const fn cell(self) -> Option<Cell> {
        match self {
            Place::Cell(cell) => Some(cell),
            Place::Outside(_) => None,
        }
    }

    /// Returns the places one step from here. If `way_out` is true, home is connected to the first place outside.
    pub fn neighbours(self, way_out: bool) -> impl Iterator<Item = Place> {
        let (cells, outer, inner) = match self {
            Place::Cell(cell) => (Some(cell.neighbours()), (way_out && cell == Cell::HOME).then_some(1), None),
            Place::Outside(steps) => (
                None,
                (steps < Place::FURTHEST).then_some(steps + 1),
                Some(if steps <= 1 { Place::Cell(Cell::HOME) } else { Place::Outside(steps - 1) }),
            ),
        };
        cells.into_iter().flatten().map(Place::Cell).chain(outer.map(Place::Outside)).chain(inner)
    }

    /// Whether two different places are one step apart. The step between home and outside counts.
    #[must_use]
    pub fn is_beside(self, other: Place) -> bool {
        self.neighbours(true).any(|place| place == other)
    }
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Cell(cell) => cell.fmt(f),
            Place::Outside(_) => f.write_str("outside"),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BasePose {
    pub place: Place,
    pub heading: Heading,
}
