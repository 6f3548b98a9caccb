//! Handles the robots' reports about their arms during a retrieval. When a piece is lifted, set down, lost or seen,
//! the map changes accordingly.

use std::collections::BTreeSet;

use super::Engine;
use crate::arm::{ArmState, Parcel};
use crate::place::Place;
use crate::robot::RobotId;
use crate::state::Retrieval;
use crate::units::{Cell, OrderId, Piece};
use crate::world::hall_map::Mark;
use crate::world::resource::Resource;

impl Engine {
    /// Handles a new state of a robot's arm. A lifted piece occupies no cell. A piece that is set down occupies the
    /// cell over which the robot held it.
    pub(super) fn arm_reported(&mut self, robot: &RobotId, arm: ArmState) {
        let Some(known) = self.robots.get_mut(robot) else { return };
        let before = std::mem::replace(&mut known.arm, arm);
        known.arm_is_heard = true;
        self.world.touch(Resource::Robot);
        if !self.is_fetching(robot) {
            return;
        }
        let off_floor = |arm: ArmState| arm.holds.filter(|_| !arm.on_floor);
        match (off_floor(before), off_floor(arm)) {
            (None, Some(_)) => self.piece_lifted(),
            // The piece fell down where the robot held it. Robots that lose a piece report the loss once more, maybe
            // much later. A robot that fetches by itself is excluded, because it releases the piece at home on
            // purpose.
            (Some(parcel), None) if !self.searches(robot) => self.piece_set_down(parcel.place),
            (None, None) if before.holds.is_none() => self.found_set_down(arm),
            (None | Some(_), None) | (Some(_), Some(_)) => {}
        }
    }

    /// Handles a piece that was set down while no report could arrive, because the program was not running or the
    /// link was lost.
    fn found_set_down(&mut self, arm: ArmState) {
        let is_off_floor = self.state.retrieval.as_ref().is_some_and(|retrieval| retrieval.piece.is_empty());
        if let Some(parcel) = arm.holds.filter(|_| is_off_floor) {
            self.piece_set_down(parcel.place);
        }
    }

    fn piece_lifted(&mut self) {
        let Some(retrieval) = self.state.retrieval.clone().filter(|retrieval| !retrieval.piece.is_empty()) else { return };
        for cell in self.doubtful(&retrieval.piece) {
            self.mark(cell, Mark::Unknown);
        }
        for cell in &retrieval.piece {
            self.mark(*cell, Mark::Visited);
        }
        self.note_retrieval(Some(Retrieval { piece: BTreeSet::new(), ..retrieval }));
    }

    /// Returns the obstacles that touch the piece and were not recognised as another piece. These obstacles may have
    /// been part of the piece.
    fn doubtful(&self, piece: &BTreeSet<Cell>) -> BTreeSet<Cell> {
        let recognised = |cell: &Cell| {
            let recorded = self.state.luggage.iter().any(|luggage| luggage.cell == *cell && luggage.piece.is_some());
            recorded || self.state.met_again.contains_key(cell)
        };
        let mut found = BTreeSet::new();
        let mut open: Vec<Cell> = piece.iter().copied().collect();
        while let Some(cell) = open.pop() {
            for next in cell.neighbours() {
                let is_luggage = matches!(self.state.map.at(next), Mark::Luggage | Mark::NotInspected);
                if is_luggage && !piece.contains(&next) && !recognised(&next) && found.insert(next) {
                    open.push(next);
                }
            }
        }
        found
    }

    fn piece_set_down(&mut self, place: Place) {
        let (Some(retrieval), Some(cell)) = (self.state.retrieval.clone(), place.cell()) else { return };
        self.mark(cell, Mark::Luggage);
        self.note_retrieval(Some(Retrieval { piece: BTreeSet::from([cell]), ..retrieval }));
    }

    /// Handles the report that the parcel lies on the floor. Both robots report this, and repeat it whenever they are
    /// reconnected. The report may be about another parcel that was lost in an earlier retrieval.
    pub(super) fn parcel_lost(&mut self, robot: &RobotId, parcel: Parcel) {
        if self.is_fetching(robot) && self.is_wanted_parcel(parcel) {
            self.piece_set_down(parcel.place);
        }
    }

    /// Whether `parcel` is the piece being fetched. The number that the camera recognises decides. A piece that was
    /// recorded without a number is recognised by its place.
    pub(super) fn is_wanted_parcel(&self, parcel: Parcel) -> bool {
        let Some(retrieval) = &self.state.retrieval else { return false };
        let is_there = retrieval.piece.is_empty() || parcel.place.cell().is_some_and(|cell| retrieval.piece.contains(&cell));
        self.wanted_piece().map_or(is_there, |wanted| wanted == parcel.piece)
    }

    pub(super) fn grow_piece(&mut self, cell: Cell, piece: Piece) {
        let Some(retrieval) = self.state.retrieval.clone() else { return };
        let is_it = self.state.luggage.get(retrieval.luggage).is_some_and(|luggage| luggage.piece == Some(piece));
        if is_it && !retrieval.piece.is_empty() && !retrieval.piece.contains(&cell) {
            let cells = retrieval.piece.iter().copied().chain([cell]).collect();
            self.note_retrieval(Some(Retrieval { piece: cells, ..retrieval }));
        }
    }

    pub(super) fn found(&mut self, robot: &RobotId, order: OrderId, parcel: Option<Parcel>) {
        if self.close(robot, order).is_some() {
            let is_unknown = self.state.retrieval.as_ref().is_some_and(|retrieval| retrieval.piece.is_empty());
            if let Some(parcel) = parcel.filter(|parcel| is_unknown && self.wanted_piece() == Some(parcel.piece)) {
                self.piece_set_down(parcel.place);
            }
            self.seen = Some(parcel.filter(|parcel| self.is_wanted_parcel(*parcel)));
        }
    }
}
