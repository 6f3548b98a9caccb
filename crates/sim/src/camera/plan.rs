//! The picture that replaces a photo when the robot has no camera: a plan of what is known, seen from above. Large
//! letters say that it is a drawing.

use super::canvas::Canvas;
use super::space::Paint;
use super::view::{HEIGHT, WIDTH};
use super::{caption, png};
use hallsweep_core::effect::Stamp;
use hallsweep_core::event::Photo;

/// The side of a cell, in pixels.
const CELL: usize = 96;

/// The left edge of the robot's cell, in pixels. The robot always faces the top of the plan.
const LEFT: usize = (WIDTH - CELL) / 2;
const TOP: usize = 258;

const PAPER: Paint = Paint(238.0, 234.0, 222.0);
const LINE: Paint = Paint(196.0, 190.0, 172.0);
const ROBOT: Paint = Paint(38.0, 84.0, 150.0);
const THING: Paint = Paint(190.0, 92.0, 40.0);
const INK: Paint = Paint(40.0, 36.0, 30.0);

/// Size of each dot of the headline's letters, in pixels.
const HEADLINE: usize = 5;
const WORDS: usize = 3;

/// Maximum length of the thing's name in the plan, in letters.
const NAME: usize = 16;

/// Draws a plan of the thing ahead of the robot. `name` is the robot's name for the thing, if it has one. The stamp
/// is written under the plan, as under a photo.
#[must_use]
pub fn plan(stamp: Stamp, name: Option<&str>) -> Photo {
    let mut canvas = Canvas::new();
    fill(&mut canvas, (0, 0), (WIDTH, HEIGHT), PAPER);
    for line in 0..=WIDTH / CELL {
        let column = (LEFT % CELL + line * CELL).min(WIDTH - 1);
        fill(&mut canvas, (column, 120), (column + 2, HEIGHT), LINE);
    }
    for row in [TOP - CELL, TOP, TOP + CELL] {
        fill(&mut canvas, (0, row), (WIDTH, row + 2), LINE);
    }
    disc(&mut canvas, (LEFT + CELL / 2, TOP + CELL / 2), CELL * 3 / 8);
    fill(&mut canvas, (LEFT + CELL / 2 - 4, TOP + 18), (LEFT + CELL / 2 + 4, TOP + CELL / 2), PAPER);
    fill(&mut canvas, (LEFT + 10, TOP - CELL + 10), (LEFT + CELL - 10, TOP - 10), THING);
    caption::write_large(&mut canvas, "A DRAWING, NO PHOTO", (34, 24), INK, HEADLINE);
    caption::write_large(&mut canvas, "no camera: ahead is up", (112, 78), INK, WORDS);
    let name: String = name.unwrap_or("unknown").chars().take(NAME).collect();
    caption::write_large(&mut canvas, &name, (LEFT + CELL + 12, TOP - CELL / 2 - 10), INK, WORDS);
    let pose = stamp.pose;
    let place = format!("ahead {}  robot {} {}", pose.ahead(), pose.cell, pose.heading.name());
    caption::draw_plain(&mut canvas, &place, stamp.wall);
    let size = |pixels: usize| u32::try_from(pixels).expect("a picture is a few hundred pixels wide");
    let bytes = png(size(WIDTH), size(HEIGHT), &canvas.into_bytes());
    Photo { bytes: bytes.into(), media_type: "image/png" }
}

fn fill(canvas: &mut Canvas, (left, top): (usize, usize), (right, bottom): (usize, usize), paint: Paint) {
    for row in top..bottom.min(HEIGHT) {
        for column in left..right.min(WIDTH) {
            canvas.paint(column, row, paint);
        }
    }
}

fn disc(canvas: &mut Canvas, (x, y): (usize, usize), radius: usize) {
    for row in y - radius..=y + radius {
        for column in x - radius..=x + radius {
            if row.abs_diff(y).pow(2) + column.abs_diff(x).pow(2) <= radius.pow(2) {
                canvas.paint(column, row, ROBOT);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::{Pose, WallTime};

    #[test]
    fn a_drawing_differs_by_what_is_ahead_and_never_fails() {
        let stamp = Stamp { pose: Pose::START, wall: WallTime { unix_ms: 1_795_249_220_000, offset_s: 0 } };
        let plans = [plan(stamp, None), plan(stamp, Some("table")), plan(stamp, Some(&"ä\u{0}".repeat(500)))];
        assert!(plans[0] != plans[1] && plans[1] != plans[2]);
        let far = Stamp { pose: Pose { cell: hallsweep_core::units::Cell::new(i32::MAX, i32::MIN), ..Pose::START }, ..stamp };
        assert!(!plan(far, Some("table")).bytes.is_empty());
    }
}
