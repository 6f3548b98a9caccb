//! The assumed position of the virtual robot, which does not report its position. Its driver counts the time that it
//! moved, and corrects the position by the things that the robot meets, which have names and do not move.
//!
//! ```text
//!    cell 6      cell 7      cell 8            a face: where the robot's centre is when it touches this thing, coming this way;
//!  ┌───────────┬───────────┬─────▓▓▓▓▓▓        met once, its place is known, and the next time it tells how far the reckoning
//!  │     ·     │     ·  ───┼──►  ▓ wallDown    has drifted
//! ```
//! Lengths are in cells. Along a direction, coordinates grow in that direction.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use hallsweep_core::units::{Cell, Heading, Pose};

/// Greatest error of the reckoning, in cells. A greater error would put things into the wrong cells.
pub(super) const DRIFT: f64 = 0.45;

/// Most faces that are stored; a scene has some dozens.
const FACES: usize = 4096;

/// Most cells that are stored as cells where the robot has stood. A page of a hundred cells on a side is a large one.
const CELLS: usize = 16_384;

/// Furthest extent of a room, in cells.
const FURTHEST: i32 = 100_000;

/// Shortest way that shows how fast the robot is, in cells. A frame of its page is a twentieth of a cell.
const GAUGED: f64 = 2.0;

/// Greatest difference in cells between the whole way driven and the net way for the robot to have driven straight.
const STRAIGHT: f64 = 0.1;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Reckoning {
    /// The cell and heading of the last completed order.
    cell: (i32, i32),
    heading: String,
    /// Position of the robot's centre, in columns to the east and rows to the south of home.
    at: [f64; 2],
    faces: BTreeMap<String, f64>,
    /// The name of the face that the robot has met from each cell and heading.
    contacts: BTreeMap<String, String>,
    stood: BTreeSet<(i32, i32)>,
    /// The names of things that move, or that exist more than once.
    #[serde(skip)]
    unfixed: BTreeSet<String>,
    /// The faces with places from the scene file.
    #[serde(skip)]
    placed: BTreeSet<String>,
    /// For each axis, whether a thing was reported since the last known face. If the reckoning is wrong, so is the cell
    /// of that thing.
    has_news: [bool; 2],
    /// For each axis, the driving since the robot last met a thing whose place is known.
    since: [Option<Since>; 2],
}

/// Where the robot last met a thing whose place is known, and the way counted since then, in cells: the net way
/// `ahead`, and the total way `driven`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Since {
    at: f64,
    ahead: f64,
    driven: f64,
}

/// The reckoning was wrong by more than `DRIFT`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drift {
    /// Error in cells.
    pub(super) cells: f64,
    /// Whether nothing was reported since the last known face, so that no report is wrong.
    pub(super) is_harmless: bool,
}

impl Reckoning {
    pub(super) fn at_home() -> Reckoning {
        Reckoning {
            cell: (0, 0),
            heading: Pose::START.heading.name().to_owned(),
            at: [0.0; 2],
            faces: BTreeMap::new(),
            contacts: BTreeMap::new(),
            stood: BTreeSet::from([(0, 0)]),
            unfixed: BTreeSet::new(),
            placed: BTreeSet::new(),
            has_news: [false; 2],
            since: [None; 2],
        }
    }

    /// Notes that the robot is back at home in the same room. Only the position and the drift begin anew. The knowledge
    /// of the room stays.
    pub(super) fn put_home(&mut self) {
        let known = std::mem::replace(self, Reckoning::at_home());
        *self = Reckoning {
            faces: known.faces,
            contacts: known.contacts,
            stood: known.stood,
            unfixed: known.unfixed,
            placed: known.placed,
            ..Reckoning::at_home()
        };
    }

    pub(super) fn is_sound(&self) -> bool {
        let bounded = |length: f64| length.is_finite() && length.abs() < 1e6;
        let faces = self.faces.len().max(self.contacts.len()) <= FACES
            && self.stood.len() <= CELLS
            && self.faces.values().all(|face| bounded(*face));
        let since = self.since.iter().flatten().all(|since| [since.at, since.ahead, since.driven].into_iter().all(bounded));
        let is_near = |(x, y): &(i32, i32)| x.abs().max(y.abs()) < FURTHEST;
        let cells = self.stood.iter().chain([&self.cell]).all(is_near);
        cells && named(&self.heading).is_some() && self.at.into_iter().all(bounded) && faces && since
    }

    pub(super) fn pose(&self) -> Pose {
        let heading = named(&self.heading).unwrap_or(Pose::START.heading);
        Pose { cell: Cell::new(self.cell.0, self.cell.1), heading }
    }

    pub(super) fn complete(&mut self, pose: Pose) {
        self.cell = (pose.cell.x, pose.cell.y);
        if !self.stood.contains(&self.cell) && self.stood.len() < CELLS {
            self.stood.insert(self.cell);
            self.has_news = [true; 2];
        }
        self.heading = pose.heading.name().to_owned();
    }

    pub(super) const fn at(&self) -> (f64, f64) {
        (self.at[0], self.at[1])
    }

