//! The luggage in the picture of the hall. Each piece is drawn in its own cell. Pieces are grouped by their numbers,
//! so that a change sends only a few pieces. In a large picture, where cells are too small, a pin represents all
//! pieces in a square of cells. Pins are grouped by rows of squares. A piece is no larger than its cell and a pin no
//! larger than its square, so the drawings never overlap. `hall::layer` draws a piece that is to be fetched.
//! `carriers` draws held and secured pieces.

use std::collections::BTreeMap;
use std::sync::Arc;

use super::carriers::fetched;
use super::drawing::{CELL, larger, middle, said, shape, write};
use crate::phrases::Language;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{Cell, LuggageId};
use hallsweep_core::world::luggage::Luggage;

pub(super) fn all(language: Language, snapshot: &Snapshot) -> String {
    groups(language, snapshot).map(|(_, markup)| markup).collect()
}

pub(super) fn all_pins(language: Language, snapshot: &Snapshot) -> String {
    pins(language, snapshot).into_values().collect()
}

/// Returns the groups of pieces and the rows of pins that differ from an older snapshot, by their ids. A removed
/// group or row has empty markup.
pub(super) fn changed(language: Language, older: Option<&Snapshot>, snapshot: &Snapshot) -> BTreeMap<String, String> {
    let Some(older) = older else { return groups(language, snapshot).chain(pins(language, snapshot)).collect() };
    let looks = |snapshot: &Snapshot| (larger(&snapshot.map), fetched(snapshot).map(|piece| piece.id));
    let is_same = looks(older) == looks(snapshot);
    let newer: Vec<_> = snapshot.luggage.parts_changed_since(&older.luggage).collect();
    let (before, now) = (older.luggage.parts().len(), snapshot.luggage.parts().len());
    if is_same && newer.is_empty() && before == now {
        return BTreeMap::new();
    }
    let mut changed: BTreeMap<String, String> = (now..before).map(|place| (id(place), String::new())).collect();
    if looks(older).1 == looks(snapshot).1 {
        changed.extend(newer.into_iter().map(|(place, pieces)| (id(place), group(language, snapshot, place, pieces))));
    } else {
        changed.extend(groups(language, snapshot));
    }
    let (before, now) = (pins(language, older), pins(language, snapshot));
    changed.extend(before.keys().filter(|row| !now.contains_key(*row)).map(|row| (row.clone(), String::new())));
    changed.extend(now.into_iter().filter(|(row, markup)| before.get(row) != Some(markup)));
    changed
}

pub(super) fn in_their_cells<'a>(language: Language, pieces: impl Iterator<Item = &'a Luggage>) -> String {
    let mut group = String::new();
    pieces.for_each(|piece| draw(language, &mut group, piece));
    group
}

/// Draws a pin for each square with pieces. The side of a square is `size` cells. Used for pictures that are too
/// large for single pieces.
pub(super) fn pinned<'a>(language: Language, pieces: impl Iterator<Item = &'a Luggage>, size: i32) -> String {
    rows(language, pieces, size).into_values().collect()
}

fn groups(language: Language, snapshot: &Snapshot) -> impl Iterator<Item = (String, String)> {
    snapshot.luggage.parts().enumerate().map(move |(place, pieces)| (id(place), group(language, snapshot, place, pieces)))
}

fn id(place: usize) -> String {
    format!("pieces_{place}")
}

fn group(language: Language, snapshot: &Snapshot, place: usize, pieces: &[Arc<Luggage>]) -> String {
    let fetched = fetched(snapshot).map(|piece| piece.id);
    let left = pieces.iter().map(|piece| &**piece).filter(|piece| is_left(piece, fetched));
    format!("<g id=\"{}\">{}</g>", id(place), in_their_cells(language, left))
}

fn is_left(piece: &Luggage, fetched: Option<LuggageId>) -> bool {
    piece.secured.is_none() && Some(piece.id) != fetched
}

fn draw(language: Language, group: &mut String, piece: &Luggage) {
    let (verdict, id, (x, y)) = (piece.verdict_name(), piece.id, middle(piece.cell));
    let (shape, letter, said) = (shape(verdict), language.say_of("letter", verdict), said(language, piece));
    write(
        group,
        format_args!(
            "<g class=\"piece own {verdict}\" data-piece=\"{id}\" transform=\"translate({x} {y}) scale(.9)\">{shape}<text y=\".6\">{letter}</text>\
             <text class=\"number\" y=\"3.7\">{id}</text><title>{said}</title></g>"
        ),
    );
}

