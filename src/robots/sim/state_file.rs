//! Stores what the simulated robot must not forget, so that its hall is unchanged after a restart. Each robot has one
//! small file in the data folder. The contents are `SimMemory`, the format is in `hallsweep_sim::page`; `link`
//! decides when to write.
//!
//! A real hall does not change when the program ends; a simulated hall would be lost without this file. So writing is
//! as cheap as possible: 1 KiB in place for each order that begins or ends. The system has the bytes at once, so they
//! survive `kill -9`. Nothing is flushed to the disk, so a power cut may lose the last seconds. Everything that must
//! survive a power cut is in the journal.

use std::io;
use std::path::Path;

use crate::storage::files;
use crate::storage::names;
use crate::storage::small_file::SmallFile;
use hallsweep_core::robot::RobotId;
use hallsweep_sim::Hall;
use hallsweep_sim::SimMemory;

mod error;

pub(super) use error::StateFileError;
use hallsweep_sim::page::{self, MemoryPage, Unread, Whose};

#[derive(Debug)]
pub(super) struct SimStateFile {
    file: SmallFile,
    whose: Whose,
    turn: u64,
    anew: bool,
    /// A memory that still has to be written after a failure.
    owed: Option<SimMemory>,
}

impl SimStateFile {
    /// Opens this robot's state file in the folder `dir`, and reads the memory of this hall; `None` when there is no
    /// file yet. Writes nothing, and does not change a file that cannot be read or belongs to another hall. `floor`
    /// is the hall as other robots have left it.
    pub(super) fn open(
        dir: &Path,
        robot: &RobotId,
        hall: &Hall,
        floor: &Hall,
    ) -> Result<(SimStateFile, Option<SimMemory>), StateFileError> {
        let mut state_file = SimStateFile::begin_anew(dir, robot, hall);
        let path = || state_file.file.path().to_owned();
        let Some(bytes) = state_file.file.read(page::SIZE).map_err(|error| StateFileError::Unreadable { path: path(), error })?
        else {
            let unfinished = state_file.file.unfinished();
            return match files::check_no_folder(&unfinished) {
                Ok(()) => Ok((state_file, None)),
                Err(error) => Err(StateFileError::Unreadable { path: unfinished, error }),
            };
        };
        let MemoryPage { whose, turn, memory } = page::read(&bytes).map_err(|unread| match unread {
            Unread::Version(found) => StateFileError::OtherVersion { path: path(), found },
            Unread::Damaged(fault) => StateFileError::Damaged { path: path(), fault },
        })?;
        if !whose.is_same(&state_file.whose) {
            let (remembered, given) = (whose.hall, state_file.whose.hall.clone());
            return Err(StateFileError::OtherHall { path: path(), remembered, given });
        }
        if !memory.fits(floor) {
            let fault = "the robot cannot stand at the position in this file".to_owned();
            return Err(StateFileError::Damaged { path: path(), fault });
        }
        (state_file.turn, state_file.anew) = (turn, false);
        Ok((state_file, Some(memory)))
    }

    /// A state file for a robot that is newly put into this hall. The first write replaces an existing file. So call
    /// this only for a folder without such a file, or for a robot that leaves its previous hall.
    pub(super) fn begin_anew(dir: &Path, robot: &RobotId, hall: &Hall) -> SimStateFile {
        // The searching robot's file keeps the name that it had when there was only one robot.
        let name = if *robot == RobotId::discovery() { names::SIMULATED } else { names::SIMULATED_FURTHER };
        SimStateFile { file: SmallFile::of(dir, name, robot.name()), whose: Whose::of(hall), turn: 0, anew: true, owed: None }
    }

    /// The robot is newly put into this hall. The next write replaces the file.
    pub(super) fn move_to(&mut self, hall: &Hall) {
        (self.whose, self.turn, self.anew, self.owed) = (Whose::of(hall), 0, true, None);
    }

    /// Writes a memory. After a failure the simulation continues, and the failure is logged once. Writing is retried
    /// until this memory or a later one is written.
    pub(super) fn keep(&mut self, memory: SimMemory) {
        let written = self.write(&memory);
        let failing = "cannot store the position of the simulated robot: free disk space, or make the folder writable; hallsweep \
                       tries again";
        self.file.say(&written, failing, "the position of the simulated robot is stored again");
        self.owed = written.as_ref().is_err().then_some(memory);
        // If somebody removed the file, it is created again.
        self.anew |= written.is_err_and(|error| error.kind() == io::ErrorKind::NotFound);
    }

    pub(super) const fn owed(&self) -> Option<SimMemory> {
        self.owed
    }

    fn write(&mut self, memory: &SimMemory) -> io::Result<()> {
        if self.anew {
            self.file.make(&page::whole(&self.whose, self.turn, memory))?;
            self.anew = false;
            return Ok(());
        }
        let turn = self.turn.wrapping_add(1);
        self.file.write_at(page::place(turn), &page::slot(turn, memory))?;
        self.turn = turn;
        Ok(())
    }
}

#[cfg(test)]
mod tests;
