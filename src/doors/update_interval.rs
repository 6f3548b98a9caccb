//! The minimum interval between two updates of a state that is always sent whole: the larger the state, the longer the
//! interval. So the map of a large hall, or all its luggage, takes no more of the processor than that of a small hall. The next
//! update contains all changes since the last one.

use std::time::Duration;

/// A megabyte a second of one state. That takes some hundredths of a processor.
const A_BYTE: Duration = Duration::from_micros(1);

pub(super) fn for_size(bytes: usize) -> Duration {
    A_BYTE.saturating_mul(u32::try_from(bytes).unwrap_or(u32::MAX))
}
