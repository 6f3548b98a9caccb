//! Every refusal and error of this door as `application/problem+json`. Which status a refusal gets stands in `crate::api::problem`.
//! Start at `Problem::refused` for the core's refusals; the other constructors are for requests that never reached it.

use axum::Extension;
use axum::http::{HeaderValue, Method, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};

use super::hearing::Pressed;
use crate::api::fields::in_short;
use crate::api::luggage::LuggageJson;
use crate::api::problem::{ProblemJson, status_of};
use crate::runtime::archive::Unreadable;
use crate::runtime::carry_out::NotDone;
use crate::runtime::handle::Gone;
use hallsweep_core::command::{Refusal, RefusalKind, Refused};
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::NoPhoto;

/// A request that was not carried out, and why.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    status: StatusCode,
    body: Box<ProblemJson>,
    is_on_record: bool,
}

/// Goes with a problem's answer, so that a person's browser can be shown a page instead of JSON.
#[derive(Clone, Debug)]
pub(super) struct Said(pub(super) String);

/// Goes with the answer to what this door did not take, so that the gate can put it on record.
#[derive(Clone, Debug)]
pub(super) struct NotTaken(pub(super) Refusal);

impl Problem {
    /// The core refused, and has put that on record; `luggage` is the record the refused command was about.
    pub(super) fn refused(refused: &Refused, luggage: Option<LuggageJson>) -> Problem {
        let status = StatusCode::from_u16(status_of(refused.kind())).expect("the table has statuses of HTTP only");
        let mut problem = Problem::new(status, refused.code(), refused.to_string());
        problem.body.luggage = luggage;
        problem.is_on_record = true;
        problem
    }

    /// 400: what was sent cannot be read.
    pub(super) fn malformed(detail: String) -> Problem {
        Problem::new(StatusCode::BAD_REQUEST, "malformed", detail)
    }

    /// 401: it takes a key to be listened to.
    pub(super) fn not_signed_in() -> Problem {
        let detail = "nobody is signed in: send the header `Authorization: Bearer TOKEN`, or sign in at /sign-in; \
                      `hallsweep token` on its machine shows tokens"
            .to_owned();
        Problem::new(StatusCode::UNAUTHORIZED, "notSignedIn", detail)
    }

    /// 403: a page of another origin sent it.
    pub(super) fn foreign(detail: String) -> Problem {
        Problem::new(StatusCode::FORBIDDEN, "foreignOrigin", detail)
    }

    /// 404: there is no such thing.
    pub(super) fn not_found(detail: String) -> Problem {
        Problem::new(StatusCode::NOT_FOUND, "notFound", detail)
    }

    /// 404: there is no such piece.
    pub(super) fn no_luggage(number: u64) -> Problem {
        Problem::not_found(Refused::UnknownLuggage(LuggageId(number)).to_string())
    }

    /// 406: none of the formats there are is wanted.
    pub(super) fn not_acceptable(detail: String) -> Problem {
        Problem::new(StatusCode::NOT_ACCEPTABLE, "notAcceptable", detail)
    }

    /// 408: the body came too slowly.
    pub(super) fn too_slow(detail: String) -> Problem {
        Problem::new(StatusCode::REQUEST_TIMEOUT, "tooSlow", detail)
    }

    /// 413: the body is larger than any command.
    pub(super) fn too_large(detail: String) -> Problem {
        Problem::new(StatusCode::PAYLOAD_TOO_LARGE, "tooLarge", detail)
    }

    /// 415: the body is of a type this route does not read.
    pub(super) fn wrong_type(detail: String) -> Problem {
        Problem::new(StatusCode::UNSUPPORTED_MEDIA_TYPE, "unsupportedMediaType", detail)
    }

    /// 421: it was sent to another name than this program's.
    pub(super) fn misdirected(detail: String) -> Problem {
        Problem::new(StatusCode::MISDIRECTED_REQUEST, "foreignHost", detail)
    }

    /// 422: it can be read, and asks for something that does not exist.
    pub(super) fn unusable(detail: String) -> Problem {
        Problem::new(StatusCode::UNPROCESSABLE_ENTITY, "unusable", detail)
    }

    /// 503: what is kept cannot be read.
    pub(super) fn unreadable(detail: String) -> Problem {
        Problem::new(StatusCode::SERVICE_UNAVAILABLE, "unreadable", detail)
    }

    /// 503: the program is ending.
    pub(super) fn closing() -> Problem {
        Problem::new(StatusCode::SERVICE_UNAVAILABLE, "shuttingDown", Gone.to_string())
    }

