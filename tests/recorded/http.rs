//! The HTTP door as its clients see it: whole answers with status and headers. The date is left out; session
//! cookies and times of the machine's clock are masked.

use std::net::Ipv4Addr;

use axum::Router;
use axum::body::{Body, to_bytes};
use axum::http::{Request, Response};
use futures_util::StreamExt;
use sha2::{Digest, Sha256};
use tower_service::Service;

use super::book::{Book, hex, readable};
use super::doors::{Access, ArchiveReader, HallDoor, HallId, Halls, Hosts, Participant, Snapshot, coming_from, router};
use super::test_app::TestApp;

/// End of all simulated times, in milliseconds since 1970; a later time comes from the machine's clock.
const SIMULATED: u64 = 1_780_000_000_000;

/// Beginnings of elements that contain the machine's time or an age computed from it, and the end of each beginning.
const HANDS: [(&str, &str); 2] = [("this page shows the state at ", ">"), ("data-since=", ">")];

/// Security headers, which every answer has.
const SECURITY: [&str; 6] = [
    "content-security-policy",
    "cross-origin-opener-policy",
    "cross-origin-resource-policy",
    "referrer-policy",
    "x-content-type-options",
    "x-frame-options",
];

/// Accept header of a browser.
pub(crate) const BROWSER: (&str, &str) = ("accept", "text/html,application/xhtml+xml,*/*;q=0.8");

/// A door that is called without sockets.
pub(crate) struct Http {
    router: Router,
}

pub(crate) struct Answered {
    pub(crate) status: u16,
    /// Status, headers and body.
    pub(crate) text: Vec<u8>,
}

impl Http {
    pub(crate) fn new(app: &TestApp, access: Access) -> Http {
        let archive = ArchiveReader::new(app.memory.archive());
        let hall = HallDoor::new(app.handle.clone(), archive, "airport").with_cells_of(Some(0.5));
        let robot = Participant { name: "discovery".into(), kind: "sim".into(), address: None };
        let main = HallId::new("main").expect("a plain name");
        let halls = Halls::new(main, hall.with_robots([robot].into()), access, None);
        Http { router: router(&halls, Hosts::new(false, &[])) }
    }

