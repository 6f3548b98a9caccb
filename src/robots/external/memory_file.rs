//! Stores what the next program must know about a robot that does not know its own position. Each such robot has one
//! small file in the data folder. The file is replaced as a whole and not flushed, which is enough to survive
//! `kill -9`. The driver decides the contents of the file.
//!
//! After a failed write, the file has an old position of the robot. So the file is renamed, and the new name says
//! that the file is out of date.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use crate::storage::files;
use crate::storage::names;
use crate::storage::small_file::{SmallFile, checksum};
use hallsweep_core::robot::RobotId;

/// Maximum size in bytes. No driver writes more.
const MOST: usize = 4 << 20;

#[derive(Debug, thiserror::Error)]
pub(super) enum MemoryFileError {
    #[error(
        "cannot read the file {} ({error}): let the user who runs hallsweep read the file; or put the robot at its start, move \
         the file away, and start hallsweep again", .path.display()
    )]
    Unreadable { path: PathBuf, error: io::Error },
    #[error(
        "the file {} is damaged: {fault}; put the robot at its start, move the file away, and start hallsweep again: the journal \
         stays", .path.display()
    )]
    Damaged { path: PathBuf, fault: String },
    #[error(
        "the file {} is out of date, because the disk could not be written: put the robot at its start, remove the file, and \
         start hallsweep again: the journal stays",
        .path.display()
    )]
    OutOfDate { path: PathBuf },
}

#[derive(Debug)]
pub(super) struct MemoryFile {
    file: SmallFile,
    /// Whether the contents belong to this robot, and not to a robot that it replaces.
    is_own: bool,
    /// Name that the file gets after a failed write, since its contents are out of date then.
    out_of_date: PathBuf,
    mark: Mark,
    /// The memory that could not be written. Writing it is retried.
    owed: Option<String>,
    /// Kind and address of the robot.
    whose: String,
}

/// Whether a file marks the position of the robot as unknown, and to which robot the mark belongs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mark {
    No,
    /// The mark belongs to a robot that this one replaces.
    OfAnother,
    Own,
}

impl MemoryFile {
    /// Opens the file of this robot in the folder `dir` and reads it. Returns `None` when there is no file, or when
    /// the file belongs to another robot than `whose`. Writes nothing, and does not change a file that cannot be
    /// read.
    pub(super) fn open(dir: &Path, robot: &RobotId, whose: &str) -> Result<(MemoryFile, Option<String>), MemoryFileError> {
        let file = SmallFile::of(dir, names::ROBOT, robot.name());
        let out_of_date = names::ROBOT_OUT_OF_DATE.of(dir, robot.name());
        let mark = mark(&out_of_date, whose);
        if mark == Mark::Own {
            return Err(MemoryFileError::OutOfDate { path: out_of_date });
        }
        let path = || file.path().to_owned();
        let read = file.read(MOST).map_err(|error| MemoryFileError::Unreadable { path: path(), error })?;
        let memory = match read {
            None => None,
            Some(bytes) => {
                let damaged = |fault: &str| MemoryFileError::Damaged { path: path(), fault: fault.to_owned() };
                let (of, memory) = understood(&bytes).map_err(damaged)?;
                if of != whose {
                    tracing::warn!(file = %file.path().display(), of, robot = whose, "the file belongs to another robot: \
                                                                                      hallsweep assumes that this robot stands \
                                                                                      at its start");
                }
                (of == whose).then_some(memory)
            }
        };
        Ok((MemoryFile { whose: whose.to_owned(), file, is_own: memory.is_some(), out_of_date, mark, owed: None }, memory))
    }

    pub(super) fn damaged(&self, fault: String) -> MemoryFileError {
        MemoryFileError::Damaged { path: self.file.path().to_owned(), fault }
    }

    /// Writes the memory, which is one line. After a failure the robot continues, and the failure is logged once.
    pub(super) fn keep(&mut self, memory: String) {
        let written = self.write(&memory);
        let failing = "cannot store the position of the robot: free disk space, or make the folder writable";
        self.file.say(&written, failing, "the position of the robot is stored again");
        match (&written, self.mark) {
            (Err(_), Mark::No | Mark::OfAnother) => match self.mark_out_of_date() {
                Ok(()) => self.mark = Mark::Own,
                Err(error) => {
                    tracing::error!(file = %self.out_of_date.display(), %error, "the next start may use an old position of the \
                                                                                 robot")
                }
            },
            (Ok(()), Mark::Own | Mark::OfAnother) if fs::remove_file(&self.out_of_date).is_ok() => self.mark = Mark::No,
            (Err(_), Mark::Own) | (Ok(()), _) => {}
        }
        self.is_own |= written.is_ok();
        self.owed = written.is_err().then_some(memory);
    }

    fn write(&mut self, memory: &str) -> io::Result<()> {
        let said = format!("{}\n{memory}", self.whose);
        self.file.swap(format!("{said}\n{}\n", checksum(&said)).as_bytes())
    }

    pub(super) fn owed(&self) -> Option<String> {
        self.owed.clone()
    }

    /// Marks the file as out of date, which needs no free space. If the folder is read-only, the file itself may
    /// still be writable. Then the file is emptied, and an empty file is not used.
    fn mark_out_of_date(&self) -> io::Result<()> {
        let anybodys = || files::create(&self.out_of_date).map(drop);
        let marked = if self.is_own { fs::rename(self.file.path(), &self.out_of_date) } else { anybodys() };
        marked
            .or_else(|_| anybodys())
            .or_else(|_| files::open(self.file.path(), fs::File::options().write(true).truncate(true)).map(drop))
    }
}

