//! The known hall as a picture for paper. Equal cells in a row are drawn together. Pieces are numbered signs whose
//! shape shows the verdict. Home has a sign of its own. The numbers along the edges are counted from home.

use std::fmt::Write;

use hallsweep_core::state::PersistentState;
use hallsweep_core::units::Cell;
use hallsweep_core::world::hall_map::{Bounds, HallMap, Mark};
use hallsweep_core::world::luggage::Luggage;

const DRAWN: [(Mark, &str); 5] = [
    (Mark::Visited, "visited"),
    (Mark::Seen, "seen"),
    (Mark::Wall, "wall"),
    (Mark::Luggage, "found"),
    (Mark::NotInspected, "todo"),
];

/// Distance from the middle of a sign to its edge, as a share of the hall's longer side. It is at least half a cell.
const SIGN: f64 = 1.0 / 50.0;

/// Maximum number of labels along an edge.
const NUMBERS: i32 = 20;

/// The visible part of the picture as x, y, width and height, in cells.
pub(super) fn view_box(state: &PersistentState) -> String {
    let Bounds { least, most } = state.map.known_bounds();
    let room = sign(state) * 1.6;
    let (x, y) = (f64::from(least.x) - room, f64::from(least.y) - room);
    format!("{x:.2} {y:.2} {:.2} {:.2}", f64::from(most.x + 1) - x, f64::from(most.y + 1) - y)
}

pub(super) fn picture(state: &PersistentState) -> String {
    let mut svg = String::new();
    for (mark, class) in DRAWN {
        write!(svg, "<path class=\"{class}\" d=\"{}\"/>", runs(&state.map, mark)).expect(WRITES);
    }
    numbers(&mut svg, state);
    let size = sign(state);
    let (x, y) = middle(Cell::HOME);
    write!(
        svg,
        "<path class=\"home\" d=\"M{:.2} {y}l{size:.2} {:.2}l{size:.2} {size:.2}v{size:.2}h{:.2}z\"/>",
        x - size,
        -size,
        -2.0 * size
    )
    .expect(WRITES);
    state.luggage.iter().for_each(|luggage| piece(&mut svg, luggage, size));
    svg
}

const WRITES: &str = "a String takes all that is written";

/// Distance from the middle of a sign to its edge, in cells.
fn sign(state: &PersistentState) -> f64 {
    let bounds = state.map.known_bounds();
    (f64::from(bounds.width().max(bounds.height())) * SIGN).max(0.5)
}

fn middle(cell: Cell) -> (f64, f64) {
    (f64::from(cell.x) + 0.5, f64::from(cell.y) + 0.5)
}

fn runs(map: &HallMap, mark: Mark) -> String {
    let Bounds { least, most } = map.known_bounds();
    let mut path = String::new();
    for y in least.y..=most.y {
        let mut x = least.x;
        while x <= most.x {
            let begin = x;
            while x <= most.x && map.at(Cell::new(x, y)) == mark {
                x += 1;
            }
            if x > begin {
                write!(path, "M{begin} {y}h{}v1h-{}z", x - begin, x - begin).expect(WRITES);
            }
            x += i32::from(x == begin);
        }
    }
    path
}

fn numbers(svg: &mut String, state: &PersistentState) {
    let Bounds { least, most } = state.map.known_bounds();
    let size = sign(state);
    let step = step((most.x - least.x).max(most.y - least.y) / NUMBERS);
    let at = |from: i32, to: i32| (from..=to).filter(move |number| number.rem_euclid(step) == 0);
    write!(svg, "<g class=\"numbers\" font-size=\"{size:.2}\">").expect(WRITES);
    for x in at(least.x, most.x) {
        write!(svg, "<text x=\"{:.1}\" y=\"{:.2}\">{x}</text>", f64::from(x) + 0.5, f64::from(least.y) - size * 0.3)
            .expect(WRITES);
    }
    for y in at(least.y, most.y) {
        write!(
            svg,
            "<text x=\"{:.2}\" y=\"{:.2}\">{y}</text>",
            f64::from(least.x) - size * 0.8,
            f64::from(y) + 0.5 + size * 0.35
        )
        .expect(WRITES);
    }
    svg.push_str("</g>");
}

/// The smallest of 1, 2, 5, 10, 20, 50 and so on that is greater than `least`.
fn step(least: i32) -> i32 {
    let mut step = 1;
    while step <= least {
        step = match step.to_string().chars().next() {
            Some('2') => step / 2 * 5,
            _ => step * 2,
        };
    }
    step
}

fn piece(svg: &mut String, luggage: &Luggage, size: f64) {
    let (x, y) = middle(luggage.cell);
    let verdict = luggage.verdict_name();
    let secured = if luggage.secured.is_some() { " secured" } else { "" };
    write!(svg, "<g class=\"piece {verdict}{secured}\" transform=\"translate({x} {y})\">").expect(WRITES);
    let drawn = match verdict {
        "safe" => write!(svg, "<circle r=\"{size:.2}\"/>"),
        "danger" => write!(svg, "<path d=\"M0 {:.2}L{:.2} {:.2}H{:.2}Z\"/>", -1.5 * size, 1.4 * size, 0.9 * size, -1.4 * size),
        _ => {
            write!(svg, "<rect x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\"/>", -size, -size, 2.0 * size, 2.0 * size)
        }
    };
    drawn.expect(WRITES);
    write!(svg, "<text y=\"{:.2}\" font-size=\"{:.2}\">{}</text></g>", size * 0.38, size * 1.05, luggage.id).expect(WRITES);
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::Revision;

    #[test]
    fn numbers_stand_at_whole_steps() {
        assert_eq!([0, 1, 2, 4, 5, 9, 10, 50].map(step), [1, 2, 5, 5, 10, 10, 20, 100]);
    }

    #[test]
    fn neighbours_in_a_row_are_drawn_together() {
        let mut map = HallMap::new(Cell::HOME, Revision(1));
        for x in [1, 2, 3, 5] {
            map.mark(Cell::new(x, 2), Mark::Wall, Revision(1));
        }
        assert_eq!(runs(&map, Mark::Wall), "M1 2h3v1h-3zM5 2h1v1h-1z");
        assert_eq!(runs(&map, Mark::NotInspected), "");
    }
}
