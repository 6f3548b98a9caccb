//! Finds the requests of one connection. A STOP is carried out as soon as it has arrived, in a head or in a body. The
//! sender is authenticated with the same rules as in the guard and the gate: a STOP that they would reject does not
//! halt. If a request has several keys, one valid key is enough. Wrong keys beside it do not prevent the halt.
//! `connection` reads the bytes and passes them on.

use axum::http::{HeaderMap, HeaderName, HeaderValue, header};

use super::shared::{Arrived, StopOutcome};
use crate::access::Need;
use crate::api::halt::{says_halt, says_halt_from};
use crate::doors::connection_limits::SlotClaim;
use crate::doors::http::command::{IDEMPOTENCY_KEY, command_id};
use crate::doors::http::gate::{allowed, by_path, issuer};
use crate::doors::http::guard::{Hosts, is_foreign};
use crate::doors::http::halls::Halls;
use crate::doors::http::peer::Peer;
use crate::doors::http::scanning::{self, BodyLength, Field, Head, Scanner, names};
use crate::runtime::handle::Handle;
use hallsweep_core::command::{Command, Request};

/// A body of at most this many bytes is searched whole whenever more of it arrives. The body of a move has a few
/// dozen bytes. In a longer body, only the new bytes and this many bytes before them are searched.
const SHORT: usize = 1024;

pub(super) struct StopSearch {
    pub(super) judge: Judge,
    pub(super) scanner: Scanner,
    /// The STOP to carry out if the body of the last request says STOP.
    unsaid: Option<StopRequest>,
    /// Number of bytes of the body that were already searched.
    looked: usize,
    /// Length of the body in bytes when it was last searched whole.
    looked_whole: usize,
}

/// A part of a request that is now complete.
pub(super) enum Heard {
    Head(HeardRequest),
    /// The body of the request whose head was found last.
    Body,
}

pub(super) struct HeardRequest {
    pub(super) claim: SlotClaim,
    pub(super) has_body: bool,
    pub(super) may_hand_over: bool,
    pub(super) came: Arrived,
}

impl StopSearch {
    pub(super) fn new(judge: Judge) -> StopSearch {
        let scanner = Scanner::new(&judge.halls.process.cookie);
        StopSearch { judge, scanner, unsaid: None, looked: 0, looked_whole: 0 }
    }

    /// Reads up to the first byte that completes a part, and carries out a STOP found there. Returns the number of
    /// bytes read, the part, and the outcome of the STOP.
    pub(super) fn take(&mut self, bytes: &[u8]) -> (usize, Option<Heard>, Option<StopOutcome>) {
        let (taken, heard) = self.scanner.take(bytes);
        match heard {
            None => (taken, None, None),
            Some(scanning::Heard::Body) => {
                let given = self.look();
                self.unsaid = None;
                (taken, Some(Heard::Body), given)
            }
            Some(scanning::Heard::Head(head)) => {
                let came = self.judge.halls.arrived(names::hall(&head.path));
                let (claim, press) = self.judge.hear(&head);
                let (unsaid, given) = match press {
                    None => (None, None),
                    Some(stop) if stop.is_named => (None, Some(stop.give())),
                    Some(stop) => (Some(stop), None),
                };
                self.unsaid = unsaid;
                (self.looked, self.looked_whole) = (0, 0);
                let asked = HeardRequest {
                    claim,
                    has_body: head.body != BodyLength::Known(0),
                    may_hand_over: head.wants_upgrade && names::is_upgrade(&head.path),
                    came,
                };
                (taken, Some(Heard::Head(asked)), given)
            }
        }
    }

    /// Carries out a STOP in an incomplete body, because the end of the body may never come or may not be recognised.
    /// A long body is searched whole only when its length has doubled, so that many small pieces cost little.
    pub(super) fn look_early(&mut self) -> Option<StopOutcome> {
        let said = self.scanner.said();
        if said.len() == self.looked {
            return None;
        }
        let start = self.looked.saturating_sub(SHORT);
        self.looked = said.len();
        if said.len() <= SHORT || said.len() >= 2 * self.looked_whole {
            self.looked_whole = said.len();
            return self.look();
        }
        self.unsaid.take_if(|_| says_halt_from(said, start)).map(StopRequest::give)
    }

