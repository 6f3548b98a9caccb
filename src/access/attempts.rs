//! Delays the refusal of a wrong key. The delay grows with the number of wrong keys from the same network. Right keys
//! are not delayed, so nobody can slow down a person who has a right key.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use super::network::Network;

/// Delay of the first refusal. Each further refusal doubles the delay.
const FIRST: Duration = Duration::from_millis(250);

/// Maximum delay. The client's connection stays open during the delay.
const LONGEST: Duration = Duration::from_secs(4);

/// A network is forgotten after this time without a wrong key. A person needs about this time to find the right key.
const FORGOTTEN: Duration = Duration::from_secs(600);

/// Maximum number of remembered networks; the network with the oldest wrong key is forgotten first.
const NETWORKS: usize = 1024;

#[derive(Debug, Default)]
pub struct Attempts(Mutex<HashMap<Network, Wrong>>);

#[derive(Clone, Copy, Debug)]
struct Wrong {
    times: u32,
    last: Duration,
}

impl Attempts {
    /// Counts a wrong key from this network. `now` is the time since the start of the program. Returns the delay of
    /// the refusal.
    pub fn wrong(&self, network: Network, now: Duration) -> Duration {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if all.len() >= NETWORKS && !all.contains_key(&network) {
            let oldest = all.iter().min_by_key(|(_, wrong)| wrong.last).map(|(network, _)| *network);
            oldest.and_then(|network| all.remove(&network));
        }
        let wrong = all.entry(network).or_insert(Wrong { times: 0, last: now });
        if now.saturating_sub(wrong.last) >= FORGOTTEN {
            wrong.times = 0;
        }
        let delay = FIRST.saturating_mul(1 << wrong.times.min(16)).min(LONGEST);
        *wrong = Wrong { times: wrong.times.saturating_add(1), last: now };
        delay
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn network(number: u32) -> Network {
        Network::of(std::net::Ipv4Addr::from_bits(number).into())
    }

    fn delays(attempts: &Attempts, times: usize, now: Duration) -> Vec<u128> {
        (0..times).map(|_| attempts.wrong(network(1), now).as_millis()).collect()
    }

    /// Safety A3.
    #[test]
    fn refusals_are_held_back_longer_and_longer_up_to_four_seconds() {
        let attempts = Attempts::default();
        assert_eq!(delays(&attempts, 7, Duration::ZERO), [250, 500, 1000, 2000, 4000, 4000, 4000]);
        assert_eq!(attempts.wrong(network(2), Duration::ZERO).as_millis(), 250, "another network is another matter");
    }

    #[test]
    fn a_network_that_was_quiet_long_enough_begins_anew() {
        let attempts = Attempts::default();
        delays(&attempts, 5, Duration::ZERO);
        assert_eq!(delays(&attempts, 2, FORGOTTEN), [250, 500]);
    }

    /// Safety A5.
    #[test]
    fn a_flood_of_networks_costs_a_bounded_table() {
        let attempts = Attempts::default();
        for number in 0..3000 {
            attempts.wrong(network(number), Duration::from_secs(u64::from(number)));
        }
        assert_eq!(attempts.0.lock().unwrap().len(), NETWORKS);
        assert_eq!(attempts.wrong(network(2999), Duration::from_secs(3000)).as_millis(), 500, "the latest are remembered");
    }
}
