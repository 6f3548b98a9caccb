//! How long the session waits for what. Tests make their own; nothing is measured here.

use std::time::Duration;

/// How long the session waits for what.
#[derive(Clone, Copy, Debug)]
pub struct Times {
    /// Connecting, TLS and the broker's greeting together; and once more for its answer to our subscription.
    pub greeting: Duration,
    /// The broker owes acknowledgements, and has given none for so long.
    pub acknowledgement: Duration,
    /// After so long a silence of ours the broker is asked whether it is there, and has as long to answer; whole seconds.
    pub keep_alive: Duration,
    /// The first pause before connecting again,
    pub shortest_pause: Duration,
    /// and the longest. A connection that lasted shorter than this counts as one that failed.
    pub longest_pause: Duration,
    pub farewell: Duration,
}

impl Default for Times {
    fn default() -> Times {
        Times {
            // A broker answers within milliseconds; one across the world, over TLS, within a second or two.
            greeting: Duration::from_secs(5),
            // Longer than a busy broker needs for its disk, shorter than anybody looks at a state that stands still.
            acknowledgement: Duration::from_secs(10),
            // With the broker's half again as much, it tells that we are gone within 23 s.
            keep_alive: Duration::from_secs(15),
            // A broker that is started anew is back within a fraction of a second,
            shortest_pause: Duration::from_millis(100),
            // and after hours it is found within these and a greeting: in less than 5 s.
            longest_pause: Duration::from_secs(3),
            // The program has ended within two seconds, and others take leave as well.
            farewell: Duration::from_secs(1),
        }
    }
}
