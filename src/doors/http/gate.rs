//! The gate before every route. It identifies the sender by bearer token or session cookie, then checks whether the
//! sender has the required right. The table of `routes` lists the required rights. `crate::access` has the keys.

use axum::Extension;
use axum::extract::{Request, State};
use axum::http::{HeaderMap, HeaderValue, Method, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Redirect, Response};

use super::guard::is_for_people;
use super::halls::{self, Entered, Halls};
use super::hearing::Pressed;
use super::peer::{Peer, cookies};
use super::prefix::is_of_the_process;
use super::problem::{NotTaken, Problem};
use super::scanning::KEYS;
use super::sign_in::{Undone, sign_in_page};
use super::{HttpDoor, Process};
use crate::access::{Access, Caller, Moment, Need, Network};
use crate::api::door;
use crate::api::fields::in_short;
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{self, Issuer};
use hallsweep_core::refused::Refused;

#[derive(Clone)]
pub(super) struct Gate {
    halls: Halls,
    need: Need,
}

enum Shown {
    Nothing,
    Token(String),
    Sessions(Vec<String>),
}

impl Gate {
    pub(super) const fn new(halls: Halls, need: Need) -> Gate {
        Gate { halls, need }
    }
}

pub(super) fn issuer(caller: &Caller, door: command::Door, peer: Peer) -> Issuer {
    Issuer { door, who: caller.signature(), from: peer.name() }
}

pub(super) fn allowed(caller: &Caller, need: Need) -> Result<(), Refused> {
    caller.may(need).map_err(Refused::NotAllowed)
}

impl HttpDoor {
    /// Records in the journal that this door refused a request (safety A6).
    pub(super) async fn note_refused(&self, issuer: Issuer, asked: Asked, refused: Refused) {
        // Recording fails only while the program is ending. The error cannot be reported to anybody then.
        let _ = self.hall.handle.note_refused(issuer, asked, refused).await;
    }
}

impl Process {
    /// Whether answers can have a date: the clock must not show a time before 1970.
    pub(super) fn can_date(&self) -> bool {
        self.moment().unix_s >= 0
    }

    pub(super) fn moment(&self) -> Moment {
        let now = self.clock.now();
        Moment { elapsed: now.since_start, unix_s: now.wall.unix_ms.div_euclid(1000) }
    }

    pub(super) fn still_knows(&self, caller: &Caller) -> bool {
        self.access.still_knows(caller, self.moment())
    }

    /// Delays a refusal. The delay grows with the number of wrong keys that came from this network.
    pub(super) async fn hold_back(&self, peer: Peer) {
        let delay = self.attempts.wrong(Network::of(peer.address), self.clock.now().since_start);
        let (from, delay_ms) = (peer.address, delay.as_millis());
        self.log_stranger(|| tracing::warn!(%from, delay_ms, "a request came with a wrong key"));
        tokio::time::sleep(delay).await;
    }

    fn log_stranger(&self, write: impl FnOnce()) {
        self.strangers.write(self.clock.now().since_start, write);
    }

    /// Logs a request without recording it in the journal. Strangers must not be able to fill the disk.
    pub(super) fn note_unrecorded(&self, peer: Peer, method: &Method, path: &str, why: &str) {
        let (from, path) = (peer.name(), in_short(path));
        self.log_stranger(|| tracing::info!(%from, %method, %path, why, "refused"));
    }

    /// Returns the owner of any valid key in these headers. Further keys that are wrong do not matter.
    pub(super) fn caller_by_any(&self, peer: Peer, headers: &HeaderMap) -> Option<Caller> {
        let by_token = tokens(headers).find_map(|token| self.caller(peer, &Shown::Token(token)));
        by_token.or_else(|| self.caller(peer, &Shown::Sessions(sessions(headers, &self.cookie))))
    }

    fn caller(&self, peer: Peer, shown: &Shown) -> Option<Caller> {
        let keyring = match &self.access {
            Access::Open => return self.access.unasked(peer.address),
            Access::Keys(keyring) => keyring,
        };
        let signed_in = match shown {
            Shown::Nothing => None,
            Shown::Token(token) => keyring.check(token),
            Shown::Sessions(cookies) => cookies.iter().find_map(|cookie| keyring.session(cookie, self.moment())),
        };
        signed_in.map(Caller::Known)
    }
}