/// Returns the pins of the picture, by the ids of their rows. Empty when every piece is visible in its cell.
fn pins(language: Language, snapshot: &Snapshot) -> BTreeMap<String, String> {
    let (size, fetched) = (larger(&snapshot.map), fetched(snapshot).map(|piece| piece.id));
    if size == 1 {
        return BTreeMap::new();
    }
    rows(language, snapshot.luggage.iter().map(|piece| &**piece).filter(|piece| is_left(piece, fetched)), size)
}

fn rows<'a>(language: Language, pieces: impl Iterator<Item = &'a Luggage>, size: i32) -> BTreeMap<String, String> {
    let mut squares: BTreeMap<(i32, i32), Square<'a>> = BTreeMap::new();
    for piece in pieces {
        let Cell { x, y } = piece.cell;
        squares.entry((y.div_euclid(size), x.div_euclid(size))).or_default().add(piece);
    }
    let mut rows: BTreeMap<i32, String> = BTreeMap::new();
    for ((row, column), square) in squares {
        square.draw(language, rows.entry(row).or_default(), (column, row), size);
    }
    rows.into_iter().map(|(row, pins)| (format!("pins_{row}"), format!("<g id=\"pins_{row}\">{pins}</g>"))).collect()
}

#[derive(Default)]
struct Square<'a> {
    danger: usize,
    pending: usize,
    safe: usize,
    last: Option<&'a Luggage>,
}

impl<'a> Square<'a> {
    fn add(&mut self, piece: &'a Luggage) {
        let count = match piece.verdict_name() {
            "danger" => &mut self.danger,
            "safe" => &mut self.safe,
            _ => &mut self.pending,
        };
        *count += 1;
        self.last = Some(piece);
    }

