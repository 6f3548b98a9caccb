//! The hall as a picture. Its parts can be sent separately: one group for each map tile, the labels, the searching
//! robot, and a small layer with other things that change at each step. `pieces` draws the luggage. One cell is
//! `CELL` units wide. Neighbouring cells of the same kind are drawn as one stroke, which keeps the picture of a large
//! hall small. The template and the style sheet contain the frames, the legend and the colours.

use super::carriers::{fetched, fetched_lies_at, has_entrance, searcher_at};
use super::drawing::{CELL, draw_luggage, larger, middle, shown, turn, write};
use super::entrance::Entrance;
use super::pieces;
use crate::phrases::{Language, Phrase};
use hallsweep_core::snapshot::{AreaView, Snapshot};
use hallsweep_core::units::{Cell, Heading};
use hallsweep_core::world::coverage::{Coverage, Sensor, Views};
use hallsweep_core::world::hall_map::{Bounds, HallMap, Mark, TILE};
use hallsweep_core::world::luggage::Luggage;

/// Length of the trail behind the robot, in cells.
const TRAIL: usize = 48;

const FADES: usize = 4;

/// The levels in which the coverage is drawn: the name that the phrases have for each, and the dots of its cells, for
/// people who cannot distinguish the colours.
const LEVELS: [(&str, &str); 4] = [("0", ""), ("1", "M5 5h0"), ("2", "M3 7h0M7 3h0"), ("3", "M3 7h0M5 5h0M7 3h0")];

/// Maximum number of labels at one edge. If there is no room for a label at each cell, only every fifth, tenth, …
/// cell has one.
const LABELS: i32 = 24;

/// Maximum length of the drawn sonar ray, in cells.
const RAY: i32 = 8;

/// Maximum size of a frontier that is drawn, in cells. A larger frontier is not drawn at all, because it would be
/// most of the data sent at every step.
const FRONTIER: usize = 2000;

pub(super) fn view_box_now(snapshot: &Snapshot) -> String {
    view_box(&snapshot.map, has_entrance(snapshot).then(|| Entrance::of(&snapshot.map)), &snapshot.mission.areas)
}

/// Returns the `viewBox` of the picture, with a margin for the labels. It includes the area before the entrance if
/// that area is drawn, and the named areas, which are known before the search.
pub(super) fn view_box(map: &HallMap, entrance: Option<Entrance>, areas: &[AreaView]) -> String {
    let corners = areas.iter().flat_map(|view| view.area.corners.iter().copied());
    let (shown, margin) = (corners.fold(shown(map), Bounds::including), CELL * larger(map));
    let higher = entrance.map_or(0, Entrance::height);
    let (left, top) = (shown.least.x * CELL - margin, shown.least.y * CELL - margin - higher);
    let width = shown.width() * CELL + margin;
    let wide = entrance.map_or(width, |entrance| width.max(entrance.east() + margin - left));
    format!("{left} {top} {wide} {}", shown.height() * CELL + margin + higher)
}

pub(super) fn tile_id(corner: Cell) -> String {
    format!("tile_{}_{}", corner.x / TILE, corner.y / TILE)
}

pub(super) const fn tile_corner(cell: Cell) -> Cell {
    Cell::new(cell.x.div_euclid(TILE) * TILE, cell.y.div_euclid(TILE) * TILE)
}

/// Draws all tiles of the map.
pub(super) fn tiles(map: &HallMap) -> String {
    map.tiles().map(|(corner, _)| tile(map, corner)).collect()
}

/// Draws a tile as a group, with one path for each kind of mark in the tile.
pub(super) fn tile(map: &HallMap, corner: Cell) -> String {
    let mut group = format!("<g id=\"{}\">", tile_id(corner));
    stroke(&mut group, "wall", &areas(map, corner, Mark::Wall));
    stroke(&mut group, "edge", &edges(map, corner));
    // The ends of the edges at inner corners lie over floor, so floor is drawn over them.
    for (class, wanted) in
        [("seen", Mark::Seen), ("visited", Mark::Visited), ("bag", Mark::Luggage), ("todo", Mark::NotInspected)]
    {
        stroke(&mut group, class, &areas(map, corner, wanted));
    }
    group.push_str("</g>");
    group
}

fn stroke(group: &mut String, class: &str, path: &str) {
    if !path.is_empty() {
        write(group, format_args!("<path class=\"{class}\" d=\"{path}\"/>"));
    }
}

