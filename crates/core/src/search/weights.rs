//! The weights of the score, and their form in a file.
//!
//! ```text
//!   # where they come from, in any words
//!   least -3000
//!   behindUnknown 1870          a line for each number of the linear part that counts
//!   behindUnknown 1870          a line for each number of the linear part with a weight
//!   [round] 0:-120 7:15 …       and one for each table, with the rows that have a weight
//! All numbers are in thousandths of a step, the unit of the way to an entry.

use std::fmt::Write;
use std::sync::LazyLock;

use super::census::Terrain;
use super::outlook::Outlook;
use super::tables::{LINEAR, LINEAR_NAMES, ROWS, STARTS, TABLES};
use super::view::{Objective, Terms};

/// The weight of each number of an outlook, in thousandths of a step.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Weights {
    pub linear: [i32; LINEAR],
    pub rows: Vec<i16>,
    /// Lower bound of the worth of any outlook. It limits how far a search must go.
    pub least: i32,
}

struct Set {
    objective: Objective,
    /// Range of the sonar, in cells.
    sonar_cells: u8,
    turn: u32,
    terrain: Terrain,
    weights: LazyLock<Weights>,
}

macro_rules! set {
    ($objective:ident, $sonar_cells:literal, $turn:literal, $terrain:ident, $file:literal) => {
        Set {
            objective: Objective::$objective,
            sonar_cells: $sonar_cells,
            turn: $turn,
            terrain: Terrain::$terrain,
            weights: LazyLock::new(|| {
                let read = Weights::read(include_str!(concat!("../../weights/", $file, ".txt")));
                read.expect("a test reads all shipped weights")
            }),
        }
    };
}

static SETS: [Set; 10] = [
    set!(Cover, 0, 4, Usual, "cover-bump"),
    set!(Cover, 0, 4, Open, "cover-open"),
    set!(Cover, 0, 4, Dense, "cover-dense"),
    set!(Cover, 0, 0, Usual, "cover-steps"),
    set!(Cover, 0, 6, Usual, "cover-slow-turns"),
    set!(Cover, 1, 4, Usual, "cover-sonar"),
    set!(Find, 0, 4, Usual, "find-bump"),
    set!(Find, 0, 6, Usual, "find-slow-turns"),
    // For a sonar that sees two cells, the next two sets fit equally well. The first of them is used.
    set!(Find, 3, 4, Usual, "find-far-sonar"),
    set!(Find, 1, 4, Usual, "find-sonar"),
];

impl Set {
    /// Returns how badly these weights fit the task, with the most important difference first. Whether turns have a
    /// cost at all matters more than the terrain. The terrain matters more than the exact cost of turns.
    fn distance(&self, terms: Terms, terrain: Terrain) -> (bool, bool, u8, bool, bool, u32) {
        let turn = terms.costs.turn;
        (
            self.objective != terms.objective,
            (self.sonar_cells > 0) != (terms.sonar_cells > 0),
            self.sonar_cells.abs_diff(terms.sonar_cells),
            (self.turn > 0) != (turn > 0),
            self.terrain != terrain,
            self.turn.abs_diff(turn),
        )
    }
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line} of the weights: {found:?} is not {wanted}")]
pub struct WeightsError {
    line: usize,
    found: String,
    wanted: &'static str,
}

impl Weights {
    /// Returns weights that are all 0, so that only the way to a cell counts.
    #[must_use]
    pub fn nothing() -> Weights {
        Weights { linear: [0; LINEAR], rows: vec![0; ROWS], least: 0 }
    }

