//! The simulator's controls, if the searching robot is simulated. They are JSON here, and pages in `page` and
//! `editor`. The core and the simulator decide what may be changed. This file adds who sent the request.

mod editor;
mod page;

use std::sync::Arc;

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use axum::http::{Method, header};
use axum::response::{IntoResponse, Response};

use super::HttpDoor;
use super::gate::issuer;
use super::language::spoken;
use super::peer::{LetIn, Peer};
use super::problem::{Problem, in_words};
use super::query::Query;
use super::reading::{HallFile, HallPayload, JsonPayload, Named};
use crate::access::Need;
use crate::api::commands::Payload;
use crate::api::door;
use crate::api::fields::in_short;
use crate::api::hall_files::{self, ReadHall};
use crate::api::problem::ProblemKind;
use crate::api::simulator::{ChangeBody, HallBody, SimulatorJson};
use crate::phrases::Language;
use crate::runtime::simulator::{NotSimulated, Simulator, SimulatorState};
use hallsweep_core::command::{Door, Issuer};
use hallsweep_core::refused::Refused;

pub(super) use editor::{act, editor};
pub(super) use page::{change_by_form, choose_by_form, page};

type PageAnswer = Result<Response, Problem>;

/// Problem code for the core's refusal to move robots to another hall during a mission.
const NOT_IN_PHASE: &str = "notInPhase";

/// Problem code for the refusal to replace a stored hall without confirmation.
const ANOTHER_KEPT: &str = "anotherKept";

pub(super) struct Asker {
    door: HttpDoor,
    simulator: Arc<dyn Simulator>,
    caller: crate::access::Caller,
    peer: Peer,
    language: Language,
}

impl<S: Send + Sync> FromRequestParts<S> for Asker {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, state: &S) -> Result<Asker, Problem> {
        let LetIn(caller) = LetIn::from_request_parts(parts, state).await?;
        let peer = Peer::from_request_parts(parts, state).await?;
        let door = HttpDoor::from_request_parts(parts, state).await?;
        let simulator = door.hall.simulator.clone().ok_or_else(|| {
            let detail = "the searching robot is not simulated, so there is no simulator to control".to_owned();
            Problem::new(("notSimulated", ProblemKind::NotFound), detail)
        })?;
        let mission = &door.hall.handle.snapshot().mission;
        let is_reading = matches!(parts.method, Method::GET | Method::HEAD);
        if mission.is_truth_hidden || mission.is_exercise && !is_reading {
            let detail = "an exercise runs, and the simulator would tell which pieces are test pieces: it is shown when every piece \
                          has its verdict or the mission is closed, and can be changed after a start without --exercise";
            return Err(Problem::new(("exerciseRunning", ProblemKind::Conflict), detail.to_owned()));
        }
        Ok(Asker { door, simulator, caller, peer, language: spoken(&parts.headers) })
    }
}

impl Asker {
    fn issuer(&self, by: Door) -> Issuer {
        issuer(&self.caller, by, self.peer)
    }

    fn state(&self) -> Arc<SimulatorState> {
        Arc::clone(&self.simulator.watch().borrow())
    }

    fn may_act(&self) -> bool {
        self.caller.may(Need::Act).is_ok()
    }

    /// Returns why the robots cannot be moved to another hall now. `None` if they can.
    fn bound(&self) -> Option<Problem> {
        self.door.hall.handle.snapshot().bound_to_hall().map(|refused| bound(&refused))
    }

    fn bound_in_words(&self) -> Option<String> {
        self.bound().map(|problem| self.in_words(&problem))
    }

    /// Returns the text of a problem for the pages. If a mission is under way, it also says what to do.
    fn in_words(&self, problem: &Problem) -> String {
        let is_bound = problem.code() == NOT_IN_PHASE;
        if is_bound { in_words(self.language, "boundToHall", problem.detail()) } else { problem.in_words(self.language) }
    }

    /// Makes a change in a separate task, so that the change is completed even if its sender disconnects.
    async fn done(changing: crate::runtime::simulator::Changing) -> Result<Arc<SimulatorState>, Problem> {
        Ok(tokio::spawn(changing).await.map_err(|_| Problem::internal())??)
    }

    fn json(&self, state: &SimulatorState) -> Response {
        let bound = self.bound().map(|problem| problem.detail().to_owned());
        axum::Json(SimulatorJson::new(&*self.simulator, state, bound)).into_response()
    }
}

fn bound(refused: &Refused) -> Problem {
    let problem = Problem::refused(refused);
    if problem.code() == NOT_IN_PHASE {
        problem.saying(format!("{refused}: let the mission end, or press RESET, which archives the mission"))
    } else {
        problem
    }
}

impl Problem {}

impl From<NotSimulated> for Problem {
    fn from(not: NotSimulated) -> Problem {
        let words = not.to_string();
        match not {
            NotSimulated::Refused(refused) => bound(&refused),
            NotSimulated::NotPaused => Problem::new(("notPaused", ProblemKind::Conflict), words),
            NotSimulated::NothingUnderWay => Problem::new(("nothingUnderWay", ProblemKind::Conflict), words),
            NotSimulated::Hall(_) => Problem::new(("unusableHall", ProblemKind::Unusable), words),
            NotSimulated::NoFreeCell(_) | NotSimulated::TooManyBlocked(_) => {
                Problem::new(("notBlocked", ProblemKind::Unusable), words)
            }
            NotSimulated::NotKept(_) => Problem::new(("hallNotKept", ProblemKind::Unavailable), words),
            NotSimulated::NotAName(_) => Problem::new(("notAName", ProblemKind::Unusable), words),
            NotSimulated::NameTaken(_) => Problem::new(("nameTaken", ProblemKind::Conflict), words),
            NotSimulated::AnotherKept(_) => Problem::new(("anotherKept", ProblemKind::Conflict), words),
            NotSimulated::TooManyKept(_) => Problem::new(("tooManyKept", ProblemKind::Conflict), words),
            NotSimulated::NoDataFolder => Problem::new(("noDataFolder", ProblemKind::Conflict), words),
            NotSimulated::NotThere(_) => Problem::not_found(words),
            NotSimulated::CannotChangeKept(_) => Problem::new(("cannotChangeKept", ProblemKind::Unavailable), words),
            NotSimulated::Gone(_) => Problem::closing(),
        }
    }
}

