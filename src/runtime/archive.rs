//! The read port through which doors fetch what is too large or too old for a snapshot: photos today.

use crate::core::event::Photo;
use crate::core::units::LuggageId;

/// What is kept and can be read back. Object-safe: the store in memory and the one on disk both are one.
pub trait Archive: Send + Sync {
    /// The newest photo of a piece, if it is kept.
    fn photo(&self, luggage: LuggageId) -> Option<Photo>;
}
