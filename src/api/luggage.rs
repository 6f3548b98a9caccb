//! Luggage records in JSON. The records do not contain the picture: `photo.url` says where it is.

use schemars::JsonSchema;
use serde::Serialize;

use super::robot::PositionJson;
use super::time::rfc3339;
use super::vocabulary;
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::{Decision, Luggage, PhotoState};

/// One record.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LuggageJson {
    /// Its number, never used for another piece.
    pub id: u64,
    /// `pending`, `safe` or `danger`.
    #[schemars(with = "vocabulary::Verdict")]
    pub verdict: &'static str,
    /// The cell of the bag.
    pub cell: PositionJson,
    /// The cell from which it was photographed.
    pub position: PositionJson,
    /// The way the robot faced then.
    #[schemars(with = "vocabulary::Heading")]
    pub heading: &'static str,
    /// When the photo was taken or failed, RFC 3339 with zone.
    pub taken: String,
    /// What became of the photo.
    pub photo: PhotoJson,
    /// Who decided and when, or null while it is pending.
    pub decided: Option<DecisionJson>,
    /// When it was put into the container, RFC 3339 with zone; null while it is in the hall.
    pub secured: Option<String>,
}

/// A photo, or why there is none; what does not apply is null.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PhotoJson {
    /// `taken` or `failed`.
    #[schemars(with = "vocabulary::PhotoState")]
    pub state: &'static str,
    /// Where it can be fetched. It changes with every take.
    pub url: Option<String>,
    /// Its size in bytes.
    pub bytes: Option<usize>,
    /// 1 for the first photo, more after a retake.
    pub take: Option<u32>,
    /// Why there is none.
    pub reason: Option<String>,
}

/// Who decided, when, and what was noted.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct DecisionJson {
    /// Who: the name of the key, and behind it in brackets the name that a person gave when signing in, as `operator (Anna)`.
    pub by: String,
    /// When, RFC 3339 with zone.
    pub at: String,
    /// What else was said of it, where something was.
    pub note: Option<String>,
}

/// Address of a piece's photo; it changes with every photo, so that nobody is shown the previous photo.
pub fn photo_url(luggage: &Luggage) -> Option<String> {
    match luggage.photo {
        PhotoState::Taken { take, .. } => Some(take_url(luggage.id, take)),
        PhotoState::Failed(_) => None,
    }
}

/// Address of one photo of a piece, by its number counted from 1.
pub fn take_url(luggage: LuggageId, take: u32) -> String {
    format!("/api/v1/luggage/{luggage}/photo?take={take}")
}

impl From<&Luggage> for LuggageJson {
    fn from(luggage: &Luggage) -> LuggageJson {
        LuggageJson {
            id: luggage.id.0,
            verdict: luggage.verdict_name(),
            cell: luggage.cell.into(),
            position: luggage.pose.cell.into(),
            heading: luggage.pose.heading.name(),
            taken: rfc3339(luggage.taken),
            photo: photo(luggage),
            decided: luggage.verdict.as_ref().map(DecisionJson::from),
            secured: luggage.secured.map(rfc3339),
        }
    }
}

impl From<&Decision> for DecisionJson {
    fn from(decision: &Decision) -> DecisionJson {
        let note = decision.note.as_ref().map(|note| note.text().to_owned());
        DecisionJson { by: decision.who.to_string(), at: rfc3339(decision.wall), note }
    }
}

fn photo(luggage: &Luggage) -> PhotoJson {
    let url = photo_url(luggage);
    match &luggage.photo {
        PhotoState::Taken { bytes, take } => {
            PhotoJson { state: "taken", url, bytes: Some(*bytes), take: Some(*take), reason: None }
        }
        PhotoState::Failed(reason) => PhotoJson { state: "failed", url, bytes: None, take: None, reason: Some(reason.clone()) },
    }
}
