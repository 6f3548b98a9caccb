//! What can go wrong between the journal and the disk, and what an operator is told to do about it.

use std::io;
use std::path::Path;

use rusqlite::ErrorCode;

use crate::core::units::Seq;
use crate::wire::journal::Unparsed;

/// Something went wrong. The words for it need the folder: see `words`.
#[derive(Debug)]
pub(super) enum Fault {
    /// SQLite says so.
    Sql(rusqlite::Error),
    /// The system says so, of a file beside the journal.
    File(io::Error),
    /// The journal's own structure is broken; what SQLite found.
    Damaged(String),
    /// It was written by a version that knows more; its format.
    Newer(i64),
    /// It was written by an older version, and nothing can be written to bring it up to date.
    Older(i64),
    /// The file is some other program's.
    Foreign,
    /// An entry of the journal says nothing that this version understands.
    Unparsed(Seq, Unparsed),
    /// Its last entry is not the one that was read at the start.
    Changed,
    /// Another hallsweep writes into the folder.
    InUse,
    /// Nothing can be created there.
    Unwritable,
    /// A photo's file is not there, or is not what it was.
    Photo(&'static str),
    /// A number that SQLite cannot hold.
    Number(u64),
    /// It took so long that what was handed over has been given up for lost.
    GivenUp,
    /// The disk does not answer.
    Hung,
    /// More was handed over than the disk takes.
    Behind,
    /// The thread that writes is gone.
    Gone,
}

/// What follows once the cause of a fault is gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Then {
    /// Writing goes on by itself.
    GoesOn,
    /// What was kept is not known: the program must be started again.
    StartAgain,
}

impl Fault {
    /// Whether waiting helps nobody: the file itself must be seen to.
    pub(super) fn is_final(&self) -> bool {
        match self {
            Fault::Sql(error) => is_damage(error),
            Fault::Damaged(_) | Fault::Newer(_) | Fault::Foreign | Fault::Unparsed(..) | Fault::Changed | Fault::Gone => true,
            Fault::File(_)
            | Fault::Older(_)
            | Fault::InUse
            | Fault::Unwritable
            | Fault::Photo(_)
            | Fault::Number(_)
            | Fault::GivenUp
            | Fault::Hung
            | Fault::Behind => false,
        }
    }

    /// What an operator reads: what is wrong, and what to do.
    pub(super) fn words(&self, folder: &Path, then: Then) -> String {
        let file = folder.join("journal.db");
        let (file, folder) = (file.display(), folder.display());
        let then = match then {
            Then::GoesOn => "hallsweep goes on by itself",
            Then::StartAgain => "then start hallsweep again",
        };
        let damaged = |detail: &str| {
            format!(
                "the journal {file} is damaged ({detail}); it is left as it is: move it away, or put a backup in its place, \
                 then start hallsweep again"
            )
        };
        let full = || format!("the disk is full: free some space for {folder}; {then}");
        let locked = || format!("{folder} cannot be written to: make it writable; {then}");
        let broken = |error: &dyn std::fmt::Display| format!("the disk reports an error ({error}): look after {folder}; {then}");
        match self {
            Fault::Sql(error) if is_damage(error) => damaged(&error.to_string()),
            Fault::Sql(error) => match error.sqlite_error_code() {
                Some(ErrorCode::DiskFull) => full(),
                Some(ErrorCode::ReadOnly | ErrorCode::CannotOpen | ErrorCode::PermissionDenied) => locked(),
                Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked) => {
                    format!("another program keeps the journal {file} locked: end it; {then}")
                }
                _ => broken(error),
            },
            Fault::File(error) => match error.kind() {
                io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => full(),
                io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => locked(),
                _ => broken(error),
            },
            Fault::Damaged(detail) => damaged(detail),
            Fault::Newer(format) => format!(
                "the journal {file} was written by a newer hallsweep (format {format}); it is left as it is: start the newer \
                 one, or choose another folder with --data"
            ),
            Fault::Older(format) => {
                format!("the journal {file} is of an older hallsweep (format {format}) and must be written to once: {}", locked())
            }
            Fault::Foreign => {
                format!("{file} is no journal of hallsweep; it is left as it is: choose another folder with --data")
            }
            Fault::Unparsed(seq, why) => format!(
                "entry {seq} of the journal {file} cannot be understood ({why}); nothing is written after it: put a backup in \
                 its place, or move it away, then start hallsweep again"
            ),
            Fault::Changed => format!("the journal {file} is not the one that was read at the start: start hallsweep again"),
            Fault::InUse => format!("another hallsweep uses the folder {folder}: end it, or choose another folder with --data"),
            Fault::Unwritable => locked(),
            Fault::Photo(what) => format!("the file of the photo {what}: put the folder photos of a backup back into {folder}"),
            Fault::Number(number) => format!("the journal has no room for the number {number}"),
            Fault::GivenUp | Fault::Hung => format!("the disk does not answer: look after {folder}; {then}"),
            Fault::Behind => format!("the disk does not keep up: look after {folder}; {then}"),
            Fault::Gone => "the writer of the journal has ended by a mistake of its own: start hallsweep again".to_owned(),
        }
    }
}

fn is_damage(error: &rusqlite::Error) -> bool {
    matches!(error.sqlite_error_code(), Some(ErrorCode::DatabaseCorrupt | ErrorCode::NotADatabase))
}

impl From<rusqlite::Error> for Fault {
    fn from(error: rusqlite::Error) -> Fault {
        Fault::Sql(error)
    }
}

impl From<io::Error> for Fault {
    fn from(error: io::Error) -> Fault {
        Fault::File(error)
    }
}

/// A number as SQLite holds it.
pub(super) fn whole(number: u64) -> Result<i64, Fault> {
    i64::try_from(number).map_err(|_| Fault::Number(number))
}

/// A number that `whole` made; a negative one, which nobody wrote, becomes 0.
pub(super) fn count(number: i64) -> u64 {
    u64::try_from(number).unwrap_or(0)
}
