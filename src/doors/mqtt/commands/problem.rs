//! Every refusal of this door, with the status that HTTP would give it. What the core refuses comes here as `NotDone`; the other
//! constructors are for messages that never reached it.

use std::time::Duration;

use axum::http::StatusCode;

use super::table::names;
use crate::api::fields::{Unread, Unusable, in_short};
use crate::api::luggage::LuggageJson;
use crate::api::problem::{ProblemJson, status_of};
use crate::runtime::carry_out::NotDone;
use crate::runtime::handle::Gone;
use hallsweep_core::command::{Refusal, RefusalKind, Refused};

/// A message that was not carried out, and why.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    kind: RefusalKind,
    body: Box<ProblemJson>,
}

impl Problem {
    /// What the core refuses, or this door in the core's words; `luggage` is the record the refused command was about.
    pub(super) fn refused(refused: &Refused, luggage: Option<LuggageJson>) -> Problem {
        let mut problem = Problem::of(refused.kind(), refused.code(), refused.to_string());
        problem.body.luggage = luggage;
        problem
    }

    /// 400: what was sent cannot be read.
    pub(super) fn malformed(detail: String) -> Problem {
        Problem::new(StatusCode::BAD_REQUEST, RefusalKind::Mismatch, "malformed", detail)
    }

    /// 404: no command is called so.
    pub(super) fn no_command(name: &str) -> Problem {
        Problem::of(
            RefusalKind::Unknown,
            "notFound",
            format!("there is no command {:?}: there are {}", in_short(name), names(false)),
        )
    }

    /// 404: no command can be given by this word alone.
    pub(super) fn no_word(word: &str) -> Problem {
        let words = names(true);
        let detail = format!("no command is given by the word {:?} alone: there are {words}; others have topics", in_short(word));
        Problem::of(RefusalKind::Unknown, "notFound", detail)
    }

    /// 413: larger than any command.
    pub(super) fn too_large(bytes: usize, most: usize) -> Problem {
        let detail = format!("the payload has {bytes} bytes: at most {most} are read, and a command is a few dozen");
        Problem::new(StatusCode::PAYLOAD_TOO_LARGE, RefusalKind::Mismatch, "tooLarge", detail)
    }

    /// 503: as many commands are under way as there may be.
    pub(super) fn too_many(most: usize) -> Problem {
        let detail = format!("{most} commands are under way: send it again when their results have come; STOP is always taken");
        Problem::of(RefusalKind::Unavailable, "tooMany", detail)
    }

    /// 503: what became of it is not known in time.
    pub(super) fn no_answer(waited: Duration) -> Problem {
        let detail = format!("it was not answered within {} s: look at the state before you repeat it", waited.as_secs());
        Problem::of(RefusalKind::Unavailable, "noAnswer", detail)
    }

    /// The sentence a person reads.
    pub(super) fn detail(&self) -> &str {
        &self.body.detail
    }

    /// As records keep it.
    pub(super) fn refusal(&self) -> Refusal {
        Refusal { code: self.body.code, kind: self.kind, words: self.body.detail.clone() }
    }

    /// As it is published.
    pub(super) fn shape(&self) -> &ProblemJson {
        &self.body
    }

    /// A problem with the status of its family.
    fn of(kind: RefusalKind, code: &'static str, detail: String) -> Problem {
        let status = StatusCode::from_u16(status_of(kind)).expect("the table has statuses of HTTP only");
        Problem::new(status, kind, code, detail)
    }

    fn new(status: StatusCode, kind: RefusalKind, code: &'static str, detail: String) -> Problem {
        let title = status.canonical_reason().unwrap_or("Problem");
        Problem { kind, body: Box::new(ProblemJson::new(status.as_u16(), title, code, detail)) }
    }
}

impl From<NotDone> for Problem {
    fn from(not_done: NotDone) -> Problem {
        match not_done {
            NotDone::Refused(refused, luggage) => Problem::refused(&refused, luggage.map(|luggage| LuggageJson::from(&*luggage))),
            NotDone::Gone => Problem::of(RefusalKind::Unavailable, "shuttingDown", Gone.to_string()),
        }
    }
}

impl From<Unusable> for Problem {
    fn from(unusable: Unusable) -> Problem {
        Problem::of(RefusalKind::Mismatch, "unusable", unusable.to_string())
    }
}

impl From<Unread> for Problem {
    fn from(unread: Unread) -> Problem {
        match unread {
            Unread::Malformed(words) => Problem::malformed(words),
            Unread::Unusable(unusable) => unusable.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::command::move_word;
    use hallsweep_core::command::CODES;

    #[test]
    fn every_refusal_there_is_has_the_status_that_http_gives_it() {
        for (word, kind) in CODES {
            let refused = Refused::Before(Refusal { code: word, kind, words: "a sentence".to_owned() });
            let problem = Problem::refused(&refused, None);
            let expected = match word {
                "unknownLuggage" | "unknownAlarm" | "unknownSensor" => 404,
                "storeDown" | "notKept" => 503,
                "otherContent" => 422,
                "notAllowed" => 403,
                _ => 409,
            };
            assert_eq!((problem.shape().status, problem.shape().code), (expected, word));
            assert_ne!(problem.shape().title, "Problem");
            assert!(!problem.shape().accepted);
        }
    }

    /// What this door refused is read back from the journal as it was written.
    #[test]
    fn what_the_door_refuses_is_known_again_after_a_restart() {
        for (problem, status) in [
            (Problem::malformed("a sentence".to_owned()), 400),
            (move_word("q").unwrap_err().into(), 422),
            (Problem::no_command("dance"), 404),
            (Problem::no_word("dance"), 404),
            (Problem::too_large(5000, 4096), 413),
            (Problem::too_many(256), 503),
            (Problem::refused(&Refused::NotAllowed("a sentence".to_owned()), None), 403),
        ] {
            let refusal = problem.refusal();
            assert_eq!(Refusal::named(refusal.code, refusal.words.clone()), refusal);
            assert_eq!((problem.shape().status, problem.shape().title.as_str() != "Problem"), (status, true));
        }
    }
}
