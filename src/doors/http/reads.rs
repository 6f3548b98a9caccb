//! The resources under `/api/v1` that can be read, and `/healthz`. Nothing here changes any state.

use std::convert::identity;
use std::sync::Arc;

use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Redirect, Response};

use super::HttpDoor;
use super::accept::preferred;
use super::etag::{conditional, tag};
use super::problem::Problem;
use super::query::{MOST, Query};
use super::reading::Number;
use crate::api::luggage::LuggageJson;
use crate::api::resources::{self, Form, ResourceKind, ResourceRow};
use crate::api::robot::RobotBySettingsJson;
use crate::api::state;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::luggage::{Luggage, NoPhoto};

/// The formats of this door. Each has the accepted media range, the media type sent, and the word used in tags.
const FORMS: [(Form, &str, &str, &str); 2] = [
    (Form::Json, "application/json", "application/json", "json"),
    (Form::Text, "text/plain", "text/plain; charset=utf-8", "text"),
];

/// Returns a resource of the table. It is sent as text if it has a text format that the client prefers, otherwise as
/// JSON.
pub(super) fn resource(row: &ResourceRow, door: &HttpDoor, headers: &HeaderMap) -> Result<Response, Problem> {
    let forms = FORMS.iter().filter(|(form, ..)| row.forms.contains(form));
    let offers: Vec<&str> = forms.map(|(_, accepted, ..)| *accepted).collect();
    let wanted = if offers.len() == 1 { offers.first().copied() } else { preferred(headers, &offers) };
    let Some((form, _, media_type, word)) = FORMS.into_iter().find(|(_, accepted, ..)| Some(*accepted) == wanted) else {
        return Err(Problem::not_acceptable(format!("the {} is available as {}", row.name, offers.join(" and as "))));
    };
    let snapshot = door.hall.handle.snapshot();
    let tag = tag(&snapshot.run, row.kind.revision(&snapshot), word);
    let body = || row.kind.written(0, form, &snapshot, identity);
    let mut response = conditional(headers, &tag, || ([(header::CONTENT_TYPE, media_type)], body()).into_response());
    if offers.len() > 1 {
        response.headers_mut().append(header::VARY, HeaderValue::from_static("accept"));
    }
    Ok(response)
}

/// `GET robots`: the robots of the state, each with its settings, which no snapshot contains.
pub(super) async fn robots(door: HttpDoor, headers: HeaderMap) -> Response {
    let snapshot = door.hall.handle.snapshot();
    let robots = state::robots(&snapshot).into_iter().map(|robot| RobotBySettingsJson::new(robot, &door.hall.robots));
    let tag = tag(&snapshot.run, ResourceKind::State.revision(&snapshot), "robots");
    conditional(&headers, &tag, || axum::Json(robots.collect::<Vec<_>>()).into_response())
}

pub(super) async fn luggage(door: HttpDoor, Number(id): Number, headers: HeaderMap) -> Result<Response, Problem> {
    let snapshot = door.hall.handle.snapshot();
    let luggage = record(&door, &snapshot, id).await?;
    let tag = tag(&snapshot.run, ResourceKind::Piece.revision(&snapshot), "json");
    let json = || match snapshot.luggage(luggage.id) {
        Some(_) => resources::marked(&snapshot, Form::Json, &LuggageJson::new(&luggage, door.hall.id())),
        // A piece of an earlier mission is not of the exercise of the present one.
        None => resources::shape(Form::Json, &LuggageJson::new(&luggage, door.hall.id())),
    };
    Ok(conditional(&headers, &tag, || ([(header::CONTENT_TYPE, "application/json")], json()).into_response()))
}

