//! Times by two clocks, and when a session ends by them.

use std::time::Duration;

/// Duration of a session in seconds: a shift.
pub const SESSION_S: i64 = 12 * 60 * 60;

/// Number of seconds by which the wall clock may be set back without ending the sessions of earlier runs.
const SLACK_S: i64 = 5 * 60;

#[derive(Clone, Copy, Debug)]
pub struct Moment {
    /// Time since the program started; nobody can set it.
    pub elapsed: Duration,
    /// Wall clock in seconds since 1970.
    pub unix_s: i64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// Opened by this run: time since its start.
    Elapsed(Duration),
    /// Opened by an earlier run: seconds since 1970.
    Unix(i64),
}

impl End {
    pub(super) fn is_ahead(self, now: Moment) -> bool {
        match self {
            End::Elapsed(end) => now.elapsed < end,
            // A wall clock that was or is wrong does not make a session last for ever.
            End::Unix(end_s) => end_s > now.unix_s && end_s <= now.unix_s.saturating_add(SESSION_S + SLACK_S),
        }
    }
}
