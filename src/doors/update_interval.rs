//! The least interval between two updates of a state that is always sent whole: longer, the larger it is. So the map of a large hall, or
//! all its luggage, costs a door no more of the processor than those of a small one; what changes meanwhile is in the next.

use std::time::Duration;

/// A megabyte a second of one state, which takes some hundredths of a processor.
const A_BYTE: Duration = Duration::from_micros(1);

pub(super) fn for_size(bytes: usize) -> Duration {
    A_BYTE.saturating_mul(u32::try_from(bytes).unwrap_or(u32::MAX))
}
