//! The leaves of the behaviour trees that look, calculate and send messages. They find the pallet and the parcel, and
//! check whether both robots are where they should be.

use super::{Performer, SEEN, answer, place_in, place_of, robot_in, written};
use crate::arm::{ArmAction, ArmState, Parcel};
use crate::effect::Action;
use crate::pair::{RetrievalFault, Saying, Which};
use crate::place::Place;
use behaviour_trees::{Leaf, Status, Value};

/// Maximum error of the distance between the bases when a parcel is put down, in micrometres. A box has about this
/// much room on a shelf.
const DROP_GAP_UM: i32 = 2500;

/// The camera's answer if it has recognised nothing.
const NONE: &str = "none";

/// Returns the camera's answer in the form of the blackboard entry `SEEN`.
pub(in crate::retrieval) fn seen(found: Option<Parcel>) -> (&'static str, Value) {
    (SEEN, found.map_or_else(|| Value::text(NONE), |parcel| written(parcel.place)))
}

impl Performer<'_> {
    /// Finds the pallet at its known place, or a parcel with the camera of SRM1.
    pub(super) fn find(&mut self, leaf: &mut Leaf<'_>) -> Status {
        let (seen, found) = (1, 2);
        let is_pallet = leaf.text(0) == Some("pallet");
        if leaf.is_starting() && !is_pallet {
            leaf.write(seen, Value::text(""));
            leaf.write(found, Value::text(""));
        }
        let Some(known) = self.parcel_known() else { return self.fails(RetrievalFault::NothingToFetch) };
        if is_pallet {
            leaf.write(found, written(known));
            return Status::Success;
        }
        let place = match leaf.text(seen) {
            None | Some("") => {
                if self.base(Which::Srm1).failures >= super::MOST_FAILURES {
                    return self.fails(RetrievalFault::RobotFails);
                }
                if self.base(Which::Srm1).open.is_none() {
                    self.propose(Which::Srm1, Action::Arm(ArmAction::FindParcel(known)));
                }
                return Status::Running;
            }
            Some(text) => place_of(text),
        };
        let Some(place) = place else { return Status::Failure };
        leaf.write(found, written(place));
        Status::Success
    }

    /// Returns the known place of the piece. A piece without a known cell lies between the two robots: it fell down
    /// on the way out, or while the program was not running.
    fn parcel_known(&self) -> Option<Place> {
        let [one, two] = self.places();
        let between = |place: &Place| one != two && place.is_beside(one) && place.is_beside(two);
        let outside = || (1..=Place::FURTHEST).map(Place::Outside).find(between);
        let fallen = || self.last.filter(between).or_else(outside);
        self.view.piece.first().copied().map(Place::Cell).or_else(fallen)
    }

    /// Calculates the parcel's place, if both robots can reach it and carry the parcel away. If the camera has not
    /// recognised the parcel, its known place is used, because the operator was called and has checked it.
    pub(super) fn calculate_goal(&mut self, leaf: &mut Leaf<'_>) -> Status {
        let Some(place) = place_in(leaf, 1).or_else(|| self.parcel_known()) else {
            return self.fails(RetrievalFault::NothingToFetch);
        };
        self.routes.forget();
        if !self.can_fetch(place) {
            return self.fails(RetrievalFault::NoWayToParcel);
        }
        leaf.write(2, written(place));
        Status::Success
    }

    pub(super) fn near(&mut self, leaf: &mut Leaf<'_>) -> Status {
        match (robot_in(leaf, 0), place_in(leaf, 1)) {
            (Some(which), Some(place)) => answer(self.is_near(which, place)),
            (None, _) => self.fails(RetrievalFault::Tree),
            (Some(_), None) => Status::Failure,
        }
    }

    pub(super) fn is_near(&self, which: Which, place: Place) -> bool {
        let base = self.base(which);
        let beside = match place {
            Place::Cell(_) => self.piece(place).into_iter().any(|cell| base.stands.place.is_beside(Place::Cell(cell))),
            Place::Outside(_) => base.stands.place.is_beside(place),
        };
        beside && !base.off_centre && base.open.is_none()
    }

    /// Sends a message. A message to the other robot is complete at once. A message to the operator is complete when
    /// it is acknowledged.
    pub(super) fn say(&mut self, leaf: &mut Leaf<'_>) -> Status {
        if leaf.text(0) == Some(Which::Srm2.name()) {
            let Some(message) = leaf.read(1).cloned() else { return self.fails(RetrievalFault::Tree) };
            leaf.write(2, message);
            return Status::Success;
        }
        let message = leaf.text(1).unwrap_or_default();
        let known = [("CallOperator", Saying::CallOperator), ("PackageLost", Saying::PackageLost)];
        let Some((_, saying)) = known.into_iter().find(|(word, _)| *word == message) else {
            return self.fails(RetrievalFault::Tree);
        };
        if leaf.is_starting() {
            self.output.sayings.push(saying);
            return Status::Running;
        }
        if self.view.is_calling { Status::Running } else { Status::Success }
    }

    pub(super) fn check_alignment(&mut self, leaf: &mut Leaf<'_>) -> Status {
        let Some(place) = place_in(leaf, 1) else { return self.fails(RetrievalFault::Tree) };
        match leaf.text(0) {
            Some("ARM1-ARM2") => answer(self.grip_place(place).is_some()),
            Some("EE") => {
                let wanted = self.grip_place(place);
                answer(wanted.is_some() && self.arms().iter().all(|arm| arm.aligned == wanted))
            }
            Some("DropPos") => answer(self.is_at_drop()),
            Some(_) | None => self.fails(RetrievalFault::Tree),
        }
    }

    pub(super) fn is_at_drop(&self) -> bool {
        let over = |arm: &ArmState| arm.holds.is_some_and(|parcel| parcel.place == self.view.target);
        let exact = self.arms().iter().all(|arm| arm.lifted && over(arm) && arm.gap_um.abs() <= DROP_GAP_UM);
        let still = Which::ALL.into_iter().all(|which| !self.base(which).off_centre && self.base(which).open.is_none());
        exact && still && self.load().is_some()
    }

    /// Returns the place at which the two robots can grip the piece from their present places and then carry it away.
    pub(super) fn grip_place(&mut self, place: Place) -> Option<Place> {
        let still = Which::ALL.into_iter().all(|which| !self.base(which).off_centre);
        still.then(|| self.grip_between(place))?
    }

    /// Returns the place at which the two robots grip the piece, once both have gone back to the centres of their
    /// places.
    pub(super) fn grip_between(&mut self, place: Place) -> Option<Place> {
        let [one, two] = self.places();
        let piece = self.piece(place);
        let all = piece.iter().copied().map(Place::Cell).chain(place.cell().is_none().then_some(place));
        let between: Vec<Place> = all.filter(|grip| one != two && grip.is_beside(one) && grip.is_beside(two)).collect();
        between.into_iter().find(|grip| {
            let (train, floor) = (self.train(*grip), self.floor(&piece, self.view.others));
            train.parcel == self.view.target || self.routes.next_train(&floor, train, self.view.target).is_some()
        })
    }
}
