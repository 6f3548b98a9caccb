//! The part of the floor that the Roomba has passed over, in squares of 5 cm. A square counts when the body passes
//! over its centre. Squares in the corners are not counted, because a round body cannot reach them.

use super::room::{RADIUS_M, ROOM_LENGTH_M, ROOM_WIDTH_M};

/// Side of a square, in metres. It is about a third of the radius, so gaps in corners and narrow strips are noticed.
pub(super) const SQUARE_M: f64 = 0.05;

/// Number of squares along x, for 6.4 m.
const COLUMNS: usize = 128;

/// Number of squares along y, for 4.8 m.
const ROWS: usize = 96;

#[derive(Clone, Debug)]
pub(super) struct Floor {
    passed: Vec<bool>,
    count: u32,
}

impl Floor {
    pub(super) fn new() -> Floor {
        Floor { passed: vec![false; COLUMNS * ROWS], count: 0 }
    }

    /// Counts the squares under a body with its centre at (`x_m`, `y_m`). A square that was counted before is not
    /// counted again.
    pub(super) fn pass(&mut self, x_m: f64, y_m: f64) {
        for row in near(y_m, ROWS) {
            for column in near(x_m, COLUMNS) {
                let is_under = is_within(centre(column) - x_m, centre(row) - y_m);
                let square = &mut self.passed[row * COLUMNS + column];
                if is_under && !*square {
                    *square = true;
                    self.count += 1;
                }
            }
        }
    }

    pub(super) const fn passed(&self) -> u32 {
        self.count
    }
}

/// Number of squares that a body can pass over if it goes everywhere in the room.
pub(super) fn reachable() -> u32 {
    let squares = (0..ROWS).flat_map(|row| (0..COLUMNS).map(move |column| (centre(column), centre(row))));
    let within = squares.filter(|(x, y)| {
        let nearest_x = x.clamp(RADIUS_M, ROOM_LENGTH_M - RADIUS_M);
        let nearest_y = y.clamp(RADIUS_M, ROOM_WIDTH_M - RADIUS_M);
        is_within(x - nearest_x, y - nearest_y)
    });
    within.fold(0, |count, _| count + 1)
}

/// Whether a point is under the body. (`dx`, `dy`) is its distance from the body's centre, in metres.
fn is_within(dx: f64, dy: f64) -> bool {
    dx * dx + dy * dy <= RADIUS_M * RADIUS_M
}

/// Centre of the column or row with this index, in metres.
#[expect(clippy::cast_precision_loss, reason = "there are a few hundred columns and rows")]
fn centre(index: usize) -> f64 {
    (index as f64 + 0.5) * SQUARE_M
}

/// The columns (or rows) that a body at this coordinate may cover. There are `of` columns in total.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a float becomes the nearest number that there is")]
fn near(at_m: f64, of: usize) -> std::ops::Range<usize> {
    let index = |m: f64| (m / SQUARE_M) as usize;
    index(at_m - RADIUS_M)..(index(at_m + RADIUS_M) + 1).min(of)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_squares_fill_the_room() {
        assert!((centre(COLUMNS - 1) + SQUARE_M / 2.0 - ROOM_LENGTH_M).abs() < 1e-9);
        assert!((centre(ROWS - 1) + SQUARE_M / 2.0 - ROOM_WIDTH_M).abs() < 1e-9);
    }

    fn standing(x_m: f64, y_m: f64) -> u32 {
        let mut floor = Floor::new();
        floor.pass(x_m, y_m);
        floor.pass(x_m, y_m);
        floor.passed()
    }

    #[test]
    fn a_body_that_stands_covers_its_own_disc_once() {
        let offsets = (0..20).flat_map(|x| (0..20).map(move |y| (f64::from(x) * 0.0025, f64::from(y) * 0.0025)));
        let mean = offsets.map(|(x, y)| f64::from(standing(3.0 + x, 2.0 + y))).sum::<f64>() / 400.0;
        let disc = std::f64::consts::PI * RADIUS_M * RADIUS_M / (SQUARE_M * SQUARE_M);
        assert!((mean - disc).abs() < 0.2, "{mean} squares for {disc}");
    }

    /// Six or seven rows of squares have their centres within 17 cm of the body's path. There are seven rows if the
    /// path runs exactly over centres.
    #[test]
    fn a_straight_way_covers_a_strip_as_wide_as_the_body() {
        for (y_m, rows) in [(1.0, 6), (1.025, 7)] {
            let mut floor = Floor::new();
            for step in 0..=300 {
                floor.pass(1.0 + f64::from(step) * 0.01, y_m);
            }
            let ends = standing(1.0, y_m);
            assert_eq!(floor.passed(), 60 * rows + ends, "at {y_m}");
        }
    }

    #[test]
    fn all_but_the_corners_can_be_reached_and_going_everywhere_reaches_it() {
        // In each corner, (1 − π/4) r² cannot be reached. This is the area of 2.5 squares.
        assert!((12_288 - 24..12_288).contains(&reachable()), "{}", reachable());
        let mut floor = Floor::new();
        let steps = |most: f64| (0..).map(|step| RADIUS_M + f64::from(step) * 0.02).take_while(move |at| *at < most);
        for y in steps(ROOM_WIDTH_M - RADIUS_M).chain([ROOM_WIDTH_M - RADIUS_M]) {
            for x in steps(ROOM_LENGTH_M - RADIUS_M).chain([ROOM_LENGTH_M - RADIUS_M]) {
                floor.pass(x, y);
            }
        }
        assert_eq!(floor.passed(), reachable());
    }
}
