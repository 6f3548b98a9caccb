//! The front sonar. It measures the distance from the robot's front to the next thing ahead, but cannot tell what the
//! thing is.

use super::drive::BodyPose;
use super::hall::{Hall, Truth};
use hallsweep_core::units::Cell;

pub(super) const RANGE_M: f64 = 4.0;

/// Half the robot's size, in cells. The robot fills most of its cell, but can turn without touching the next cell.
pub(super) const BODY_HALF: f64 = 0.42;

/// Width of the free strip along each side of a cell with luggage, in cells. Walls leave no free strip.
pub(super) const LUGGAGE_INSET: f64 = 0.12;

/// The exact distance from the robot's front to the next thing ahead, in centimetres. `None` if it is beyond the
/// range.
pub(super) fn distance_cm(hall: &Hall, body: BodyPose) -> Option<f64> {
    let cell_m = hall.cell_m();
    let ray = Ray { x: body.x_m / cell_m, y: body.y_m / cell_m, direction: body.ahead() };
    let reach = RANGE_M / cell_m + BODY_HALF;
    let way = ray.to_obstacle(hall, reach)?;
    Some((way - BODY_HALF).max(0.0) * cell_m * 100.0)
}

/// Number of whole free cells before the thing that a reading shows. The robot must stand at the centre of its cell.
/// Walls and luggage begin within the first quarter of their cells, so rounding gives the right number.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a reading ends at the sonar's range")]
pub(super) fn free_cells(cm: u16, cell_m: f64) -> u16 {
    let begins = 0.5 - BODY_HALF + LUGGAGE_INSET / 2.0;
    (f64::from(cm) / (cell_m * 100.0) - begins).round().max(0.0) as u16
}

/// Number of whole cells ahead that are within the range. The robot must stand at the centre of its cell.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the range is a few metres, and what is less than none is none"
)]
pub(super) fn cells_in_range(cell_m: f64) -> u16 {
    (RANGE_M / cell_m - (0.5 - BODY_HALF)).floor().max(0.0) as u16
}

/// Distance that a robot can drive from the centre of its cell before it touches a wall or luggage in the next cell,
/// in cells. `None` if the next cell is free.
pub(super) fn way_to_contact(truth: Truth) -> Option<f64> {
    inset(truth).map(|inset| 0.5 - BODY_HALF + inset)
}

/// Distance from the sides of a cell to the wall or luggage in it, in cells. `None` for a free cell.
const fn inset(truth: Truth) -> Option<f64> {
    match truth {
        Truth::Free => None,
        Truth::Wall => Some(0.0),
        Truth::Luggage(_) => Some(LUGGAGE_INSET),
    }
}

/// A line of sight from (`x`, `y`), in cells. The centre of the home cell is (0, 0).
struct Ray {
    x: f64,
    y: f64,
    direction: (f64, f64),
}

impl Ray {
    fn to_obstacle(&self, hall: &Hall, reach: f64) -> Option<f64> {
        let (dx, dy) = self.direction;
        let mut cell = (self.x.round(), self.y.round());
        let mut entered = 0.0;
        while entered <= reach {
            if let Some(way) = inset(hall.truth(whole(cell))).and_then(|inset| self.way_to_square(cell, 0.5 - inset)) {
                return (way <= reach).then_some(way);
            }
            let to_side =
                |place: f64, centre: f64, d: f64| if d == 0.0 { f64::INFINITY } else { (centre + 0.5 * d.signum() - place) / d };
            let (by_column, by_row) = (to_side(self.x, cell.0, dx), to_side(self.y, cell.1, dy));
            if by_column < by_row {
                cell.0 += dx.signum()
            } else {
                cell.1 += dy.signum()
            }
            entered = by_column.min(by_row);
        }
        None
    }

    fn way_to_square(&self, centre: (f64, f64), half: f64) -> Option<f64> {
        let span = |place: f64, middle: f64, d: f64| {
            let (a, b) = ((middle - half - place) / d, (middle + half - place) / d);
            if d != 0.0 {
                (a.min(b), a.max(b))
            } else if (place - middle).abs() <= half {
                (f64::NEG_INFINITY, f64::INFINITY)
            } else {
                (f64::INFINITY, f64::NEG_INFINITY)
            }
        };
        let (x_in, x_out) = span(self.x, centre.0, self.direction.0);
        let (y_in, y_out) = span(self.y, centre.1, self.direction.1);
        let (enters, leaves) = (x_in.max(y_in), x_out.min(y_out));
        (enters <= leaves && leaves >= 0.0).then_some(enters.max(0.0))
    }
}

#[expect(clippy::cast_possible_truncation, reason = "halls are a few thousand cells wide, and rays end at their range")]
const fn whole(cell: (f64, f64)) -> Cell {
    Cell::new(cell.0 as i32, cell.1 as i32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::{Heading, Pose};

    fn check(rows: &[&str], heading: Heading, expect_cm: Option<f64>) {
        let hall = Hall::from_rows("test", rows).unwrap();
        let body = BodyPose::centred(Pose { cell: Cell::HOME, heading }, hall.cell_m());
        match (distance_cm(&hall, body), expect_cm) {
            (Some(found), Some(expect)) => assert!((found - expect).abs() < 1e-6, "{found} cm"),
            (found, expect) => assert_eq!(found.is_some(), expect.is_some()),
        }
    }

    #[test]
    fn it_measures_from_the_robots_front() {
        check(&["S#"], Heading::East, Some(4.0));
        check(&["S..#"], Heading::East, Some(104.0));
        check(&["S.a"], Heading::East, Some(60.0));
        check(&["S.#"], Heading::West, Some(4.0));
        check(&["#", ".", "S"], Heading::North, Some(54.0));
    }

    #[test]
    fn a_reading_tells_how_many_cells_are_free() {
        for (rows, free) in [("S#", 0), ("Sa", 0), ("S.#", 1), ("S.a", 1), ("S...a", 3), ("S......#", 6)] {
            let hall = Hall::from_rows("test", &[rows]).unwrap();
            let body = BodyPose::centred(Pose { cell: Cell::HOME, heading: Heading::East }, hall.cell_m());
            let cm = distance_cm(&hall, body).unwrap().round();
            for error in [-15.0, 0.0, 15.0] {
                assert_eq!(free_cells((cm + error).max(0.0) as u16, hall.cell_m()), free, "{rows} {error}");
            }
        }
    }

    #[test]
    fn beyond_four_metres_it_sees_nothing() {
        check(&["S.......#"], Heading::East, Some(354.0));
        check(&["S.........#"], Heading::East, None);
    }

    #[test]
    fn between_two_headings_it_looks_along_the_slant() {
        let hall = Hall::from_rows("test", &["S..", "...", "..#"]).unwrap();
        let body = BodyPose { x_m: 0.0, y_m: 0.0, theta: std::f64::consts::FRAC_PI_4 };
        let expect = (1.5 * 2f64.sqrt() - BODY_HALF) * 50.0;
        assert!((distance_cm(&hall, body).unwrap() - expect).abs() < 1e-6);
    }
}
