//! Distances in the hall: how far a piece is from home in metres, and the evacuation circles round a bomb. The size of
//! the bomb gives their radius, otherwise the settings do. They are drawn only if the size of a cell is known. People
//! decide who must leave. The keep-out rings, which the robots respect, and the cells to be searched again are drawn
//! here, too.

use std::collections::BTreeSet;

use super::carriers::is_at;
use super::drawing::{CELL, middle, write};
use super::view::View;
use crate::phrases::Language;
use hallsweep_core::bomb_size::BombSize;
use hallsweep_core::units::{Cell, Heading};
use hallsweep_core::world::luggage::Luggage;

/// Draws the cells to be searched again, and the circles and the rings round all bombs in the hall. The circle of a
/// bomb that is being fetched moves with the bomb.
pub(super) fn circles(v: &View<'_>) -> String {
    let mut group = String::from("<g id=\"hall-evacuation\">");
    if !v.snapshot.mission.again.is_empty() {
        write(&mut group, format_args!("<path class=\"again\" d=\"{}\"/>", outline(&v.snapshot.mission.again)));
    }
    if let Some(cell_m) = v.hall.cell_m {
        for bomb in v.snapshot.luggage.bombs_left() {
            let (x, y) = is_at(v.snapshot, bomb);
            let (mandatory, preferred) = distances(v, bomb);
            for (class, metres) in [("evacuation preferred", preferred), ("evacuation", Some(mandatory))] {
                let Some(radius) = metres.map(|metres| f64::from(CELL) * metres / cell_m) else { continue };
                write(&mut group, format_args!("<circle class=\"{class}\" cx=\"{x}\" cy=\"{y}\" r=\"{radius:.1}\"/>"));
            }
        }
    }
    let radius = f64::from(CELL) * v.snapshot.mission.keep_out.radius();
    for ring in v.snapshot.mission.keep_out.rings() {
        let said = v.say("keep-out-of").with("id", ring.luggage);
        for (x, y) in ring.bomb.iter().copied().map(middle) {
            let circle =
                format_args!("<circle class=\"keep-out\" cx=\"{x}\" cy=\"{y}\" r=\"{radius:.1}\"><title>{said}</title></circle>");
            write(&mut group, circle);
        }
    }
    group.push_str("</g>");
    group
}

/// Returns the outline of these cells. Cells side by side in a row share a rectangle.
fn outline(cells: &BTreeSet<Cell>) -> String {
    let firsts = cells.iter().filter(|cell| !cells.contains(&cell.ahead(Heading::West)));
    let rectangle = |first: &Cell| {
        let last = (first.x..).take_while(|x| cells.contains(&Cell::new(*x, first.y))).last().unwrap_or(first.x);
        let width = (last - first.x + 1) * CELL;
        format!("M{} {}h{width}v{CELL}h-{width}z", first.x * CELL, first.y * CELL)
    };
    firsts.map(rectangle).collect()
}

/// Returns the distance in metres that everybody must keep from a bomb, and the one within which people outdoors must
/// go into a building. A bomb without a size has the distance of the settings.
pub(super) fn distances(v: &View<'_>, bomb: &Luggage) -> (f64, Option<f64>) {
    let size = bomb.verdict.as_ref().and_then(|decision| decision.hot.size);
    let mandatory = size.map_or(v.hall.evacuation_m, |size| size.mandatory_m().into());
    (mandatory, size.and_then(BombSize::preferred_m).map(f64::from))
}

/// Whether the inner circle round a bomb contains the whole known part of the hall.
pub(super) fn takes_in_all(v: &View<'_>, bomb: &Luggage) -> bool {
    let Some(cell_m) = v.hall.cell_m else { return false };
    let known = v.snapshot.map.known_bounds();
    let corners = [
        (known.least.x, known.least.y),
        (known.most.x, known.least.y),
        (known.least.x, known.most.y),
        (known.most.x, known.most.y),
    ];
    let (mandatory, _) = distances(v, bomb);
    corners.into_iter().all(|(x, y)| distance(Cell::new(x, y), bomb.cell) * cell_m <= mandatory)
}

pub(super) fn from_home(language: Language, cell: Cell, cell_m: Option<f64>) -> String {
    let (east, south) = (cell.x - Cell::HOME.x, cell.y - Cell::HOME.y);
    let sides = [(east, "east", "west"), (south, "south", "north")];
    let sides = sides.into_iter().filter(|(cells, ..)| *cells != 0);
    let towards = |cells: i32, there: &'static str, back: &'static str| if cells > 0 { there } else { back };
    let metres = |metres: f64| language.number(&format!("{metres:.1}"));
    let words = |(cells, there, back): (i32, &'static str, &'static str)| {
        let side = language.say_of("heading", towards(cells, there, back));
        let said = match cell_m {
            Some(cell_m) => language.say("from-home-metres").with("metres", metres(f64::from(cells.abs()) * cell_m)),
            None => language.say("from-home-cells").with("count", cells.abs()),
        };
        said.with("side", side).to_string()
    };
    let sides: Vec<String> = sides.map(words).collect();
    match (sides.len(), cell_m) {
        (0, _) => language.say("from-home-none"),
        (2, Some(cell_m)) => language
            .say("from-home-straight")
            .with("sides", language.list(&sides))
            .with("metres", metres(distance(cell, Cell::HOME) * cell_m)),
        _ => language.say("from-home").with("sides", language.list(&sides)),
    }
    .to_string()
}

