//! The file `journal.lost` names the entry after which everything was declared lost. When a disk hangs, entries may
//! be declared lost although their commit reaches the disk, and a later start would find them. This file needs no
//! flush and survives a kill, so that entries declared lost stay lost (safety V3).
//!
//! ```text
//!   failure ─► put K ─► the loss is announced          deleted, durably ─► clear, durably ─► the end of the failure is announced
//! ```
//! `pages` deletes the entries.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::Duration;

use super::fault::Fault;
use super::folder::{Folder, Identity};
use crate::storage::{files, names};
use hallsweep_core::units::Seq;

/// Maximum time for which the announcement of a loss waits for the file. A disk that hangs even on these few bytes
/// must not delay it longer.
const PATIENCE: Duration = Duration::from_millis(500);

const WORDS: [&str; 2] = ["everything after entry ", " was said to be lost\n"];

const NOTHING: &str = "nothing was said to be lost";

/// Writes and clears the mark, never both at once.
#[derive(Debug)]
pub(super) struct Marker {
    folder: Folder,
    /// Identity of the lock file in the original folder. A folder that replaced this one must not get this program's
    /// losses.
    lock: Option<Identity>,
    putting: Arc<AtomicUsize>,
}

impl Marker {
    pub(super) fn new(folder: &Folder) -> Marker {
        Marker { folder: folder.clone(), lock: folder.lock_identity(), putting: Arc::default() }
    }

    /// Records that everything after `kept` is lost. Waits half a second at most. After this time a thread finishes
    /// the write when the disk allows it.
    pub(super) fn put(&self, kept: Seq) {
        let (folder, lock, putting) = (self.folder.clone(), self.lock, Arc::clone(&self.putting));
        let (done, waiting) = mpsc::channel::<()>();
        putting.fetch_add(1, Ordering::SeqCst);
        let put = std::thread::Builder::new().name("journal-marker".to_owned()).spawn(move || {
            let is_ours = lock.is_none() || folder.lock_identity() == lock;
            if let Some(error) = is_ours.then(|| folder.marker().write_over(text(Some(kept)).as_bytes())).and_then(Result::err) {
                tracing::warn!(%error, "cannot record which entries are lost: if hallsweep is killed now, these entries may come \
                                        back");
            }
            putting.fetch_sub(1, Ordering::SeqCst);
            drop(done);
        });
        match put {
            // Nothing is ever sent on this channel: it ends when the thread ends.
            Ok(_) => drop(waiting.recv_timeout(PATIENCE)),
            Err(_) => drop(self.putting.fetch_sub(1, Ordering::SeqCst)),
        }
    }

    /// Records durably that no entries are declared lost any more. It is called when the lost entries are deleted.
    pub(super) fn clear(&self) -> Result<(), Fault> {
        // A thread that is still writing the mark would set it again after this.
        if self.putting.load(Ordering::SeqCst) > 0 { Err(Fault::Hung) } else { clear(&self.folder) }
    }
}

/// Records durably that no entries are declared lost. From then on the file exists, so writing the mark needs no free
/// space.
pub(super) fn clear(folder: &Folder) -> Result<(), Fault> {
    folder.marker().write_over(text(None).as_bytes())?.sync_all()?;
    Ok(files::sync_folder(folder.path())?)
}

/// The entry after which everything was declared lost; `None` when nothing was declared lost.
pub(super) fn read(folder: &Folder) -> Result<Option<Seq>, Fault> {
    let Some(bytes) = folder.marker().read(text(None).len())? else { return Ok(None) };
    let damaged = || Fault::Unusable(names::LOST, "it is damaged, so the lost entries are unknown".to_owned());
    understood(&bytes).ok_or_else(damaged)
}

/// Parses the file; `None` when its contents are not ours. A kill may leave a new file empty.
fn understood(bytes: &[u8]) -> Option<Option<Seq>> {
    let said = std::str::from_utf8(bytes).ok()?;
    if said.is_empty() || said == text(None) { Some(None) } else { lost_after(said).map(Some) }
}

/// The contents of the file. Both possible texts have the same length and are written in one call, so no kill leaves
/// a mix of them.
fn text(lost_after: Option<Seq>) -> String {
    let lost = |seq: Seq| format!("{}{:020}{}", WORDS[0], seq.0, WORDS[1]);
    let length = lost(Seq(0)).len() - 1;
    lost_after.map_or_else(|| format!("{NOTHING:length$}\n"), lost)
}

fn lost_after(text: &str) -> Option<Seq> {
    text.strip_prefix(WORDS[0])?.strip_suffix(WORDS[1])?.parse().ok().map(Seq)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_the_texts_cover_each_other() {
        for seq in [Seq(0), Seq(42), Seq(u64::MAX)] {
            assert_eq!(understood(text(Some(seq)).as_bytes()), Some(Some(seq)));
            assert_eq!(text(Some(seq)).len(), text(None).len());
        }
        assert_eq!((understood(text(None).as_bytes()), understood(b"")), (Some(None), Some(None)));
        for damaged in ["everything after entry 12", "nothing", &"\0".repeat(text(None).len()), &format!("{}x", text(None))] {
            assert_eq!(understood(damaged.as_bytes()), None, "{damaged}");
        }
        assert_eq!(understood(&[0xff; 9]), None);
    }

    /// Safety V3: if the mark were set after it was cleared, the next start would delete entries stored since then.
    #[test]
    fn it_is_not_cleared_while_somebody_is_at_putting_it_down() {
        let marker = Marker::new(&Folder::new(std::path::Path::new("nowhere")));
        marker.putting.fetch_add(1, Ordering::SeqCst);
        assert!(matches!(marker.clear(), Err(Fault::Hung)));
    }
}
