//! The simulated operator. It acknowledges an alarm after two to six seconds, and presses START two to six seconds
//! later. An absent operator never comes.

use std::time::Duration;

use hallsweep_core::rng::RandomStream;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Deed {
    Acknowledge,
    Start,
}

#[derive(Clone, Debug)]
pub(super) struct Operator {
    random: RandomStream,
    is_there: bool,
    next: Option<(Duration, Deed)>,
}

impl Operator {
    pub(super) fn new(seed: u64, is_there: bool) -> Operator {
        Operator { random: RandomStream::new(seed, "operator"), is_there, next: None }
    }

    /// Calls the operator, who performs `deed` two to six seconds later. An absent operator does nothing.
    pub(super) fn called(&mut self, deed: Deed, now: Duration) {
        if self.is_there {
            self.next = Some((now + Duration::from_millis(2000 + self.random.below(4000)), deed));
        }
    }

    pub(super) fn due(&self) -> Option<Duration> {
        self.next.map(|(at, _)| at)
    }

    /// Returns the operator's action if it is due. Each action is returned only once.
    pub(super) fn deed(&mut self, now: Duration) -> Option<Deed> {
        self.next.take_if(|(at, _)| *at <= now).map(|(_, deed)| deed)
    }
}
