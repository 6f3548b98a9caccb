//! Layers before every route: security headers, refusal of foreign hosts, refusal of commands from other origins,
//! error pages for browsers, compression, and catching of panics. They do not depend on the route.

use std::borrow::Cow;
use std::net::IpAddr;
use std::sync::Arc;

use askama::Template;
use axum::Router;
use axum::body::{Body, HttpBody, to_bytes};
use axum::extract::{Request, State};
use axum::http::uri::Authority;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, StatusCode, Version, header};
use axum::middleware::{Next, from_fn, from_fn_with_state, map_request, map_response};
use axum::response::{IntoResponse, Response};
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::set_header::SetResponseHeaderLayer;

use super::accept::{codings, preferred};
use super::halls::Halls;
use super::language::spoken;
use super::peer::Peer;
use super::prefix::local;
use super::prefix::{is_page, relative};
use super::problem::{Detail, Problem, halted, in_words};
use super::{HttpDoor, Process};
use crate::api::fields::in_short;
use crate::phrases::Language;
use hallsweep_core::units::MissionId;

/// Allows only files of this origin. Inline scripts, inline styles, frames and forms to another origin are forbidden.
const CONTENT_SECURITY_POLICY: &str = "default-src 'self'; object-src 'none'; frame-ancestors 'none'; form-action 'self'; \
                                       base-uri 'self'";

/// Headers of every answer, error answers included.
const SECURITY: [(HeaderName, &str); 6] = [
    (header::CONTENT_SECURITY_POLICY, CONTENT_SECURITY_POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
];

/// Host names of this program. Other names are refused: a foreign page could use a name of its own that leads to this
/// machine (DNS rebinding). IP addresses are safe, because nobody can redirect them.
#[derive(Clone, Debug)]
pub struct Hosts {
    is_local: bool,
    names: Arc<[String]>,
}

impl Hosts {
    /// Creates the list of accepted names: this machine's own names, and `names`. If other machines can reach the
    /// program (`is_local` is false), any IP address is accepted too.
    pub fn new(is_local: bool, names: &[String]) -> Hosts {
        Hosts { is_local, names: names.iter().map(|name| plain(name)).collect() }
    }

    /// Whether a host name means this program. A port after the name is ignored.
    fn knows(&self, host: &str) -> bool {
        let Ok(authority) = host.parse::<Authority>() else { return false };
        let name = plain(authority.host());
        match name.trim_start_matches('[').trim_end_matches(']').parse::<IpAddr>() {
            Ok(address) => !self.is_local || address.is_loopback(),
            Err(_) => name == "localhost" || name.ends_with(".localhost") || self.names.contains(&name),
        }
    }

    /// Returns the first foreign host name in a request. Checks the host in the request's target (`named`) first, if
    /// there is one, then all headers `Host`.
    pub(super) fn stranger(&self, named: Option<&str>, headers: &HeaderMap) -> Option<String> {
        let hosts = headers.get_all(header::HOST).iter().map(|name| String::from_utf8_lossy(name.as_bytes()));
        let mut names = named.map(Cow::Borrowed).into_iter().chain(hosts);
        names.find(|name| !self.knows(name)).map(Cow::into_owned)
    }

    fn advice(&self) -> &'static str {
        if self.is_local {
            "hallsweep listens only on this machine: use the host localhost or 127.0.0.1; behind a proxy, list the proxy's host \
             names in http.hosts"
        } else {
            "use the IP address of this machine, or list the machine's host names in http.hosts"
        }
    }
}

/// Normalises a host name. Upper and lower case are equal, and a dot at the end is allowed (RFC 3986, section 3.2.2).
fn plain(name: &str) -> String {
    name.trim_end_matches('.').to_ascii_lowercase()
}

/// Adds the layers, the innermost first. A request passes them from the bottom of this list to the top, and then the
/// gate of its route. `CompressionLayer` does not compress event streams and pictures; this is its default.
pub(super) fn guarded(routes: Router, hosts: Hosts, halls: &Halls) -> Router {
    let clock = halls.process.clock;
    let guarded = routes
        .layer(from_fn_with_state(Arc::clone(&halls.process), same_origin))
        .layer(from_fn_with_state(hosts, own_name))
        .layer(from_fn(for_people))
        .layer(from_fn(in_an_exercise))
        .layer(map_response(in_a_language))
        .layer(from_fn(relative))
        .layer(CatchPanicLayer::custom(|_: Box<dyn std::any::Any + Send>| Problem::internal().into_response()))
        .layer(CompressionLayer::new())
        .layer(map_request(as_it_is))
        .layer(SetResponseHeaderLayer::if_not_present(header::CACHE_CONTROL, HeaderValue::from_static("no-cache")))
        .layer(SetResponseHeaderLayer::if_not_present(header::DATE, move |_: &Response| date(clock.now().wall.unix_ms)));
    SECURITY.into_iter().fold(guarded, |router, (name, value)| {
        router.layer(SetResponseHeaderLayer::overriding(name, HeaderValue::from_static(value)))
    })
}

