//! The port to the store: it takes pages in order, and reports at once or later that they are stored.

use std::sync::Arc;

use tokio::sync::watch;

use hallsweep_core::effect::Page;
use hallsweep_core::units::Seq;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StoreStatus {
    /// The entry up to which everything is stored, apart from losses.
    pub kept: Seq,
    pub failure: Option<Arc<str>>,
    /// How often writing has failed. A rise means that every page not stored yet is lost, and so is every page whose sender did
    /// not know of the loss; the core records the present state anew once the store writes again.
    pub losses: u64,
}

/// Stores pages for good, each whole or not at all. Object-safe, because both stores, in memory and on disk, implement it.
pub trait Store: Send {
    /// Takes a page; must not block. `word` reports whether and when it is stored. A page whose sender knows of fewer `losses`
    /// than there were is dropped.
    fn record(&mut self, page: Page, losses: u64);

    fn word(&self) -> watch::Receiver<StoreStatus>;
}