/// Returns the sides of the tile's walls at which known floor begins. They are drawn as the lines of a floor plan. A
/// line lies within its wall, where no floor of a neighbouring tile is drawn over it.
fn edges(map: &HallMap, corner: Cell) -> String {
    let is_wall = |x, y| map.at(Cell::new(x, y)) == Mark::Wall;
    let is_floor = |x, y| !matches!(map.at(Cell::new(x, y)), Mark::Wall | Mark::Unknown);
    let mut path = String::new();
    for (side, inset) in [(-1, 1), (1, CELL - 1)] {
        for y in corner.y..corner.y + TILE {
            for (x, length) in runs(corner.x, |x| is_wall(x, y) && is_floor(x, y + side)) {
                write(&mut path, format_args!("M{} {}h{}", x * CELL, y * CELL + inset, length * CELL));
            }
        }
        for x in corner.x..corner.x + TILE {
            for (y, length) in runs(corner.y, |y| is_wall(x, y) && is_floor(x + side, y)) {
                write(&mut path, format_args!("M{} {}v{}", x * CELL + inset, y * CELL, length * CELL));
            }
        }
    }
    path
}

/// Draws the numbers of columns and rows beside the known part of the hall. With scripts the numbers stay in sight
/// when the picture is enlarged; `data-known` says how far they go.
pub(super) fn labels(map: &HallMap) -> String {
    let known = map.known_bounds();
    let Bounds { least, most } = known;
    let mut group = format!("<g id=\"hall-labels\" data-known=\"{} {} {} {}\">", least.x, least.y, most.x, most.y);
    let size = larger(map);
    let fits = |count: i32, step: i32| count / step <= LABELS && step >= size;
    let step = |count: i32| [1, 5, 10, 50, 100, 500].into_iter().find(|step| fits(count, *step)).unwrap_or(1000);
    let (every_x, every_y) = (step(known.width()), step(known.height()));
    let (left, top) = (least.x * CELL - CELL * size / 2, least.y * CELL - CELL * size / 2);
    for x in (least.x..=most.x).filter(|x| x % every_x == 0) {
        label(&mut group, (x * CELL + CELL / 2, top), size, x);
    }
    for y in (least.y..=most.y).filter(|y| y % every_y == 0) {
        label(&mut group, (left, y * CELL + CELL / 2), size, y);
    }
    group.push_str("</g>");
    group
}

fn label(group: &mut String, (x, y): (i32, i32), size: i32, number: i32) {
    write(group, format_args!("<text transform=\"translate({x} {y}) scale({size})\" y=\"2\">{number}</text>"));
}

/// Draws the frontier: unknown cells beside visited ones, where the search continues.
pub(super) fn frontier(map: &HallMap) -> String {
    let mut group = String::from("<g id=\"hall-frontier\">");
    if (1..=FRONTIER).contains(&map.frontier_size()) {
        let mut path = String::new();
        for cell in map.frontier() {
            write(&mut path, format_args!("M{} {}h{CELL}v{CELL}h-{CELL}z", cell.x * CELL, cell.y * CELL));
        }
        write(&mut group, format_args!("<path class=\"frontier\" d=\"{path}\"/>"));
    }
    group.push_str("</g>");
    group
}

/// Draws home and what changes at each step, without the robots: the trail, the route, the goal, the sonar's ray, and
/// a piece that is to be fetched.
pub(super) fn layer(language: Language, snapshot: &Snapshot) -> String {
    let size = larger(&snapshot.map);
    let far = if size > 1 { " class=\"far\"" } else { "" };
    let mut group = format!("<g id=\"hall-layer\" data-larger=\"{size}\"{far}>");
    trail(&mut group, snapshot);
    home(language, &mut group, size);
    if let Some(piece) = fetched(snapshot)
        && let Some(at) = fetched_lies_at(snapshot, piece)
    {
        draw_luggage(language, &mut group, piece, at, size);
    }
    route(language, &mut group, snapshot, size);
    if snapshot.robot.outside == 0 {
        ray(&mut group, snapshot);
    }
    group.push_str("</g>");
    group
}

