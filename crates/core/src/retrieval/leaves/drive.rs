//! The leaves that drive: each base alone to its place, both bases with the parcel between them, and the last few
//! centimetres. `way` finds the ways, and `steer` turns the bases.

use std::collections::BTreeSet;
use std::time::Duration;

use super::routes::Plan;
use super::{MOST_FAILURES, Performer, place_in, robot_in};
use crate::command::Move;
use crate::effect::Action;
use crate::pair::{RetrievalFault, Which};
use crate::place::Place;
use crate::retrieval::steer::{Gear, steer};
use crate::retrieval::way::{Stands, Train};
use crate::units::Cell;
use crate::world::hall_map::Mark;
use behaviour_trees::{Leaf, Status};

/// Maximum time for the last few centimetres. It is enough for dozens of attempts.
const ADJUSTING: Duration = Duration::from_secs(600);

enum Going {
    There,
    OnTheWay,
    NoWay,
    Fails,
}

impl Performer<'_> {
    /// Drives one base to a free place beside the pallet.
    pub(super) fn approach(&mut self, leaf: &mut Leaf<'_>) -> Status {
        let (Some(which), Some(place)) = (robot_in(leaf, 0), place_in(leaf, 1)) else {
            return self.fails(RetrievalFault::Tree);
        };
        if leaf.is_starting() {
            self.routes.forget();
        }
        if self.is_near(which, place) {
            return Status::Success;
        }
        match self.go_near(which, place) {
            Going::There => Status::Success,
            Going::OnTheWay => Status::Running,
            // The other base is in the way, so both bases go to the places where they can grip.
            Going::NoWay => match self.correct_bases(place) {
                Status::Failure => Status::Failure,
                Status::Idle | Status::Running | Status::Success | Status::Skipped => Status::Running,
            },
            Going::Fails => self.fails(RetrievalFault::RobotFails),
        }
    }

    pub(super) fn move_base(&mut self, leaf: &mut Leaf<'_>) -> Status {
        let object = place_in(leaf, 1);
        match (leaf.text(0), object) {
            (Some("CorrectBasePos"), Some(place)) => self.correct_bases(place),
            (Some("TargetArea"), _) => self.carry(),
            (Some("AdjustPositioning"), _) if leaf.elapsed() > ADJUSTING => self.fails(RetrievalFault::NotAligned),
            (Some("AdjustPositioning"), _) => self.adjust(),
            (Some("ReturnToPallet"), Some(place)) => self.return_to(place),
            (Some(_) | None, _) => self.fails(RetrievalFault::Tree),
        }
    }

    /// Returns the places from which the piece is lifted, from the last plan or from a new one. SRM1 drives to its
    /// place first. If SRM1 would then block SRM2, SRM2 drives first.
    pub(super) fn stands(&mut self, place: Place) -> Option<Plan> {
        let is_closed = |cell: &Cell| self.view.map.at(*cell).is_obstacle();
        let usable = |(at, plan): &(Place, Plan)| *at == place && !plan.stands.bases.iter().any(is_closed);
        if let Some((_, plan)) = self.routes.stands.filter(usable) {
            return Some(plan);
        }
        let plan = self.plan(place, self.places())?;
        self.routes.stands = Some((place, plan));
        Some(plan)
    }

    fn plan(&self, place: Place, [one, two]: [Place; 2]) -> Option<Plan> {
        let (piece, target) = (self.piece(place), self.view.target);
        let floor = self.floor(&piece, self.view.others);
        if let Some(stands) = floor.stands([one, two], &piece, target) {
            return Some(Plan { stands, order: Which::ALL });
        }
        let Stands { grip, bases: [first, second] } = floor.stands([two, one], &piece, target)?;
        Some(Plan { stands: Stands { grip, bases: [second, first] }, order: [Which::Srm2, Which::Srm1] })
    }

    /// Whether the piece can be lifted and carried away. The two robots may do this from their present places, or
    /// after they have been outside.
    pub(super) fn can_fetch(&mut self, place: Place) -> bool {
        self.grip_between(place).is_some() || self.stands(place).is_some() || self.can_fetch_from_outside(place)
    }

    fn can_fetch_from_outside(&self, place: Place) -> bool {
        self.view.way_out && self.plan(place, [Place::ENTRANCE; 2]).is_some()
    }

    /// Drives both bases to the places where they can grip. If the two block each other for good, they first go
    /// outside and come in again in another order.
    fn correct_bases(&mut self, place: Place) -> Status {
        if self.is_anybody_busy() {
            return Status::Running;
        }
        if self.grip_place(place).is_some() {
            return Status::Success;
        }
        if let Some(status) = self.recentre_both() {
            return status;
        }
        if let Some(plan) = self.stands(place) {
            let ends = plan.stands.bases.map(Place::Cell);
            match self.one_after_the_other(plan.order, |performer, which| performer.go(which, ends[which.index()])) {
                Going::There => return Status::Success,
                Going::OnTheWay => return Status::Running,
                Going::Fails => return self.fails(RetrievalFault::RobotFails),
                Going::NoWay => self.routes.stands = None,
            }
            if self.stands(place).is_some() {
                // A new plan was just made, with the present knowledge. The next tick follows it.
                return Status::Running;
            }
        }
        self.go_outside(place)
    }

    fn go_outside(&mut self, place: Place) -> Status {
        let both_there = self.places() == [Place::ENTRANCE; 2];
        if both_there || !self.can_fetch_from_outside(place) {
            return self.fails(RetrievalFault::NoWayToParcel);
        }
        match self.one_after_the_other(Which::ALL, |performer, which| performer.go(which, Place::ENTRANCE)) {
            Going::There | Going::OnTheWay => Status::Running,
            Going::NoWay => self.fails(RetrievalFault::NoWayToParcel),
            Going::Fails => self.fails(RetrievalFault::RobotFails),
        }
    }

    /// Drives back to the pallet for the next parcel. If nothing is left to fetch and the pair has a way out, both
    /// robots stay where they are.
    fn return_to(&mut self, pallet: Place) -> Status {
        if self.view.piece.is_empty() && self.view.way_out {
            return Status::Success;
        }
        let place = self.view.piece.first().copied().map_or(pallet, Place::Cell);
        match self.one_after_the_other(Which::ALL, |performer, which| performer.go_near(which, place)) {
            Going::There => Status::Success,
            Going::OnTheWay => Status::Running,
            Going::NoWay => self.fails(RetrievalFault::NoWayBack),
            Going::Fails => self.fails(RetrievalFault::RobotFails),
        }
    }

    /// Drives one base after the other, so that neither base enters the other's route unnoticed. If the first base
    /// finds no way, the second base tries.
    fn one_after_the_other(&mut self, order: [Which; 2], mut go: impl FnMut(&mut Self, Which) -> Going) -> Going {
        let mut all = Going::There;
        for which in order {
            match go(self, which) {
                Going::There => {}
                Going::NoWay => all = Going::NoWay,
                going @ (Going::OnTheWay | Going::Fails) => return going,
            }
        }
        all
    }

    /// Drives a base to its place beside the piece: the place from which the piece is lifted, or a free place beside
    /// it.
    fn go_near(&mut self, which: Which, place: Place) -> Going {
        if self.base(which).open.is_some() {
            return Going::OnTheWay;
        }
        if self.is_near(which, place) {
            return Going::There;
        }
        let other = self.base(which.other()).stands.place;
        let planned = self.stands(place).map(|plan| Place::Cell(plan.stands.bases[which.index()])).filter(|end| *end != other);
        let Some(end) = planned.or_else(|| self.room_beside(which, place)) else { return Going::NoWay };
        self.go(which, end)
    }

    fn room_beside(&self, which: Which, place: Place) -> Option<Place> {
        let (here, other) = (self.base(which).stands.place, [self.base(which.other()).stands.place]);
        let none = BTreeSet::new();
        let taken: Vec<Place> = other.into_iter().chain(self.view.others.iter().copied()).collect();
        let floor = self.floor(&none, &taken);
        let piece = self.piece(place);
        let beside = piece.iter().flat_map(|cell| cell.neighbours()).filter(|cell| !piece.contains(cell)).map(Place::Cell);
        let ways = beside.filter(|end| !taken.contains(end)).filter_map(|end| Some((floor.approach(here, end)?.len(), end)));
        ways.min().map(|(_, end)| end)
    }

    fn go(&mut self, which: Which, to: Place) -> Going {
        let base = self.base(which);
        if base.open.is_some() {
            return Going::OnTheWay;
        }
        if base.failures >= MOST_FAILURES {
            return Going::Fails;
        }
        if base.off_centre {
            self.propose(which, Action::Recentre);
            return Going::OnTheWay;
        }
        if base.stands.place == to {
            return Going::There;
        }
        let none = BTreeSet::new();
        let taken: Vec<Place> =
            std::iter::once(self.base(which.other()).stands.place).chain(self.view.others.iter().copied()).collect();
        let floor = self.floor(&none, &taken);
        let next = self.routes.next_place(which.index(), &floor, base.stands.place, to);
        let Some(action) = next.and_then(|next| steer(base.stands, next, self.gear(next))) else {
            self.routes.stands = None;
            return Going::NoWay;
        };
        self.propose(which, action);
        Going::OnTheWay
    }

    /// Returns the allowed direction. The camera looks ahead, so a base may drive backwards only into cells that are
    /// known to be free.
    fn gear(&self, next: Place) -> Gear {
        let is_known = next.cell().is_none_or(|cell| self.view.map.at(cell) == Mark::Visited);
        if is_known { Gear::Either } else { Gear::Forwards }
    }

    /// Moves both bases back to the centres of their places. Returns `None` when both are there.
    fn recentre_both(&mut self) -> Option<Status> {
        let mut all_centred = true;
        for which in Which::ALL {
            let base = self.base(which);
            if base.failures >= MOST_FAILURES {
                return Some(self.fails(RetrievalFault::RobotFails));
            }
            if base.off_centre {
                all_centred = false;
                if base.open.is_none() {
                    self.propose(which, Action::Recentre);
                }
            }
        }
        (!all_centred).then_some(Status::Running)
    }

    /// Carries the parcel to its destination. Fails if the parcel is no longer in both grippers.
    fn carry(&mut self) -> Status {
        let Some(parcel) = self.load() else { return Status::Failure };
        if let Some(status) = self.recentre_both() {
            return status;
        }
        let is_still = !self.is_anybody_busy();
        if parcel.place == self.view.target {
            return if is_still { Status::Success } else { Status::Running };
        }
        let train = self.train(parcel.place);
        if !train.bases.iter().all(|base| base.is_beside(parcel.place)) {
            // If only one robot has reported the end of the step, wait for the other one.
            return if is_still { self.fails(RetrievalFault::NoWayToTarget) } else { Status::Running };
        }
        let floor = self.floor(self.view.piece, self.view.others);
        let Some(next) = self.routes.next_train(&floor, train, self.view.target) else {
            return self.fails(RetrievalFault::NoWayToTarget);
        };
        self.step(train, next)
    }

    /// Moves each base towards its next place. First each base turns by itself; then both begin the step together.
    fn step(&mut self, train: Train, next: Train) -> Status {
        let wanted = Which::ALL.map(|which| {
            let to = next.bases[which.index()];
            let gear = if to == train.parcel { Gear::Either } else { self.gear(to) };
            steer(self.base(which).stands, to, gear)
        });
        let is_turn = |action: Option<Action>| matches!(action, Some(Action::Move(Move::TurnLeft | Move::TurnRight)));
        let any_turns = wanted.into_iter().any(is_turn);
        for (which, action) in Which::ALL.into_iter().zip(wanted) {
            let Some(action) = action else { return self.fails(RetrievalFault::NoWayToTarget) };
            if self.base(which).open.is_none() && (is_turn(Some(action)) || !any_turns) {
                self.propose(which, action);
            }
        }
        Status::Running
    }

    /// Corrects the gap between the bases: drives away from the place and back until the gap is right. The
    /// controllers of the wheels correct the gap only while the bases drive.
    fn adjust(&mut self) -> Status {
        let Some(parcel) = self.load() else { return Status::Failure };
        // Until both robots have reported the end of the step, their known places do not match each other.
        if self.is_anybody_busy() {
            return Status::Running;
        }
        if self.is_at_drop() {
            return Status::Success;
        }
        if let Some(status) = self.recentre_both() {
            return status;
        }
        if parcel.place != self.view.target {
            return self.carry();
        }
        let train = self.train(parcel.place);
        match self.step_aside(train) {
            Some(next) => self.step(train, next),
            None => self.fails(RetrievalFault::NotAligned),
        }
    }

    /// Returns the train (both bases with the parcel between them) after one step aside, over visited cells only.
    fn step_aside(&self, train: Train) -> Option<Train> {
        let is_free = |place: &Place| {
            let known = place.cell().is_none_or(|cell| self.view.map.at(cell) == Mark::Visited);
            known && !self.view.others.contains(place) && *place != train.parcel && !train.bases.contains(place)
        };
        (0..2).find_map(|leader| {
            let to = train.bases[leader].neighbours(self.view.way_out).find(is_free)?;
            let mut bases = [train.parcel; 2];
            bases[leader] = to;
            Some(Train { bases, parcel: train.bases[leader] })
        })
    }
}
