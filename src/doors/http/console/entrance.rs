//! The area before the entrance, drawn north of the hall's picture. It contains the waiting robots, and the container
//! with the secured pieces. `hall` draws the cells, `carriers` the robots.

use super::drawing::{CELL, larger, middle, shown, write};
use crate::phrases::{Language, Phrase};
use hallsweep_core::units::{Cell, LuggageId};
use hallsweep_core::world::hall_map::HallMap;

/// Distance between two rows of waiting robots, in tenths of a drawn cell. It leaves room for the robots' names.
const ROW: i32 = 14;

/// Number of rows in the area. A robot one step outside stands in the first row; a robot further away stands in the
/// second.
const ROWS: i32 = 2;

/// Distance between two waiting robots of a row, in tenths of a drawn cell.
const COLUMN: i32 = 20;

/// Distances to the east of the way out, in tenths of a drawn cell: to the middle of the container, and to the middle
/// of the first waiting robot.
const CONTAINER: i32 = 20;
const FIRST: i32 = 42;

/// Eastern end of the area, in tenths of a drawn cell. At most three robots wait in the area.
const END: i32 = FIRST + 2 * COLUMN + 12;

/// Maximum number of pieces drawn in the container. If there are more, only their number is shown.
const SEEN: usize = 4;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Column {
    /// The column of the way out, north of home.
    WayOut,
    /// A column of waiting robots. Column 0 is next to the container.
    Waiting(i32),
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Entrance {
    /// Size of a tenth of a drawn cell, in units of the picture.
    tenth: i32,
    /// Southern edge of the area. It is also the northern edge of the hall's picture, labels included.
    south: i32,
    /// Middle of the column of cells that contains home.
    home: i32,
}

impl Entrance {
    pub(super) fn of(map: &HallMap) -> Entrance {
        let tenth = CELL * larger(map) / 10;
        Entrance { tenth, south: shown(map).least.y * CELL - 10 * tenth, home: middle(Cell::HOME).0 }
    }

    /// Returns the height that this area adds to the picture, in units of the picture.
    pub(super) const fn height(self) -> i32 {
        (ROWS * ROW + 4) * self.tenth
    }

    /// Returns the eastern end of the area, in units of the picture.
    pub(super) const fn east(self) -> i32 {
        self.home + END * self.tenth
    }

    pub(super) const fn middle(self, steps: u8, column: Column) -> (i32, i32) {
        let east = match column {
            Column::WayOut => 0,
            Column::Waiting(place) => FIRST + place * COLUMN,
        };
        let row = if steps > 1 { ROWS } else { 1 };
        (self.home + east * self.tenth, self.south + (ROW / 2 - row * ROW) * self.tenth)
    }

    pub(super) fn draw(self, language: Language, group: &mut String, secured: &[LuggageId]) {
        let Entrance { tenth, south, home } = self;
        let (west, width, height) = (home - 8 * tenth, (END + 8) * tenth, ROWS * ROW * tenth);
        write(
            group,
            format_args!(
                "<rect class=\"porch\" x=\"{west}\" y=\"{}\" width=\"{width}\" height=\"{height}\" rx=\"{}\"><title>{}</title></rect>\
                 <path class=\"way-out\" d=\"M{home} 0V{}\"/>",
                south - height,
                2 * tenth,
                language.say("before-entrance"),
                south - height + ROW / 2 * tenth
            ),
        );
        self.container(language, group, secured);
    }

    fn container(self, language: Language, group: &mut String, secured: &[LuggageId]) {
        let (x, y) = (self.home + CONTAINER * self.tenth, self.south - ROWS * ROW / 2 * self.tenth);
        // The container is drawn as if a cell were 10 units wide, and then scaled.
        write(
            group,
            format_args!(
                "<g class=\"container\" transform=\"translate({x} {y}) scale({})\"><title>{}</title><path class=\"box\" d=\"M-9 -9H9V9H-9Z\"/><path class=\"lid\" d=\"M-10.5 -9H10.5M-9 -3H9M-9 3H9\"/>",
                self.tenth,
                held(language, secured)
            ),
        );
        let danger = language.say("letter-danger");
        for (place, id) in (0..).zip(secured.iter().take(SEEN)) {
            let among = (if place % 2 == 0 { -4 } else { 4 }, if place < 2 { -4 } else { 5 });
            let (x, y) = if secured.len() == 1 { (0, 2) } else { among };
            write(
                group,
                format_args!(
                    "<g class=\"piece danger\" transform=\"translate({x} {y}) scale(.75)\"><path d=\"M0 -5L5 4H-5Z\"/><text y=\"2.6\">{danger}</text></g>\
                     <text class=\"inside\" x=\"{x}\" y=\"{}\">#{id}</text>",
                    y - 4
                ),
            );
        }
        if secured.len() > SEEN {
            let more = language.say("container-more").with("count", secured.len() - SEEN);
            write(group, format_args!("<text class=\"inside\" y=\"13.5\">{more}</text>"));
        }
        group.push_str("</g>");
    }
}

fn held(language: Language, secured: &[LuggageId]) -> Phrase<'static> {
    let pieces: Vec<String> = secured.iter().map(|id| language.say("luggage-number").with("id", id).to_string()).collect();
    if pieces.is_empty() {
        language.say("container-empty")
    } else {
        language.say("container-holds").with("pieces", pieces.join(", "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::drawn;
    use hallsweep_core::units::Revision;
    use hallsweep_core::world::hall_map::Mark;

    #[test]
    fn nobody_before_the_entrance_is_drawn_over_the_hall_or_over_another() {
        let mut map = drawn(&["111"], 1);
        for far in [Cell::new(3, 3), Cell::new(150, 3), Cell::new(0, -30)] {
            map.mark(far, Mark::Visited, Revision(2));
            let entrance = Entrance::of(&map);
            let columns = [Column::WayOut, Column::Waiting(0), Column::Waiting(1), Column::Waiting(2)];
            let places: Vec<_> = columns.iter().flat_map(|column| [1, 2].map(|steps| entrance.middle(steps, *column))).collect();
            for (place, (x, y)) in places.iter().enumerate() {
                assert!(
                    *y < entrance.south && *y > entrance.south - entrance.height() && *x < entrance.east(),
                    "{x} {y} at {far}"
                );
                let apart = |(a, b): &(i32, i32)| (x - a).abs() + (y - b).abs();
                assert!(places.iter().skip(place + 1).all(|other| apart(other) >= 10 * entrance.tenth), "{x} {y} at {far}");
            }
        }
    }

    #[test]
    fn the_container_shows_what_is_in_it_and_counts_what_has_no_room() {
        let draw = |most: u64| {
            let mut group = String::new();
            Entrance::of(&drawn(&["1"], 1)).draw(Language::English, &mut group, &(1..=most).map(LuggageId).collect::<Vec<_>>());
            group
        };
        assert!(draw(0).contains("container: empty") && !draw(0).contains("piece danger"));
        assert!(draw(2).contains("container: luggage #1, luggage #2") && draw(2).contains(">#2<"));
        assert!(draw(6).contains("and 2 more") && draw(6).matches("piece danger").count() == SEEN, "{}", draw(6));
    }
}