    /// How far ahead of the robot the centre of this cell is in this direction. Negative if it is behind.
    pub(super) fn way_to(&self, cell: Cell, towards: Heading) -> f64 {
        along([f64::from(cell.x), f64::from(cell.y)], towards) - along(self.at, towards)
    }

    pub(super) fn advance(&mut self, towards: Heading, cells: f64) {
        let (dx, dy) = towards.vector();
        self.at = [f64::from(dx).mul_add(cells, self.at[0]), f64::from(dy).mul_add(cells, self.at[1])];
        if let Some(since) = &mut self.since[axis(towards)] {
            since.ahead += cells * sign(towards);
            since.driven += cells.abs();
        }
    }

    /// Notes that the robot has met this thing while it drove in this direction. This corrects the reckoning, or makes
    /// the thing's place known. Returns the ratio of the counted way to the real way if it was long enough.
    pub(super) fn meet(&mut self, name: Option<&str>, towards: Heading) -> Result<Option<f64>, Drift> {
        let Some(name) = name.filter(|name| !self.unfixed.contains(*name)) else { return Ok(None) };
        let key = key(name, towards);
        if towards == self.pose().heading && self.contacts.len() < FACES {
            self.contacts.insert(self.contact_key(), key.clone());
        }
        let here = along(self.at, towards);
        let Some(face) = self.faces.get(&key).copied() else {
            if self.faces.len() < FACES {
                self.faces.insert(key, here);
            }
            self.has_news = [true; 2];
            return Ok(None);
        };
        let drift = here - face;
        let ratio = self.since[axis(towards)].and_then(|since| since.ratio(face * sign(towards)));
        let is_harmless = !self.has_news[axis(towards)];
        self.stand_at(face, towards);
        if drift.abs() > DRIFT { Err(Drift { cells: drift, is_harmless }) } else { Ok(ratio) }
    }

    /// Forgets the robot's own findings: they may be wrong, or no longer true.
    pub(super) fn doubt(&mut self) {
        self.faces.retain(|face, _| self.placed.contains(face));
        self.contacts.clear();
    }

    /// Notes the start of a search, from which on every cell is new again.
    pub(super) fn begin_search(&mut self) {
        self.stood = BTreeSet::from([self.cell]);
    }

    #[expect(clippy::cast_possible_truncation, reason = "it is bounded, and a room has some hundred cells a side")]
    pub(super) fn cell(&self) -> Cell {
        Cell::new(self.at[0].round() as i32, self.at[1].round() as i32)
    }

    pub(super) fn has_stood_in(&self, cell: Cell) -> bool {
        self.stood.contains(&(cell.x, cell.y))
    }

    /// Distance to the thing that the robot met before from this cell and in this heading. If there is none, distance
    /// to a wall that is known from elsewhere and may extend to here. The flag says whether the contact is certain.
    pub(super) fn contact_ahead(&self) -> Option<(f64, bool)> {
        let heading = self.pose().heading;
        let way = |face: &f64| face - along(self.at, heading);
        if let Some(key) = self.contacts.get(&self.contact_key()) {
            // If nothing was met here although a wall might have been, none will be met again.
            return self.faces.get(key).map(|face| (way(face), true)).filter(|(way, _)| (0.0..1.5).contains(way));
        }
        let begins = format!("{} wall", heading.name());
        let walls = self.faces.range(begins.clone()..).take_while(|(key, _)| key.starts_with(&begins));
        walls.map(|(_, face)| (way(face), false)).find(|(way, _)| (0.0..1.0).contains(way))
    }

    /// Notes that no wall was met from this cell and in this heading, where one might have been.
    pub(super) fn nothing_ahead(&mut self) {
        if self.contacts.len() < FACES {
            self.contacts.insert(self.contact_key(), String::new());
        }
    }

    /// Cells driven to and fro along this axis since the robot last met a thing whose place is known; infinite before
    /// the first contact.
    pub(super) fn driven(&self, heading: Heading) -> f64 {
        self.since[axis(heading)].map_or(f64::INFINITY, |since| since.driven)
    }

    fn contact_key(&self) -> String {
        format!("{},{} {}", self.cell.0, self.cell.1, self.heading)
    }

    pub(super) fn correct(&mut self, name: Option<&str>, towards: Heading, by: f64) {
        let (dx, dy) = towards.vector();
        self.at = [f64::from(dx).mul_add(by, self.at[0]), f64::from(dy).mul_add(by, self.at[1])];
        if let Some(face) = name.and_then(|name| self.faces.get_mut(&key(name, towards))) {
            *face += by;
        }
    }

    pub(super) fn place(&mut self, name: &str, towards: Heading, at: f64) {
        if self.faces.len() < FACES {
            self.placed.insert(key(name, towards));
            self.faces.insert(key(name, towards), at);
        }
    }

    /// Limits the coordinate across the direction of travel to this range, in cells.
    pub(super) fn stand_across(&mut self, towards: Heading, from: f64, to: f64) {
        let across = 1 - axis(towards);
        self.at[across] = self.at[across].clamp(from, to);
    }

