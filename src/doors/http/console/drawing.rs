//! Shared by all drawings of the hall: sizes, and the shape of a piece of luggage.

use std::fmt::Write;

use crate::phrases::Language;
use hallsweep_core::units::{Cell, Heading};
use hallsweep_core::world::hall_map::{Bounds, HallMap};
use hallsweep_core::world::luggage::Luggage;

/// The side of a cell, in the picture's units.
pub(super) const CELL: i32 = 10;

/// The picture grows by this many cells at a time, so that it does not jump with every step.
const GROWTH: i32 = 4;

/// Minimum size of the picture, in cells.
const LEAST: (i32, i32) = (16, 12);

/// Up to this width, in cells, the picture is drawn to scale. In a wider one important things are drawn larger than their cell.
const READABLE: i32 = 32;

/// The visible part of the hall in cells: the known part, rounded outwards.
pub(super) fn shown(map: &HallMap) -> Bounds {
    let known = map.known_bounds();
    let least = Cell::new(round_down(known.least.x.min(-1)), round_down(known.least.y.min(-1)));
    let far = |least: i32, most: i32, size: i32| least + size.max(round_up(most - least + 2)) - 1;
    Bounds { least, most: Cell::new(far(least.x, known.most.x, LEAST.0), far(least.y, known.most.y, LEAST.1)) }
}

/// Magnification of the robot and similar things, so that they are visible in a large hall too.
pub(super) fn larger(map: &HallMap) -> i32 {
    let shown = shown(map);
    let widest = shown.width().max(shown.height() * LEAST.0 / LEAST.1);
    (widest + READABLE - 1) / READABLE
}

pub(super) const fn middle(cell: Cell) -> (i32, i32) {
    (cell.x * CELL + CELL / 2, cell.y * CELL + CELL / 2)
}

/// Degrees from north, clockwise.
pub(super) const fn turn(heading: Heading) -> i32 {
    match heading {
        Heading::North => 0,
        Heading::East => 90,
        Heading::South => 180,
        Heading::West => 270,
    }
}

/// Draws a piece that is not in its cell, or not alone there.
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

/// The shape of a verdict. The piece also shows a letter, for people who cannot tell the colours apart.
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
