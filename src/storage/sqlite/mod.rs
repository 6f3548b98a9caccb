//! The store: an SQLite journal of entries, tables that are computed from the entries, and photos as files. If
//! nothing is to be stored, all of them are in memory (`memory`). START HERE.
//!
//! ```text
//!   Task ─ record ─► SqliteStore ─ queue ─► Writer ─► Pages ─► journal.db, photos/      (one thread, one connection)
//!     ▲              WriterStatus ◄── kept, failed ──┘
//!     └── StoreStatus ◄────┘ ◄────── hangs ──── watchman
//!   doors ─ Archive ─► Reading ─► journal.db, photos/                                   (their own connections)
//! ```
//! The core decides what is recorded and when. This module writes it (safety D1, D2, D3, R3). A file that cannot be
//! opened is never overwritten, renamed or deleted.

mod archive;
mod archive_check;
mod archive_file;
mod chain;
mod check;
mod connect;
mod cut;
mod fault;
mod folder;
mod head;
mod kept_back;
mod marker;
mod memory;
mod moments;
mod of_archives;
mod pages;
mod photos;
mod project;
mod reading;
mod recall;
mod rows;
mod schema;
mod unpack;
mod writer;
mod writer_status;

#[cfg(test)]
mod tests;

use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender, SyncSender, TrySendError};

use tokio::sync::watch;

use self::archive::SqliteArchive;
pub use self::archive_check::ArchiveCheck;
pub use self::archive_file::{Archived, is_within, write_out, write_out_at_start};
pub use self::check::Findings;
use self::fault::{Fault, Then};
use self::folder::Folder;
use self::head::HeadFile;
use self::marker::Marker;
pub use self::memory::MemoryStore;
use self::pages::Pages;
pub use self::reading::{ReadOnlyJournal, rebuild};
pub use self::unpack::unpack;
use self::writer::{Hand, Handed, Patience, Writer};
use self::writer_status::WriterStatus;
use crate::runtime::archive::Archive;
use crate::runtime::store::{Store, StoreStatus};
use hallsweep_core::effect::Page;
use hallsweep_core::engine::Recalled;
use hallsweep_core::units::Seq;

/// Maximum number of pages waiting for the disk. The robot waits for the record before each move, so further pages
/// come only from commands and sensors. The queue has room for minutes of such pages.
const QUEUE: usize = 1024;

/// Why a folder cannot be used at all; the program should not start.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    #[error("{0}")]
    InUse(String),
    #[error("the store cannot start: {0}")]
    System(std::io::Error),
}

pub struct Opened {
    pub store: Box<dyn Store>,
    /// Reads what was stored, even while nothing can be written.
    pub archive: Arc<dyn Archive>,
    /// The stored state; `None` when no state is stored, or when it cannot be read.
    pub recalled: Option<Recalled>,
    /// Why nothing can be written, in words for an operator; the store's status says the same.
    pub failure: Option<String>,
}

/// Hands pages to the writer; never waits.
#[derive(Debug)]
pub struct SqliteStore {
    folder: Folder,
    status: Arc<WriterStatus>,
    /// When `pages` and the two senders in `ends` are dropped, the writer and the watchman end.
    pages: Option<SyncSender<Handed>>,
    ends: Vec<Sender<()>>,
    done: Receiver<()>,
    patience: Patience,
}

/// Opens the folder `path`, and creates it if it does not exist. A fault of the files is not an error, but is
/// reported in `failure`. `beside` is a fault of other files in the folder, with the advice what to do. With such a
/// fault nothing is written until the program is restarted, and so nothing moves (safety R5).
pub fn open(path: &Path, beside: Option<String>) -> Result<Opened, OpenError> {
    open_with(path, beside, Patience::USUAL)
}

fn open_with(path: &Path, beside: Option<String>, patience: Patience) -> Result<Opened, OpenError> {
    let folder = Folder::new(path);
    let found = look(&folder).map_err(|fault| OpenError::InUse(fault.words(path, Then::GoesOn)))?;
    let (hand, recalled, failure) = match (found, beside) {
        (found, None) => found,
        ((_, recalled, failure), Some(beside)) => {
            let all: Vec<String> = [Some(beside), failure].into_iter().flatten().collect();
            (Hand::Closed, recalled, Some(all.join("; and ")))
        }
    };
    let kept = recalled.as_ref().map_or(Seq(0), |recalled| recalled.written);
    let status = Arc::new(WriterStatus::new(Marker::new(&folder), kept, failure.as_deref()));
    let store = SqliteStore::start(&folder, status, hand, kept, patience).map_err(OpenError::System)?;
    let archive = Arc::new(SqliteArchive::new(folder));
    Ok(Opened { store: Box::new(store), archive, recalled, failure })
}

