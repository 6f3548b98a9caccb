//! The interface between the socket loop and the resources, and the answers when the resources panic.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::Pin;
use std::sync::Arc;

use crate::runtime::figures::Connected;
use coap_endpoint::{Answer, Code, RefusedRequest, Request, Response};

/// Added to the answer when a STOP has halted the robot although its request is refused.
pub(super) const HALTED: &str = "the robot was halted anyway";

pub enum Reply {
    Now(Answer),
    /// The answer is the output of the future. A command has begun already. A read begins when its future is polled, and may be
    /// dropped.
    Later(Pin<Box<dyn Future<Output = Answer> + Send>>),
}

/// The resources of the program, or those of a test.
pub trait Application: Send + 'static {
    /// Answers a request, and sends its command, so that commands keep the order in which they came; must not block.
    fn answer(&self, request: &Request) -> Reply;

    /// Told when there is a newer state; must not block.
    fn handle_change(&self) {}

    /// The present representations for an observer of this request; must not block.
    fn things(&self, request: &Request) -> Vec<Arc<Response>>;

    /// Whether a request is a STOP of somebody who may press it here, by its method, path and payload alone. This STOP is
    /// carried out whatever else is wrong with the request, and however many commands are under way (safety S8).
    const IS_STOP: fn(&Request) -> bool;

    /// Words of four bytes, in lower case by the bit 0x20 of each byte. The path of a STOP in its usual form contains at least
    /// one of these words, which lets the STOP through the flood filter before it is parsed. A STOP without any of them is
    /// filtered like other commands.
    const STOP_WORDS: &'static [[u8; 4]];

    /// Number of requests so far, at all doors, that may have undone a STOP; must not block.
    fn undone(&self) -> u64;

    /// Records a request that the endpoint refused without asking; must not block.
    fn note(&self, refusal: RefusedRequest);

    /// Counts one observation until the returned value is dropped.
    fn observed(&self) -> Connected;

    /// Records that a command was refused because too many are under way; must not block.
    fn note_busy(&self, request: &Request);
}

/// Asks for an answer; a panic of the application ends only this request (safety A7).
pub(super) fn answer(application: &impl Application, request: &Request) -> Reply {
    let asked = AssertUnwindSafe(|| application.answer(request));
    catch_unwind(asked).unwrap_or_else(|_| Reply::Now(broken()))
}

pub(super) fn changed(application: &impl Application) {
    // A panic is in the log already, and does not end the door.
    let _ = catch_unwind(AssertUnwindSafe(|| application.handle_change()));
}

/// A panic of the application costs only this notification (safety A7).
pub(super) fn things(application: &impl Application, request: &Request) -> Option<Vec<Arc<Response>>> {
    catch_unwind(AssertUnwindSafe(|| application.things(request))).ok()
}

pub(super) fn broken() -> Answer {
    let words = "a mistake in hallsweep ended this request; its log says more";
    Answer::once(Response::refusal(Code::INTERNAL, words.to_owned()))
}
