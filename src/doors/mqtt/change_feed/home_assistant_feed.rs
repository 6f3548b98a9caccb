//! Publishes the messages that only Home Assistant needs: the description of the robot, its state as a vacuum
//! cleaner, and the last photo. The contents of these messages are in `home_assistant`.

use std::time::Duration;

use bytes::Bytes;

use super::super::home_assistant::{self, discovery};
use super::super::publication::Publication;
use super::super::topics::Topics;
use super::photos::Photos;
use hallsweep_core::snapshot::Snapshot;

/// Minimum time between two messages with the robot's state.
const PACE: Duration = Duration::from_millis(100);

pub(super) struct HomeAssistantFeed {
    pub(super) photos: Photos,
    config: Bytes,
    is_introduced: bool,
    state: Option<home_assistant::State>,
    said: Option<home_assistant::State>,
    next: Duration,
}

impl HomeAssistantFeed {
    pub(super) fn new(topics: &Topics) -> HomeAssistantFeed {
        HomeAssistantFeed {
            photos: Photos::default(),
            config: discovery::config(topics, env!("CARGO_PKG_VERSION")).to_string().into(),
            is_introduced: false,
            state: None,
            said: None,
            next: Duration::ZERO,
        }
    }

    pub(super) fn handle_state(&mut self, older: Option<&Snapshot>, newer: &Snapshot) {
        self.state = Some(home_assistant::state(newer));
        self.photos.handle_state(older, newer);
    }

    /// Call this when Home Assistant has started. The description is then published again.
    pub(super) const fn handle_birth(&mut self) {
        self.is_introduced = false;
    }

    pub(super) fn due(&self) -> Option<Duration> {
        if !self.is_introduced || self.photos.is_due {
            return Some(Duration::ZERO);
        }
        (self.state != self.said).then_some(self.next)
    }

    pub(super) fn take(&mut self, topics: &Topics, now: Duration) -> Option<Publication> {
        if !self.is_introduced {
            self.is_introduced = true;
            return Some(Publication::kept(topics.discovery(), self.config.clone()));
        }
        if self.photos.is_due {
            return self.photos.take().map(|photo| Publication::kept(topics.photo(), photo));
        }
        self.said = self.state;
        self.next = now + PACE;
        self.state.map(|state| Publication::kept(topics.home_assistant(), state.json().to_string()))
    }

    pub(super) fn renew(&mut self) {
        self.is_introduced = false;
        self.said = None;
        self.photos.renew();
    }
}
