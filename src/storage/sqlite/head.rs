//! The file `journal.head` has the last entry written to the journal, and the digest of the entry's page. It shows
//! whether entries were cut off at the end of the journal. The file is written after each commit and without a flush.
//! So after a kill or a power cut it may be behind the journal, but it is never ahead of the journal.

use std::io;
use std::sync::mpsc::{self, Receiver};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use rusqlite::Connection;

use super::fault::Fault;
use super::folder::Folder;
use super::{chain, connect, marker, rows, schema};
use crate::runtime::archive::Head;
use crate::storage::names;
use hallsweep_core::units::Seq;

/// Fixed size of the file in bytes, so that each write overwrites the previous one.
const LENGTH: usize = "entry ".len() + 20 + " sha256 ".len() + 64 + 1;

/// Writes the file on a separate thread. If the disk hangs, nobody waits, and the file stays behind the journal.
#[derive(Debug)]
pub(super) struct HeadFile {
    slot: Arc<Slot>,
    done: Receiver<()>,
}

#[derive(Debug, Default)]
struct Slot {
    next: Mutex<Next>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Next {
    head: Option<Head>,
    is_over: bool,
}

impl HeadFile {
    pub(super) fn start(folder: &Folder) -> io::Result<HeadFile> {
        let (slot, mut file) = (Arc::new(Slot::default()), folder.head());
        // A folder that replaced the original folder must not get this journal's head.
        let (folder, lock) = (folder.clone(), folder.lock_identity());
        let (say_done, done) = mpsc::channel();
        let heads = Arc::clone(&slot);
        std::thread::Builder::new().name("journal-head".to_owned()).spawn(move || {
            while let Some(head) = heads.wait() {
                if lock.is_some() && folder.lock_identity() != lock {
                    continue;
                }
                let written = file.write_over(text(&head).as_bytes()).map(drop);
                file.say(
                    &written,
                    "this file cannot be written: a loss of the newest entries could not be detected",
                    "this file is written again",
                );
            }
            drop(say_done);
        })?;
        Ok(HeadFile { slot, done })
    }

    pub(super) fn put(&self, head: Head) {
        self.slot.change(|next| next.head = Some(head));
    }

    /// Stops the thread. The last head is still written if that takes no longer than `patience`.
    pub(super) fn end(&self, patience: Duration) {
        self.slot.change(|next| next.is_over = true);
        // Nothing is ever sent on this channel: it ends when the thread ends.
        let _ = self.done.recv_timeout(patience);
    }
}

impl Slot {
    fn change(&self, change: impl FnOnce(&mut Next)) {
        // No code under the lock can panic.
        change(&mut self.next.lock().unwrap_or_else(PoisonError::into_inner));
        self.changed.notify_one();
    }

    /// Waits for the next head; `None` when all heads are written and no more will come.
    fn wait(&self) -> Option<Head> {
        let next = self.next.lock().unwrap_or_else(PoisonError::into_inner);
        let waited = self.changed.wait_while(next, |next| next.head.is_none() && !next.is_over);
        waited.unwrap_or_else(PoisonError::into_inner).head.take()
    }
}

/// Writes the head durably, for callers that may wait.
pub(super) fn write(folder: &Folder, head: &Head) -> Result<(), Fault> {
    Ok(folder.head().write_over(text(head).as_bytes())?.sync_all()?)
}

/// Fails when the journal does not have the entry that the head file names, or when this entry was declared lost.
pub(super) fn check(folder: &Folder) -> Result<(), Fault> {
    let Some(head) = read(folder)? else { return Ok(()) };
    let lost_after = marker::read(folder)?;
    if lost_after.is_some_and(|kept| kept < head.seq) {
        let why = format!("it says that entries are lost, but these entries were stored, up to entry {}", head.seq);
        return Err(Fault::Unusable(names::LOST, why));
    }
    let Some(connect::JournalReader { connection, .. }) = connect::reader_of_entries(folder)? else {
        return Err(if folder.has_photos() { Fault::OnlyPhotos } else { Fault::CutOff(head.seq) });
    };
    is_held(&connection, &head)
}

/// Fails when the journal does not have this page. The empty head fits every journal, since a program may be killed
/// before the file names the first page.
pub(super) fn is_held(connection: &Connection, head: &Head) -> Result<(), Fault> {
    if *head == chain::NOTHING {
        return Ok(());
    }
    if rows::last_up_to(connection, None)? < head.seq {
        return Err(Fault::CutOff(head.seq));
    }
    // A head file cannot belong to a journal that has no chain.
    let is_chained = schema::format(connection)? == schema::Format::Current;
    let there = if is_chained { chain::page_of(connection, head.seq)? } else { None };
    if there == Some(*head) { Ok(()) } else { Err(Fault::Another(head.seq)) }
}

/// The stored head; `None` when there is no file, or when a power cut left the file empty.
pub(super) fn read(folder: &Folder) -> Result<Option<Head>, Fault> {
    let bytes = folder.head().read(LENGTH)?.unwrap_or_default();
    if bytes.iter().all(|byte| *byte == 0) {
        return Ok(None);
    }
    let damaged = || Fault::Unusable(names::HEAD, "it is damaged".to_owned());
    understood(&bytes).map(Some).ok_or_else(damaged)
}

fn text(head: &Head) -> String {
    format!("entry {:020} sha256 {}\n", head.seq.0, head.hex())
}

fn understood(bytes: &[u8]) -> Option<Head> {
    let (seq, digest) = std::str::from_utf8(bytes).ok()?.strip_prefix("entry ")?.split_once(" sha256 ")?;
    let head = Head { seq: Seq(seq.parse().ok()?), digest: Head::read_digest(digest.strip_suffix('\n')?)? };
    (text(&head).as_bytes() == bytes).then_some(head)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_nothing_else_is() {
        for seq in [Seq(0), Seq(42), Seq(u64::MAX)] {
            let head = Head { seq, digest: [0xa5; 32] };
            let text = text(&head);
            assert_eq!((understood(text.as_bytes()), text.len()), (Some(head), LENGTH));
            for place in 0..text.len() {
                let mut changed = text.clone().into_bytes();
                changed[place] ^= 1;
                assert_ne!(understood(&changed), understood(text.as_bytes()), "{place}");
            }
        }
        assert_eq!(understood(b"entry 1 sha256 \n"), None);
    }
}
