//! `GET /console/live`: sends the changed parts of the page as HTML, in server-sent events. The first message has all
//! parts. After a disconnection, the page opens the stream again and receives all parts again. `parts` defines the
//! parts.

use std::collections::{BTreeMap, BTreeSet};
use std::convert::Infallible;
use std::sync::Arc;
use std::time::Duration;

use axum::response::sse::{Event, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream;
use serde::Serialize;

use super::super::HttpDoor;
use super::super::assets::fingerprint;
use super::super::events::{HEARTBEAT, UNBUFFERED};
use super::super::language::PageReader;
use super::super::problem::Problem;
use super::super::watcher::{Wake, Watcher};
use super::parts::PARTS;
use super::timeline::{self, Scale, Timeline, Timelines};
use super::view::{HallInfo, Then, View, Who};
use super::{began, hall, pieces, who};
use crate::phrases::Language;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::Cell;

/// Minimum time between two messages. A person cannot follow more than ten a second.
const PAUSE: Duration = Duration::from_millis(100);

#[derive(Debug, Serialize)]
pub(in crate::doors::http) struct Message {
    run: String,
    revision: u64,
    /// The server's time in milliseconds since 1970. The browser's own clock may be wrong.
    now: i64,
    title: String,
    /// Whether the message has all parts of the page. If it has, the page removes every part that is not in the
    /// message.
    whole: bool,
    view: String,
    then: Option<Then>,
    line: Option<Scale>,
    /// HTML by element id. The HTML is empty for an element that the page must remove: a tile, a group of luggage or
    /// a section of the timeline.
    parts: BTreeMap<String, String>,
}

#[derive(Default)]
pub(super) struct Shown {
    older: Option<Arc<Snapshot>>,
    /// Hash of each part's HTML. A part is not sent when its data changed but its HTML is the same.
    prints: BTreeMap<&'static str, u64>,
    /// Whether the last message said that the simulator is paused. A snapshot does not contain this.
    is_paused: bool,
    line: ShownLine,
}

#[derive(Clone, Copy, Default, PartialEq, Eq)]
struct ShownLine {
    mission: u64,
    full: usize,
    growing: u64,
}

pub(in crate::doors::http) async fn live(door: HttpDoor, to: PageReader) -> Result<Response, Problem> {
    let PageReader { caller, language } = to;
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
                Wake::Changed(snapshot) => message(&changed(&door, &mut shown, snapshot, who, language).await),
                Wake::Quiet => quiet(&door, &mut shown, who, language).await,
                Wake::Closed => return None,
            };
            Some((Ok::<Event, Infallible>(event), (watcher, shown, None)))
        }
    });
    Ok(([UNBUFFERED], Sse::new(events)).into_response())
}

async fn changed(door: &HttpDoor, shown: &mut Shown, snapshot: Arc<Snapshot>, who: Option<Who>, language: Language) -> Message {
    let mission = snapshot.mission.id;
    let (began, line) = (began::began(door, mission).await, Timelines::of(door, mission, language).await);
    let (hall, now) = (HallInfo::of(door), door.process.clock.now().wall);
    let line = Some(&*line);
    shown.update(&snapshot, &View { snapshot: &snapshot, hall, began, who, language, why: None, now, line, then: None })
}

/// Returns the message to send when no new state has come for some time. The timeline may still have new entries,
/// because it is read from the record.
async fn quiet(door: &HttpDoor, shown: &mut Shown, who: Option<Who>, language: Language) -> Event {
    let older = shown.older.clone();
    let message_of = async {
        let snapshot = older?;
        let message = changed(door, shown, snapshot, who, language).await;
        (!message.parts.is_empty()).then(|| self::message(&message))
    };
    message_of.await.unwrap_or_else(|| Event::default().event("tick").data("alive"))
}

fn message(message: &Message) -> Event {
    let event = Event::default().event("page").retry(HEARTBEAT).json_data(message);
    event.expect("a message is strings and numbers, which JSON can hold")
}

