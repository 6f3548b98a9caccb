//! One JSON shape for every fact. The name of a fact in JSON is its kind. The store finds entries by their kind.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::closing::{ClosedShape, OpenInAreaShape};
use super::coded::{CodeOrSentence, Coded, Form};
use super::conditions::ConditionsShape;
use super::luggage::{HotShape, JudgementShape, LuggageShape};
use super::names::SearchShape;
use super::phase::PhaseShape;
use super::places::{AgainShape, GoalShape, PoseShape};
use super::retrieval::RetrievalShape;
use super::standing::StandingShape;
use super::{Picture, Unparsed, map, names, places, refused, retrieval};
use hallsweep_core::command::Issuer;
use hallsweep_core::state::fact::{Fact, Unpacked, WrittenOut};
use hallsweep_core::units::{AlarmId, Cell, Epoch, LuggageId, MissionId, Piece, Seq};

#[derive(Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "camelCase", rename_all_fields = "camelCase")]
pub(super) enum Shape {
    ProgramStarted {
        version: String,
    },
    ProgramEnded {
        by: String,
    },
    ClockSet {
        by_ms: i64,
    },
    /// Missions `first` to `last`, and the entries up to `until`, are only in this archive file.
    WrittenOut {
        first: u64,
        last: u64,
        until: u64,
        file: String,
        digest: String,
    },
    /// All entries before this one come from this archive file. The archive file begins after the entry with the
    /// number `behind`. The page of the entry `behind` has the digest `page`.
    Unpacked {
        file: String,
        digest: String,
        behind: u64,
        page: String,
    },
    Conditions(ConditionsShape),
    Standing {
        standing: Box<StandingShape>,
    },
    Command(CommandShape),
    MissionBegan {
        number: u64,
        strategy: String,
    },
    MissionArchived {
        number: u64,
        left: Vec<u64>,
    },
    Phase {
        phase: PhaseShape,
    },
    Holds {
        holds: Vec<String>,
    },
    Epoch {
        epoch: u64,
    },
    Goal {
        goal: Option<GoalShape>,
        search: SearchShape,
    },
    Pose(PoseShape),
    RobotPose {
        robot: String,
        #[serde(flatten)]
        pose: PoseShape,
    },
    Outside {
        robot: String,
        steps: u8,
    },
    Retrieval {
        retrieval: Option<RetrievalShape>,
    },
    MetAgain {
        #[serde(deserialize_with = "places::side")]
        x: i32,
        #[serde(deserialize_with = "places::side")]
        y: i32,
        piece: u32,
    },
    Secured {
        luggage: u64,
    },
    Led {
        blinking: bool,
    },
    Obstacle {
        #[serde(deserialize_with = "places::side")]
        x: i32,
        #[serde(deserialize_with = "places::side")]
        y: i32,
        taken_for: String,
    },
    Mark {
        #[serde(deserialize_with = "places::side")]
        x: i32,
        #[serde(deserialize_with = "places::side")]
        y: i32,
        mark: String,
    },
    Luggage {
        luggage: LuggageShape,
        picture: Option<Picture>,
    },
    Verdict {
        luggage: u64,
        verdict: String,
        who: String,
        /// Absent in entries of versions that had no notes.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        note: Option<String>,
        #[serde(flatten)]
        hot: HotShape,
    },
    /// A judge could not tell from the photo.
    Unsure {
        luggage: u64,
        who: String,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        note: Option<String>,
        #[serde(flatten)]
        hot: HotShape,
    },
    /// The answer of another judge, which was kept back until this entry.
    Judged(JudgementShape),
    /// Whether a judged piece is a test piece of the exercise.
    Revealed {
        luggage: u64,
        test: bool,
    },
    /// The person in charge has closed the mission.
    Closed(ClosedShape),
    /// The mission and its record were handed over to this person or office.
    HandedOver {
        who: String,
        to: String,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        note: Option<String>,
    },
    /// These searched cells are to be searched again. A closed area is open again.
    SearchAgain(AgainShape),
    /// The names of the areas that are searched first.
    AreasOrdered {
        areas: Vec<String>,
    },
    /// The person in charge has closed an area.
    AreaClosed {
        area: String,
        closed: ClosedShape<OpenInAreaShape>,
    },
    Temperature {
        source: String,
        celsius: f64,
    },
    ThermometerSilent {
        source: String,
    },
    AlarmRaised {
        alarm: u64,
        luggage: Option<u64>,
        text: CodeOrSentence,
    },
    AlarmAcknowledged {
        alarm: u64,
        who: String,
    },
    Strategy {
        strategy: String,
    },
    MapEmptied {
        heading: String,
    },
}

