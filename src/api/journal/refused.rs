//! Reasons of refusals in the journal. A refusal that a door wrote in its own words is stored with its code and these
//! words.

use serde_json::{Value, json};

use super::closing::OpenShape;
use super::coded::{Coded, Form};
use super::phase::CauseShape;
use super::places::Point;
use super::{Unparsed, earlier, names};
use crate::api::problem::refusal;
use hallsweep_core::command::CommandId;
use hallsweep_core::refused::{OTHER_CONTENT, Refused};
use hallsweep_core::units::{AlarmId, Epoch, LuggageId, MissionId};

pub(super) fn written(refused: &Refused, form: Form) -> Coded {
    let fields = match refused {
        _ if form == Form::Sentences => json!({ "words": refused.to_string() }),
        Refused::Held(holds, store_failure) => {
            json!({ "holds": holds.iter().map(|hold| hold.name()).collect::<Vec<_>>(), "storeFailure": store_failure })
        }
        Refused::Outdated { sent, now } => json!({ "sent": sent.0, "now": now.0 }),
        Refused::NotInPhase(phase) => json!({ "phase": phase.name() }),
        Refused::IntoObstacle(cell) => json!({ "cell": Point::from(*cell) }),
        Refused::VerdictPending(id)
        | Refused::BombUnfetched(id)
        | Refused::UnknownLuggage(id)
        | Refused::NotABomb(id)
        | Refused::NoPhoto(id)
        | Refused::HotUnanswered(id)
        | Refused::NotInspected(id) => json!({ "luggage": id.0 }),
        Refused::Decided { luggage, verdict } => json!({ "luggage": luggage.0, "verdict": verdict.name() }),
        Refused::UnknownAlarm(id) => json!({ "alarm": id.0 }),
        Refused::FetcherUnreached(robot) | Refused::FetcherAbroad(robot) => json!({ "robot": robot.name() }),
        Refused::FaultStands(fault) => json!({ "fault": CauseShape::of(fault, form) }),
        Refused::OtherContent(id) => json!({ "id": id.text() }),
        Refused::OpenPoints { mission, open } => json!({ "mission": mission.0, "open": OpenShape::from(**open) }),
        Refused::OtherMission(mission) => json!({ "mission": mission.0 }),
        Refused::AreaTooLarge(most) => json!({ "most": most }),
        Refused::UnknownArea(area) | Refused::AreaClosed(area) => json!({ "area": &**area }),
        Refused::UnknownSensor(sensor) => json!({ "sensor": &**sensor }),
        Refused::NotAllowed(_) | Refused::InWords(_) => json!({ "words": refused.to_string() }),
        Refused::SentBefore
        | Refused::Driving
        | Refused::NotStopped
        | Refused::NotCapable
        | Refused::Moving
        | Refused::Unrecorded
        | Refused::NothingPending
        | Refused::PhotoUnderWay
        | Refused::NoRetrievalRobot
        | Refused::ExerciseOver
        | Refused::NothingSearched
        | Refused::StoreDown
        | Refused::NotKept
        | Refused::NotOnRecord => Value::Null,
    };
    Coded::new(refused.code(), fields)
}

/// Reads a refusal. A sentence beside the code occurs only in three cases: a door refused in its own words, an
/// earlier version wrote the refusal, or the line was exported.
pub(super) fn read(coded: &Coded) -> Result<Refused, Unparsed> {
    let Some(words) = coded.field::<Option<String>>("words")? else { return value(coded) };
    let earlier = earlier::refused(&coded.code, &words).and_then(|coded| value(&coded).ok());
    Ok(earlier.unwrap_or_else(|| Refused::InWords(refusal(&coded.code, words))))
}

fn value(coded: &Coded) -> Result<Refused, Unparsed> {
    let luggage = || coded.field("luggage").map(LuggageId);
    let robot = || names::robot(&coded.field::<String>("robot")?);
    let id = |text: String| CommandId::new(&text).ok_or_else(|| Unparsed("the earlier command id is not valid".to_owned()));
    Ok(match &*coded.code {
        "held" => {
            let holds = coded.field::<Vec<String>>("holds")?;
            let holds = holds.iter().map(|name| names::hold(name)).collect::<Result<_, _>>()?;
            Refused::Held(holds, coded.field("storeFailure")?)
        }
        "outdated" => Refused::Outdated { sent: Epoch(coded.field("sent")?), now: Epoch(coded.field("now")?) },
        "sentBefore" => Refused::SentBefore,
        "notInPhase" => Refused::NotInPhase(names::phase(&coded.field::<String>("phase")?)?),
        "verdictPending" => Refused::VerdictPending(luggage()?),
        "driving" => Refused::Driving,
        "notStopped" => Refused::NotStopped,
        "intoObstacle" => Refused::IntoObstacle(coded.field::<Point>("cell")?.into()),
        "notCapable" => Refused::NotCapable,
        "moving" => Refused::Moving,
        "unrecorded" => Refused::Unrecorded,
        "bombUnfetched" => Refused::BombUnfetched(luggage()?),
        "unknownLuggage" => Refused::UnknownLuggage(luggage()?),
        "notABomb" => Refused::NotABomb(luggage()?),
        "nothingPending" => Refused::NothingPending,
        "decided" => Refused::Decided { luggage: luggage()?, verdict: names::verdict(&coded.field::<String>("verdict")?)? },
        "noPhoto" => Refused::NoPhoto(luggage()?),
        "hotUnanswered" => Refused::HotUnanswered(luggage()?),
        "notInspected" => Refused::NotInspected(luggage()?),
        "photoUnderWay" => Refused::PhotoUnderWay,
        "unknownAlarm" => Refused::UnknownAlarm(AlarmId(coded.field("alarm")?)),
        "noRetrievalRobot" => Refused::NoRetrievalRobot,
        "fetcherUnreached" => Refused::FetcherUnreached(robot()?),
        "fetcherAbroad" => Refused::FetcherAbroad(robot()?),
        "openPoints" => {
            let open = Box::new(coded.field::<OpenShape>("open")?.into());
            Refused::OpenPoints { mission: MissionId(coded.field("mission")?), open }
        }
        "otherMission" => Refused::OtherMission(MissionId(coded.field("mission")?)),
        "exerciseOver" => Refused::ExerciseOver,
        "nothingSearched" => Refused::NothingSearched,
        "areaTooLarge" => Refused::AreaTooLarge(coded.field("most")?),
        "unknownArea" => Refused::UnknownArea(names::area(coded.field("area")?)?),
        "areaClosed" => Refused::AreaClosed(names::area(coded.field("area")?)?),
        "faultStands" => Refused::FaultStands(coded.field::<CauseShape>("fault")?.cause()?),
        "storeDown" => Refused::StoreDown,
        "notKept" => Refused::NotKept,
        "notOnRecord" => Refused::NotOnRecord,
        OTHER_CONTENT => Refused::OtherContent(id(coded.field("id")?)?),
        "unknownSensor" => Refused::UnknownSensor(coded.field::<String>("sensor")?.into()),
        "notAllowed" => Refused::NotAllowed(coded.field("words")?),
        _ => return coded.unknown(),
    })
}