impl Shown {
    pub(super) fn already(snapshot: &Arc<Snapshot>, view: &View<'_>) -> Shown {
        let prints = PARTS.iter().map(|part| (part.id, fingerprint((part.render)(view)))).collect();
        let line = view.line.map(ShownLine::of).unwrap_or_default();
        Shown { older: Some(Arc::clone(snapshot)), prints, is_paused: view.hall.is_paused, line }
    }

    /// Returns the message that changes the page from its last contents to this snapshot and view. Stores the new
    /// contents for the next call.
    pub(super) fn update(&mut self, snapshot: &Arc<Snapshot>, view: &View<'_>) -> Message {
        let older = self.older.replace(Arc::clone(snapshot));
        let mut parts = tiles(older.as_deref(), snapshot);
        parts.extend(pieces::changed(view.language, older.as_deref(), snapshot));
        if let Some(line) = view.line {
            parts.extend(self.line.update(line));
        }
        let is_paused_or_goes_on = std::mem::replace(&mut self.is_paused, view.hall.is_paused) != view.hall.is_paused;
        for part in &PARTS {
            let touched = |older: &Arc<Snapshot>| part.shows.iter().any(|r| snapshot.revision_of(*r) != older.revision_of(*r));
            if older.as_ref().is_none_or(touched) || is_paused_or_goes_on || view.then.is_some() {
                let html = (part.render)(view);
                if self.prints.insert(part.id, fingerprint(&html)) != Some(fingerprint(&html)) {
                    parts.insert(part.id.to_owned(), html);
                }
            }
        }
        Message {
            run: snapshot.run.to_string(),
            revision: snapshot.revision.0,
            now: view.now.unix_ms,
            title: view.title(),
            whole: older.is_none(),
            view: hall::view_box_now(snapshot),
            then: view.then,
            line: view.line.filter(|line| !line.is_empty()).map(Timeline::scale),
            parts,
        }
    }
}

impl ShownLine {
    fn of(line: &Timeline) -> ShownLine {
        let growing = line.sections(line.full()).next().map_or(0, |(_, markup)| fingerprint(&markup));
        ShownLine { mission: line.mission().0, full: line.full(), growing }
    }

    /// Returns new and changed sections by element id. If the mission has changed, surplus sections of the old
    /// timeline get empty HTML, which removes them from the page.
    fn update(&mut self, line: &Timeline) -> Vec<(String, String)> {
        // A timeline may be read again from its beginning. Until it is as long as before, no section is removed from
        // the page.
        if self.mission == line.mission().0 && line.full() < self.full {
            return Vec::new();
        }
        let before = std::mem::replace(self, ShownLine::of(line));
        if before == *self {
            return Vec::new();
        }
        let is_same = before.mission == self.mission;
        let gone = if is_same { 0..0 } else { line.full() + 1..before.full + 1 };
        let newer = line.sections(if is_same { before.full } else { 0 }).map(|(id, markup)| (id, markup.to_string()));
        newer.chain(gone.map(|place| (timeline::id(place), String::new()))).collect()
    }
}