#[derive(Serialize, Deserialize)]
pub(super) struct CommandShape {
    command: CodeOrSentence,
    door: String,
    who: String,
    from: String,
    id: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    epoch: Option<u64>,
    luggage: Option<u64>,
    refused: Option<Coded>,
}

/// The kind of a fact. The store finds entries by their kind.
pub const fn kind(fact: &Fact) -> &'static str {
    match fact {
        Fact::ProgramStarted(_) => "programStarted",
        Fact::ProgramEnded(_) => "programEnded",
        Fact::ClockSet(_) => "clockSet",
        Fact::WrittenOut(_) => "writtenOut",
        Fact::Unpacked(_) => "unpacked",
        Fact::Conditions(_) => "conditions",
        Fact::State(_) => "standing",
        Fact::Command { .. } => "command",
        Fact::MissionBegan(..) => "missionBegan",
        Fact::MissionArchived(..) => "missionArchived",
        Fact::Phase(_) => "phase",
        Fact::Holds(_) => "holds",
        Fact::Epoch(_) => "epoch",
        Fact::Goal(..) => "goal",
        Fact::Pose(_) => "pose",
        Fact::RobotPose(..) => "robotPose",
        Fact::Outside(..) => "outside",
        Fact::Retrieval(_) => "retrieval",
        Fact::MetAgain(..) => "metAgain",
        Fact::Secured(_) => "secured",
        Fact::Led(_) => "led",
        Fact::Obstacle(..) => "obstacle",
        Fact::Mark(..) => "mark",
        Fact::Luggage { .. } => "luggage",
        Fact::Verdict { .. } => "verdict",
        Fact::Unsure { .. } => "unsure",
        Fact::Judged(_) => "judged",
        Fact::Revealed { .. } => "revealed",
        Fact::Closed(_) => "closed",
        Fact::HandedOver { .. } => "handedOver",
        Fact::SearchAgain(_) => "searchAgain",
        Fact::AreasOrdered(_) => "areasOrdered",
        Fact::AreaClosed(..) => "areaClosed",
        Fact::Temperature(..) => "temperature",
        Fact::ThermometerSilent(_) => "thermometerSilent",
        Fact::AlarmRaised(..) => "alarmRaised",
        Fact::AlarmAcknowledged(..) => "alarmAcknowledged",
        Fact::Strategy(_) => "strategy",
        Fact::MapEmptied(_) => "mapEmptied",
    }
}

