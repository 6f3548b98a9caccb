//! What can be looked at under `/api/v1`, and `/healthz`. Nothing here changes anything.

use axum::Json;
use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};

use super::Door;
use super::accept::preferred;
use super::etag::{conditional, tag};
use super::problem::Problem;
use super::reading::Number;
use crate::core::units::LuggageId;
use crate::core::world::luggage::{Luggage, PhotoState};
use crate::core::world::resource::Resource;
use crate::core::world::snapshot::Snapshot;
use crate::wire::luggage::LuggageJson;
use crate::wire::map::{MapJson, map_revision};
use crate::wire::map_text;
use crate::wire::state::{self, StateJson};

/// `GET state`
pub(super) async fn state(State(door): State<Door>, headers: HeaderMap) -> Response {
    let snapshot = door.handle.snapshot();
    let tag = tag(&snapshot.run, snapshot.revision, "json");
    conditional(&headers, &tag, || Json(StateJson::from(&*snapshot)).into_response())
}

/// `GET map`, as JSON or as the text of old clients.
pub(super) async fn map(State(door): State<Door>, headers: HeaderMap) -> Result<Response, Problem> {
    const FORMATS: [&str; 2] = ["application/json", "text/plain"];
    let snapshot = door.handle.snapshot();
    let Some(format) = preferred(&headers, &FORMATS) else {
        return Err(Problem::not_acceptable("the map is there as application/json and as text/plain".to_owned()));
    };
    let is_json = format == FORMATS[0];
    let tag = tag(&snapshot.run, map_revision(&snapshot), if is_json { "json" } else { "text" });
    let mut response = conditional(&headers, &tag, || match is_json {
        true => Json(MapJson::from(&*snapshot)).into_response(),
        false => map_text::lines(&snapshot).into_response(),
    });
    response.headers_mut().append(header::VARY, HeaderValue::from_static("accept"));
    Ok(response)
}

/// `GET luggage`
pub(super) async fn luggage_list(State(door): State<Door>, headers: HeaderMap) -> Response {
    let snapshot = door.handle.snapshot();
    conditional(&headers, &luggage_tag(&snapshot), || Json(state::luggage(&snapshot)).into_response())
}

/// `GET luggage/{id}`
pub(super) async fn luggage(State(door): State<Door>, Number(id): Number, headers: HeaderMap) -> Result<Response, Problem> {
    let snapshot = door.handle.snapshot();
    let luggage = record(&snapshot, id)?;
    Ok(conditional(&headers, &luggage_tag(&snapshot), || Json(LuggageJson::from(luggage)).into_response()))
}

/// `GET luggage/{id}/photo`: the newest picture of a piece.
pub(super) async fn photo(State(door): State<Door>, Number(id): Number, headers: HeaderMap) -> Result<Response, Problem> {
    let snapshot = door.handle.snapshot();
    let take = match &record(&snapshot, id)?.photo {
        PhotoState::Taken { take, .. } => *take,
        PhotoState::Failed(reason) => {
            return Err(Problem::not_found(format!("there is no photo of luggage #{id}: {reason}; take it again")));
        }
    };
    let kept = door.archive.photo(LuggageId(id));
    let photo = kept.ok_or_else(|| Problem::not_found(format!("the photo of luggage #{id} is not kept")))?;
    let tag = tag(&snapshot.run, format_args!("{id}.{take}"), "photo");
    let bytes = axum::body::Bytes::from_owner(photo.bytes);
    Ok(conditional(&headers, &tag, || ([(header::CONTENT_TYPE, photo.media_type)], bytes).into_response()))
}

/// `GET /healthz`: `ok` and the revision, as long as the loop behind the door lives.
pub(super) async fn health(State(door): State<Door>) -> Result<String, Problem> {
    match door.handle.watch().has_changed() {
        Ok(_) => Ok(format!("ok {}\n", door.handle.snapshot().revision)),
        Err(_) => Err(Problem::closing()),
    }
}

fn record(snapshot: &Snapshot, id: u64) -> Result<&Luggage, Problem> {
    let luggage = snapshot.luggage(LuggageId(id));
    luggage.map(|luggage| &**luggage).ok_or_else(|| Problem::not_found(format!("there is no luggage #{id}")))
}

fn luggage_tag(snapshot: &Snapshot) -> String {
    tag(&snapshot.run, snapshot.revision_of(Resource::Luggage), "json")
}
