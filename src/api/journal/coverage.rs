//! What the search has looked at, in the journal.
//!
//! ```text
//!   [4, -1, [[12, 65536, 29502841], [3, 0, 0]]]   row 4, from column -1: twelve cells with these views, last looked at
//!                                                 in this minute since 1970; three cells without views
//! ```

use super::Unparsed;
use super::rows::{self, Row};
use hallsweep_core::world::coverage::{Coverage, Views};

pub(super) type Looks = Row<Vec<(i32, u32, u32)>>;

pub(super) fn rows(coverage: &Coverage) -> Vec<Looks> {
    let run = |(count, views): (i32, Views)| (count, views.bits, views.minute);
    let rows = rows::of(coverage.iter(), Views::default()).into_iter();
    rows.map(|Row(y, x, runs)| Row(y, x, runs.into_iter().map(run).collect())).collect()
}

pub(super) fn coverage(rows: &[Looks]) -> Result<Coverage, Unparsed> {
    let mut coverage = Coverage::default();
    for Row(y, first, runs) in rows {
        let runs = runs.iter().map(|(count, bits, minute)| (*count, Views { bits: *bits, minute: *minute }));
        rows::walk((*y, *first), runs, |cell, views| coverage.add(cell, views))?;
    }
    Ok(coverage)
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::units::Cell;

    #[test]
    fn a_row_that_is_no_row_is_refused() {
        for count in [0, -1, 99_999_999, i32::MAX] {
            assert!(coverage(&[Row(1, 1, vec![(1, 1, 0), (count, 1, 0)])]).is_err(), "{count}");
        }
    }

    #[test]
    fn runs_are_short_and_read_back() {
        let mut looks = Coverage::default();
        for (x, bits, minute) in [(-2, 1, 50), (-1, 1, 50), (3, 0xff00_0000, 48)] {
            looks.add(Cell::new(x, 4), Views { bits, minute });
        }
        let rows = rows(&looks);
        assert_eq!(serde_json::to_string(&rows).unwrap(), "[[4,-2,[[2,1,50],[3,0,0],[1,4278190080,48]]]]");
        assert_eq!(coverage(&rows), Ok(looks));
    }
}