/// Ignores that a client refuses uncompressed answers, and sends it an uncompressed answer. An error instead would
/// make a command that was carried out look refused.
async fn as_it_is(mut request: Request) -> Request {
    let is_refused = |(name, quality): (&str, f32)| quality == 0.0 && (name == "*" || name.eq_ignore_ascii_case("identity"));
    if codings(request.headers()).any(is_refused) {
        request.headers_mut().remove(header::ACCEPT_ENCODING);
    }
    request
}

/// Refuses requests with a missing, faulty or foreign host name. A foreign name means that somebody else has led the
/// browser to this program.
async fn own_name(State(hosts): State<Hosts>, request: Request, next: Next) -> Response {
    if let Some(fault) = host_fault(&request) {
        let halted = halted(request.extensions().get());
        return Problem::malformed(format!("{fault}: name the host once, as in Host: localhost:8080{halted}")).into_response();
    }
    match hosts.stranger(request.uri().authority().map(Authority::as_str), request.headers()) {
        None => next.run(request).await,
        Some(name) => Problem::misdirected(format!("this host is not {:?}: {}", in_short(&name), hosts.advice())).into_response(),
    }
}

/// Returns what is wrong with the host name of a request, or `None` (RFC 9112, section 3.2).
fn host_fault(request: &Request) -> Option<&'static str> {
    let hosts: Vec<&HeaderValue> = request.headers().get_all(header::HOST).iter().collect();
    match hosts[..] {
        [] => (request.version() == Version::HTTP_11).then_some("the header Host is missing, which HTTP/1.1 requires"),
        [host] => (!is_host(host)).then_some("the header Host is no valid host name or address"),
        _ => Some("there is more than one header Host"),
    }
}

/// Whether this header is a host, with or without a port. A user name before the host is a fault.
fn is_host(value: &HeaderValue) -> bool {
    let Some(authority) = value.to_str().ok().and_then(|text| text.parse::<Authority>().ok()) else { return false };
    let port = authority.as_str().strip_prefix(authority.host());
    port.is_some_and(|port| {
        port.is_empty() || port.strip_prefix(':').is_some_and(|port| port.bytes().all(|byte| byte.is_ascii_digit()))
    })
}

/// Whether a browser requests a page. Paths under `/api` are always for programs.
pub(super) fn is_for_people(path: &str, headers: &HeaderMap) -> bool {
    !path.starts_with("/api/") && preferred(headers, &["application/json", "text/html"]) == Some("text/html")
}

/// Tells caches which headers select the language of a page.
async fn in_a_language(mut response: Response) -> Response {
    if is_page(&response) {
        response.headers_mut().append(header::VARY, HeaderValue::from_static("accept-language, cookie"));
    }
    response
}

/// Converts a problem to a page if a browser requested a page. Programs get the problem as JSON, and so does every
/// request under `/api`.
async fn for_people(request: Request, next: Next) -> Response {
    let is_program = !is_for_people(request.uri().path(), request.headers());
    let language = spoken(request.headers());
    // The answer to a form cannot be requested again with its address.
    let can_be_shown_again = !is_program && *request.method() == Method::GET;
    let asked = request.uri().path_and_query().filter(|_| can_be_shown_again).map(|path| path.as_str().to_owned());
    let mut response = next.run(request).await;
    let Some(Detail { code, detail, of_core }) = response.extensions_mut().remove::<Detail>() else { return response };
    response.headers_mut().append(header::VARY, HeaderValue::from_static("accept"));
    if is_program {
        return response;
    }
    let (mut parts, _) = response.into_parts();
    parts.headers.remove(header::CONTENT_LENGTH);
    parts.headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("text/html; charset=utf-8"));
    // Under a foreign host name STOP would be refused too, and without a hall it would halt nothing. The page must not
    // offer it.
    let may_stop = parts.status != StatusCode::MISDIRECTED_REQUEST && code != "noHall";
    let detail = of_core.map_or_else(|| in_words(language, code, &detail), |refused| language.refused(&refused));
    let title = title(parts.status);
    let page = Astray { language, title, detail, may_stop, here: local(asked.as_deref()) };
    let page = page.render().expect("the template only writes strings, which does not fail");
    Response::from_parts(parts, page.into())
}

