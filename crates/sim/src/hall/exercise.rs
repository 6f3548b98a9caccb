//! The hall of an exercise: test pieces stand among the ordinary ones. People who know the hall must not be able to
//! tell them apart, so the test pieces are drawn from all pieces, and not from the added ones alone.

use std::collections::{BTreeMap, BTreeSet};

use super::{Hall, HallFault, Truth};
use crate::bag::{Bag, BagKind, Colour};
use hallsweep_core::rng::RandomStream;
use hallsweep_core::units::{Cell, Piece};

impl Hall {
    /// Returns the hall with `count` test pieces among all pieces. Twice as many pieces are added, so that most pieces
    /// are no test pieces even in a hall without luggage. Each test piece can be inspected, and every other cell that could be reached stays so. All other pieces are harmless. Numbers follow
    /// the reading order, as in a hall file.
    ///
    /// # Errors
    /// When the hall has no room for all of them.
    pub fn with_tests(&self, count: u32, seed: u64) -> Result<Hall, HallFault> {
        let mut stream = RandomStream::new(seed, "exercise");
        let mut hall = self.clone();
        hall.is_exercise = true;
        let mut free: Vec<Cell> = self.reachable().into_iter().collect();
        shuffle(&mut free, &mut stream);
        let (mut planted, wanted) = (0, count.saturating_mul(2));
        for cell in free {
            if planted < wanted && hall.has_room_at(cell) {
                planted += 1;
                hall.put(cell, &mut stream);
            }
        }
        if planted < wanted {
            return Err(HallFault::NoRoomForTests { wanted: count, room: planted / 2 });
        }
        hall.number_anew();
        let mut tests: Vec<Piece> = hall.inspectable().into_keys().collect();
        shuffle(&mut tests, &mut stream);
        tests.truncate(count as usize);
        hall.bags.iter_mut().for_each(|bag| bag.dangerous = tests.contains(&bag.piece));
        Ok(hall)
    }

    /// Whether test pieces stand in this hall.
    #[must_use]
    pub const fn is_exercise(&self) -> bool {
        self.is_exercise
    }

    /// All pieces that can be inspected, each with whether it is dangerous.
    #[must_use]
    pub fn inspectable(&self) -> BTreeMap<Piece, bool> {
        let unmet: BTreeSet<Piece> = self.unreachable_pieces().iter().map(|bag| bag.piece).collect();
        let met = self.bags.iter().filter(|bag| !unmet.contains(&bag.piece));
        met.map(|bag| (bag.piece, bag.dangerous)).collect()
    }

    /// Whether a piece in this reachable cell blocks no way, and hides no other piece. It blocks no way if the free
    /// cells beside it are connected by the cells round it.
    fn has_room_at(&self, cell: Cell) -> bool {
        if cell == Cell::HOME || cell.neighbours().contains(&Cell::HOME) {
            return false;
        }
        let is_free = |other: &Cell| self.truth(*other) == Truth::Free;
        let beside: Vec<Cell> = cell.neighbours().into_iter().filter(is_free).collect();
        let mut connected: Vec<Cell> = beside.first().copied().into_iter().collect();
        let mut looked_at = 0;
        while let Some(next) = connected.get(looked_at).copied() {
            looked_at += 1;
            let is_round = |other: &Cell| (other.x - cell.x).abs().max((other.y - cell.y).abs()) == 1;
            let further = next.neighbours().into_iter().filter(|other| is_round(other) && is_free(other));
            let further: Vec<Cell> = further.filter(|other| !connected.contains(other)).collect();
            connected.extend(further);
        }
        let can_be_met = |bag: &Bag| {
            let round = bag.cells.iter().flat_map(|part| part.neighbours());
            round.filter(is_free).any(|other| other != cell)
        };
        let others = cell.neighbours().into_iter().filter_map(|other| match self.truth(other) {
            Truth::Luggage(piece) => self.bag(piece),
            Truth::Free | Truth::Wall => None,
        });
        !beside.is_empty() && beside.iter().all(|other| connected.contains(other)) && others.into_iter().all(can_be_met)
    }

    /// Adds a piece of a random kind and colour. `number_anew` gives it its final number.
    fn put(&mut self, cell: Cell, stream: &mut RandomStream) {
        let piece = Piece(u32::try_from(self.bags.len()).map_or(u32::MAX, |count| count + 1));
        let kind = BagKind::ALL[below(stream, BagKind::ALL.len())];
        let (colour_name, colour) = Colour::NAMED[below(stream, Colour::NAMED.len())];
        let name = format!("{colour_name} {}", kind.name()).into();
        self.bags.push(Bag { name, colour, ..Bag::of_kind(kind, piece, vec![cell]) });
        if let Some(place) = self.place(cell) {
            self.squares[place] = Truth::Luggage(piece);
        }
    }

