//! Excerpts of resources that are too large to publish whole. The excerpt of the luggage has the newest pieces, and
//! the dangerous and pending pieces that fit. The excerpt of the map has the size of the map, but no rows. Each
//! excerpt says how large the whole resource is, and where to read the whole resource. So nobody mistakes the excerpt
//! for the whole.

use std::collections::BTreeMap;

use serde::Serialize;

use super::address::address;
use super::luggage::LuggageJson;
use super::map::map_revision;
use super::resources::{Form, shape};
use super::robot::PositionJson;
use hallsweep_core::command::Note;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::world::luggage::Luggage;
use hallsweep_core::world::resource::Resource;

/// Maximum size of published luggage, in bytes. Every broker accepts messages of this size (1 MiB).
const LUGGAGE_BYTES: usize = 1024 * 1024;

/// Size that is assumed for each record without its note, in bytes. The true size is smaller.
const PIECE_BYTES: usize = 512;

/// Number of newest pieces in an excerpt. Up to this number, the HTTP stream sends all pieces. Dangerous and pending
/// pieces are added to these pieces.
const NEWEST: usize = 256;

/// Maximum size of the rows of a map that is published whole, in bytes. The map with its other fields then fits into
/// a message of 2 MiB.
const MAP_BYTES: i64 = 2 * 1024 * 1024 - 1024;

