//! The outlook of an unknown cell: the cells round it, seen in the direction in which the robot would enter it.
//! `scored` weighs the outlook as numbers. A difference between left and right does not matter: an outlook is
//! mirrored so that the heavier side is on the right.
//!
//! ```text
//!      ahead   4 … 1, 0 = the target, the unknown cell, −1 = the visited cell from which it is entered, −2
//!      aside  −2, −1 left of that line, 0 on it, 1, 2 right
//! ```
//! A cell counts as unknown (0), as visited (1) or as blocked (2). If the hall is to be covered, a cell that was only
//! seen counts as unknown. If luggage is to be found, it counts as visited.

use super::entries::CellEntry;
use super::grid::{Grid, Spot, Square, onward};
use super::tables::{LINEAR, RUN, SMALL, STARTS, TABLES};
use super::view::{Gait, Objective, View};
use crate::command::Move;
use crate::units::{Cell, Heading};

const UNKNOWN: u8 = 0;
const VISITED: u8 = 1;
const BLOCKED: u8 = 2;

#[derive(Clone, Copy, Debug)]
pub struct Outlook {
    /// The values of the linear part, in the order of `LINEAR_NAMES`, in thousandths.
    pub linear: [i16; LINEAR],
    /// The row in each table. Rows are numbered over all tables together.
    pub rows: [u32; TABLES.len()],
}

/// The direction of an entry, compared with the robot's heading at its present place.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Turn {
    StraightOn,
    Aside,
    Back,
    Elsewhere,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Looking<'a> {
    grid: &'a Grid,
    spot: Spot,
    heading: Heading,
    cell: Cell,
    gait: Gait,
    /// The value of a cell that was only seen.
    seen: u8,
}

/// A place in the window: number of cells ahead of the target, and number of cells to the side.
type WindowPosition = (isize, isize);

struct Sight<'a> {
    looking: &'a Looking<'a>,
    entry: &'a CellEntry,
    forward: isize,
    right: isize,
    is_mirrored: bool,
    /// The cells round the target, with the indexes `[ahead + 2][aside + 2]`.
    window: [[u8; 5]; 7],
    turn: Turn,
    /// Number of unknown cells in a row behind the target, up to `RUN`.
    run: usize,
    /// Number of unknown cells that are connected with the target. The count stops at `SMALL` + 1.
    component: usize,
}