/// `GET luggage/{id}/photo`: the newest photo of a piece, or an earlier one with a query such as `?take=1`. A browser
/// that opens the photo alone is redirected to the photo's page, because a picture alone has no STOP.
pub(super) async fn photo(door: HttpDoor, Number(id): Number, query: Query, headers: HeaderMap) -> Result<Response, Problem> {
    let asked = asked_take(&query)?;
    if preferred(&headers, &["image/*", "text/html"]) == Some("text/html") {
        let take = asked.map_or_else(String::new, |take| format!("?take={take}"));
        return Ok(([(header::VARY, "accept")], Redirect::to(&format!("/luggage/{id}{take}"))).into_response());
    }
    let snapshot = door.hall.handle.snapshot();
    let take = taken(&*record(&door, &snapshot, id).await?, asked)?;
    let kept = door.hall.archive.look_up(move |archive| Ok(archive.take(LuggageId(id), take)?)).await?;
    let photo = kept.ok_or(NoPhoto::NotKept(LuggageId(id)))?;
    let tag = tag(&snapshot.run, format_args!("{id}.{take}"), "photo");
    let bytes = axum::body::Bytes::from_owner(photo.bytes);
    let mut response = conditional(&headers, &tag, || ([(header::CONTENT_TYPE, photo.media_type)], bytes).into_response());
    response.headers_mut().append(header::VARY, HeaderValue::from_static("accept"));
    Ok(response)
}

pub(super) fn asked_take(query: &Query) -> Result<Option<u64>, Problem> {
    query.only(&["take"])?;
    query.count("take", 1..=MOST)
}

/// Returns the number of the requested photo, counted from 1. The newest photo is the default.
pub(super) fn taken(luggage: &Luggage, asked: Option<u64>) -> Result<u32, NoPhoto> {
    let newest = luggage.take()?;
    let Some(asked) = asked else { return Ok(newest) };
    let taken = u32::try_from(asked).ok().filter(|take| (1..=newest).contains(take));
    taken.ok_or(NoPhoto::NotTaken(luggage.id, asked, newest))
}

/// `GET /healthz`: answers `ok` and the revision while the mission's loop runs.
pub(super) async fn health(door: HttpDoor) -> Result<String, Problem> {
    match door.hall.handle.watch().has_changed() {
        Ok(_) => Ok(format!("ok {}\n", door.hall.handle.snapshot().revision)),
        Err(_) => Err(Problem::closing()),
    }
}

pub(super) async fn record(door: &HttpDoor, snapshot: &Snapshot, id: u64) -> Result<Arc<Luggage>, Problem> {
    if let Some(luggage) = snapshot.luggage(LuggageId(id)) {
        return Ok(Arc::clone(luggage));
    }
    let kept = door.hall.archive.look_up(move |archive| archive.luggage(LuggageId(id))).await?.map(Arc::new);
    kept.ok_or_else(|| Problem::no_luggage(id))
}

#[cfg(test)]
mod tests {
    use super::super::testing::{TestApp, app, read, text};
    use crate::api::resources::{RESOURCES, ResourceKind, ResourceRow};
    use crate::api::tests::fixture::searching;
    use hallsweep_core::robot::{Part, Parts};
    use hallsweep_core::snapshot::Snapshot;
    use hallsweep_core::state::Participant;
    use hallsweep_core::world::luggage::{Luggage, PhotoState};
    use hallsweep_core::world::resource::Resource;
    use std::sync::Arc;

    async fn etag(app: &TestApp, path: &str, accept: &str) -> String {
        let response = app.send("GET", path, &[("accept", accept)], "").await;
        assert_eq!(response.status(), 200, "{path}");
        response.headers()["etag"].to_str().unwrap().to_owned()
    }

    #[tokio::test]
    async fn what_a_client_already_has_is_not_sent_again() {
        let app = app(searching());
        for path in RESOURCES.map(|row| format!("/api/v1{}", row.path.replace("{id}", "3"))) {
            let tag = etag(&app, &path, "*/*").await;
            assert!(tag.starts_with("W/\"t-1-"), "{tag}");
            let again = app.send("GET", &path, &[("if-none-match", &tag)], "").await;
            assert_eq!((again.status().as_u16(), &again.headers()["etag"]), (304, &tag.parse().unwrap()), "{path}");
            assert_eq!(again.headers()["cache-control"], "no-cache");
            let other = app.send("GET", &path, &[("if-none-match", "W/\"t-0-20-json\"")], "").await;
            assert_eq!(other.status(), 200, "{path}");
        }
    }

