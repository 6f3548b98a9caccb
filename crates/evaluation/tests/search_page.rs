//! The table of figures in docs/search.md against walks through the halls that it names. A few halls of each row are
//! searched, and must be as near to the table as can be expected of so few; all the halls of the table,
//! `HALLSWEEP_HALLS=600`, must give every digit of it.

use std::time::Duration;

use hallsweep_core::command::Strategy;
use hallsweep_evaluation::compare::rows::{Row, rows};
use hallsweep_evaluation::compare::{Entrant, Estimate, Timings, against, over};

const PAGE: &str = include_str!("../../../docs/search.md");

/// Halls of each row by default.
const HALLS: usize = 2;

/// Greatest distance of the mean of a few halls from that of all, in units of its own 95 % interval, were the halls of
/// a row all alike.
const FAR: f64 = 1.5;

const SHOWN: [Strategy; 5] = [Strategy::Snail, Strategy::Columns, Strategy::Spiral, Strategy::Frontier, Strategy::Auto];

/// The results of a row: each strategy, and `auto` minus `frontier`, hall by hall.
fn estimates(row: &Row) -> Vec<Option<Estimate>> {
    let trials = row.contest.run(&SHOWN.map(Entrant::Strategy), || Duration::ZERO, || ());
    let alone = trials.iter().map(|trials| over(trials, row.measure));
    alone.chain([against(&trials[4], &trials[3], row.measure)]).collect()
}

/// The form in the table: in thousandths, without an interval where all halls are the same.
fn cell(estimate: Option<Estimate>) -> String {
    estimate.map_or_else(String::new, |Estimate { mean, half_width, .. }| {
        let interval = if half_width < 0.000_5 { String::new() } else { format!(" ± {half_width:.3}") };
        format!("{mean:.3}{interval}").replace('-', "−")
    })
}

/// The mean and the interval in a cell of the table.
fn read(cell: &str) -> (f64, f64) {
    let (mean, interval) = cell.split_once(" ± ").unwrap_or((cell, "0"));
    let number = |text: &str| text.replace('−', "-").parse().unwrap_or_else(|_| panic!("{text:?} is no number"));
    (number(mean), number(interval))
}

#[test]
#[expect(clippy::cast_precision_loss, reason = "nobody walks through 2^53 halls")]
fn the_figures_of_the_page_are_those_that_walks_through_its_halls_come_to() {
    let number = |before: &str| -> usize {
        let (_, rest) = PAGE.split_once(before).unwrap_or_else(|| panic!("the page says `{before}N`"));
        rest.split(|letter: char| !letter.is_ascii_digit()).next().and_then(|number| number.parse().ok()).expect("a number")
    };
    let (count, seed) = (number("hallsweep-evaluation evaluate --count "), number(" --seed ") as u64);
    assert!(count >= 600, "the means of fewer halls are the luck of the draw");
    let (_, table) =
        PAGE.split_once("| hall | snail | columns | spiral | frontier | auto | auto minus frontier |\n").expect("the table");
    let lines: Vec<&str> = table.lines().skip(1).take_while(|line| line.starts_with('|')).collect();
    let halls = std::env::var("HALLSWEEP_HALLS").ok().and_then(|halls| halls.parse().ok()).unwrap_or(HALLS);
    let rows = rows(halls, seed, Timings { step_s: 1.0, turn_s: 1.0, bump_s: 1.0 });
    assert_eq!(lines.len(), rows.len());
    let mut wrong = Vec::new();
    for (row, line) in rows.iter().zip(lines) {
        let cells: Vec<&str> = line.trim_matches('|').split('|').map(str::trim).collect();
        let found = estimates(row);
        eprintln!("| {} | {} |", cells[0], found.iter().map(|found| cell(*found)).collect::<Vec<_>>().join(" | "));
        let is_so = |(said, found): (&&str, &Option<Estimate>)| {
            if halls == count {
                return **said == cell(*found);
            }
            let ((mean, interval), found) = (read(said), found.expect("there is something to measure").mean);
            let spread = interval * (count as f64 / halls as f64).sqrt();
            (mean - found).abs() <= FAR * spread + 0.000_5
        };
        if cells.len() != 7 || !cells[1..].iter().zip(&found).all(is_so) {
            wrong.push(line);
        }
    }
    assert!(wrong.is_empty(), "these lines are not so, see what is printed:\n{}", wrong.join("\n"));
}