    /// Carries out a STOP in the body. Called when no more of the body comes.
    pub(super) fn look(&mut self) -> Option<StopOutcome> {
        let said = self.scanner.said();
        self.unsaid.take_if(|_| says_halt(said)).map(StopRequest::give)
    }

    /// Returns the number of the last request. The first request has the number 0.
    pub(super) fn number(&self) -> u64 {
        self.scanner.heads().saturating_sub(1)
    }
}

impl Drop for StopSearch {
    /// Searches the body for the last time, because the connection has ended and no more bytes come.
    fn drop(&mut self) {
        drop(self.look());
    }
}

/// A STOP of one hall, from a sender who has the right to stop there.
pub(super) struct StopRequest {
    hall: Handle,
    request: Request,
    /// Whether the path in the head is a STOP route. Otherwise the request is a STOP if its body contains the word for
    /// STOP.
    is_named: bool,
}

impl StopRequest {
    /// Halts the robot at once. The returned future waits for the result.
    fn give(self) -> StopOutcome {
        Box::pin(self.hall.carry_out(self.request))
    }
}

#[derive(Clone)]
pub(super) struct Judge {
    pub(super) halls: Halls,
    pub(super) hosts: Hosts,
    pub(super) peer: Peer,
}

impl Judge {
    /// Returns the sender of a request. If that sender has the right to stop, also returns the STOP that this request
    /// is or may become.
    pub(super) fn hear(&self, head: &Head) -> (SlotClaim, Option<StopRequest>) {
        let (headers, is_in_doubt) = headers(head);
        let caller = self.halls.process.caller_by_any(self.peer, &headers);
        let claim = SlotClaim::new(self.peer.address, caller.as_ref());
        let stop = names::stop(&head.method, &head.path);
        let route = stop.or_else(|| names::says_by_body(&head.method, &head.path));
        let route = route.filter(|_| !is_in_doubt && self.is_ours(head, &headers));
        let (Some(route), Some(caller)) = (route, caller.filter(|caller| allowed(caller, Need::Stop).is_ok())) else {
            return (claim, None);
        };
        let Some(door) = self.halls.seen_by(&caller, names::hall(&head.path).as_ref()) else { return (claim, None) };
        let issuer = issuer(&caller, by_path(route), self.peer);
        let request = Request { id: command_id(&headers).unwrap_or_default(), ..Request::new(Command::Stop, issuer) };
        (claim, Some(StopRequest { hall: door.hall.handle.clone(), request, is_named: stop.is_some() }))
    }

    /// Whether the request is meant for this program: it names no foreign host, and no page of another origin sent
    /// it.
    fn is_ours(&self, head: &Head, headers: &HeaderMap) -> bool {
        let named = head.host.as_deref().map(String::from_utf8_lossy);
        self.hosts.stranger(named.as_deref(), headers).is_none() && !is_foreign(headers)
    }
}

/// Returns the headers that the guard and the gate need. Also returns whether the host or the origin is unknown.
fn headers(head: &Head) -> (HeaderMap, bool) {
    let (mut headers, mut is_in_doubt) = (HeaderMap::new(), head.is_in_doubt);
    for (field, value) in &head.fields {
        match (HeaderValue::from_bytes(value), field) {
            (Ok(value), field) => drop(headers.append(name(*field), value)),
            (Err(_), Field::Host | Field::Origin | Field::SecFetchSite) => is_in_doubt = true,
            (Err(_), Field::Authorization | Field::Cookie | Field::IdempotencyKey) => {}
        }
    }
    (headers, is_in_doubt)
}

fn name(field: Field) -> HeaderName {
    match field {
        Field::Host => header::HOST,
        Field::Origin => header::ORIGIN,
        Field::SecFetchSite => HeaderName::from_static("sec-fetch-site"),
        Field::Authorization => header::AUTHORIZATION,
        Field::Cookie => header::COOKIE,
        Field::IdempotencyKey => IDEMPOTENCY_KEY,
    }
}

#[cfg(test)]
#[path = "judge_tests.rs"]
mod tests;