impl<'a> Looking<'a> {
    pub(crate) fn of(view: &View<'a>) -> Looking<'a> {
        let View { grid, pose, gait, terms, .. } = *view;
        let seen = match terms.objective {
            Objective::Cover => UNKNOWN,
            Objective::Find => VISITED,
        };
        Looking { grid, spot: grid.spot(pose.cell), heading: pose.heading, cell: pose.cell, gait, seen }
    }

    const fn kind(&self, square: Square) -> u8 {
        match square {
            Square::Unknown => UNKNOWN,
            Square::Seen => self.seen,
            Square::Visited => VISITED,
            Square::Obstacle | Square::Luggage | Square::Target | Square::KeptOut => BLOCKED,
        }
    }

    /// Returns the number of unknown cells that are connected with this target. The count stops at `SMALL` + 1.
    fn component(&self, target: Spot) -> usize {
        let mut cells = [target; SMALL + 1];
        let (mut count, mut done) = (1, 0);
        while done < count && count < cells.len() {
            for heading in Heading::ALL {
                let next = onward(cells[done], self.grid.step(heading));
                let is_unknown = self.kind(self.grid.here(next)) == UNKNOWN;
                if count < cells.len() && is_unknown && !cells[..count].contains(&next) {
                    cells[count] = next;
                    count += 1;
                }
            }
            done += 1;
        }
        count
    }

    pub(crate) fn at(&self, entry: &CellEntry) -> Outlook {
        let sight = Sight::of(self, entry);
        Outlook { linear: sight.linear(), rows: sight.rows() }
    }

    fn turn(&self, entry: &CellEntry) -> Turn {
        if entry.at.spot != self.spot {
            Turn::Elsewhere
        } else if entry.at.heading == self.heading {
            Turn::StraightOn
        } else if entry.at.heading == self.heading.opposite() {
            Turn::Back
        } else {
            Turn::Aside
        }
    }
}

impl<'a> Sight<'a> {
    fn of(looking: &'a Looking<'a>, entry: &'a CellEntry) -> Sight<'a> {
        let grid = looking.grid;
        let (forward, right) = (grid.step(entry.at.heading), grid.step(entry.at.heading.right()));
        let look = |(ahead, aside): WindowPosition, right: isize| {
            looking.kind(grid.here(onward(entry.target, ahead * forward + aside * right)))
        };
        let weight = |right: isize| {
            let side: [WindowPosition; 7] = [(0, 1), (1, 1), (-1, 1), (0, 2), (1, 2), (2, 1), (-1, 2)];
            side.into_iter().fold(0, |sum, place| sum * 3 + u32::from(look(place, right)))
        };
        let is_mirrored = weight(-right) > weight(right);
        let right = if is_mirrored { -right } else { right };
        let mut window = [[0; 5]; 7];
        for (row, ahead) in window.iter_mut().zip(-2..) {
            for (square, aside) in row.iter_mut().zip(-2..) {
                *square = look((ahead, aside), right);
            }
        }
        let run = (1..=RUN).take_while(|n| look((n.cast_signed(), 0), right) == UNKNOWN).count();
        let (turn, component) = (looking.turn(entry), looking.component(entry.target));
        Sight { looking, entry, forward, right, is_mirrored, window, turn, run, component }
    }

    fn at(&self, (ahead, aside): WindowPosition) -> u8 {
        self.window[(ahead + 2).cast_unsigned()][(aside + 2).cast_unsigned()]
    }

    fn is_unknown(&self, place: WindowPosition) -> bool {
        self.at(place) == UNKNOWN
    }

    fn is_blocked(&self, place: WindowPosition) -> bool {
        self.at(place) == BLOCKED
    }

    fn beyond(&self, (ahead, aside): WindowPosition) -> u8 {
        self.looking.kind(self.looking.grid.here(onward(self.entry.target, ahead * self.forward + aside * self.right)))
    }

    fn linear(&self) -> [i16; LINEAR] {
        let pair = |(ahead, aside): WindowPosition| {
            i16::from(self.is_unknown((ahead, aside))) + i16::from(self.is_unknown((ahead, -aside)))
        };
        let blocked = |(ahead, aside): WindowPosition| {
            i16::from(self.is_blocked((ahead, aside))) + i16::from(self.is_blocked((ahead, -aside)))
        };
        let diagonal = |aside: isize, is_known: bool| {
            i16::from(self.is_unknown((0, aside)) == is_known && self.is_unknown((1, aside)) != is_known)
        };
        let grid = self.looking.grid;
        let seen =
            (0..RUN.cast_signed()).take_while(|n| grid.here(onward(self.entry.target, n * self.forward)) == Square::Seen).count();
        let (sides, behind, straight_on) = (pair((0, 1)), self.is_unknown((1, 0)), self.turn == Turn::StraightOn);
        let side = if self.entry.at.heading == self.looking.heading.right() { 1 } else { -1 };
        let is_same_turn = self.turn == Turn::Aside && side == self.looking.gait.turn;
        let count = |n: usize| i16::try_from(n).unwrap_or(0) * 1000;
        let whole = |n: i16| n * 1000;
        let is = |so: bool| whole(i16::from(so));
        [
            is(behind),
            is(sides == 1),
            is(sides == 2),
            is(straight_on && sides == 0 && !behind),
            count(self.run),
            self.gain(|x, y| x + y),
            self.gain(i32::max),
            if self.component <= SMALL { i16::try_from((SMALL + 1 - self.component) * 100).unwrap_or(0) } else { 0 },
            whole(pair((1, 1))),
            whole(pair((-1, 1))),
            whole(pair((0, 2))),
            whole(pair((2, 1))),
            whole(pair((1, 2))),
            whole(pair((-1, 2))),
            is(self.is_unknown((2, 0))),
            is(self.is_unknown((3, 0))),
            is(self.is_blocked((1, 0))),
            whole(blocked((0, 1))),
            whole(blocked((1, 1))),
            whole(blocked((-1, 1))),
            is(straight_on),
            is(self.turn == Turn::Back),
            is(is_same_turn),
            whole(diagonal(1, true) + diagonal(-1, true)),
            whole(diagonal(1, false) + diagonal(-1, false)),
            is(matches!(self.entry.at.heading, Heading::North | Heading::South)),
            is(!self.is_unknown((0, if self.is_mirrored { -1 } else { 1 }))),
            count(seen),
        ]
    }

    /// Returns how much further from home the target is than the robot, in hundredths of a cell.
    fn gain(&self, distance: fn(i32, i32) -> i32) -> i16 {
        let from_home = |cell: Cell| distance(cell.x.abs(), cell.y.abs());
        let cells = from_home(self.looking.grid.cell(self.entry.target)) - from_home(self.looking.cell);
        i16::try_from(cells * 100).unwrap_or(if cells > 0 { i16::MAX } else { i16::MIN })
    }

    fn rows(&self) -> [u32; TABLES.len()] {
        const ROUND: [WindowPosition; 7] = [(0, -1), (0, 1), (1, 0), (1, -1), (1, 1), (-1, -1), (-1, 1)];
        const NEAR: [WindowPosition; 12] =
            [(0, -1), (0, 1), (1, 0), (1, -1), (1, 1), (-1, -1), (-1, 1), (2, 0), (0, -2), (0, 2), (2, -1), (2, 1)];
        const WIDE: [WindowPosition; 12] =
            [(1, -2), (1, 2), (2, -2), (2, 2), (3, -1), (3, 1), (3, 0), (-1, -2), (-1, 2), (0, -1), (0, 1), (1, 0)];
        const BEHIND: [WindowPosition; 5] = [(-1, -1), (-1, 1), (-2, 0), (-2, -1), (-2, 1)];
        const AHEAD: [WindowPosition; 9] = [(1, -1), (1, 0), (1, 1), (2, -1), (2, 0), (2, 1), (3, -1), (3, 0), (3, 1)];
        const FAR: [WindowPosition; 8] = [(4, 0), (3, 0), (2, -2), (2, 2), (1, -2), (1, 2), (0, -2), (0, 2)];
        let way = self.entry.at.cost as usize;
        let way_class = match way {
            0..=1 => 0,
            2..=4 => 1,
            _ => 2,
        };
        let (round, entering) = (self.ternary(&ROUND), self.entering());
        let four = self.ternary(&[(0, -1), (0, 1), (1, 0), (1, 1)]);
        let blocked = self.window.iter().flatten().filter(|square| **square == BLOCKED).count();
        let width = (self.width(1) + self.width(-1)).min(3);
        let run = usize::from(self.looking.gait.run.min(8));
        let column = |aside: isize| -> usize {
            let place = |n: usize| (n.cast_signed() % 5 - 2, if n < 5 { aside } else { 2 * aside });
            (0..10).fold(0, |sum, n| sum * 2 + usize::from(self.is_unknown(place(n))))
        };
        let rows = [
            round,
            self.binary(&NEAR),
            self.ternary(&BEHIND) * 4 + entering,
            column(-1),
            column(1),
            self.ternary(&AHEAD),
            ((self.run * 4 + width) * (RUN + 1) + self.edge(1)) * (RUN + 1) + self.edge(-1),
            (entering * 12 + way.min(11)) * 9 + run,
            (self.component - 1).min(SMALL) * 16 + self.binary(&[(0, -1), (0, 1), (1, 0), (2, 0)]),
            blocked.min(7) * 81 + four,
            self.wall() * 81 + four,
            (round * 4 + entering) * 3 + way_class,
            self.binary(&WIDE) * 4 + entering,
            self.ternary(&FAR),
        ];
        let mut counted = [0; TABLES.len()];
        for ((row, start), to) in rows.into_iter().zip(STARTS).zip(&mut counted) {
            *to = u32::try_from(start + row).unwrap_or(0);
        }
        counted
    }

    fn ternary(&self, places: &[WindowPosition]) -> usize {
        places.iter().fold(0, |sum, place| sum * 3 + usize::from(self.at(*place)))
    }

    fn binary(&self, places: &[WindowPosition]) -> usize {
        places.iter().fold(0, |sum, place| sum * 2 + usize::from(self.is_unknown(*place)))
    }

    /// Returns the turn by which the target is entered after mirroring: 0 none, 1 right, 2 left, 3 back. If the robot
    /// must first drive to another place, this is the last move of the way to that place, if that move is a turn.
    fn entering(&self) -> usize {
        let side = |is_right: bool| usize::from(is_right == self.is_mirrored) + 1;
        match (self.turn, self.entry.at.by) {
            (Turn::Back, _) => 3,
            (Turn::Aside, _) => side(self.entry.at.heading == self.looking.heading.right()),
            (Turn::Elsewhere, Some(Move::TurnRight)) => side(true),
            (Turn::Elsewhere, Some(Move::TurnLeft)) => side(false),
            (Turn::StraightOn | Turn::Elsewhere, _) => 0,
        }
    }

    /// Returns the number of unknown cells beside the target on one side, up to 3.
    fn width(&self, side: isize) -> usize {
        (1..=3).take_while(|away| self.beyond((0, away * side)) == 0).count()
    }

    /// Returns how many cells straight ahead, counted from the target, have no unknown cell beside them on this side.
    /// The count stops at the first unknown cell, or at `RUN`.
    fn edge(&self, side: isize) -> usize {
        (0..RUN.cast_signed()).take_while(|ahead| self.beyond((*ahead, side)) != 0).count()
    }

    /// Returns the place of a wall beside the target. A wall is two blocked cells in a row. 1 to 3 is the distance to
    /// the right, 4 to 6 is 3 plus the distance to the left, and 0 means that there is no wall near.
    fn wall(&self) -> usize {
        let is_wall = |aside: isize| self.beyond((0, aside)) == 2 && self.beyond((1, aside)) == 2;
        (1..=3usize)
            .find_map(|away| {
                let aside = away.cast_signed();
                is_wall(aside).then_some(away).or_else(|| is_wall(-aside).then_some(away + 3))
            })
            .unwrap_or(0)
    }
}
