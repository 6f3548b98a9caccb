//! The minimum time between two publications of something that is always sent as a whole: the larger it is, the longer. So the
//! map of a large hall, or all its luggage, costs a door no more processor time than those of a small one; changes in between are
//! in the next publication.

use std::time::Duration;

/// One megabyte a second of one resource, which takes some hundredths of a processor.
const A_BYTE: Duration = Duration::from_micros(1);

/// Minimum time after a state of this many bytes.
pub(super) fn of_size(bytes: usize) -> Duration {
    A_BYTE.saturating_mul(u32::try_from(bytes).unwrap_or(u32::MAX))
}
