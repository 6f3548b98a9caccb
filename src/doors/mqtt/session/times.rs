//! The time limits of the session. Tests use limits of their own. Nothing is measured here.

use std::time::Duration;

#[derive(Clone, Copy, Debug)]
pub struct Times {
    /// Maximum time for connecting, TLS and the broker's greeting together. The answer to our subscription has the
    /// same time limit.
    pub greeting: Duration,
    /// Maximum time without an acknowledgement while one is missing.
    pub acknowledgement: Duration,
    /// Time of silence after which we ping the broker, in whole seconds. It is also the maximum time for the answer.
    pub keep_alive: Duration,
    pub shortest_pause: Duration,
    /// Longest pause between two attempts to connect. A connection that was shorter than this counts as a failed
    /// attempt.
    pub longest_pause: Duration,
    pub farewell: Duration,
}

impl Default for Times {
    fn default() -> Times {
        Times {
            // A broker usually answers within milliseconds. A broker on another continent, over TLS, needs a second
            // or two.
            greeting: Duration::from_secs(5),
            // A busy broker may need some seconds for its disk. Nobody should look at an outdated state for longer
            // than 10 s.
            acknowledgement: Duration::from_secs(10),
            // Brokers wait 1.5 × the keep alive, so they notice our absence within 23 s.
            keep_alive: Duration::from_secs(15),
            // A broker that is restarted is back within a fraction of a second.
            shortest_pause: Duration::from_millis(100),
            // A broker that was absent for hours is found within this pause plus the time of a greeting. Together
            // this is less than 5 s.
            longest_pause: Duration::from_secs(3),
            // The program must end within two seconds, and other parts disconnect during the same time.
            farewell: Duration::from_secs(1),
        }
    }
}
