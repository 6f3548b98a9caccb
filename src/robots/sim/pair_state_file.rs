//! Stores what the simulated pair and its hall must not forget, in one small file of the data folder. `state_file`
//! does the same for the searching robot. The file is replaced as a whole and not flushed, which is enough to survive
//! `kill -9`. Its format is in `hallsweep_sim::pair::page`.

use std::path::Path;

use super::state_file::StateFileError;
use crate::storage::names;
use crate::storage::small_file::SmallFile;
use hallsweep_sim::Hall;
use hallsweep_sim::page::{Unread, Whose};
use hallsweep_sim::pair::{PairMemory, page};

#[derive(Debug)]
pub(super) struct PairStateFile {
    file: SmallFile,
    whose: Whose,
    /// A memory that still has to be written after a failure.
    owed: Option<Box<PairMemory>>,
}

impl PairStateFile {
    /// Opens the pair's state file in the folder `dir`, and reads the memory of this hall; `None` when there is no
    /// file yet. Writes nothing, and does not change a file that cannot be read or belongs to another hall.
    pub(super) fn open(dir: &Path, hall: &Hall) -> Result<(PairStateFile, Option<PairMemory>), StateFileError> {
        let state_file = PairStateFile::begin_anew(dir, hall);
        let path = || state_file.file.path().to_owned();
        let read = state_file.file.read(page::MOST).map_err(|error| StateFileError::Unreadable { path: path(), error })?;
        let Some(bytes) = read else { return Ok((state_file, None)) };
        let (whose, memory) = page::read(&bytes).map_err(|unread| match unread {
            Unread::Version(found) => StateFileError::OtherVersion { path: path(), found },
            Unread::Damaged(fault) => StateFileError::Damaged { path: path(), fault },
        })?;
        if !whose.is_same(&state_file.whose) {
            let (remembered, given) = (whose.hall, state_file.whose.hall.clone());
            return Err(StateFileError::OtherHall { path: path(), remembered, given });
        }
        if !memory.fits(hall) {
            let fault = "the pair cannot stand at the position in this file".to_owned();
            return Err(StateFileError::Damaged { path: path(), fault });
        }
        Ok((state_file, Some(memory)))
    }

    pub(super) fn begin_anew(dir: &Path, hall: &Hall) -> PairStateFile {
        PairStateFile { file: SmallFile::within(dir, names::PAIR), whose: Whose::of(hall), owed: None }
    }

    pub(super) fn move_to(&mut self, hall: &Hall) {
        (self.whose, self.owed) = (Whose::of(hall), None);
    }

    /// Writes a memory. After a failure the simulation continues, and the failure is logged once. Writing is retried
    /// until this memory or a later one is written.
    pub(super) fn keep(&mut self, memory: PairMemory) {
        let written = self.file.swap(&page::written(&self.whose, &memory));
        let failing = "cannot store the position of the simulated pair: free disk space, or make the folder writable; hallsweep \
                       tries again";
        self.file.say(&written, failing, "the position of the simulated pair is stored again");
        self.owed = written.is_err().then(|| Box::new(memory));
    }

    pub(super) fn owed(&self) -> Option<&PairMemory> {
        self.owed.as_deref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::storage::tests::scratch::Scratch;
    use hallsweep_core::place::{BasePose, Place};
    use hallsweep_core::units::{Heading, Piece};

    fn hall(rows: &[&str]) -> Hall {
        Hall::from_rows("first", rows).expect("a good hall")
    }

    fn outside() -> PairMemory {
        PairMemory::new([BasePose { place: Place::ENTRANCE, heading: Heading::South }; 2])
    }

    #[test]
    fn what_was_kept_is_there_at_the_next_start_and_a_kill_leaves_the_old_or_the_new() {
        let (folder, hall) = (Scratch::new(), hall(&["S.a"]));
        let (mut file, nothing) = PairStateFile::open(&folder.0, &hall).expect("there is no file yet");
        assert_eq!(nothing, None);
        let secured = PairMemory { taken_in: vec![Piece(1)], restarts: 3, ..outside() };
        for memory in [outside(), secured] {
            file.keep(memory.clone());
            assert_eq!(PairStateFile::open(&folder.0, &hall).expect("it is ours").1, Some(memory));
        }
    }

    #[test]
    fn a_memory_of_another_hall_or_of_what_cannot_be_is_refused_with_words() {
        let (folder, first) = (Scratch::new(), hall(&["S.a"]));
        PairStateFile::begin_anew(&folder.0, &first).keep(outside());
        let other = PairStateFile::open(&folder.0, &hall(&["S..a"])).expect_err("another hall");
        assert!(matches!(other, StateFileError::OtherHall { .. }), "{other}");
        let inside = BasePose { place: Place::Cell(hallsweep_core::units::Cell::new(2, 0)), heading: Heading::South };
        for wrong in [PairMemory::new([inside; 2]), PairMemory { taken_in: vec![Piece(9)], ..outside() }] {
            PairStateFile::begin_anew(&folder.0, &first).keep(wrong);
            let refused = PairStateFile::open(&folder.0, &first).expect_err("that cannot be");
            assert!(refused.to_string().contains("simulated-pair.txt"), "{refused}");
        }
    }
}
