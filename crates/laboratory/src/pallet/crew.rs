//! What is known about the two robots and the yard from the robots' reports, and which orders have no answer yet. In
//! a mission in a hall, the core's engine keeps this knowledge. Only the simulated pair knows the true state.

use std::collections::BTreeSet;
use std::time::Duration;

use super::yard::Yard;
use hallsweep_core::arm::{ArmState, Parcel};
use hallsweep_core::command::Move;
use hallsweep_core::effect::{Action, Order};
use hallsweep_core::event::{Capabilities, Obstacle, RobotEvent};
use hallsweep_core::pair::Which;
use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::retrieval::{BaseView, Proposal, View};
use hallsweep_core::units::{Cell, Epoch, Heading, OrderId, Piece, Revision};
use hallsweep_core::world::hall_map::{HallMap, Mark};
use hallsweep_core::world::keep_out::NOWHERE;

#[derive(Clone, Debug)]
pub(super) struct Crew {
    map: HallMap,
    bases: [BaseView; 2],
    last: OrderId,
    can: Capabilities,
    target: Place,
    way_out: bool,
    /// Parcels outside the target area with their places, in the order in which they will be fetched.
    left: Vec<Parcel>,
    /// Cells of the next parcel. Empty while the parcel is held.
    piece: BTreeSet<Cell>,
}

impl Crew {
    pub(super) fn new(yard: &Yard, can: Capabilities) -> Crew {
        let base = |stands| BaseView { stands, off_centre: false, open: None, failures: 0, arm: ArmState::default() };
        let left: Vec<Parcel> =
            yard.parcels.iter().map(|(piece, cell)| Parcel { piece: *piece, place: Place::Cell(*cell) }).collect();
        let mut crew = Crew {
            map: yard.known_at_first(),
            bases: yard.starts.map(base),
            last: OrderId(0),
            can,
            target: yard.target,
            way_out: yard.way_out,
            left,
            piece: BTreeSet::new(),
        };
        crew.choose();
        crew
    }

