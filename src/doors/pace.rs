//! How soon what is always said whole may be said again: later, the larger it is. So the whole map of a large hall, or all its luggage, costs
//! a door no more of the processor than those of a small one; what changes meanwhile is in the next.

use std::time::Duration;

/// A megabyte a second of one thing, which is some hundredths of a processor.
const A_BYTE: Duration = Duration::from_micros(1);

/// The least time between two states of a thing that took so many bytes.
pub(super) fn of_size(bytes: usize) -> Duration {
    A_BYTE.saturating_mul(u32::try_from(bytes).unwrap_or(u32::MAX))
}
