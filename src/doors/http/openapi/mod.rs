//! The description of this door for programs, in OpenAPI 3.1. It is built from the table of routes, the
//! operations, and the schemas of the interface. All readers get the same description, except for whether a key is
//! required.

mod kept;
mod operation;
mod operations;
mod page;

use std::collections::BTreeMap;
use std::sync::LazyLock;

use axum::http::HeaderMap;
use axum::response::Response;
use serde_json::{Map, Value, json};

use self::kept::Kept;
use self::operation::{Operation, Subject, problem};
use super::HttpDoor;
use super::etag::{conditional, tag_of};
use super::routes::{RouteRow, table};
use crate::access::Access;
use crate::api::problem::{ProblemJson, ProblemKind};
use crate::api::schemas::Schemas;

pub(super) use page::page;

const ABOUT: &str = "A robot searches an evacuated airport hall for dangerous luggage; an operator watches, decides and can \
    always stop the robot. The same state and commands are available over CoAP and MQTT. STOP (`POST /api/v1/commands/stop`) \
    halts the robot before the rest of the request is checked.";

struct Description {
    json: Kept,
    tag: String,
}

/// The descriptions, created at the first request: one for doors without keys, one for doors with keys.
static OPEN: LazyLock<Description> = LazyLock::new(|| Description::of(false));
static KEYED: LazyLock<Description> = LazyLock::new(|| Description::of(true));

pub(super) async fn description(door: HttpDoor, headers: HeaderMap) -> Response {
    let Description { json, tag } = at(&door);
    conditional(&headers, tag, || json.sent(&headers))
}

fn at(door: &HttpDoor) -> &'static Description {
    match door.process.access {
        Access::Open => &OPEN,
        Access::Keys(_) => &KEYED,
    }
}

impl Description {
    fn of(asks: bool) -> Description {
        let text = document(asks).to_string();
        Description { tag: tag_of(&text), json: Kept::new("application/json", text) }
    }
}

fn described(schemas: &mut Schemas) -> Vec<(RouteRow, Operation)> {
    let key = |method: &axum::http::Method, path: &str| (method.to_string(), path.to_owned());
    let mut operations: BTreeMap<_, Operation> =
        operations::all(schemas).into_iter().map(|operation| (key(&operation.method, &operation.path), operation)).collect();
    table()
        .into_iter()
        .filter_map(|row| operations.remove(&key(&row.method, &row.path)).map(|operation| (row, operation)))
        .collect()
}

/// Returns the whole description. `asks` says whether keys are required.
fn document(asks: bool) -> Value {
    let mut schemas = Schemas::default();
    let mut paths: Map<String, Value> = Map::new();
    for (row, operation) in described(&mut schemas) {
        let path = paths.entry(row.path.to_string()).or_insert_with(|| json!({}));
        path[operation.method.as_str().to_ascii_lowercase()] = operation.written(row.need, asks);
    }
    let shape = schemas.sent::<ProblemJson<'static>>();
    let answers: Map<String, Value> = ProblemKind::ALL.map(|kind| problem(kind, &shape)).into_iter().collect();
    let tags = Subject::ALL.map(|subject| json!({"name": subject.named().0, "description": subject.named().1}));
    let token = "Token of a key, as `hallsweep token` shows the token.";
    let components = json!({
        "schemas": schemas.shapes(),
        "responses": answers,
        "headers": {"ETag": {"description": "Weak tag of this version, for `If-None-Match`.", "schema": {"type": "string"}}},
        "securitySchemes": {"token": {"type": "http", "scheme": "bearer", "description": token}},
    });
    json!({
        "openapi": "3.1.0",
        "info": {
            "title": "hallsweep",
            "version": env!("CARGO_PKG_VERSION"),
            "description": ABOUT,
            "license": {"name": env!("CARGO_PKG_LICENSE"), "identifier": env!("CARGO_PKG_LICENSE")},
        },
        "servers": [{"url": "../.."}],
        "tags": tags,
        "paths": paths,
        "components": components,
    })
}

#[cfg(test)]
mod tests;
