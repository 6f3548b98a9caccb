//! `GET /api/v1/events`: sends the complete state first and then only the changes, as server-sent events. A client
//! that reconnects sends its last revision in `Last-Event-ID`. If that id is from another run of the program, the
//! stream starts with the complete state.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::http::{HeaderMap, HeaderName};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::{self, Stream, StreamExt};
use serde::Serialize;

use super::HttpDoor;
use super::peer::LetIn;
use super::problem::Problem;
use super::watcher::{Wake, Watcher};
use crate::api::changes::ChangesJson;
use crate::api::state::StateJson;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::Revision;

/// Interval of heartbeats on an idle stream. A client that receives nothing for three seconds may consider the stream
/// dead.
pub(super) const HEARTBEAT: Duration = Duration::from_secs(1);

/// Minimum time between two events of one stream. No program that watches a robot needs more than fifty a second.
const PAUSE: Duration = Duration::from_millis(20);

/// Time after which a client reconnects when its stream has ended. It is sent in the field `retry` of the first
/// event.
const RETRY: Duration = Duration::from_secs(1);

/// Tells proxies not to buffer a stream.
pub(super) const UNBUFFERED: (HeaderName, &str) = (HeaderName::from_static("x-accel-buffering"), "no");

pub(super) async fn events(door: HttpDoor, LetIn(caller): LetIn, headers: HeaderMap) -> Result<Response, Problem> {
    let (watcher, snapshot) = Watcher::open(&door, caller)?;
    // An id has the form `run-revision`. The stream starts with the complete state if the id is from another run, or
    // if its revision is not reached yet.
    let resumed = headers.get("last-event-id").and_then(|id| {
        let (run, revision) = id.to_str().ok()?.trim().rsplit_once('-')?;
        let revision = Revision(revision.parse().ok()?);
        (run == &*snapshot.run && revision <= snapshot.revision).then_some(revision)
    });
    let first = first_event(&snapshot, resumed);
    let events = stream::iter(first).chain(changes(watcher, snapshot)).map(Ok::<Event, Infallible>);
    let beating = Sse::new(events).keep_alive(KeepAlive::new().interval(HEARTBEAT).text("heartbeat"));
    Ok(([UNBUFFERED], beating).into_response())
}

fn first_event(snapshot: &Snapshot, resumed: Option<Revision>) -> Option<Event> {
    match resumed {
        Some(revision) if revision == snapshot.revision => None,
        Some(revision) => Some(event("changes", snapshot, &ChangesJson::since(snapshot, revision)).retry(RETRY)),
        None => Some(event("snapshot", snapshot, &StateJson::from(snapshot)).retry(RETRY)),
    }
}

fn changes(watcher: Watcher, snapshot: Arc<Snapshot>) -> impl Stream<Item = Event> {
    stream::unfold((watcher, snapshot), |(mut watcher, older)| async move {
        let snapshot = loop {
            match watcher.next(PAUSE, Duration::MAX).await {
                Wake::Changed(snapshot) if snapshot.revision > older.revision => break snapshot,
                Wake::Changed(_) | Wake::Quiet => {}
                Wake::Closed => return None,
            }
        };
        let event = event("changes", &snapshot, &ChangesJson::between(&older, &snapshot));
        Some((event, (watcher, snapshot)))
    })
}

fn event(name: &str, snapshot: &Snapshot, data: &impl Serialize) -> Event {
    let id = format!("{}-{}", snapshot.run, snapshot.revision);
    let event = Event::default().event(name).id(id).json_data(data);
    event.expect("the wire shapes are strings, numbers and lists, which JSON can hold")
}

#[cfg(test)]
mod tests {
    use super::super::STREAMS;
    use super::super::testing::{TestApp, app};
    use super::*;
    use crate::api::tests::fixture::{searching, touch};
    use axum::body::{Body, BodyDataStream};
    use hallsweep_core::units::Cell;
    use hallsweep_core::world::hall_map::Mark;
    use hallsweep_core::world::resource::Resource;
    use serde_json::Value;

