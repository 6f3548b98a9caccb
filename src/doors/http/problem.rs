//! Writes problems as `application/problem+json`, with the HTTP status of the problem. Also contains the problems
//! that only this door has.

use axum::Extension;
use axum::http::{HeaderValue, Method, StatusCode, Uri, header};
use axum::response::{IntoResponse, Response};

use super::hearing::Pressed;
use crate::api::fields::in_short;
use crate::api::problem::{ProblemKind, TOO_SLOW};
pub(super) use crate::doors::problem::Problem;
use crate::phrases::Language;
use hallsweep_core::refused::{CODES, Refused};

/// Added to the response of a problem, so that a browser can get a page instead of JSON.
#[derive(Clone, Debug)]
pub(super) struct Detail {
    pub(super) code: &'static str,
    pub(super) detail: String,
    pub(super) of_core: Option<Refused>,
}

/// Returns the text of a problem that has no `Refused` value. The phrase of a refusal by the core cannot be made
/// without that value, so such a refusal gets a general phrase with the English detail.
pub(super) fn in_words(language: Language, code: &str, detail: &str) -> String {
    let code = if CODES.iter().any(|(known, _)| *known == code) { "refused" } else { code };
    language.say_of("problem", code).with("detail", detail).to_string()
}

/// Added to the answer to a refused request, so that the gate can record the refusal.
#[derive(Clone, Debug)]
pub(super) struct NotTaken(pub(super) Refused);

impl Problem {
    pub(super) fn not_signed_in() -> Problem {
        let detail = "nobody is signed in: send the header `Authorization: Bearer TOKEN`, or sign in at /sign-in; \
                      `hallsweep token` on the server shows the tokens"
            .to_owned();
        Problem::new(("notSignedIn", ProblemKind::NotSignedIn), detail)
    }

    /// The same bytes for a hall that does not exist and for a hall that this key does not see.
    pub(super) fn no_hall() -> Problem {
        let detail = "there is no hall of this name, or this key does not see it: /api/v1/halls lists the halls that it sees";
        Problem::new(("noHall", ProblemKind::NotFound), detail.to_owned())
    }

    pub(super) const fn foreign(detail: String) -> Problem {
        Problem::new(("foreignOrigin", ProblemKind::Forbidden), detail)
    }

    pub(super) const fn too_slow(detail: String) -> Problem {
        Problem::new(TOO_SLOW, detail)
    }

    pub(super) const fn misdirected(detail: String) -> Problem {
        Problem::new(("foreignHost", ProblemKind::Misdirected), detail)
    }

    pub(super) fn too_many_streams(most: usize) -> Problem {
        let detail =
            format!("all {most} event streams, or all that this key may open, are in use: close a stream, or read /api/v1/state");
        Problem::new(("tooManyStreams", ProblemKind::Unavailable), detail)
    }

    pub(super) fn too_many_runs(waiting: usize) -> Problem {
        let detail = format!("{waiting} laboratory runs are under way or waiting: try again in a moment");
        Problem::new(("tooManyRuns", ProblemKind::Unavailable), detail)
    }

    pub(super) fn too_many_reports(writing: usize) -> Problem {
        let detail = format!("{writing} reports and records are being sent: try again in a moment");
        Problem::new(("tooManyReports", ProblemKind::Unavailable), detail)
    }

    /// No connection can be evicted for this one. A STOP in the request has already been carried out.
    pub(super) fn no_slot(has_halted: bool) -> Problem {
        let so = if has_halted { "; the STOP in this request has halted the robot" } else { "" };
        let detail = format!("all connections are in use{so}: try again in a moment");
        Problem::new(("noPlace", ProblemKind::Unavailable), detail)
    }

    /// This machine's clock shows a time before 1970, and answers cannot have a date. A STOP in the request has
    /// already been carried out.
    pub(super) fn no_date(has_halted: bool) -> Problem {
        let so = if has_halted { "; the STOP in this request has halted the robot" } else { "" };
        let detail = format!("the clock of this machine shows a year before 1970: set the clock, then try again{so}");
        Problem::new(("noDate", ProblemKind::Unavailable), detail)
    }

