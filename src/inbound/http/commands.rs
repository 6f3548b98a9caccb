//! The commands of `/api/v1`: each reads its body, gives one command and answers with its revision.
//! STOP reads no body at all: nothing that is wrong with a request may keep it from halting the robot.

use axum::extract::State;
use axum::response::{IntoResponse, Response};

use super::Door;
use super::problem::Problem;
use super::reading::{Json, Number, OptionalJson};
use crate::core::command::{self, Command, LuggageRef};
use crate::core::units::{AlarmId, Epoch, LuggageId};
use crate::wire::answer::AnswerJson;
use crate::wire::command::{EpochBody, GotoBody, MoveBody, StrategyBody, TemperatureBody, Unusable, VerdictBody};

type Answer = Result<Response, Problem>;

/// `POST commands/start`
pub(super) async fn start(State(door): State<Door>, OptionalJson(body): OptionalJson<EpochBody>) -> Answer {
    give(&door, Command::Start, body.epoch()).await
}

/// `POST commands/stop`
pub(super) async fn stop(State(door): State<Door>) -> Answer {
    give(&door, Command::Stop, None).await
}

/// `POST commands/backHome`
pub(super) async fn back_home(State(door): State<Door>, OptionalJson(body): OptionalJson<EpochBody>) -> Answer {
    give(&door, Command::BackHome, body.epoch()).await
}

/// `POST commands/retrieve`
pub(super) async fn retrieve(State(door): State<Door>, OptionalJson(body): OptionalJson<EpochBody>) -> Answer {
    give(&door, Command::Retrieve, body.epoch()).await
}

/// `POST commands/reset`
pub(super) async fn reset(State(door): State<Door>, OptionalJson(body): OptionalJson<EpochBody>) -> Answer {
    give(&door, Command::Reset, body.epoch()).await
}

/// `POST commands/move`
pub(super) async fn make_move(State(door): State<Door>, Json(body): Json<MoveBody>) -> Answer {
    let (command, epoch) = body.command()?;
    give(&door, command, epoch).await
}

/// `POST commands/goto`
pub(super) async fn goto(State(door): State<Door>, Json(body): Json<GotoBody>) -> Answer {
    let (command, epoch) = body.command()?;
    give(&door, command, epoch).await
}

/// `POST luggage/{id}/verdict`
pub(super) async fn verdict(State(door): State<Door>, Number(id): Number, Json(body): Json<VerdictBody>) -> Answer {
    let luggage = LuggageRef::Id(LuggageId(id));
    give(&door, Command::Verdict { luggage, verdict: body.verdict()? }, None).await
}

/// `POST luggage/{id}/photo`
pub(super) async fn retake(State(door): State<Door>, Number(id): Number, _: OptionalJson<EpochBody>) -> Answer {
    give(&door, Command::RetakePhoto(LuggageId(id)), None).await
}

/// `PUT strategy`
pub(super) async fn strategy(State(door): State<Door>, Json(body): Json<StrategyBody>) -> Answer {
    give(&door, Command::ChooseStrategy(body.strategy()?), None).await
}

/// `POST alarms/{id}/acknowledge`
pub(super) async fn acknowledge(State(door): State<Door>, Number(id): Number, _: OptionalJson<EpochBody>) -> Answer {
    give(&door, Command::Acknowledge(AlarmId(id)), None).await
}

/// `PUT temperature`
pub(super) async fn temperature(State(door): State<Door>, Json(body): Json<TemperatureBody>) -> Answer {
    give(&door, Command::Temperature(body.report()?), None).await
}

/// Gives a command by the interface and answers in JSON; the old console's routes end here too.
pub(super) async fn give(door: &Door, command: Command, epoch: Option<Epoch>) -> Answer {
    let done = door.give(command::Door::Http, command, epoch).await?;
    Ok(axum::Json(AnswerJson::new(done.accepted, &done.snapshot)).into_response())
}

impl From<Unusable> for Problem {
    fn from(unusable: Unusable) -> Problem {
        Problem::unusable(unusable.to_string())
    }
}