/// Draws home and the pieces, without robots, for the page of a recorded mission. Secured pieces are drawn in the
/// container.
pub(super) fn found<'a>(
    language: Language,
    map: &HallMap,
    entrance: Option<Entrance>,
    pieces: impl Iterator<Item = &'a Luggage>,
) -> String {
    let size = larger(map);
    let (secured, left): (Vec<&Luggage>, Vec<&Luggage>) = pieces.partition(|piece| piece.secured.is_some());
    let mut group = String::from("<g>");
    home(language, &mut group, size);
    if let Some(entrance) = entrance {
        entrance.draw(language, &mut group, &secured.iter().map(|piece| piece.id).collect::<Vec<_>>());
    }
    group.push_str("</g>");
    let left = left.into_iter();
    group.push_str(&if size > 1 { pieces::pinned(language, left, size) } else { pieces::in_their_cells(language, left) });
    group
}

/// Draws the searching robot in a separate group, which moves smoothly from cell to cell.
pub(super) fn robot(snapshot: &Snapshot) -> String {
    let (x, y) = searcher_at(snapshot);
    let turn = turn(snapshot.robot.pose.heading);
    // A single robot needs no name. The name is never drawn ahead of the robot, because the robot's target is drawn
    // there.
    let name_y = if snapshot.robot.pose.heading == Heading::South { "-5.4" } else { "8.2" };
    let name = match snapshot.robots.first().filter(|_| snapshot.robots.len() > 1) {
        Some(robot) => {
            format!("<text class=\"name\" transform=\"scale({})\" y=\"{name_y}\">{}</text>", larger(&snapshot.map), robot.id)
        }
        None => String::new(),
    };
    let off_centre = if snapshot.robot.off_centre { " off-centre" } else { "" };
    draw_robot((x, y), turn, larger(&snapshot.map), snapshot.robot.led_blinking, off_centre, &name)
}

fn draw_robot((x, y): (i32, i32), turn: i32, size: i32, led_blinking: bool, class: &str, name: &str) -> String {
    let led = if led_blinking { "led blinking" } else { "led" };
    format!(
        "<g id=\"hall-robot\" class=\"robot{class}\" transform=\"translate({x} {y})\"><g transform=\"rotate({turn})\">\
         <g class=\"sized\" transform=\"scale({size})\">\
         <path class=\"cone\" d=\"M0 0L-4.5 -9A10 10 0 0 1 4.5 -9Z\"/>\
         <circle class=\"body\" r=\"4\"/><path class=\"nose\" d=\"M0 -3.4L2.4 1.2H-2.4Z\"/>\
         <circle class=\"{led}\" cy=\"2.3\" r=\"0.9\"/></g></g>{name}</g>"
    )
}

/// Draws how well each cell was searched, over the floor: four levels of the probability of detection, or of the number of
/// views if the sensor is not calibrated.
pub(super) fn coverage(coverage: &Coverage, sensor: Sensor) -> String {
    let cells: Vec<(usize, Cell)> = coverage.iter().map(|(cell, views)| (level(sensor, views), cell)).collect();
    let mut paths: [String; LEVELS.len()] = Default::default();
    // The cells of a tile come row by row.
    for run in cells.chunk_by(|(level, cell), next| (*level, cell.ahead(Heading::East)) == *next) {
        let ((level, Cell { x, y }), length) = (run[0], run.len() * CELL as usize);
        write(&mut paths[level], format_args!("M{} {}h{length}v{CELL}h-{length}z", x * CELL, y * CELL));
    }
    let mut group = String::from("<g id=\"hall-coverage\">");
    for ((level, dots), path) in LEVELS.iter().zip(&paths) {
        write(
            &mut group,
            format_args!(
                "<pattern id=\"dotted-{level}\" width=\"{CELL}\" height=\"{CELL}\" patternUnits=\"userSpaceOnUse\">\
                 <path class=\"looked-{level}\" d=\"M0 0h{CELL}v{CELL}h-{CELL}z\"/><path class=\"dots\" d=\"{dots}\"/></pattern>\
                 <path fill=\"url(#dotted-{level})\" d=\"{path}\"/>"
            ),
        );
    }
    group.push_str("</g>");
    group
}

fn level(sensor: Sensor, views: Views) -> usize {
    match sensor.detection(views) {
        Some(share) => [0.5, 0.8, 0.95].into_iter().filter(|least| share >= *least).count(),
        None => (views.count() as usize).clamp(1, LEVELS.len()) - 1,
    }
}

