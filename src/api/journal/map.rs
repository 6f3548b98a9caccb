//! The hall map in the journal. Each row has its number, its first known column, and runs of equal cells. Runs keep
//! both walls and floors short: a hall of 512 × 512 cells takes some kilobytes.
//!
//! ```text
//!   [4, -1, "W1V12.3L1"]   row 4, from column -1: a wall, twelve visited cells, three unknown, a piece of luggage
//! ```

use serde::{Deserialize, Serialize};

use super::Unparsed;
use crate::api::fields::in_short;
use hallsweep_core::units::{Cell, Revision};
use hallsweep_core::world::hall_map::{HallMap, Mark, REACH};

const LETTERS: [(Mark, char); 6] = [
    (Mark::Unknown, '.'),
    (Mark::Seen, 'S'),
    (Mark::Visited, 'V'),
    (Mark::Wall, 'W'),
    (Mark::Luggage, 'L'),
    (Mark::NotInspected, 'N'),
];

/// A row: its `y`, the `x` of its first known cell, and its runs of equal cells.
#[derive(Serialize, Deserialize)]
pub(super) struct Row(i32, i32, String);

pub(super) fn named(name: &str) -> Result<Mark, Unparsed> {
    let known = LETTERS.iter().find(|(mark, _)| mark.name() == name);
    known.map(|(mark, _)| *mark).ok_or_else(|| Unparsed(format!("{:?} is no mark of a cell", in_short(name))))
}

pub(super) fn rows(map: &HallMap) -> Vec<Row> {
    let mut cells: Vec<(i32, i32, Mark)> = map.known().map(|(cell, mark)| (cell.y, cell.x, mark)).collect();
    cells.sort_unstable_by_key(|(y, x, _)| (*y, *x));
    cells.chunk_by(|a, b| a.0 == b.0).map(row).collect()
}

pub(super) fn map(rows: &[Row]) -> Result<HallMap, Unparsed> {
    let mut map = HallMap::new(Cell::HOME, Revision(1));
    // A new map has a mark at the home cell. The mark is removed, because all marks must come from the stored map.
    map.mark(Cell::HOME, Mark::Unknown, Revision(1));
    rows.iter().try_for_each(|row| draw(&mut map, row))?;
    Ok(map)
}

fn row(cells: &[(i32, i32, Mark)]) -> Row {
    let (y, first, _) = cells[0];
    let mut runs = Runs::default();
    let mut next = first;
    for (_, x, mark) in cells {
        runs.add(Mark::Unknown, x - next);
        runs.add(*mark, 1);
        next = x + 1;
    }
    Row(y, first, runs.text())
}

#[derive(Default)]
struct Runs {
    text: String,
    open: Option<(Mark, i32)>,
}

impl Runs {
    fn add(&mut self, mark: Mark, count: i32) {
        match &mut self.open {
            _ if count == 0 => {}
            Some((open, length)) if *open == mark => *length += count,
            _ => {
                self.close();
                self.open = Some((mark, count));
            }
        }
    }

    fn close(&mut self) {
        if let Some((mark, count)) = self.open.take() {
            self.text.push(letter(mark));
            self.text.push_str(&count.to_string());
        }
    }

    fn text(mut self) -> String {
        self.close();
        self.text
    }
}

fn letter(mark: Mark) -> char {
    let known = LETTERS.iter().find(|(known, _)| *known == mark);
    known.expect("a test walks all marks").1
}

fn mark(letter: char) -> Result<Mark, Unparsed> {
    let known = LETTERS.iter().find(|(_, known)| *known == letter);
    known.map(|(mark, _)| *mark).ok_or_else(|| Unparsed(format!("{letter:?} is no mark of a cell")))
}

/// Draws a row into the map. Cells beyond the map's reach are refused. Otherwise a large number in a file could make
/// the program draw for ever.
fn draw(map: &mut HallMap, Row(y, first, runs): &Row) -> Result<(), Unparsed> {
    let wrong = || Unparsed(format!("row {y} of the map is no row: {:?}", in_short(runs)));
    let within = |number: i32| (-REACH..=REACH).contains(&number);
    let mut x = *first;
    let mut rest = runs.as_str();
    while let Some(letter) = rest.chars().next() {
        let mark = mark(letter)?;
        let after = &rest[letter.len_utf8()..];
        let digits = after.bytes().take_while(u8::is_ascii_digit).count();
        let count: i32 = after[..digits].parse().map_err(|_| wrong())?;
        let end = x.checked_add(count).ok_or_else(wrong)?;
        if !(count > 0 && within(x) && within(end - 1) && within(*y)) {
            return Err(wrong());
        }
        for x in x..end {
            map.mark(Cell::new(x, *y), mark, Revision(1));
        }
        (x, rest) = (end, &after[digits..]);
    }
    Ok(())
}