/// Returns the tiles that differ from the older snapshot. A wall is drawn at the floor beside it, so the tile beside a
/// changed cell is drawn again, too. Tiles that both snapshots share in memory are not compared.
fn tiles(older: Option<&Snapshot>, snapshot: &Snapshot) -> BTreeMap<String, String> {
    let map = &snapshot.map;
    let drawn = |corner: Cell| (hall::tile_id(corner), hall::tile(map, corner));
    let Some(older) = older.map(|older| &older.map) else { return map.tiles().map(|(corner, _)| drawn(corner)).collect() };
    let gone = older.tiles_changed_since(map).filter(|(corner, _)| !map.has_tile(*corner));
    let gone = gone.map(|(corner, _)| (hall::tile_id(corner), String::new()));
    let changed = map.changes_since(older);
    let corners: BTreeSet<Cell> = changed.iter().flat_map(|(cell, _)| cell.neighbours()).map(hall::tile_corner).collect();
    gone.chain(corners.into_iter().filter(|corner| map.has_tile(*corner)).map(drawn)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::{TEN, idle, searching, touch};
    use crate::phrases::Language;
    use hallsweep_core::settings::Rules;
    use hallsweep_core::units::{Cell, Revision};
    use hallsweep_core::world::hall_map::Mark;
    use hallsweep_core::world::resource::Resource;

    fn update(shown: &mut Shown, snapshot: Snapshot) -> Message {
        update_while(shown, snapshot, false)
    }

    fn update_while(shown: &mut Shown, snapshot: Snapshot, is_paused: bool) -> Message {
        let snapshot = Arc::new(snapshot);
        let hall = HallInfo {
            name: "airport".into(),
            cell_m: None,
            is_reckoned: false,
            evacuation_m: 100.0,
            is_paused,
            robot: None,
            rules: Rules::default(),
        };
        let view = View {
            snapshot: &snapshot,
            hall,
            began: None,
            who: None,
            language: Language::English,
            why: None,
            now: TEN,
            line: None,
            then: None,
        };
        shown.update(&snapshot, &view)
    }

    #[test]
    fn the_first_message_has_every_part_every_tile_and_all_pieces() {
        let message = update(&mut Shown::default(), searching());
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
        update(&mut shown, snapshot.clone());
        snapshot.map.mark(Cell::new(4, 1), Mark::Visited, Revision(21));
        snapshot.robot.pose.cell = Cell::new(4, 1);
        touch(&mut snapshot, 21, &[Resource::Map, Resource::Robot]);
        let message = update(&mut shown, snapshot);
        let ids: Vec<&str> = message.parts.keys().map(String::as_str).collect();
        assert_eq!(ids, ["about-hall", "hall-frontier", "hall-layer", "hall-robot", "robot", "tile_0_0"]);
        assert!(serde_json::to_string(&message).unwrap().len() < 8_000);
    }

    #[test]
    fn a_wall_gets_its_line_when_the_floor_beside_it_in_another_tile_becomes_known() {
        let mut snapshot = searching();
        snapshot.map.mark(Cell::new(31, 5), Mark::Wall, Revision(20));
        let mut shown = Shown::default();
        let first = update(&mut shown, snapshot.clone());
        assert!(!first.parts["tile_0_0"].contains("M319 50v10"), "{}", first.parts["tile_0_0"]);
        snapshot.map.mark(Cell::new(32, 5), Mark::Visited, Revision(21));
        touch(&mut snapshot, 21, &[Resource::Map]);
        let message = update(&mut shown, snapshot);
        assert!(
            message.parts.contains_key("tile_1_0") && message.parts["tile_0_0"].contains("M319 50v10"),
            "{:?}",
            message.parts
        );
    }

    #[test]
    fn a_tile_that_is_gone_is_taken_away() {
        let mut snapshot = searching();
        snapshot.map.mark(Cell::new(100, 0), Mark::Wall, Revision(20));
        let mut shown = Shown::default();
        update(&mut shown, snapshot);
        let mut emptied = idle();
        touch(&mut emptied, 21, &Resource::ALL);
        assert_eq!(update(&mut shown, emptied).parts["tile_3_0"], "");
    }

    /// The log records a pause a moment before the simulator is paused.
    #[test]
    fn that_the_simulator_is_paused_is_sent_although_the_state_is_the_same() {
        let (mut shown, snapshot) = (Shown::default(), searching());
        update(&mut shown, snapshot.clone());
        for (is_paused, is_said) in [(true, true), (true, false), (false, true)] {
            let parts = update_while(&mut shown, snapshot.clone(), is_paused).parts;
            assert_eq!(parts.keys().map(String::as_str).collect::<Vec<_>>(), if is_said { vec!["holds"] } else { vec![] });
            assert!(!is_said || parts["holds"].contains("Paused:") == is_paused, "{parts:?}");
        }
    }

    #[test]
    fn what_looks_the_same_is_not_sent_again() {
        let mut snapshot = searching();
        let mut shown = Shown::default();
        update(&mut shown, snapshot.clone());
        touch(&mut snapshot, 21, &Resource::ALL);
        assert!(update(&mut shown, snapshot).parts.is_empty());
    }
}
