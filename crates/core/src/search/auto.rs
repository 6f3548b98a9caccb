//! The default strategy. It uses the strategy that is best for a hall like this one, as far as the hall is known. To
//! find luggage soon, the search begins along the walls. It continues there if luggage stands along the walls.
//! Otherwise it uses the tuned score, with weights for this kind of hall.

use super::entries::Visit;
use super::view::{Objective, View};
use super::ways::Ways;
use super::{scored, spiral};

/// Number of cells along walls to look at before deciding where luggage stands. With a larger number, luggage along
/// the walls would be found sooner, and luggage in all other halls would be found later.
const LOOKED_AT: u32 = 50;

pub(super) fn next(view: &View<'_>, ways: &mut Ways) -> Option<Visit> {
    let census = view.grid.census();
    let is_along = view.terms.objective == Objective::Find && (census.is_lined() || census.along() < LOOKED_AT);
    if is_along { spiral::next(view, ways) } else { scored::next(view, ways) }
}
