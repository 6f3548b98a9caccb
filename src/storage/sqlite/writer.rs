//! The thread that writes: it takes pages, stores them in one transaction, and reports that they are stored. After a
//! failure it retries until something can be written (safety R3). A second thread, the watchman, declares pages lost
//! when the disk hangs.
//!
//! ```text
//!   pages ─► writing ── kept ─► word.kept
//!              │  ▲
//!        fails │  │ something was written durably, and the lost entries are deleted
//!              ▼  │
//!            failing ── once a second
//! ```

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use super::fault::{Fault, Then};
use super::folder::Folder;
use super::head::HeadFile;
use super::kept_back;
use super::pages::Pages;
use super::writer_status::WriterStatus;
use hallsweep_core::effect::{KeptBack, Page};
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{MissionId, Seq};

/// Maximum number of pages in one transaction. It is enough for the pages that collect on a slow disk, but still
/// takes only moments.
const BATCH: usize = 256;

/// Free space in bytes that must remain beyond the failed page before writing is retried. Otherwise a nearly full
/// disk would accept a few entries, fail, accept a few more, and so on.
const MARGIN: usize = 256 * 1024;

#[derive(Clone, Copy, Debug)]
pub(super) struct Patience {
    /// Pause between two attempts after a failure.
    pub(super) retry: Duration,
    /// Number of looks at a batch after which the watchman declares the batch lost.
    pub(super) looks: u32,
    /// Time between two looks of the watchman.
    pub(super) look: Duration,
    /// Maximum wait for the last pages at the end of the program.
    pub(super) end: Duration,
}

impl Patience {
    /// Retries once a second, and declares a batch lost after 5 s. At the end it waits one second, because the whole
    /// program must end within two seconds.
    pub(super) const USUAL: Patience =
        Patience { retry: Duration::from_secs(1), looks: 10, look: Duration::from_millis(500), end: Duration::from_secs(1) };
}

#[derive(Debug)]
pub(super) struct Handed {
    pub(super) page: Page,
    pub(super) losses: u64,
}

#[derive(Debug)]
pub(super) enum Hand {
    Writing(Pages),
    /// The journal could not be opened for writing. The stored state is known, so writing may begin later.
    Waiting(Option<MissionId>),
    /// Nothing may be written until the program is restarted.
    Closed,
}

#[derive(Debug)]
pub(super) struct Writer {
    pub(super) folder: Folder,
    pub(super) status: Arc<WriterStatus>,
    pub(super) pages: Receiver<Handed>,
    pub(super) ended: Receiver<()>,
    pub(super) hand: Hand,
    pub(super) head: HeadFile,
    pub(super) kept: Seq,
    /// Bytes of photos in the last batch.
    pub(super) bulk: usize,
    pub(super) patience: Patience,
}

impl Writer {
    /// Writes until all senders are gone.
    pub(super) fn run(mut self) {
        self.remember_head();
        while self.turn() {}
        self.head.end(self.patience.end);
    }

    fn turn(&mut self) -> bool {
        if self.status.is_failing() {
            let ended = self.ended.recv_timeout(self.patience.retry) == Err(RecvTimeoutError::Disconnected);
            if !ended {
                self.try_again();
            }
            return !ended;
        }
        let first = match self.pages.recv_timeout(self.patience.retry) {
            Ok(first) => first,
            // A page that was refused may be declared lost after everything else was written. Then only this timeout
            // wakes the thread.
            Err(RecvTimeoutError::Timeout) => return true,
            Err(RecvTimeoutError::Disconnected) => return false,
        };
        let batch = std::iter::once(first).chain(self.pages.try_iter().take(BATCH - 1)).collect();
        self.keep(batch);
        true
    }

    /// Stores a batch, except for pages whose sender did not know of a loss.
    fn keep(&mut self, batch: Vec<Handed>) {
        let losses = self.status.begin();
        let pages: Vec<Page> = batch.into_iter().filter(|handed| handed.losses == losses).map(|handed| handed.page).collect();
        let photos = pages
            .iter()
            .flat_map(|page| &page.entries)
            .map(|entry| if let Fact::Luggage { photo: Some(photo), .. } = &entry.fact { photo.bytes.len() } else { 0 });
        self.bulk = photos.sum();
        let last = pages.last().map_or(self.kept, Page::last);
        let answers = pages.iter().rev().find_map(|page| page.kept_back.clone());
        let pages: Vec<Page> = pages.into_iter().filter(|page| !page.entries.is_empty()).collect();
        // The answers that are still kept back follow the entries: an answer must be in one of both places.
        let kept = self.write(&pages, losses).and_then(|()| self.write_answers(answers.as_ref()));
        self.conclude(kept, losses, last);
        if let Some(answers) = answers {
            self.status.keep_back(losses, answers.number);
        }
    }

