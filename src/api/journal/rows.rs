//! Cells of a hall in the journal, as rows: each has its number, its first column, and runs of equal cells. Runs keep both
//! walls and floors short: a hall of 512 × 512 cells takes some kilobytes.

use serde::{Deserialize, Serialize};

use super::Unparsed;
use hallsweep_core::units::Cell;
use hallsweep_core::world::hall_map::REACH;

/// A row: its `y`, the `x` of its first cell, and its runs.
#[derive(Serialize, Deserialize)]
pub(super) struct Row<Runs>(pub(super) i32, pub(super) i32, pub(super) Runs);

/// Returns each row with the length and the value of its runs. `gap` is the value of the cells between the given ones.
pub(super) fn of<T: Copy + PartialEq>(cells: impl Iterator<Item = (Cell, T)>, gap: T) -> Vec<Row<Vec<(i32, T)>>> {
    let mut cells: Vec<(Cell, T)> = cells.collect();
    cells.sort_unstable_by_key(|(cell, _)| (cell.y, cell.x));
    let row = |row: &[(Cell, T)]| {
        let Cell { x, y } = row[0].0;
        let (mut next, mut runs) = (x, Vec::new());
        for run in row.chunk_by(|a, b| a.1 == b.1 && a.0.x + 1 == b.0.x) {
            let (first, after) = (run[0].0.x, run[run.len() - 1].0.x + 1);
            runs.extend([(first - next, gap), (after - first, run[0].1)]);
            next = after;
        }
        runs.retain(|(count, _)| *count > 0);
        Row(y, x, runs)
    };
    cells.chunk_by(|a, b| a.0.y == b.0.y).map(row).collect()
}

/// Calls `put` for the cells of a row. Cells beyond the map's reach are refused. Otherwise a large number in a file could
/// make the program draw for ever.
pub(super) fn walk<T: Copy>(
    (y, first): (i32, i32),
    runs: impl Iterator<Item = (i32, T)>,
    mut put: impl FnMut(Cell, T),
) -> Result<(), Unparsed> {
    let within = |number: i32| (-REACH..=REACH).contains(&number);
    let mut x = first;
    for (count, value) in runs {
        let end = x.checked_add(count).filter(|end| count > 0 && within(x) && within(end - 1) && within(y));
        let end = end.ok_or_else(|| Unparsed(format!("row {y} of the map is no row: {count} cells from column {x}")))?;
        (x..end).for_each(|x| put(Cell::new(x, y), value));
        x = end;
    }
    Ok(())
}
