//! Publishes at our own broker, in the same process. There is no connection to make or lose, and nothing to acknowledge.

use std::sync::Arc;

use tokio::sync::{mpsc, watch};

use super::super::change_feed::{ChangeFeed, OFFLINE};
use super::super::commands::ResultMessage;
use super::super::home_assistant::BIRTH;
use super::super::publication::Publication;
use super::super::topics::{HOME_ASSISTANT_STATUS, Topics};
use super::photos::{self, PhotoReading};
use crate::doors::log_throttle::LogThrottle;
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::clock::Clock;
use hallsweep_core::snapshot::Snapshot;
use mqtt_gate::packet::properties::Property;
use mqtt_gate::{Announcement, Broker, OwnSubscription};

/// The program's own session at our own broker. Commands are not received here, but at the broker's gate.
pub struct OwnSession {
    broker: Arc<Broker>,
    topics: Topics,
    changes: ChangeFeed,
    states: watch::Receiver<Arc<Snapshot>>,
    answers: mpsc::Receiver<ResultMessage>,
    archive: ArchiveReader,
    reading: PhotoReading,
    /// The subscription to Home Assistant's status. It is empty if Home Assistant is switched off.
    home_assistant_status: OwnSubscription,
    left_out: LogThrottle,
    clock: Clock,
}

impl OwnSession {
    pub fn new(
        broker: Arc<Broker>,
        topics: Topics,
        home_assistant: bool,
        states: watch::Receiver<Arc<Snapshot>>,
        answers: mpsc::Receiver<ResultMessage>,
        archive: ArchiveReader,
    ) -> OwnSession {
        let home_assistant_status = broker.subscribe(if home_assistant { &[HOME_ASSISTANT_STATUS] } else { &[] });
        let changes = ChangeFeed::new(topics.clone(), home_assistant);
        let (reading, clock) = (PhotoReading::default(), Clock::default());
        OwnSession {
            broker,
            topics,
            changes,
            states,
            answers,
            archive,
            reading,
            home_assistant_status,
            left_out: LogThrottle::default(),
            clock,
        }
    }

    /// Publishes until `shutdown`. The last message says that the program has ended.
    pub async fn run(mut self, shutdown: impl Future<Output = ()>) {
        tokio::pin!(shutdown);
        self.learn();
        loop {
            self.speak();
            let due = self.changes.poll_timeout();
            tokio::select! {
                () = &mut shutdown => break,
                Ok(()) = self.states.changed() => self.learn(),
                Some(answer) = self.answers.recv() => self.say(&answer.taken()),
                message = self.home_assistant_status.next() => {
                    if message.payload() == BIRTH {
                        self.changes.handle_birth();
                    }
                }
                looked = self.reading.done() => photos::show(&mut self.changes, looked),
                () = self.clock.reach(due) => {}
            }
        }
        while let Ok(answer) = self.answers.try_recv() {
            self.say(&answer.taken());
        }
        self.say(&Publication::kept(self.topics.availability(), OFFLINE));
    }

    fn learn(&mut self) {
        let state = Arc::clone(&self.states.borrow_and_update());
        self.changes.handle_state(state);
    }

    fn speak(&mut self) {
        self.reading.begin(&mut self.changes, &self.archive);
        while let Some(publication) = self.changes.poll_publication(self.clock.now().since_start) {
            self.say(&publication);
        }
    }

    fn say(&self, publication: &Publication) {
        let Publication { topic, payload, retain, beside } = publication;
        let publish =
            |properties: &[Property<'_>]| self.broker.publish(&Announcement { topic, payload, retain: *retain, properties });
        if !publication.fits(None) {
            if let Some(left_out) = self.left_out.one_more() {
                tracing::warn!(topic, left_out, "messages were too large to be published; the latest is on this topic");
            }
        } else if !beside.with_properties(publish) {
            tracing::warn!(topic, "there is no room for a retained message: clients that subscribe later do not receive it");
        }
    }
}