#[derive(Clone, Debug, PartialEq, Serialize)]
struct LuggageExcerpt {
    pieces: usize,
    pending: usize,
    /// Number of dangerous pieces, including those in the container.
    dangerous: usize,
    /// Address of all pieces at the HTTP door.
    all: String,
    /// The newest pieces, and the dangerous and pending pieces that fit, sorted by number.
    luggage: Vec<LuggageJson>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
struct MapExcerpt {
    revision: u64,
    origin: PositionJson,
    width: i32,
    height: i32,
    /// Address of the map with its rows at the HTTP door.
    all: String,
}

/// Returns the excerpt of a resource in JSON; `None` if the whole resource can be published.
pub fn excerpt(resource: Resource, snapshot: &Snapshot) -> Option<Vec<u8>> {
    match resource {
        Resource::Luggage => luggage(snapshot).map(|excerpt| shape(Form::Json, &excerpt)),
        Resource::Map => map(snapshot).map(|excerpt| shape(Form::Json, &excerpt)),
        Resource::Mission
        | Resource::Robot
        | Resource::Coverage
        | Resource::Temperature
        | Resource::Alarms
        | Resource::Retrieval
        | Resource::Log => None,
    }
}

fn luggage(snapshot: &Snapshot) -> Option<LuggageExcerpt> {
    let records = &snapshot.luggage;
    if records.iter().map(|piece| bytes(piece)).sum::<usize>() <= LUGGAGE_BYTES {
        return None;
    }
    let dangerous = || records.bombs_left().chain(records.secured());
    let newest = || records.iter().rev().take(NEWEST);
    let mut room = LUGGAGE_BYTES.saturating_sub(newest().map(|piece| bytes(piece)).sum());
    let matters = dangerous().chain(records.pending()).take_while(|piece| {
        let fits = bytes(piece) <= room;
        room = room.saturating_sub(bytes(piece));
        fits
    });
    let shown: BTreeMap<u64, &Luggage> = matters.chain(newest()).map(|piece| (piece.id.0, &**piece)).collect();
    Some(LuggageExcerpt {
        pieces: records.len(),
        pending: records.pending().count(),
        dangerous: dangerous().count(),
        all: address(snapshot.hall.as_ref(), "/api/v1/luggage"),
        luggage: shown.into_values().map(|piece| LuggageJson::new(piece, snapshot.hall.as_ref())).collect(),
    })
}

/// Upper bound of the size of a piece in JSON, in bytes. Each quote or backslash in the note takes two bytes.
fn bytes(piece: &Luggage) -> usize {
    let note = piece.verdict.as_ref().and_then(|decision| decision.note.as_ref()).map_or("", Note::text);
    PIECE_BYTES + note.len() + note.matches(['"', '\\']).count()
}

fn map(snapshot: &Snapshot) -> Option<MapExcerpt> {
    let bounds = snapshot.map.known_bounds();
    let (width, height) = (bounds.width(), bounds.height());
    // Each row also has two quotes and a comma.
    if (i64::from(width) + 3) * i64::from(height) <= MAP_BYTES {
        return None;
    }
    let revision = map_revision(snapshot).0;
    Some(MapExcerpt { revision, origin: bounds.least.into(), width, height, all: address(snapshot.hall.as_ref(), "/api/v1/map") })
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;
    use crate::api::tests::fixture::{TEN, idle, piece};
    use hallsweep_core::command::Verdict;
    use hallsweep_core::units::{Cell, LuggageId, Revision};
    use hallsweep_core::world::hall_map::Mark;

    /// Number of pieces that are published whole if no piece has a note.
    const PIECES: usize = LUGGAGE_BYTES / PIECE_BYTES;

    /// A snapshot of `count` pieces. All pieces are safe, except those in `others`.
    fn with(count: u64, others: &[(u64, Option<Verdict>)]) -> Snapshot {
        let mut snapshot = idle();
        for id in 1..=count {
            let other = others.iter().find(|(number, _)| *number == id);
            let verdict = other.map_or(Some(Verdict::Safe), |(_, verdict)| *verdict);
            snapshot.luggage.insert(piece(id, Cell::new(100, 100), verdict));
        }
        snapshot
    }

    fn read(resource: Resource, snapshot: &Snapshot) -> Value {
        serde_json::from_slice(&excerpt(resource, snapshot).expect("it is too large")).expect("it is JSON")
    }

    #[test]
    fn as_many_pieces_as_fit_are_published_whole() {
        let whole = with(PIECES as u64, &[(7, None)]);
        assert_eq!(excerpt(Resource::Luggage, &whole), None);
        let bytes = serde_json::to_vec(&crate::api::state::luggage(&whole)).expect("it is JSON").len();
        assert!(bytes < PIECES * 512, "{bytes} bytes");
        assert!(Resource::ALL.iter().all(|resource| excerpt(*resource, &idle()).is_none()));
    }

    /// Uses the longest possible notes, made of the characters that take the most bytes.
    #[test]
    fn what_is_published_fits_a_message_whatever_was_noted() {
        for letter in ["\"", "ü", "𝔘"] {
            let mut snapshot = with(PIECES as u64, &[]);
            let note = Note::new(&letter.repeat(Note::MOST));
            for id in 1..=PIECES as u64 {
                snapshot.luggage.change(LuggageId(id), |piece| {
                    let decision = piece.verdict.as_mut().expect("it is decided");
                    (decision.verdict, decision.note) = (Verdict::Danger, note.clone());
                });
            }
            let bytes = excerpt(Resource::Luggage, &snapshot).expect("it is too large").len();
            assert!((LUGGAGE_BYTES / 2..LUGGAGE_BYTES).contains(&bytes), "{letter}: {bytes} bytes");
        }
    }

    /// Pending and dangerous pieces are shown, however long ago they were found.
    #[test]
    fn of_more_pieces_what_matters_and_the_newest_are_shown_and_how_many_there_are() {
        let mut snapshot = with(5000, &[(3, None), (17, Some(Verdict::Danger)), (40, Some(Verdict::Danger))]);
        snapshot.luggage.change(LuggageId(40), |bomb| bomb.secured = Some(TEN));
        let excerpt = read(Resource::Luggage, &snapshot);
        let counts = ["pieces", "pending", "dangerous"].map(|count| excerpt[count].as_u64());
        assert_eq!(counts, [Some(5000), Some(1), Some(2)]);
        assert_eq!(excerpt["all"], "/api/v1/luggage");
        let shown = excerpt["luggage"].as_array().expect("a list");
        let numbers: Vec<u64> = shown.iter().filter_map(|record| record["id"].as_u64()).collect();
        let expected: Vec<u64> = [3, 17, 40].into_iter().chain(5000 - NEWEST as u64 + 1..=5000).collect();
        assert_eq!(numbers, expected);
        assert_eq!(shown[1], serde_json::to_value(LuggageJson::new(&snapshot.luggage[16], None)).expect("it is JSON"));
    }

    #[test]
    fn of_more_undecided_pieces_than_fit_their_number_is_said() {
        let mut snapshot = with(1, &[]);
        for id in 2..=6000 {
            let verdict = (id == 5000).then_some(Verdict::Danger);
            snapshot.luggage.insert(piece(id, Cell::new(1, 1), verdict));
        }
        let excerpt = read(Resource::Luggage, &snapshot);
        let shown = excerpt["luggage"].as_array().expect("a list");
        assert_eq!((&excerpt["pending"], shown.len()), (&json!(5998), PIECES));
        assert!(shown.iter().any(|record| record["id"] == 5000), "the dangerous one is not lost among them");
    }

    #[test]
    fn a_map_that_does_not_fit_says_how_large_it_is_and_where_it_stands() {
        let mut snapshot = idle();
        snapshot.map.mark(Cell::new(1399, 1399), Mark::Visited, Revision(2));
        assert_eq!(excerpt(Resource::Map, &snapshot), None);
        snapshot.map.mark(Cell::new(1499, 1499), Mark::Visited, Revision(3));
        snapshot.revisions = [Revision(3); Resource::COUNT];
        let expected = json!({"revision": 3, "origin": {"x": 0, "y": 0}, "width": 1500, "height": 1500, "all": "/api/v1/map"});
        assert_eq!(read(Resource::Map, &snapshot), expected);
    }
}
