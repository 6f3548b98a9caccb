//! Finds the pieces of luggage that differ between two snapshots.

use std::sync::Arc;

use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::world::luggage::Luggage;
use hallsweep_core::world::resource::Resource;

/// Returns the pieces of `newer`, by number, that are new or have changed. A piece has changed if `differs(earlier,
/// later)` is true for its two versions.
pub(super) fn changed<'a>(
    older: &'a Snapshot,
    newer: &'a Snapshot,
    differs: impl Fn(&Luggage, &Luggage) -> bool + 'a,
) -> impl Iterator<Item = &'a Arc<Luggage>> {
    let is_touched = older.revision_of(Resource::Luggage) != newer.revision_of(Resource::Luggage);
    let is_news = move |piece: &&'a Arc<Luggage>| older.luggage.get(piece.id).is_none_or(|earlier| differs(earlier, piece));
    newer.luggage.changed_since(&older.luggage).filter(move |_| is_touched).filter(is_news)
}
