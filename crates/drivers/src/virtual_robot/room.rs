//! The room as the page's scene file describes it: where all things stand, and therefore in which cells the robot can
//! stand. With a known room, a drift is noticed before anything wrong is reported.
//!
//! Lengths are in cells from the centre of the robot's start, with columns to the east and rows to the south.
//! Coordinates are those of the robot's centre. The robot counts as a point, and all things are enlarged by half the
//! robot on each side.

use super::reckoning::DRIFT;
use super::{Aim, VirtualRobot};
use hallsweep_core::units::{Cell, Heading};

/// Greatest distance from a cell's centre, in cells, at which the robot still counts as having reached the cell. A
/// thing that stops the robot there is not in that cell.
pub(super) const REACHED: f64 = 0.15;

/// Distance before a thing, in cells, at which the robot's centre must have room. Otherwise, the robot cannot meet
/// the thing.
const BEFORE: f64 = 0.2;

/// Greatest sideways distance, in cells, at which the robot can meet a thing. It is above 0 because the robot's
/// position is not exact.
const BESIDE: f64 = 0.2;

/// How many cells to go to each side, at most, when looking for a cell where the robot can stand.
const ASIDE: i32 = 3;

/// How many cells to go back, at most, when looking for a cell where the robot can stand.
const FURTHEST_BACK: u8 = 8;

/// The page's name for the border of the floor.
pub(super) const BORDER: &str = "floor-border";

#[derive(Clone, Debug, PartialEq)]
pub struct Room {
    /// The area in which the robot's centre can be.
    pub floor: Extent,
    pub things: Vec<Thing>,
    /// The names of things that move. They do not show the robot's place.
    pub moving: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Thing {
    pub name: String,
    /// The area in which the robot's centre would touch the thing.
    pub extent: Extent,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    pub x: (f64, f64),
    pub y: (f64, f64),
}

impl Extent {
    /// Distance from a point inside the area to the nearest side. Negative if the point is outside.
    fn depth(&self, (x, y): (f64, f64)) -> f64 {
        (x - self.x.0).min(self.x.1 - x).min(y - self.y.0).min(self.y.1 - y)
    }

    const fn across(&self, towards: Heading) -> (f64, f64) {
        match towards {
            Heading::North | Heading::South => self.x,
            Heading::East | Heading::West => self.y,
        }
    }

    /// At this coordinate along the direction of travel, the robot's centre touches the thing.
    fn face(&self, towards: Heading) -> f64 {
        match towards {
            Heading::North => -self.y.1,
            Heading::East => self.x.0,
            Heading::South => self.y.0,
            Heading::West => -self.x.1,
        }
    }
}

impl Room {
    /// Whether the name alone shows where the thing is. It must not move, and no other thing may have the same name.
    fn is_one(&self, name: &str) -> bool {
        self.things.iter().filter(|thing| thing.name == name).count() == 1 && !self.moves(name)
    }

    fn stands(&self, name: &str) -> bool {
        (name == BORDER || self.things.iter().any(|thing| thing.name == name)) && !self.moves(name)
    }

    fn moves(&self, name: &str) -> bool {
        self.moving.iter().any(|moving| moving == name)
    }

    fn is_free(&self, cell: Cell) -> bool {
        self.is_open((f64::from(cell.x), f64::from(cell.y)))
    }

    fn is_open(&self, at: (f64, f64)) -> bool {
        self.floor.depth(at) >= -REACHED && self.things.iter().all(|thing| thing.extent.depth(at) <= REACHED)
    }

