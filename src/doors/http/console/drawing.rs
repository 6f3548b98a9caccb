//! Shared by all drawings of the hall: sizes, and the shapes of luggage.

use std::fmt::Write;

use crate::phrases::Language;
use hallsweep_core::units::{Cell, Heading};
use hallsweep_core::world::hall_map::{Bounds, HallMap};
use hallsweep_core::world::luggage::Luggage;

/// Side length of a cell, in units of the picture.
pub(super) const CELL: i32 = 10;

/// The picture grows by this number of cells at a time. If it grew by one cell, it would jump at every step of the
/// robot.
const GROWTH: i32 = 2;

/// Minimum size of the picture, in cells.
const LEAST: (i32, i32) = (16, 12);

/// Maximum width of a picture drawn to scale, in cells. In a wider picture, the robot and the luggage are drawn
/// larger than their cells.
const READABLE: i32 = 32;

/// Returns the part of the hall that the picture shows, in cells. It is the known part, enlarged to multiples of
/// `GROWTH` and at least to `LEAST`.
pub(super) fn shown(map: &HallMap) -> Bounds {
    let known = map.known_bounds();
    let least = Cell::new(round_down(known.least.x.min(-1)), round_down(known.least.y.min(-1)));
    let far = |least: i32, most: i32, size: i32| least + size.max(round_up(most - least + 2)) - 1;
    Bounds { least, most: Cell::new(far(least.x, known.most.x, LEAST.0), far(least.y, known.most.y, LEAST.1)) }
}

/// Returns by which factor the robot and other symbols are enlarged, so that they are visible in a large hall too.
pub(super) fn larger(map: &HallMap) -> i32 {
    let shown = shown(map);
    let widest = shown.width().max(shown.height() * LEAST.0 / LEAST.1);
    (widest + READABLE - 1) / READABLE
}

pub(super) const fn middle(cell: Cell) -> (i32, i32) {
    (cell.x * CELL + CELL / 2, cell.y * CELL + CELL / 2)
}

/// Returns the heading in degrees from north, clockwise.
pub(super) const fn turn(heading: Heading) -> i32 {
    match heading {
        Heading::North => 0,
        Heading::East => 90,
        Heading::South => 180,
        Heading::West => 270,
    }
}

/// Draws a piece of luggage at the given place of the picture, which need not be the cell of the piece.
pub(super) fn draw_luggage(language: Language, group: &mut String, piece: &Luggage, (x, y): (i32, i32), size: i32) {
    let verdict = piece.verdict_name();
    let (shape, letter, said) = (shape(verdict), language.say_of("letter", verdict), said(language, piece));
    write(
        group,
        format_args!(
            "<g class=\"piece {verdict}\" transform=\"translate({x} {y}) scale({size})\">{shape}<text y=\"2\">{letter}</text>\
             <title>{said}</title></g>"
        ),
    );
}

pub(super) fn said(language: Language, piece: &Luggage) -> String {
    language.say("piece-is").with("id", piece.id).with("verdict", language.verdict(piece.verdict_name())).to_string()
}

/// Returns the shape for a verdict. A piece also shows a letter, for people who cannot distinguish the colours.
pub(super) fn shape(verdict: &str) -> &'static str {
    match verdict {
        "safe" => "<circle r=\"4.2\"/>",
        "danger" => "<path d=\"M0 -5L5 4H-5Z\"/>",
        _ => "<rect x=\"-4.2\" y=\"-4.2\" width=\"8.4\" height=\"8.4\"/>",
    }
}

const fn round_down(cells: i32) -> i32 {
    if cells >= -1 { -1 } else { cells.div_euclid(GROWTH) * GROWTH - 1 }
}

const fn round_up(cells: i32) -> i32 {
    (cells + GROWTH - 1).div_euclid(GROWTH) * GROWTH
}

pub(super) fn write(text: &mut String, words: std::fmt::Arguments<'_>) {
    text.write_fmt(words).expect("writing into a string does not fail");
}
