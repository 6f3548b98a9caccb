//! Simulated time beside the real one: how fast it runs may change while it does, it may stand still, and it may jump.

use std::time::Duration;

use hallsweep_sim::{Speed, times};

#[derive(Clone, Copy, Debug)]
pub(super) struct SimTime {
    speed: Speed,
    is_paused: bool,
    /// A moment by the real clock, and the simulated time then.
    real: Duration,
    simulated: Duration,
}

impl SimTime {
    /// It begins at this moment of the real clock.
    pub(super) const fn begin(speed: Speed, real: Duration) -> SimTime {
        SimTime { speed, is_paused: false, real, simulated: Duration::ZERO }
    }

    pub(super) const fn speed(&self) -> Speed {
        self.speed
    }

    pub(super) const fn is_paused(&self) -> bool {
        self.is_paused
    }

    pub(super) fn at(&self, real: Duration) -> Duration {
        let pace = if self.is_paused { 0.0 } else { self.speed.pace() };
        self.simulated.saturating_add(times(real.saturating_sub(self.real), pace))
    }

    /// From now on it runs so; whether that is news.
    pub(super) fn run_at(&mut self, speed: Speed, is_paused: bool, real: Duration) -> bool {
        let is_news = (self.speed, self.is_paused) != (speed, is_paused);
        *self = SimTime { speed, is_paused, real, simulated: self.at(real) };
        is_news
    }

    /// Nothing happens in between.
    pub(super) fn jump_to(&mut self, simulated: Duration, real: Duration) {
        *self = SimTime { real, simulated: simulated.max(self.at(real)), ..*self };
    }

    /// How long a simulated moment is away, by the real clock; for ever while time stands still.
    pub(super) fn until(&self, simulated: Duration, real: Duration) -> Option<Duration> {
        let wait = simulated.saturating_sub(self.at(real));
        (!self.is_paused).then(|| times(wait, 1.0 / self.speed.pace()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn s(seconds: u64) -> Duration {
        Duration::from_secs(seconds)
    }

    #[test]
    fn it_runs_at_its_speed_stands_while_it_is_paused_and_never_goes_back() {
        let mut time = SimTime::begin(Speed::Times(2.0), s(10));
        assert_eq!((time.at(s(15)), time.until(s(30), s(15))), (s(10), Some(s(10))));
        assert!(time.run_at(Speed::Times(2.0), true, s(15)) && time.is_paused());
        assert_eq!((time.at(s(1000)), time.until(s(30), s(1000))), (s(10), None));
        time.jump_to(s(12), s(1000));
        time.jump_to(s(3), s(1000));
        assert_eq!(time.at(s(2000)), s(12));
        assert!(time.run_at(Speed::Times(4.0), false, s(2000)));
        assert!(!time.run_at(Speed::Times(4.0), false, s(2001)), "it runs so already");
        assert_eq!(time.at(s(2010)), s(52));
    }
}