    pub(super) fn write(&mut self, pages: &[Page], losses: u64) -> Result<(), Fault> {
        match &mut self.hand {
            _ if pages.is_empty() => Ok(()),
            Hand::Writing(journal) => journal.keep(pages, || self.status.wants(losses)),
            Hand::Waiting(..) | Hand::Closed => Err(Fault::Unwritable),
        }
    }

    fn write_answers(&self, answers: Option<&KeptBack>) -> Result<(), Fault> {
        match (answers, &self.hand) {
            (None, _) => Ok(()),
            (Some(list), Hand::Writing(_)) => kept_back::write(&self.folder, &list.answers),
            (Some(_), Hand::Waiting(..) | Hand::Closed) => Err(Fault::Unwritable),
        }
    }

    pub(super) fn conclude(&mut self, kept: Result<(), Fault>, losses: u64, last: Seq) {
        match kept {
            Ok(()) if self.status.keep(losses, last) => {
                self.kept = last;
                self.remember_head();
            }
            // The batch is on disk but was declared lost, so it is deleted at once.
            Ok(()) => self.try_again(),
            Err(fault) => {
                // A failed commit may have left its pages in the write-ahead log. If the program were killed now, the
                // next start would find these pages complete. So they are overwritten before the loss is reported.
                // This need not be durable.
                if let (Hand::Writing(journal), false) = (&mut self.hand, fault.is_final()) {
                    let _ = journal.go_on_after(self.kept);
                }
                self.status.fail(losses, &fault.words(self.folder.path(), Then::GoesOn));
                self.give_in(&fault);
            }
        }
    }

    /// Writes the head file after the entries were reported as stored, so that the file is never ahead of the
    /// journal.
    fn remember_head(&mut self) {
        if let Hand::Writing(journal) = &self.hand
            && let Ok(head) = journal.head()
        {
            self.head.put(head);
        }
    }

    fn try_again(&mut self) {
        // A sender who does not know of the loss yet must not be told that the failure is over.
        if !self.status.is_announced() {
            return;
        }
        let tried = match &mut self.hand {
            Hand::Writing(journal) => journal.go_on_after(self.kept),
            Hand::Waiting(under_way) => {
                let opened = Pages::open(&self.folder, None, self.kept, *under_way);
                opened.and_then(|mut journal| {
                    journal.go_on_after(self.kept)?;
                    self.hand = Hand::Writing(journal);
                    Ok(())
                })
            }
            Hand::Closed => return,
        };
        let proved = tried.and_then(|()| self.folder.prove_room(self.bulk + MARGIN));
        match proved.and_then(|()| self.status.clear_marker()) {
            Ok(()) => self.status.recover(),
            Err(fault) => {
                self.status.still_failing(&fault.words(self.folder.path(), Then::GoesOn));
                self.give_in(&fault);
            }
        }
    }

    /// After a fault that waiting cannot repair, nothing is written to the file until a restart.
    fn give_in(&mut self, fault: &Fault) {
        if fault.is_final() {
            self.hand = Hand::Closed;
        }
    }
}

/// Declares a batch lost when the writer has worked on it for `patience.looks` looks. This is needed because a disk
/// that hangs reports no error.
pub(super) fn watch(status: &WriterStatus, folder: &Folder, ended: &Receiver<()>, patience: Patience) {
    let mut seen = (None, 0);
    while ended.recv_timeout(patience.look) == Err(RecvTimeoutError::Timeout) {
        let batch = status.at_work();
        seen = if batch.is_some() && batch == seen.0 { (batch, seen.1 + 1) } else { (batch, 0) };
        if let (Some(batch), true) = (batch, seen.1 >= patience.looks) {
            status.give_up(batch, &Fault::Hung.words(folder.path(), Then::GoesOn));
        }
    }
}
