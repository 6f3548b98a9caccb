//! Where the robots of a retrieval can be: in a cell of the hall, or outside the entrance, beyond home. The content of
//! a cell is on the map.

use std::fmt;

use crate::units::{Cell, Heading};

/// A place that one base, or one parcel, fills.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Place {
    Cell(Cell),
    /// Outside the entrance: steps from home, at most [`Place::FURTHEST`]. There is room for all robots.
    Outside(u8),
}

impl Place {
    /// Number of steps that a train must go out, so that its parcel stands one step from home, beside the container.
    pub const FURTHEST: u8 = 2;

    /// Where robots wait to come in, and where the container stands.
    pub const ENTRANCE: Place = Place::Outside(1);

    /// `None` outside the hall.
    #[must_use]
    pub const fn cell(self) -> Option<Cell> {
        match self {
            Place::Cell(cell) => Some(cell),
            Place::Outside(_) => None,
        }
    }

    /// The places one step from here, the way out included if there is one.
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

    /// Whether two different places are one step apart, the way out included.
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
