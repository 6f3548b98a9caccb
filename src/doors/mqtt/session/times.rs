//! The time limits of the session. Tests use limits of their own. Nothing is measured here.

use std::time::Duration;

#[derive(Clone, Copy, Debug)]
pub struct Times {
    /// Maximum time for connecting, TLS and the broker's greeting together. The same time applies to the answer to our
    /// subscription.
    pub greeting: Duration,
    /// Maximum time without an acknowledgement when the broker owes one.
    pub acknowledgement: Duration,
    /// Silence after which the broker is pinged, and maximum time for its answer, in whole seconds.
    pub keep_alive: Duration,
    pub shortest_pause: Duration,
    /// Longest pause between two attempts. A connection that lasts for less than this counts as failed.
    pub longest_pause: Duration,
    pub farewell: Duration,
}

impl Default for Times {
    fn default() -> Times {
        Times {
            // A broker answers within milliseconds. One on another continent, over TLS, answers within a second or two.
            greeting: Duration::from_secs(5),
            // Longer than a busy broker needs for its disk, but shorter than anybody looks at an outdated state.
            acknowledgement: Duration::from_secs(10),
            // A broker waits one and a half times this, so it notices our absence within 23 s.
            keep_alive: Duration::from_secs(15),
            // A restarted broker is back within a fraction of a second.
            shortest_pause: Duration::from_millis(100),
            // After hours of absence a broker is found again within this pause and the time of a greeting, in less than 5 s.
            longest_pause: Duration::from_secs(3),
            // The program must end within two seconds, in which other parts disconnect too.
            farewell: Duration::from_secs(1),
        }
    }
}