impl Shape {
    /// The shape of a fact. Of a photo, it has only the digest and the media type of the file.
    pub(super) fn of(fact: &Fact, picture: Option<&Picture>, form: Form) -> Shape {
        match fact {
            Fact::ProgramStarted(version) => Shape::ProgramStarted { version: version.clone() },
            Fact::ProgramEnded(by) => Shape::ProgramEnded { by: by.clone() },
            Fact::ClockSet(by_ms) => Shape::ClockSet { by_ms: *by_ms },
            Fact::WrittenOut(WrittenOut { missions: (first, last), until, file, digest }) => {
                Shape::WrittenOut { first: first.0, last: last.0, until: until.0, file: file.clone(), digest: digest.clone() }
            }
            Fact::Unpacked(Unpacked { file, digest, behind, page }) => {
                Shape::Unpacked { file: file.clone(), digest: digest.clone(), behind: behind.0, page: page.clone() }
            }
            Fact::Conditions(conditions) => Shape::Conditions(conditions.into()),
            Fact::State(state) => Shape::Standing { standing: Box::new(StandingShape::of(state, form)) },
            Fact::Command { issuer, id, asked, epoch, luggage, refused } => Shape::Command(CommandShape {
                command: CodeOrSentence::of(asked, form),
                door: issuer.door.0.to_owned(),
                who: issuer.who.to_string(),
                from: issuer.from.to_string(),
                id: id.as_ref().map(|id| id.text().to_owned()),
                epoch: epoch.map(|epoch| epoch.0),
                luggage: luggage.map(|id| id.0),
                refused: refused.as_ref().map(|refused| refused::written(refused, form)),
            }),
            Fact::MissionBegan(mission, strategy) => {
                Shape::MissionBegan { number: mission.0, strategy: strategy.name().to_owned() }
            }
            Fact::MissionArchived(mission, left) => {
                Shape::MissionArchived { number: mission.0, left: left.iter().map(|id| id.0).collect() }
            }
            Fact::Phase(phase) => Shape::Phase { phase: PhaseShape::of(phase, form) },
            Fact::Holds(holds) => Shape::Holds { holds: holds.iter().map(|hold| hold.name().to_owned()).collect() },
            Fact::Epoch(epoch) => Shape::Epoch { epoch: epoch.0 },
            Fact::Goal(goal, search) => Shape::Goal { goal: goal.map(GoalShape::from), search: search.into() },
            Fact::Pose(pose) => Shape::Pose((*pose).into()),
            Fact::RobotPose(robot, pose) => Shape::RobotPose { robot: robot.name().to_owned(), pose: (*pose).into() },
            Fact::Outside(robot, steps) => Shape::Outside { robot: robot.name().to_owned(), steps: *steps },
            Fact::Retrieval(retrieval) => {
                Shape::Retrieval { retrieval: retrieval.as_deref().map(|retrieval| RetrievalShape::of(retrieval, form)) }
            }
            Fact::MetAgain(Cell { x, y }, piece) => Shape::MetAgain { x: *x, y: *y, piece: piece.0 },
            Fact::Secured(luggage) => Shape::Secured { luggage: luggage.0 },
            Fact::Led(blinking) => Shape::Led { blinking: *blinking },
            Fact::Obstacle(Cell { x, y }, taken_for) => Shape::Obstacle { x: *x, y: *y, taken_for: (*taken_for).to_owned() },
            Fact::Mark(Cell { x, y }, mark) => Shape::Mark { x: *x, y: *y, mark: mark.name().to_owned() },
            Fact::Luggage { record, .. } => Shape::Luggage { luggage: (&**record).into(), picture: picture.cloned() },
            Fact::Unsure { luggage, who, note, hot } => Shape::Unsure {
                luggage: luggage.0,
                who: who.to_string(),
                note: note.as_ref().map(|note| note.text().to_owned()),
                hot: (*hot).into(),
            },
            Fact::Judged(judgement) => Shape::Judged((&**judgement).into()),
            Fact::Verdict { luggage, verdict, who, note, hot } => Shape::Verdict {
                luggage: luggage.0,
                verdict: verdict.name().to_owned(),
                who: who.to_string(),
                note: note.as_ref().map(|note| note.text().to_owned()),
                hot: (*hot).into(),
            },
            Fact::Revealed { luggage, is_test } => Shape::Revealed { luggage: luggage.0, test: *is_test },
            Fact::Closed(closed) => Shape::Closed((&**closed).into()),
            Fact::HandedOver { who, to, note } => Shape::HandedOver {
                who: who.to_string(),
                to: to.text().to_owned(),
                note: note.as_ref().map(|note| note.text().to_owned()),
            },
            Fact::SearchAgain(again) => Shape::SearchAgain(again.into()),
            Fact::AreasOrdered(order) => Shape::AreasOrdered { areas: order.iter().map(ToString::to_string).collect() },
            Fact::AreaClosed(area, closed) => Shape::AreaClosed { area: area.to_string(), closed: (&**closed).into() },
            Fact::Temperature(source, celsius) => Shape::Temperature { source: source.to_string(), celsius: celsius.degrees() },
            Fact::ThermometerSilent(source) => Shape::ThermometerSilent { source: source.to_string() },
            Fact::AlarmRaised(alarm, luggage, cause) => {
                Shape::AlarmRaised { alarm: alarm.0, luggage: luggage.map(|id| id.0), text: CodeOrSentence::of(cause, form) }
            }
            Fact::AlarmAcknowledged(alarm, who) => Shape::AlarmAcknowledged { alarm: alarm.0, who: who.to_string() },
            Fact::Strategy(strategy) => Shape::Strategy { strategy: strategy.name().to_owned() },
            Fact::MapEmptied(heading) => Shape::MapEmptied { heading: heading.name().to_owned() },
        }
    }

