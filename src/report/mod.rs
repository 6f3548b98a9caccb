//! The report of a mission: one HTML page with everything in it, for paper and for people who were not there. `list`
//! has the same record as a list for programs. The report contains only what is on record. So it can be made again
//! from the journal and compared with the copy that was handed over (`compare`). This makes the copy evidence.
//!
//! ```text
//!   journal ─► Archive ─► Tally, Moment ─► page, hall, chart ─► file         `Claim` in its head: mission, entry, language
//!      └──── journal check --report ──► the same again ──► Comparison ◄── file
//! ```
//! The doors and the command line decide when a report is made. Read the comment on `EDITION` before changing a
//! report.

pub mod bundle;
mod chart;
mod claim;
mod compare;
mod hall;
pub mod list;
mod page;
pub mod receipt;
mod scaled;
mod tally;

#[cfg(test)]
mod edition_tests;
#[cfg(test)]
mod tests;

use std::io::{self, Write};

pub use self::claim::{Claim, Unclear};
pub use self::compare::{Comparison, Difference};
use self::tally::Tally;
use crate::phrases::Language;
use crate::runtime::archive::{Archive, At, Head, PastMoment, Span, Unreadable};
use hallsweep_core::state::fact::Entry;
use hallsweep_core::units::{MissionId, Seq};

/// Edition of new reports. Every later version of hallsweep must be able to confirm earlier reports, so the contents
/// of an edition never change. Whoever changes the page, its style, or one of its phrases adds an edition, and leaves
/// everything that earlier editions use. `words.txt` has the words of the editions, and `pages.txt` has digests of
/// some pages; tests compare both files with the program. Edition 2 scales down the photos of a large report. It also
/// names the robots that took part, and says what was not searched. Its chart continues the last reading until the
/// temperature is not known any more. Edition 3 has the form of a document, with a letterhead and lines to sign on.
/// Edition 4 says what was found in how many pieces, and who has closed the mission. Edition 5 says how far the hall and
/// its areas were searched.
pub const EDITION: u32 = 5;

/// Number of entries read at once, so that a long mission is never in memory as a whole.
const BATCH: usize = 1000;

pub struct Report<'a> {
    archive: &'a dyn Archive,
    claim: Claim,
    began: Option<Seq>,
    /// The head of the chain of digests. `None` for a journal in memory, where nothing can confirm the report later.
    head: Option<Head>,
    tally: Tally,
    /// The state at the mission's end, or its present state; `None` if the state is not stored.
    moment: Option<PastMoment>,
}

/// Why there is no report, or only the beginning of a report.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    #[error(transparent)]
    Unreadable(#[from] Unreadable),
    #[error(transparent)]
    Unwritable(#[from] io::Error),
}

impl<'a> Report<'a> {
    /// Makes the report of a mission as far as it is recorded; `None` if there is no such mission.
    pub fn new(archive: &'a dyn Archive, mission: MissionId, language: Language) -> Result<Option<Report<'a>>, Unreadable> {
        let end = end(archive)?;
        let head = archive.head(mission, end)?;
        let until = match head {
            Some(head) => Some(head.seq),
            // Without a chain, the report covers the entries that are there now. The journal may grow while the
            // report is made.
            None => Tally::of(archive, mission, end)?.last(),
        };
        let Some(until) = until else { return Ok(None) };
        Report::of(archive, Claim { edition: EDITION, mission, until, language }, head)
    }

    /// Makes the report with this claim again. `None` if the journal has no such mission, or no longer has the
    /// claimed last entry.
    pub fn again(archive: &'a dyn Archive, claim: Claim) -> Result<Option<Report<'a>>, Unreadable> {
        let head = archive.head(claim.mission, claim.until)?;
        if head.is_none_or(|head| head.seq != claim.until) || claim.until > end(archive)? {
            return Ok(None);
        }
        Report::of(archive, claim, head)
    }

    fn of(archive: &'a dyn Archive, claim: Claim, head: Option<Head>) -> Result<Option<Report<'a>>, Unreadable> {
        let began = first(archive, claim.mission)?;
        let tally = Tally::of(archive, claim.mission, claim.until)?;
        if tally.last().is_none() {
            return Ok(None);
        }
        let moment = archive.moments(claim.mission, &[At::Entry(tally.stood_last(claim.until))])?.pop();
        Ok(Some(Report { archive, claim, began, head, tally, moment }))
    }

    /// Sentences about unreadable parts of the record. Such a part is an entry of the timeline, or an entry that is
    /// needed to draw the hall.
    fn damage(&self) -> Vec<&str> {
        let (told, drawn) = (&self.tally.damage, self.moment.iter().flat_map(|moment| &moment.past.damage));
        told.iter().chain(drawn.filter(|words| !told.contains(words))).map(String::as_str).collect()
    }

    pub fn head(&self) -> Option<&Head> {
        self.head.as_ref()
    }

    pub fn file_name(mission: MissionId) -> String {
        format!("hallsweep-mission-{mission}.html")
    }

    /// Writes the report part by part, so that the whole report is never in memory.
    pub fn write(&self, out: &mut dyn Write) -> Result<(), Failure> {
        page::write(self, out)?;
        still_there(self.archive, self.claim.mission, self.began)
    }
}

/// The last valid entry. Later entries were declared lost, and the next start of the program deletes these entries.
/// If no entry was lost, this is the greatest possible number.
fn end(archive: &dyn Archive) -> Result<Seq, Unreadable> {
    Ok(archive.lost_after()?.unwrap_or(Seq(u64::MAX)))
}

/// The first stored entry of a mission. The result changes when the mission is moved to an archive file.
fn first(archive: &dyn Archive, mission: MissionId) -> Result<Option<Seq>, Unreadable> {
    Ok(archive.entries(mission, Span { after: Seq(0), until: Seq(u64::MAX) }, 1)?.first().map(|(seq, _)| *seq))
}

/// Fails if the mission that began with the entry `began` was moved to an archive file meanwhile. The data read since
/// then may be incomplete.
fn still_there(archive: &dyn Archive, mission: MissionId, began: Option<Seq>) -> Result<(), Failure> {
    if first(archive, mission)? == began {
        return Ok(());
    }
    Err(Unreadable(format!("mission {mission} was moved to an archive meanwhile: make its report from the archive")).into())
}

/// Visits the entries of a mission's timeline up to `until`, oldest first.
fn each(
    archive: &dyn Archive,
    mission: MissionId,
    until: Seq,
    mut visit: impl FnMut(Seq, Result<&Entry, &Unreadable>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let batch = |after| archive.timeline(mission, Span { after, until }, BATCH);
    in_batches(batch, |seq, entry| visit(seq, entry.as_ref()))
}

/// Reads entries in batches and visits them, oldest first. A batch that is not full is the last one.
fn in_batches<T>(
    batch: impl Fn(Seq) -> Result<Vec<(Seq, T)>, Unreadable>,
    mut visit: impl FnMut(Seq, T) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut after = Seq(0);
    loop {
        let batch = batch(after)?;
        let is_last = batch.len() < BATCH;
        for (seq, one) in batch {
            visit(seq, one)?;
            after = seq;
        }
        if is_last {
            return Ok(());
        }
    }
}