    /// Whether a robot at `at` may have met this thing on its way into `cell`, although the cell counts as free. The
    /// thing may be up to `REACHED` to the side of the robot's path.
    fn is_grazed(&self, name: &str, cell: Cell, at: (f64, f64), towards: Heading) -> bool {
        let (dx, dy) = (f64::from(towards.vector().0), f64::from(towards.vector().1));
        let (along, across) = (dx.mul_add(at.0, dy * at.1), if dx == 0.0 { f64::from(cell.x) } else { f64::from(cell.y) });
        let reaches = |extent: &Extent| {
            let (from, to) = extent.across(towards);
            (from - REACHED..=to + REACHED).contains(&across) && (extent.face(towards) - along).abs() <= DRIFT
        };
        self.things.iter().any(|thing| thing.name == name && reaches(&thing.extent))
    }

    /// Returns the thing that the robot hit at the position `at` while it drove in the direction `towards`, for servers
    /// that do not send the name of the thing. Returns `None` if the room has moving things: it may have hit one of them.
    fn met(&self, at: (f64, f64), towards: Heading) -> Option<&str> {
        if !self.moving.is_empty() {
            return None;
        }
        let (dx, dy) = (f64::from(towards.vector().0), f64::from(towards.vector().1));
        let along = dx.mul_add(at.0, dy * at.1);
        // Distance to a thing that can be met. `None` if the robot could not come that far because something stands
        // before it.
        let far = |face: f64| {
            let ahead = face - along;
            let before = ahead - BEFORE;
            let is_met = self.is_open((dx.mul_add(before, at.0), dy.mul_add(before, at.1)));
            is_met.then_some(ahead.abs())
        };
        let across = if dx == 0.0 { at.0 } else { at.1 };
        let beside = |extent: &Extent| {
            let (from, to) = extent.across(towards);
            (from - across).max(across - to).max(0.0)
        };
        let things = self.things.iter().map(|thing| (thing.name.as_str(), thing.extent.face(towards), beside(&thing.extent)));
        let all = things.chain([(BORDER, -self.floor.face(towards.opposite()), 0.0)]);
        let near =
            all.filter(|(.., beside)| *beside <= BESIDE).filter_map(|(name, face, beside)| Some((name, far(face)? + beside)));
        near.min_by(|one, other| one.1.total_cmp(&other.1)).map(|met| met.0)
    }

    /// Distance from the start to the first thing to the south, in cells. The robot faces south at the start.
    pub(super) fn ahead(&self) -> f64 {
        let is_ahead = |extent: &Extent| extent.x.0 <= 0.0 && extent.x.1 >= 0.0 && extent.y.0 > 0.0;
        let faces = self.things.iter().map(|thing| &thing.extent).filter(|extent| is_ahead(extent)).map(|extent| extent.y.0);
        faces.fold(self.floor.y.1, f64::min)
    }
}

impl VirtualRobot {
    #[must_use]
    pub fn in_room(mut self, room: Room) -> VirtualRobot {
        for Thing { name, extent } in &room.things {
            if room.is_one(name) {
                for towards in Heading::ALL {
                    self.reckoning.place(name, towards, extent.face(towards));
                }
            } else {
                self.reckoning.pass_over(name);
            }
        }
        for name in &room.moving {
            self.reckoning.pass_over(name);
        }
        for (towards, at) in [
            (Heading::North, -room.floor.y.0),
            (Heading::East, room.floor.x.1),
            (Heading::South, room.floor.y.1),
            (Heading::West, -room.floor.x.0),
        ] {
            self.reckoning.place(BORDER, towards, at);
        }
        self.gauge_by(room.ahead());
        self.room = Some(room);
        self
    }

    pub(super) fn is_met_as_it_should_be(&self) -> bool {
        let Some((room, met)) = self.room.as_ref().zip(self.met.as_deref()) else { return true };
        let is_there = |thing: &Thing| thing.name == met && thing.extent.y.0 <= room.ahead() + REACHED && thing.extent.y.1 > 0.0;
        met == BORDER || room.things.iter().any(is_there)
    }

