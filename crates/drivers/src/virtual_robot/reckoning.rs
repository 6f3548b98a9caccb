//! The assumed position of the virtual robot, which does not report its real position. The driver computes it from
//! the time of each motion. Things that the robot meets correct it, since they have names and do not move.
//!
//! ```text
//!    cell 6      cell 7      cell 8           A face is where the robot's centre is when the robot touches a thing
//!  ┌───────────┬───────────┬─────▓▓▓▓▓▓       from one side. The first contact makes the place of the face known.
//!  │     ·     │     ·  ───┼──►  ▓ wallDown   Later contacts show how far the assumed position has drifted.
//! ```
//! Lengths are in cells. A coordinate along a direction grows in that direction.

use std::collections::{BTreeMap, BTreeSet};

use serde::{Deserialize, Serialize};

use hallsweep_core::units::{Cell, Heading, Pose};

/// Greatest error of the assumed position, in cells. With a greater error, things would be reported in wrong cells.
pub(super) const DRIFT: f64 = 0.45;

/// Maximum number of faces that are stored. A scene has some dozens.
const FACES: usize = 4096;

/// Maximum number of cells that are stored as cells where the robot has stood. Even a large page has only a hundred
/// cells on a side.
const CELLS: usize = 16_384;

/// Largest coordinate in a room, in cells.
const FURTHEST: i32 = 100_000;

/// Shortest distance from which the robot's speed is computed, in cells. One frame of its page is a twentieth of a
/// cell.
const GAUGED: f64 = 2.0;

/// The robot counts as having driven straight if its total distance exceeds the net distance by less than this, in
/// cells.
const STRAIGHT: f64 = 0.1;

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Reckoning {
    /// The robot's cell after its last completed order. `heading` is its heading then.
    cell: (i32, i32),
    heading: String,
    /// Position of the robot's centre, in columns to the east and rows to the south of home.
    at: [f64; 2],
    faces: BTreeMap<String, f64>,
    /// For each cell and heading, the name of the face that the robot has met there.
    contacts: BTreeMap<String, String>,
    stood: BTreeSet<(i32, i32)>,
    /// The names of things that do not show the robot's place, because they move or exist more than once.
    #[serde(skip)]
    unfixed: BTreeSet<String>,
    /// The faces whose places are from the scene file.
    #[serde(skip)]
    placed: BTreeSet<String>,
    /// For each axis, whether the robot has entered a new cell or met a new face since it last met a known face. If
    /// the position was already wrong at that time, this was reported for a wrong cell.
    has_news: [bool; 2],
    /// For each axis, the distances driven since the robot last met a thing with a known place.
    since: [Option<Since>; 2],
}

/// Where the robot last met a thing with a known place, and the distances since then, in cells. `ahead` is the net
/// distance and `driven` the total distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Since {
    at: f64,
    ahead: f64,
    driven: f64,
}

/// An error of the assumed position by more than `DRIFT`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drift {
    /// Error in cells.
    pub(super) cells: f64,
    /// Whether the robot has entered no new cell and met no new face since it last met a known face. If so, no report
    /// was wrong.
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

    /// Sets the robot back to home in the same room. Position and drift begin anew, but everything known about the
    /// room is kept.
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

    /// How far ahead the centre of this cell is in this direction, in cells. Negative if it is behind.
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

    /// Records that the robot met this thing while it drove in this direction. If the thing's place was already
    /// known, the position is corrected. Otherwise the thing's place becomes known. Returns counted distance ÷ real
    /// distance, if the way was long enough.
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

    /// Forgets the places that the robot itself has found. They may be wrong, or no longer true.
    pub(super) fn doubt(&mut self) {
        self.faces.retain(|face, _| self.placed.contains(face));
        self.contacts.clear();
    }

    /// Marks all cells except the current one as new, because a search begins.
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

    /// Distance to the thing that the robot met before from this cell with this heading. If it met nothing from here
    /// before, the distance to a known wall that may extend to this place. The flag says whether a contact is
    /// certain.
    pub(super) fn contact_ahead(&self) -> Option<(f64, bool)> {
        let heading = self.pose().heading;
        let way = |face: &f64| face - along(self.at, heading);
        if let Some(key) = self.contacts.get(&self.contact_key()) {
            // An entry without a known face means that no wall was met here, so no wall is expected again.
            return self.faces.get(key).map(|face| (way(face), true)).filter(|(way, _)| (0.0..1.5).contains(way));
        }
        let begins = format!("{} wall", heading.name());
        let walls = self.faces.range(begins.clone()..).take_while(|(key, _)| key.starts_with(&begins));
        walls.map(|(_, face)| (way(face), false)).find(|(way, _)| (0.0..1.0).contains(way))
    }

    /// Records that no wall was met from this cell with this heading, although there could have been one.
    pub(super) fn nothing_ahead(&mut self) {
        if self.contacts.len() < FACES {
            self.contacts.insert(self.contact_key(), String::new());
        }
    }

    /// Total distance driven along this axis since the robot last met a thing with a known place, in cells. Infinite
    /// before the first contact.
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

    /// Limits the sideways coordinate to this range, in cells. Sideways is across the direction of travel.
    pub(super) fn stand_across(&mut self, towards: Heading, from: f64, to: f64) {
        let across = 1 - axis(towards);
        self.at[across] = self.at[across].clamp(from, to);
    }

    pub(super) fn stand_in_column(&mut self, cell: Cell, towards: Heading) {
        let across = 1 - axis(towards);
        let centre = [f64::from(cell.x), f64::from(cell.y)][across];
        self.at[across] = self.at[across].clamp(centre - 0.5, centre + 0.5);
    }

    /// Records that this thing does not show the position, because it moves or exists more than once.
    pub(super) fn pass_over(&mut self, name: &str) {
        self.unfixed.insert(name.to_owned());
    }

    /// Sets the position exactly to home. The robot is back there after its step was measured.
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
    /// Counted distance ÷ real distance, if the robot drove straight from the last contact and far enough.
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
