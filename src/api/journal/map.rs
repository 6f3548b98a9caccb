//! The hall map in the journal. The runs of a row are one text.
//!
//! ```text
//!   [4, -1, "W1V12.3L1"]   row 4, from column -1: a wall, twelve visited cells, three unknown, a piece of luggage
//! ```

use super::Unparsed;
use super::rows::{self, Row};
use crate::api::fields::in_short;
use hallsweep_core::units::{Cell, Revision};
use hallsweep_core::world::hall_map::{HallMap, Mark};

const LETTERS: [(Mark, char); 6] = [
    (Mark::Unknown, '.'),
    (Mark::Seen, 'S'),
    (Mark::Visited, 'V'),
    (Mark::Wall, 'W'),
    (Mark::Luggage, 'L'),
    (Mark::NotInspected, 'N'),
];

pub(super) fn named(name: &str) -> Result<Mark, Unparsed> {
    let known = LETTERS.iter().find(|(mark, _)| mark.name() == name);
    known.map(|(mark, _)| *mark).ok_or_else(|| Unparsed(format!("{:?} is no mark of a cell", in_short(name))))
}

pub(super) fn rows(map: &HallMap) -> Vec<Row<String>> {
    let text = |runs: &[(i32, Mark)]| runs.iter().map(|(count, mark)| format!("{}{count}", letter(*mark))).collect();
    rows::of(map.known(), Mark::Unknown).iter().map(|Row(y, x, runs)| Row(*y, *x, text(runs))).collect()
}

pub(super) fn map(rows: &[Row<String>]) -> Result<HallMap, Unparsed> {
    let mut map = HallMap::new(Cell::HOME, Revision(1));
    // A new map has a mark at the home cell. The mark is removed, because all marks must come from the stored map.
    map.mark(Cell::HOME, Mark::Unknown, Revision(1));
    for Row(y, first, text) in rows {
        let runs = runs(text).ok_or_else(|| Unparsed(format!("row {y} of the map is no row: {:?}", in_short(text))))?;
        rows::walk((*y, *first), runs.into_iter(), |cell, mark| {
            map.mark(cell, mark, Revision(1));
        })?;
    }
    Ok(map)
}

fn letter(mark: Mark) -> char {
    let known = LETTERS.iter().find(|(known, _)| *known == mark);
    known.expect("a test walks all marks").1
}

fn runs(text: &str) -> Option<Vec<(i32, Mark)>> {
    let mut runs = Vec::new();
    let mut rest = text;
    while let Some(letter) = rest.chars().next() {
        let (mark, _) = LETTERS.iter().find(|(_, known)| *known == letter)?;
        let digits = &rest[letter.len_utf8()..];
        let count;
        (count, rest) = digits.split_at(digits.find(|digit: char| !digit.is_ascii_digit()).unwrap_or(digits.len()));
        runs.push((count.parse().ok()?, *mark));
    }
    Some(runs)
}
