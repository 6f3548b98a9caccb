//! Whether the router is the cause of what is wrong. Starting it anew sends everybody away, so that it must not be done for nothing: on
//! a machine with far too much to do it may only be slow, and it is looked whether others get their messages; where the program takes
//! much memory it may be others who do, and it is looked what the router was given and has room for. What is done about it is not decided here.

use std::time::Duration;

use super::limits::{APPETITE, MEAL, OF_CLIENT, OF_FILTER};
use super::session::Health;

/// Where Linux tells a program about itself, and on which line.
const STATUS: &str = "/proc/self/status";
const RESIDENT: &str = "VmRSS:";

/// A router out of which a message came within this time passes messages on; our own would have had to come back within it.
const LATELY: Duration = Duration::from_secs(5);

/// So often in a row it must be called ill to be believed to be, though it passes messages on.
const CALLS: u32 = 6;

#[derive(Debug, Default)]
pub(super) struct Suspicion {
    /// How many pieces of messages have come out of routers, and when the last one had.
    came: u64,
    came_at: Option<Duration>,
    /// How often it was called ill since it was last called well.
    calls: u32,
}

impl Suspicion {
    /// So many pieces of messages have come out of routers since the program began.
    pub(super) fn handle_came(&mut self, came: u64, now: Duration) {
        if came != self.came {
            (self.came, self.came_at) = (came, Some(now));
        }
    }

    /// Our own session says how the router is; whether another one is needed.
    pub(super) fn handle_told(&mut self, health: Health, now: Duration) -> bool {
        match health {
            Health::Unproven => false,
            Health::Well => {
                self.calls = 0;
                false
            }
            Health::Ill => {
                self.calls += 1;
                let passes = self.came_at.is_some_and(|at| now.saturating_sub(at) < LATELY);
                !passes || self.calls >= CALLS
            }
        }
    }

    /// There is another router, of which nothing is known yet.
    pub(super) const fn renew(&mut self) {
        (self.came_at, self.calls) = (None, 0);
    }
}

/// Whether it is the router that takes so many bytes more than usual, having been given so many under so many filters, by so many
/// clients.
pub(super) const fn is_greedy(more: usize, fed: u64, (filters, clients): (usize, usize)) -> bool {
    let room = filters.saturating_mul(OF_FILTER).saturating_add(clients.saturating_mul(OF_CLIENT));
    more > APPETITE && fed > MEAL && room > APPETITE
}

/// The memory that the program has in use, in bytes, where the system tells (Linux does); `None`: the system does not tell.
pub(super) fn memory_in_use() -> Option<usize> {
    resident(&std::fs::read_to_string(STATUS).ok()?)
}

fn resident(status: &str) -> Option<usize> {
    let line = status.lines().find_map(|line| line.strip_prefix(RESIDENT))?;
    let kibibytes: usize = line.trim().strip_suffix(" kB")?.parse().ok()?;
    kibibytes.checked_mul(1024)
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: Duration = Duration::from_secs(100);

    /// Safety A5, S9: crowds of connections, at whichever door, do not send the others away.
    #[test]
    fn a_router_that_was_given_little_does_not_take_too_much() {
        let many = (1000, 10);
        assert!(is_greedy(APPETITE + 1, MEAL + 1, many));
        assert!(!is_greedy(10 * APPETITE, MEAL, many) && !is_greedy(APPETITE, 10 * MEAL, many));
    }

    /// Safety A5: what a large hall takes is not the router's, however long its changes are published for the screens of a site.
    #[test]
    fn a_router_that_has_room_for_little_does_not_take_too_much() {
        let (more, fed) = (100 * APPETITE, 100 * MEAL);
        assert!(!is_greedy(more, fed, (20, 60)) && !is_greedy(more, fed, (2, 100)));
        assert!(is_greedy(more, fed, (60, 60)), "each of sixty clients follows what nobody else does");
    }

    #[test]
    fn a_router_out_of_which_nothing_comes_is_ill_when_it_is_called_so() {
        let mut suspicion = Suspicion::default();
        assert!(suspicion.handle_told(Health::Ill, NOW));
        suspicion.handle_came(7, NOW);
        suspicion.handle_came(7, NOW + LATELY);
        assert!(suspicion.handle_told(Health::Ill, NOW + LATELY));
    }

    #[test]
    fn a_router_that_passes_messages_on_is_ill_only_when_it_is_called_so_again_and_again() {
        let mut suspicion = Suspicion::default();
        suspicion.handle_came(7, NOW);
        for _ in 0..2 {
            assert!((1..CALLS).all(|_| !suspicion.handle_told(Health::Ill, NOW)));
            assert!(!suspicion.handle_told(Health::Well, NOW));
        }
        assert!((1..CALLS).all(|_| !suspicion.handle_told(Health::Ill, NOW)));
        assert!(suspicion.handle_told(Health::Ill, NOW));
        suspicion.renew();
        suspicion.handle_came(8, NOW);
        assert!(!suspicion.handle_told(Health::Ill, NOW), "that is another router");
        suspicion.renew();
        assert!(suspicion.handle_told(Health::Ill, NOW), "nothing has come out of this one");
    }

    #[test]
    fn the_memory_in_use_is_read_as_linux_writes_it_and_nothing_else_is() {
        assert_eq!(resident("VmPeak:\t  9000 kB\nVmRSS:\t   8123 kB\nThreads:\t1\n"), Some(8123 * 1024));
        for strange in
            ["", "VmRSS:", "VmRSS: many kB", "VmRSS: 8 MB", "VmRSS: 99999999999999999999 kB", "VmRSS: 18446744073709551615 kB"]
        {
            assert_eq!(resident(strange), None, "{strange}");
        }
    }
}
