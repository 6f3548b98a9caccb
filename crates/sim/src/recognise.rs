//! What an ideal camera recognises in an obstacle that the robot has met or seen ahead. `senses` adds the errors of
//! the real camera. `camera` makes the pictures.

use super::hall::{Hall, Truth};
use hallsweep_core::event::Obstacle;
use hallsweep_core::units::{Heading, Pose};

/// What is really in the cell ahead of the robot. `Unknown` if nothing is there.
pub(super) fn obstacle_ahead(hall: &Hall, pose: Pose) -> Obstacle {
    match hall.truth(pose.ahead()) {
        Truth::Wall => Obstacle::Wall {
            left: further_cells(hall, pose, pose.heading.left()),
            right: further_cells(hall, pose, pose.heading.right()),
        },
        Truth::Luggage(piece) => Obstacle::Luggage(piece),
        Truth::Free => Obstacle::Unknown,
    }
}

/// Number of cells that the wall ahead continues sideways, as far as the robot can see. Each counted cell is a
/// wall, and the cell in front of it is free.
fn further_cells(hall: &Hall, pose: Pose, side: Heading) -> u16 {
    let mut here = pose.cell;
    for seen in 0..u16::MAX {
        here = here.ahead(side);
        if hall.truth(here) != Truth::Free || hall.truth(here.ahead(pose.heading)) != Truth::Wall {
            return seen;
        }
    }
    u16::MAX
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::{Cell, Piece};

    fn check(rows: &[&str], heading: Heading, expect: Obstacle) {
        let hall = Hall::from_rows("test", rows).unwrap();
        assert_eq!(obstacle_ahead(&hall, Pose { cell: Cell::HOME, heading }), expect);
    }

    #[test]
    fn a_wall_is_seen_to_both_sides_until_it_ends() {
        check(&["...S.."], Heading::South, Obstacle::Wall { left: 2, right: 3 });
        check(&["...S..", "######"], Heading::South, Obstacle::Wall { left: 2, right: 3 });
        check(&["...S..", "#.##.#"], Heading::South, Obstacle::Wall { left: 0, right: 1 });
        check(&["...S.."], Heading::North, Obstacle::Wall { left: 3, right: 2 });
    }

    #[test]
    fn luggage_before_the_wall_or_in_its_line_ends_the_sight_of_it() {
        check(&["..aS.."], Heading::South, Obstacle::Wall { left: 2, right: 0 });
        check(&["...S..", "#a##b#"], Heading::South, Obstacle::Wall { left: 0, right: 1 });
    }

    #[test]
    fn luggage_is_told_by_its_piece() {
        check(&["Sab"], Heading::East, Obstacle::Luggage(Piece(1)));
    }
}