    pub(super) fn stand_in_column(&mut self, cell: Cell, towards: Heading) {
        let across = 1 - axis(towards);
        let centre = [f64::from(cell.x), f64::from(cell.y)][across];
        self.at[across] = self.at[across].clamp(centre - 0.5, centre + 0.5);
    }

    /// Notes that this thing says nothing about the position, because it moves or exists more than once.
    pub(super) fn pass_over(&mut self, name: &str) {
        self.unfixed.insert(name.to_owned());
    }

    /// Sets the exact position at home, to which the robot returns after the measurement of a step.
    pub(super) fn set_out_from_home(&mut self) {
        (self.at, self.since) = ([0.0; 2], [None; 2]);
    }

    pub(super) fn knows(&self, name: Option<&str>, towards: Heading) -> bool {
        name.is_some_and(|name| self.faces.contains_key(&key(name, towards)))
    }

    fn stand_at(&mut self, along: f64, towards: Heading) {
        let axis = axis(towards);
        self.at[axis] = along * sign(towards);
        self.since[axis] = Some(Since { at: self.at[axis], ahead: 0.0, driven: 0.0 });
        self.has_news[axis] = false;
    }
}

impl Since {
    /// The ratio of the counted way to the real way, if the robot drove straight from the last contact and far enough.
    fn ratio(self, to: f64) -> Option<f64> {
        let between = (to - self.at).abs();
        let is_straight = self.driven - self.ahead.abs() < STRAIGHT;
        (is_straight && between >= GAUGED).then(|| self.driven / between)
    }
}

fn key(name: &str, towards: Heading) -> String {
    format!("{} {name}", towards.name())
}

fn named(name: &str) -> Option<Heading> {
    Heading::ALL.into_iter().find(|heading| heading.name() == name)
}

fn axis(heading: Heading) -> usize {
    usize::from(heading.vector().0 == 0)
}

fn sign(heading: Heading) -> f64 {
    let (dx, dy) = heading.vector();
    f64::from(dx + dy)
}

fn along(at: [f64; 2], heading: Heading) -> f64 {
    at[axis(heading)] * sign(heading)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WALL: Option<&str> = Some("wallDown");

    #[test]
    fn a_thing_that_is_met_again_sets_the_reckoning_right() {
        let mut reckoning = Reckoning::at_home();
        reckoning.advance(Heading::South, 7.6);
        assert_eq!(reckoning.meet(WALL, Heading::South), Ok(None), "now it is known where it stands");
        reckoning.advance(Heading::North, 0.6);
        reckoning.advance(Heading::South, 0.8);
        assert_eq!(reckoning.meet(WALL, Heading::South), Ok(None));
        assert!((reckoning.way_to(Cell::new(0, 7), Heading::North) - 0.6).abs() < 1e-9);
    }

    #[test]
    fn too_much_drift_is_said_and_a_thing_has_two_sides() {
        let mut reckoning = Reckoning::at_home();
        reckoning.advance(Heading::South, 7.6);
        assert_eq!(reckoning.meet(WALL, Heading::South), Ok(None));
        reckoning.advance(Heading::South, 2.0);
        assert_eq!(reckoning.meet(WALL, Heading::North), Ok(None), "that is its other side");
        reckoning.advance(Heading::North, 1.0);
        assert!(matches!(reckoning.meet(WALL, Heading::South), Err(Drift { cells, .. }) if (cells - 1.0).abs() < 1e-9));
        assert!(reckoning.meet(WALL, Heading::South).is_ok(), "and then it is right");
    }

    #[test]
    fn a_long_way_between_two_things_tells_how_fast_it_is() {
        let mut reckoning = Reckoning::at_home();
        reckoning.advance(Heading::South, 7.6);
        assert_eq!(reckoning.meet(WALL, Heading::South), Ok(None));
        reckoning.advance(Heading::North, 8.0);
        assert_eq!(reckoning.meet(Some("wallUp"), Heading::North), Ok(None));
        reckoning.advance(Heading::North, 0.05);
        assert_eq!(reckoning.meet(Some("wallUp"), Heading::North), Ok(None), "nothing was driven yet");
        reckoning.advance(Heading::South, 8.3);
        let Ok(Some(ratio)) = reckoning.meet(WALL, Heading::South) else { panic!("that is far enough") };
        assert!((ratio - 8.3 / 8.0).abs() < 1e-9, "{ratio}");
        for (towards, cells) in [(Heading::North, 4.0), (Heading::South, 2.0), (Heading::North, 6.0)] {
            reckoning.advance(towards, cells);
        }
        assert_eq!(reckoning.meet(Some("wallUp"), Heading::North), Ok(None), "it went to and fro");
    }

    #[test]
    fn what_is_no_place_is_not_believed() {
        let mut reckoning = Reckoning::at_home();
        assert!(reckoning.is_sound());
        reckoning.at[0] = f64::NAN;
        assert!(!reckoning.is_sound());
        assert!(!Reckoning { heading: "up".into(), ..Reckoning::at_home() }.is_sound());
    }
}
