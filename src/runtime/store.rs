//! The port to the store: entries go in, in order; the word that they are kept comes back through the loop.

use crate::core::effect::Entry;
use crate::core::units::Seq;

/// Keeps entries for good. Object-safe: the store in memory and the one on disk both are one.
pub trait Store: Send {
    /// Takes an entry. Whether and when it is kept is said by `kept`.
    fn record(&mut self, seq: Seq, entry: &Entry);

    /// Up to which entry everything is kept; or why nothing more can be kept, in words for an operator.
    ///
    /// # Errors
    /// The store's words when it cannot write.
    fn kept(&mut self) -> Result<Seq, String>;
}
