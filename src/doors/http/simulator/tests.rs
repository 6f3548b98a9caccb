//! The door's own refusals, before anything is asked of a simulator.

use super::super::testing::{app, guarded_app, keys, text};
use crate::access::Access;
use crate::api::fixture::searching;

const ROUTES: [(&str, &str); 9] = [
    ("GET", "/simulator"),
    ("POST", "/simulator/change"),
    ("POST", "/simulator/hall"),
    ("GET", "/simulator/editor"),
    ("GET", "/api/v1/simulator"),
    ("PUT", "/api/v1/simulator"),
    ("POST", "/api/v1/simulator/step"),
    ("PUT", "/api/v1/simulator/hall"),
    ("POST", "/api/v1/simulator/hall/check"),
];

#[tokio::test]
async fn where_nothing_is_simulated_every_route_says_so() {
    let app = app(searching());
    for (method, path) in ROUTES {
        let response = app.send(method, path, &[], "").await;
        assert_eq!(response.status(), 404, "{method} {path}");
        assert!(text(response).await.contains("notSimulated"), "{method} {path}");
    }
    let console = text(app.get("/").await).await;
    assert!(!console.contains("href=\"/simulator\""), "the console leads nobody there");
}

/// Safety A3.
#[tokio::test]
async fn a_viewer_changes_nothing_and_a_stranger_sees_nothing() {
    let (keyring, tokens) = keys();
    let app = guarded_app(searching(), Access::Keys(keyring));
    let bearer = format!("Bearer {}", tokens.viewer);
    for (method, path) in ROUTES {
        assert_eq!(app.send(method, path, &[], "").await.status(), 401, "{method} {path}");
        let expect = if method == "GET" { 404 } else { 403 };
        let response = app.send(method, path, &[("authorization", &bearer)], "").await;
        assert_eq!(response.status(), expect, "{method} {path}");
    }
}