    /// 503: as many streams are open as there may be.
    pub(super) fn too_many_streams(most: usize) -> Problem {
        let detail =
            format!("{most} event streams are open, or this key has its share of them: close one, or read /api/v1/state");
        Problem::new(StatusCode::SERVICE_UNAVAILABLE, "tooManyStreams", detail)
    }

    /// 503: nobody gives way to one more connection; a STOP was heard before.
    pub(super) fn no_place(has_halted: bool) -> Problem {
        let so = if has_halted { "; the STOP that came with it has halted the robot" } else { "" };
        let detail = format!("every place for a connection is taken by others who are at it{so}: try again in a moment");
        Problem::new(StatusCode::SERVICE_UNAVAILABLE, "noPlace", detail)
    }

    /// 503: this machine's clock stands where no answer can be dated; a STOP was heard before.
    pub(super) fn no_date(has_halted: bool) -> Problem {
        let so = if has_halted { "; the STOP that came with it has halted the robot" } else { "" };
        let detail = format!("the clock of the machine stands before 1970, and nothing is served until it is set{so}");
        Problem::new(StatusCode::SERVICE_UNAVAILABLE, "noDate", detail)
    }

    /// 500: a mistake in the program ended this request, and this request only.
    pub(super) fn internal() -> Problem {
        let detail = "a mistake in hallsweep ended this request; its log says more".to_owned();
        Problem::new(StatusCode::INTERNAL_SERVER_ERROR, "internal", detail)
    }

    /// The sentence a person reads.
    pub(super) fn detail(&self) -> &str {
        &self.body.detail
    }

    /// What a program reads.
    pub(super) fn json(&self) -> String {
        serde_json::to_string(&self.body).expect("a problem is strings and numbers, which JSON can hold")
    }

    pub(super) const fn status(&self) -> StatusCode {
        self.status
    }

    /// Tells the gate what is to go on record: whatever the sender did wrong and the core never saw.
    pub(super) fn tell_gate(&self, response: &mut Response) {
        if self.status.is_client_error() && !self.is_on_record {
            let kind = if self.status == StatusCode::NOT_FOUND { RefusalKind::Unknown } else { RefusalKind::Mismatch };
            let refusal = Refusal { code: self.body.code, kind, words: self.body.detail.clone() };
            response.extensions_mut().insert(NotTaken(refusal));
        }
    }

    fn new(status: StatusCode, code: &'static str, detail: String) -> Problem {
        let title = status.canonical_reason().unwrap_or("Problem");
        let body = Box::new(ProblemJson::new(status.as_u16(), title, code, detail));
        Problem { status, body, is_on_record: false }
    }
}

impl From<NotDone> for Problem {
    fn from(not_done: NotDone) -> Problem {
        match not_done {
            NotDone::Refused(refused, luggage) => Problem::refused(&refused, luggage.map(|luggage| LuggageJson::from(&*luggage))),
            NotDone::Gone => Problem::closing(),
        }
    }
}

impl From<NoPhoto> for Problem {
    fn from(none: NoPhoto) -> Problem {
        Problem::not_found(none.to_string())
    }
}

impl From<Unreadable> for Problem {
    fn from(unreadable: Unreadable) -> Problem {
        Problem::unreadable(unreadable.to_string())
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let body = self.json();
        let media_type = HeaderValue::from_static("application/problem+json");
        let said = Said(self.body.detail.clone());
        let mut response = (self.status, Extension(said), [(header::CONTENT_TYPE, media_type)], body).into_response();
        self.tell_gate(&mut response);
        response
    }
}

/// The answer where no route is.
pub(super) async fn no_such_path(uri: Uri, pressed: Option<Extension<Pressed>>) -> Problem {
    let halted = halted(pressed);
    Problem::not_found(format!("there is nothing at {}: the routes are listed in docs/http.md{halted}", in_short(uri.path())))
}

/// The answer where the route is but not for this method; the header `Allow` lists those it has.
pub(super) async fn no_such_method(method: Method, uri: Uri, pressed: Option<Extension<Pressed>>) -> Problem {
    let (path, method, halted) = (in_short(uri.path()), in_short(method.as_str()), halted(pressed));
    let detail = format!("{path} does not answer {method}: see the header Allow{halted}");
    Problem::new(StatusCode::METHOD_NOT_ALLOWED, "methodNotAllowed", detail)
}

