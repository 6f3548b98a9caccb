//! The interface between the socket loop and the resources, and the answers if the resources panic.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::Pin;
use std::sync::Arc;

use crate::runtime::figures::Connected;
use coap_endpoint::{Answer, Code, RefusedRequest, Request, Response};

/// Added to the answer to a STOP that has halted the robot although its request is refused.
pub(super) const HALTED: &str = "the robot was halted anyway";

pub enum Reply {
    Now(Answer),
    /// The answer follows when the future is ready. A command has already begun when this is returned. A read begins
    /// when the future is polled for the first time, and may be dropped.
    Later(Pin<Box<dyn Future<Output = Answer> + Send>>),
}

/// What the socket loop needs from the resources. The program and the tests have one implementation each.
pub trait Application: Send + 'static {
    /// Answers a request. A command is sent before this returns, so that commands keep the order in which they came.
    /// Must not block.
    fn answer(&self, request: &Request) -> Reply;

    /// Called when there is a newer state. Must not block.
    fn handle_change(&self) {}

    /// Returns the present representations for an observer of this request. Must not block.
    fn things(&self, request: &Request) -> Vec<Arc<Response>>;

    /// Whether a request is a STOP and its sender may press STOP here. Only sender, method, path and payload count.
    /// Such a STOP is carried out whatever else is wrong with the request, and however many commands are under way
    /// (safety S8).
    const IS_STOP: fn(&Request) -> bool;

    /// Words of four bytes, where each byte has the bit 0x20 set (lower case). The path of a STOP in its usual form
    /// contains at least one of them. The flood filter lets such a datagram through before it is parsed. A STOP
    /// without any of these words is filtered like other commands.
    const STOP_WORDS: &'static [[u8; 4]];

    /// Returns how many requests so far, at all doors, may have undone a STOP. Must not block.
    fn undone(&self) -> u64;

    /// Records a request that the endpoint refused without calling `answer`. Must not block.
    fn note(&self, refusal: RefusedRequest);

    /// Counts one observation until the returned value is dropped.
    fn observed(&self) -> Connected;

    /// Records that a command was refused because too many commands are under way. Must not block.
    fn note_busy(&self, request: &Request);
}

/// Calls the application's `answer`. If the application panics, only this request fails (safety A7).
pub(super) fn answer(application: &impl Application, request: &Request) -> Reply {
    let asked = AssertUnwindSafe(|| application.answer(request));
    catch_unwind(asked).unwrap_or_else(|_| Reply::Now(broken()))
}

pub(super) fn changed(application: &impl Application) {
    // A panic is logged already, and does not end the door.
    let _ = catch_unwind(AssertUnwindSafe(|| application.handle_change()));
}

/// Calls the application's `things`. If the application panics, only this notification is lost (safety A7).
pub(super) fn things(application: &impl Application, request: &Request) -> Option<Vec<Arc<Response>>> {
    catch_unwind(AssertUnwindSafe(|| application.things(request))).ok()
}

pub(super) fn broken() -> Answer {
    let words = "a mistake in hallsweep ended this request; its log says more";
    Answer::once(Response::refusal(Code::INTERNAL, words.to_owned()))
}
