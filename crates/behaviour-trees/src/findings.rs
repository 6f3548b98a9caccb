//! Collects all faults of a file of trees, and other notes for its author.

use std::collections::BTreeSet;

use super::error::TreeError;
use crate::fnv1a;

/// Maximum number of faults that are reported. The same limit applies to notes. Further faults are only counted.
pub const MOST_FAULTS: usize = 100;

/// Faults and notes about a file. A file with faults is refused; a file with notes is not.
#[derive(Debug, Default)]
pub struct Findings {
    faults: Vec<TreeError>,
    notes: Vec<TreeError>,
    /// Place and hash of the sentence of every fault. A subtree is checked at each use, but each of its faults is
    /// reported only once.
    seen: BTreeSet<(u32, u32, u64)>,
}

impl Findings {
    pub(crate) fn fault(&mut self, fault: TreeError) {
        let key = (fault.place.line, fault.place.column, fnv1a(&fault.reason.to_string()));
        if self.seen.insert(key) && self.faults.len() < MOST_FAULTS {
            self.faults.push(fault);
        }
    }

    /// Adds a note. Notes with the same reason are reported once, at the place of the first one.
    pub(crate) fn note(&mut self, note: TreeError) {
        if self.notes.len() < MOST_FAULTS && !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    /// The fault that was found first. It need not be the first fault in the file.
    pub(crate) fn first(&self) -> Result<(), TreeError> {
        self.faults.first().map_or(Ok(()), |fault| Err(fault.clone()))
    }

    /// The faults in the order of the file, at most [`MOST_FAULTS`].
    #[must_use]
    pub fn faults(&self) -> Vec<&TreeError> {
        let mut faults: Vec<&TreeError> = self.faults.iter().collect();
        faults.sort_by_key(|fault| (fault.place.line, fault.place.column));
        faults
    }

    /// Number of faults that [`Findings::faults`] does not return.
    #[must_use]
    pub fn more(&self) -> usize {
        self.seen.len() - self.faults.len()
    }

    /// The notes in the order in which they were found.
    #[must_use]
    pub fn notes(&self) -> &[TreeError] {
        &self.notes
    }
}