    #[tokio::test]
    async fn the_robots_are_there_with_what_is_set_of_them_and_what_is_replaced() {
        let mut app = app(searching());
        let (kind, address) = ("virtual-tcp".into(), Some("localhost:8999".into()));
        app.hall_mut().robots = [Participant { name: "discovery".into(), kind, address }].into();
        let mut snapshot = Snapshot::clone(&app.publish.borrow());
        let mut robots = snapshot.robots.to_vec();
        robots[0].parts = Some(Parts::of(&[Part::Base, Part::Bump, Part::Sonar]));
        snapshot.robots = robots.into();
        app.publish.send_replace(Arc::new(snapshot));
        let (_, robots) = read(app.get("/api/v1/robots").await).await;
        assert_eq!((&robots[0]["name"], &robots[0]["kind"]), (&"discovery".into(), &"virtual-tcp".into()));
        assert_eq!(robots[0]["address"], "localhost:8999");
        assert_eq!(robots[0]["replaced"][0], serde_json::json!({"part": "camera", "by": "a drawing marked as a drawing"}));
        assert_eq!(robots[0]["replaced"].as_array().map(Vec::len), Some(4));
        let (_, state) = read(app.get("/api/v1/state").await).await;
        assert_eq!(state["robots"][0]["replaced"], robots[0]["replaced"], "the state says the same, without the kind");
        assert_eq!(state["robots"][0].get("kind"), None);
    }

    #[tokio::test]
    async fn every_resource_is_there_alone_as_it_stands_in_the_whole_state() {
        let app = app(searching());
        let (_, state) = read(app.get("/api/v1/state").await).await;
        // The whole state leaves the coverage out, because all cells are counted for it.
        let is_whole = |row: &&ResourceRow| matches!(row.kind, ResourceKind::Of(of) if of != Resource::Coverage);
        for row in RESOURCES.iter().filter(is_whole) {
            let (status, json) = read(app.get(&format!("/api/v1{}", row.path)).await).await;
            assert_eq!((status.as_u16(), &json), (200, &state[row.name]), "{}", row.name);
        }
        let (_, strategy) = read(app.get("/api/v1/strategy").await).await;
        assert_eq!(strategy["name"], state["mission"]["strategy"]);
        let plain = app.send("GET", "/api/v1/temperature", &[("accept", "text/plain")], "").await;
        assert_eq!(text(plain).await, "21.4 °C, ok");
        let none = app.send("GET", "/api/v1/alarms", &[("accept", "text/plain")], "").await;
        assert_eq!(none.headers()["content-type"], "application/json", "where there is one form it is sent");
    }

    #[tokio::test]
    async fn the_map_comes_in_the_format_that_is_asked_for() {
        let app = app(searching());
        let plain = app.send("GET", "/api/v1/map", &[("accept", "text/plain")], "").await;
        assert!(plain.headers().get_all("vary").iter().any(|value| value == "accept"));
        assert!(plain.headers()["content-type"].to_str().unwrap().starts_with("text/plain"));
        assert!(text(plain).await.starts_with("|1, 1, 1, X, 1, X, \n"));
        let (_, json) = read(app.get("/api/v1/map").await).await;
        assert_eq!(json["rows"][2], "1XrX0X");
        assert_eq!(app.send("GET", "/api/v1/map", &[("accept", "image/png")], "").await.status(), 406);
        let (json, plain) = (etag(&app, "/api/v1/map", "*/*").await, etag(&app, "/api/v1/map", "text/plain").await);
        assert_ne!(json, plain);
    }

    #[tokio::test]
    async fn a_photo_is_the_picture_itself_and_never_compressed() {
        let app = app(searching());
        let response = app.send("GET", "/api/v1/luggage/3/photo", &[("accept-encoding", "gzip")], "").await;
        assert_eq!(response.headers()["content-type"], "image/png");
        assert!(response.headers().get("content-encoding").is_none());
        let bytes = axum::body::to_bytes(response.into_body(), 100).await.unwrap();
        assert_eq!(&bytes[..], b"\x89PNG");
    }