    /// Sends a request from this machine.
    pub(crate) async fn ask(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> Answered {
        let response = self.response(method, path, headers, body).await;
        let status = response.status().as_u16();
        let mut head = head(&response);
        let is_stream = response.headers().get("content-type").is_some_and(|kind| kind == "text/event-stream");
        let body = if is_stream { first(response).await } else { whole(response).await };
        let masked = masked(&body);
        if masked != body {
            // The length depends on the masked times, so it is left out too.
            head = head.lines().filter(|line| !line.starts_with("content-length:")).map(|line| format!("{line}\n")).collect();
        }
        let text = [head.as_bytes(), readable(&masked).as_bytes()].concat();
        Answered { status, text }
    }

    async fn response(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> Response<Body> {
        let mut request = Request::builder().method(method).uri(path);
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        if !headers.iter().any(|(name, _)| name.eq_ignore_ascii_case("host")) {
            request = request.header("host", "localhost");
        }
        let request = request.body(Body::from(body.to_owned())).expect("a sound request");
        let request = coming_from(request, Ipv4Addr::LOCALHOST.into(), false);
        self.router.clone().call(request).await.expect("the router answers everything")
    }

    async fn show(&self, book: &mut Book, kind: &'static str, path: &str, headers: &[(&str, &str)]) {
        let said: String = headers.iter().map(|(name, value)| format!(" · {name}: {value}")).collect();
        let answered = self.ask("GET", path, headers, "").await;
        book.show(kind, &format!("GET {path}{said}"), &answered.text);
    }

    /// Records every page that shows a state; slow pages only if `is_worth` is set.
    pub(crate) async fn look(&self, book: &mut Book, state: &Snapshot, is_worth: bool) {
        for path in ["/healthz", "/api/v1/state", "/api/v1/robots", "/api/v1/map", "/api/v1/luggage"] {
            self.show(book, "http", path, &[]).await;
        }
        self.show(book, "http", "/api/v1/map", &[("accept", "text/plain")]).await;
        self.show(book, "console", "/", &[]).await;
        if is_worth {
            self.look_closely(book, state).await;
        }
    }

    async fn look_closely(&self, book: &mut Book, state: &Snapshot) {
        let earlier = format!("{}-{}", state.run, state.revision.0.saturating_sub(15));
        self.show(book, "http", "/api/v1/events", &[]).await;
        let missed = self.ask("GET", "/api/v1/events", &[("last-event-id", &earlier)], "").await;
        book.show("http", "GET /api/v1/events of who misses 15 revisions", &missed.text);
        self.show(book, "console", "/console/live", &[]).await;
        for id in state.luggage.iter().map(|piece| piece.id.0).chain([999]) {
            self.show(book, "http", &format!("/api/v1/luggage/{id}"), &[]).await;
            self.show(book, "http", &format!("/api/v1/luggage/{id}/photo"), &[]).await;
            self.show(book, "console", &format!("/luggage/{id}"), &[]).await;
            self.show(book, "console", &format!("/console/confirm/danger/{id}"), &[]).await;
        }
        for path in ["/api/v1/missions", "/api/v1/missions?limit=1", "/api/v1/missions?before=2"] {
            self.show(book, "http", path, &[]).await;
        }
        for mission in (1..=state.mission.id.0).rev().take(2).chain([999]) {
            let path = format!("/api/v1/missions/{mission}");
            self.show(book, "http", &path, &[]).await;
            self.show(book, "http", &format!("{path}/map"), &[]).await;
            self.show(book, "http", &format!("{path}/map"), &[("accept", "text/plain")]).await;
            self.show(book, "http", &format!("{path}/events?limit=3"), &[]).await;
            self.show(book, "http", &format!("{path}/events"), &[]).await;
            self.show(book, "console", &format!("/missions/{mission}"), &[]).await;
        }
        for path in ["/missions", "/console/confirm/reset"] {
            self.show(book, "console", path, &[]).await;
        }
    }

    /// Records what does not depend on the state, and unknown paths.
    pub(crate) async fn look_round(&self, book: &mut Book) {
        let assets =
            ["console.css", "console.js", "stop.js", "vendor/idiomorph.js", "icon.svg"].map(|name| format!("/static/{name}"));
        for path in assets.iter().map(String::as_str).chain(["/favicon.ico", "/sign-in", "/mqtt"]) {
            self.show(book, "http", path, &[]).await;
        }
        for path in
            ["/nowhere", "/api/v1/", "/api/v1/luggage/x", "/api/v1/missions?limit=0", "/api/v1/missions/1/events?x=1", "/w"]
        {
            self.show(book, "http", path, &[]).await;
            self.show(book, "http", path, &[BROWSER]).await;
        }
        for (path, accept) in [("/api/v1/map", "image/png"), ("/api/v1/luggage/1/photo", BROWSER.1), ("/", BROWSER.1)] {
            self.show(book, "http", path, &[("accept", accept)]).await;
        }
        for headers in [&[("host", "elsewhere.example")][..], &[("host", "elsewhere.example"), BROWSER]] {
            self.show(book, "http", "/api/v1/state", headers).await;
            self.show(book, "console", "/", headers).await;
        }
        for (method, path) in
            [("PUT", "/api/v1/state"), ("DELETE", "/"), ("HEAD", "/api/v1/state"), ("GET", "/api/v1/commands/start")]
        {
            let answered = self.ask(method, path, &[], "").await;
            book.show("http", &format!("{method} {path}"), &answered.text);
        }
        let foreign = [("origin", "http://elsewhere.example"), ("host", "127.0.0.1:8080")];
        let answered = self.ask("POST", "/console/start", &foreign, "").await;
        book.show("http", "POST /console/start from another origin", &answered.text);
    }

    /// Records what a client without a key sees: without signing in, the sign-in page, and then what each role may
    /// see.
    pub(crate) async fn sign_in(&self, book: &mut Book, tokens: &[(&str, &str)]) {
        for path in ["/", "/missions", "/api/v1/state", "/sign-in", "/sign-in?next=/missions", "/sign-in?undone=stop", "/healthz"]
        {
            self.show(book, "sign_in", path, &[]).await;
            self.show(book, "sign_in", path, &[BROWSER]).await;
        }
        let form = [("content-type", "application/x-www-form-urlencoded"), BROWSER];
        let posts =
            [("/sign-in", "token=wrong&next=/missions"), ("/sign-in", ""), ("/sign-out", ""), ("/console/stop", ""), ("/w", "")];
        for (path, body) in posts {
            let answered = self.ask("POST", path, &form, body).await;
            book.show("sign_in", &format!("POST {path} {body:?}"), &answered.text);
        }
        for (role, token) in tokens {
            let answered = self.ask("POST", "/sign-in", &form, &format!("token={token}&next=/missions")).await;
            book.show("sign_in", &format!("POST /sign-in as {role}"), &answered.text);
            let bearer = format!("Bearer {token}");
            let asked =
                [("GET", "/"), ("GET", "/api/v1/state"), ("POST", "/api/v1/commands/start"), ("POST", "/api/v1/commands/stop")];
            for (method, path) in asked {
                let answered = self.ask(method, path, &[("authorization", &bearer)], "").await;
                book.show("sign_in", &format!("{method} {path} as {role}"), &answered.text);
            }
        }
    }
}

/// Status and headers without the date, sorted by name; the security headers as their digest.
fn head(response: &Response<Body>) -> String {
    let security = response.headers().iter().filter(|(name, _)| SECURITY.contains(&name.as_str()));
    let mut security: Vec<String> = security.map(|(name, value)| format!("{name}: {value:?}")).collect();
    security.sort_unstable();
    let mut lines: Vec<String> = response
        .headers()
        .iter()
        .filter(|(name, _)| *name != "date" && !SECURITY.contains(&name.as_str()))
        .map(|(name, value)| format!("{name}: {}", cookie_masked(&String::from_utf8_lossy(value.as_bytes()))))
        .collect();
    lines.sort_unstable();
    let security = &hex(&Sha256::digest(security.join("\n")))[..8];
    format!("{}\n{}\n{} headers of security {security}\n\n", response.status(), lines.join("\n"), SECURITY.len())
}

/// Masks the session, which is random.
fn cookie_masked(value: &str) -> String {
    match value.split_once('=').and_then(|(name, rest)| Some((name, rest.split_once("; Max-Age=")?))) {
        Some((name, (session, rest))) if !session.is_empty() => format!("{name}=‹session›; Max-Age={rest}"),
        _ => value.to_owned(),
    }
}

/// Masks every time of the machine's clock: a number of 13 digits that is later than the simulated times.
fn masked(body: &[u8]) -> Vec<u8> {
    let Ok(text) = std::str::from_utf8(body) else { return body.to_vec() };
    let mut masked = String::with_capacity(text.len());
    let mut digits = String::new();
    for letter in text.chars().chain(['\0']) {
        if letter.is_ascii_digit() {
            digits.push(letter);
            continue;
        }
        let is_now = digits.len() == 13 && digits.parse::<u64>().is_ok_and(|number| number > SIMULATED);
        masked.push_str(if is_now { "‹now›" } else { &digits });
        digits.clear();
        masked.push(letter);
    }
    masked.pop();
    HANDS.iter().fold(masked, |text, (before, after)| between_masked(&text, before, after)).into_bytes()
}

/// Replaces the text between an element's beginning (`before` up to `ends`) and the next `<`.
fn between_masked(text: &str, before: &str, ends: &str) -> String {
    let mut parts = text.split(before);
    let mut masked = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (head, rest) = part.split_once(ends).unwrap_or((part, ""));
        let rest = rest.find('<').map_or("", |end| &rest[end..]);
        masked.push_str(&format!("{before}{head}{ends}‹now›{rest}"));
    }
    masked
}

async fn whole(response: Response<Body>) -> Vec<u8> {
    to_bytes(response.into_body(), usize::MAX).await.expect("the body ends").to_vec()
}

async fn first(response: Response<Body>) -> Vec<u8> {
    let mut stream = response.into_body().into_data_stream();
    let chunk = stream.next().await.expect("a stream begins with something");
    chunk.expect("nothing fails here").to_vec()
}
