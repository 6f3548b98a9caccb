//! Keep-out rings: the cells round the located bombs, which no robot enters by itself. Distances are between the
//! middles of cells.

use crate::units::{Cell, LuggageId};
use crate::world::hall_map::Bounds;

/// The side of a cell in a hall whose scale is unknown, in metres.
pub const USUAL_CELL_M: f64 = 0.5;

/// The rings round all bombs, all with the same radius. By default there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct KeepOut {
    rings: Vec<Ring>,
    /// In cells. A little more than the setting says, so that rounding does not open a cell at exactly this distance.
    radius: f64,
}

/// No ring at all.
pub static NOWHERE: KeepOut = KeepOut { rings: Vec::new(), radius: 0.0 };

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Ring {
    pub luggage: LuggageId,
    /// The known cells of the bomb.
    pub bomb: Vec<Cell>,
}

impl KeepOut {
    #[must_use]
    pub fn new(rings: Vec<Ring>, radius_m: f64, cell_m: f64) -> KeepOut {
        KeepOut { rings, radius: radius_m / cell_m + 1e-6 }
    }

    #[must_use]
    pub fn rings(&self) -> &[Ring] {
        &self.rings
    }

    /// Returns the radius, in cells.
    #[must_use]
    pub const fn radius(&self) -> f64 {
        self.radius
    }

    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.rings.is_empty()
    }

    #[must_use]
    pub fn contains(&self, cell: Cell) -> bool {
        self.around(cell).next().is_some()
    }

    /// Returns the bombs whose rings contain the cell.
    pub fn around(&self, cell: Cell) -> impl Iterator<Item = LuggageId> {
        let is_near = move |ring: &&Ring| clearance(&ring.bomb, cell).is_some_and(|least| least <= self.radius * self.radius);
        self.rings.iter().filter(is_near).map(|ring| ring.luggage)
    }

    /// Returns the sum of radius / distance over the bombs whose rings contain the cell, in thousandths.
    pub(crate) fn exposure(&self, cell: Cell) -> u64 {
        let squares = self.rings.iter().filter_map(|ring| clearance(&ring.bomb, cell));
        let within = squares.filter(|square| *square <= self.radius * self.radius);
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "positive, and bounded by the settings")]
        within.map(|square| (1000.0 * self.radius / square.sqrt().max(1.0)) as u64).sum()
    }

    /// Returns the cells of the rings within `bounds`. Cells of two rings occur twice.
    pub(crate) fn cells_within(&self, bounds: Bounds) -> impl Iterator<Item = Cell> {
        #[expect(clippy::cast_possible_truncation, reason = "the radius is bounded by the settings")]
        let reach = self.radius as i32;
        let boxes = self.rings.iter().flat_map(|ring| &ring.bomb).map(move |bomb| Bounds::of(*bomb).grown(reach));
        let cells = boxes.flat_map(move |near| {
            let (left, right) = (near.least.x.max(bounds.least.x), near.most.x.min(bounds.most.x));
            let rows = near.least.y.max(bounds.least.y)..=near.most.y.min(bounds.most.y);
            rows.flat_map(move |y| (left..=right).map(move |x| Cell::new(x, y)))
        });
        cells.filter(|cell| self.contains(*cell))
    }
}

fn clearance(bomb: &[Cell], cell: Cell) -> Option<f64> {
    let square = |from: &Cell| {
        let (x, y) = (f64::from(from.x) - f64::from(cell.x), f64::from(from.y) - f64::from(cell.y));
        x * x + y * y
    };
    bomb.iter().map(square).min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_ring_takes_in_every_cell_up_to_its_radius_and_none_beyond() {
        let bomb = Cell::new(4, -2);
        let ring = |radius_m, cell_m| KeepOut::new(vec![Ring { luggage: LuggageId(3), bomb: vec![bomb] }], radius_m, cell_m);
        for (radius_m, cell_m, count) in [(0.0, 0.5, 1), (0.49, 0.5, 1), (0.5, 0.5, 5), (0.3, 0.1, 29), (1.0, 0.5, 13)] {
            let ring = ring(radius_m, cell_m);
            let cells: Vec<Cell> = ring.cells_within(Bounds::of(bomb).grown(9)).collect();
            assert_eq!(cells.len(), count, "{radius_m} m, cells of {cell_m} m");
            assert!(cells.iter().all(|cell| ring.contains(*cell)));
        }
        assert_eq!(ring(1.0, 0.5).cells_within(Bounds::of(bomb)).count(), 1);
        assert!(!KeepOut::default().contains(bomb));
    }

    #[test]
    fn a_piece_of_several_cells_has_a_ring_round_each_of_them() {
        let ring = Ring { luggage: LuggageId(3), bomb: vec![Cell::new(0, 0), Cell::new(5, 0)] };
        let keep_out = KeepOut::new(vec![ring], 1.0, 1.0);
        assert!(keep_out.contains(Cell::new(6, 0)) && keep_out.contains(Cell::new(-1, 0)) && !keep_out.contains(Cell::new(2, 0)));
        assert_eq!([3, 4, 5].map(|x| keep_out.exposure(Cell::new(x, 0))), [0, 1000, 1000]);
    }
}