/// Returns what the levels of `coverage` mean, and their dots.
pub(super) fn levels(language: Language, sensor: Sensor) -> [(Phrase<'static>, &'static str); LEVELS.len()] {
    let family = if sensor.model.is_some() { "coverage-pod" } else { "coverage-views" };
    LEVELS.map(|(level, dots)| (language.say_of(family, level), dots))
}

fn areas(map: &HallMap, corner: Cell, wanted: Mark) -> String {
    let mut path = String::new();
    for y in corner.y..corner.y + TILE {
        for (x, length) in runs(corner.x, |x| map.at(Cell::new(x, y)) == wanted) {
            write(&mut path, format_args!("M{} {}h{}v{CELL}h-{}z", x * CELL, y * CELL, length * CELL, length * CELL));
        }
    }
    path
}

/// Returns start and length of each run of cells for which `is_wanted`, in a row or column of a tile.
fn runs(first: i32, is_wanted: impl Fn(i32) -> bool) -> Vec<(i32, i32)> {
    let mut runs: Vec<(i32, i32)> = Vec::new();
    for at in (first..first + TILE).filter(|at| is_wanted(*at)) {
        match runs.last_mut() {
            Some((start, length)) if *start + *length == at => *length += 1,
            _ => runs.push((at, 1)),
        }
    }
    runs
}

fn trail(group: &mut String, snapshot: &Snapshot) {
    let mut trail = snapshot.mission.trail.to_vec();
    if trail.last().is_some_and(|last| last.neighbours().contains(&snapshot.robot.pose.cell)) {
        trail.push(snapshot.robot.pose.cell);
    }
    let latest = &trail[trail.len().saturating_sub(TRAIL)..];
    let part = latest.len().div_ceil(FADES).max(1);
    for (fade, cells) in latest.rchunks(part).enumerate() {
        // Each part begins where the part before it ended, so that the line has no gaps.
        let from = latest.len() - (fade * part + cells.len());
        let to = (from + cells.len() + 1).min(latest.len());
        if to - from > 1 {
            let points = points(latest[from..to].iter().copied());
            write(group, format_args!("<polyline class=\"trail fade-{fade}\" points=\"{points}\"/>"));
        }
    }
}

fn home(language: Language, group: &mut String, size: i32) {
    let ((x, y), home) = (middle(Cell::HOME), language.say("legend-home"));
    write(
        group,
        format_args!(
            "<g transform=\"translate({x} {y})\"><path class=\"home sized\" transform=\"scale({size})\" d=\"M-4 0l4 -3.4l4 3.4v4.4h-8z\">\
             <title>{home}</title></path></g>"
        ),
    );
}

fn route(language: Language, group: &mut String, snapshot: &Snapshot, size: i32) {
    let route = &snapshot.mission.route;
    if !route.is_empty() {
        let points = points(std::iter::once(snapshot.robot.pose.cell).chain(route.iter().copied()));
        write(group, format_args!("<polyline class=\"route\" points=\"{points}\"/>"));
    }
    // The cross of the goal would cover a piece of luggage in the same cell. The piece is more important.
    let goal = snapshot.mission.goal.filter(|goal| snapshot.map.at(*goal) != Mark::Luggage);
    if let Some(goal) = goal {
        let ((x, y), said) = (middle(goal), language.say("goal-at").with("cell", goal));
        write(
            group,
            format_args!(
                "<g transform=\"translate({x} {y})\"><path class=\"goal sized\" transform=\"scale({size})\" d=\"M-3 -3l6 6m0 -6l-6 6\">\
                 <title>{said}</title></path></g>"
            ),
        );
    }
}

/// Draws the sonar's cone from the robot over the free cells ahead. The exact distance is shown beside the picture.
fn ray(group: &mut String, snapshot: &Snapshot) {
    let pose = snapshot.robot.pose;
    let (dx, dy) = pose.heading.vector();
    let ahead = |n: i32| Cell::new(pose.cell.x + dx * n, pose.cell.y + dy * n);
    let free = (1..=RAY).take_while(|n| snapshot.map.at(ahead(*n)) == Mark::Visited).count();
    let length = i32::try_from(free).unwrap_or(RAY) * CELL + CELL / 2;
    let class = if snapshot.robot.sonar_cm.is_some() { "ray" } else { "ray nothing" };
    let ((x, y), wide) = (middle(pose.cell), (length / 8 + 1).min(CELL / 2 - 1));
    let (ahead_x, ahead_y) = (x + dx * length, y + dy * length);
    let [left, right] = [wide, -wide].map(|side| format!("L{} {}", ahead_x - dy * side, ahead_y + dx * side));
    write(group, format_args!("<path class=\"{class}\" d=\"M{x} {y}{left}{right}z\"/>"));
}

