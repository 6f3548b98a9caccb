//! The port to the store: pages go in, in order; the word that they are kept comes back, now or later.

use std::sync::Arc;

use tokio::sync::watch;

use hallsweep_core::effect::Page;
use hallsweep_core::units::Seq;

/// What the store says of the pages it was given.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StoreStatus {
    /// Up to which entry everything is kept, but for what losses took.
    pub kept: Seq,
    /// Why nothing can be written just now, in words for an operator.
    pub failure: Option<Arc<str>>,
    /// How often writing has failed. When this rises every page that was not kept is lost, and so is every page that is handed
    /// over in ignorance of it; the core records anew what still stands once the store writes again.
    pub losses: u64,
}

/// Keeps pages for good, each whole or not at all. Object-safe: the store in memory and the one on disk both are one.
pub trait Store: Send {
    /// Takes a page; must not block. Whether and when it is kept is said by `word`. A page whose sender knows of fewer
    /// `losses` than there were is dropped.
    fn record(&mut self, page: Page, losses: u64);

    /// Where the store's latest word is found.
    fn word(&self) -> watch::Receiver<StoreStatus>;
}