/// Marks the pages of missions that are exercises, and all other pages while the program runs an exercise. A report is
/// sent as a stream and has its own mark.
async fn in_an_exercise(request: Request, next: Next) -> Response {
    const TOP: &str = "<header id=\"top\">";
    let language = spoken(request.headers());
    let mission = request.uri().path().strip_prefix("/missions/").and_then(|rest| rest.split('/').next()?.parse().ok());
    let mut response = next.run(request).await;
    let is_whole = response.body().size_hint().exact().is_some();
    let door = response.extensions_mut().remove::<HttpDoor>().filter(|_| is_whole && is_page(&response));
    let Some(door) = door else { return response };
    let is_exercise = match mission.map(MissionId) {
        Some(mission) => {
            let record = door.hall.archive.look_up(move |archive| archive.mission(mission)).await;
            record.is_ok_and(|record| record.is_some_and(|record| record.is_exercise))
        }
        None => door.hall.handle.snapshot().mission.is_exercise,
    };
    if !is_exercise {
        return response;
    }
    let (mut parts, body) = response.into_parts();
    parts.headers.remove(header::CONTENT_LENGTH);
    let page = to_bytes(body, usize::MAX).await.expect("a page is in memory");
    let mark = format!("<p class=\"exercise\">{}</p>\n{TOP}", language.say("exercise"));
    Response::from_parts(parts, Body::from(String::from_utf8_lossy(&page).replacen(TOP, &mark, 1)))
}

/// Statuses that have a title in plain words. All other statuses get the first title, which says that the request was
/// not understood.
const TITLES: [&str; 9] = ["400", "401", "403", "404", "408", "409", "421", "500", "503"];

fn title(status: StatusCode) -> &'static str {
    TITLES.into_iter().find(|title| *title == status.as_str()).unwrap_or(TITLES[0])
}

#[derive(Template)]
#[template(path = "astray.html")]
struct Astray<'a> {
    language: Language,
    /// Key of the page's title in the list of phrases.
    title: &'static str,
    detail: String,
    may_stop: bool,
    here: &'a str,
}

/// Refuses a request that a page of another origin sent, unless the request only reads. A program sends no header
/// about its origin and is not refused.
async fn same_origin(State(process): State<Arc<Process>>, request: Request, next: Next) -> Response {
    if matches!(*request.method(), Method::GET | Method::HEAD | Method::OPTIONS) || !is_foreign(request.headers()) {
        return next.run(request).await;
    }
    if let Some(peer) = request.extensions().get::<Peer>() {
        process.note_unrecorded(*peer, request.method(), request.uri().path(), "a page of another origin sent the request");
    }
    let detail =
        "a page of another origin sent this request: hallsweep accepts commands only from its own page and from programs";
    Problem::foreign(detail.to_owned()).into_response()
}

/// Whether a page of another origin sent the request. The header `Sec-Fetch-Site` decides. Older browsers send only
/// the header `Origin`; its host is then compared with the header `Host`.
pub(super) fn is_foreign(headers: &HeaderMap) -> bool {
    let texts = |name: HeaderName| headers.get_all(name).iter().map(|value| value.to_str().unwrap_or("unreadable"));
    let mut sites = texts(HeaderName::from_static("sec-fetch-site")).peekable();
    if sites.peek().is_some() {
        return sites.any(|site| !matches!(site, "same-origin" | "none"));
    }
    let host = texts(header::HOST).next();
    texts(header::ORIGIN).any(|origin| origin.split_once("://").map(|(_, host)| host) != host)
}

/// Returns the value of the header `Date` (RFC 9110, section 6.6.1). Returns `None` if the clock shows an impossible
/// time.
fn date(unix_ms: i64) -> Option<HeaderValue> {
    let now = jiff::Timestamp::from_millisecond(unix_ms).ok().filter(|_| unix_ms >= 0)?;
    let text = jiff::fmt::rfc2822::DateTimePrinter::new().timestamp_to_rfc9110_string(&now).ok()?;
    HeaderValue::from_str(&text).ok()
}

