//! A retrieval by the robot that searches. It goes back to the piece, recognises it, takes it onto its back, and
//! releases it at home, where the container stands. `retrieval` has the retrieval by the pair, and the code that both
//! retrievals share.

use super::Engine;
use super::motion::Turn;
use crate::arm::ArmAction;
use crate::command::Move;
use crate::effect::Action;
use crate::not_fetched::{AloneFault, NotFetched};
use crate::place::Place;
use crate::retrieval::MOST_FAILURES;
use crate::search::plan::Through;
use crate::state::RetrievalStage;
use crate::units::{Cell, Heading, Pose};
use crate::world::hall_map::Mark;

impl Engine {
    /// Does one step of the retrieval. The step depends only on where the robot stands and what it holds, so a
    /// restart between two steps makes no difference.
    pub(super) fn fetch_alone(&mut self) -> Turn {
        if self.steps_outside(self.robots.searching_id()) > 0 {
            return self.order(Action::Enter);
        }
        if !self.robots.searching().arm_is_heard {
            return Turn::Rest;
        }
        let is_lifted = self.state.retrieval.as_ref().is_some_and(|retrieval| retrieval.piece.is_empty());
        match (self.robots.searching().arm.holds, is_lifted) {
            (Some(parcel), _) if self.wanted_piece().is_some_and(|wanted| wanted != parcel.piece) => {
                self.give_up(AloneFault::OtherPiece)
            }
            (Some(_), _) if self.is_home() => {
                self.set_retrieval_stage(RetrievalStage::LettingGo);
                Turn::Again
            }
            (Some(_), _) => self.carry_home(),
            (None, true) => self.give_up(AloneFault::PieceLost),
            (None, false) => self.go_and_take(),
        }
    }

    /// Releases the piece at home. The stage `LettingGo` was recorded before. If the robot no longer holds the piece
    /// in this stage, it has released the piece into the container.
    pub(super) fn let_go(&mut self) -> Turn {
        let robot = self.robots.searching();
        match robot.arm.holds {
            _ if !robot.arm_is_heard => Turn::Rest,
            None => self.secured(),
            Some(_) if self.is_home() => self.order(Action::Arm(ArmAction::Release)),
            Some(_) => {
                self.set_retrieval_stage(RetrievalStage::Fetching);
                Turn::Again
            }
        }
    }

    /// Carries the piece home over visited cells only. The piece may explode, so the robot enters no unknown cell
    /// with it.
    fn carry_home(&mut self) -> Turn {
        if self.mission.route.is_empty() {
            let way = self.way_home(Through::Known).or_else(|| self.way_home_through_rings());
            self.set_route(way);
        }
        if self.follow_route() { Turn::Rest } else { self.give_up(AloneFault::NoWayHome) }
    }

    fn go_and_take(&mut self) -> Turn {
        let Pose { cell, heading } = self.state.pose;
        let ahead = cell.ahead(heading);
        if self.piece_to_fetch().any(|cell| cell == ahead) {
            // The ring of another bomb may lie across the way home. The piece then stays where it is.
            if self.way_home(Through::Known).is_none() {
                return self.give_up(AloneFault::NoWayHome);
            }
            return self.take(Place::Cell(ahead));
        }
        self.seen = None;
        if self.mission.route.is_empty() {
            let way = self.way_to_piece();
            self.set_route(way);
        }
        if self.follow_route() { Turn::Rest } else { self.give_up(AloneFault::NoWayToPiece) }
    }

    /// Takes the piece at this place, but only if it is the piece for which the robot was sent.
    fn take(&mut self, place: Place) -> Turn {
        if self.robots.searching().failures >= MOST_FAILURES {
            self.robots.searching_mut().failures = 0;
            return self.give_up(AloneFault::CannotTake);
        }
        match self.seen.take() {
            None => self.order(Action::Arm(ArmAction::FindParcel(place))),
            Some(Some(_)) => self.order(Action::Arm(ArmAction::CloseGripper)),
            Some(None) => self.give_up(AloneFault::NotRecognised),
        }
    }

    fn piece_to_fetch(&self) -> impl Iterator<Item = Cell> {
        self.state.retrieval.iter().flat_map(|retrieval| retrieval.piece.iter().copied())
    }

    /// Returns the shortest way to a cell beside the piece. At the end of the way, the robot faces the piece.
    fn way_to_piece(&mut self) -> Option<Vec<Move>> {
        let sides = |cell: Cell| Heading::ALL.map(|heading| (cell, heading));
        let sides: Vec<(Cell, Heading)> = self.piece_to_fetch().flat_map(sides).collect();
        let ways = sides.into_iter().filter_map(|(cell, heading)| self.way_before(cell, heading));
        ways.min_by_key(Vec::len)
    }

    /// Returns the way on which the robot comes up to this cell of the piece with this heading. The last cells in
    /// front of the piece need not be visited. It is enough that the robot has seen that they are free.
    fn way_before(&mut self, piece: Cell, heading: Heading) -> Option<Vec<Move>> {
        let back = |cell: &Cell| Some(cell.ahead(heading.opposite()));
        let mut before = std::iter::successors(back(&piece), back);
        let mut seen = 0;
        let cell = before.find(|cell| {
            let is_seen = self.state.map.at(*cell) == Mark::Seen;
            seen += usize::from(is_seen);
            !is_seen
        })?;
        let mut way = self.planner.way_to_pose(self.state.pose, Pose { cell, heading })?;
        way.extend(std::iter::repeat_n(Move::Forward, seen));
        Some(way)
    }

    fn give_up(&mut self, fault: AloneFault) -> Turn {
        self.not_fetched(NotFetched::Alone(fault));
        Turn::Again
    }
}