pub(super) async fn gate(
    State(Gate { halls, need }): State<Gate>,
    peer: Peer,
    Extension(Entered { hall, path }): Extension<Entered>,
    mut request: Request,
    next: Next,
) -> Response {
    let process = &halls.process;
    let shown = shown(request.headers(), &process.cookie);
    let caller = process.caller(peer, &shown);
    if need == Need::Nothing {
        if let Some(asked) = request.uri().path_and_query().filter(|asked| hall.is_some() && is_of_the_process(asked.as_str())) {
            return Redirect::temporary(asked.as_str()).into_response();
        }
        if let Some(caller) = caller {
            request.extensions_mut().insert(caller);
        };
        return within(halls.default(), request, next).await;
    }
    let Some(caller) = caller else {
        if matches!(shown, Shown::Token(_)) {
            process.hold_back(peer).await;
        }
        return stranger(process, peer, &path, &request);
    };
    if hall.is_none() && request.uri().path() == halls::LIST {
        request.extensions_mut().insert(halls);
        request.extensions_mut().insert(caller);
        return next.run(request).await;
    }
    let Some(door) = halls.seen_by(&caller, hall.as_ref()) else {
        let first = halls.first_seen_by(&caller).filter(|_| hall.is_none() && path == "/");
        return first.map_or_else(|| Problem::no_hall().into_response(), |first| Redirect::to(&first).into_response());
    };
    let asked = asked(&request, need).map(|(by, asked)| (issuer(&caller, by, peer), asked));
    if let Err(refused) = allowed(&caller, need) {
        if let Some((issuer, asked)) = asked {
            door.note_refused(issuer, asked, refused.clone()).await;
        }
        return Problem::refused(&refused).off_record().into_response();
    }
    request.extensions_mut().insert(caller);
    let pressed = request.extensions().get::<Pressed>().cloned();
    let mut response = within(door.clone(), request, next).await;
    // A request that was recognised as a STOP is already recorded.
    let asked = asked.filter(|_| !pressed.is_some_and(|pressed| pressed.is_there()));
    if let (Some((issuer, asked)), Some(NotTaken(refused))) = (asked, response.extensions_mut().remove::<NotTaken>()) {
        door.note_refused(issuer, asked, refused).await;
    }
    response
}

/// Answers a request in this hall. The layers around the gate find the hall in the answer.
async fn within(door: HttpDoor, mut request: Request, next: Next) -> Response {
    request.extensions_mut().insert(door.clone());
    let mut response = next.run(request).await;
    response.extensions_mut().insert(door);
    response
}

/// Returns what to record if this request is refused: its door, its method and its path. Returns `None` for a request
/// that changes nothing. Signing in and out are not commands.
fn asked(request: &Request, need: Need) -> Option<(command::Door, Asked)> {
    let looks = matches!(*request.method(), Method::GET | Method::HEAD | Method::OPTIONS);
    if looks || need == Need::Nothing {
        return None;
    }
    let path = request.uri().path();
    Some((by_path(path), Asked::Words(format!("{} {}", request.method(), in_short(path)))))
}

pub(super) fn by_path(path: &str) -> command::Door {
    if path.starts_with("/console/") || path.starts_with("/simulator/") { door::CONSOLE } else { door::HTTP }
}

/// Answers a sender without credentials. A browser that requests a page is redirected to the sign-in page, which
/// leads back to the requested page. For any other request of a browser, the sign-in page says that the command was
/// not carried out. A program gets a problem that says what to send.
fn stranger(process: &Process, peer: Peer, path: &str, request: &Request) -> Response {
    if *request.method() != Method::GET {
        process.note_unrecorded(peer, request.method(), path, "nobody is signed in");
    }
    if is_for_people(request.uri().path(), request.headers()) {
        let query = request.uri().query().map_or_else(String::new, |query| format!("?{query}"));
        let page = if *request.method() == Method::GET {
            sign_in_page(&format!("{path}{query}"))
        } else {
            Undone::of(request.uri().path()).page()
        };
        return Redirect::to(&page).into_response();
    }
    let mut response = Problem::not_signed_in().into_response();
    response.headers_mut().insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
    response
}

/// Returns the credentials of a request. A bearer token takes precedence over the cookie. Any other kind of
/// authorization is meant for a proxy; in that case the cookie is used.
fn shown(headers: &HeaderMap, cookie: &str) -> Shown {
    if let Some(token) = tokens(headers).next() {
        return Shown::Token(token);
    }
    let ours = sessions(headers, cookie);
    if ours.is_empty() { Shown::Nothing } else { Shown::Sessions(ours) }
}

fn tokens(headers: &HeaderMap) -> impl Iterator<Item = String> {
    let shown = headers.get_all(header::AUTHORIZATION).iter();
    let bearers = shown.filter_map(|value| {
        let (scheme, token) = value.to_str().ok()?.split_once(' ')?;
        scheme.eq_ignore_ascii_case("bearer").then(|| token.trim().to_owned())
    });
    bearers.take(KEYS)
}

fn sessions(headers: &HeaderMap, cookie: &str) -> Vec<String> {
    cookies(headers, cookie).map(str::to_owned).take(KEYS).collect()
}

#[cfg(test)]
#[path = "gate_tests.rs"]
mod tests;