    fn number_anew(&mut self) {
        self.bags.sort_by_key(|bag| bag.cells.first().map(|cell| (cell.y, cell.x)));
        for (number, bag) in (1..).zip(0..self.bags.len()) {
            self.bags[bag].piece = Piece(number);
            for cell in self.bags[bag].cells.clone() {
                if let Some(place) = self.place(cell) {
                    self.squares[place] = Truth::Luggage(Piece(number));
                }
            }
        }
    }
}

fn shuffle<T>(all: &mut [T], stream: &mut RandomStream) {
    for last in (1..all.len()).rev() {
        all.swap(last, below(stream, last + 1));
    }
}

fn below(stream: &mut RandomStream, bound: usize) -> usize {
    usize::try_from(stream.below(bound as u64)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn test_pieces_can_be_inspected_and_block_no_way_in_every_hall() {
        for name in Hall::builtin_names() {
            let hall = Hall::named_or_file(name).unwrap();
            for (count, seed) in [(1, 1), (3, 2), (8, 3), (8, u64::MAX)] {
                let Ok(exercise) = hall.with_tests(count, seed) else { continue };
                let added: BTreeSet<Cell> = hall.reachable().difference(&exercise.reachable()).copied().collect();
                assert_eq!(added.len(), 2 * count as usize, "{name}: only the cells of the added pieces are lost");
                assert!(added.iter().all(|cell| matches!(exercise.truth(*cell), Truth::Luggage(_))), "{name}");
                assert!(!added.contains(&Cell::HOME) && Cell::HOME.neighbours().iter().all(|cell| !added.contains(cell)));
                assert_eq!(exercise.unreachable_pieces().len(), hall.unreachable_pieces().len(), "{name}");
                let tests = exercise.pieces().iter().filter(|bag| bag.dangerous).count();
                assert_eq!(tests, exercise.inspectable().values().filter(|is_test| **is_test).count());
                assert_eq!(
                    (tests, exercise.pieces().len()),
                    (count as usize, hall.pieces().len() + 2 * count as usize),
                    "{name}"
                );
            }
        }
    }

    #[test]
    fn the_numbers_follow_the_reading_order_and_tell_nothing() {
        let hall = Hall::named_or_file("airport").unwrap().with_tests(8, 5).unwrap();
        let first: Vec<(i32, i32)> = hall.pieces().iter().map(|bag| (bag.cells[0].y, bag.cells[0].x)).collect();
        assert!(first.is_sorted());
        for (number, bag) in (1..).zip(hall.pieces()) {
            assert_eq!(bag.piece, Piece(number));
            assert!(bag.cells.iter().all(|cell| hall.truth(*cell) == Truth::Luggage(bag.piece)));
        }
    }

    #[test]
    fn who_knows_the_hall_does_not_know_the_test_pieces() {
        let usual = Hall::named_or_file("airport").unwrap();
        let known: BTreeSet<Vec<Cell>> = usual.pieces().iter().map(|bag| bag.cells.clone()).collect();
        let (mut of_hall, mut added) = (0, 0);
        for seed in 0..50 {
            let hall = usual.with_tests(6, seed).unwrap();
            for test in hall.pieces().iter().filter(|bag| bag.dangerous) {
                *if known.contains(&test.cells) { &mut of_hall } else { &mut added } += 1;
            }
        }
        assert!(of_hall > 50 && added > 50, "{of_hall} {added}");
    }

    #[test]
    fn the_seed_alone_says_where_they_stand() {
        let hall = Hall::named_or_file("airport").unwrap();
        assert_eq!(hall.with_tests(5, 9), hall.with_tests(5, 9));
        assert_ne!(hall.with_tests(5, 9), hall.with_tests(5, 10));
    }

    #[test]
    fn a_hall_without_room_says_how_many_it_has_room_for() {
        let corridor = Hall::from_rows("test", &["S....."]).unwrap();
        let fault = HallFault::NoRoomForTests { wanted: 1, room: 0 };
        assert_eq!(corridor.with_tests(1, 1), Err(fault), "only its end blocks no way");
        let error = Hall::from_rows("test", &["S."]).unwrap().with_tests(2, 1).unwrap_err();
        assert_eq!(error, HallFault::NoRoomForTests { wanted: 2, room: 0 });
        assert!(error.to_string().contains("2 test pieces"), "{error}");
    }

    #[test]
    fn a_piece_is_never_hidden_behind_another() {
        for seed in 0..40 {
            let hall = Hall::from_rows("test", &["S....", "....#", "..#.#", "....."]).unwrap().with_tests(1, seed).unwrap();
            assert!(hall.unreachable_pieces().is_empty(), "seed {seed}");
        }
    }
}
