//! Keeps what the next program must know of a robot that does not know itself where it stands, in one small file of the data folder. It is
//! replaced as a whole and nothing is flushed: that outlives `kill -9`. What stands in it is the driver's business.

use std::path::Path;

use crate::robots::sim::StateFileError;
use crate::storage::small_file::SmallFile;
use hallsweep_core::event::RobotId;

/// More than a driver ever writes.
const MOST: usize = 1 << 20;

#[derive(Debug)]
pub(super) struct MemoryFile {
    file: SmallFile,
    /// Which robot it is of: its kind and where it is.
    whose: String,
}

impl MemoryFile {
    /// The file of this robot in the folder `dir`, and what stands in it; nothing when there is none yet, or when it is of another robot
    /// than `whose`. Nothing is written, and a file that cannot be read stays as it is.
    pub(super) fn open(dir: &Path, robot: &RobotId, whose: &str) -> Result<(MemoryFile, Option<String>), StateFileError> {
        let file = SmallFile::within(dir, &format!("robot-{robot}.txt"));
        let path = || file.path().to_owned();
        let read = file.read(MOST).map_err(|error| StateFileError::Unreadable { path: path(), error })?;
        let memory = match read {
            None => None,
            Some(bytes) => {
                let damaged = |fault: &str| StateFileError::Damaged { path: path(), fault: fault.to_owned() };
                let text = String::from_utf8(bytes).map_err(|_| damaged("it is no text"))?;
                let (of, memory) = text.split_once('\n').ok_or_else(|| damaged("it ends too early"))?;
                (of == whose).then(|| memory.to_owned())
            }
        };
        Ok((MemoryFile { whose: whose.to_owned(), file }, memory))
    }

    /// What stands in it is no memory of a robot, for this reason.
    pub(super) fn damaged(&self, fault: String) -> StateFileError {
        StateFileError::Damaged { path: self.file.path().to_owned(), fault }
    }

    /// Writes this down. When that fails, the robot goes on all the same, and the log says so once.
    pub(super) fn keep(&mut self, memory: &str) {
        let written = self.file.swap(format!("{}\n{memory}", self.whose).as_bytes());
        let failing = "cannot keep where the robot stands: make room, or the folder writable";
        self.file.say(&written, failing, "where the robot stands is kept again");
    }
}
