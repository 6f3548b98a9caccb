//! The read port through which doors fetch what is too large or too old for a snapshot: photos, missions that are over, the
//! journal. Reading may touch a disk, so a door calls it where blocking is allowed.

use std::sync::Arc;

use hallsweep_core::effect::Entry;
use hallsweep_core::engine::Past;
use hallsweep_core::event::Photo;
use hallsweep_core::state::PersistentState;
use hallsweep_core::units::{LuggageId, MissionId, Seq, WallTime};
use hallsweep_core::world::luggage::Luggage;

/// Reading failed; why, in words for an operator.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the record cannot be read: {0}")]
pub struct Unreadable(pub String);

/// Why a photo that is on record cannot be looked at.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoTake {
    #[error(transparent)]
    Unreadable(#[from] Unreadable),
    /// It is lost for good: its bytes are not there, or are not those on record; in words for an operator.
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

/// What of something is sound, and a sentence on each part of the record that is not: what follows from that part is not in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Sound<T> {
    pub of: T,
    /// What is not, in words for an operator; a few of the sentences where there are many.
    pub damage: Vec<String>,
}

/// What stands behind one entry of the journal, up to another: as it was known then, whatever came after that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Span {
    pub after: Seq,
    pub until: Seq,
}

impl Span {
    /// To the end.
    pub const fn after(after: Seq) -> Span {
        Span { after, until: Seq(u64::MAX) }
    }
}

/// An entry of the journal by its place; where it cannot be understood, why.
pub type Happened = (Seq, Result<Entry, Unreadable>);

/// A mission in one line.
#[derive(Clone, Debug, PartialEq)]
pub struct MissionRecord {
    pub id: MissionId,
    /// The order of its search, by its name.
    pub strategy: Arc<str>,
    pub began: WallTime,
    /// When it was put away; `None` while it is the present one.
    pub archived: Option<WallTime>,
    /// The last phase it came to, by the name of the doors.
    pub phase: Arc<str>,
    /// How many pieces were found.
    pub luggage: u64,
    pub dangerous: u64,
    /// The bombs that were left in place when it was put away.
    pub left: Vec<LuggageId>,
}

/// A moment of a mission: after its last entry up to this one, or up to this time; before its first, after that.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum At {
    Entry(Seq),
    /// In milliseconds since 1970.
    Time(i64),
    /// A time in milliseconds since 1970, searched only between these two entries: a clock that is set back shows a time twice.
    TimeAmong(i64, [Seq; 2]),
}

/// How a mission stood after one of its entries.
#[derive(Clone, Debug, PartialEq)]
pub struct PastMoment {
    /// What is on record of it, and what of that cannot be understood.
    pub past: Sound<Past>,
    /// When its entry was written.
    pub wall: WallTime,
    /// The entries of the mission before and behind it.
    pub earlier: Option<Seq>,
    pub later: Option<Seq>,
}

/// Where the chain of digests has come to: the last entry of a page, and the digest of this page, which holds all pages before it.
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

    /// The digest that is written so.
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

/// What is kept and can be read back. Object-safe: the store in memory and the one on disk both are one.
pub trait Archive: Send + Sync {
    /// The newest photo of a piece, of whatever mission.
    fn photo(&self, luggage: LuggageId) -> Result<Option<Photo>, Unreadable>;

    /// One photo of a piece by how often it had been taken then, from 1.
    fn take(&self, luggage: LuggageId, take: u32) -> Result<Option<Photo>, NoTake>;

    /// The record of a piece, of whatever mission.
    fn luggage(&self, luggage: LuggageId) -> Result<Option<Luggage>, Unreadable>;

    /// The newest missions older than `before`, newest first, at most `most`.
    fn missions(&self, before: Option<MissionId>, most: usize) -> Result<Vec<MissionRecord>, Unreadable>;

    fn mission(&self, mission: MissionId) -> Result<Option<MissionRecord>, Unreadable>;

    /// What stood when a mission was put away, or stands now: its map and its luggage with it.
    fn state(&self, mission: MissionId) -> Result<Option<Sound<PersistentState>>, Unreadable>;

    /// How a mission stood at these moments, in their order; their maps share what is the same. Nothing where one of them is before the
    /// first entry that is asked for by its place, or where those from which it follows are not kept any more.
    fn moments(&self, mission: MissionId, at: &[At]) -> Result<Vec<PastMoment>, Unreadable>;

    /// The entries of a mission, oldest first, at most `most`.
    fn entries(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable>;

    /// The same as JSON, a line each without its break, as they are exported; in the place of one that cannot be understood a line that says why.
    fn lines(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<(Seq, String)>, Unreadable>;

    /// The page of the chain with the last entry of a mission up to this one; nothing where there is no such entry, or no chain.
    fn head(&self, mission: MissionId, until: Seq) -> Result<Option<Head>, Unreadable>;

    /// The entries of a mission that stand on the line of time, oldest first, at most `most`: phases, holds, temperatures,
    /// luggage, verdicts, alarms, commands, stages of a retrieval, and when the program began and ended.
    fn timeline(&self, mission: MissionId, span: Span, most: usize) -> Result<Vec<Happened>, Unreadable>;

    /// After which entry everything was said to be lost, where the next start takes it back; only what is on disk can come to that.
    fn lost_after(&self) -> Result<Option<Seq>, Unreadable> {
        Ok(None)
    }

    /// What the last thousands of entries of a mission tell of its retrieval, and of what held it, oldest first, at most `most`.
    fn retrieval(&self, mission: MissionId, most: usize) -> Result<Vec<Happened>, Unreadable>;
}
