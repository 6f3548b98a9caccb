//! The time limits of the session. Tests use their own; nothing is measured here.

use std::time::Duration;

#[derive(Clone, Copy, Debug)]
pub struct Times {
    /// For connecting, TLS and the broker's greeting together; and again for its answer to our subscription.
    pub greeting: Duration,
    /// Maximum time without an acknowledgement while the broker owes one.
    pub acknowledgement: Duration,
    /// Silence after which the broker is pinged, and time for its answer; whole seconds.
    pub keep_alive: Duration,
    pub shortest_pause: Duration,
    /// A connection that lasts for less counts as failed.
    pub longest_pause: Duration,
    pub farewell: Duration,
}

impl Default for Times {
    fn default() -> Times {
        Times {
            // A broker answers within milliseconds; one across the world, over TLS, within a second or two.
            greeting: Duration::from_secs(5),
            // Longer than a busy broker needs for its disk, shorter than anybody looks at a stale state.
            acknowledgement: Duration::from_secs(10),
            // Together with the broker's one and a half times, our absence is noticed within 23 s.
            keep_alive: Duration::from_secs(15),
            // A restarted broker is back within a fraction of a second.
            shortest_pause: Duration::from_millis(100),
            // After hours a broker is found again within this pause and a greeting, in less than 5 s.
            longest_pause: Duration::from_secs(3),
            // The program must end within two seconds, and others disconnect as well.
            farewell: Duration::from_secs(1),
        }
    }
}