    /// The thing that the robot has met after driving `way` cells, for servers that do not name things.
    pub(super) fn met_by_room(&self, towards: Heading, way: f64) -> Option<String> {
        let (room, (x, y), (dx, dy)) = (self.room.as_ref()?, self.reckoning.at(), towards.vector());
        let at = match towards {
            // While the step is measured, the counted distance is not usable. A robot that drives south meets the
            // thing ahead of its start. A robot that drives north meets the thing behind it.
            Heading::North if self.is_gauging() => (0.0, 0.0),
            Heading::South if self.is_gauging() => (0.0, room.ahead()),
            Heading::North | Heading::East | Heading::South | Heading::West => {
                (f64::from(dx).mul_add(way, x), f64::from(dy).mul_add(way, y))
            }
        };
        room.met(at, towards).map(str::to_owned)
    }

    pub(super) fn is_barred(&self, cell: Cell) -> bool {
        self.room.as_ref().is_some_and(|room| !room.is_free(cell))
    }

    /// Whether the scene file shows that the met thing cannot block this cell. Things that move, and things that are
    /// not in the file, may be anywhere.
    pub(super) fn is_contradicted(&self, cell: Cell, towards: Heading) -> bool {
        let Some((room, met)) = self.room.as_ref().zip(self.met.as_deref()) else { return false };
        room.stands(met) && room.is_free(cell) && !room.is_grazed(met, cell, self.reckoning.at(), towards)
    }

    /// Lets the robot drive on for at most a few cells, until it meets something. By the counted distance, it has
    /// entered a cell where it cannot stand, but it has met nothing.
    pub(super) fn go_on_until_met(&mut self, towards: Heading, backward: bool) {
        self.off_centre = true;
        self.aim(Aim::Touch { is_certain: true, further: 0 });
        self.drive(towards, 1.0, backward);
    }

    /// Sets the position to the last free cell before the thing that the robot should have met. It has driven on for
    /// a long way without a contact.
    pub(super) fn stands_before_it(&mut self) {
        let (back, mut cell) = (self.moves_towards().opposite(), self.reckoning.cell());
        let mut left = FURTHEST_BACK;
        while left > 0 && self.is_barred(cell) {
            (cell, left) = (cell.ahead(back), left - 1);
        }
        self.reckoning.advance(back, self.reckoning.way_to(cell, back).max(0.0));
        self.stand_elsewhere(cell);
    }

    /// Whether the next cell is blocked in the scene file, but not by the thing that the robot has met.
    pub(super) fn has_passed_what_bars(&self, towards: Heading) -> bool {
        let next = self.reckoning.pose().cell.ahead(towards);
        let Some(room) = self.room.as_ref().filter(|room| !room.is_free(next)) else { return false };
        let centre = (f64::from(next.x), f64::from(next.y));
        let is_met = |thing: &&Thing| Some(thing.name.as_str()) == self.met.as_deref() && thing.extent.depth(centre) > REACHED;
        room.floor.depth(centre) >= -REACHED && room.things.iter().find(is_met).is_none()
    }

    /// The neighbouring column, to the right or left, in which the robot must be now. Returns its cell there. `None`
    /// if neither column is free along the whole way.
    pub(super) fn column_beside(&mut self, towards: Heading) -> Option<Cell> {
        let room = self.room.as_ref()?;
        let (back, right) = (towards.opposite(), towards.right().vector());
        let (from, here) = (self.reckoning.pose().cell, self.reckoning.cell());
        let here = if room.is_free(here) { here } else { here.ahead(back) };
        let steps = (here.x - from.x).abs() + (here.y - from.y).abs();
        let beside = |by: i32| Cell::new(here.x + right.0 * by, here.y + right.1 * by);
        let is_free = |cell: &Cell| {
            std::iter::successors(Some(*cell), |cell| Some(cell.ahead(back)))
                .take(steps.unsigned_abs() as usize + 1)
                .all(|cell| room.is_free(cell))
        };
        let cell = [1, -1].map(beside).into_iter().find(is_free)?;
        self.reckoning.stand_in_column(cell, towards);
        Some(cell)
    }

