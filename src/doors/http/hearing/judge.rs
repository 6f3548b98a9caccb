//! Authenticates the sender of a request with the same rules as the guard and the gate: a STOP that they would reject does not
//! halt. Of several keys one valid key is enough, since a STOP with a wrong key beside it is a STOP with a fault.

use axum::http::{HeaderMap, HeaderName, HeaderValue, header};

use super::shared::StopOutcome;
use crate::access::Need;
use crate::doors::connection_limits::SlotClaim;
use crate::doors::http::HttpDoor;
use crate::doors::http::command_sender::{IDEMPOTENCY_KEY, command_id};
use crate::doors::http::gate::{allowed, by_path, issuer};
use crate::doors::http::guard::{Hosts, is_foreign};
use crate::doors::http::peer::Peer;
use crate::doors::http::scanning::{Field, Head, names};
use hallsweep_core::command::{Command, Request};

/// A STOP whose sender has the permission to stop.
pub(super) enum StopRequest {
    /// The head names STOP.
    Named(Request),
    /// The request is a STOP if its body says so.
    Unsaid(Request),
}

#[derive(Clone)]
pub(super) struct Judge {
    pub(super) door: HttpDoor,
    pub(super) hosts: Hosts,
    pub(super) peer: Peer,
}

impl Judge {
    /// The sender of a request, and the STOP that the request is or may be, when its sender may stop.
    pub(super) fn hear(&self, head: &Head) -> (SlotClaim, Option<StopRequest>) {
        let (headers, is_in_doubt) = headers(head);
        let caller = self.door.caller_by_any(self.peer, &headers);
        let claim = SlotClaim::new(self.peer.address, caller.as_ref());
        let stop = names::stop(&head.method, &head.path);
        let route = stop.or_else(|| names::says_by_body(&head.method, &head.path));
        let route = route.filter(|_| !is_in_doubt && self.is_ours(head, &headers));
        let (Some(route), Some(caller)) = (route, caller.filter(|caller| allowed(caller, Need::Stop).is_ok())) else {
            return (claim, None);
        };
        let issuer = issuer(&caller, by_path(route), self.peer);
        let request = Request { id: command_id(&headers).unwrap_or_default(), ..Request::new(Command::Stop, issuer) };
        (claim, Some(if stop.is_some() { StopRequest::Named(request) } else { StopRequest::Unsaid(request) }))
    }

    /// Halts at once; the future waits for the result.
    pub(super) fn give(&self, stop: Request) -> StopOutcome {
        Box::pin(self.door.handle.carry_out(stop))
    }

    /// Whether the request names this program as its host, and does not come from a page of another origin.
    fn is_ours(&self, head: &Head, headers: &HeaderMap) -> bool {
        let named = head.host.as_deref().map(String::from_utf8_lossy);
        self.hosts.stranger(named.as_deref(), headers).is_none() && !is_foreign(headers)
    }
}

/// The fields of a head for the guard and the gate, and whether it cannot be said that host and origin are ours.
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
