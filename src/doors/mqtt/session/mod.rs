//! Publishes new messages: at our own broker in the same process (`own`), or at another broker as a client. At
//! another broker it also receives commands. If the connection is lost, it connects again until the program ends.
//! Messages come from `change_feed`, commands go to `commands`.

mod backoff;
mod connection_task;
mod conversation;
mod event;
mod five;
mod inflight;
mod kept;
mod link;
mod lost;
mod own;
mod photos;
#[cfg(test)]
pub(super) mod testing;
#[cfg(test)]
mod tests;
mod three;
mod times;
mod tls;
mod transport;

pub use link::SessionLink;
pub use own::OwnSession;
pub use times::Times;
pub use tls::{TlsError, believing};

use std::collections::VecDeque;
use std::sync::Arc;

use tokio::sync::{mpsc, watch};

use super::change_feed::{ChangeFeed, OFFLINE};
use super::commands::{Commands, Publisher, ResultMessage};
use super::publication::Publication;
use super::topics::{HOME_ASSISTANT_STATUS, Topics};
use crate::doors::log_throttle::LogThrottle;
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::clock::Clock;
use backoff::Backoff;
use connection_task::ConnectionTask;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::world::resource::Resource;
use lost::Lost;
use mqtt_gate::packet::Version;

pub struct Parts {
    pub link: SessionLink,
    pub commands: Commands,
    pub topics: Topics,
    pub home_assistant: bool,
    pub states: watch::Receiver<Arc<Snapshot>>,
    pub answers: mpsc::Receiver<ResultMessage>,
    pub archive: ArchiveReader,
    pub seed: u64,
    pub times: Times,
}

pub struct Session {
    link: SessionLink,
    commands: Commands,
    publisher: Publisher,
    topics: Topics,
    home_assistant: bool,
    changes: ChangeFeed,
    states: watch::Receiver<Arc<Snapshot>>,
    answers: mpsc::Receiver<ResultMessage>,
    archive: ArchiveReader,
    /// Messages that were published on an earlier connection and may not have arrived.
    again: VecDeque<Publication>,
    /// Number of numbered messages for old clients that may not have arrived.
    unacknowledged: u64,
    backoff: Backoff,
    clock: Clock,
    times: Times,
    is_lost: bool,
    refused: LogThrottle,
}

impl Session {
    /// Creates a session. It connects only when `run` is called.
    pub fn new(parts: Parts) -> Session {
        Session {
            changes: ChangeFeed::new(parts.topics.clone(), parts.home_assistant),
            publisher: Publisher::Unknown { broker: parts.link.host.as_str().into() },
            link: parts.link,
            commands: parts.commands,
            topics: parts.topics,
            home_assistant: parts.home_assistant,
            states: parts.states,
            answers: parts.answers,
            archive: parts.archive,
            again: VecDeque::new(),
            unacknowledged: 0,
            backoff: Backoff::new(&parts.times, RandomStream::new(parts.seed, "mqtt pauses")),
            clock: Clock::default(),
            times: parts.times,
            is_lost: false,
            refused: LogThrottle::default(),
        }
    }

    /// Keeps a connection to the broker until `shutdown`. Then disconnects within a second.
    pub async fn run(mut self, shutdown: impl Future<Output = ()>) {
        tokio::pin!(shutdown);
        loop {
            let began = self.clock.now().since_start;
            let mut task = ConnectionTask::begin(&mut self);
            let lost = tokio::select! {
                () = &mut shutdown => return task.take_leave().await,
                lost = task.go_on() => lost,
            };
            let was_open = task.conversation.is_open();
            let unacknowledged = task.conversation.inflight.into_unacknowledged();
            self.handle_lost(&lost, was_open, unacknowledged);
            let lasted = self.clock.now().since_start.saturating_sub(began);
            let pause = self.backoff.handle_ended(lasted, was_open);
            tokio::select! {
                () = &mut shutdown => return,
                () = tokio::time::sleep(pause) => {}
            }
        }
    }

    /// The message that the program publishes when it ends. It is also the last will, so the broker publishes it when
    /// the connection is lost.
    fn offline(&self) -> Publication {
        Publication::kept(self.topics.availability(), OFFLINE)
    }

    fn filters(&self) -> Vec<String> {
        let status = self.home_assistant.then(|| HOME_ASSISTANT_STATUS.to_owned());
        self.topics.commands().into_iter().chain(status).collect()
    }

    /// Returns the topics of our retained messages that are watched, because other clients may replace them. With
    /// MQTT 3.1.1 we also receive our own messages, and a STOP would wait until large ones have arrived. So the
    /// topics of large messages are left out there.
    fn kept(&self) -> Vec<String> {
        let (topics, is_five) = (&self.topics, self.link.version == Version::Five);
        let is_small = |resource: &Resource| !matches!(resource, Resource::Map | Resource::Luggage | Resource::Log);
        let states =
            Resource::ALL.into_iter().filter(|resource| is_five || is_small(resource)).map(|resource| topics.state(resource));
        let told = self.home_assistant.then(|| [topics.home_assistant(), topics.discovery()]);
        let photo = (self.home_assistant && is_five).then(|| topics.photo());
        [topics.availability()].into_iter().chain(states).chain(told.into_iter().flatten()).chain(photo).collect()
    }

    fn poll_publication(&mut self) -> Option<Publication> {
        self.again.pop_front().or_else(|| self.changes.poll_publication(self.clock.now().since_start))
    }

    /// Call this when the broker has greeted us and answered our subscription. Everything is published again, as for
    /// a new subscriber.
    fn handle_open(&mut self) {
        if std::mem::take(&mut self.is_lost) {
            tracing::info!(broker = %self.link, "the MQTT broker is back");
        }
        self.learn();
        self.changes.renew(std::mem::take(&mut self.unacknowledged));
    }

    fn learn(&mut self) {
        let state = Arc::clone(&self.states.borrow_and_update());
        self.changes.handle_state(state);
    }

    /// Logs that a connection was lost. Failed attempts after that are not logged as warnings. Messages that may not
    /// have arrived are published again: `renew` publishes all retained ones, and the other ones are sent unchanged.
    fn handle_lost(&mut self, lost: &Lost, was_open: bool, unacknowledged: Vec<Publication>) {
        let (numbered, others): (Vec<_>, Vec<_>) = unacknowledged.into_iter().partition(|said| self.changes.is_numbered(said));
        self.unacknowledged += numbered.len() as u64;
        self.again.extend(others.into_iter().filter(|said| !said.retain));
        if std::mem::replace(&mut self.is_lost, true) {
            tracing::debug!(broker = %self.link, reason = %lost, "the MQTT broker still cannot be reached");
        } else {
            let what = if was_open { "is lost" } else { "cannot be reached" };
            tracing::warn!(broker = %self.link, reason = %lost, "the MQTT broker {what}; hallsweep tries again until it answers");
        }
    }
}
