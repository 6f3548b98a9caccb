//! Computes simulated time from real time and the simulator's controls. The speed of simulated time may change. It
//! may be paused except for a step, and it may jump.

use std::time::Duration;

use super::remote::Controls;
use hallsweep_core::speed::{Speed, times};

/// Maximum length of a timer. When it ends, the link checks its state again.
const LONGEST_WAIT: Duration = Duration::from_secs(3600);

#[derive(Clone, Copy, Debug)]
pub(super) struct SimTime {
    /// Speed while the controls set no speed.
    usual_speed: Speed,
    speed: Speed,
    is_paused: bool,
    /// Whether the simulator makes a step: time is paused, but first runs until the actions under way are done.
    is_stepping: bool,
    /// A real time, and the simulated time at that moment.
    real: Duration,
    simulated: Duration,
}

impl SimTime {
    pub(super) const fn begin(speed: Speed, real: Duration) -> SimTime {
        SimTime { usual_speed: speed, speed, is_paused: false, is_stepping: false, real, simulated: Duration::ZERO }
    }

    /// Starts again from zero, because another hall begins its own time. Time stays running or paused as it was.
    pub(super) fn begin_again(&mut self, real: Duration) {
        *self = SimTime { is_stepping: false, real, simulated: Duration::ZERO, ..*self };
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

    /// Applies the controls from now on; `before` are the previous controls. Returns whether the speed or the pause
    /// changed.
    pub(super) fn obey(&mut self, controls: &Controls, before: &Controls, real: Duration) -> bool {
        let (speed, is_paused) = (controls.speed.unwrap_or(self.usual_speed), controls.is_paused);
        let is_news = (self.speed, self.is_paused) != (speed, is_paused);
        let is_stepping = is_paused && (self.is_stepping || controls.steps != before.steps);
        *self = SimTime { speed, is_paused, is_stepping, real, simulated: self.at(real), ..*self };
        is_news
    }

    pub(super) fn jumps(&self) -> bool {
        self.is_stepping || self.speed == Speed::Max && !self.is_paused
    }

    pub(super) const fn end_step(&mut self) {
        self.is_stepping = false;
    }

    /// Jumps to a simulated time. Nothing may happen before this time.
    pub(super) fn jump_to(&mut self, simulated: Duration, real: Duration) {
        *self = SimTime { real, simulated: simulated.max(self.at(real)), ..*self };
    }

    /// The real time of a simulated moment, or an earlier time at which to check again. If there is no such moment,
    /// it is the time of the next check.
    pub(super) fn comes(&self, simulated: Option<Duration>, real: Duration) -> Duration {
        let wait = simulated.and_then(|at| self.until(at, real));
        real + wait.unwrap_or(LONGEST_WAIT).min(LONGEST_WAIT)
    }

    /// Real time until a simulated moment; `None` while time is paused.
    fn until(&self, simulated: Duration, real: Duration) -> Option<Duration> {
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
        let runs = Controls { speed: Some(Speed::Times(2.0)), ..Controls::default() };
        let stands = Controls { is_paused: true, ..runs.clone() };
        assert!(time.obey(&stands, &runs, s(15)) && time.is_paused() && !time.jumps());
        assert_eq!((time.at(s(1000)), time.until(s(30), s(1000))), (s(10), None));
        time.jump_to(s(12), s(1000));
        time.jump_to(s(3), s(1000));
        assert_eq!(time.at(s(2000)), s(12));
        let faster = Controls { speed: Some(Speed::Times(4.0)), ..Controls::default() };
        assert!(time.obey(&faster, &stands, s(2000)));
        assert!(!time.obey(&faster, &faster, s(2001)), "it runs so already");
        assert_eq!(time.at(s(2010)), s(52));
        time.begin_again(s(2010));
        assert_eq!((time.at(s(2011)), time.speed()), (s(4), Speed::Times(4.0)));
    }

    #[test]
    fn a_step_is_not_waited_for_and_ends_with_what_was_under_way() {
        let mut time = SimTime::begin(Speed::Times(1.0), s(0));
        let stands = Controls { is_paused: true, ..Controls::default() };
        let steps = Controls { steps: 1, ..stands.clone() };
        time.obey(&stands, &Controls::default(), s(1));
        assert!(!time.obey(&steps, &stands, s(2)) && time.jumps());
        time.obey(&steps, &steps, s(3));
        assert!(time.jumps(), "whatever else the controls say");
        time.end_step();
        assert!(!time.jumps());
    }
}
