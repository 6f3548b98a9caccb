//! Which pieces of luggage are other than they were.

use std::sync::Arc;

use hallsweep_core::world::luggage::Luggage;
use hallsweep_core::world::resource::Resource;
use hallsweep_core::world::snapshot::Snapshot;

/// The pieces of `newer`, by number, that were not in `older` or of which `differs` (the earlier record, the later one) says so.
pub(super) fn changed<'a>(
    older: &'a Snapshot,
    newer: &'a Snapshot,
    differs: impl Fn(&Luggage, &Luggage) -> bool + 'a,
) -> impl Iterator<Item = &'a Arc<Luggage>> {
    let is_touched = older.revision_of(Resource::Luggage) != newer.revision_of(Resource::Luggage);
    let before =
        |piece: &Luggage| older.luggage.binary_search_by_key(&piece.id, |other| other.id).ok().map(|at| &older.luggage[at]);
    let is_news = move |piece: &&'a Arc<Luggage>| {
        before(piece).is_none_or(|earlier| !Arc::ptr_eq(earlier, piece) && differs(earlier, piece))
    };
    newer.luggage.iter().filter(move |_| is_touched).filter(is_news)
}