    /// A panic ended this request. Other requests continue.
    pub(super) fn internal() -> Problem {
        let detail = "a mistake in hallsweep ended this request; its log says more".to_owned();
        Problem::new(("internal", ProblemKind::Internal), detail)
    }

    pub(super) fn in_words(&self, language: Language) -> String {
        self.of_core().map_or_else(|| in_words(language, self.code(), self.detail()), |refused| language.refused(refused))
    }

    /// Returns the response in this language. The text for the record stays in English.
    pub(super) fn told(self, language: Language) -> Response {
        let said = self.in_words(language);
        let mut response = self.clone().saying(said).into_response();
        self.tell_gate(&mut response);
        response
    }

    pub(super) fn json(&self) -> String {
        serde_json::to_string(&self.shape()).expect("a problem is strings and numbers, which JSON can hold")
    }

    pub(super) fn status(&self) -> StatusCode {
        StatusCode::from_u16(self.kind().status().0).expect("the statuses of problem details are those of HTTP")
    }

    /// Tells the gate what to record, if the fault is the sender's and the core has not recorded it.
    pub(super) fn tell_gate(&self, response: &mut Response) {
        if self.status().is_client_error() && self.is_for_record() {
            response.extensions_mut().insert(NotTaken(self.for_record()));
        }
    }
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let body = self.json();
        let media_type = HeaderValue::from_static("application/problem+json");
        let said = Detail { code: self.code(), detail: self.detail().to_owned(), of_core: self.of_core().cloned() };
        let mut response = (self.status(), Extension(said), [(header::CONTENT_TYPE, media_type)], body).into_response();
        self.tell_gate(&mut response);
        response
    }
}

pub(super) async fn no_such_path(uri: Uri, pressed: Option<Extension<Pressed>>) -> Problem {
    let halted = halted(pressed.as_deref());
    Problem::not_found(format!("there is nothing at {}: the routes are listed in docs/http.md{halted}", in_short(uri.path())))
}

/// Answers a request to a known path with a wrong method. The header `Allow` lists the allowed methods (RFC 9110,
/// section 15.5.6).
pub(super) async fn no_such_method(method: Method, uri: Uri, pressed: Option<Extension<Pressed>>) -> Problem {
    let (path, method, halted) = (in_short(uri.path()), in_short(method.as_str()), halted(pressed.as_deref()));
    let detail = format!("{path} does not accept {method}: see the header Allow{halted}");
    Problem::no_method(detail)
}

