//! The port through which doors read data that is too large or too old for a snapshot: photos, past missions, the journal.
//! Reading may touch a disk, so doors call it where blocking is allowed.

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
    /// The photo is lost for good, because its bytes are missing or differ from the record; in words for an operator.
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

/// Readable data, and a sentence about each part of the record that cannot be read. Nothing that follows from such a part is
/// included.
#[derive(Clone, Debug, PartialEq)]
pub struct Sound<T> {
    pub of: T,
    /// Sentences about unreadable parts, in words for an operator; at most a few, even when there are many.
    pub damage: Vec<String>,
}

/// The entries of the journal after the entry `after`, up to `until`. The entries are read as they were known at `until`,
/// whatever came later.
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
    /// When the mission was put away; `None` for the present mission.
    pub archived: Option<WallTime>,
    /// The last phase that the mission reached, by its name on the wire.
    pub phase: Arc<str>,
    pub luggage: u64,
    pub dangerous: u64,
    /// The bombs that were left in place when the mission was put away.
    pub left: Vec<LuggageId>,
}

/// A moment of a mission, right after an entry: the last entry up to a given number, or up to a given time. If the mission has
/// no entry up to there, the moment after its first entry is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    Entry(Seq),
    /// Milliseconds since 1970.
    Time(i64),
    /// Milliseconds since 1970, searched only between these two entries: a clock that was set back shows the same time twice.
    TimeAmong(i64, [Seq; 2]),
}

#[derive(Clone, Debug, PartialEq)]
pub struct PastMoment {
    pub past: Sound<Past>,
    pub wall: WallTime,
    pub earlier: Option<Seq>,
    pub later: Option<Seq>,
}

/// Head of the chain of digests: the last entry of a page, and the digest of that page, which covers all pages before it.
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

/// Bytes in lower-case hexadecimal digits, as every digest is written.
pub fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Read access to the store. Object-safe, because both stores, in memory and on disk, implement it.
pub trait Archive: Send + Sync {
    /// The newest photo of a piece, in whatever mission it was found.
    fn photo(&self, luggage: LuggageId) -> Result<Option<Photo>, Unreadable>;

    /// One photo of a piece by its number, counted from 1.
    fn take(&self, luggage: LuggageId, take: u32) -> Result<Option<Photo>, NoTake>;

    /// The record of a piece, in whatever mission it was found.
    fn luggage(&self, luggage: LuggageId) -> Result<Option<Luggage>, Unreadable>;

    /// The newest missions older than `before`, newest first, at most `most`.
    fn missions(&self, before: Option<MissionId>, most: usize) -> Result<Vec<MissionRecord>, Unreadable>;

    fn mission(&self, mission: MissionId) -> Result<Option<MissionRecord>, Unreadable>;

    /// The state when a mission was put away, or its present state, with map and luggage.
    fn state(&self, mission: MissionId) -> Result<Option<Sound<PersistentState>>, Unreadable>;

    /// The states of a mission at these moments, in this order; the maps share their equal parts. Empty when a moment given by
    /// its entry is before the first one, or when the entries needed are no longer stored.
    fn moments(&self, mission: MissionId, at: &[At]) -> Result<Vec<PastMoment>, Unreadable>;

    /// The entries of a mission, oldest first, at most `most`.
    fn entries(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable>;

    /// Like `entries`, as exported JSON, one line each without its line break; an entry that cannot be read becomes a line that
    /// says why.
    fn lines(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<(Seq, String)>, Unreadable>;

    /// The page of the chain with the last entry of a mission up to `until`; `None` when there is no such entry, or no chain.
    fn head(&self, mission: MissionId, until: Seq) -> Result<Option<Head>, Unreadable>;

    /// The entries of a mission that the timeline shows, oldest first, at most `most`: phases, holds, temperatures, luggage,
    /// verdicts, alarms, commands, stages of a retrieval, and when the program began and ended.
    fn timeline(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable>;

    /// The entry after which everything was declared lost, if the next start will delete the lost entries; only a store on disk
    /// has such an entry.
    fn lost_after(&self) -> Result<Option<Seq>, Unreadable> {
        Ok(None)
    }

    /// Entries about a mission's retrieval and its holds among the last thousands, oldest first, at most `most`.
    fn retrieval(&self, mission: MissionId, most: usize) -> Result<Vec<Happened>, Unreadable>;
}
