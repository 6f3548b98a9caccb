//! That there is a newer state: said to the loop of the door, and not too often, and told to the endpoint. What is new in it is
//! found out there.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::watch;

use super::application::{self, Application};
use crate::runtime::clock::Clock;
use coap_endpoint::{Answer, Endpoint, limits::PACE};
use hallsweep_core::world::snapshot::Snapshot;

pub(super) struct ChangeFeed {
    states: watch::Receiver<Arc<Snapshot>>,
    clock: Clock,
    /// Until then nothing is said; `None` once that is over.
    next: Option<Duration>,
}

impl ChangeFeed {
    pub(super) fn of(states: watch::Receiver<Arc<Snapshot>>, clock: Clock) -> ChangeFeed {
        ChangeFeed { states, clock, next: None }
    }

    /// Waits for a state that is newer than at the last time; for ever, when none will come. May be dropped while it waits.
    pub(super) async fn next(&mut self) {
        if self.next.is_some() {
            self.clock.reach(self.next).await;
            self.next = None;
        }
        if self.states.changed().await.is_err() {
            std::future::pending::<()>().await;
        }
        self.next = Some(self.clock.since_start() + PACE);
    }

    /// Says it once more when this answer is observed: it was looked up before, and may have changed since.
    pub(super) fn again_for(&mut self, answer: &Answer) {
        if !answer.observed.is_empty() {
            self.states.mark_changed();
        }
    }
}

/// Tells the endpoint what the observers of each subject see now.
pub(super) fn tell(endpoint: &mut Endpoint, application: &impl Application, now: Duration) {
    application::changed(application);
    for (subject, request) in endpoint.subjects() {
        if let Some(things) = application::things(application, &request) {
            endpoint.handle_change(subject, things, now);
        }
    }
}
