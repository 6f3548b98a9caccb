//! STOP at this door. It is recognised before anything else is judged, by sender, method, path and word alone; other faults are
//! reported afterwards (safety S8). The handle halts the robot.

use super::super::application::Reply;
use super::Resources;
use super::actions::{self, Terms};
use super::caller::{self, Caller};
use super::problem::Problem;
use crate::api::halt::{bare, is_halt, is_halt_word, says_halt};
use coap_endpoint::{Answer, Request};
use hallsweep_core::command::{self, Command};

/// Whether a request halts the robot. A method that this door does not support halts as well, but not a method that only reads.
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

/// Every request that halts has one of these words in its path, here in lower case. The exception is an unusual form of the
/// bare `h`: one that does not directly follow `commands`, because blanks or an empty segment precede it, or that is cut off.
pub(super) const WORDS: &[[u8; 4]] = &[*b"stop", *b"move", *b"reso", *b"ds!h", *b"ds/h"];

/// The words of a path in lower case, however a client has split it.
fn segments(request: &Request) -> Vec<String> {
    let segments = request.path.iter().flat_map(|segment| segment.split('/'));
    segments.map(|segment| bare(segment).to_ascii_lowercase()).filter(|segment| !segment.is_empty()).collect()
}

impl Resources {
    /// Carries out a STOP, and answers when the robot stands: accepted, or refused although it has halted.
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

    /// The parameters of the answer. Only path and method are judged: a STOP counts whatever its query, conditions, format and
    /// body are.
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
