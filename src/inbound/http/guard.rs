//! What stands in front of every route: security headers, refusal of other origins' posts, compression, and the catching of
//! panics. It knows no route.

use axum::Router;
use axum::extract::Request;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Method, header};
use axum::middleware::{Next, from_fn};
use axum::response::{IntoResponse, Response};
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::compression::CompressionLayer;
use tower_http::set_header::SetResponseHeaderLayer;

use super::problem::Problem;

/// Nothing but this origin's own files, no inline script or style, no frame, no form to anywhere else.
const CONTENT_SECURITY_POLICY: &str = "default-src 'self'; object-src 'none'; frame-ancestors 'none'; form-action 'self'; \
                                       base-uri 'none'";

/// On every answer, whatever it is.
const SECURITY: [(HeaderName, &str); 6] = [
    (header::CONTENT_SECURITY_POLICY, CONTENT_SECURITY_POLICY),
    (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
    (header::X_FRAME_OPTIONS, "DENY"),
    (header::REFERRER_POLICY, "no-referrer"),
    (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
    (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
];

/// The routes behind their guard. Compression leaves event streams and pictures alone.
pub(super) fn guarded(routes: Router) -> Router {
    let guarded = routes
        .layer(from_fn(same_origin))
        .layer(CatchPanicLayer::custom(|_: Box<dyn std::any::Any + Send>| Problem::internal().into_response()))
        .layer(CompressionLayer::new())
        .layer(SetResponseHeaderLayer::if_not_present(header::CACHE_CONTROL, HeaderValue::from_static("no-cache")));
    SECURITY.into_iter().fold(guarded, |router, (name, value)| {
        router.layer(SetResponseHeaderLayer::overriding(name, HeaderValue::from_static(value)))
    })
}

/// A page of another origin may not press buttons here. Programs send neither header and pass.
async fn same_origin(request: Request, next: Next) -> Response {
    if matches!(*request.method(), Method::GET | Method::HEAD | Method::OPTIONS) || !is_foreign(request.headers()) {
        return next.run(request).await;
    }
    Problem::foreign("a page of another origin sent this: commands are taken from hallsweep's own page and from programs".into())
        .into_response()
}

/// By what the browser says of the sender; older ones name only the origin, which is then compared with the host asked for.
fn is_foreign(headers: &HeaderMap) -> bool {
    let text = |name: HeaderName| headers.get(name).map(|value| value.to_str().unwrap_or("unreadable"));
    match text(HeaderName::from_static("sec-fetch-site")) {
        Some(site) => !matches!(site, "same-origin" | "none"),
        None => match text(header::ORIGIN) {
            Some(origin) => origin.split_once("://").map(|(_, host)| host) != text(header::HOST),
            None => false,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::house;
    use super::*;
    use crate::wire::fixture::searching;

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

    #[tokio::test]
    async fn every_answer_of_every_kind_carries_the_security_headers() {
        let house = house(searching());
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
            ("GET", "/console/confirm/danger/3"),
            ("GET", "/static/console.css"),
            ("GET", "/static/console.js"),
            ("GET", "/static/vendor/idiomorph.js"),
            ("GET", "/static/icon.svg"),
            ("GET", "/favicon.ico"),
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
            let response = house.send(method, path, &[], "").await;
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
        let house = house(searching());
        for path in ["/api/v1/events", "/console/live"] {
            let response = house.send("GET", path, &[("accept-encoding", "gzip")], "").await;
            assert!(response.headers().get("content-encoding").is_none(), "{path}");
        }
        let response = house.send("GET", "/", &[("accept-encoding", "gzip")], "").await;
        assert_eq!(response.headers()["content-encoding"], "gzip");
        assert!(response.headers().get_all("vary").iter().any(|vary| vary == "accept-encoding"));
    }

    #[test]
    fn another_origin_does_not() {
        assert!(foreign(&[("host", "127.0.0.1:8080"), ("origin", "http://elsewhere.example")]));
        assert!(foreign(&[("host", "127.0.0.1:8080"), ("origin", "null")]));
        assert!(foreign(&[("sec-fetch-site", "cross-site")]));
        assert!(foreign(&[("sec-fetch-site", "same-site"), ("host", "a"), ("origin", "http://a")]));
    }
}
