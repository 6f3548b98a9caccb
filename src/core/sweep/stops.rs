//! The answers to STOP: each waits for the robot to stand, but never for long (safety S8). The halt itself waits for nothing; it
//! went out before.

use std::time::Duration;

use super::Sweep;
use crate::core::units::Ticket;

/// So long the answer to a stop waits for the robot to say that it stands.
const PATIENCE: Duration = Duration::from_millis(100);

/// The stops that are not answered yet, and what waits for them.
#[derive(Clone, Debug, Default)]
pub(super) struct Stops {
    /// Oldest first, each with when it is answered at the latest. Bounded by the places of the doors: each is somebody's who waits.
    waiting: Vec<(Ticket, Duration)>,
    /// When the next order may be looked for that was put off for the sake of an answer.
    put_off: Option<Duration>,
}

impl Stops {
    /// When `handle_timeout` is needed.
    pub(super) fn due(&self) -> Option<Duration> {
        self.waiting.first().map(|(_, due)| *due).into_iter().chain(self.put_off).min()
    }
}

impl Sweep {
    /// Answers a stop as soon as the robot stands.
    pub(super) fn answer_standing(&mut self, ticket: Ticket) {
        if self.helm.is_halting() {
            self.stops.waiting.push((ticket, self.now.since_start.saturating_add(PATIENCE)));
        } else {
            self.answer(ticket, None);
        }
    }

    /// Gives the next order, if there is one to give. When stops are answered because the robot stands, that is put off, so that
    /// the revision of their answers is one in which it does.
    pub(super) fn go_on(&mut self) {
        self.stops.put_off = None;
        if self.stops.waiting.is_empty() || self.helm.is_halting() {
            return self.pump();
        }
        self.stops.put_off = Some(self.now.since_start);
        for (ticket, _) in std::mem::take(&mut self.stops.waiting) {
            self.answer(ticket, None);
        }
    }

    /// Answers the stops that have waited long enough for a robot that does not stand.
    pub(super) fn answer_overdue_stops(&mut self) {
        let now = self.now.since_start;
        let overdue = self.stops.waiting.iter().take_while(|(_, due)| *due <= now).count();
        for (ticket, _) in self.stops.waiting.drain(..overdue).collect::<Vec<_>>() {
            self.answer(ticket, None);
        }
    }
}
