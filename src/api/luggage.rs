//! Luggage records in JSON. A record does not contain the photo: `photo.url` says where the photo is.

use schemars::JsonSchema;
use serde::Serialize;

use super::address::address;
use super::robot::PositionJson;
use super::time::rfc3339;
use super::vocabulary;
use hallsweep_core::bomb_size::BombSize;
use hallsweep_core::command::{Hot, HotAnswer};
use hallsweep_core::hall::HallId;
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::{Decision, Doubt, Judgement, Luggage, PhotoState};

/// Record of a piece of luggage.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct LuggageJson {
    /// Number of the piece, never used for another piece.
    pub id: u64,
    /// Verdict: `pending`, `safe` or `danger`.
    #[schemars(with = "vocabulary::Verdict")]
    pub verdict: &'static str,
    /// Cell of the piece.
    pub cell: PositionJson,
    /// Cell from which the piece was photographed.
    pub position: PositionJson,
    /// Direction in which the robot faced for the photo.
    #[schemars(with = "vocabulary::Heading")]
    pub heading: &'static str,
    /// Time at which the photo was taken or failed, RFC 3339 with zone.
    pub taken: String,
    /// The photo, or the reason why the photo failed.
    pub photo: PhotoJson,
    /// Decision on the piece; null while the verdict is pending.
    pub decided: Option<DecisionJson>,
    /// Answers of judges who were unsure, the latest last; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub unsure: Vec<DecisionJson>,
    /// Answers of other judges, which were kept back until the verdict; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub judged: Vec<JudgementJson>,
    /// Whether this is a test piece of an exercise; absent until the exercise is over, and outside exercises.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub test: Option<bool>,
    /// Time at which the piece was put into the container, RFC 3339 with zone; null while the piece is in the hall.
    pub secured: Option<String>,
}

/// A photo, or the reason why the photo failed; fields that do not apply are null.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PhotoJson {
    /// Result: `taken` or `failed`.
    #[schemars(with = "vocabulary::PhotoState")]
    pub state: &'static str,
    /// Address of the photo. Each photo of a piece has an address of its own.
    pub url: Option<String>,
    /// Size of the photo, in bytes.
    pub bytes: Option<usize>,
    /// Number of the photo, counted from 1; each retake adds one.
    pub take: Option<u32>,
    /// Reason why the photo failed.
    pub reason: Option<String>,
}

/// Answer about a piece: sender, time and note.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct DecisionJson {
    /// Name of the key. If a person gave a name when signing in, this name follows in brackets, as `operator (Anna)`.
    pub by: String,
    /// Time of the decision, RFC 3339 with zone.
    pub at: String,
    /// Remark of the operator, or null.
    pub note: Option<String>,
    #[serde(flatten)]
    pub hot: HotJson,
}

/// Answers about a piece; a question that was not answered is absent.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct HotJson {
    /// Is the piece hidden?
    #[schemars(with = "Option<vocabulary::HotAnswer>")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hidden: Option<&'static str>,
    /// Is the piece obviously suspicious?
    #[schemars(with = "Option<vocabulary::HotAnswer>")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub obvious: Option<&'static str>,
    /// Is the piece typical of this place?
    #[schemars(with = "Option<vocabulary::HotAnswer>")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub typical: Option<&'static str>,
    /// How large the bomb may be: `pipe`, `vest`, `suitcase`, `car`, or a radius in metres such as `120`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<String>,
    /// Distance from the bomb that everybody must keep, in metres; absent without a size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mandatory_m: Option<u16>,
    /// Distance from the bomb within which people outdoors must go into a building, in metres; absent without a size of
    /// the table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preferred_m: Option<u16>,
}

/// Answer of one of two judges, which was kept back until the verdict.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct JudgementJson {
    /// Answer: `safe` or `danger`.
    #[schemars(with = "vocabulary::VerdictWord")]
    pub verdict: &'static str,
    #[serde(flatten)]
    pub decided: DecisionJson,
}

/// Address of the newest photo of a piece; `None` if the photo failed. The address changes with every photo, so that
/// nobody sees the previous photo.
pub fn photo_url(luggage: &Luggage) -> Option<String> {
    match luggage.photo {
        PhotoState::Taken { take, .. } => Some(take_url(luggage.id, take)),
        PhotoState::Failed(_) => None,
    }
}

/// Address of one photo of a piece. `take` is the number of the photo, counted from 1.
pub fn take_url(luggage: LuggageId, take: u32) -> String {
    format!("/api/v1/luggage/{luggage}/photo?take={take}")
}

impl LuggageJson {
    /// A piece of this hall.
    pub fn new(luggage: &Luggage, hall: Option<&HallId>) -> LuggageJson {
        LuggageJson {
            id: luggage.id.0,
            verdict: luggage.verdict_name(),
            cell: luggage.cell.into(),
            position: luggage.pose.cell.into(),
            heading: luggage.pose.heading.name(),
            taken: rfc3339(luggage.taken),
            photo: photo(luggage, hall),
            decided: luggage.verdict.as_ref().map(DecisionJson::from),
            unsure: luggage.unsure.iter().map(DecisionJson::from).collect(),
            judged: luggage.judged.iter().map(JudgementJson::from).collect(),
            test: luggage.truth,
            secured: luggage.secured.map(rfc3339),
        }
    }
}

impl From<&Decision> for DecisionJson {
    fn from(decision: &Decision) -> DecisionJson {
        let note = decision.note.as_ref().map(|note| note.text().to_owned());
        DecisionJson { by: decision.who.to_string(), at: rfc3339(decision.wall), note, hot: decision.hot.into() }
    }
}

impl From<&Doubt> for DecisionJson {
    fn from(doubt: &Doubt) -> DecisionJson {
        let note = doubt.note.as_ref().map(|note| note.text().to_owned());
        DecisionJson { by: doubt.who.to_string(), at: rfc3339(doubt.wall), note, hot: doubt.hot.into() }
    }
}

impl From<Hot> for HotJson {
    fn from(hot: Hot) -> HotJson {
        let [hidden, obvious, typical] = hot.answers().map(|(_, answer)| answer.map(HotAnswer::name));
        HotJson {
            hidden,
            obvious,
            typical,
            size: hot.size.map(|size| size.to_string()),
            mandatory_m: hot.size.map(BombSize::mandatory_m),
            preferred_m: hot.size.and_then(BombSize::preferred_m),
        }
    }
}

impl From<&Judgement> for JudgementJson {
    fn from(Judgement { verdict, issuer, note, hot, wall, .. }: &Judgement) -> JudgementJson {
        let note = note.as_ref().map(|note| note.text().to_owned());
        let decided = DecisionJson { by: issuer.who.to_string(), at: rfc3339(*wall), note, hot: (*hot).into() };
        JudgementJson { verdict: verdict.name(), decided }
    }
}

fn photo(luggage: &Luggage, hall: Option<&HallId>) -> PhotoJson {
    let url = photo_url(luggage).map(|url| address(hall, &url));
    match &luggage.photo {
        PhotoState::Taken { bytes, take } => {
            PhotoJson { state: "taken", url, bytes: Some(*bytes), take: Some(*take), reason: None }
        }
        PhotoState::Failed(reason) => PhotoJson { state: "failed", url, bytes: None, take: None, reason: Some(reason.clone()) },
    }
}
