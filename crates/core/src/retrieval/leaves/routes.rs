//! Remembered routes, so that a way is not searched for at every step: the routes of each base, the routes of both
//! bases with a parcel (a *train*), and the places from which a piece is lifted. A route that no longer fits is
//! dropped. All routes are lost when the program ends.

use std::collections::VecDeque;

use crate::pair::Which;
use crate::place::Place;
use crate::retrieval::way::{Floor, Stands, Train};

#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    pub(super) stands: Stands,
    pub(super) order: [Which; 2],
}

#[derive(Clone, Debug, Default)]
pub(in crate::retrieval) struct Routes {
    /// The plan for lifting the piece, with the place of the piece for which it was made.
    pub(super) stands: Option<(Place, Plan)>,
    alone: [VecDeque<Place>; 2],
    train: VecDeque<Train>,
}

impl Routes {
    pub(in crate::retrieval) fn forget(&mut self) {
        *self = Routes::default();
    }

    /// Returns the next place on the way. The present way is kept while it still leads from `from` to `to` and
    /// nothing blocks it.
    pub(super) fn next_place(&mut self, index: usize, floor: &Floor<'_>, from: Place, to: Place) -> Option<Place> {
        let way = &mut self.alone[index];
        if way.front() == Some(&from) {
            way.pop_front();
        }
        let leads_on = way.front().is_some_and(|next| next.is_beside(from)) && way.back() == Some(&to);
        if !leads_on || way.iter().any(|place| floor.taken.contains(place) || is_closed(floor, *place)) {
            *way = floor.approach(from, to)?.into();
        }
        way.front().copied()
    }

    /// Returns the next train on the way. The present way is kept while nothing blocks it and it still leads to a
    /// train whose parcel is at `drop`.
    pub(super) fn next_train(&mut self, floor: &Floor<'_>, from: Train, drop: Place) -> Option<Train> {
        let way = &mut self.train;
        if way.front() == Some(&from) {
            way.pop_front();
        }
        let leads_on = way.front().is_some_and(|next| {
            let (leader, to) = from.leader(*next);
            to.is_beside(from.bases[leader]) && next.parcel == from.bases[leader] && next.bases[1 - leader] == from.parcel
        });
        let blocked = |train: &Train| train.bases.iter().any(|base| floor.taken.contains(base) || is_closed(floor, *base));
        if !leads_on || way.back().is_none_or(|train| train.parcel != drop) || way.iter().any(blocked) {
            *way = floor.carry(from, drop)?.into();
        }
        way.front().copied()
    }
}

fn is_closed(floor: &Floor<'_>, place: Place) -> bool {
    place.cell().is_some_and(|cell| floor.map.at(cell).is_obstacle() || floor.kept_out.contains(cell))
}