    /// Draws a pin in the middle of the square. It shows the worst verdict of the pieces in the square.
    fn draw(&self, language: Language, row: &mut String, (x, y): (i32, i32), size: i32) {
        let verdict = match (self.danger, self.pending) {
            (0, 0) => "safe",
            (0, _) => "pending",
            _ => "danger",
        };
        let (shape, count) = (shape(verdict), self.danger + self.pending + self.safe);
        let (sign, piece, said) = match self.last.filter(|_| count == 1) {
            Some(piece) => {
                (language.say_of("letter", verdict).to_string(), format!(" data-piece=\"{}\"", piece.id), said(language, piece))
            }
            None => {
                let all = [(self.danger, "danger"), (self.pending, "pending"), (self.safe, "safe")];
                let all = all.into_iter().filter(|(count, _)| *count > 0);
                let all = all.map(|(count, verdict)| language.say_of("counted", verdict).with("count", count).to_string());
                let what = all.collect::<Vec<_>>().join(", ");
                let said = language.say("pieces-are").with("count", count).with("what", what).to_string();
                (count.to_string(), String::new(), said)
            }
        };
        let (x, y) = (x * size * CELL + size * CELL / 2, y * size * CELL + size * CELL / 2);
        write(
            row,
            format_args!(
                "<g class=\"piece pin {verdict}\"{piece} transform=\"translate({x} {y})\"><g class=\"sized\" transform=\"scale({size})\">\
                 <g transform=\"scale(.9)\">{shape}<text y=\"2\">{sign}</text></g></g><title>{said}</title></g>"
            ),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::api::tests::fixture::{idle, piece, searching};
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
        let drawn = all(Language::English, &searching());
        for part in ["piece own safe", "piece own danger", "piece own pending", "#3"] {
            assert!(drawn.contains(part), "{part} in {drawn}");
        }
        assert_eq!(all_pins(Language::English, &searching()), "", "where every cell can be seen there are no pins");
    }

    #[test]
    fn where_cells_are_tiny_one_pin_stands_for_a_square_of_them_and_looks_like_its_worst_piece() {
        let mut snapshot = searching();
        snapshot.map.mark(Cell::new(199, 90), Mark::Visited, Revision(21));
        snapshot.luggage = Default::default();
        let pieces = [
            (0, 0, Some(Verdict::Safe)),
            (6, 6, Some(Verdict::Danger)),
            (7, 0, None),
            (13, 0, Some(Verdict::Safe)),
            (70, 70, None),
        ];
        for (id, (x, y, verdict)) in (1..).zip(pieces) {
            snapshot.luggage.insert(piece(id, Cell::new(x, y), verdict));
        }
        let rows = pins(Language::English, &snapshot);
        assert_eq!(rows.keys().map(String::as_str).collect::<Vec<_>>(), ["pins_0", "pins_10"]);
        for part in [
            "piece pin danger\" transform=\"translate(35 35)\"",
            "2 pieces: 1 danger, 1 safe",
            "piece pin pending\" transform=\"translate(105 35)\"",
            "2 pieces: 1 pending, 1 safe",
        ] {
            assert!(rows["pins_0"].contains(part), "{part} in {}", rows["pins_0"]);
        }
        assert!(rows["pins_10"].contains("data-piece=\"5\"") && rows["pins_10"].contains("luggage #5: pending"));
    }

    #[test]
    fn one_more_piece_sends_those_beside_it_and_not_all_that_were_found() {
        let older = with(20 * PART as u64 + 5);
        let mut newer = older.clone();
        newer.luggage.insert(piece(20 * PART as u64 + 6, Cell::new(4, 4), None));
        let sent = changed(Language::English, Some(&older), &newer);
        assert_eq!(sent.keys().map(String::as_str).collect::<Vec<_>>(), ["pieces_20"]);
        assert_eq!(sent["pieces_20"].matches("class=\"piece own").count(), 6);
        assert!(changed(Language::English, Some(&newer), &newer.clone()).is_empty());
    }

    /// Returns the middle (x, y) and half the side length of each drawn box, strokes included.
    fn boxes(markup: &str) -> Vec<(f64, f64, f64)> {
        let number = |text: &str| text.parse::<f64>().expect("a number");
        let drawn = markup.split("<g class=\"piece").skip(1).map(|drawn| {
            let (_, at) = drawn.split_once("translate(").expect("it has a place");
            let (x, y) = at.split_once(')').and_then(|(at, _)| at.split_once(' ')).expect("two numbers");
            let scales = drawn.split("scale(").skip(1).map(|scale| number(scale.split(')').next().expect("it ends")));
            // The largest shape is the triangle, 10 units high and wide. Half of its stroke lies outside.
            (number(x), number(y), scales.product::<f64>() * (5.0 + 0.35))
        });
        drawn.collect()
    }

    fn check_apart(markup: &str) -> usize {
        let mut boxes = boxes(markup);
        boxes.sort_by(|a, b| a.0.total_cmp(&b.0));
        for (place, (x, y, half)) in boxes.iter().enumerate() {
            for (other_x, other_y, other) in boxes[place + 1..].iter().take_while(|(other_x, ..)| other_x - x < 2.0 * half) {
                assert!(
                    (other_y - y).abs() >= half + other || (other_x - x).abs() >= half + other,
                    "at {x} {y} and {other_x} {other_y}"
                );
            }
        }
        boxes.len()
    }

    #[test]
    fn however_many_pieces_there_are_none_is_drawn_over_another() {
        for side in [30, 60, 170, 1000] {
            let mut snapshot = searching();
            snapshot.map.mark(Cell::new(side - 1, side - 1), Mark::Visited, Revision(21));
            snapshot.luggage = Default::default();
            for id in 0..770 {
                let cell = Cell::new(i32::try_from(id * 7919 % 1009).unwrap() % side, i32::try_from(id / 2).unwrap() % side);
                snapshot.luggage.insert(piece(id + 1, cell, if id % 3 == 0 { None } else { Some(Verdict::Danger) }));
            }
            let cells: std::collections::BTreeSet<Cell> = snapshot.luggage.iter().map(|piece| piece.cell).collect();
            if cells.len() == snapshot.luggage.len() {
                assert_eq!(check_apart(&all(Language::English, &snapshot)), 770);
            }
            assert!(
                check_apart(&all_pins(Language::English, &snapshot)) > 0 || larger(&snapshot.map) == 1,
                "{side} cells a side"
            );
        }
    }

    #[test]
    fn a_larger_picture_draws_all_anew_and_an_emptied_hall_takes_them_away() {
        let older = with(PART as u64 + 1);
        let mut newer = older.clone();
        newer.map.mark(Cell::new(199, 90), Mark::Visited, Revision(21));
        assert_eq!(changed(Language::English, Some(&older), &newer).keys().map(String::as_str).collect::<Vec<_>>(), ["pins_0"]);
        assert_eq!(changed(Language::English, Some(&newer), &older)["pins_0"], "", "in a small one they are gone");
        let gone = changed(Language::English, Some(&older), &idle());
        assert_eq!(gone.values().map(String::as_str).collect::<Vec<_>>(), ["", ""]);
    }
}
