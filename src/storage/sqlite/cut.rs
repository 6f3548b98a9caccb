//! Finds the places where old missions may be cut off the journal. Such a place is after each page that ends a
//! mission, if the state after the page follows from the remaining entries.

use rusqlite::Connection;

use super::chain;
use super::fault::{Fault, count, whole};
use super::rows;
use crate::runtime::archive::Head;
use hallsweep_core::units::{MissionId, Seq, WallTime};

#[derive(Clone, Copy, Debug)]
pub(super) struct Cut {
    pub(super) missions: (MissionId, MissionId),
    /// Last entry that leaves the journal. `last` is the last archived page.
    pub(super) gone: Seq,
    pub(super) last: Head,
    entries: u64,
    photo_bytes: u64,
}

/// Maximum amount to cut off at once.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bound {
    pub(super) entries: u64,
    pub(super) photo_bytes: u64,
}

impl Bound {
    pub(super) const NONE: Bound = Bound { entries: u64::MAX, photo_bytes: u64::MAX };

    /// Bound for archiving at a start. On a common disk the start waits for some seconds, since photos are written,
    /// read again and hashed.
    pub(super) const OF_A_START: Bound = Bound { entries: 250_000, photo_bytes: 128 * 1024 * 1024 };

    pub(super) fn takes(self, cut: &Cut) -> bool {
        cut.entries <= self.entries && cut.photo_bytes <= self.photo_bytes
    }
}

/// All places where the journal may be cut so that only missions put away before `before` leave it. A cut at a later
/// place includes all missions of the earlier places.
pub(super) fn cuts(journal: &Connection, before: WallTime) -> Result<Vec<Cut>, Fault> {
    // A photo counts towards the mission in which its piece of luggage was found.
    let sql = "SELECT id, archived_seq, (SELECT coalesce(sum(bytes), 0) FROM luggage JOIN takes ON takes.luggage = luggage.id
                   JOIN photos ON photos.digest = takes.photo WHERE luggage.mission = missions.id)
               FROM missions ORDER BY id";
    let mut statement = journal.prepare(sql)?;
    let missions = statement.query_map([], |row| Ok((row.get(0)?, row.get::<_, Option<i64>>(1)?, row.get(2)?)))?;
    let begins = chain::anchor(journal)?.seq;
    let (mut first, mut photo_bytes, mut cuts) = (None, 0, Vec::new());
    for mission in missions {
        let (id, archived, bytes) = mission?;
        let Some(archived) = archived.map(|seq| Seq(count(seq))) else { break };
        let at: i64 = journal.query_row("SELECT at_ms FROM events WHERE seq = ?1", [whole(archived.0)?], |row| row.get(0))?;
        if at >= before.unix_ms {
            break;
        }
        let mission = MissionId(count(id));
        let first = *first.get_or_insert(mission);
        photo_bytes += count(bytes);
        // The page that ends a mission also has a snapshot of the whole state, with the emptied map.
        let Some(last) = chain::page_of(journal, archived)? else { break };
        let standing = rows::last_standing(journal, Some(last.seq.next()))?;
        let gone = chain::page_before(journal, archived)?;
        if let (Some(gone), true) = (gone, standing > Some(archived)) {
            let entries = last.seq.0.saturating_sub(begins.0);
            cuts.push(Cut { missions: (first, mission), gone: gone.seq, last, entries, photo_bytes });
        }
    }
    Ok(cuts)
}