pub(super) async fn simulator(asker: Asker) -> Response {
    asker.json(&asker.state())
}

pub(super) async fn change(asker: Asker, body: JsonPayload) -> PageAnswer {
    let ChangeBody(change) = body.needed()?;
    let state = Asker::done(Arc::clone(&asker.simulator).change(change, asker.issuer(door::HTTP))).await?;
    Ok(asker.json(&state))
}

pub(super) async fn step(asker: Asker) -> PageAnswer {
    let state = Asker::done(Arc::clone(&asker.simulator).step(asker.issuer(door::HTTP))).await?;
    Ok(asker.json(&state))
}

pub(super) async fn hall(asker: Asker) -> Response {
    // The text is shared and not copied, because it may be large and many clients may request it.
    toml(axum::body::Bytes::from_owner(Shared(Arc::clone(&asker.state().hall.toml))))
}

pub(super) async fn offered(asker: Asker, Named(name): Named) -> PageAnswer {
    if !asker.simulator.halls().contains(&name) {
        let words = format!("there is no hall {:?}: GET /api/v1/simulator lists the halls", in_short(&name));
        return Err(Problem::not_found(words));
    }
    Ok(toml(offered_hall(&asker, &name).await??))
}

async fn offered_hall(asker: &Asker, name: &str) -> Result<Result<String, NotSimulated>, Problem> {
    let (simulator, name) = (Arc::clone(&asker.simulator), name.to_owned());
    in_turn(&asker.door, move || simulator.hall(&name)).await
}

/// The text of a hall, which may be large. Answers share this text instead of copying it.
struct Shared(Arc<str>);

impl AsRef<[u8]> for Shared {
    fn as_ref(&self) -> &[u8] {
        self.0.as_bytes()
    }
}

fn toml(text: impl IntoResponse) -> Response {
    ([(header::CONTENT_TYPE, "application/toml")], text).into_response()
}

/// `PUT simulator/halls/{name}`: replaces the stored hall by a hall file, in the format that `GET` returns.
pub(super) async fn keep(asker: Asker, Named(name): Named, file: HallFile) -> PageAnswer {
    let unpacked = in_turn(&asker.door, move || file.unpacked().map(|toml| String::from_utf8_lossy(&toml).into_owned()));
    let toml = unpacked.await??;
    let state = Asker::done(Arc::clone(&asker.simulator).keep(name, toml, true, asker.issuer(door::HTTP))).await?;
    Ok(asker.json(&state))
}

pub(super) async fn discard(asker: Asker, Named(name): Named) -> PageAnswer {
    let state = Asker::done(Arc::clone(&asker.simulator).discard(name, asker.issuer(door::HTTP))).await?;
    Ok(asker.json(&state))
}

pub(super) async fn put_down(asker: Asker, HallPayload(body): HallPayload) -> PageAnswer {
    let HallBody(hall) = body.needed()?;
    let state = Asker::done(Arc::clone(&asker.simulator).put_down(hall, asker.issuer(door::HTTP))).await?;
    Ok(asker.json(&state))
}

pub(super) async fn check(_: Asker, door: HttpDoor, query: Query, file: HallFile) -> PageAnswer {
    query.only(&["name"])?;
    let name = query.every("name").first().map_or("hall.toml", String::as_str).to_owned();
    // An editor calls this after every keystroke. Errors are useful to the person who draws, but are not recorded.
    let read = read_hall(&door, name, file).await.map_err(Problem::off_record)?;
    Ok(axum::Json(read).into_response())
}

async fn read_hall(door: &HttpDoor, name: String, file: HallFile) -> Result<ReadHall, Problem> {
    let read = in_turn(door, move || {
        let hall = hall_files::read(&name, &file.unpacked()?).map_err(|error| NotSimulated::Hall(error.to_string()))?;
        // The size is checked before the hall is built, because a small image file may describe a very large hall.
        let bounds = hall.bounds();
        match NotSimulated::too_large(bounds.width().unsigned_abs(), bounds.height().unsigned_abs()) {
            Some(not) => Err(Problem::from(not)),
            None => Ok(ReadHall::from(&hall)),
        }
    });
    read.await?
}

/// Does slow work on halls on a thread that no other work waits for. Only one such job runs at a time. Each is
/// completed even if its sender disconnects (safety S7).
async fn in_turn<T: Send + 'static>(door: &HttpDoor, act: impl FnOnce() -> T + Send + 'static) -> Result<T, Problem> {
    let turn = Arc::clone(&door.process.uploads).acquire_owned().await.map_err(|_| Problem::closing())?;
    let acting = tokio::task::spawn_blocking(move || {
        let done = act();
        drop(turn);
        done
    });
    acting.await.map_err(|_| Problem::internal())
}

#[cfg(test)]
mod tests;