/// Returns the distance between the middles of two cells, in cells.
fn distance(one: Cell, other: Cell) -> f64 {
    f64::from(one.x - other.x).hypot(f64::from(one.y - other.y))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::super::view::HallInfo;
    use super::*;
    use crate::api::tests::fixture::{TEN, idle, piece, searching};
    use hallsweep_core::command::{Hot, Verdict};
    use hallsweep_core::settings::Rules;
    use hallsweep_core::snapshot::Snapshot;
    use hallsweep_core::units::LuggageId;
    use hallsweep_core::world::luggage::Decision;

    fn view(snapshot: &Snapshot, cell_m: Option<f64>) -> View<'_> {
        let hall = HallInfo {
            name: "airport".into(),
            cell_m,
            evacuation_m: 25.0,
            is_paused: false,
            is_reckoned: false,
            robot: None,
            rules: Rules::default(),
        };
        View { snapshot, hall, began: None, who: None, language: Language::English, why: None, now: TEN, line: None, then: None }
    }

    #[test]
    fn every_bomb_in_the_hall_has_a_circle_of_as_many_metres_as_are_set() {
        let mut snapshot = searching();
        snapshot.luggage.insert(piece(4, Cell::new(0, 4), Some(Verdict::Danger)));
        let drawn = circles(&view(&snapshot, Some(0.5)));
        assert_eq!(drawn.matches("r=\"500.0\"").count(), 2, "{drawn}");
        assert!(drawn.contains("cx=\"5\" cy=\"45\""), "round the middle of its cell: {drawn}");
        snapshot.luggage.change(LuggageId(4), |bomb| bomb.secured = Some(TEN));
        assert_eq!(
            circles(&view(&snapshot, Some(0.5))).matches("<circle").count(),
            1,
            "one in the container is none in the hall"
        );
        assert_eq!(circles(&view(&idle(), Some(0.5))), "<g id=\"hall-evacuation\"></g>");
    }

    #[test]
    fn cells_to_be_searched_again_are_drawn_row_by_row() {
        let mut snapshot = idle();
        snapshot.mission.again = Arc::new([(0, 1), (1, 1), (3, 1), (0, 2)].map(|(x, y)| Cell::new(x, y)).into());
        let drawn = circles(&view(&snapshot, None));
        let outline = "<path class=\"again\" d=\"M0 10h20v10h-20zM0 20h10v10h-10zM30 10h10v10h-10z\"/>";
        assert_eq!(drawn, format!("<g id=\"hall-evacuation\">{outline}</g>"));
    }

    #[test]
    fn a_bomb_of_known_size_has_the_two_circles_of_its_size() {
        let mut snapshot = searching();
        let name = |snapshot: &mut Snapshot, size| {
            let decide = |decision: Decision| Decision { hot: Hot { size: Some(size), ..Hot::NONE }, ..decision };
            snapshot.luggage.change(LuggageId(2), |bomb| bomb.verdict = bomb.verdict.take().map(decide));
        };
        for (size, circles_of) in [(BombSize::Suitcase, vec!["11280.0", "920.0"]), (BombSize::Radius(30), vec!["600.0"])] {
            name(&mut snapshot, size);
            let drawn = circles(&view(&snapshot, Some(0.5)));
            let radii: Vec<&str> = drawn.split(" r=\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
            assert_eq!(radii, circles_of, "{drawn}");
        }
    }

    #[test]
    fn without_the_side_of_a_cell_no_circle_is_guessed() {
        let snapshot = searching();
        let unmeasured = view(&snapshot, None);
        assert_eq!(circles(&unmeasured), "<g id=\"hall-evacuation\"></g>");
        assert!(!takes_in_all(&unmeasured, &piece(2, Cell::HOME, Some(Verdict::Danger))));
    }

    #[test]
    fn that_the_whole_hall_lies_within_is_said_only_when_its_far_corner_does() {
        let snapshot = searching();
        let known = snapshot.map.known_bounds();
        let reach = distance(known.most, known.least);
        let bomb = piece(2, known.most, Some(Verdict::Danger));
        assert!(takes_in_all(&view(&snapshot, Some(24.9 / reach)), &bomb));
        assert!(!takes_in_all(&view(&snapshot, Some(25.1 / reach)), &bomb));
    }

    #[test]
    fn a_place_is_said_as_seen_from_home() {
        let half = Some(0.5);
        for (cell, cell_m, words) in [
            (Cell::new(3, 4), half, "1.5 m east and 2.0 m south of home, 2.5 m in a straight line"),
            (Cell::new(-3, 0), half, "1.5 m west of home"),
            (Cell::new(0, -1), None, "1 cell north of home"),
            (Cell::new(6, 2), None, "6 cells east and 2 cells south of home"),
            (Cell::HOME, half, "at home"),
        ] {
            assert_eq!(from_home(Language::English, cell, cell_m).replace('\u{a0}', " "), words);
        }
    }
}
