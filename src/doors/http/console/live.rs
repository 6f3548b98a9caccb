//! `GET /console/live`: the parts of the page that changed, rendered, over server-sent events. The first message has all of
//! them, so a page that was away catches up by opening the stream again. What a part shows stands in `parts`.

use std::collections::BTreeMap;
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::extract::State;
use axum::response::sse::{Event, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use serde::Serialize;

use super::super::HttpDoor;
use super::super::assets::fingerprint;
use super::super::events::{HEARTBEAT, UNBUFFERED};
use super::super::gate::LetIn;
use super::super::problem::Problem;
use super::super::watcher::{Wake, Watcher};
use super::parts::PARTS;
use super::view::{HallInfo, View, Who};
use super::{began, hall, pieces, who};
use hallsweep_core::units::{Cell, WallTime};
use hallsweep_core::world::snapshot::Snapshot;

/// The least time between two messages: ten a second are as many as an eye can use.
const PAUSE: Duration = Duration::from_millis(100);

#[derive(Debug, Serialize)]
struct Message {
    run: String,
    revision: u64,
    /// The time here, in milliseconds since 1970: the page's own clock may be wrong.
    now: i64,
    title: String,
    /// All parts are here: what is not can go.
    whole: bool,
    /// The `viewBox` of the hall.
    view: String,
    /// The markup of a part by its element's id; empty for a tile, or pieces, that are gone.
    parts: BTreeMap<String, String>,
}

#[derive(Default)]
struct Shown {
    older: Option<Arc<Snapshot>>,
    /// A fingerprint of each part's markup, so that a part whose resource changed but whose looks did not is not sent.
    prints: BTreeMap<&'static str, u64>,
}

/// `GET console/live`
pub(in crate::doors::http) async fn live(State(door): State<HttpDoor>, LetIn(caller): LetIn) -> Result<Response, Problem> {
    let who = who(&door, &caller);
    let (watcher, snapshot) = Watcher::open(&door, caller)?;
    let events = stream::unfold((watcher, Shown::default(), Some(snapshot)), move |(mut watcher, mut shown, first)| {
        let (door, who) = (door.clone(), who.clone());
        async move {
            let wake = match first {
                Some(snapshot) => Wake::Changed(snapshot),
                None => watcher.next(PAUSE, HEARTBEAT).await,
            };
            let event = match wake {
                Wake::Changed(snapshot) => {
                    let began = began::began(&door, snapshot.mission.id).await;
                    let named = door.hall();
                    let hall = HallInfo::of(&door, &named);
                    message(&shown.update(snapshot, hall, began, who, door.clock.now().wall))
                }
                Wake::Quiet => Event::default().event("tick").data("alive"),
                Wake::Closed => return None,
            };
            Some((Ok::<Event, Infallible>(event), (watcher, shown, None)))
        }
    });
    Ok(([UNBUFFERED], Sse::new(events)).into_response())
}

fn message(message: &Message) -> Event {
    let event = Event::default().event("page").retry(HEARTBEAT).json_data(message);
    event.expect("a message is strings and numbers, which JSON can hold")
}

impl Shown {
    /// What this page lacks of a snapshot; from now on it shows it.
    fn update(
        &mut self,
        snapshot: Arc<Snapshot>,
        hall: HallInfo<'_>,
        began: Option<WallTime>,
        who: Option<Who>,
        now: WallTime,
    ) -> Message {
        let view = View { snapshot: &snapshot, hall, began, who, why: None, now };
        let older = self.older.take();
        let mut parts = tiles(older.as_deref(), &snapshot);
        parts.extend(pieces::changed(older.as_deref(), &snapshot));
        for part in &PARTS {
            let touched = |older: &Arc<Snapshot>| part.shows.iter().any(|r| snapshot.revision_of(*r) > older.revision_of(*r));
            if older.as_ref().is_none_or(touched) {
                let html = (part.render)(&view);
                if self.prints.insert(part.id, fingerprint(&html)) != Some(fingerprint(&html)) {
                    parts.insert(part.id.to_owned(), html);
                }
            }
        }
        let message = Message {
            run: snapshot.run.to_string(),
            revision: snapshot.revision.0,
            now: now.unix_ms,
            title: view.title(),
            whole: older.is_none(),
            view: hall::view_box_now(&snapshot),
            parts,
        };
        self.older = Some(snapshot);
        message
    }
}

/// The tiles that differ from the older snapshot's; shared ones are not looked into.
fn tiles(older: Option<&Snapshot>, snapshot: &Snapshot) -> BTreeMap<String, String> {
    let map = &snapshot.map;
    let drawn = |corner: Cell| (hall::tile_id(corner), hall::tile(map, corner));
    let Some(older) = older.map(|older| &older.map) else { return map.tiles().map(|(corner, _)| drawn(corner)).collect() };
    let gone = older.tiles_changed_since(map).filter(|(corner, _)| !map.has_tile(*corner));
    let gone = gone.map(|(corner, _)| (hall::tile_id(corner), String::new()));
    gone.chain(map.tiles_changed_since(older).map(|(corner, _)| drawn(corner))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::fixture::{TEN, idle, searching, touch};
    use hallsweep_core::units::{Cell, Revision};
    use hallsweep_core::world::hall_map::Mark;
    use hallsweep_core::world::resource::Resource;

    const AIRPORT: HallInfo<'static> = HallInfo { name: "airport", cell_m: None, robot: None };

    #[test]
    fn the_first_message_has_every_part_every_tile_and_all_pieces() {
        let message = Shown::default().update(Arc::new(searching()), AIRPORT, None, None, TEN);
        assert!(message.whole);
        assert_eq!(message.parts.len(), PARTS.len() + 2);
        for (id, html) in &message.parts {
            assert!(html.contains(&format!("id=\"{id}\"")), "{id} is in {html}");
        }
    }

    #[test]
    fn a_step_sends_its_tile_and_the_small_layer_and_not_the_hall() {
        let mut snapshot = searching();
        for x in 0..2000 {
            snapshot.map.mark(Cell::new(x, 40), Mark::Wall, Revision(20));
        }
        let mut shown = Shown::default();
        shown.update(Arc::new(snapshot.clone()), AIRPORT, None, None, TEN);
        snapshot.map.mark(Cell::new(4, 1), Mark::Visited, Revision(21));
        snapshot.robot.pose.cell = Cell::new(4, 1);
        touch(&mut snapshot, 21, &[Resource::Map, Resource::Robot]);
        let message = shown.update(Arc::new(snapshot), AIRPORT, None, None, TEN);
        let ids: Vec<&str> = message.parts.keys().map(String::as_str).collect();
        assert_eq!(ids, ["hall-frontier", "hall-layer", "hall-robot", "robot", "tile_0_0"]);
        assert!(serde_json::to_string(&message).unwrap().len() < 8_000);
    }

    #[test]
    fn a_tile_that_is_gone_is_taken_away() {
        let mut snapshot = searching();
        snapshot.map.mark(Cell::new(100, 0), Mark::Wall, Revision(20));
        let mut shown = Shown::default();
        shown.update(Arc::new(snapshot), AIRPORT, None, None, TEN);
        let mut emptied = idle();
        touch(&mut emptied, 21, &Resource::ALL);
        assert_eq!(shown.update(Arc::new(emptied), AIRPORT, None, None, TEN).parts["tile_3_0"], "");
    }

    #[test]
    fn what_looks_the_same_is_not_sent_again() {
        let mut snapshot = searching();
        let mut shown = Shown::default();
        shown.update(Arc::new(snapshot.clone()), AIRPORT, None, None, TEN);
        touch(&mut snapshot, 21, &Resource::ALL);
        assert!(shown.update(Arc::new(snapshot), AIRPORT, None, None, TEN).parts.is_empty());
    }
}