fn points(cells: impl Iterator<Item = Cell>) -> String {
    let mut points = String::new();
    for (x, y) in cells.map(middle) {
        write(&mut points, format_args!("{x},{y} "));
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::{drawn, idle, searching};
    use hallsweep_core::units::Revision;

    #[test]
    fn equal_neighbours_are_one_stroke() {
        let map = drawn(&["111", "WW"], 1);
        let tile = tile(&map, Cell::HOME);
        assert_eq!(
            tile,
            "<g id=\"tile_0_0\"><path class=\"wall\" d=\"M0 10h20v10h-20z\"/><path class=\"edge\" d=\"M0 11h20\"/>\
             <path class=\"visited\" d=\"M0 0h30v10h-30z\"/></g>"
        );
    }

    #[test]
    fn a_wall_is_a_line_where_known_floor_begins() {
        let map = drawn(&["111", "W1W", "WW"], 1);
        let tile = tile(&map, Cell::HOME);
        let (_, edges) = tile.split_once("<path class=\"edge\" d=\"").expect("there are walls beside floor");
        let edges = edges.split_once('"').unwrap().0;
        assert_eq!(edges, "M0 11h10M20 11h10M10 21h10M21 10v10M9 10v10", "no line lies between two walls or before the unknown");
    }

    #[test]
    fn the_numbers_go_as_far_as_the_known_hall() {
        let labels = labels(&drawn(&["111", "W1W"], 1));
        assert!(labels.starts_with("<g id=\"hall-labels\" data-known=\"0 0 2 1\">"), "{labels}");
        assert_eq!(labels.matches("<text").count(), 3 + 2, "{labels}");
    }

    #[test]
    fn the_picture_holds_everything_known_and_keeps_still_meanwhile() {
        let mut map = HallMap::new(Cell::HOME, Revision(1));
        let first = view_box(&map, None, &[]);
        for cell in [Cell::new(3, 3), Cell::new(9, 6)] {
            map.mark(cell, Mark::Visited, Revision(2));
            assert_eq!(view_box(&map, None, &[]), first);
        }
        for cell in [Cell::new(40, 7), Cell::new(-9, -30), Cell::new(3, 90)] {
            map.mark(cell, Mark::Wall, Revision(3));
            assert!(shown(&map).contains(cell), "{cell}");
        }
    }

    #[test]
    fn the_layer_shows_goal_route_and_trail() {
        let layer = layer(Language::English, &searching());
        for part in ["class=\"goal sized\"", "class=\"route\"", "trail fade-0", "class=\"home sized\""] {
            assert!(layer.contains(part), "{part} in {layer}");
        }
    }

    #[test]
    fn in_a_large_hall_what_matters_is_drawn_larger() {
        let mut snapshot = searching();
        assert!(robot(&snapshot).contains("scale(1)"), "{}", robot(&snapshot));
        snapshot.map.mark(Cell::new(199, 90), Mark::Visited, Revision(21));
        assert!(robot(&snapshot).contains("scale(7)"), "{}", robot(&snapshot));
    }

    #[test]
    fn the_frontier_is_drawn_unless_it_is_endless() {
        let mut map = drawn(&["11"], 1);
        assert!(frontier(&map).contains("M20 0h10v10h-10z"), "{}", frontier(&map));
        for x in 0..2000 {
            map.mark(Cell::new(x, 0), Mark::Visited, Revision(2));
        }
        assert_eq!(frontier(&map), "<g id=\"hall-frontier\"></g>");
    }

    #[test]
    fn a_trail_of_any_length_is_drawn_without_gaps() {
        let mut snapshot = idle();
        for length in 0..60 {
            snapshot.mission.trail = (0..length).map(|x| Cell::new(x, 0)).collect();
            let drawn = layer(Language::English, &snapshot).matches("<polyline class=\"trail").count();
            assert!(drawn <= FADES && (drawn > 0) == (length > 1), "{length} cells in {drawn} parts");
        }
    }

    #[test]
    fn tiles_west_and_north_of_home_have_names_of_their_own() {
        assert_eq!(tile_id(Cell::new(-32, 32)), "tile_-1_1");
    }
}
