//! The port to the store: pages go in, in order; the report that they are stored comes back, at once or later.

use std::sync::Arc;

use tokio::sync::watch;

use hallsweep_core::effect::Page;
use hallsweep_core::units::Seq;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StoreStatus {
    /// The entry up to which everything is stored, apart from losses.
    pub kept: Seq,
    pub failure: Option<Arc<str>>,
    /// How often writing has failed. A rise means that every page not stored yet is lost, and so is every page handed over
    /// without knowledge of it; the core records the present state anew once the store writes again.
    pub losses: u64,
}

/// Stores pages for good, each whole or not at all. Object-safe, because the store in memory and the one on disk both implement
/// it.
pub trait Store: Send {
    /// Takes a page; must not block. `word` reports whether and when it is stored. A page whose sender knows of fewer `losses`
    /// than there were is dropped.
    fn record(&mut self, page: Page, losses: u64);

    fn word(&self) -> watch::Receiver<StoreStatus>;
}
