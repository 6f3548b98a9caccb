//! The robots' reports about their arms during a retrieval, and what follows for the piece and the map: it was lifted,
//! set down, lost, or seen.

use std::collections::BTreeSet;

use super::Engine;
use crate::arm::{ArmState, Parcel};
use crate::event::RobotId;
use crate::place::Place;
use crate::state::Retrieval;
use crate::units::{Cell, OrderId, Piece};
use crate::world::hall_map::Mark;
use crate::world::resource::Resource;

impl Engine {
    /// A piece that is lifted stands nowhere; one that is set down stands where it was held.
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
            // It fell where it was held; robots that lose it report the same once more, maybe much later. A robot that
            // fetches by itself releases it at home.
            (Some(parcel), None) if !self.searches(robot) => self.piece_set_down(parcel.place),
            (None, None) if before.holds.is_none() => self.found_set_down(arm),
            (None | Some(_), None) | (Some(_), Some(_)) => {}
        }
    }

    /// It was set down while nobody listened: the program was killed, or the link lost.
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

    /// Obstacles that touch the piece and were not recognised as another one: they may have been part of it.
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

    /// The parcel lies on the floor; both robots report it, and again whenever they are reached anew. Another parcel
    /// may lie there since an earlier retrieval.
    pub(super) fn parcel_lost(&mut self, robot: &RobotId, parcel: Parcel) {
        if self.is_fetching(robot) && self.is_wanted_parcel(parcel) {
            self.piece_set_down(parcel.place);
        }
    }

    /// Whether this is the piece being fetched: by its identity, or, where the camera could not tell when it was
    /// recorded, by its place.
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