    /// Reads the fact, and the file of its photo. Only a luggage record has a photo.
    pub(super) fn fact(self) -> Result<(Fact, Option<Picture>), Unparsed> {
        let fact = match self {
            Shape::Luggage { luggage, picture } => {
                if picture.as_ref().is_some_and(|picture| !picture.is_sound()) {
                    return Err(Unparsed("the digest of the photo is not valid".to_owned()));
                }
                return Ok((Fact::Luggage { record: Arc::new(luggage.record()?), photo: None }, picture));
            }
            Shape::ProgramStarted { version } => Fact::ProgramStarted(version),
            Shape::ProgramEnded { by } => Fact::ProgramEnded(by),
            Shape::ClockSet { by_ms } => Fact::ClockSet(by_ms),
            Shape::WrittenOut { first, last, until, file, digest } => {
                let missions = (MissionId(first), MissionId(last));
                Fact::WrittenOut(WrittenOut { missions, until: Seq(until), file, digest })
            }
            Shape::Unpacked { file, digest, behind, page } => {
                Fact::Unpacked(Unpacked { file, digest, behind: Seq(behind), page })
            }
            Shape::Conditions(shape) => Fact::Conditions(shape.conditions()?),
            Shape::Standing { standing } => Fact::State(Box::new(standing.state()?)),
            Shape::Command(command) => command.fact()?,
            Shape::MissionBegan { number, strategy } => Fact::MissionBegan(MissionId(number), names::strategy(&strategy)?),
            Shape::MissionArchived { number, left } => {
                Fact::MissionArchived(MissionId(number), left.into_iter().map(LuggageId).collect())
            }
            Shape::Phase { phase } => Fact::Phase(phase.phase()?),
            Shape::Holds { holds } => Fact::Holds(holds.iter().map(|name| names::hold(name)).collect::<Result<_, _>>()?),
            Shape::Epoch { epoch } => Fact::Epoch(names::epoch(epoch)?),
            Shape::Goal { goal, search } => Fact::Goal(goal.map(Into::into), search.search()?),
            Shape::Pose(pose) => Fact::Pose(pose.pose()?),
            Shape::RobotPose { robot, pose } => Fact::RobotPose(names::robot(&robot)?, pose.pose()?),
            Shape::Outside { robot, steps } => Fact::Outside(names::robot(&robot)?, retrieval::steps(steps)?),
            Shape::Retrieval { retrieval } => {
                Fact::Retrieval(retrieval.map(RetrievalShape::retrieval).transpose()?.map(Box::new))
            }
            Shape::MetAgain { x, y, piece } => Fact::MetAgain(Cell::new(x, y), Piece(piece)),
            Shape::Secured { luggage } => Fact::Secured(LuggageId(luggage)),
            Shape::Led { blinking } => Fact::Led(blinking),
            Shape::Obstacle { x, y, taken_for } => Fact::Obstacle(Cell::new(x, y), names::taken_for(&taken_for)?),
            Shape::Mark { x, y, mark } => Fact::Mark(Cell::new(x, y), map::named(&mark)?),
            Shape::Unsure { luggage, who, note, hot } => {
                Fact::Unsure { luggage: LuggageId(luggage), who: who.into(), note: names::note(note)?, hot: hot.hot()? }
            }
            Shape::Judged(judgement) => Fact::Judged(Box::new(judgement.judgement()?)),
            Shape::Verdict { luggage, verdict, who, note, hot } => Fact::Verdict {
                luggage: LuggageId(luggage),
                verdict: names::verdict(&verdict)?,
                who: who.into(),
                note: names::note(note)?,
                hot: hot.hot()?,
            },
            Shape::Revealed { luggage, test } => Fact::Revealed { luggage: LuggageId(luggage), is_test: test },
            Shape::Closed(closed) => Fact::Closed(Box::new(closed.closed()?)),
            Shape::HandedOver { who, to, note } => {
                Fact::HandedOver { who: who.into(), to: names::name(to)?, note: names::note(note)? }
            }
            Shape::SearchAgain(again) => Fact::SearchAgain(again.again()?),
            Shape::AreasOrdered { areas } => Fact::AreasOrdered(names::areas(areas)?),
            Shape::AreaClosed { area, closed } => Fact::AreaClosed(names::area(area)?, Box::new(closed.closed()?)),
            Shape::Temperature { source, celsius } => Fact::Temperature(source.into(), names::celsius(celsius)?),
            Shape::ThermometerSilent { source } => Fact::ThermometerSilent(source.into()),
            Shape::AlarmRaised { alarm, luggage, text } => {
                Fact::AlarmRaised(AlarmId(alarm), luggage.map(LuggageId), text.value()?)
            }
            Shape::AlarmAcknowledged { alarm, who } => Fact::AlarmAcknowledged(AlarmId(alarm), who.into()),
            Shape::Strategy { strategy } => Fact::Strategy(names::strategy(&strategy)?),
            Shape::MapEmptied { heading } => Fact::MapEmptied(names::heading(&heading)?),
        };
        Ok((fact, None))
    }
}

impl CommandShape {
    fn fact(self) -> Result<Fact, Unparsed> {
        let issuer = Issuer { door: names::door(&self.door)?, who: self.who.into(), from: self.from.into() };
        Ok(Fact::Command {
            issuer,
            id: names::command_id(self.id)?,
            asked: self.command.value()?,
            epoch: self.epoch.map(Epoch),
            luggage: self.luggage.map(LuggageId),
            refused: self.refused.map(|refused| refused::read(&refused)).transpose()?,
        })
    }
}
