//! Faults between the journal and the disk, and the advice to an operator about each fault.

use std::fmt::Display;
use std::io;
use std::path::{Path, PathBuf};

use rusqlite::ErrorCode;

use super::folder::Folder;
use crate::api::journal::Unparsed;
use crate::storage::names::{self, Name};
use hallsweep_core::units::Seq;

/// Files that must be moved together: each is incomplete without the other files.
pub(super) const ALL: &str = "journal.db, journal.db-wal, journal.db-shm, journal.head and the folder photos";

/// Advice when `journal.head` does not belong to the journal.
const WRONG_ONE: &str = "the journal was not changed: put back the journal that belongs to journal.head, or, to use a backup, \
                         move journal.head away; then start hallsweep again";

/// Maximum number of characters shown of SQLite's findings, since SQLite may list hundreds of pages.
const SHOWN: usize = 200;

#[derive(Debug)]
pub(super) enum Fault {
    Sql(rusqlite::Error),
    File(io::Error),
    /// SQLite found the structure of the journal broken; the text has SQLite's findings.
    Damaged(String),
    /// The journal is missing or empty, but there is a write-ahead log with contents.
    OnlyLog,
    OnlyPhotos,
    /// The file with this name cannot be used; the text is the reason.
    Unusable(Name, String),
    /// The user who runs the program may not read this file or folder.
    Closed(PathBuf),
    /// The file was deleted or replaced while it was open.
    TakenAway(&'static str),
    /// A newer version wrote the file; the number is the file's format.
    Newer(i64),
    /// An older version wrote the file, and it cannot be migrated because nothing can be written; the number is the file's
    /// format.
    Older(i64),
    Foreign,
    /// This version does not understand an entry.
    Unparsed(Seq, Unparsed),
    /// The last entry differs from the last entry that was read at the start.
    Changed,
    /// The journal was once written up to this entry, but now ends before it.
    CutOff(Seq),
    /// The journal was written up to this entry, but now holds a different entry in its place.
    Another(Seq),
    /// The chain ends with this entry, but the journal ends with another entry.
    Unchained(Seq),
    InUse,
    Unwritable,
    /// A photo is missing or changed, or has no digest on record; the text says what is wrong.
    Photo(String),
    Number(u64),
    /// The pages were declared lost because writing them took too long.
    GivenUp,
    Hung,
    /// The disk is too slow for the number of pages.
    Behind,
    Gone,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Then {
    GoesOn,
    /// The program must be restarted, because it does not know the stored state.
    StartAgain,
}

impl Fault {
    pub(super) fn of_file(error: io::Error, name: Name, path: PathBuf) -> Fault {
        if error.kind() == io::ErrorKind::PermissionDenied {
            Fault::Closed(path)
        } else {
            Fault::Unusable(name, error.to_string())
        }
    }

    /// Whether the file itself needs repair, so that waiting cannot help.
    pub(super) fn is_final(&self) -> bool {
        match self {
            Fault::Sql(error) => is_damage(error),
            Fault::Damaged(_)
            | Fault::OnlyLog
            | Fault::OnlyPhotos
            | Fault::Unusable(..)
            | Fault::Closed(_)
            | Fault::TakenAway(_)
            | Fault::Newer(_)
            | Fault::Foreign
            | Fault::Unparsed(..)
            | Fault::Changed
            | Fault::CutOff(_)
            | Fault::Another(_)
            | Fault::Unchained(_)
            | Fault::Gone => true,
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

    pub(super) fn words_of_an_entry(&self, folder: &Path) -> String {
        if let Fault::Unparsed(seq, why) = self {
            return format!("entry {seq} of the journal cannot be understood ({})", one_line(why));
        }
        if let Fault::Damaged(detail) = self { one_line(detail) } else { self.words(folder, Then::StartAgain) }
    }

    pub(super) fn words(&self, folder: &Path, then: Then) -> String {
        let file = Folder::new(folder).journal();
        let (file, shown) = (file.display(), folder.display());
        let damaged = |detail: &dyn Display| {
            format!(
                "the journal {file} is damaged; it was not changed: move {ALL} away together, or replace these files by a \
                 backup, then start hallsweep again ({})",
                one_line(detail)
            )
        };
        match self {
            Fault::Damaged(detail) => damaged(detail),
            Fault::Sql(error) if is_damage(error) => damaged(error),
            Fault::Sql(error) => Trouble::of_sql(error).words(folder, then),
            Fault::File(error) => Trouble::of_file(error).words(folder, then),
            Fault::Unwritable => Trouble::Locked.words(folder, then),
            Fault::GivenUp | Fault::Hung => Trouble::Silent.words(folder, then),
            Fault::Behind => Trouble::Slow.words(folder, then),
            Fault::OnlyLog => format!(
                "the journal {file} is missing or empty, but journal.db-wal beside it has entries; nothing was changed: put back \
                 the journal.db that belongs to journal.db-wal, or move {ALL} away together, then start hallsweep again"
            ),
            Fault::OnlyPhotos => format!(
                "the journal {file} has no entry, but {shown} has photos; nothing was changed: put back the journal that belongs \
                 to the photos, or move {ALL} away together to begin with an empty journal, then start hallsweep again"
            ),
            Fault::Unusable(name, why) => unusable(*name, why, folder),
            Fault::Closed(path) => {
                let then = Trouble::then(then);
                format!("the user who runs hallsweep cannot open {}: give that user access; {then}", path.display())
            }
            Fault::TakenAway(name) => format!(
                "{name} in {shown} was deleted or replaced while hallsweep was using it; nothing is recorded any more: end \
                 hallsweep, put the journal back, then start hallsweep again"
            ),
            Fault::Newer(format) => format!(
                "the journal {file} was written by a newer hallsweep (format {format}); it was not changed: start the newer \
                 hallsweep, or choose another folder with --data"
            ),
            Fault::Older(format) => {
                let locked = Trouble::Locked.words(folder, then);
                format!(
                    "the journal {file} was written by an older hallsweep (format {format}): start this hallsweep with the \
                     journal to convert it; if the start fails: {locked}"
                )
            }
            Fault::Foreign => {
                format!("{file} is not a journal of hallsweep; it was not changed: choose another folder with --data")
            }
            Fault::Unparsed(seq, why) => format!(
                "entry {seq} of the journal {file} cannot be understood ({why}); nothing is written after this entry: save the \
                 sound entries with `hallsweep journal export` if you need them, replace the journal by a backup, or move {ALL} \
                 away together, then start hallsweep again"
            ),
            Fault::Changed => format!("the journal {file} is not the one that was read at the start: start hallsweep again"),
            Fault::CutOff(seq) => format!("the journal {file} ends before entry {seq}, which was stored; {WRONG_ONE}"),
            Fault::Another(seq) => format!("entry {seq} of the journal {file} is not the entry that was stored; {WRONG_ONE}"),
            Fault::Unchained(seq) => format!(
                "another program has written to the journal {file}: its chain of digests ends with entry {seq}, but its entries \
                 do not; the journal was not changed: `hallsweep journal check` says more; replace the journal by a backup, or \
                 move {ALL} away together, then start hallsweep again"
            ),
            Fault::InUse => format!("another hallsweep uses the folder {shown}: end it, or choose another folder with --data"),
            Fault::Photo(what) => format!("{what}: put the folder photos of a backup back into {shown}"),
            Fault::Number(number) => format!("the journal has no room for the number {number}"),
            Fault::Gone => "the writer of the journal stopped after an internal error: start hallsweep again".to_owned(),
        }
    }
}

enum Trouble {
    Full,
    Locked,
    Busy,
    Broken(String),
    Silent,
    Slow,
}

impl Trouble {
    fn then(then: Then) -> &'static str {
        match then {
            Then::GoesOn => "recording goes on by itself",
            Then::StartAgain => "then start hallsweep again",
        }
    }

    fn of_sql(error: &rusqlite::Error) -> Trouble {
        let code = error.sqlite_error_code();
        if code == Some(ErrorCode::DiskFull) {
            Trouble::Full
        } else if matches!(code, Some(ErrorCode::ReadOnly | ErrorCode::CannotOpen | ErrorCode::PermissionDenied)) {
            Trouble::Locked
        } else if matches!(code, Some(ErrorCode::DatabaseBusy | ErrorCode::DatabaseLocked)) {
            Trouble::Busy
        } else {
            Trouble::Broken(error.to_string())
        }
    }

    fn of_file(error: &io::Error) -> Trouble {
        if matches!(error.kind(), io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded) {
            Trouble::Full
        } else if matches!(error.kind(), io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem) {
            Trouble::Locked
        } else {
            Trouble::Broken(error.to_string())
        }
    }

    fn words(&self, folder: &Path, then: Then) -> String {
        let (folder, then) = (folder.display(), Trouble::then(then));
        match self {
            Trouble::Full => format!("the disk is full: free some space for {folder}; {then}"),
            Trouble::Locked => format!("{folder}, or a file in it, cannot be written to: make it writable; {then}"),
            Trouble::Busy => format!("another program keeps the journal in {folder} locked: end it; {then}"),
            Trouble::Broken(error) => format!("the disk reports an error ({error}): check the disk of {folder}; {then}"),
            Trouble::Silent => format!("the disk does not answer: check the disk of {folder}; {then}"),
            Trouble::Slow => format!("the disk is too slow: check the disk of {folder}; {then}"),
        }
    }
}

fn unusable(name: Name, why: &str, folder: &Path) -> String {
    let what = if [names::JOURNAL, names::LOG, names::LOG_INDEX, names::PHOTOS].contains(&name) {
        format!("it was not changed: put back the right one, or move {ALL} away together to begin with an empty journal")
    } else if name == names::LOST {
        "move it away; all entries in the journal then count, even entries that were reported as not recorded".to_owned()
    } else {
        "move it away".to_owned()
    };
    format!("{} cannot be used ({why}): {what}, then start hallsweep again", name.within(folder).display())
}

pub(super) fn one_line(detail: &dyn Display) -> String {
    let text = detail.to_string().replace("*** in database main ***", " ");
    text.split_whitespace().collect::<Vec<_>>().join(" ").chars().take(SHOWN).collect()
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

pub(super) fn whole(number: u64) -> Result<i64, Fault> {
    i64::try_from(number).map_err(|_| Fault::Number(number))
}

/// Reverses `whole`. A negative number, which the program never writes, becomes 0.
pub(super) fn count(number: i64) -> u64 {
    u64::try_from(number).unwrap_or(0)
}
