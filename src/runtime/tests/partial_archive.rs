//! For tests: an archive that has only what a test puts into it.

use crate::runtime::archive::{Archive, At, Happened, Head, MissionRecord, NoTake, PastMoment, Sound, Span, Unreadable};
use hallsweep_core::event::Photo;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{LuggageId, MissionId, Seq};
use hallsweep_core::world::luggage::Luggage;

/// The queries of `Archive`. Each query finds nothing, unless a test overrides it.
pub(crate) trait PartialArchive: Send + Sync {
    fn photo(&self, _: LuggageId) -> Result<Option<Photo>, Unreadable> {
        Ok(None)
    }

    fn take(&self, luggage: LuggageId, _: u32) -> Result<Option<Photo>, NoTake> {
        Ok(self.photo(luggage)?)
    }

    fn luggage(&self, _: LuggageId) -> Result<Option<Luggage>, Unreadable> {
        Ok(None)
    }

    fn missions(&self) -> Vec<MissionRecord> {
        Vec::new()
    }

    fn mission(&self, mission: MissionId) -> Result<Option<MissionRecord>, Unreadable> {
        Ok(self.missions().into_iter().find(|record| record.id == mission))
    }

    fn state(&self, _: MissionId) -> Option<Sound<PersistentState>> {
        None
    }

    fn moments(&self, _: MissionId, _: &[At]) -> Vec<PastMoment> {
        Vec::new()
    }

    fn entries(&self, _: MissionId) -> Vec<Happened> {
        Vec::new()
    }

    fn lines(&self, _: MissionId, _: Vec<Happened>) -> Vec<(Seq, String)> {
        Vec::new()
    }

    fn is_on_timeline(&self, _: &Happened) -> bool {
        true
    }

    fn head(&self, _: Seq) -> Option<Head> {
        None
    }

    fn lost_after(&self) -> Option<Seq> {
        None
    }

    fn retrieval(&self, _: MissionId) -> Vec<Happened> {
        Vec::new()
    }
}

impl<A: PartialArchive> Archive for A {
    fn photo(&self, luggage: LuggageId) -> Result<Option<Photo>, Unreadable> {
        PartialArchive::photo(self, luggage)
    }

    fn take(&self, luggage: LuggageId, take: u32) -> Result<Option<Photo>, NoTake> {
        PartialArchive::take(self, luggage, take)
    }

    fn luggage(&self, luggage: LuggageId) -> Result<Option<Luggage>, Unreadable> {
        PartialArchive::luggage(self, luggage)
    }

    fn missions(&self, before: Option<MissionId>, most: usize) -> Result<Vec<MissionRecord>, Unreadable> {
        let older = |record: &MissionRecord| before.is_none_or(|before| record.id < before);
        Ok(PartialArchive::missions(self).into_iter().filter(older).take(most).collect())
    }

    fn mission(&self, mission: MissionId) -> Result<Option<MissionRecord>, Unreadable> {
        PartialArchive::mission(self, mission)
    }

    fn state(&self, mission: MissionId) -> Result<Option<Sound<PersistentState>>, Unreadable> {
        Ok(PartialArchive::state(self, mission))
    }

    fn moments(&self, mission: MissionId, at: &[At]) -> Result<Vec<PastMoment>, Unreadable> {
        Ok(PartialArchive::moments(self, mission, at))
    }

    fn timeline(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable> {
        let all = Archive::entries(self, mission, span, usize::MAX)?;
        Ok(all.into_iter().filter(|happened| self.is_on_timeline(happened)).take(most).collect())
    }

    fn entries(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable> {
        let all = PartialArchive::entries(self, mission).into_iter();
        Ok(all.filter(|(seq, _)| *seq > span.after && *seq <= span.until).take(most).collect())
    }

    fn lines(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<(Seq, String)>, Unreadable> {
        Ok(PartialArchive::lines(self, mission, Archive::entries(self, mission, span, most)?))
    }

    fn head(&self, _: MissionId, until: Seq) -> Result<Option<Head>, Unreadable> {
        Ok(PartialArchive::head(self, until))
    }

    fn hand_overs(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable> {
        let all = Archive::entries(self, mission, span, usize::MAX)?.into_iter();
        let handed_over = |entry: &Entry| matches!(entry.fact, Fact::HandedOver { .. });
        Ok(all.filter(|(_, entry)| entry.as_ref().map_or(true, handed_over)).take(most).collect())
    }

    fn lost_after(&self) -> Result<Option<Seq>, Unreadable> {
        Ok(PartialArchive::lost_after(self))
    }

    fn retrieval(&self, mission: MissionId, most: usize) -> Result<Vec<Happened>, Unreadable> {
        Ok(PartialArchive::retrieval(self, mission).into_iter().take(most).collect())
    }
}