#[cfg(test)]
mod tests {
    use super::super::testing::{app, text};
    use super::*;
    use crate::api::tests::fixture::searching;

    fn foreign(headers: &[(&'static str, &'static str)]) -> bool {
        let pairs = headers.iter().map(|(name, value)| (HeaderName::from_static(name), HeaderValue::from_static(value)));
        is_foreign(&pairs.collect())
    }

    #[test]
    fn programs_and_the_own_page_pass() {
        assert!(!foreign(&[]));
        assert!(!foreign(&[("host", "127.0.0.1:8080")]));
        assert!(!foreign(&[("host", "127.0.0.1:8080"), ("origin", "http://127.0.0.1:8080")]));
        assert!(!foreign(&[("sec-fetch-site", "same-origin"), ("origin", "https://behind-a-proxy.example")]));
    }

    #[test]
    fn a_date_is_said_unless_the_clock_cannot_be_right() {
        let said = |unix_ms| date(unix_ms).map(|date| date.to_str().unwrap().to_owned());
        assert_eq!(said(1_770_109_512_250).as_deref(), Some("Tue, 03 Feb 2026 09:05:12 GMT"));
        assert_eq!(said(0).as_deref(), Some("Thu, 01 Jan 1970 00:00:00 GMT"));
        for wrong in [-1, i64::MIN, i64::MAX] {
            assert_eq!(said(wrong), None, "{wrong}");
        }
    }

    #[tokio::test]
    async fn every_answer_of_every_kind_carries_the_security_headers() {
        let app = app(searching());
        let walk = [
            ("GET", "/"),
            ("GET", "/healthz"),
            ("GET", "/api/v1/state"),
            ("GET", "/api/v1/map"),
            ("GET", "/api/v1/luggage"),
            ("GET", "/api/v1/luggage/3"),
            ("GET", "/api/v1/luggage/3/photo"),
            ("GET", "/api/v1/events"),
            ("GET", "/console/live"),
            ("GET", "/console/confirm/reset"),
            ("GET", "/console/confirm/close"),
            ("GET", "/console/confirm/closeArea"),
            ("GET", "/console/confirm/handOver"),
            ("GET", "/missions/1/receipts"),
            ("GET", "/api/v1/missions/1/receipts"),
            ("GET", "/console/confirm/danger/3"),
            ("GET", "/static/console.css"),
            ("GET", "/static/console.js"),
            ("GET", "/static/vendor/idiomorph.js"),
            ("GET", "/static/icon.svg"),
            ("GET", "/favicon.ico"),
            ("GET", "/laboratory"),
            ("GET", "/api/v1/laboratory/roomba"),
            ("GET", "/api/v1/laboratory/pallet"),
            ("GET", "/nowhere"),
            ("GET", "/api/v1/luggage/99"),
            ("DELETE", "/"),
            ("POST", "/api/v1/commands/start"),
            ("POST", "/api/v1/commands/move"),
            ("POST", "/console/start"),
            ("POST", "/console/stop"),
            ("POST", "/h"),
            ("PUT", "/api/v1/temperature"),
        ];
        for (method, path) in walk {
            let response = app.send(method, path, &[], "").await;
            for (name, value) in SECURITY {
                assert_eq!(
                    response.headers().get(&name).map(|is| is.as_bytes()),
                    Some(value.as_bytes()),
                    "{method} {path} {name}"
                );
            }
            assert_eq!(response.headers().get_all("cache-control").iter().count(), 1, "{method} {path}");
        }
    }

    #[tokio::test]
    async fn event_streams_are_not_compressed_and_a_vary_says_what_is() {
        let app = app(searching());
        for path in ["/api/v1/events", "/console/live"] {
            let response = app.send("GET", path, &[("accept-encoding", "gzip")], "").await;
            assert!(response.headers().get("content-encoding").is_none(), "{path}");
        }
        let response = app.send("GET", "/", &[("accept-encoding", "gzip")], "").await;
        assert_eq!(response.headers()["content-encoding"], "gzip");
        assert!(response.headers().get_all("vary").iter().any(|vary| vary == "accept-encoding"));
    }

