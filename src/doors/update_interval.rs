//! The minimum interval between two updates of a state that is always sent as a whole. The larger the state, the
//! longer the interval. So a large map, or a long list of luggage, needs no more processor time than a small one. The
//! next update contains all changes since the last update.

use std::time::Duration;

/// Interval for each byte: at most 1 MB of one state is sent per second. This takes a few hundredths of a processor.
const A_BYTE: Duration = Duration::from_micros(1);

pub(super) fn for_size(bytes: usize) -> Duration {
    A_BYTE.saturating_mul(u32::try_from(bytes).unwrap_or(u32::MAX))
}
