//! The default strategy: it uses the strategy that does best in a hall like this one, as far as the hall is known. To
//! find luggage soon, the search begins along the walls, and continues there if luggage stands there. Otherwise the
//! tuned score does best, with weights for this kind of hall.

use super::entries::Visit;
use super::view::{Objective, View};
use super::ways::Ways;
use super::{scored, spiral};

/// Number of cells along walls that are looked at before the strategy decides where luggage stands. A larger number
/// would find luggage sooner in halls that are lined with it, and later in all other halls.
const LOOKED_AT: u32 = 50;

pub(super) fn next(view: &View<'_>, ways: &mut Ways) -> Option<Visit> {
    let census = view.grid.census();
    let is_along = view.terms.objective == Objective::Find && (census.is_lined() || census.along() < LOOKED_AT);
    if is_along { spiral::next(view, ways) } else { scored::next(view, ways) }
}