    async fn open(app: &TestApp, last_event_id: Option<&str>) -> BodyDataStream {
        let headers: Vec<(&str, &str)> = last_event_id.map(|id| ("last-event-id", id)).into_iter().collect();
        let response: Response<Body> = app.send("GET", "/api/v1/events", &headers, "").await;
        assert_eq!(response.status(), 200);
        assert!(response.headers().get("content-encoding").is_none());
        response.into_body().into_data_stream()
    }

    async fn next(stream: &mut BodyDataStream) -> (String, String, Value) {
        loop {
            let bytes = tokio::time::timeout(Duration::from_secs(5), stream.next()).await.expect("an event within 5 s");
            let text = String::from_utf8(bytes.expect("the stream goes on").unwrap().to_vec()).unwrap();
            let field = |name: &str| text.lines().find_map(|line| line.strip_prefix(name)).map(|value| value.trim().to_owned());
            if let Some(data) = field("data:") {
                return (field("event:").unwrap(), field("id:").unwrap(), serde_json::from_str(&data).unwrap());
            }
        }
    }

    fn step(app: &TestApp, revision: u64) {
        let mut snapshot = Snapshot::clone(&app.publish.borrow());
        snapshot.map.mark(Cell::new(4, 1), Mark::Visited, Revision(revision));
        touch(&mut snapshot, revision, &[Resource::Map]);
        app.publish.send_replace(Arc::new(snapshot));
    }

    #[tokio::test]
    async fn the_whole_state_comes_first_and_then_only_what_changed() {
        let app = app(searching());
        let mut stream = open(&app, None).await;
        let (name, id, state) = next(&mut stream).await;
        assert_eq!((name.as_str(), id.as_str(), &state["revision"]), ("snapshot", "t-1-20", &20.into()));
        step(&app, 21);
        let (name, id, changes) = next(&mut stream).await;
        assert_eq!((name.as_str(), id.as_str()), ("changes", "t-1-21"));
        assert_eq!(changes["map"]["cells"], serde_json::json!([{"x": 4, "y": 1, "mark": "1"}]));
        assert_eq!(changes.get("robot"), None);
    }

    #[tokio::test]
    async fn a_reader_that_comes_back_gets_what_it_missed() {
        let app = app(searching());
        step(&app, 21);
        let (name, id, changes) = next(&mut open(&app, Some("t-1-20")).await).await;
        assert_eq!((name.as_str(), id.as_str()), ("changes", "t-1-21"));
        assert!(changes.get("map").is_some() && changes.get("luggage").is_none(), "{changes}");
    }

    #[tokio::test]
    async fn a_foreign_or_malformed_id_begins_anew() {
        let app = app(searching());
        for id in ["t-2-20", "t-1-21", "t-1-", "20", "", "-", "t-1-99999999999999999999999", "t-1--1"] {
            let (name, _, _) = next(&mut open(&app, Some(id)).await).await;
            assert_eq!(name, "snapshot", "{id}");
        }
    }

    #[tokio::test]
    async fn a_reader_with_everything_waits_for_the_next_change() {
        let app = app(searching());
        let mut stream = open(&app, Some("t-1-20")).await;
        step(&app, 21);
        assert_eq!(next(&mut stream).await.1, "t-1-21");
    }

    #[tokio::test]
    async fn the_latest_state_wins() {
        let app = app(searching());
        let mut stream = open(&app, None).await;
        next(&mut stream).await;
        for revision in 21..=40 {
            step(&app, revision);
        }
        assert_eq!(next(&mut stream).await.1, "t-1-40");
    }

    #[tokio::test]
    async fn closing_ends_every_stream_at_once() {
        let app = app(searching());
        let mut stream = open(&app, None).await;
        next(&mut stream).await;
        app.halls().close();
        let end = tokio::time::timeout(Duration::from_millis(500), stream.next()).await.expect("it ends at once");
        assert!(end.is_none());
    }

    #[tokio::test]
    async fn there_are_only_so_many_streams_and_an_ended_one_makes_room() {
        let app = app(searching());
        let mut streams = Vec::new();
        for _ in 0..STREAMS {
            streams.push(open(&app, None).await);
        }
        assert_eq!(app.get("/api/v1/events").await.status(), 503);
        streams.pop();
        streams.push(open(&app, None).await);
    }
}
