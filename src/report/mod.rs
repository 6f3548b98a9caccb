//! The report of a mission: one page of HTML with everything in it, for paper and for whoever was not there, and the same record as a list
//! for programs (`list`). It holds what is on record and nothing else, so that it can be made again from the journal and be held
//! against what was handed over (`compare`): that is what makes it evidence.
//!
//! ```text
//!   journal ─► Archive ─► Tally, Moment ─► page, hall, chart ─► file         `Claim` in its head: mission, entry, language
//!      └──── journal check --report ──► the same again ──► Comparison ◄── file
//! ```
//! Where it is asked for is the doors' and the command line's business. EDITION says what becomes of earlier reports when this is changed.

mod chart;
mod claim;
mod compare;
mod hall;
pub mod list;
mod page;
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
use hallsweep_core::effect::Entry;
use hallsweep_core::units::{MissionId, Seq};

/// Reports that were handed over must be confirmed by every later version. So what one of them says is never said otherwise: whoever changes
/// the page, its style, or a phrase that it says makes a further edition, and keeps what the earlier ones need. `words.txt` remembers
/// what they say, `pages.txt` how some pages look, and tests hold them. Edition 2 scales the photos of a large report
/// down, says which robots took part and what was not searched, and draws a reading until it is not known any more.
pub const EDITION: u32 = 2;

/// Entries that are looked at together.
const BATCH: usize = 1000;

/// A report that can be written.
pub struct Report<'a> {
    archive: &'a dyn Archive,
    claim: Claim,
    /// The first entry of the mission.
    began: Option<Seq>,
    /// Where the chain of digests had come to; `None` where the journal is in memory alone, and nothing can confirm it later.
    head: Option<Head>,
    tally: Tally,
    /// How it stood at its end, or stands; `None` where that is not kept.
    moment: Option<PastMoment>,
}

/// Why there is no report, or only the beginning of one.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    #[error(transparent)]
    Unreadable(#[from] Unreadable),
    #[error(transparent)]
    Unwritable(#[from] io::Error),
}

impl<'a> Report<'a> {
    /// The report of a mission as far as it is on record; `None` where there is no such mission.
    pub fn new(archive: &'a dyn Archive, mission: MissionId, language: Language) -> Result<Option<Report<'a>>, Unreadable> {
        let end = end(archive)?;
        let head = archive.head(mission, end)?;
        let until = match head {
            Some(head) => Some(head.seq),
            // Where there is no chain it goes as far as is seen now: the journal may grow meanwhile.
            None => Tally::of(archive, mission, end)?.last(),
        };
        let Some(until) = until else { return Ok(None) };
        Report::of(archive, Claim { edition: EDITION, mission, until, language }, head)
    }

    /// The report that says this of itself, made again; `None` where the journal has no such mission, or none up to this entry.
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

    /// What cannot be understood of what it is made from, a sentence each: on the line of time, and besides what the hall follows from.
    fn damage(&self) -> Vec<&str> {
        let (told, drawn) = (&self.tally.damage, self.moment.iter().flat_map(|moment| &moment.past.damage));
        told.iter().chain(drawn.filter(|words| !told.contains(words))).map(String::as_str).collect()
    }

    /// Where the chain of digests had come to.
    pub fn head(&self) -> Option<&Head> {
        self.head.as_ref()
    }

    /// What a file of it is called.
    pub fn file_name(mission: MissionId) -> String {
        format!("hallsweep-mission-{mission}.html")
    }

    /// Writes it, a part at a time: of what may be large nothing is held as a whole.
    pub fn write(&self, out: &mut dyn Write) -> Result<(), Failure> {
        page::write(self, out)?;
        still_there(self.archive, self.claim.mission, self.began)
    }
}

/// The last entry that counts: what comes behind it was said to be lost, and the next start takes it back.
fn end(archive: &dyn Archive) -> Result<Seq, Unreadable> {
    Ok(archive.lost_after()?.unwrap_or(Seq(u64::MAX)))
}

/// The first entry of a mission that is on record: another, or none, once the mission was written out into an archive.
fn first(archive: &dyn Archive, mission: MissionId) -> Result<Option<Seq>, Unreadable> {
    Ok(archive.entries(mission, Span { after: Seq(0), until: Seq(u64::MAX) }, 1)?.first().map(|(seq, _)| *seq))
}

/// Fails where a mission that began with this entry was written out meanwhile: what was read since may be half of it.
fn still_there(archive: &dyn Archive, mission: MissionId, began: Option<Seq>) -> Result<(), Failure> {
    if first(archive, mission)? == began {
        return Ok(());
    }
    Err(Unreadable(format!("mission {mission} was written out into an archive meanwhile: ask for it there")).into())
}

/// Walks over what is on record of a mission up to `until` and stands on its line of time, oldest first.
fn each(
    archive: &dyn Archive,
    mission: MissionId,
    until: Seq,
    mut visit: impl FnMut(Seq, Result<&Entry, &Unreadable>) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let batch = |after| archive.timeline(mission, Span { after, until }, BATCH);
    in_batches(batch, |seq, entry| visit(seq, entry.as_ref()))
}

/// Visits what is read in batches, oldest first; one that is not full is the last.
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
