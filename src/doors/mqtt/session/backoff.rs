//! The pauses between attempts to connect. The pauses grow with each failure. They are random, so that many robots do
//! not return to a broker at the same moment. Nothing waits here.

use std::time::Duration;

use super::times::Times;
use hallsweep_core::rng::RandomStream;

#[derive(Debug)]
pub(super) struct Backoff {
    shortest: Duration,
    longest: Duration,
    /// Upper bound of the next pause. Each failure doubles it, up to `longest`.
    bound: Duration,
    chance: RandomStream,
}

impl Backoff {
    pub(super) fn new(times: &Times, chance: RandomStream) -> Backoff {
        let (shortest, longest) = (times.shortest_pause, times.longest_pause);
        Backoff { shortest, longest, bound: shortest, chance }
    }

    /// Returns the pause after a connection or a failed attempt that took `lasted`. The time of a failed attempt
    /// counts as part of the pause. So a broker whose machine was off is found about as soon as a broker that refused
    /// each attempt at once.
    pub(super) fn handle_ended(&mut self, lasted: Duration, was_open: bool) -> Duration {
        if was_open && lasted >= self.longest {
            self.bound = self.shortest;
        }
        self.bound = (self.bound * 2).min(self.longest);
        let pause = self.shortest + self.bound.saturating_sub(self.shortest).mul_f64(self.chance.fraction());
        if was_open { pause } else { pause.saturating_sub(lasted).max(self.shortest) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const AT_ONCE: Duration = Duration::ZERO;

    fn backoff() -> (Backoff, Times) {
        let times = Times::default();
        (Backoff::new(&times, RandomStream::new(7, "test")), times)
    }

    #[test]
    fn pauses_grow_from_the_shortest_to_the_longest_and_are_spread() {
        let (mut backoff, times) = backoff();
        let first = backoff.handle_ended(AT_ONCE, false);
        assert!(first >= times.shortest_pause && first <= 2 * times.shortest_pause, "{first:?}");
        let later: Vec<_> = (0..1000).map(|_| backoff.handle_ended(AT_ONCE, false)).collect();
        assert!(later.iter().all(|pause| *pause >= times.shortest_pause && *pause <= times.longest_pause));
        assert!(later.iter().any(|pause| *pause > times.longest_pause.mul_f64(0.9)), "it reaches the longest");
        assert!(later[10..].iter().any(|pause| *pause < times.longest_pause.mul_f64(0.2)), "it is spread");
    }

    #[test]
    fn a_connection_that_lasted_is_a_new_beginning_and_a_short_one_is_not() {
        let (mut backoff, times) = backoff();
        assert_eq!((0..10).map(|_| backoff.handle_ended(AT_ONCE, false)).count(), 10);
        backoff.handle_ended(times.longest_pause / 2, true);
        assert_eq!(backoff.bound, times.longest_pause);
        let pause = backoff.handle_ended(times.longest_pause, true);
        assert!(pause <= 2 * times.shortest_pause, "{pause:?}");
    }

    #[test]
    fn what_an_attempt_took_is_part_of_the_pause() {
        let (mut backoff, times) = backoff();
        let after: Vec<_> = (0..20).map(|_| backoff.handle_ended(times.greeting, false)).collect();
        assert!(after.iter().all(|pause| *pause == times.shortest_pause), "{after:?}");
    }
}
