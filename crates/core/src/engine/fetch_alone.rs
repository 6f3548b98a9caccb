//! A retrieval by the robot that searches itself: it goes back to the piece, sees that it is the one, takes it onto its back, and lets go
//! of it at home, where the container stands. The retrieval by the pair, and what both have in common, is `retrieval`'s business.

use super::Engine;
use super::motion::Turn;
use crate::effect::Action;
use crate::retrieval::{ArmAction, Place, RetrievalFault};
use crate::search::plan::Through;
use crate::units::{Cell, Heading, Pose};

impl Engine {
    /// One look at it. Everything follows from where the robot stands and what it holds, so it makes no difference whether the program
    /// was ended in between.
    pub(super) fn fetch_alone(&mut self) -> Turn {
        if self.steps_outside(self.robots.searching_id()) > 0 {
            return self.order(Action::Enter);
        }
        let holds = self.robots.searching().arm.holds;
        let is_lifted = self.state.retrieval.as_ref().is_some_and(|retrieval| retrieval.piece.is_empty());
        match (holds, is_lifted) {
            (Some(_), _) if self.is_home() => self.order(Action::Arm(ArmAction::Release)),
            (Some(_), _) => self.carry_home(),
            // It has let go of it where the container stands, and nowhere else.
            (None, true) if self.is_home() => self.secured(),
            (None, true) => self.give_up("the robot does not hold the piece any more, and it is not in the container"),
            (None, false) => self.go_and_take(),
        }
    }

    fn carry_home(&mut self) -> Turn {
        if self.mission.route.is_empty() {
            let way = self.way_home(Through::Known).or_else(|| self.way_home(Through::Unknown));
            self.set_route(way);
        }
        if self.follow_route() { Turn::Rest } else { self.give_up("no way leads home with the piece") }
    }

    fn go_and_take(&mut self) -> Turn {
        let Pose { cell, heading } = self.state.pose;
        let ahead = cell.ahead(heading);
        if self.piece_to_fetch().any(|cell| cell == ahead) {
            return self.take(Place::Cell(ahead));
        }
        if self.mission.route.is_empty() {
            let way = self.way_to_piece();
            self.set_route(way);
        }
        if self.follow_route() { Turn::Rest } else { self.give_up("no way leads to the piece") }
    }

    /// Only what it was sent for, where the camera can tell.
    fn take(&mut self, place: Place) -> Turn {
        let Some(seen) = self.seen.take() else { return self.order(Action::Arm(ArmAction::FindParcel(place))) };
        match (seen, self.wanted_piece()) {
            (Some(parcel), Some(wanted)) if parcel.piece != wanted => self.give_up("another piece stands where it should be"),
            (Some(_), _) => self.order(Action::Arm(ArmAction::CloseGripper)),
            (None, _) => self.give_up(RetrievalFault::NothingToFetch.in_words()),
        }
    }

    fn piece_to_fetch(&self) -> impl Iterator<Item = Cell> {
        self.state.retrieval.iter().flat_map(|retrieval| retrieval.piece.iter().copied())
    }

    /// The shortest way to stand before any cell of it, facing it.
    fn way_to_piece(&mut self) -> Option<Vec<crate::command::Move>> {
        let before = |cell: Cell| Heading::ALL.map(|heading| Pose { cell: cell.ahead(heading.opposite()), heading });
        let poses: Vec<Pose> = self.piece_to_fetch().flat_map(before).collect();
        let ways = poses.into_iter().filter_map(|pose| self.planner.way_to_pose(&self.state.map, self.state.pose, pose));
        ways.min_by_key(Vec::len)
    }

    fn give_up(&mut self, words: &str) -> Turn {
        self.not_fetched(words.to_owned());
        Turn::Again
    }
}
