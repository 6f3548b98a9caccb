//! The port through which doors read data that is too large or too old for a snapshot: photos, past missions, the
//! journal. Reading may use a disk, so doors call the port where blocking is allowed.

use std::sync::Arc;

use hallsweep_core::engine::Past;
use hallsweep_core::event::Photo;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::Entry;
use hallsweep_core::units::{LuggageId, MissionId, Seq, WallTime};
use hallsweep_core::world::luggage::Luggage;

/// Why reading failed, in words for an operator.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the record cannot be read: {0}")]
pub struct Unreadable(pub String);

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoTake {
    #[error(transparent)]
    Unreadable(#[from] Unreadable),
    /// The photo is lost for good: its bytes are missing or differ from the record. The words are for an operator.
    #[error("{0}")]
    Spoilt(String),
}

impl From<NoTake> for Unreadable {
    fn from(why: NoTake) -> Unreadable {
        match why {
            NoTake::Unreadable(unreadable) => unreadable,
            NoTake::Spoilt(words) => Unreadable(words),
        }
    }
}

/// Data that could be read, and one sentence for each part of the record that cannot be read. Data that follows from
/// an unreadable part is left out.
#[derive(Clone, Debug, PartialEq)]
pub struct Sound<T> {
    pub of: T,
    /// Sentences about unreadable parts, in words for an operator. If there are many such parts, only a few are
    /// listed.
    pub damage: Vec<String>,
}

/// The entries of the journal after the entry `after`, up to the entry `until`. Each entry is read with the knowledge
/// of that time: entries after `until` do not matter.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    pub after: Seq,
    pub until: Seq,
}

impl Span {
    pub const fn after(after: Seq) -> Span {
        Span { after, until: Seq(u64::MAX) }
    }
}

pub type Happened = (Seq, Result<Entry, Unreadable>);

#[derive(Clone, Debug, PartialEq)]
pub struct MissionRecord {
    pub id: MissionId,
    pub strategy: Arc<str>,
    pub began: WallTime,
    /// When the mission was archived; `None` for the present mission.
    pub archived: Option<WallTime>,
    /// The last phase that the mission reached, under its name at the doors.
    pub phase: Arc<str>,
    pub luggage: u64,
    pub dangerous: u64,
    /// The dangerous pieces that were still in the hall when the mission was archived.
    pub left: Vec<LuggageId>,
    pub is_exercise: bool,
}

/// A moment of a mission, right after one of its entries. This is the last entry up to the given number or time. If
/// all entries are later than the given time, it is the first entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    Entry(Seq),
    /// The time, in milliseconds since 1970.
    Time(i64),
    /// Like `Time`, but only these two entries and the entries between them are searched. If the clock was set back,
    /// the same time occurs twice, so the time alone is not enough.
    TimeAmong(i64, [Seq; 2]),
}

#[derive(Clone, Debug, PartialEq)]
pub struct PastMoment {
    pub past: Sound<Past>,
    pub wall: WallTime,
    pub earlier: Option<Seq>,
    pub later: Option<Seq>,
}

/// Head of the chain of digests: the last entry of a page, and the digest of this page. The digest also covers all
/// pages before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Head {
    pub seq: Seq,
    pub digest: [u8; 32],
}

impl Head {
    /// The digest in 64 lower-case hexadecimal digits.
    pub fn hex(&self) -> String {
        hex(&self.digest)
    }

    pub fn read_digest(hex: &str) -> Option<[u8; 32]> {
        let is_written_so = hex.len() == 64 && hex.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
        let byte = |place: usize| u8::from_str_radix(hex.get(2 * place..2 * place + 2)?, 16).ok();
        if is_written_so { Some(std::array::from_fn(|place| byte(place).unwrap_or(0))) } else { None }
    }
}

/// Writes bytes in lower-case hexadecimal digits, the form of every digest.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Read access to the store. The trait is object-safe, because two stores implement it: one in memory and one on
/// disk.
pub trait Archive: Send + Sync {
    /// The newest photo of a piece of any mission.
    fn photo(&self, luggage: LuggageId) -> Result<Option<Photo>, Unreadable>;

    /// One photo of a piece. `take` is its number, counted from 1.
    fn take(&self, luggage: LuggageId, take: u32) -> Result<Option<Photo>, NoTake>;

    /// The record of a piece of any mission.
    fn luggage(&self, luggage: LuggageId) -> Result<Option<Luggage>, Unreadable>;

    /// At most `most` missions older than `before`, newest first.
    fn missions(&self, before: Option<MissionId>, most: usize) -> Result<Vec<MissionRecord>, Unreadable>;

    fn mission(&self, mission: MissionId) -> Result<Option<MissionRecord>, Unreadable>;

    /// The state when a mission was archived, or its present state, with map and luggage.
    fn state(&self, mission: MissionId) -> Result<Option<Sound<PersistentState>>, Unreadable>;

    /// The states of a mission at these moments, in the order of `at`. Equal parts of the maps share memory. The
    /// result is empty if an `At::Entry` is before the first entry, or if the required entries are no longer stored.
    fn moments(&self, mission: MissionId, at: &[At]) -> Result<Vec<PastMoment>, Unreadable>;

    /// At most `most` entries of a mission, oldest first.
    fn entries(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable>;

    /// Like `entries`, but as lines of exported JSON without line breaks. An entry that cannot be read becomes a line
    /// that says why.
    fn lines(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<(Seq, String)>, Unreadable>;

    /// The page of the chain that has the mission's last entry up to `until`. `None` if there is no such entry, or no
    /// chain.
    fn head(&self, mission: MissionId, until: Seq) -> Result<Option<Head>, Unreadable>;

    /// At most `most` entries of a mission that the timeline shows, oldest first. These are phases, holds,
    /// temperatures, luggage, verdicts, alarms, commands, stages of a retrieval, and the program's starts and ends.
    fn timeline(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable>;

    /// At most `most` entries that say to whom a mission was handed over, oldest first.
    fn hand_overs(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable>;

    /// The last entry before the entries that were declared lost and that the next start will delete. `None` if there
    /// are no such entries. Only a store on disk can have such entries.
    fn lost_after(&self) -> Result<Option<Seq>, Unreadable> {
        Ok(None)
    }

    /// At most `most` entries about a mission's retrieval and its holds, oldest first. Only the last thousands of
    /// entries are searched.
    fn retrieval(&self, mission: MissionId, most: usize) -> Result<Vec<Happened>, Unreadable>;
}
