//! The thread that writes: takes what was handed over, keeps it in one transaction, says so. After a failure it tries again and
//! again until something can be written (safety R3). Beside it the watchman, who does not wait for a disk that hangs.
//!
//! ```text
//!   pages ─► writing ── kept ─► word.kept
//!              │  ▲
//!        fails │  │ something was written durably, and what was said to be lost is gone
//!              ▼  │
//!            failing ── once a second
//! ```

use std::sync::Arc;
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::Duration;

use super::fault::{Fault, Then};
use super::folder::Folder;
use super::head::HeadFile;
use super::pages::Pages;
use super::writer_status::WriterStatus;
use hallsweep_core::effect::{Entry, Fact, Page};
use hallsweep_core::units::{MissionId, Seq};

/// So many pages at most share one transaction: what a slow disk lets pile up, and still only moments of work.
const BATCH: usize = 256;

/// There must be room for so many bytes more than what could not be written, before it is tried again: else a disk that is all but
/// full would take the next few entries, fail, take some more, and so on.
const MARGIN: usize = 256 * 1024;

/// How long things take before something is done about them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Patience {
    /// Between two attempts to write after a failure.
    pub(super) retry: Duration,
    /// A batch that takes longer than so many looks is given up,
    pub(super) looks: u32,
    /// with so much time between two looks.
    pub(super) look: Duration,
    /// How long the end of the program waits for the last pages: a disk that takes longer would not have kept them either.
    pub(super) end: Duration,
}

impl Patience {
    /// Once a second; after 5 s; a second, because the whole program is to end within two.
    pub(super) const USUAL: Patience =
        Patience { retry: Duration::from_secs(1), looks: 10, look: Duration::from_millis(500), end: Duration::from_secs(1) };
}

/// A page, and how many losses whoever handed it over knew of.
#[derive(Debug)]
pub(super) struct Handed {
    pub(super) page: Page,
    pub(super) losses: u64,
}

/// The journal, or what keeps it from being written.
#[derive(Debug)]
pub(super) enum Hand {
    Writing(Pages),
    /// It could not be opened for writing. What was kept is known, so that writing may begin later.
    Waiting(Option<MissionId>),
    /// Nothing may be written before the program is started again.
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
    /// The last entry that was said to be kept.
    pub(super) kept: Seq,
    /// How many bytes of photos came with the last batch.
    pub(super) bulk: usize,
    pub(super) patience: Patience,
}

impl Writer {
    /// Writes until nobody can hand anything over any more.
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
            // What could not be handed over may be said to be lost when all that could be is written already: nobody else wakes this.
            Err(RecvTimeoutError::Timeout) => return true,
            Err(RecvTimeoutError::Disconnected) => return false,
        };
        let batch = std::iter::once(first).chain(self.pages.try_iter().take(BATCH - 1)).collect();
        self.keep(batch);
        true
    }

    /// Keeps what was handed over, but for pages whose sender did not know of a loss.
    fn keep(&mut self, batch: Vec<Handed>) {
        let losses = self.status.begin();
        let pages: Vec<Page> = batch.into_iter().filter(|handed| handed.losses == losses).map(|handed| handed.page).collect();
        self.bulk = pages.iter().flat_map(|page| &page.entries).map(photo_bytes).sum();
        let kept = self.write(&pages, losses);
        self.conclude(kept, losses, pages.last().map_or(self.kept, Page::last));
    }

    pub(super) fn write(&mut self, pages: &[Page], losses: u64) -> Result<(), Fault> {
        match &mut self.hand {
            _ if pages.is_empty() => Ok(()),
            Hand::Writing(journal) => journal.keep(pages, || self.status.wants(losses)),
            Hand::Waiting(..) | Hand::Closed => Err(Fault::Unwritable),
        }
    }

    pub(super) fn conclude(&mut self, kept: Result<(), Fault>, losses: u64, last: Seq) {
        match kept {
            Ok(()) if self.status.keep(losses, last) => {
                self.kept = last;
                self.remember_head();
            }
            // It is on the disk and was said to be lost: it goes at once.
            Ok(()) => self.try_again(),
            Err(fault) => {
                // A commit that failed may have left its pages in the write-ahead log, where a kill at this moment would find
                // them whole. They are written over before anybody hears that they are lost; whether that lasts does not matter.
                if let (Hand::Writing(journal), false) = (&mut self.hand, fault.is_final()) {
                    let _ = journal.go_on_after(self.kept);
                }
                self.status.fail(losses, &fault.words(self.folder.path(), Then::GoesOn));
                self.give_in(&fault);
            }
        }
    }

    /// Puts down where the journal ends; behind what was said to be kept, and so never before it.
    fn remember_head(&mut self) {
        if let Hand::Writing(journal) = &self.hand
            && let Ok(head) = journal.head()
        {
            self.head.put(head);
        }
    }

    fn try_again(&mut self) {
        // Who does not know yet that something is lost must not be told that all is well again.
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

    /// A file that is broken is not written to again.
    fn give_in(&mut self, fault: &Fault) {
        if fault.is_final() {
            self.hand = Hand::Closed;
        }
    }
}

fn photo_bytes(entry: &Entry) -> usize {
    if let Fact::Luggage { photo: Some(photo), .. } = &entry.fact { photo.bytes.len() } else { 0 }
}

/// Looks at the writer now and then; one that is at the same batch for too long is not waited for.
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
