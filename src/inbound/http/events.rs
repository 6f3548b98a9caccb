//! `GET /api/v1/events`: the state as server-sent events, the whole first and then only what changed.
//! A reader that comes back says by `Last-Event-ID` what it has; one with an id of another run begins anew.

use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::State;
use axum::http::{HeaderMap, HeaderName};
use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::{self, Stream, StreamExt};
use serde::Serialize;

use super::Door;
use super::problem::Problem;
use super::watcher::{Wake, Watcher};
use crate::core::units::Revision;
use crate::core::world::snapshot::Snapshot;
use crate::wire::changes::ChangesJson;
use crate::wire::state::StateJson;

/// A silent stream says every second that it lives: a reader may call it dead after three.
pub(super) const HEARTBEAT: Duration = Duration::from_secs(1);

/// The least time between two events of one stream: no program that watches a robot needs more than fifty a second.
const PAUSE: Duration = Duration::from_millis(20);

/// After a break a reader tries again this soon.
const RETRY: Duration = Duration::from_secs(1);

/// `GET events`
pub(super) async fn events(State(door): State<Door>, headers: HeaderMap) -> Result<Response, Problem> {
    let (watcher, snapshot) = Watcher::open(&door)?;
    let resumed = headers.get("last-event-id").and_then(|id| known_revision(id.to_str().ok()?, &snapshot));
    let first = first_event(&snapshot, resumed);
    let events = stream::iter(first).chain(changes(watcher, snapshot)).map(Ok::<Event, Infallible>);
    let beating = Sse::new(events).keep_alive(KeepAlive::new().interval(HEARTBEAT).text("heartbeat"));
    Ok(([(HeaderName::from_static("x-accel-buffering"), "no")], beating).into_response())
}

/// The revision a returning reader has, when its id is of this run.
fn known_revision(id: &str, snapshot: &Snapshot) -> Option<Revision> {
    let (run, revision) = id.trim().rsplit_once('-')?;
    let revision = Revision(revision.parse().ok()?);
    (run == &*snapshot.run && revision <= snapshot.revision).then_some(revision)
}

/// What a stream begins with; nothing when the reader has everything.
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
