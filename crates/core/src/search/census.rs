//! Counts where the known luggage stands: along walls, or inside the hall. From these counts, a search estimates
//! where more luggage stands.

/// Counts of visited cells and of cells with luggage. A cell is along a wall if one of the eight cells round it is
/// known to be wall. All other cells are inside.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Census {
    pub(super) visited_along: u32,
    pub(super) luggage_along: u32,
    pub(super) visited_inside: u32,
    pub(super) luggage_inside: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Terrain {
    /// Hardly any luggage inside the hall.
    Open,
    /// Some luggage, or not enough is known yet.
    Usual,
    /// Much luggage in the whole hall.
    Dense,
}

/// Cells that are added to every count, one tenth of them luggage: the assumption while nothing is known.
const IMAGINED: Share = Share { luggage: 1, cells: 10 };

/// Limits for the share of luggage, in percent. A hall with a smaller share than `OPEN` inside is open. A hall with a
/// larger share than `DENSE` in total is dense.
const OPEN: u64 = 7;
const DENSE: u64 = 15;

/// Minimum number of pieces along the walls. With fewer pieces, no conclusion is drawn.
const FEW: u32 = 4;

/// Number of cells with luggage, and number of all cells. `cells` includes the cells with luggage.
#[derive(Clone, Copy)]
struct Share {
    luggage: u32,
    cells: u32,
}

impl Share {
    const fn guessed(self) -> Share {
        Share { luggage: self.luggage + IMAGINED.luggage, cells: self.cells + IMAGINED.cells }
    }

    /// Returns the share of luggage in percent of the cells, rounded down.
    const fn hundredths(self) -> u64 {
        self.luggage as u64 * 100 / self.cells as u64
    }
}

impl Census {
    pub(super) const fn less(self, other: Census) -> Census {
        Census {
            visited_along: self.visited_along - other.visited_along,
            luggage_along: self.luggage_along - other.luggage_along,
            visited_inside: self.visited_inside - other.visited_inside,
            luggage_inside: self.luggage_inside - other.luggage_inside,
        }
    }

    pub(super) const fn and(self, other: Census) -> Census {
        Census {
            visited_along: self.visited_along + other.visited_along,
            luggage_along: self.luggage_along + other.luggage_along,
            visited_inside: self.visited_inside + other.visited_inside,
            luggage_inside: self.luggage_inside + other.luggage_inside,
        }
    }

    /// Number of cells that were visited or hold luggage.
    #[must_use]
    pub const fn looked_at(self) -> u32 {
        self.along() + self.inside().cells
    }

    pub(super) const fn along(self) -> u32 {
        self.visited_along + self.luggage_along
    }

    #[must_use]
    pub fn terrain(self) -> Terrain {
        let inside = self.inside();
        let all = Share { luggage: inside.luggage + self.luggage_along, cells: inside.cells + self.along() };
        if inside.guessed().hundredths() < OPEN {
            Terrain::Open
        } else if all.guessed().hundredths() > DENSE {
            Terrain::Dense
        } else {
            Terrain::Usual
        }
    }

    /// Whether luggage is more than 1.5 times as frequent along the walls as inside, with at least `FEW` pieces along
    /// the walls.
    #[must_use]
    pub fn is_lined(self) -> bool {
        let inside = self.inside().guessed();
        let along = u64::from(self.luggage_along) * u64::from(inside.cells);
        self.luggage_along >= FEW && along * 2 > u64::from(inside.luggage) * u64::from(self.along()) * 3
    }

    const fn inside(self) -> Share {
        Share { luggage: self.luggage_inside, cells: self.visited_inside + self.luggage_inside }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn census(along: (u32, u32), inside: (u32, u32)) -> Census {
        Census { visited_along: along.1, luggage_along: along.0, visited_inside: inside.1, luggage_inside: inside.0 }
    }

    #[test]
    fn a_hall_is_usual_until_enough_is_known() {
        for (census, terrain) in [
            (census((0, 0), (0, 0)), Terrain::Usual),
            (census((0, 40), (0, 2)), Terrain::Usual),
            (census((0, 40), (0, 20)), Terrain::Open),
            (census((20, 80), (2, 60)), Terrain::Open),
            (census((10, 90), (20, 180)), Terrain::Usual),
            (census((20, 80), (20, 80)), Terrain::Dense),
        ] {
            assert_eq!(census.terrain(), terrain, "{census:?}");
        }
    }

    #[test]
    fn a_hall_is_lined_where_luggage_stands_along_its_walls_and_not_inside() {
        assert!(!census((3, 1), (0, 0)).is_lined(), "three pieces say nothing");
        assert!(census((8, 32), (0, 0)).is_lined(), "a fifth is more than anybody expects");
        assert!(!census((4, 36), (0, 0)).is_lined());
        assert!(census((4, 36), (0, 40)).is_lined(), "inside there is none");
        assert!(!census((10, 40), (20, 80)).is_lined());
    }
}
