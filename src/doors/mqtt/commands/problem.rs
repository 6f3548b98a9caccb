//! The problems that exist only at this door. They are published in the same form as all other problems.

use std::time::Duration;

use super::table::names;
use crate::api::fields::in_short;
use crate::api::problem::{ProblemKind, TOO_MANY};
pub(super) use crate::doors::problem::Problem;

impl Problem {
    pub(super) fn no_command(name: &str) -> Problem {
        Problem::not_found(format!("there is no command {:?}: the commands are {}", in_short(name), names(false)))
    }

    pub(super) fn no_word(word: &str) -> Problem {
        let (word, words) = (in_short(word), names(true));
        let detail =
            format!("{word:?} is not a command that can be sent as a bare word: send {words}, or use the topic of the command");
        Problem::not_found(detail)
    }

    pub(super) fn too_many(most: usize) -> Problem {
        let detail =
            format!("{most} commands are under way: wait for a result, then send this command again; STOP is always accepted");
        Problem::new(TOO_MANY, detail)
    }

    pub(super) fn no_answer(waited: Duration) -> Problem {
        let detail =
            format!("the command had no answer within {} s: read the state before you repeat the command", waited.as_secs());
        Problem::new(("noAnswer", ProblemKind::Unavailable), detail)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::command::move_word;
    use crate::api::problem::refusal as named;
    use hallsweep_core::refused::{CODES, Refusal, Refused};

    fn title_of(status: u16) -> Option<&'static str> {
        axum::http::StatusCode::from_u16(status).unwrap().canonical_reason()
    }

    #[test]
    fn every_refusal_there_is_has_the_status_that_http_gives_it() {
        for (word, kind) in CODES {
            let refused = Refused::InWords(Refusal { code: word, kind, words: "a sentence".to_owned() });
            let problem = Problem::refused(&refused);
            let expected = match word {
                "unknownLuggage" | "unknownAlarm" | "unknownSensor" | "unknownArea" => 404,
                "storeDown" | "notKept" => 503,
                "otherContent" => 422,
                "notAllowed" => 403,
                _ => 409,
            };
            assert_eq!((problem.shape().status, problem.shape().code), (expected, word));
            assert_eq!(Some(problem.shape().title), title_of(expected));
            assert!(!problem.shape().accepted);
        }
    }

    #[test]
    fn what_the_door_refuses_is_known_again_after_a_restart() {
        for (problem, status) in [
            (Problem::malformed("a sentence".to_owned()), 400),
            (move_word("q").unwrap_err().into(), 422),
            (Problem::no_command("dance"), 404),
            (Problem::no_word("dance"), 404),
            (Problem::too_large("a sentence".to_owned()), 413),
            (Problem::too_many(256), 503),
            (Problem::refused(&Refused::NotAllowed("a sentence".to_owned())), 403),
        ] {
            let refusal = named(problem.code(), problem.detail().to_owned());
            assert_eq!((refusal.code, refusal.kind), (problem.code(), problem.for_record().kind()));
            assert_eq!((problem.shape().status, Some(problem.shape().title)), (status, title_of(status)));
        }
    }
}