/// What is said when a STOP was heard in a request that is refused.
fn halted(pressed: Option<Extension<Pressed>>) -> &'static str {
    if pressed.is_some_and(|Extension(pressed)| pressed.is_there()) { "; the STOP in it has halted the robot" } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::command::{CODES, CommandId, Refusal, Verdict};
    use hallsweep_core::mission::{Hold, PhaseName};
    use hallsweep_core::units::{AlarmId, Cell, Epoch};

    /// One of each variant, in their order, and how the walk goes on; a new variant does not compile until it is added here.
    fn next(refused: Option<&Refused>) -> Option<Refused> {
        let id = LuggageId(3);
        Some(match refused {
            None => Refused::Held(vec![Hold::TooHigh], None),
            Some(Refused::Held(..)) => Refused::Outdated { sent: Epoch(1), now: Epoch(2) },
            Some(Refused::Outdated { .. }) => Refused::SentBefore,
            Some(Refused::SentBefore) => Refused::NotInPhase(PhaseName::Idle),
            Some(Refused::NotInPhase(_)) => Refused::VerdictPending(id),
            Some(Refused::VerdictPending(_)) => Refused::Driving,
            Some(Refused::Driving) => Refused::NotStopped,
            Some(Refused::NotStopped) => Refused::IntoObstacle(Cell::HOME),
            Some(Refused::IntoObstacle(_)) => Refused::NotCapable,
            Some(Refused::NotCapable) => Refused::Moving,
            Some(Refused::Moving) => Refused::Unrecorded,
            Some(Refused::Unrecorded) => Refused::BombUnfetched(id),
            Some(Refused::BombUnfetched(_)) => Refused::UnknownLuggage(id),
            Some(Refused::UnknownLuggage(_)) => Refused::NothingPending,
            Some(Refused::NothingPending) => Refused::Decided { luggage: id, verdict: Verdict::Safe },
            Some(Refused::Decided { .. }) => Refused::NoPhoto(id),
            Some(Refused::NoPhoto(_)) => Refused::NotInspected(id),
            Some(Refused::NotInspected(_)) => Refused::PhotoUnderWay,
            Some(Refused::PhotoUnderWay) => Refused::UnknownAlarm(AlarmId(1)),
            Some(Refused::UnknownAlarm(_)) => Refused::NoRetrievalRobot,
            Some(Refused::NoRetrievalRobot) => Refused::FaultStands("stuck".to_owned()),
            Some(Refused::FaultStands(_)) => Refused::StoreDown,
            Some(Refused::StoreDown) => Refused::NotKept,
            Some(Refused::NotKept) => Refused::OtherContent(CommandId::new("a-name").unwrap()),
            Some(Refused::OtherContent(_)) => Refused::UnknownSensor("roof".into()),
            Some(Refused::UnknownSensor(_)) => Refused::NotAllowed("a viewer sees, and stops".to_owned()),
            Some(Refused::NotAllowed(_) | Refused::Before(_)) => return None,
        })
    }

    /// What this door refused is read back from the journal as it was written.
    #[test]
    fn what_the_door_refuses_is_known_again_after_a_restart() {
        let words = || "a sentence".to_owned();
        for problem in [
            Problem::malformed(words()),
            Problem::unusable(words()),
            Problem::too_large(words()),
            Problem::too_slow(words()),
            Problem::wrong_type(words()),
            Problem::not_found(words()),
        ] {
            let response = problem.into_response();
            let NotTaken(refusal) = response.extensions().get().expect("the door did not take it");
            assert_eq!(Refusal::named(refusal.code, words()), *refusal);
        }
    }

    #[test]
    fn every_refusal_has_a_status_a_code_of_its_own_and_a_sentence() {
        let all: Vec<Refused> = std::iter::successors(next(None), |refused| next(Some(refused))).collect();
        let mut codes = std::collections::BTreeSet::new();
        for refused in &all {
            let problem = Problem::refused(refused, None);
            let expected = match refused.code() {
                "unknownLuggage" | "unknownAlarm" | "unknownSensor" => 404,
                "storeDown" | "notKept" => 503,
                "otherContent" => 422,
                "notAllowed" => 403,
                _ => 409,
            };
            let read_back = Refused::Before(Refusal::named(refused.code(), refused.to_string()));
            assert_eq!((read_back.code(), read_back.kind()), (refused.code(), refused.kind()), "as before, after a restart");
            assert_eq!(problem.status.as_u16(), expected, "{refused}");
            assert_eq!(problem.body.status, expected);
            assert!(problem.detail().len() > 15, "a person is to understand {refused:?}");
            assert_eq!(problem.body.kind, format!("urn:hallsweep:problem:{}", refused.code()));
            assert!(codes.insert(refused.code()), "{} is used twice", refused.code());
        }
        assert_eq!(all.len(), CODES.len());
    }
}
