//! A store that is slow for every page, or hangs until it is released. It stores nothing.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use hallsweep::runtime::store::{Store, StoreStatus};
use hallsweep_core::effect::Page;
use hallsweep_core::units::Seq;
use tokio::sync::watch;

/// Capacity of the queue, more than the pages that arrive while the store hangs.
const PAGES: usize = 65_536;

/// The main loop's side of the store.
pub(crate) struct Tardy {
    pages: SyncSender<Seq>,
    word: watch::Receiver<StoreStatus>,
}

/// Switch that makes the store hang or continue.
#[derive(Clone, Default)]
pub(crate) struct Keeping(Arc<(Mutex<bool>, Condvar)>);

impl Tardy {
    /// Starts a store that takes this long per page, on a thread that ends with it.
    pub(crate) fn start(takes: Duration) -> (Tardy, Keeping) {
        let (pages, handed) = sync_channel(PAGES);
        let (say, word) = watch::channel(StoreStatus::default());
        let keeping = Keeping::default();
        let kept = keeping.clone();
        std::thread::spawn(move || kept.keep(&handed, takes, &say));
        (Tardy { pages, word }, keeping)
    }
}

impl Store for Tardy {
    fn record(&mut self, page: Page, _losses: u64) {
        self.pages.try_send(page.last()).expect("fewer pages come than may wait");
    }

    fn word(&self) -> watch::Receiver<StoreStatus> {
        self.word.clone()
    }
}

impl Keeping {
    /// Sets whether the store hangs.
    pub(crate) fn hang(&self, hangs: bool) {
        let (is_hung, changed) = &*self.0;
        *is_hung.lock().unwrap_or_else(PoisonError::into_inner) = hangs;
        changed.notify_all();
    }

    /// Pages that arrive during a write are stored together with the next one, as on a disk.
    fn keep(&self, handed: &Receiver<Seq>, takes: Duration, say: &watch::Sender<StoreStatus>) {
        while let Ok(first) = handed.recv() {
            let last = handed.try_iter().last().unwrap_or(first);
            std::thread::sleep(takes);
            let (is_hung, changed) = &*self.0;
            let hung = is_hung.lock().unwrap_or_else(PoisonError::into_inner);
            drop(changed.wait_while(hung, |hung| *hung).unwrap_or_else(PoisonError::into_inner));
            say.send_modify(|word| word.kept = last);
        }
    }
}