/// Returns a text to add to a refusal. It says that the STOP in the request was not refused.
pub(super) fn halted(pressed: Option<&Pressed>) -> &'static str {
    if pressed.is_some_and(Pressed::is_there) { "; the STOP in this request has halted the robot" } else { "" }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::problem::refusal as named;
    use hallsweep_core::closing::OpenPoints;
    use hallsweep_core::command::{CommandId, Verdict};
    use hallsweep_core::hold::Hold;
    use hallsweep_core::phase::{FaultCause, PhaseName};
    use hallsweep_core::refused::Refused;
    use hallsweep_core::robot::RobotId;
    use hallsweep_core::units::{AlarmId, Cell, Epoch, LuggageId, MissionId};

    fn codes() -> std::collections::BTreeSet<String> {
        let mut folders = vec![std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/doors/http")];
        let mut sources = vec![include_str!("../problem.rs").to_owned()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    sources.push(std::fs::read_to_string(path).unwrap());
                }
            }
        }
        let begin = concat!("Problem::new", "((\"");
        let code = |rest: &str| rest.split('"').next().unwrap().to_owned();
        let own = sources.iter().flat_map(|source| source.split(begin).skip(1)).map(code);
        let words = String::new;
        let common = [
            Problem::malformed(words()),
            Problem::unusable(words()),
            Problem::not_found(words()),
            Problem::no_method(words()),
            Problem::not_acceptable(words()),
            Problem::too_large(words()),
            Problem::too_slow(words()),
            Problem::wrong_format(words()),
        ];
        let common = common.iter().map(|problem| problem.code().to_owned());
        let of_simulator = "boundToHall".to_owned();
        own.chain(common).chain(["refused".to_owned(), of_simulator]).collect()
    }

    #[test]
    fn every_code_has_a_sentence_in_every_language_and_every_sentence_its_code() {
        let file = include_str!("../../phrases/it/problems.ftl");
        let said = file.lines().filter_map(|line| line.strip_prefix("problem-")?.split_once(" = "));
        assert_eq!(said.map(|(code, _)| code.to_owned()).collect::<std::collections::BTreeSet<_>>(), codes());
        for code in codes() {
            assert_eq!(in_words(Language::English, &code, "the detail, 3"), "the detail, 3", "{code}");
            let italian = in_words(Language::Italian, &code, "");
            assert!(italian.len() > 15 && !italian.ends_with('.'), "{code}: it stands within other sentences: {italian}");
        }
    }

    /// Returns the next variant after `refused`, with example values. A new variant does not compile until it is
    /// added here.
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
            Some(Refused::UnknownLuggage(_)) => Refused::NotABomb(id),
            Some(Refused::NotABomb(_)) => Refused::NothingPending,
            Some(Refused::NothingPending) => Refused::Decided { luggage: id, verdict: Verdict::Safe },
            Some(Refused::Decided { .. }) => Refused::NoPhoto(id),
            Some(Refused::NoPhoto(_)) => Refused::HotUnanswered(id),
            Some(Refused::HotUnanswered(_)) => Refused::NotInspected(id),
            Some(Refused::NotInspected(_)) => Refused::PhotoUnderWay,
            Some(Refused::PhotoUnderWay) => Refused::UnknownAlarm(AlarmId(1)),
            Some(Refused::UnknownAlarm(_)) => Refused::NoRetrievalRobot,
            Some(Refused::NoRetrievalRobot) => Refused::FetcherUnreached(RobotId::discovery()),
            Some(Refused::FetcherUnreached(_)) => Refused::FetcherAbroad(RobotId::discovery()),
            Some(Refused::FetcherAbroad(_)) => Refused::FaultStands(FaultCause::Unanswered),
            Some(Refused::FaultStands(_)) => {
                Refused::OpenPoints { mission: MissionId(1), open: Box::new(OpenPoints { bombs: 1, ..OpenPoints::default() }) }
            }
            Some(Refused::OpenPoints { .. }) => Refused::OtherMission(MissionId(2)),
            Some(Refused::OtherMission(_)) => Refused::ExerciseOver,
            Some(Refused::ExerciseOver) => Refused::NothingSearched,
            Some(Refused::NothingSearched) => Refused::AreaTooLarge(4096),
            Some(Refused::AreaTooLarge(_)) => Refused::UnknownArea("gate 1".into()),
            Some(Refused::UnknownArea(_)) => Refused::AreaClosed("gate 1".into()),
            Some(Refused::AreaClosed(_)) => Refused::StoreDown,
            Some(Refused::StoreDown) => Refused::NotKept,
            Some(Refused::NotKept) => Refused::OtherContent(CommandId::new("a-name").unwrap()),
            Some(Refused::OtherContent(_)) => Refused::UnknownSensor("roof".into()),
            Some(Refused::UnknownSensor(_)) => Refused::NotAllowed("a viewer sees, and stops".to_owned()),
            // `NotAllowed` is the last value. `NotOnRecord` is only shown at buttons, and `InWords` can stand for any
            // variant.
            Some(Refused::NotAllowed(_) | Refused::NotOnRecord | Refused::InWords(_)) => return None,
        })
    }

    #[test]
    fn a_refusal_is_told_with_its_values_and_goes_on_record_in_english() {
        let refused = std::iter::successors(next(None), |refused| next(Some(refused)));
        for refused in refused {
            let problem = || Problem::refused(&refused);
            assert_eq!(problem().in_words(Language::English), refused.to_string());
            let italian = problem().in_words(Language::Italian);
            assert!(italian != refused.to_string() && italian == Language::Italian.refused(&refused), "{italian}");
        }
        let told = Problem::unusable("x is missing: fill it in".to_owned()).told(Language::Italian);
        assert_eq!(
            told.extensions().get::<NotTaken>().map(|NotTaken(refused)| refused.to_string()).as_deref(),
            Some("x is missing: fill it in")
        );
    }

    #[test]
    fn every_problem_is_called_as_its_status_is() {
        let words = || "a sentence".to_owned();
        for (problem, status) in [
            (Problem::malformed(words()), StatusCode::BAD_REQUEST),
            (Problem::not_signed_in(), StatusCode::UNAUTHORIZED),
            (Problem::foreign(words()), StatusCode::FORBIDDEN),
            (Problem::not_found(words()), StatusCode::NOT_FOUND),
            (Problem::no_method(words()), StatusCode::METHOD_NOT_ALLOWED),
            (Problem::not_acceptable(words()), StatusCode::NOT_ACCEPTABLE),
            (Problem::too_slow(words()), StatusCode::REQUEST_TIMEOUT),
            (Problem::refused(&Refused::Moving), StatusCode::CONFLICT),
            (Problem::too_large(words()), StatusCode::PAYLOAD_TOO_LARGE),
            (Problem::wrong_format(words()), StatusCode::UNSUPPORTED_MEDIA_TYPE),
            (Problem::misdirected(words()), StatusCode::MISDIRECTED_REQUEST),
            (Problem::unusable(words()), StatusCode::UNPROCESSABLE_ENTITY),
            (Problem::internal(), StatusCode::INTERNAL_SERVER_ERROR),
            (Problem::closing(), StatusCode::SERVICE_UNAVAILABLE),
        ] {
            assert_eq!((problem.status(), Some(problem.shape().title)), (status, status.canonical_reason()));
            assert_eq!(problem.shape().status, status.as_u16());
        }
    }

    #[test]
    fn what_the_door_refuses_is_known_again_after_a_restart() {
        let words = || "a sentence".to_owned();
        for problem in [
            Problem::malformed(words()),
            Problem::unusable(words()),
            Problem::too_large(words()),
            Problem::too_slow(words()),
            Problem::wrong_format(words()),
            Problem::not_found(words()),
        ] {
            let response = problem.into_response();
            let NotTaken(refused) = response.extensions().get().expect("the door did not take it");
            assert_eq!(Refused::InWords(named(refused.code(), words())), *refused);
        }
    }

    #[test]
    fn every_refusal_has_a_status_a_code_of_its_own_and_a_sentence() {
        let all: Vec<Refused> = std::iter::successors(next(None), |refused| next(Some(refused))).collect();
        let mut codes = std::collections::BTreeSet::new();
        for refused in &all {
            let problem = Problem::refused(refused);
            let expected = match refused.code() {
                "unknownLuggage" | "unknownAlarm" | "unknownSensor" | "unknownArea" => 404,
                "storeDown" | "notKept" => 503,
                "otherContent" => 422,
                "notAllowed" => 403,
                _ => 409,
            };
            let read_back = Refused::InWords(named(refused.code(), refused.to_string()));
            assert_eq!((read_back.code(), read_back.kind()), (refused.code(), refused.kind()), "as before, after a restart");
            assert_eq!(problem.status().as_u16(), expected, "{refused}");
            assert_eq!(problem.shape().status, expected);
            assert!(problem.detail().len() > 15, "a person is to understand {refused:?}");
            assert_eq!(problem.shape().kind, format!("urn:hallsweep:problem:{}", refused.code()));
            assert!(codes.insert(refused.code()), "{} is used twice", refused.code());
        }
        assert_eq!(all.len(), CODES.len());
    }
}
