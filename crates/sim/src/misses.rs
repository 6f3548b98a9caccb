//! The camera that can miss luggage: it then takes the piece for a wall. How often depends on what a searcher knows,
//! which is the distance, and on what nobody knows beforehand: the size of the piece, the side that it shows, and how
//! much of it is hidden. The figures are invented; they make a camera that misses often enough to be calibrated.

use crate::Hall;
use crate::bag::Bag;
use crate::hall::Truth;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::units::{Cell, Pose};

/// Distance from which a piece of half a metre is recognised in half of all looks, in metres.
const HALF_M: f64 = 2.4;

/// Share of the looks at the narrow side of a piece in which it is recognised, compared with its broad side.
const NARROW: f64 = 0.88;

/// Share of the looks in which a piece is recognised, for each neighbour that hides a part of it.
const HIDDEN: f64 = 0.94;

/// Whether the camera recognises the piece in `cell` from this pose. A second look from the same pose sees the same, so
/// the answer depends on the seed, the cell and the pose alone. A restart of the program changes the seed.
pub(super) fn recognises(hall: &Hall, seed: u64, bag: &Bag, cell: Cell, pose: Pose) -> bool {
    let mixed = |cell: Cell| (u64::from(cell.x.cast_unsigned()) << 32) | u64::from(cell.y.cast_unsigned());
    let look = mixed(cell).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ mixed(pose.cell).wrapping_mul(0xC2B2_AE3D_27D4_EB4F);
    RandomStream::new(seed ^ look, "misses").happens(chance(hall, bag, cell, pose))
}

/// The probability that the camera recognises the piece in `cell` from this pose, which faces the cell.
fn chance(hall: &Hall, bag: &Bag, cell: Cell, pose: Pose) -> f64 {
    let cells = pose.cell.x.abs_diff(cell.x).max(pose.cell.y.abs_diff(cell.y));
    let distance_m = f64::from(cells) * hall.cell_m();
    let by_distance = 1.0 / (1.0 + (distance_m / (HALF_M * (bag.height_m / 0.5).sqrt())).powi(3));
    let shows_narrow = bag.piece.0.is_multiple_of(2) == (pose.heading.vector().0 == 0);
    let beside = [pose.heading.left(), pose.heading.right()].map(|side| cell.ahead(pose.heading.opposite()).ahead(side));
    let hiding = beside.into_iter().filter(|beside| hall.truth(*beside) != Truth::Free).count();
    let by_sight = if shows_narrow { NARROW } else { 1.0 } * [1.0, HIDDEN, HIDDEN * HIDDEN][hiding];
    by_distance * by_sight
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::Heading;

    fn chance_in(rows: &[&str], away: i32) -> f64 {
        let hall = Hall::from_rows("drawn", rows).expect("a valid drawing");
        let pose = Pose { cell: Cell::HOME, heading: Heading::East };
        chance(&hall, &hall.pieces()[0], Cell::new(away, 0), pose)
    }

    #[test]
    fn what_is_farther_smaller_narrower_or_hidden_is_missed_more_often() {
        let near = chance_in(&["...", "Sa.", "..."], 1);
        let far = chance_in(&[".....", "S...a", "....."], 4);
        assert!(far < near && near < 1.0 && far > 0.3, "{near} {far}");
        let hidden = chance_in(&["#..", "Sa.", "..."], 1);
        assert!(hidden < near, "{hidden} {near}");
        let hall = Hall::from_rows("drawn", &["S.a"]).expect("a valid drawing");
        let (bag, cell) = (hall.pieces()[0].clone(), Cell::new(2, 0));
        let from = |bag: &Bag, heading| chance(&hall, bag, cell, Pose { cell: Cell::HOME, heading });
        assert!(from(&Bag { height_m: 0.2, ..bag.clone() }, Heading::East) < from(&bag, Heading::East));
        assert_ne!(from(&bag, Heading::East), from(&bag, Heading::South), "from another side");
    }

    #[test]
    fn a_second_look_from_the_same_pose_sees_the_same_and_from_elsewhere_it_is_another_chance() {
        let hall = Hall::from_rows("drawn", &["S...a..."]).expect("a valid drawing");
        let cell = Cell::new(4, 0);
        let look = |seed, x, heading| recognises(&hall, seed, &hall.pieces()[0], cell, Pose { cell: Cell::new(x, 0), heading });
        let seen = |x, heading| (0..2000).filter(|seed| look(*seed, x, heading)).count();
        assert!((0..2000).all(|seed| look(seed, 0, Heading::East) == look(seed, 0, Heading::East)));
        let both = (0..2000).filter(|seed| look(*seed, 0, Heading::East) && look(*seed, 7, Heading::West)).count();
        let (east, west) = (seen(0, Heading::East), seen(7, Heading::West));
        assert!(both.abs_diff(east * west / 2000) < 100, "independent: {both} of {east} and {west}");
    }
}