    #[tokio::test]
    async fn every_take_of_a_piece_can_be_fetched_and_one_that_was_not_taken_is_not_there() {
        let mut snapshot = searching();
        let thrice = Luggage { photo: PhotoState::Taken { bytes: 1, take: 3 }, ..(*snapshot.luggage[2]).clone() };
        snapshot.luggage.insert(Arc::new(thrice));
        let app = app(snapshot);
        for (take, bytes) in [("?take=2", "2"), ("?take=3", "3"), ("", "3")] {
            assert_eq!(text(app.get(&format!("/api/v1/luggage/3/photo{take}")).await).await, bytes, "{take}");
        }
        let tags =
            [etag(&app, "/api/v1/luggage/3/photo?take=2", "*/*").await, etag(&app, "/api/v1/luggage/3/photo", "*/*").await];
        assert_ne!(tags[0], tags[1]);
        for (take, status, words) in [
            ("4", 404, "there is no photo 4 of luggage #3: the photos have the numbers 1 to 3"),
            ("99999999999", 404, "1 to 3"),
            ("0", 422, "a whole number from 1"),
            ("x", 422, "a whole number from 1"),
        ] {
            let (is, json) = read(app.get(&format!("/api/v1/luggage/3/photo?take={take}")).await).await;
            assert_eq!(is.as_u16(), status, "{take}: {json}");
            assert!(json["detail"].as_str().unwrap().contains(words), "{json}");
        }
        let page = text(app.get("/luggage/3").await).await;
        for take in 1..=3 {
            assert!(page.contains(&format!("href=\"./luggage/3?take={take}\"")), "{page}");
        }
        let page = text(app.get("/luggage/3?take=2").await).await;
        assert!(
            page.contains("src=\"./api/v1/luggage/3/photo?take=2\" alt=\"Photo 2 of 3 of luggage #3, an earlier one\""),
            "{page}"
        );
        assert_eq!(app.get("/luggage/3?take=4").await.status(), 404);
        let console = text(app.get("/").await).await;
        assert!(console.contains("href=\"./luggage/3?take=1\"") && console.contains("href=\"./luggage/3?take=2\""), "{console}");
    }

    #[tokio::test]
    async fn a_failed_photo_says_why_it_is_not_there() {
        let mut snapshot = searching();
        let failed = Luggage { photo: PhotoState::Failed("lens covered".to_owned()), ..(*snapshot.luggage[2]).clone() };
        snapshot.luggage.insert(Arc::new(failed));
        let (status, json) = read(app(snapshot).get("/api/v1/luggage/3/photo").await).await;
        assert_eq!(status, 404);
        assert!(json["detail"].as_str().unwrap().contains("lens covered"), "{json}");
    }

    #[tokio::test]
    async fn what_is_large_travels_compressed_when_the_client_can() {
        let app = app(searching());
        let response = app.send("GET", "/api/v1/state", &[("accept-encoding", "gzip")], "").await;
        assert_eq!(response.headers()["content-encoding"], "gzip");
        assert!(response.headers()["etag"].to_str().unwrap().starts_with("W/"));
    }

    #[tokio::test]
    async fn what_is_not_there_is_not_found() {
        let app = app(searching());
        for path in ["/api/v1/luggage/99", "/api/v1/luggage/x", "/api/v1/luggage/99/photo", "/api/v1/", "/api/v2", "/nowhere"] {
            let (status, json) = read(app.get(path).await).await;
            assert_eq!((status.as_u16(), &json["status"]), (404, &404.into()), "{path}");
        }
    }

    #[tokio::test]
    async fn health_is_ok_until_the_loop_is_gone() {
        let app = app(searching());
        assert_eq!(text(app.get("/healthz").await).await, "ok 20\n");
    }
}
