//! What the store, the writer and the watchman share: the store's report on its pages (`StoreStatus`), and whether
//! the writer is at work. Every change of the report is made here, under one lock, so that no page is ever reported
//! as both stored and lost.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;

use tokio::sync::watch;

use super::fault::Fault;
use super::marker::Marker;
use crate::runtime::store::StoreStatus;
use hallsweep_core::units::Seq;

#[derive(Debug)]
pub(super) struct WriterStatus {
    word: watch::Sender<StoreStatus>,
    work: Mutex<Work>,
    marker: Marker,
}

#[derive(Debug, Default)]
struct Work {
    batches: u64,
    busy: bool,
    /// Whether a loss is decided but not announced yet. Meanwhile it is written to a file that survives a kill.
    losing: bool,
    overflowed: bool,
}

impl WriterStatus {
    /// The status at the start. A failure to open the journal counts as a loss, so that nobody waits until it is
    /// open.
    pub(super) fn new(marker: Marker, kept: Seq, failure: Option<&str>) -> WriterStatus {
        let word = StoreStatus { kept, failure: failure.map(Arc::from), losses: u64::from(failure.is_some()), kept_back: 0 };
        WriterStatus { word: watch::Sender::new(word), work: Mutex::default(), marker }
    }

    pub(super) fn word(&self) -> watch::Receiver<StoreStatus> {
        let mut word = self.word.subscribe();
        word.mark_changed();
        word
    }

    pub(super) fn losses(&self) -> u64 {
        self.word.borrow().losses
    }

    /// Whether writing fails, or is about to be reported as failing.
    pub(super) fn is_failing(&self) -> bool {
        self.fails(&self.work())
    }

    pub(super) fn is_announced(&self) -> bool {
        let work = self.work();
        self.fails(&work) && !work.losing
    }

    pub(super) fn wants(&self, losses: u64) -> bool {
        let work = self.work();
        !work.losing && self.losses() == losses
    }

    /// Begins a batch; returns the number of losses so far.
    pub(super) fn begin(&self) -> u64 {
        let mut work = self.work();
        (work.batches, work.busy) = (work.batches + 1, true);
        self.losses()
    }

    /// Reports that the batch is stored up to `last`. `losses` is the number of losses when the batch was begun.
    /// Returns false if the batch was declared lost in the meantime; then the caller must delete the batch.
    pub(super) fn keep(&self, losses: u64, last: Seq) -> bool {
        let mut work = self.work();
        work.busy = false;
        let stands = !work.losing && self.losses() == losses;
        if stands {
            self.word.send_modify(|word| word.kept = last);
        }
        stands
    }

    /// Reports that the answers of the batch are stored, unless the batch was lost.
    pub(super) fn keep_back(&self, losses: u64, number: u64) {
        let work = self.work();
        if !self.fails(&work) && self.losses() == losses {
            self.word.send_modify(|word| word.kept_back = number);
        }
    }

    /// Reports that the batch failed, unless the batch is already declared lost.
    pub(super) fn fail(&self, losses: u64, words: &str) {
        let mut work = self.work();
        work.busy = false;
        if !work.losing && self.losses() == losses {
            self.lose(work, words);
        }
    }

    /// Reports that a page cannot be accepted. Only the first such page counts as a loss: all further pages until the
    /// end of the failure belong to this loss. Never waits, because another thread makes the announcement.
    pub(super) fn overflow(self: &Arc<WriterStatus>, words: String) {
        let mut work = self.work();
        if self.fails(&work) {
            work.overflowed = true;
            return;
        }
        work.losing = true;
        drop(work);
        let (status, said) = (Arc::clone(self), words.clone());
        let announced = thread::Builder::new().name("journal-loss".to_owned()).spawn(move || status.announce(&said, true));
        if announced.is_err() {
            self.announce(&words, false);
        }
    }

    pub(super) fn still_failing(&self, words: &str) {
        let _work = self.work();
        self.word.send_if_modified(|word| {
            let news = word.failure.as_deref() != Some(words);
            if news {
                word.failure = Some(Arc::from(words));
            }
            news
        });
    }

    pub(super) fn recover(&self) {
        let mut work = self.work();
        let lost = u64::from(std::mem::take(&mut work.overflowed));
        self.word.send_modify(|word| {
            word.failure = None;
            word.losses += lost;
        });
    }

    pub(super) fn at_work(&self) -> Option<u64> {
        let work = self.work();
        work.busy.then_some(work.batches)
    }

    /// Declares the batch lost if it is still being written. Pages that were handed over after the batch are lost
    /// too.
    pub(super) fn give_up(&self, batch: u64, words: &str) {
        let work = self.work();
        if work.busy && work.batches == batch && !self.fails(&work) {
            self.lose(work, words);
        }
    }

    /// Clears the mark, because writing works again and the lost entries are deleted. So after a kill everything in
    /// the journal may be read.
    pub(super) fn clear_marker(&self) -> Result<(), Fault> {
        self.marker.clear()
    }

    fn fails(&self, work: &Work) -> bool {
        work.losing || self.word.borrow().failure.is_some()
    }

    /// Declares a loss. First stops reporting pages as stored, so that the last stored entry remains the same as in
    /// the mark.
    fn lose(&self, mut work: MutexGuard<'_, Work>, words: &str) {
        work.losing = true;
        drop(work);
        self.announce(words, true);
    }

    fn announce(&self, words: &str, with_marker: bool) {
        if with_marker {
            let kept = self.word.borrow().kept;
            self.marker.put(kept);
        }
        let mut work = self.work();
        work.losing = false;
        self.word.send_modify(|word| {
            word.losses += 1;
            word.failure = Some(Arc::from(words));
        });
    }

    fn work(&self) -> MutexGuard<'_, Work> {
        // No code under the lock can panic.
        self.work.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::super::folder::Folder;
    use super::*;

    /// Safety V3: tests the time between the decision on a loss and its announcement.
    #[test]
    fn while_a_loss_is_being_put_down_nothing_is_kept_and_nothing_is_well_again() {
        let status = WriterStatus::new(Marker::new(&Folder::new(Path::new("nowhere"))), Seq(5), None);
        let losses = status.begin();
        status.work().losing = true;
        assert!(!status.wants(losses) && !status.keep(losses, Seq(6)));
        assert_eq!(status.word().borrow().kept, Seq(5));
        assert!(status.is_failing() && !status.is_announced());
    }

    /// Safety R3: the watchman may have looked just before the batch ended. The next batch must not be declared lost
    /// instead.
    #[test]
    fn a_batch_that_is_over_is_not_given_up_in_place_of_the_next() {
        let status = WriterStatus::new(Marker::new(&Folder::new(Path::new("nowhere"))), Seq(0), None);
        assert!(status.keep(status.begin(), Seq(1)));
        let before = status.at_work();
        let losses = status.begin();
        status.give_up(1, "the disk does not answer");
        assert_eq!((before, status.losses(), status.keep(losses, Seq(2))), (None, 0, true));
    }
}
