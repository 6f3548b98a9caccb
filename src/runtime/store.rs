//! The port to the store. The store takes pages (groups of journal entries) in order. At once or later, it reports
//! that they are stored.

use std::sync::Arc;

use tokio::sync::watch;

use hallsweep_core::effect::Page;
use hallsweep_core::units::Seq;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StoreStatus {
    /// Every entry up to this one is stored, except for lost entries.
    pub kept: Seq,
    pub failure: Option<Arc<str>>,
    /// How often writing has failed. Each failure loses all pages that are not stored yet, and all later pages whose
    /// sender did not know of the failure. Once the store writes again, the core records the present state anew.
    pub losses: u64,
    /// Number of the last list of answers that was stored. The core keeps these answers back from everybody else.
    pub kept_back: u64,
}

/// Stores pages for good, each whole or not at all. The trait is object-safe, because two stores implement it: one in
/// memory and one on disk.
pub trait Store: Send {
    /// Takes a page; must not block. `word` reports when the page is stored. `losses` is the number of write failures
    /// that the sender knows of. If there were more failures, the page is dropped.
    fn record(&mut self, page: Page, losses: u64);

    fn word(&self) -> watch::Receiver<StoreStatus>;
}
