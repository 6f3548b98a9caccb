//! Signing in and out with a browser: a page with one form, and a cookie. It works without scripts. Opening a link
//! never signs anybody in: a token in the address only fills the field.

use std::sync::Arc;

use askama::Template;
use axum::extract::Query;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{Html, IntoResponse, Redirect, Response};
use serde::Deserialize;

use super::HttpDoor;
use super::language::Spoken;
use super::peer::{LetIn, Peer};
use super::prefix::local;
use super::reading::Form;
use super::scanning::names;
use crate::access::{Access, Network, Person};
use crate::phrases::{Language, Phrase};

pub(super) fn cookie_name(port: u16) -> Arc<str> {
    format!("hallsweep-{port}").into()
}

/// Lifetime of the cookie in seconds: the maximum that browsers allow. The browser measures it with the clock of its
/// own machine. This program decides when the session ends.
const KEPT_S: u64 = 400 * 24 * 60 * 60;

#[derive(Debug, Default, Deserialize)]
pub(super) struct SignInQuery {
    token: Option<String>,
    next: Option<String>,
    undone: Option<Undone>,
}

impl SignInQuery {
    /// Returns the address of the sign-in page with these parameters. A parameter that cannot be escaped is left out.
    fn address(&self) -> String {
        let undone = self.undone.map(Undone::name);
        let parts = [("token", self.token.as_deref()), ("next", self.next.as_deref()), ("undone", undone)];
        let parts = parts.into_iter().filter_map(|(name, value)| Some(format!("{name}={}", escaped(value?)?)));
        let parts: Vec<String> = parts.collect();
        if parts.is_empty() { "/sign-in".to_owned() } else { format!("/sign-in?{}", parts.join("&")) }
    }
}

/// A request that was not carried out, because its sender was not signed in any more.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) enum Undone {
    /// STOP, sent by the page or by an old client.
    Stop,
    Command,
    /// No command: a page was open when the key of its reader was removed.
    Watching,
}

#[derive(Debug, Deserialize)]
pub(super) struct SignInForm {
    token: String,
    #[serde(default)]
    name: String,
    next: Option<String>,
}

#[derive(Default, Template)]
#[template(path = "sign_in.html")]
struct SignIn<'a> {
    language: Language,
    token: &'a str,
    next: &'a str,
    here: String,
    undone: Option<Undone>,
    why: String,
    /// The typed name, and the reason if it is not accepted.
    name: &'a str,
    why_name: String,
    is_overheard: bool,
    is_in: bool,
}

impl Undone {
    pub(super) fn of(path: &str) -> Undone {
        if names::stop(b"POST", path.as_bytes()).is_some() { Undone::Stop } else { Undone::Command }
    }

    pub(super) fn page(self) -> String {
        format!("/sign-in?undone={}", self.name())
    }

    const fn name(self) -> &'static str {
        match self {
            Undone::Stop => "stop",
            Undone::Command => "command",
            Undone::Watching => "watching",
        }
    }

    fn said(self, language: Language) -> Phrase<'static> {
        language.say_of("sign-in-undone", self.name())
    }
}

pub(super) async fn page(
    door: HttpDoor,
    Spoken(language): Spoken,
    peer: Peer,
    caller: Result<LetIn, super::problem::Problem>,
    asked: Result<Query<SignInQuery>, axum::extract::rejection::QueryRejection>,
) -> Response {
    let asked = asked.map(|Query(asked)| asked).unwrap_or_default();
    let next = local(asked.next.as_deref());
    let is_in = caller.is_ok();
    if matches!(door.process.access, Access::Open) || (is_in && asked.token.is_none()) {
        return Redirect::to(next).into_response();
    }
    let why = match &door.process.access {
        Access::Keys(keyring) if keyring.is_unusable() => unusable(language),
        Access::Keys(_) | Access::Open => String::new(),
    };
    let (token, undone, here) = (asked.token.as_deref().unwrap_or_default(), asked.undone, asked.address());
    shown(StatusCode::OK, peer, SignIn { language, token, next, here, undone, why, is_in, ..SignIn::default() })
}

pub(super) async fn sign_in(
    door: HttpDoor,
    Spoken(language): Spoken,
    peer: Peer,
    caller: Result<LetIn, super::problem::Problem>,
    Form(sent): Form<SignInForm>,
) -> Response {
    let next = local(sent.next.as_deref());
    let Access::Keys(keyring) = &door.process.access else { return Redirect::to(next).into_response() };
    let (name, here, is_in) = (sent.name.as_str(), sign_in_page(next), caller.is_ok());
    let Some(person) = Person::new(name) else {
        let why_name = language.say("sign-in-name-unusable").with("most", Person::MOST).to_string();
        let page = SignIn { language, token: &sent.token, next, here, name, why_name, is_in, ..SignIn::default() };
        return shown(StatusCode::UNPROCESSABLE_ENTITY, peer, page);
    };
    let Some(session) = keyring.sign_in(sent.token.trim(), &person, door.process.moment()) else {
        door.process.hold_back(peer).await;
        let why = if keyring.is_unusable() { unusable(language) } else { language.say("sign-in-unknown").to_string() };
        let page = SignIn { language, next, here, why, name, is_in, ..SignIn::default() };
        return shown(StatusCode::FORBIDDEN, peer, page);
    };
    (cookie(&door, &session, KEPT_S, peer), Redirect::to(next)).into_response()
}

pub(super) async fn sign_out(door: HttpDoor, peer: Peer) -> Response {
    (cookie(&door, "", 0, peer), Redirect::to("/sign-in")).into_response()
}

pub(super) fn sign_in_page(next: &str) -> String {
    let next = local(Some(next));
    match escaped(next) {
        Some(next) if next != "/" => format!("/sign-in?next={next}"),
        _ => "/sign-in".to_owned(),
    }
}

/// Escapes a parameter. Tokens, and paths of this door with their queries, have only a few kinds of characters.
/// Returns `None` for any other text.
fn escaped(text: &str) -> Option<String> {
    let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/.-_?=&".contains(&byte);
    let escaped = || text.replace('?', "%3F").replace('=', "%3D").replace('&', "%26");
    text.bytes().all(is_plain).then(escaped)
}

/// Returns the text that is shown when no token exists. Strangers are not told where the file with the tokens is.
fn unusable(language: Language) -> String {
    language.say("sign-in-unusable").to_string()
}

fn shown(status: StatusCode, peer: Peer, page: SignIn) -> Response {
    let is_overheard = !peer.is_encrypted && !Network::of(peer.address).is_loopback();
    let page = SignIn { is_overheard, ..page };
    let html = Html(page.render().expect("the template only writes strings, which does not fail"));
    (status, [(header::CACHE_CONTROL, HeaderValue::from_static("no-store"))], html).into_response()
}

/// Creates a cookie that no script can read and no other site can send. Its path is the folder of the sign-in page as
/// the browser sees it. Another hall on the same host then has a cookie of its own.
fn cookie(door: &HttpDoor, session: &str, kept_s: u64, peer: Peer) -> HeaderMap {
    let secure = if peer.is_encrypted { "; Secure" } else { "" };
    let cookie = format!("{}={session}; Max-Age={kept_s}; HttpOnly; SameSite=Strict{secure}", door.process.cookie);
    let cookie = HeaderValue::from_str(&cookie).expect("a session is letters, digits, dots, - and _");
    HeaderMap::from_iter([(header::SET_COOKIE, cookie)])
}

#[cfg(test)]
#[path = "sign_in_tests.rs"]
mod tests;
