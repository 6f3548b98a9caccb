//! Obstacles that the robot has bumped into or seen by sonar, and their marks on the map.

use super::Engine;
use crate::event::{Ahead, Obstacle};
use crate::mission::{Input, InputContext};
use crate::state::Phase;
use crate::state::fact::Fact;
use crate::units::{Cell, Heading, Piece, Pose};
use crate::world::hall_map::{Mark, REACH};
use crate::world::luggage::Luggage;

impl Engine {
    /// Marks what the sonar of the searching robot sees: free cells, and the obstacle behind them. The robot then
    /// need not bump into that obstacle.
    pub(super) fn look_ahead(&mut self) {
        let seen = self.robots.searching_mut().ahead.take();
        let Some(Ahead { free, obstacle }) = seen.filter(|_| self.settings.sonar_cells > 0) else { return };
        let most = u16::from(self.settings.sonar_cells);
        let (is_cut, free) = (free >= most, free.min(most));
        let Pose { mut cell, heading } = self.state.pose;
        for _ in 0..free {
            cell = cell.ahead(heading);
            if self.state.map.at(cell) == Mark::Unknown {
                self.mark(cell, Mark::Seen);
                self.mission.has_news = true;
            }
        }
        let cell = cell.ahead(heading);
        // What a sonar reports beyond its reach is not believed against a cell that was free.
        let is_noted = self.state.again.contains(&cell) && self.state.phase == Phase::Exploring && !is_cut;
        let known = self.state.map.at(cell);
        let is_found_late = |obstacle: Obstacle| known == Mark::Wall && piece_of(obstacle).is_some();
        let is_wanted = |obstacle: &Obstacle| known.is_unvisited() || is_noted || is_found_late(*obstacle);
        let Some(obstacle) = obstacle.filter(is_wanted) else { return };
        self.mission.has_news |= known == Mark::Unknown;
        let obstacle = if self.settings.inspect_everything { Obstacle::Unknown } else { obstacle };
        self.mission.route.clear();
        self.meet(cell, heading, obstacle);
        self.feed(Input::Blocked, &InputContext { cell: Some(cell), obstacle: Some(obstacle), ..InputContext::default() });
    }

    /// Marks the obstacle as the kind that the robot recognised (mission §3).
    pub(super) fn meet(&mut self, cell: Cell, heading: Heading, obstacle: Obstacle) {
        let mark = match obstacle {
            Obstacle::Wall { .. } => Mark::Wall,
            Obstacle::Luggage(piece) if self.state.pieces.contains(&piece) => Mark::Luggage,
            Obstacle::Luggage(_) | Obstacle::Unknown => Mark::NotInspected,
        };
        // A mark of inspected luggage stays. No new verdict is needed if the camera later fails to recognise the luggage.
        // A mark of a wall stays unless the camera has missed luggage there and recognises it now.
        let known = self.state.map.at(cell);
        if known != Mark::Luggage && (known != Mark::Wall || piece_of(obstacle).is_some()) {
            self.mark(cell, mark);
        }
        let taken_for = match obstacle {
            Obstacle::Wall { .. } => "wall",
            Obstacle::Luggage(_) => "luggage",
            Obstacle::Unknown => "unknown",
        };
        self.record(Fact::Obstacle(cell, taken_for));
        self.note_piece_at(cell, obstacle);
        if let (Obstacle::Wall { left, right }, Mark::Wall, true) = (obstacle, mark, self.settings.wall_lines) {
            self.reveal_wall(cell, heading.left(), left);
            self.reveal_wall(cell, heading.right(), right);
        }
    }

    /// Notes that a known piece also covers this cell. A retrieval of this piece then includes the cell.
    fn note_piece_at(&mut self, cell: Cell, obstacle: Obstacle) {
        let Obstacle::Luggage(piece) = obstacle else { return };
        let is_known = self.state.pieces.contains(&piece);
        let has_met = |luggage: &Luggage| luggage.cell == cell && luggage.piece == Some(piece);
        let is_new = || !self.state.met_again.contains_key(&cell) && !self.state.luggage.iter().any(|luggage| has_met(luggage));
        if is_known && is_new() {
            self.record(Fact::MetAgain(cell, piece));
            self.grow_piece(cell, piece);
        }
    }

    fn reveal_wall(&mut self, from: Cell, towards: Heading, count: u16) {
        let mut cell = from;
        for _ in 0..i32::from(count).min(REACH) {
            cell = cell.ahead(towards);
            if self.state.map.at(cell).is_unvisited() {
                self.mark(cell, Mark::Wall);
            }
        }
    }
}

pub(super) fn piece_of(obstacle: Obstacle) -> Option<Piece> {
    match obstacle {
        Obstacle::Luggage(piece) => Some(piece),
        Obstacle::Wall { .. } | Obstacle::Unknown => None,
    }
}