/// Reads the stored state, and opens the journal for writing if this state is known. The only error is a folder in
/// use.
fn look(folder: &Folder) -> Result<(Hand, Option<Recalled>, Option<String>), Fault> {
    let words = |fault: &Fault, then| Some(fault.words(folder.path(), then));
    // Without the folder there is no lock either; the writer retries both.
    let _ = folder.create_path();
    let lock = match folder.lock() {
        Err(Fault::InUse) => return Err(Fault::InUse),
        other => other.ok(),
    };
    if let Err(fault) = folder.check_journal() {
        return Ok((Hand::Closed, None, words(&fault, Then::StartAgain)));
    }
    let lost_after = match folder.check_beside().and_then(|()| head::check(folder)).and_then(|()| marker::read(folder)) {
        Ok(lost_after) => lost_after,
        // The state is shown as far as the journal can be read. Nothing is written until a restart.
        Err(fault) => return Ok((Hand::Closed, recall::recall(folder, None).unwrap_or(None), words(&fault, Then::StartAgain))),
    };
    let recalled = match recall_up_to_date(folder, lost_after) {
        // The journal was removed, by a user or by SQLite. A new journal beside the old photos would hide this.
        Ok(None) if folder.has_photos() => return Ok((Hand::Closed, None, words(&Fault::OnlyPhotos, Then::StartAgain))),
        Ok(recalled) => recalled,
        Err(fault) => return Ok((Hand::Closed, None, words(&fault, Then::StartAgain))),
    };
    let kept = recalled.as_ref().map_or(Seq(0), |recalled| recalled.written);
    let state = recalled.as_ref().map(|recalled| &recalled.state);
    let under_way = state.filter(|state| state.under_way).map(|state| state.mission);
    match Pages::open(folder, lock, kept, under_way) {
        Ok(pages) => Ok((Hand::Writing(pages), recalled, None)),
        Err(Fault::InUse) => Err(Fault::InUse),
        Err(fault) if fault.is_final() => Ok((Hand::Closed, recalled, words(&fault, Then::StartAgain))),
        Err(fault) => Ok((Hand::Waiting(under_way), recalled, words(&fault, Then::GoesOn))),
    }
}

/// Reads the stored state. A file is changed only if an older version wrote it: then it is migrated first.
fn recall_up_to_date(folder: &Folder, lost_after: Option<Seq>) -> Result<Option<Recalled>, Fault> {
    match recall::recall(folder, lost_after) {
        Err(Fault::Older(_)) => {
            schema::bring_up_to_date(&mut connect::writer(folder)?)?;
            recall::recall(folder, lost_after)
        }
        recalled => recalled,
    }
}

impl SqliteStore {
    fn start(
        folder: &Folder,
        status: Arc<WriterStatus>,
        hand: Hand,
        kept: Seq,
        patience: Patience,
    ) -> std::io::Result<SqliteStore> {
        let (pages, handed) = mpsc::sync_channel(QUEUE);
        let ((end_writer, ended), (end_watchman, watched)) = (mpsc::channel(), mpsc::channel());
        let (say_done, done) = mpsc::channel();
        let head = HeadFile::start(folder)?;
        let (to_write, to_watch) = (Arc::clone(&status), (Arc::clone(&status), folder.clone()));
        let writer =
            Writer { folder: folder.clone(), status: to_write, pages: handed, ended, hand, head, kept, bulk: 0, patience };
        thread("journal", move || {
            writer.run();
            drop(say_done);
        })?;
        thread("journal-watchman", move || writer::watch(&to_watch.0, &to_watch.1, &watched, patience))?;
        let store = SqliteStore {
            folder: folder.clone(),
            status,
            pages: Some(pages),
            ends: vec![end_writer, end_watchman],
            done,
            patience,
        };
        Ok(store)
    }
}

impl Store for SqliteStore {
    fn record(&mut self, page: Page, losses: u64) {
        let Some(pages) = &self.pages else { return };
        let fault = match pages.try_send(Handed { page, losses }) {
            Ok(()) => return,
            Err(TrySendError::Full(_)) => Fault::Behind,
            Err(TrySendError::Disconnected(_)) => Fault::Gone,
        };
        self.status.overflow(fault.words(self.folder.path(), Then::GoesOn));
    }

    fn word(&self) -> watch::Receiver<StoreStatus> {
        self.status.word()
    }
}

/// The last pages are still written, if the disk is fast enough.
impl Drop for SqliteStore {
    fn drop(&mut self) {
        self.pages = None;
        self.ends.clear();
        // Nothing is ever sent on this channel. The writer ends in time, or this thread stops waiting for it.
        let _ = self.done.recv_timeout(self.patience.end);
    }
}

fn thread(name: &str, run: impl FnOnce() + Send + 'static) -> std::io::Result<()> {
    std::thread::Builder::new().name(name.to_owned()).spawn(run).map(drop)
}
