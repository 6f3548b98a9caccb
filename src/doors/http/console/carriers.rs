//! Draws the robots that fetch luggage in the picture of the hall: position, name, and the arm that reaches to the
//! piece. It also draws the piece that a robot holds. `hall` draws the searching robot, `entrance` the area before
//! the entrance.

use super::drawing::{CELL, draw_luggage, larger, middle, turn, write};
use super::entrance::{Column, Entrance};
use crate::phrases::Language;
use hallsweep_core::place::Place;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::snapshot::robot::RobotShown;
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::Luggage;

/// Whether the area before the entrance must be drawn: there is a fetching robot, or a piece in the container.
pub(super) fn has_entrance(snapshot: &Snapshot) -> bool {
    snapshot.robots.len() > 1 || snapshot.luggage.secured().next().is_some()
}

pub(super) fn carriers(language: Language, snapshot: &Snapshot) -> String {
    let mut group = String::from("<g id=\"hall-carriers\">");
    if has_entrance(snapshot) {
        let scene = Scene::of(snapshot);
        let secured: Vec<LuggageId> = snapshot.luggage.secured().map(|piece| piece.id).collect();
        scene.entrance.draw(language, &mut group, &secured);
        let others = || (1..).zip(snapshot.robots.iter().skip(1));
        others().for_each(|(waits, robot)| scene.robot(&mut group, waits, robot));
        scene.parcel(language, &mut group, snapshot);
    }
    group.push_str("</g>");
    group
}

pub(super) fn searcher_at(snapshot: &Snapshot) -> (i32, i32) {
    match snapshot.robot.outside {
        0 => middle(snapshot.robot.pose.cell),
        steps => Entrance::of(&snapshot.map).middle(steps, Column::Waiting(0)),
    }
}

pub(super) fn fetched(snapshot: &Snapshot) -> Option<&Luggage> {
    let retrieval = snapshot.retrieval.as_deref()?;
    snapshot.luggage(retrieval.luggage).map(|piece| &**piece)
}

/// Returns where a piece that is to be fetched lies in the hall. Returns `None` while a robot holds the piece, and
/// after the piece is secured.
pub(super) fn fetched_lies_at(snapshot: &Snapshot, piece: &Luggage) -> Option<(i32, i32)> {
    if piece.secured.is_some() || held_at(snapshot, piece).is_some() {
        return None;
    }
    let cells = &snapshot.retrieval.as_deref()?.piece;
    let found = cells.contains(&piece.cell) || cells.is_empty();
    Some(middle(if found { piece.cell } else { cells[0] }))
}

/// Returns where a piece is drawn: the place where it was found, or the place where a robot holds it.
pub(super) fn is_at(snapshot: &Snapshot, piece: &Luggage) -> (i32, i32) {
    let is_fetched = fetched(snapshot).is_some_and(|fetched| fetched.id == piece.id);
    match held_at(snapshot, piece) {
        Some(place) => Scene::of(snapshot).place(place),
        None if is_fetched => fetched_lies_at(snapshot, piece).unwrap_or_else(|| middle(piece.cell)),
        None => middle(piece.cell),
    }
}

pub(super) fn held_at(snapshot: &Snapshot, piece: &Luggage) -> Option<Place> {
    fetched(snapshot).filter(|fetched| fetched.id == piece.id)?;
    snapshot.robots.iter().find_map(|robot| robot.arm?.holds).map(|parcel| parcel.place)
}

struct Scene {
    entrance: Entrance,
    /// Factor by which everything drawn here is enlarged.
    size: i32,
}

impl Scene {
    fn of(snapshot: &Snapshot) -> Scene {
        Scene { entrance: Entrance::of(&snapshot.map), size: larger(&snapshot.map) }
    }

    fn place(&self, place: Place) -> (i32, i32) {
        match place {
            Place::Cell(cell) => middle(cell),
            Place::Outside(steps) => self.entrance.middle(steps, Column::WayOut),
        }
    }

    /// Returns where a robot is drawn. In a large hall, the robot and its piece are drawn larger than their cells.
    /// The distance between them is enlarged too, otherwise the robot would cover the piece.
    fn at(&self, waits: i32, robot: &RobotShown) -> (i32, i32) {
        let at_work = reaches(robot);
        if robot.view.outside > 0 {
            let column = if at_work.is_some() { Column::WayOut } else { Column::Waiting(waits) };
            return self.entrance.middle(robot.view.outside, column);
        }
        let (x, y) = middle(robot.view.pose.cell);
        match at_work.and_then(Place::cell).map(middle) {
            Some((about_x, about_y)) => (about_x + self.size * (x - about_x), about_y + self.size * (y - about_y)),
            None => (x, y),
        }
    }

    /// Draws the arm from the robot to the piece. The arm moves with the robot.
    fn arm(&self, waits: i32, robot: &RobotShown) -> String {
        let Some(place) = reaches(robot) else { return String::new() };
        let ((x, y), (to_x, to_y)) = (self.at(waits, robot), self.place(place));
        let class = if robot.arm.is_some_and(|arm| arm.holds.is_some()) { "arm holding" } else { "arm" };
        format!("<path class=\"{class}\" stroke-width=\"{}\" d=\"M0 0L{} {}\"/>", 2 * self.size, to_x - x, to_y - y)
    }

    fn robot(&self, group: &mut String, waits: i32, robot: &RobotShown) {
        let ((x, y), size) = (self.at(waits, robot), self.size);
        let off_centre = if robot.view.off_centre { " off-centre" } else { "" };
        let (name, arm) = (robot.id.name(), self.arm(waits, robot));
        // The name is drawn on the side of the robot that is away from the piece. Before the entrance it is above, because
        // the numbers of columns are below.
        let is_above = robot.view.outside > 0 || reaches(robot).is_some_and(|place| self.place(place).1 > y);
        let name_y = if is_above { "-5" } else { "8.2" };
        write(
            group,
            format_args!(
                "<g id=\"hall-carrier-{waits}\" class=\"robot carrier{off_centre}\" transform=\"translate({x} {y})\"><title>{name}</title>{arm}\
                 <g transform=\"scale({size})\"><g transform=\"rotate({})\"><rect class=\"body\" x=\"-3.8\" y=\"-3.8\" width=\"7.6\" height=\"7.6\" rx=\"1.6\"/>\
                 <path class=\"nose\" d=\"M0 -3L2.2 1.2H-2.2Z\"/></g><text class=\"name\" y=\"{name_y}\">{name}</text></g></g>",
                turn(robot.view.pose.heading)
            ),
        );
    }

    fn parcel(&self, language: Language, group: &mut String, snapshot: &Snapshot) {
        if let Some(piece) = fetched(snapshot)
            && let Some(place) = held_at(snapshot, piece)
        {
            // The held piece has the class `robot`, so it moves in the picture like a robot. It is smaller, so that
            // the robots' names stay visible.
            let (x, y) = self.place(place);
            write(
                group,
                format_args!(
                    "<g id=\"hall-load\" class=\"robot load\" transform=\"translate({x} {y})\"><g transform=\"scale(.75)\">"
                ),
            );
            draw_luggage(language, group, piece, (0, 0), self.size);
            group.push_str("</g></g>");
        }
    }
}

fn reaches(robot: &RobotShown) -> Option<Place> {
    let arm = robot.arm?;
    arm.holds.map(|parcel| parcel.place).or(arm.aligned)
}

const _: () = assert!(CELL == 10, "bodies and names are drawn for cells of ten units");
