//! Compares the description with the table of routes in both directions, and checks that it is consistent.
//! `tests/service` checks that real answers match it.

use std::collections::BTreeSet;

use super::super::testing::{app, guarded_app, keys, read, text};
use super::*;
use crate::access::Access;
use crate::api::tests::fixture::searching;

fn is_for_people(path: &str) -> bool {
    const FOLDERS: [&str; 4] = ["/static/", "/console/", "/luggage/", "/simulator/"];
    const PAGES: [&str; 14] = [
        "/",
        "/api",
        "/sign-in",
        "/sign-out",
        "/language",
        "/favicon.ico",
        "/mqtt",
        "/missions",
        "/missions/{id}",
        "/missions/{id}/moment",
        "/missions/{id}/retrieval",
        "/missions/{id}/receipts",
        "/laboratory",
        "/simulator",
    ];
    PAGES.contains(&path) || FOLDERS.iter().any(|folder| path.starts_with(folder))
}

fn of_description(document: &Value) -> BTreeSet<(String, String)> {
    let paths = document["paths"].as_object().unwrap();
    let methods = |(path, methods): (&String, &Value)| {
        let of = |method: &String| (method.to_ascii_uppercase(), path.clone());
        methods.as_object().unwrap().keys().map(of).collect::<Vec<_>>()
    };
    paths.iter().flat_map(methods).collect()
}

#[test]
fn every_route_for_programs_is_described_and_nothing_else_is() {
    let table: BTreeSet<(String, String)> = table()
        .iter()
        .filter(|row| !is_for_people(&row.path))
        .map(|row| (row.method.to_string(), row.path.to_string()))
        .collect();
    assert_eq!(of_description(&document(true)), table);
    let written: BTreeSet<(String, String)> = operations::all(&mut Schemas::default())
        .iter()
        .map(|operation| (operation.method.to_string(), operation.path.to_string()))
        .collect();
    assert_eq!(written, table, "an operation without a route would be left out of the description unseen");
}

#[test]
fn every_reference_leads_somewhere_and_no_name_is_there_twice() {
    let document = document(true);
    let text = document.to_string();
    for referred in text.split("\"$ref\":\"#").skip(1).filter_map(|rest| rest.split('"').next()) {
        assert!(document.pointer(referred).is_some(), "{referred}");
    }
    let ids: Vec<&str> = text.split("\"operationId\":\"").skip(1).filter_map(|rest| rest.split('"').next()).collect();
    assert_eq!(ids.iter().collect::<BTreeSet<_>>().len(), ids.len());
}

/// The Python generator of openapi-generator fails on a type that is only `null`.
#[test]
fn nothing_has_the_type_null_alone() {
    assert!(!document(true).to_string().contains(r#":{"type":"null"}"#));
}

#[tokio::test]
async fn a_key_is_asked_for_in_the_description_where_it_is_at_the_door() {
    let (keyring, tokens) = keys();
    let guarded = guarded_app(searching(), Access::Keys(keyring));
    let (status, keyed) = read(guarded.get("/api/v1/openapi.json").await).await;
    assert_eq!((status.as_u16(), &keyed["openapi"]), (200, &"3.1.0".into()), "whoever has no key yet learns how to send one");
    let state = |document: &Value| document["paths"]["/api/v1/state"]["get"].clone();
    assert_eq!(state(&keyed)["security"], json!([{"token": []}]));
    assert!(state(&keyed)["responses"].get("401").is_some());
    assert_eq!(guarded.get("/api").await.status(), 401, "the page has STOP on it");
    let bearer = format!("Bearer {}", tokens.viewer);
    let page = text(guarded.send("GET", "/api", &[("authorization", &bearer)], "").await).await;
    assert!(page.contains("action=\"./console/stop\""));

    let app = app(searching());
    let first = app.get("/api/v1/openapi.json").await;
    let tag = first.headers()["etag"].to_str().unwrap().to_owned();
    let (_, open) = read(first).await;
    assert_eq!(state(&open)["security"], json!([{}, {"token": []}]), "a key may be shown to whoever asks for none");
    for document in [&keyed, &open] {
        assert_eq!(document["components"]["securitySchemes"]["token"]["scheme"], "bearer");
    }
    let again = app.send("GET", "/api/v1/openapi.json", &[("if-none-match", &tag)], "").await;
    assert_eq!(again.status(), 304);
}

#[tokio::test]
async fn who_accepts_it_packed_gets_it_packed_and_nobody_else() {
    let app = app(searching());
    for path in ["/api", "/api/v1/openapi.json"] {
        let sent = async |coding: &str| app.send("GET", path, &[("accept-encoding", coding)], "").await;
        let (packed, plain) = (sent("br, gzip").await, sent("gzip;q=0, br").await);
        assert_eq!(packed.headers()["content-encoding"], "gzip", "{path}");
        assert!(plain.headers().get("content-encoding").is_none(), "{path}");
        let packed = axum::body::to_bytes(packed.into_body(), 1 << 20).await.unwrap();
        let mut unpacked = String::new();
        std::io::Read::read_to_string(&mut flate2::read::GzDecoder::new(&packed[..]), &mut unpacked).unwrap();
        assert_eq!(unpacked, text(plain).await, "{path}");
    }
}

#[tokio::test]
async fn the_page_shows_every_operation_and_every_shape() {
    let page = text(app(searching()).get("/api").await).await;
    let document = document(false);
    for (method, path) in of_description(&document) {
        assert!(page.contains(&format!("{method}</span> {path}</code>")), "{method} {path}");
    }
    for name in document["components"]["schemas"].as_object().unwrap().keys() {
        assert!(page.contains(&format!("id=\"shape-{name}\"")), "{name}");
    }
    for shape in page.split("href=\"#shape-").skip(1).filter_map(|rest| rest.split('"').next()) {
        assert!(page.contains(&format!("id=\"shape-{shape}\"")), "{shape}");
    }
}
