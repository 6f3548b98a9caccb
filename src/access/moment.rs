//! Times of two clocks. The end of a session is a time of one of these clocks.

use std::time::Duration;

/// Duration of a session in seconds: one working shift.
pub const SESSION_S: i64 = 12 * 60 * 60;

/// Number of seconds by which the wall clock may be set back without ending the sessions of earlier runs.
const SLACK_S: i64 = 5 * 60;

#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Time since the program started. Nobody can set this clock.
    pub elapsed: Duration,
    /// Wall clock in seconds since 1970.
    pub unix_s: i64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// End of a session that this run opened: time since the program started.
    Elapsed(Duration),
    /// End of a session that an earlier run opened: seconds since 1970.
    Unix(i64),
}

impl End {
    pub(super) fn is_ahead(self, now: Moment) -> bool {
        match self {
            End::Elapsed(end) => now.elapsed < end,
            // A wall clock that is wrong, now or earlier, must not make a session last for ever.
            End::Unix(end_s) => end_s > now.unix_s && end_s <= now.unix_s.saturating_add(SESSION_S + SLACK_S),
        }
    }
}
