//! The port to the store: entries go in, in order; the word that they are kept comes back, now or later.

use tokio::sync::watch;

use crate::core::effect::Entry;
use crate::core::units::Seq;

/// Up to which entry everything is kept; or why nothing can be written, in words for an operator. Entries that were not kept
/// when a failure was said are lost, and the core records anew what still stands once the store is restored.
pub type StoreWord = Result<Seq, String>;

/// Keeps entries for good. Object-safe: the store in memory and the one on disk both are one.
pub trait Store: Send {
    /// Takes an entry; must not block. Whether and when it is kept is said by `word`.
    fn record(&mut self, seq: Seq, entry: &Entry);

    /// Where the store's latest word is found.
    fn word(&self) -> watch::Receiver<StoreWord>;
}