    /// Safety A2.
    #[test]
    fn on_this_machine_alone_only_its_own_names_are_known() {
        let hosts = Hosts::new(true, &["Engine.Example.".to_owned()]);
        for own in
            ["localhost", "LOCALHOST:8080", "localhost.:80", "a.localhost", "127.0.0.1:8080", "127.9.9.9", "[::1]:1", "[::1]"]
        {
            assert!(hosts.knows(own), "{own}");
        }
        assert!(hosts.knows("engine.example:443"), "a proxy's name that is listed");
        for foreign in ["rebound.example:8080", "127.0.0.1.example", "localhost.example", "192.168.0.7", "", "a b", "[::2]"] {
            assert!(!hosts.knows(foreign), "{foreign}");
        }
    }

    /// Safety A2.
    #[test]
    fn beyond_it_any_address_is_known_and_names_that_are_listed() {
        let hosts = Hosts::new(false, &["hall.example".to_owned()]);
        for own in ["192.168.0.7:8080", "[2001:db8::1]:80", "127.0.0.1", "localhost:8080", "hall.example", "HALL.example.:80"] {
            assert!(hosts.knows(own), "{own}");
        }
        for foreign in ["rebound.example", "a.hall.example", "hall.example.org", "", "999.1.1.1", "[::g]"] {
            assert!(!hosts.knows(foreign), "{foreign}");
        }
        assert!(hosts.advice().contains("http.hosts"));
    }

    #[tokio::test]
    async fn a_browser_gone_astray_sees_a_page_and_a_program_a_problem() {
        let app = app(searching());
        let browser = [("accept", "text/html,application/xhtml+xml,*/*;q=0.8")];
        for (method, path, status) in
            [("GET", "/nowhere", 404), ("GET", "/console/start", 405), ("GET", "/console/confirm/danger/x", 404)]
        {
            let response = app.send(method, path, &browser, "").await;
            assert_eq!(response.status(), status, "{path}");
            assert_eq!(response.headers()["content-type"], "text/html; charset=utf-8", "{path}");
            let page = text(response).await;
            assert!(page.contains("href=\"./\"") && page.contains("<h1>"), "{page}");
            assert!(!page.contains("<h1>Not Found") && !page.contains("Unprocessable"), "in words of people: {page}");
            let program = app.send(method, path, &[], "").await;
            assert_eq!(program.headers()["content-type"], "application/problem+json", "{path}");
        }
        let response = app.send("GET", "/api/v1/nothing", &browser, "").await;
        assert_eq!(response.headers()["content-type"], "application/problem+json");
    }

    #[test]
    fn every_title_is_there_in_every_language() {
        for language in Language::ALL {
            let titles: std::collections::BTreeSet<String> =
                TITLES.iter().map(|title| language.say_of("astray", title).to_string()).collect();
            assert_eq!(titles.len(), TITLES.len(), "{titles:?}");
        }
        assert_eq!((title(StatusCode::CONFLICT), title(StatusCode::URI_TOO_LONG)), ("409", "400"));
    }

    #[tokio::test]
    async fn a_problem_is_said_in_the_language_of_the_reader_who_can_have_the_page_in_another() {
        let app = app(searching());
        let page = app.italian("GET", "/nowhere?a=b", "", &[], &[]).await;
        for wanted in
            ["<h1>Pagina non trovata", "non si trova: «there is nothing at /nowhere", "Alla console", "value=\"/nowhere?a=b\""]
        {
            assert!(page.contains(wanted), "{wanted}: {page}");
        }
        assert!(page.contains("lang=\"en\">English</button>"), "{page}");
        let page = app.italian("POST", "/nowhere", "", &[], &[]).await;
        assert!(page.contains("name=\"next\" value=\"/\""), "{page}");
        let page = app.italian("POST", "/language", "language=it", &[("sec-fetch-site", "cross-site")], &[]).await;
        assert!(page.contains("Questo non è permesso") && page.contains("una pagina di un&#39;altra origine"), "{page}");
        let program = app.send("GET", "/nowhere", &[("accept-language", "it")], "").await;
        assert!(text(program).await.contains("there is nothing at /nowhere: the routes"));
    }

    #[test]
    fn another_origin_does_not() {
        assert!(foreign(&[("host", "127.0.0.1:8080"), ("origin", "http://elsewhere.example")]));
        assert!(foreign(&[("host", "127.0.0.1:8080"), ("origin", "null")]));
        assert!(foreign(&[("sec-fetch-site", "cross-site")]));
        assert!(foreign(&[("sec-fetch-site", "same-site"), ("host", "a"), ("origin", "http://a")]));
    }
}
