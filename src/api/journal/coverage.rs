//! What the search has looked at, in the journal: for each row its number, its first column, and runs of equal cells.
//!
//! ```text
//!   [4, -1, "12.10000.0 3 1.101.2"]   row 4, from column -1: twelve cells with the views 10000 (hexadecimal), last looked
//!                                     at in the first minute of the coverage; three cells without views; and a cell
//! ```

use serde::{Deserialize, Serialize};

use super::Unparsed;
use crate::api::fields::in_short;
use hallsweep_core::units::Cell;
use hallsweep_core::world::coverage::{Coverage, Views};
use hallsweep_core::world::hall_map::REACH;

#[derive(Default, Serialize, Deserialize)]
pub(super) struct CoverageShape {
    /// The earliest minute of a last look, since 1970. The runs count from it.
    from: u32,
    rows: Vec<(i32, i32, String)>,
}

impl CoverageShape {
    pub(super) fn of(coverage: &Coverage) -> Option<CoverageShape> {
        let mut cells: Vec<(Cell, Views)> = coverage.iter().collect();
        cells.sort_unstable_by_key(|(cell, _)| (cell.y, cell.x));
        let from = cells.iter().map(|(_, views)| views.minute).min()?;
        let rows = cells.chunk_by(|a, b| a.0.y == b.0.y).map(|row| (row[0].0.y, row[0].0.x, runs(row, from)));
        Some(CoverageShape { from, rows: rows.collect() })
    }

    pub(super) fn coverage(&self) -> Result<Coverage, Unparsed> {
        let mut coverage = Coverage::default();
        for (y, first, runs) in &self.rows {
            let wrong = || Unparsed(format!("row {y} of the coverage is no row: {:?}", in_short(runs)));
            let mut x = *first;
            for run in runs.split(' ') {
                let mut parts = run.split('.');
                let count: i32 = parts.next().and_then(|count| count.parse().ok()).ok_or_else(wrong)?;
                let end = x.checked_add(count).ok_or_else(wrong)?;
                let within = |number: i32| (-REACH..=REACH).contains(&number);
                if count < 1 || !(within(x) && within(end - 1) && within(*y)) {
                    return Err(wrong());
                }
                if let Some(bits) = parts.next() {
                    let bits = u32::from_str_radix(bits, 16).map_err(|_| wrong())?;
                    let minutes: u32 = parts.next().and_then(|minutes| minutes.parse().ok()).ok_or_else(wrong)?;
                    let minute = self.from.checked_add(minutes).ok_or_else(wrong)?;
                    (x..end).for_each(|x| coverage.add(Cell::new(x, *y), Views { bits, minute }));
                }
                x = end;
            }
        }
        Ok(coverage)
    }
}

fn runs(row: &[(Cell, Views)], from: u32) -> String {
    let mut runs = Vec::new();
    let mut next = row[0].0.x;
    for run in row.chunk_by(|a, b| a.1 == b.1 && a.0.x + 1 == b.0.x) {
        let (first, views) = run[0];
        if first.x > next {
            runs.push((first.x - next).to_string());
        }
        runs.push(format!("{}.{:x}.{}", run.len(), views.bits, views.minute - from));
        next = first.x + i32::try_from(run.len()).unwrap_or(i32::MAX);
    }
    runs.join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_row_that_is_no_row_is_refused() {
        for runs in
            ["", "x", "0.1.0", "-1.1.0", "1.g.0", "1.1", "1.1.-1", "1.1.4294967295", "99999999.1.0", "2147483647.1.0 1.1.0"]
        {
            let shape = CoverageShape { from: 7, rows: vec![(0, 0, runs.to_owned())] };
            assert!(shape.coverage().is_err(), "{runs}");
        }
    }

    #[test]
    fn runs_are_short_and_read_back() {
        let mut coverage = Coverage::default();
        for (x, bits, minute) in [(-2, 1, 50), (-1, 1, 50), (3, 0xff00_0000, 48)] {
            coverage.add(Cell::new(x, 4), Views { bits, minute });
        }
        let shape = CoverageShape::of(&coverage).expect("something was looked at");
        assert_eq!(shape.rows, [(4, -2, "2.1.2 3 1.ff000000.0".to_owned())]);
        assert_eq!(shape.coverage(), Ok(coverage));
        assert!(CoverageShape::of(&Coverage::default()).is_none());
    }
}
