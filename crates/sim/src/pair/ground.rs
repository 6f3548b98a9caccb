//! The true state of the floor on which the pair drives. Pieces that were taken away are gone, and pieces that were
//! put down elsewhere are there. The positions of the two bases are not known here.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use super::super::hall::{Hall, Truth};
use hallsweep_core::arm::Parcel;
use hallsweep_core::place::Place;
use hallsweep_core::units::{Cell, Piece};

/// Greatest distance at which the camera recognises a parcel, in steps from the place at which the camera looks. This
/// is enough for a pallet and the floor around it.
const SIGHT: u32 = 12;

#[derive(Clone, Debug)]
pub(super) struct PairGround {
    hall: Arc<Hall>,
    /// Where each piece that was ever lifted is now. Even a large piece has one place. `None` while the piece is in
    /// the grippers or in the container.
    moved: BTreeMap<Piece, Option<Place>>,
    taken_in: Vec<Piece>,
    /// Cells that were closed permanently.
    closed: BTreeSet<Cell>,
    blocked: BTreeSet<Cell>,
}

impl PairGround {
    #[cfg(test)]
    pub(super) const fn new(hall: Arc<Hall>) -> PairGround {
        PairGround { hall, moved: BTreeMap::new(), taken_in: Vec::new(), closed: BTreeSet::new(), blocked: BTreeSet::new() }
    }

    pub(super) fn remembered(hall: Arc<Hall>, lying: &[(Piece, Place)], taken_in: &[Piece], closed: &[Cell]) -> PairGround {
        let inside = taken_in.iter().map(|piece| (*piece, None));
        PairGround {
            hall,
            moved: lying.iter().map(|(piece, place)| (*piece, Some(*place))).chain(inside).collect(),
            taken_in: taken_in.to_vec(),
            closed: closed.iter().copied().collect(),
            blocked: BTreeSet::new(),
        }
    }

    pub(super) fn hall(&self) -> &Hall {
        &self.hall
    }

    pub(super) fn taken_in(&self) -> &[Piece] {
        &self.taken_in
    }

    pub(super) fn closed(&self) -> impl Iterator<Item = Cell> {
        self.closed.iter().copied()
    }

    /// Pieces that were put down or fell, with their new places.
    pub(super) fn lying(&self) -> impl Iterator<Item = (Piece, Place)> {
        self.moved.iter().filter_map(|(piece, place)| Some((*piece, (*place)?)))
    }

    pub(super) fn moved(&self) -> impl Iterator<Item = (Piece, Option<Place>)> {
        self.moved.iter().map(|(piece, place)| (*piece, *place))
    }

    /// The content of a cell. The two bases are not considered.
    pub(super) fn truth(&self, cell: Cell) -> Truth {
        if self.closed.contains(&cell) || self.blocked.contains(&cell) {
            return Truth::Wall;
        }
        if let Some((piece, _)) = self.lying().find(|(_, place)| *place == Place::Cell(cell)) {
            return Truth::Luggage(piece);
        }
        match self.hall.truth(cell) {
            Truth::Luggage(piece) if self.moved.contains_key(&piece) => Truth::Free,
            truth @ (Truth::Free | Truth::Wall | Truth::Luggage(_)) => truth,
        }
    }

    pub(super) fn piece_at(&self, place: Place) -> Option<Piece> {
        match place {
            Place::Cell(cell) => match self.truth(cell) {
                Truth::Luggage(piece) => Some(piece),
                Truth::Free | Truth::Wall => None,
            },
            Place::Outside(_) => self.lying().find(|(_, lies)| *lies == place).map(|(piece, _)| piece),
        }
    }

    /// The nearest piece within sight of a place, with the nearest of its cells. Of equally near pieces, the one with
    /// the lowest number is chosen.
    pub(super) fn nearest(&self, place: Place) -> Option<Parcel> {
        if let Some(piece) = self.piece_at(place) {
            return Some(Parcel { piece, place });
        }
        let from = place.cell()?;
        let away = |cell: Cell| cell.x.abs_diff(from.x).saturating_add(cell.y.abs_diff(from.y));
        let there = self.hall.pieces().iter().filter(|bag| !self.moved.contains_key(&bag.piece));
        let there = there.flat_map(|bag| bag.cells.iter().map(|cell| (bag.piece, *cell)));
        let moved = self.lying().filter_map(|(piece, place)| Some((piece, place.cell()?)));
        let near = there.chain(moved).map(|(piece, cell)| (away(cell), piece, cell)).filter(|(away, _, _)| *away <= SIGHT);
        near.min().map(|(_, piece, cell)| Parcel { piece, place: Place::Cell(cell) })
    }

    pub(super) fn lift(&mut self, piece: Piece) {
        self.moved.insert(piece, None);
    }

    pub(super) fn put(&mut self, parcel: Parcel) {
        self.moved.insert(parcel.piece, Some(parcel.place));
    }

    /// Puts a piece into the container, from which it is never taken out.
    pub(super) fn take_in(&mut self, piece: Piece) {
        self.moved.insert(piece, None);
        self.taken_in.push(piece);
    }

    pub(super) fn block(&mut self, cells: BTreeSet<Cell>) {
        self.blocked = cells;
    }

    pub(super) fn close(&mut self, cell: Cell) {
        self.closed.insert(cell);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ground(rows: &[&str]) -> PairGround {
        PairGround::new(Arc::new(Hall::from_rows("test", rows).unwrap()))
    }

    #[test]
    fn a_piece_that_was_lifted_leaves_its_cells_free_and_lies_on_one_where_it_falls() {
        let mut ground = ground(&["S.aa."]);
        let at = |ground: &PairGround, x| ground.truth(Cell::new(x, 0));
        assert_eq!((at(&ground, 2), at(&ground, 3)), (Truth::Luggage(Piece(1)), Truth::Luggage(Piece(1))));
        ground.lift(Piece(1));
        assert_eq!((at(&ground, 2), at(&ground, 3)), (Truth::Free, Truth::Free));
        ground.put(Parcel { piece: Piece(1), place: Place::Cell(Cell::new(4, 0)) });
        assert_eq!((at(&ground, 3), at(&ground, 4)), (Truth::Free, Truth::Luggage(Piece(1))));
        ground.take_in(Piece(1));
        assert_eq!((at(&ground, 4), ground.taken_in()), (Truth::Free, &[Piece(1)][..]));
    }

    #[test]
    fn the_nearest_piece_in_sight_is_found_and_one_far_away_is_not() {
        let mut ground = ground(&["Sa..b..............c"]);
        let found =
            |ground: &PairGround, x| ground.nearest(Place::Cell(Cell::new(x, 0))).map(|parcel| (parcel.piece, parcel.place));
        assert_eq!(found(&ground, 3), Some((Piece(2), Place::Cell(Cell::new(4, 0)))));
        ground.lift(Piece(2));
        assert_eq!(found(&ground, 3), Some((Piece(1), Place::Cell(Cell::new(1, 0)))));
        ground.take_in(Piece(1));
        assert_eq!(found(&ground, 3), None, "the third is out of sight");
    }

    #[test]
    fn a_cell_that_was_closed_is_a_wall() {
        let mut ground = ground(&["S.."]);
        ground.close(Cell::new(1, 0));
        assert_eq!(ground.truth(Cell::new(1, 0)), Truth::Wall);
    }
}
