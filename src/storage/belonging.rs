//! To which mission the entries of a page belong, in every store alike.

use hallsweep_core::effect::{Entry, Fact, Page};
use hallsweep_core::units::MissionId;

/// The mission an entry belongs to, and the one under way behind it. What leads to a mission's beginning belongs to it, as the
/// command that began it; the phase that follows on a mission does not, although it is on record before the mission's end.
pub(super) fn belongs(page: &Page, place: usize, under_way: Option<MissionId>) -> (Option<MissionId>, Option<MissionId>) {
    let (entry, rest) = (&page.entries[place], &page.entries[place..]);
    if let Fact::MissionArchived(mission, _) = &entry.fact {
        return (Some(*mission), None);
    }
    if let Some(begun) = begun(entry) {
        return (begun, begun);
    }
    let ahead = rest.iter().find_map(begun).flatten();
    let ends = rest.iter().any(|entry| matches!(entry.fact, Fact::MissionArchived(..)));
    let follows = ends && matches!(entry.fact, Fact::Phase(_));
    (under_way.filter(|_| !follows).or(ahead), under_way)
}

/// The mission that is under way from this entry on, where it says so.
fn begun(entry: &Entry) -> Option<Option<MissionId>> {
    if let Fact::MissionBegan(mission, _) = &entry.fact {
        return Some(Some(*mission));
    }
    if let Fact::State(standing) = &entry.fact { Some(standing.under_way.then_some(standing.mission)) } else { None }
}