    /// The cell where the robot really stands after it met this thing. It is the assumed cell or a free cell near it,
    /// back or to the side. `None` if there is no such cell.
    pub(super) fn truly_in(&mut self, name: Option<&str>, towards: Heading) -> Option<Cell> {
        let room = self.room.as_ref()?;
        let met = room.things.iter().find(|thing| Some(thing.name.as_str()) == name && room.is_one(&thing.name));
        if let Some(Thing { extent, .. }) = met {
            let (from, to) = extent.across(towards);
            self.reckoning.stand_across(towards, from, to);
        }
        let (cell, back, aside) = (self.reckoning.cell(), towards.opposite(), towards.right().vector());
        // The thing may begin before the centre of the cell. The robot has then not reached that centre.
        let is_before = self.reckoning.way_to(cell, towards) > REACHED;
        let cell = if is_before { cell.ahead(back) } else { cell };
        let before = [cell, cell.ahead(back)];
        let beside = |by: i32| before.map(|cell| Cell::new(cell.x + aside.0 * by, cell.y + aside.1 * by));
        let near = (0..=ASIDE).flat_map(|by| [by, -by]).flat_map(beside).find(|cell| room.is_free(*cell))?;
        self.reckoning.stand_in_column(near, towards);
        Some(near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A room of four by three cells. A case stands in cell (2, 1). There are also two carts, and a cat that walks.
    fn room() -> Room {
        let thing = |name: &str, x, y| Thing { name: name.to_owned(), extent: Extent { x, y } };
        let things = vec![
            thing("case", (1.4, 2.6), (0.4, 1.6)),
            thing("cart", (-0.8, -0.6), (-0.9, 2.8)),
            thing("cart", (-0.8, 3.9), (2.3, 2.8)),
        ];
        Room { floor: Extent { x: (-0.8, 3.9), y: (-0.9, 2.8) }, things, moving: vec!["cat".to_owned()] }
    }

    #[test]
    fn a_cell_is_free_where_the_centre_of_the_robot_can_be() {
        let room = room();
        for (x, y, is_free) in
            [(0, 0, true), (2, 0, true), (2, 1, false), (1, 2, true), (-1, 0, false), (0, 3, false), (4, 1, true)]
        {
            assert_eq!(room.is_free(Cell::new(x, y)), is_free, "({x}, {y})");
        }
    }

    #[test]
    fn what_stands_ahead_of_the_start_is_the_first_thing_to_the_south_or_the_border() {
        let mut room = room();
        assert!((room.ahead() - 2.3).abs() < 1e-9);
        room.things.clear();
        assert!((room.ahead() - 2.8).abs() < 1e-9);
    }

    #[test]
    fn what_is_met_without_a_name_is_what_can_be_met_there_unless_things_move() {
        let mut room = room();
        assert_eq!(room.met((1.0, 1.0), Heading::East), None, "it may have been the cat");
        room.moving.clear();
        for (at, towards, name) in [
            ((1.0, 1.0), Heading::East, "case"),
            ((1.0, 0.0), Heading::East, BORDER),
            ((3.0, 1.0), Heading::West, "case"),
            ((2.0, -0.3), Heading::South, "case"),
            ((1.0, 0.0), Heading::South, "cart"),
            ((0.0, 0.0), Heading::North, BORDER),
        ] {
            assert_eq!(room.met(at, towards), Some(name), "{at:?} {towards:?}");
        }
    }

    #[test]
    fn the_name_of_what_moves_or_stands_twice_says_nothing_of_where_it_is() {
        let robot = VirtualRobot::new(crate::Dialect::Semicolons, std::time::Duration::from_millis(330)).in_room(room());
        let knows = |name, towards| robot.reckoning.knows(Some(name), towards);
        assert!(Heading::ALL.into_iter().all(|towards| knows("case", towards) && knows(BORDER, towards)));
        assert!(!Heading::ALL.into_iter().any(|towards| knows("cart", towards) || knows("cat", towards)));
    }
}
