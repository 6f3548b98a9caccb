//! The hall map as text for old clients (mission §6). One form has a line per row, such as `|r, 1, X, `; the other
//! form has one line for all rows, such as `r 1 X @1 1 X @`. The first row and the first column of the text have a
//! visited cell. So the borders in the north and in the west are not written.

use super::map::{Plan, mark_char};
use hallsweep_core::units::Cell;
use hallsweep_core::world::hall_map::{Bounds, Mark};

/// Writes one line per row, with `, ` after each cell.
pub fn lines<'a>(plan: impl Into<Plan<'a>>) -> String {
    written(plan.into(), "|", ", ", "\n")
}

/// Writes all rows in one line, with a blank after each cell and `@` after each row.
pub fn one_line<'a>(plan: impl Into<Plan<'a>>) -> String {
    written(plan.into(), "", " ", "@")
}

fn written(plan: Plan<'_>, open: &str, after_cell: &str, after_row: &str) -> String {
    let shown = shown(plan);
    let mut text = String::new();
    for y in shown.least.y..=shown.most.y {
        text.push_str(open);
        for x in shown.least.x..=shown.most.x {
            text.push(text_char(plan, Cell::new(x, y)));
            text.push_str(after_cell);
        }
        text.push_str(after_row);
    }
    text
}

/// The part of the map that is shown: the rectangle of visited cells, the east border and the south border. A border
/// is shown only if any of its cells is known.
fn shown(plan: Plan<'_>) -> Bounds {
    let visited = plan.hall.visited_bounds();
    let most = Cell::new(visited.most.x + 1, visited.most.y + 1);
    let known = |cell| plan.hall.at(cell) != Mark::Unknown;
    let east = (visited.least.y..=most.y).any(|y| known(Cell::new(most.x, y)));
    let south = (visited.least.x..=most.x).any(|x| known(Cell::new(x, most.y)));
    let most = Cell::new(if east { most.x } else { visited.most.x }, if south { most.y } else { visited.most.y });
    Bounds { least: visited.least, most }
}

/// The character of `mark_char`, except in the corner between the east and the south border. No sensor can see this
/// corner, so it counts as a wall if both neighbours are walls.
fn text_char(plan: Plan<'_>, cell: Cell) -> char {
    let visited = plan.hall.visited_bounds();
    let is_corner = cell == Cell::new(visited.most.x + 1, visited.most.y + 1);
    let wall = |x, y| plan.hall.at(Cell::new(x, y)) == Mark::Wall;
    if is_corner && wall(cell.x - 1, cell.y) && wall(cell.x, cell.y - 1) { 'X' } else { mark_char(plan, cell) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::{drawn, idle};
    use hallsweep_core::snapshot::Snapshot;
    use hallsweep_core::units::{Heading, Pose};

    fn hall(rows: &[&str], robot: Cell) -> Snapshot {
        let mut snapshot = idle();
        snapshot.map = drawn(rows, 2);
        snapshot.robot.pose = Pose { cell: robot, heading: Heading::South };
        snapshot
    }

    #[test]
    fn an_empty_hall_of_eight_by_eight_has_its_known_text() {
        let mut rows = vec!["11111111W"; 8];
        rows.push("WWWWWWWW?");
        let text = lines(&hall(&rows, Cell::HOME));
        let first = "|r, 1, 1, 1, 1, 1, 1, 1, X, \n";
        let others = "|1, 1, 1, 1, 1, 1, 1, 1, X, \n".repeat(7);
        let border = "|X, X, X, X, X, X, X, X, X, \n";
        assert_eq!(text, format!("{first}{others}{border}"));
    }

    #[test]
    fn the_one_line_form_ends_every_row_with_an_at() {
        assert_eq!(one_line(&hall(&["11W", "11W"], Cell::HOME)), "r 1 X @1 1 X @");
    }

    #[test]
    fn a_border_of_which_nothing_is_known_is_not_shown() {
        assert_eq!(one_line(&hall(&["111", "111"], Cell::new(1, 1))), "1 1 1 @1 r 1 @");
        assert_eq!(one_line(&hall(&["11", "WW"], Cell::HOME)), "r 1 @X X @");
    }

    #[test]
    fn the_corner_is_a_wall_only_between_two_walls() {
        assert_eq!(one_line(&hall(&["1W", "W?"], Cell::HOME)), "r X @X X @");
        assert_eq!(one_line(&hall(&["1L", "W?"], Cell::HOME)), "r X @X 0 @");
        assert_eq!(one_line(&hall(&["11W", "W??"], Cell::HOME)), "r 1 X @X 0 0 @");
    }

    #[test]
    fn the_text_begins_at_the_least_visited_row_and_column() {
        let mut snapshot = hall(&["1"], Cell::HOME);
        for (cell, mark) in [(Cell::new(-1, -2), Mark::Visited), (Cell::new(-2, -2), Mark::Wall)] {
            snapshot.map.mark(cell, mark, hallsweep_core::units::Revision(3));
        }
        assert_eq!(one_line(&snapshot), "1 0 @0 0 @0 r @");
    }
}
