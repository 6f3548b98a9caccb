//! The bar under every photo: hall, cell of the luggage, cell and heading of the robot, time. These values come from
//! the photo's stamp. Only the picture itself shows where the robot really stands.

use super::super::hall::{Hall, Truth};
use super::canvas::Canvas;
use super::font;
use super::space::Paint;
use super::view::{HEIGHT, WIDTH};
use hallsweep_core::effect::Stamp;
use hallsweep_core::units::WallTime;

/// The side of a dot of the font, in pixels.
const DOT: usize = 2;

/// The height of the bar in pixels: two lines of text and the space around them.
const BAR: usize = 48;

const PAPER: Paint = Paint(18.0, 22.0, 28.0);
const TEXT: Paint = Paint(240.0, 242.0, 245.0);
const TIME: Paint = Paint(250.0, 204.0, 80.0);

/// The word on every photo of an exercise.
const EXERCISE: &str = "EXERCISE";

/// The space beside the text, in pixels.
const MARGIN: usize = 8;

pub(super) fn draw(canvas: &mut Canvas, hall: &Hall, stamp: Stamp) {
    draw_plain(canvas, &where_line(hall, stamp), stamp.wall);
    let name: String = hall.name().chars().take(22).collect();
    let width = name.chars().count() * font::ADVANCE * DOT;
    write(canvas, &name, (WIDTH - MARGIN - width, HEIGHT - BAR + 28), TEXT);
    if hall.is_exercise() {
        let left = WIDTH - 2 * MARGIN - EXERCISE.len() * font::ADVANCE * DOT;
        // In a very wide hall, the words on the left would reach this far.
        for column in left..WIDTH {
            (HEIGHT - BAR..HEIGHT - BAR + 24).for_each(|row| canvas.paint(column, row, PAPER));
        }
        write(canvas, EXERCISE, (left + MARGIN, HEIGHT - BAR + 8), TIME);
    }
}

/// Draws the bar under a plan. Unlike the bar of a photo, it has no hall name.
pub(super) fn draw_plain(canvas: &mut Canvas, words: &str, wall: WallTime) {
    for row in HEIGHT - BAR..HEIGHT {
        for column in 0..WIDTH {
            canvas.paint(column, row, PAPER);
        }
    }
    write(canvas, words, (MARGIN, HEIGHT - BAR + 8), TEXT);
    write(canvas, &in_words(wall), (MARGIN, HEIGHT - BAR + 28), TIME);
}

fn where_line(hall: &Hall, stamp: Stamp) -> String {
    let subject = stamp.pose.cell.onward(stamp.pose.heading, super::away(hall, stamp.pose));
    let what = match hall.truth(subject) {
        Truth::Luggage(_) => "luggage",
        Truth::Wall => "wall",
        Truth::Free => "view",
    };
    format!("{what} {subject}  robot {} {}", stamp.pose.cell, stamp.pose.heading.name())
}

/// Formats a time as `2026-11-21 08:20:20 +00:00`, with its own UTC offset. A time that no calendar date can express
/// is shown in milliseconds.
fn in_words(wall: WallTime) -> String {
    let offset = jiff::tz::Offset::from_seconds(wall.offset_s).unwrap_or(jiff::tz::Offset::UTC);
    match jiff::Timestamp::from_millisecond(wall.unix_ms) {
        Ok(moment) => moment.to_zoned(offset.to_time_zone()).strftime("%Y-%m-%d %H:%M:%S %:z").to_string(),
        Err(_) => format!("{} ms", wall.unix_ms),
    }
}

fn write(canvas: &mut Canvas, text: &str, place: (usize, usize), paint: Paint) {
    write_large(canvas, text, place, paint, DOT);
}

/// Draws a line of text. Each dot of a letter is a square of `dot` pixels. Text beyond the right edge of the picture
/// is cut off.
pub(super) fn write_large(canvas: &mut Canvas, text: &str, (left, top): (usize, usize), paint: Paint, dot: usize) {
    let columns = text.chars().count() * font::ADVANCE * dot;
    for column in (0..columns).filter(|column| left + column < WIDTH) {
        for row in (0..font::HEIGHT * dot).filter(|row| font::dot(text, column / dot, row / dot)) {
            canvas.paint(left + column, top + row, paint);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_is_shown_in_its_zone() {
        let wall = WallTime { unix_ms: 1_795_249_220_123, offset_s: 0 };
        assert_eq!(in_words(wall), "2026-11-21 08:20:20 +00:00");
        assert_eq!(in_words(WallTime { offset_s: 3600, ..wall }), "2026-11-21 09:20:20 +01:00");
        assert_eq!(in_words(WallTime { unix_ms: i64::MAX, offset_s: i32::MAX }), "9223372036854775807 ms");
    }
}
