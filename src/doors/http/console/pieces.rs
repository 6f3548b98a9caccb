//! The luggage in the picture of the hall, in groups by its numbers: so that a change sends the few pieces beside it, and not all that
//! were ever found. What is being fetched moves, and is drawn by `hall::layer`; what is secured, by `carriers`.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::carriers::fetched;
use super::hall::{larger, luggage, middle};
use hallsweep_core::world::luggage::Luggage;
use hallsweep_core::world::snapshot::Snapshot;

/// Every group.
pub(super) fn all(snapshot: &Snapshot) -> String {
    groups(snapshot).map(|(_, markup)| markup).collect()
}

/// The groups that look other than in an older snapshot, by their ids; one that is gone is empty.
pub(super) fn changed(older: Option<&Snapshot>, snapshot: &Snapshot) -> BTreeMap<String, String> {
    let looks = |snapshot: &Snapshot| (larger(&snapshot.map), fetched(snapshot).map(|piece| piece.id));
    let Some(older) = older else { return groups(snapshot).collect() };
    let gone = (snapshot.luggage.parts().len()..older.luggage.parts().len()).map(|place| (id(place), String::new()));
    if looks(older) != looks(snapshot) {
        return groups(snapshot).chain(gone).collect();
    }
    let newer = snapshot.luggage.parts_changed_since(&older.luggage);
    newer.map(|(place, pieces)| (id(place), group(snapshot, place, pieces))).chain(gone).collect()
}

fn groups(snapshot: &Snapshot) -> impl Iterator<Item = (String, String)> {
    snapshot.luggage.parts().enumerate().map(|(place, pieces)| (id(place), group(snapshot, place, pieces)))
}

fn id(place: usize) -> String {
    format!("pieces_{place}")
}

fn group(snapshot: &Snapshot, place: usize, pieces: &[Arc<Luggage>]) -> String {
    let (size, fetched) = (larger(&snapshot.map), fetched(snapshot).map(|piece| piece.id));
    let mut group = format!("<g id=\"{}\">", id(place));
    for piece in pieces.iter().filter(|piece| piece.secured.is_none() && Some(piece.id) != fetched) {
        luggage(&mut group, piece, middle(piece.cell), size);
    }
    group.push_str("</g>");
    group
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::fixture::{idle, piece, searching};
    use hallsweep_core::command::Verdict;
    use hallsweep_core::units::{Cell, Revision};
    use hallsweep_core::world::hall_map::Mark;
    use hallsweep_core::world::records::PART;

    fn with(count: u64) -> Snapshot {
        let mut snapshot = searching();
        for id in 1..=count {
            snapshot.luggage.insert(piece(id, Cell::new(3, 2), Some(Verdict::Safe)));
        }
        snapshot
    }

    #[test]
    fn every_piece_is_drawn() {
        let drawn = all(&searching());
        for part in ["piece safe", "piece danger", "piece pending", "#3"] {
            assert!(drawn.contains(part), "{part} in {drawn}");
        }
    }

    #[test]
    fn one_more_piece_sends_those_beside_it_and_not_all_that_were_found() {
        let older = with(20 * PART as u64 + 5);
        let mut newer = older.clone();
        newer.luggage.insert(piece(20 * PART as u64 + 6, Cell::new(4, 4), None));
        let sent = changed(Some(&older), &newer);
        assert_eq!(sent.keys().map(String::as_str).collect::<Vec<_>>(), ["pieces_20"]);
        assert_eq!(sent["pieces_20"].matches("class=\"piece").count(), 6);
        assert!(changed(Some(&newer), &newer.clone()).is_empty());
    }

    #[test]
    fn a_larger_picture_draws_all_anew_and_an_emptied_hall_takes_them_away() {
        let older = with(PART as u64 + 1);
        let mut newer = older.clone();
        newer.map.mark(Cell::new(199, 90), Mark::Visited, Revision(21));
        assert_eq!(changed(Some(&older), &newer).len(), 2);
        let gone = changed(Some(&older), &idle());
        assert_eq!(gone.values().map(String::as_str).collect::<Vec<_>>(), ["", ""]);
    }
}
