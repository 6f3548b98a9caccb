//! A store that takes its time over every page, or hangs as long as it is told to. It keeps nothing.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

use hallsweep::runtime::store::{Store, StoreStatus};
use hallsweep_core::effect::Page;
use hallsweep_core::units::Seq;
use tokio::sync::watch;

/// Pages that may wait: more than come while it hangs.
const PAGES: usize = 65_536;

/// The store's end in the loop.
pub(crate) struct Tardy {
    pages: SyncSender<Seq>,
    word: watch::Receiver<StoreStatus>,
}

/// Lets the store hang, and go on.
#[derive(Clone, Default)]
pub(crate) struct Keeping(Arc<(Mutex<bool>, Condvar)>);

impl Tardy {
    /// A store that takes this long over every page, on a thread of its own that ends with it.
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
    /// Whether it hangs from now on.
    pub(crate) fn hang(&self, hangs: bool) {
        let (is_hung, changed) = &*self.0;
        *is_hung.lock().unwrap_or_else(PoisonError::into_inner) = hangs;
        changed.notify_all();
    }

    /// What has come while a page was written is kept with the next one, as a disk does it.
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