/// Reads the mark. An empty or unreadable mark counts as the mark of this robot.
fn mark(out_of_date: &Path, whose: &str) -> Mark {
    match files::read_if_there(out_of_date, MOST) {
        Ok(None) => Mark::No,
        Ok(Some(bytes)) if understood(&bytes).is_ok_and(|(of, _)| of != whose) => Mark::OfAnother,
        Ok(Some(_)) | Err(_) => Mark::Own,
    }
}

fn understood(bytes: &[u8]) -> Result<(String, String), &'static str> {
    let text = std::str::from_utf8(bytes).map_err(|_| "it is not text")?;
    let (whose, memory) = match text.split('\n').collect::<Vec<_>>()[..] {
        [whose, memory, sum, ""] if sum == checksum(&format!("{whose}\n{memory}")) => (whose, memory),
        // Earlier versions wrote no checksum.
        [whose, memory] if memory.starts_with('{') && memory.ends_with('}') => (whose, memory),
        _ => return Err("its content is not as hallsweep wrote it"),
    };
    Ok((whose.to_owned(), memory.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::storage::tests::scratch::Scratch;

    fn open(folder: &Scratch, whose: &str) -> Result<(MemoryFile, Option<String>), MemoryFileError> {
        MemoryFile::open(&folder.0, &RobotId::discovery(), whose)
    }

    #[test]
    fn what_is_kept_is_read_by_the_next_program_and_by_no_other_robot() {
        let folder = Scratch::new();
        let (mut file, nothing) = open(&folder, "one").expect("there is none yet");
        assert_eq!(nothing, None);
        file.keep("here".to_owned());
        assert_eq!(open(&folder, "one").expect("it is there").1.as_deref(), Some("here"));
        assert_eq!(open(&folder, "another").expect("it is there").1, None);
    }

    #[test]
    fn a_file_that_could_not_be_replaced_is_not_believed() {
        let folder = Scratch::new();
        let (mut file, _) = open(&folder, "one").expect("there is none yet");
        file.keep("here".to_owned());
        let in_the_way = folder.0.join("robot-discovery.new");
        fs::create_dir(&in_the_way).expect("the folder can be written");
        file.keep("there".to_owned());
        assert!(matches!(open(&folder, "one"), Err(MemoryFileError::OutOfDate { .. })));
        assert_eq!(file.owed().as_deref(), Some("there"));
        fs::remove_dir(&in_the_way).expect("it is empty");
        file.keep("elsewhere".to_owned());
        assert_eq!(file.owed(), None);
        assert_eq!(open(&folder, "one").expect("it is well again").1.as_deref(), Some("elsewhere"));
    }

    #[test]
    fn what_is_out_of_date_of_one_robot_is_not_of_another_in_its_place() {
        let folder = Scratch::new();
        let mark = folder.0.join("robot-discovery.out-of-date");
        for (left, of_one, of_another) in [("one\n{}", false, true), ("", false, false)] {
            fs::write(&mark, left).expect("the folder can be written");
            assert_eq!((open(&folder, "one").is_ok(), open(&folder, "another").is_ok()), (of_one, of_another), "{left:?}");
        }
        fs::write(&mark, "one\n{}").expect("the folder can be written");
        open(&folder, "another").expect("it is not of this robot").0.keep("there".to_owned());
        assert!(!mark.exists(), "what is kept since is in date");
    }

    /// The robot replaces another robot, of which a file or a mark is still in the folder.
    #[test]
    fn one_whose_first_writing_fails_is_out_of_date_itself() {
        for other in ["robot-discovery.txt", "robot-discovery.out-of-date"] {
            let folder = Scratch::new();
            fs::write(folder.0.join(other), "one\n{}").expect("the folder can be written");
            fs::create_dir(folder.0.join("robot-discovery.new")).expect("the folder can be written");
            open(&folder, "another").expect("it is not of this robot").0.keep("there".to_owned());
            assert!(open(&folder, "another").is_err(), "{other}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn in_a_folder_that_cannot_be_written_what_stood_in_the_file_is_not_believed_either() {
        use std::os::unix::fs::PermissionsExt;
        let folder = Scratch::new();
        let (mut file, _) = open(&folder, "one").expect("there is none yet");
        file.keep("here".to_owned());
        let set = |mode| fs::set_permissions(&folder.0, fs::Permissions::from_mode(mode)).expect("the folder is ours");
        set(0o555);
        let is_root = fs::write(folder.0.join("probe"), "").is_ok();
        file.keep("there".to_owned());
        set(0o755);
        assert!(is_root || open(&folder, "one").is_err(), "it is out of date");
    }

    #[test]
    fn a_damaged_file_is_said_to_be_one_and_stays() {
        let folder = Scratch::new();
        let (mut file, _) = open(&folder, "one").expect("there is none yet");
        file.keep("here".to_owned());
        let kept = fs::read(folder.0.join("robot-discovery.txt")).expect("it is there");
        let wrong = (0..kept.len()).map(|at| kept.iter().enumerate().map(|(n, byte)| byte ^ u8::from(n == at)).collect());
        let short = (0..kept.len()).map(|length| kept[..length].to_vec());
        for bytes in wrong.chain(short).chain([vec![0xff, b'\n']]) {
            fs::write(folder.0.join("robot-discovery.txt"), &bytes).expect("the folder can be written");
            let said = open(&folder, "one").expect_err("it is damaged").to_string();
            assert!(said.contains("robot-discovery.txt") && said.contains("put the robot at its start"), "{said}");
            assert_eq!(fs::read(folder.0.join("robot-discovery.txt")).expect("it stays"), bytes);
        }
    }
}
