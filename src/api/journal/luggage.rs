//! Luggage records and alarms in the journal. A field that earlier versions did not have is left out if it has no
//! value. A record without such values is thus written as in earlier versions.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::coded::{CodeOrSentence, Form};
use super::places::{Moment, Point, PoseShape};
use super::{Unparsed, names, written};
use crate::api::is_default;
use hallsweep_core::command::{Hot, Issuer};
use hallsweep_core::units::{AlarmId, LuggageId, Piece};
use hallsweep_core::world::alarm::Alarm;
use hallsweep_core::world::luggage::{Decision, Doubt, Judgement, Luggage, PhotoState};

#[derive(Serialize, Deserialize)]
pub(super) struct LuggageShape {
    pub(super) id: u64,
    cell: Point,
    pose: PoseShape,
    taken: Moment,
    /// Time of the first photo, if a later photo is stored.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    first_taken: Option<Moment>,
    photo: PhotoShape,
    /// Where the robot took earlier photos.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    seen_from: Vec<PoseShape>,
    verdict: Option<DecisionShape>,
    /// Answers of judges who were unsure.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    unsure: Vec<DoubtShape>,
    /// Answers of other judges, which were kept back until the verdict.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    judged: Vec<JudgementShape>,
    /// Whether this is a test piece of an exercise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    truth: Option<bool>,
    piece: Option<u32>,
    /// Time at which the piece was put into the container.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    secured: Option<Moment>,
    #[serde(default, skip_serializing_if = "is_default")]
    clock_set_ms: i64,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
enum PhotoShape {
    Taken { bytes: usize, take: u32 },
    Failed(String),
}

#[derive(Serialize, Deserialize)]
struct DecisionShape {
    verdict: String,
    #[serde(flatten)]
    answer: DoubtShape,
}

/// Who answered about a piece, and what, beside a verdict.
#[derive(Serialize, Deserialize)]
struct DoubtShape {
    who: String,
    when: Moment,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    note: Option<String>,
    #[serde(flatten)]
    hot: HotShape,
}

/// The answers about a piece. A question that was not answered is left out.
#[derive(Serialize, Deserialize)]
pub(super) struct HotShape {
    #[serde(default, skip_serializing_if = "Option::is_none")]
    hidden: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    obvious: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    typical: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    size: Option<String>,
}

/// The answer of one judge, in the journal and in the file of answers that are kept back.
#[derive(Serialize, Deserialize)]
pub(super) struct JudgementShape {
    luggage: u64,
    verdict: String,
    door: String,
    who: String,
    from: String,
    when: Moment,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    note: Option<String>,
    #[serde(flatten)]
    hot: HotShape,
    taken: Moment,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    id: Option<String>,
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    bare: bool,
}

#[derive(Serialize, Deserialize)]
pub(super) struct AlarmShape {
    id: u64,
    raised: Moment,
    text: CodeOrSentence,
    luggage: Option<u64>,
    acknowledged: Option<SeenShape>,
}

#[derive(Serialize, Deserialize)]
struct SeenShape {
    who: String,
    when: Moment,
}

impl From<&Luggage> for LuggageShape {
    fn from(luggage: &Luggage) -> LuggageShape {
        LuggageShape {
            id: luggage.id.0,
            cell: luggage.cell.into(),
            pose: luggage.pose.into(),
            taken: luggage.taken.into(),
            first_taken: (luggage.first_taken != luggage.taken).then(|| luggage.first_taken.into()),
            photo: match &luggage.photo {
                PhotoState::Taken { bytes, take } => PhotoShape::Taken { bytes: *bytes, take: *take },
                PhotoState::Failed(words) => PhotoShape::Failed(words.clone()),
            },
            seen_from: luggage.seen_from.iter().copied().map(PoseShape::from).collect(),
            verdict: luggage.verdict.as_ref().map(DecisionShape::from),
            unsure: luggage.unsure.iter().map(DoubtShape::from).collect(),
            judged: luggage.judged.iter().map(JudgementShape::from).collect(),
            truth: luggage.truth,
            piece: luggage.piece.map(|piece| piece.0),
            secured: luggage.secured.map(Moment::from),
            clock_set_ms: luggage.clock_set_ms,
        }
    }
}

impl LuggageShape {
    pub(super) fn record(self) -> Result<Luggage, Unparsed> {
        let taken = self.taken.into();
        Ok(Luggage {
            id: LuggageId(self.id),
            cell: self.cell.into(),
            pose: self.pose.pose()?,
            taken,
            first_taken: self.first_taken.map_or(taken, Into::into),
            photo: match self.photo {
                PhotoShape::Taken { bytes, take } => PhotoState::Taken { bytes, take },
                PhotoShape::Failed(words) => PhotoState::Failed(words),
            },
            seen_from: self.seen_from.into_iter().map(|pose| pose.pose()).collect::<Result<_, _>>()?,
            verdict: self.verdict.map(DecisionShape::decision).transpose()?,
            unsure: self.unsure.into_iter().map(DoubtShape::doubt).collect::<Result<_, _>>()?,
            judged: self.judged.into_iter().map(JudgementShape::judgement).collect::<Result<_, _>>()?,
            truth: self.truth,
            piece: self.piece.map(Piece),
            secured: self.secured.map(Into::into),
            clock_set_ms: self.clock_set_ms,
        })
    }
}

impl From<&Decision> for DecisionShape {
    fn from(decision: &Decision) -> DecisionShape {
        let Decision { verdict, who, wall, note, hot } = decision.clone();
        DecisionShape { verdict: verdict.name().to_owned(), answer: (&Doubt { who, wall, note, hot }).into() }
    }
}

impl DecisionShape {
    fn decision(self) -> Result<Decision, Unparsed> {
        let Doubt { who, wall, note, hot } = self.answer.doubt()?;
        Ok(Decision { verdict: names::verdict(&self.verdict)?, who, wall, note, hot })
    }
}

impl From<&Doubt> for DoubtShape {
    fn from(Doubt { who, wall, note, hot }: &Doubt) -> DoubtShape {
        let note = note.as_ref().map(|note| note.text().to_owned());
        DoubtShape { who: who.to_string(), when: (*wall).into(), note, hot: (*hot).into() }
    }
}

impl DoubtShape {
    fn doubt(self) -> Result<Doubt, Unparsed> {
        Ok(Doubt { who: self.who.into(), wall: self.when.into(), note: names::note(self.note)?, hot: self.hot.hot()? })
    }
}

impl From<Hot> for HotShape {
    fn from(hot: Hot) -> HotShape {
        let [hidden, obvious, typical] = hot.answers().map(|(_, answer)| answer.map(|answer| answer.name().to_owned()));
        HotShape { hidden, obvious, typical, size: hot.size.map(|size| size.to_string()) }
    }
}

impl HotShape {
    pub(super) fn hot(self) -> Result<Hot, Unparsed> {
        let read = |answer: Option<String>| answer.map(|answer| names::hot_answer(&answer)).transpose();
        let size = self.size.map(|size| names::bomb_size(&size)).transpose()?;
        Ok(Hot { hidden: read(self.hidden)?, obvious: read(self.obvious)?, typical: read(self.typical)?, size })
    }
}

impl From<&Judgement> for JudgementShape {
    fn from(Judgement { luggage, verdict, issuer, note, hot, wall, taken, id, is_bare }: &Judgement) -> JudgementShape {
        JudgementShape {
            luggage: luggage.0,
            verdict: verdict.name().to_owned(),
            door: issuer.door.0.to_owned(),
            who: issuer.who.to_string(),
            from: issuer.from.to_string(),
            when: (*wall).into(),
            note: note.as_ref().map(|note| note.text().to_owned()),
            hot: (*hot).into(),
            taken: (*taken).into(),
            id: id.as_ref().map(|id| id.text().to_owned()),
            bare: *is_bare,
        }
    }
}

impl JudgementShape {
    pub(super) fn judgement(self) -> Result<Judgement, Unparsed> {
        Ok(Judgement {
            luggage: LuggageId(self.luggage),
            verdict: names::verdict(&self.verdict)?,
            issuer: Issuer { door: names::door(&self.door)?, who: self.who.into(), from: self.from.into() },
            note: names::note(self.note)?,
            hot: self.hot.hot()?,
            wall: self.when.into(),
            taken: self.taken.into(),
            id: names::command_id(self.id)?,
            is_bare: self.bare,
        })
    }
}

pub fn written_decision(decision: &Decision) -> String {
    written(&DecisionShape::from(decision))
}

pub fn written_doubt(doubt: &Doubt) -> String {
    written(&DoubtShape::from(doubt))
}

pub fn written_judgement(judgement: &Judgement) -> String {
    written(&JudgementShape::from(judgement))
}

/// Writes answers that are kept back, for a file of their own.
pub fn written_answers(answers: &[Judgement]) -> String {
    written(&answers.iter().map(JudgementShape::from).collect::<Vec<_>>())
}

pub fn read_answers(text: &str) -> Result<Vec<Judgement>, Unparsed> {
    let shapes: Vec<JudgementShape> = serde_json::from_str(text).map_err(|error| Unparsed(error.to_string()))?;
    shapes.into_iter().map(JudgementShape::judgement).collect()
}

impl AlarmShape {
    pub(super) fn of(alarm: &Alarm, form: Form) -> AlarmShape {
        let seen = alarm.acknowledged.as_ref();
        AlarmShape {
            id: alarm.id.0,
            raised: alarm.raised.into(),
            text: CodeOrSentence::of(&alarm.cause, form),
            luggage: alarm.luggage.map(|id| id.0),
            acknowledged: seen.map(|(who, wall)| SeenShape { who: who.to_string(), when: (*wall).into() }),
        }
    }

    pub(super) fn alarm(self) -> Result<Alarm, Unparsed> {
        Ok(Alarm {
            id: AlarmId(self.id),
            raised: self.raised.into(),
            cause: self.text.value()?,
            luggage: self.luggage.map(LuggageId),
            acknowledged: self.acknowledged.map(|seen| (Arc::from(seen.who), seen.when.into())),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::{TEN, piece};
    use hallsweep_core::units::{Cell, WallTime};

    #[test]
    fn a_record_of_before_waits_since_its_photo_and_a_later_photo_leaves_that_on_record() {
        let first = piece(1, Cell::HOME, None);
        let written = serde_json::to_string(&LuggageShape::from(&*first)).unwrap();
        assert!(!written.contains("first_taken"), "as it was written before: {written}");
        let read = |text: &str| serde_json::from_str::<LuggageShape>(text).unwrap().record().unwrap();
        assert_eq!(read(&written), *first);
        let later = Luggage { taken: WallTime { unix_ms: TEN.unix_ms + 60_000, ..TEN }, ..Luggage::clone(&first) };
        let read = read(&serde_json::to_string(&LuggageShape::from(&later)).unwrap());
        assert_eq!((read.waits_since(), read.taken), (TEN, later.taken));
    }
}
