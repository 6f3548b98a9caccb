//! The JSON shapes of the journal. Every fact is written as JSON and read back, for the table of events and for
//! export with one object per line. In the table, requests, refusals and causes are codes with fields (`coded`),
//! which do not depend on wording. Exported lines have sentences instead. The store stores the lines. For a photo, a
//! line has only the digest of the file.
//!
//! ```text
//!   {"seq":12,"at":"2026-02-03T10:05:12.000+01:00","unixMs":1770109512000,"offsetS":3600,"mission":3,
//!    "kind":"phase","phase":{"name":"exploring"}}
//! ```
//! Unknown fields are skipped when a line is read, so that a later version may add fields. Unknown values are
//! refused.

mod asked;
mod causes;
mod closing;
mod coded;
mod conditions;
mod coverage;
mod earlier;
mod fact;
mod luggage;
mod map;
mod names;
mod phase;
mod places;
mod refused;
mod retrieval;
mod rows;
mod standing;
mod team;

#[cfg(test)]
pub(crate) mod tests;

pub use closing::{OpenInAreaShape, OpenShape};
pub use conditions::ConditionsShape;
pub use fact::kind;
pub use luggage::{read_answers, written_answers, written_decision, written_doubt, written_judgement};

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use self::coded::Form;
use self::fact::Shape;
use super::time::rfc3339;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{MissionId, Seq, WallTime};
use hallsweep_core::world::luggage::Luggage;

/// Why a stored text cannot be read as a fact, as a sentence.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Unparsed(pub(super) String);

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct Picture {
    /// SHA-256 of the file, in 64 lower-case hexadecimal digits.
    pub digest: String,
    /// Media type, as `image/png`.
    pub media_type: String,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    pub seq: Seq,
    /// `None` between two missions.
    pub mission: Option<MissionId>,
    pub entry: Entry,
    /// The file of a photo. Only luggage records have a photo.
    pub picture: Option<Picture>,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
struct LineShape {
    seq: u64,
    /// The time for people. Programs read the next two fields.
    #[serde(default)]
    at: String,
    unix_ms: i64,
    offset_s: i32,
    mission: Option<u64>,
    #[serde(flatten)]
    fact: Shape,
}

/// A line in a list of entries, with further fields that depend on the kind (`docs/journal.md`). An entry that cannot
/// be understood has only `seq`, `kind` and `why`.
#[derive(JsonSchema)]
#[schemars(rename = "Entry", rename_all = "camelCase")]
#[expect(dead_code, reason = "it is there for its schema: a list is put together of lines that are written already")]
pub struct ListedLine {
    /// Number of the entry in the journal.
    seq: u64,
    /// Time of writing, RFC 3339 with zone.
    #[schemars(skip_serializing_if = "Option::is_none")]
    at: Option<String>,
    /// Time of writing, in milliseconds since 1970 (UTC).
    #[schemars(skip_serializing_if = "Option::is_none")]
    unix_ms: Option<i64>,
    /// Offset of the time zone from UTC, in seconds.
    #[schemars(skip_serializing_if = "Option::is_none")]
    offset_s: Option<i32>,
    /// Mission of the entry; null between two missions.
    #[schemars(skip_serializing_if = "Option::is_none")]
    mission: Option<u64>,
    /// Kind of the entry. An entry that cannot be understood has the kind `unreadable`, and the reason as `why`.
    kind: String,
}

impl Picture {
    /// Whether the digest has the right form. This matters because the digest becomes the name of a file.
    pub fn is_sound(&self) -> bool {
        self.digest.len() == 64 && self.digest.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'))
    }
}

/// Writes a fact as the journal stores it: a JSON object with the kind of the fact.
pub fn body(fact: &Fact, picture: Option<&Picture>) -> String {
    written(&Shape::of(fact, picture, Form::Codes))
}

pub fn read_body(text: &str) -> Result<(Fact, Option<Picture>), Unparsed> {
    parsed::<Shape>(text.as_bytes())?.fact()
}

/// Writes a line for export. The line has sentences in place of the journal's codes, and no line break.
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

/// Writes the line for an entry that cannot be understood: its number, the kind `unreadable`, and the reason.
pub fn unreadable(seq: Seq, why: &str) -> String {
    format!("{{\"seq\":{seq},\"kind\":\"unreadable\",\"why\":{}}}", serde_json::Value::from(why))
}

/// Reads an exported line. A sentence that no version up to format 4 wrote is read as `words`. Any bytes yield a
/// line, or an error that says what is wrong with the line.
pub fn read_line(bytes: &[u8]) -> Result<Line, Unparsed> {
    let LineShape { seq, unix_ms, offset_s, mission, fact, .. } = parsed(bytes)?;
    let (fact, picture) = fact.fact()?;
    let entry = Entry { wall: WallTime { unix_ms, offset_s }, fact };
    Ok(Line { seq: Seq(seq), mission: mission.map(MissionId), entry, picture })
}

pub fn record(record: &Luggage) -> String {
    written(&luggage::LuggageShape::from(record))
}

pub fn moment(wall: WallTime) -> String {
    written(&places::Moment::from(wall))
}

pub fn read_record(text: &str) -> Result<Luggage, Unparsed> {
    parsed::<luggage::LuggageShape>(text.as_bytes())?.record()
}

fn written(shape: &impl Serialize) -> String {
    serde_json::to_string(shape).expect("the shapes have text for keys and write to memory, so that nothing can fail")
}

fn parsed<'a, T: Deserialize<'a>>(bytes: &'a [u8]) -> Result<T, Unparsed> {
    serde_json::from_slice(bytes).map_err(|error| Unparsed(format!("this version cannot read the entry: {error}")))
}
