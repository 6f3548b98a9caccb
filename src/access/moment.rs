//! Moments by two clocks, and when a session ends by them.

use std::time::Duration;

/// How long a session lasts, in seconds: a shift.
pub const SESSION_S: i64 = 12 * 60 * 60;

/// How far the wall clock may be set back without ending the sessions of earlier runs, in seconds.
const SLACK_S: i64 = 5 * 60;

/// A moment, by both clocks.
#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Since the program started; nobody can set it.
    pub elapsed: Duration,
    /// By the wall clock, in seconds since 1970.
    pub unix_s: i64,
}

/// When a session ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// This run opened it.
    Elapsed(Duration),
    /// An earlier run opened it: in seconds since 1970.
    Unix(i64),
}

impl End {
    pub(super) fn is_ahead(self, now: Moment) -> bool {
        match self {
            End::Elapsed(end) => now.elapsed < end,
            // A clock that was wrong, then or now, lets no session last for ever.
            End::Unix(end_s) => end_s > now.unix_s && end_s <= now.unix_s.saturating_add(SESSION_S + SLACK_S),
        }
    }
}
