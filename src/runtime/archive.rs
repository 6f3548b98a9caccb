//! The read port through which doors fetch what is too large or too old for a snapshot: photos, and the luggage of missions that
//! are over.

use crate::core::event::Photo;
use crate::core::units::LuggageId;
use crate::core::world::luggage::Luggage;

/// What is kept and can be read back. Object-safe: the store in memory and the one on disk both are one.
pub trait Archive: Send + Sync {
    /// The newest photo of a piece, if it is kept.
    fn photo(&self, luggage: LuggageId) -> Option<Photo>;

    /// The record of a piece, of whatever mission, if it is kept.
    fn luggage(&self, luggage: LuggageId) -> Option<Luggage>;
}
