//! STOP at this door. A STOP is recognised before anything else is judged: only sender, method, path and word count.
//! Other faults are reported afterwards (safety S8). The handle halts the robot.

use super::super::application::Reply;
use super::Resources;
use super::actions::{self, Terms};
use super::caller::{self, Caller};
use super::problem::Problem;
use crate::api::halt::{bare, is_halt, is_halt_word, says_halt};
use coap_endpoint::{Answer, Request};
use hallsweep_core::command::{self, Command};

/// Whether a request halts the robot. Methods that this door does not support halt too. Methods that only read do
/// not.
pub(super) fn is_stop(request: &Request) -> bool {
    if request.method.is_safe() || Caller::of(request.peer) != Caller::Here {
        return false;
    }
    let path = segments(request);
    match path.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["commands", word] if is_halt(word) => true,
        ["commands", "move"] => says_halt(&request.payload),
        ["resourcemodel"] => is_halt_word(&request.payload),
        _ => false,
    }
}

/// Every request that halts contains one of these words in its path; they are in lower case here. The exception is an
/// unusual form of the bare `h`: with blanks around it, after an empty segment, or in a message that is cut off.
pub(super) const WORDS: &[[u8; 4]] = &[*b"stop", *b"move", *b"reso", *b"ds!h", *b"ds/h"];

/// Returns the words of a path in lower case. How the client has split the path does not matter.
fn segments(request: &Request) -> Vec<String> {
    let segments = request.path.iter().flat_map(|segment| segment.split('/'));
    segments.map(|segment| bare(segment).to_ascii_lowercase()).filter(|segment| !segment.is_empty()).collect()
}

impl Resources {
    /// Carries out a STOP, and answers when the robot has halted. The answer is "accepted", or a refusal that says
    /// that the robot has halted.
    pub(super) fn stop(&self, request: &Request) -> Reply {
        let judged = self.judged(request);
        let id = judged.as_ref().ok().and_then(|terms| terms.id.clone());
        let asked = command::Request { id, ..command::Request::new(Command::Stop, caller::issuer(request.peer)) };
        let (given, request) = (self.handle.carry_out(asked), request.clone());
        Reply::Later(Box::pin(async move {
            Answer::once(match (given.await, judged) {
                (Ok(done), Ok(terms)) => actions::accepted(terms.form, &done),
                (Ok(_), Err(problem)) => problem.although_halted().response(&request),
                (Err(not_done), _) => Problem::from(not_done).response(&request),
            })
        }))
    }

    /// Returns the parameters of the answer. A fault in path or method is reported. Faults in query, conditions,
    /// format and body are ignored.
    fn judged(&self, request: &Request) -> Result<Terms, Problem> {
        let found = self.table.find(&request.path).ok_or_else(|| Problem::nothing_at(request))?;
        let act = found.row.action(request.method).ok_or_else(|| Problem::not_answered(request, found.row))?;
        let terms = actions::terms(act, request).and_then(|terms| self.may_change(&found, request).map(|()| terms));
        Ok(terms.unwrap_or_else(|_| Terms::plain(act)))
    }
}

#[cfg(test)]
#[path = "stop_tests.rs"]
mod tests;