    /// Returns the weights that were tuned for this task. If there are none, returns the weights for the most similar
    /// task.
    #[must_use]
    pub fn shipped(terms: Terms, terrain: Terrain) -> &'static Weights {
        let nearest = SETS.iter().min_by_key(|set| set.distance(terms, terrain));
        &nearest.expect("at least one set is shipped").weights
    }

    /// Reads the file format that is shown at the top of this module.
    ///
    /// # Errors
    /// The first invalid line.
    pub fn read(text: &str) -> Result<Weights, WeightsError> {
        let mut weights = Weights::nothing();
        let mut has_least = false;
        for (line, written) in (1..).zip(text.lines()).filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#')) {
            let wrong = |found: &str, wanted| WeightsError { line, found: found.to_owned(), wanted };
            let mut words = written.split_whitespace();
            let name = words.next().unwrap_or_default();
            if let Some(table) = name.strip_prefix('[').and_then(|name| name.strip_suffix(']')) {
                let table =
                    TABLES.iter().position(|(known, _)| *known == table).ok_or_else(|| wrong(table, "the name of a table"))?;
                for word in words {
                    let row = read_row(word, TABLES[table].1).ok_or_else(|| wrong(word, "ROW:WEIGHT of this table"))?;
                    weights.rows[STARTS[table] + row.0] = row.1;
                }
                continue;
            }
            let value = words.next().unwrap_or_default();
            let value: i32 = value.parse().map_err(|_| wrong(value, "a whole number"))?;
            if name == "least" {
                (weights.least, has_least) = (value, true);
            } else {
                let number = LINEAR_NAMES.iter().position(|known| *known == name);
                weights.linear[number.ok_or_else(|| wrong(name, "the name of a weight"))?] = value;
            }
        }
        // Every file of weights has a line `least`. A file without this line is cut off, or is another kind of file.
        if has_least {
            Ok(weights)
        } else {
            Err(WeightsError { line: text.lines().count(), found: "the end".to_owned(), wanted: "a line with least" })
        }
    }

    /// Returns the text of a file with these weights, which names their origin. Rows whose weight is closer to 0 than
    /// `smallest` are left out.
    #[must_use]
    pub fn write(&self, origin: &str, smallest: i16) -> String {
        let mut text: String = origin.lines().map(|line| format!("# {line}\n")).collect();
        let _ = writeln!(text, "least {}", self.least);
        for (name, weight) in LINEAR_NAMES.iter().zip(self.linear).filter(|(_, weight)| *weight != 0) {
            let _ = writeln!(text, "{name} {weight}");
        }
        for ((name, size), start) in TABLES.iter().zip(STARTS) {
            let rows = self.rows[start..start + size]
                .iter()
                .enumerate()
                .filter(|(_, weight)| weight.unsigned_abs() >= smallest.unsigned_abs());
            let rows: String = rows.map(|(row, weight)| format!(" {row}:{weight}")).collect();
            if !rows.is_empty() {
                let _ = writeln!(text, "[{name}]{rows}");
            }
        }
        text
    }

    /// Returns the worth of an outlook in thousandths of a step, without the way. It is never below `least`.
    #[must_use]
    pub fn worth(&self, outlook: &Outlook) -> i32 {
        let linear: i64 = self.linear.iter().zip(outlook.linear).map(|(weight, n)| i64::from(*weight) * i64::from(n)).sum();
        let rows: i32 = outlook.rows.iter().map(|row| i32::from(self.rows[*row as usize])).sum();
        i32::try_from(linear / 1000).unwrap_or(0).saturating_add(rows).max(self.least)
    }
}

/// Reads `ROW:WEIGHT` for a table with this many rows.
fn read_row(word: &str, size: usize) -> Option<(usize, i16)> {
    let (row, weight) = word.split_once(':')?;
    let row = row.parse().ok().filter(|row| *row < size)?;
    Some((row, weight.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::search::costs::Costs;

    #[test]
    fn what_is_shipped_can_be_read_and_counts_something() {
        for set in &SETS {
            let of = format!("{}, sonar of {}, turn {}, {:?}", set.objective.name(), set.sonar_cells, set.turn, set.terrain);
            assert!(set.weights.rows.iter().any(|row| *row != 0), "{of}");
            assert!(set.weights.least < 0, "a search without a bound goes through the whole hall at every step: {of}");
        }
    }

    #[test]
    fn every_search_has_the_weights_that_were_tuned_for_what_is_nearest_to_it() {
        let (even, slow, steps) = (Costs::EVEN, Costs { turn: 7, bump: 4 }, Costs { turn: 0, bump: 0 });
        for (objective, sonar_cells, costs, terrain, set) in [
            (Objective::Cover, 0, even, Terrain::Usual, 0),
            (Objective::Cover, 0, even, Terrain::Open, 1),
            (Objective::Cover, 0, even, Terrain::Dense, 2),
            (Objective::Cover, 0, steps, Terrain::Open, 3),
            (Objective::Cover, 0, slow, Terrain::Usual, 4),
            (Objective::Cover, 0, slow, Terrain::Dense, 2),
            (Objective::Cover, 3, slow, Terrain::Open, 5),
            (Objective::Find, 0, even, Terrain::Dense, 6),
            (Objective::Find, 0, slow, Terrain::Open, 7),
            (Objective::Find, 1, even, Terrain::Usual, 9),
            (Objective::Find, 2, slow, Terrain::Open, 8),
            (Objective::Find, 7, even, Terrain::Dense, 8),
        ] {
            let shipped = Weights::shipped(Terms { objective, sonar_cells, costs }, terrain);
            let of = format!("{} by sonar of {sonar_cells}, {costs}, {terrain:?}", objective.name());
            assert!(std::ptr::eq(shipped, &*SETS[set].weights), "{of}");
        }
    }

    #[test]
    fn weights_are_read_back_as_they_were_written() {
        let mut weights = Weights { least: -2500, ..Weights::nothing() };
        weights.linear[3] = -17;
        (weights.rows[0], weights.rows[ROWS - 1]) = (40, -5000);
        assert_eq!(Weights::read(&weights.write("a test\nof two lines", 1)), Ok(weights));
    }

    #[test]
    fn a_line_that_is_not_as_it_should_be_is_named() {
        let check = |text: &str, expect: &str| assert_eq!(Weights::read(text).unwrap_err().to_string(), expect);
        check("# x\nleast y", "line 2 of the weights: \"y\" is not a whole number");
        check("", "line 0 of the weights: \"the end\" is not a line with least");
        check("speed 3", "line 1 of the weights: \"speed\" is not the name of a weight");
        check("[rond] 1:2", "line 1 of the weights: \"rond\" is not the name of a table");
        check("[round] 2187:2", "line 1 of the weights: \"2187:2\" is not ROW:WEIGHT of this table");
    }
}
