//! What the socket loop asks of whoever knows the resources, and what is said in its place when it breaks. What the resources are
//! stands with those who implement it.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::Pin;
use std::sync::Arc;

use crate::runtime::figures::Connected;
use coap_endpoint::{Answer, Code, RefusedRequest, Request, Response};

/// What whoever pressed STOP is told first, where his request is refused.
pub(super) const HALTED: &str = "halted all the same";

pub enum Reply {
    Now(Answer),
    /// The answer comes when this ends. A command's work is begun; a read begins when this is waited for, and may be dropped.
    Later(Pin<Box<dyn Future<Output = Answer> + Send>>),
}

/// Whoever knows the resources: those of the program, or a test's.
pub trait Application: Send + 'static {
    /// Takes a request. A command is given in here, so that commands keep the order in which they came; must not block.
    fn answer(&self, request: &Request) -> Reply;

    /// There is a newer state; must not block.
    fn handle_change(&self) {}

    /// What an observer of this request sees now; must not block.
    fn things(&self, request: &Request) -> Vec<Arc<Response>>;

    /// Whether a request is a STOP of somebody who may press it here, by its method, path and payload alone: it is taken whatever
    /// is wrong with the rest, and however much is under way already (safety S8).
    const IS_STOP: fn(&Request) -> bool;

    /// Four bytes each: a STOP as it is usually written has at least one of them in its path, with the bit set that makes letters
    /// small. By these it is known in a flood before it is read; one that has none of them is thinned out there like any command.
    const STOP_WORDS: &'static [[u8; 4]];

    /// How many requests came so far, at any door, that may have undone what a STOP did; must not block.
    fn undone(&self) -> u64;

    /// Notes what the endpoint refused without asking; must not block.
    fn note(&self, refusal: RefusedRequest);

    /// Counts an observation, for as long as what is returned lives.
    fn observed(&self) -> Connected;

    /// Notes that a command was not taken because too many are under way; must not block.
    fn note_busy(&self, request: &Request);
}

/// Asks for an answer; a mistake of the application ends this request alone (safety A7).
pub(super) fn answer(application: &impl Application, request: &Request) -> Reply {
    let asked = AssertUnwindSafe(|| application.answer(request));
    catch_unwind(asked).unwrap_or_else(|_| Reply::Now(broken()))
}

pub(super) fn changed(application: &impl Application) {
    // What breaks over it was logged, and is no reason for the door to end.
    let _ = catch_unwind(AssertUnwindSafe(|| application.handle_change()));
}

/// Asks what observers see; nothing, when the application breaks over it.
pub(super) fn things(application: &impl Application, request: &Request) -> Option<Vec<Arc<Response>>> {
    catch_unwind(AssertUnwindSafe(|| application.things(request))).ok()
}

/// 5.00: a mistake in the program ended this request.
pub(super) fn broken() -> Answer {
    let words = "a mistake in hallsweep ended this request; its log says more";
    Answer::once(Response::refusal(Code::INTERNAL, words.to_owned()))
}
