//! The shapes of the journal: every fact as JSON and back, for the table of events and for export, one object a line. In the table what was
//! asked, refused and caused has a code with fields (`coded`), which no wording changes; exported it is a sentence.
//! Where the lines are kept is the store's business; a photo's pixels are not in them, only the digest of its file.
//!
//! ```text
//!   {"seq":12,"at":"2026-02-03T10:05:12.000+01:00","unixMs":1770109512000,"offsetS":3600,"mission":3,
//!    "kind":"phase","phase":{"name":"exploring"}}
//! ```
//! Reading skips fields that it does not know, so that a later version may add some, and refuses meanings that it does not know.

mod asked;
mod causes;
mod coded;
mod conditions;
mod earlier;
mod fact;
mod luggage;
mod map;
mod names;
mod phase;
mod places;
mod refused;
mod retrieval;
mod standing;
mod team;

#[cfg(test)]
pub(crate) mod arbitrary;
#[cfg(test)]
mod tests;

pub use conditions::ConditionsShape;
pub use fact::kind;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use self::coded::Form;
use self::fact::Shape;
use super::time::rfc3339;
use hallsweep_core::effect::{Entry, Fact};
use hallsweep_core::units::{MissionId, Seq, WallTime};
use hallsweep_core::world::luggage::Luggage;

/// Why no fact can be made of what was kept, as a sentence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unparsed(pub(super) String);

/// The file in which a photo is kept.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Picture {
    /// The SHA-256 of its bytes, in 64 lower-case hexadecimal digits.
    pub digest: String,
    /// Its media type, as `image/png`.
    pub media_type: String,
}

/// An entry with its place in the journal.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// Its place.
    pub seq: Seq,
    /// The mission it belongs to; `None` between two.
    pub mission: Option<MissionId>,
    /// What happened, and when.
    pub entry: Entry,
    /// The photo that came with it.
    pub picture: Option<Picture>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct LineShape {
    seq: u64,
    /// For people; what counts is the two that follow.
    #[serde(default)]
    at: String,
    unix_ms: i64,
    offset_s: i32,
    mission: Option<u64>,
    #[serde(flatten)]
    fact: Shape,
}

/// A line in a list of entries, as its schema has it: what else is in it follows from its kind (`docs/journal.md`).
#[derive(JsonSchema)]
#[schemars(rename = "Entry", rename_all = "camelCase")]
#[expect(dead_code, reason = "it is there for its schema: a list is put together of lines that are written already")]
pub struct ListedLine {
    /// Its place in the journal.
    seq: u64,
    /// When it was written, RFC 3339 with zone; absent, as what follows, where the entry cannot be understood.
    #[schemars(skip_serializing_if = "Option::is_none")]
    at: Option<String>,
    /// The same in milliseconds since 1970, and the offset of its zone in seconds.
    #[schemars(skip_serializing_if = "Option::is_none")]
    unix_ms: Option<i64>,
    #[schemars(skip_serializing_if = "Option::is_none")]
    offset_s: Option<i32>,
    /// The mission it belongs to; null between two.
    #[schemars(skip_serializing_if = "Option::is_none")]
    mission: Option<u64>,
    /// What kind of entry it is; `unreadable` with the reason as `why` where it cannot be understood.
    kind: String,
}

impl Picture {
    /// Whether the digest is one: it becomes the name of a file.
    pub fn is_sound(&self) -> bool {
        self.digest.len() == 64 && self.digest.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
    }
}

/// A fact as the journal keeps it, a JSON object with its kind.
pub fn body(fact: &Fact, picture: Option<&Picture>) -> String {
    written(&Shape::of(fact, picture, Form::Codes))
}

/// The fact of a JSON object.
///
/// # Errors
/// What is wrong with it.
pub fn read_body(text: &str) -> Result<(Fact, Option<Picture>), Unparsed> {
    parsed::<Shape>(text.as_bytes())?.fact()
}

/// A line as it is exported, with sentences for what has a code in the journal; without a line break.
pub fn line(line: &Line) -> String {
    let WallTime { unix_ms, offset_s } = line.entry.wall;
    written(&LineShape {
        seq: line.seq.0,
        at: rfc3339(line.entry.wall),
        unix_ms,
        offset_s,
        mission: line.mission.map(|mission| mission.0),
        fact: Shape::of(&line.entry.fact, line.picture.as_ref(), Form::Sentences),
    })
}

/// The line that stands in the place of an entry that cannot be understood: its place, the kind `unreadable`, and why.
pub fn unreadable(seq: Seq, why: &str) -> String {
    format!("{{\"seq\":{seq},\"kind\":\"unreadable\",\"why\":{}}}", serde_json::Value::from(why))
}

/// Reads an exported line. A sentence that no version up to format 4 has said comes back as it is.
///
/// # Errors
/// What is wrong with it; any bytes give a line or that.
pub fn read_line(bytes: &[u8]) -> Result<Line, Unparsed> {
    let LineShape { seq, unix_ms, offset_s, mission, fact, .. } = parsed(bytes)?;
    let (fact, picture) = fact.fact()?;
    let entry = Entry { wall: WallTime { unix_ms, offset_s }, fact };
    Ok(Line { seq: Seq(seq), mission: mission.map(MissionId), entry, picture })
}

/// The record of a piece, with its verdict, as a JSON object.
pub fn record(record: &Luggage) -> String {
    written(&luggage::LuggageShape::from(record))
}

/// A moment as it stands in a record, as a JSON object.
pub fn moment(wall: WallTime) -> String {
    written(&places::Moment::from(wall))
}

/// The record of a piece from its JSON object.
///
/// # Errors
/// What is wrong with it.
pub fn read_record(text: &str) -> Result<Luggage, Unparsed> {
    parsed::<luggage::LuggageShape>(text.as_bytes())?.record()
}

fn written(shape: &impl Serialize) -> String {
    serde_json::to_string(shape).expect("the shapes have text for keys and write to memory, so that nothing can fail")
}

fn parsed<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Result<T, Unparsed> {
    serde_json::from_slice(bytes).map_err(|error| Unparsed(format!("it is not a fact of this version: {error}")))
}