    pub(super) fn view(&self, is_calling: bool) -> View<'_> {
        View {
            map: &self.map,
            way_out: self.way_out,
            others: &[],
            piece: &self.piece,
            wanted: None,
            target: self.target,
            bases: self.bases,
            is_calling,
            kept_out: &NOWHERE,
        }
    }

    pub(super) fn left(&self) -> impl Iterator<Item = (Piece, Place)> {
        let held = self.held();
        self.left
            .iter()
            .filter(move |parcel| held.is_none_or(|held| held.piece != parcel.piece))
            .map(|parcel| (parcel.piece, parcel.place))
    }

    /// Makes an order from a proposal of the trees. Its deadline is 3 × t + 1 s, where t is the usual duration of the
    /// order. Returns `None` if the robot still has an open order.
    pub(super) fn order(&mut self, proposal: Proposal) -> Option<Order> {
        let base = &mut self.bases[proposal.which.index()];
        if base.open.is_some() {
            return None;
        }
        base.open = Some(proposal.action);
        self.last = self.last.next();
        let nominal = match proposal.action {
            Action::Move(Move::TurnLeft | Move::TurnRight | Move::NudgeLeft | Move::NudgeRight) => self.can.turn,
            Action::Move(Move::Forward | Move::Backward) | Action::Enter | Action::Leave => self.can.step,
            Action::Recentre => self.can.step.max(self.can.turn),
            Action::Arm(_) | Action::Photograph(_) => self.can.arm,
        };
        let deadline = nominal.saturating_mul(3).saturating_add(Duration::from_secs(1));
        Some(Order { id: self.last, action: proposal.action, epoch: Epoch(0), deadline })
    }

    /// Clears the open orders after the program has died, since they will not be answered.
    pub(super) fn forget_orders(&mut self) {
        self.bases.iter_mut().for_each(|base| (base.open, base.failures) = (None, 0));
    }

    pub(super) fn report(&mut self, which: Which, report: RobotEvent) {
        let index = which.index();
        match report {
            RobotEvent::Stands(whereabouts) => {
                self.bases[index].stands.place = Place::Cell(whereabouts.pose.cell);
                self.bases[index].stands.heading = whereabouts.pose.heading;
                self.bases[index].off_centre = whereabouts.off_centre;
                self.mark(whereabouts.pose.cell, Mark::Visited);
            }
            RobotEvent::Arm(arm) => self.arm(index, arm),
            RobotEvent::ParcelLost(parcel) => self.lies(parcel),
            RobotEvent::Done(_) => self.done(index),
            RobotEvent::Blocked(_, obstacle) => self.blocked(which, obstacle),
            RobotEvent::Halted(_, off_centre) => {
                self.answered(index);
                self.bases[index].off_centre |= off_centre;
            }
            RobotEvent::Failed(..) => {
                let failures = self.bases[index].failures;
                let moved = self.answered(index).is_some_and(Action::moves_base);
                self.bases[index].off_centre |= moved;
                self.bases[index].failures = failures.saturating_add(1);
            }
            RobotEvent::Found(..) => drop(self.answered(index)),
            RobotEvent::StandsOutside(steps, heading, off_centre) => {
                self.bases[index].stands = BasePose { place: Place::Outside(steps), heading };
                self.bases[index].off_centre = off_centre;
            }
            RobotEvent::LinkUp(_)
            | RobotEvent::LinkLost(_)
            | RobotEvent::Paused
            | RobotEvent::Photo(..)
            | RobotEvent::PhotoFailed(..)
            | RobotEvent::Sonar(_)
            | RobotEvent::Ahead(_)
            | RobotEvent::Temperature(_) => {}
        }
    }

    fn answered(&mut self, index: usize) -> Option<Action> {
        self.bases[index].failures = 0;
        self.bases[index].open.take()
    }

    fn done(&mut self, index: usize) {
        let Some(action) = self.answered(index) else { return };
        let base = &mut self.bases[index];
        if action.moves_base() {
            base.off_centre = false;
        }
        let BasePose { place, heading } = base.stands;
        (base.stands.place, base.stands.heading) = match (action, place) {
            (Action::Move(Move::Forward), Place::Cell(cell)) => (Place::Cell(cell.ahead(heading)), heading),
            (Action::Move(Move::Backward), Place::Cell(cell)) => (Place::Cell(cell.ahead(heading.opposite())), heading),
            (Action::Move(Move::TurnLeft), _) => (place, heading.left()),
            (Action::Move(Move::TurnRight), _) => (place, heading.right()),
            (Action::Enter, Place::Outside(2..)) => (Place::ENTRANCE, heading),
            (Action::Enter, _) => (Place::Cell(Cell::HOME), heading),
            (Action::Leave, Place::Cell(_)) => (Place::ENTRANCE, heading),
            (Action::Leave, Place::Outside(steps)) => (Place::Outside(steps + 1), heading),
            (Action::Move(_) | Action::Recentre | Action::Photograph(_) | Action::Arm(_), _) => (place, heading),
        };
        if let Place::Cell(cell) = base.stands.place {
            self.mark(cell, Mark::Visited);
        }
    }

    /// Marks the cell of the obstacle that the robot met. If the obstacle is the other robot, nothing is marked.
    fn blocked(&mut self, which: Which, obstacle: Obstacle) {
        let action = self.answered(which.index());
        let base = &mut self.bases[which.index()];
        base.off_centre = true;
        let towards = |heading: Heading| base.stands.place.cell().map(|cell| cell.ahead(heading));
        let met = match action {
            Some(Action::Move(Move::Forward)) => towards(base.stands.heading),
            Some(Action::Move(Move::Backward)) => towards(base.stands.heading.opposite()),
            Some(_) | None => None,
        };
        let other = self.bases[which.other().index()].stands.place;
        if let Some(cell) = met.filter(|cell| Place::Cell(*cell) != other) {
            let mark = match obstacle {
                Obstacle::Luggage(_) => Mark::Luggage,
                Obstacle::Wall { .. } | Obstacle::Unknown => Mark::Wall,
            };
            self.mark(cell, mark);
        }
    }

    fn arm(&mut self, index: usize, arm: ArmState) {
        let before = self.held();
        self.bases[index].arm = arm;
        match (before, self.held()) {
            // The cell under a lifted parcel is free.
            (_, Some(parcel)) if !arm.on_floor => {
                if let Some(cell) = parcel.place.cell() {
                    self.mark(cell, Mark::Visited);
                }
                self.piece.clear();
            }
            (Some(parcel), None) if parcel.place == self.target => {
                self.left.retain(|left| left.piece != parcel.piece);
                self.choose();
            }
            _ => {}
        }
    }

    /// Makes a fallen parcel the next one to fetch, at its new place.
    fn lies(&mut self, parcel: Parcel) {
        self.left.retain(|left| left.piece != parcel.piece);
        self.left.insert(0, parcel);
        if let Some(cell) = parcel.place.cell() {
            self.mark(cell, Mark::Luggage);
        }
        self.choose();
    }

    fn choose(&mut self) {
        self.piece = self.left.first().and_then(|parcel| parcel.place.cell()).into_iter().collect();
    }

    fn held(&self) -> Option<Parcel> {
        self.bases[0].arm.holds
    }

    fn mark(&mut self, cell: Cell, mark: Mark) {
        self.map.mark(cell, mark, Revision(0));
    }
}
