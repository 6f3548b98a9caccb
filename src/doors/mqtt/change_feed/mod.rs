//! Decides which message is published next, and when. It compares the newest state with what was published before.
//! The owner of the connection polls only when it can send a message, because a returned message counts as sent.
//! Sockets, clocks and acknowledgements are elsewhere. The last will `offline`, which a broker publishes when the
//! connection is lost, is not here either.

mod events;
mod home_assistant_feed;
mod old;
mod photos;
mod pieces;
mod states;
#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::time::Duration;

pub use self::photos::{PHOTO_MOST, Picture};

use self::events::Events;
use self::home_assistant_feed::HomeAssistantFeed;
use self::old::Old;
use self::states::States;
use super::publication::Publication;
use super::qak::outgoing;
use super::topics::Topics;
use crate::api::resources::ResourceKind;
use hallsweep_core::event::Photo;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::world::resource::Resource;

/// Payload on the availability topic while the program runs.
pub const ONLINE: &str = "online";

/// Payload on the availability topic while the program does not run. The session's last will and its last message
/// have this payload.
pub const OFFLINE: &str = "offline";

/// Selects the messages to publish. All times are measured from the start of the caller's clock.
pub struct ChangeFeed {
    topics: Topics,
    snapshot: Option<Arc<Snapshot>>,
    is_announced: bool,
    states: States,
    events: Events,
    /// `None` for a further hall, which has no old topics.
    old: Option<Old>,
    home_assistant_feed: Option<HomeAssistantFeed>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    Availability,
    Old,
    Event,
    State(Resource),
    HomeAssistant,
}

impl ChangeFeed {
    /// Creates a feed that publishes nothing before the first call of `handle_state`.
    pub fn new(topics: Topics, home_assistant: bool) -> ChangeFeed {
        ChangeFeed {
            home_assistant_feed: home_assistant.then(|| HomeAssistantFeed::new(&topics)),
            old: topics.has_old().then(Old::default),
            topics,
            snapshot: None,
            is_announced: false,
            states: States::default(),
            events: Events::default(),
        }
    }

    /// Takes a newer state. An older state that was not published yet is skipped. Luggage is the exception: every
    /// changed piece is published.
    pub fn handle_state(&mut self, snapshot: Arc<Snapshot>) {
        let older = self.snapshot.as_deref();
        if let Some(old) = &mut self.old {
            old.handle_state(older, &snapshot);
        }
        if let Some(home_assistant_feed) = &mut self.home_assistant_feed {
            home_assistant_feed.handle_state(older, &snapshot);
        }
        self.snapshot = Some(snapshot);
    }

    /// Returns the next message to send, or `None` if no message is due at `now`. Of several due messages, the one
    /// that has waited longest comes first. A returned message counts as sent, so call this only when a message can
    /// be sent.
    pub fn poll_publication(&mut self, now: Duration) -> Option<Publication> {
        let snapshot = Arc::clone(self.snapshot.as_ref()?);
        let (due, source) = self.soonest(&snapshot)?;
        if due > now {
            return None;
        }
        let topics = &self.topics;
        match source {
            Source::Availability => {
                self.is_announced = true;
                Some(Publication::kept(topics.availability(), ONLINE))
            }
            Source::Old => {
                let message = self.old.as_mut()?.take(&snapshot, now)?;
                Some(Publication::passing(topics.old_events(), message))
            }
            Source::Event => {
                let line = self.events.take(&snapshot)?;
                Some(Publication::passing(topics.event(), line).json_of(snapshot.revision.0))
            }
            Source::State(resource) => {
                let state = self.states.take(resource, &snapshot, now);
                let revision = ResourceKind::Of(resource).revision(&snapshot);
                Some(Publication::kept(topics.state(resource), state).json_of(revision.0))
            }
            Source::HomeAssistant => self.home_assistant_feed.as_mut()?.take(topics, now),
        }
    }

    /// Returns when the next message is due. This time may be in the past. Returns `None` when everything is
    /// published.
    pub fn poll_timeout(&self) -> Option<Duration> {
        self.soonest(self.snapshot.as_ref()?).map(|(due, _)| due)
    }

    /// Call this when a new connection begins. Everything that a broker retains is published again, and so is the
    /// newest version of each item for old clients. `unacknowledged` is the number of numbered messages (see
    /// `is_numbered`) that the previous connection left unacknowledged. These messages count as never sent: their
    /// numbers are used again, so that subscribers see no gap, and their luggage is published again. Event lines are
    /// not repeated.
    pub fn renew(&mut self, unacknowledged: u64) {
        self.is_announced = false;
        self.states.renew();
        if let Some(old) = &mut self.old {
            old.renew(unacknowledged, self.snapshot.as_deref());
        }
        if let Some(home_assistant_feed) = &mut self.home_assistant_feed {
            home_assistant_feed.renew();
        }
    }

    /// Whether this is a message for old clients with a counted SEQNUM. `renew` needs the number of unacknowledged
    /// messages of this kind.
    pub fn is_numbered(&self, publication: &Publication) -> bool {
        publication.topic == self.topics.old_events() && outgoing::is_counted(&publication.payload)
    }

    /// Call this when Home Assistant has started. The description is then published again.
    pub fn handle_birth(&mut self) {
        if let Some(home_assistant_feed) = &mut self.home_assistant_feed {
            home_assistant_feed.handle_birth();
        }
    }

    /// Returns a photo to publish; each photo is returned only once. The caller reads the photo from the archive,
    /// where blocking is allowed, and passes it to `handle_photo`. A photo that cannot be read is not passed. `renew`
    /// makes a photo that was never passed available again.
    pub fn poll_photo(&mut self) -> Option<Picture> {
        self.home_assistant_feed.as_mut()?.photos.poll()
    }

    /// Takes the photo that `poll_photo` returned; returns whether it will be published. It is not published if there
    /// is a newer photo by now, or if it is larger than `PHOTO_MOST`.
    pub fn handle_photo(&mut self, picture: Picture, photo: Photo) -> bool {
        self.home_assistant_feed.as_mut().is_some_and(|home_assistant_feed| home_assistant_feed.photos.handle(picture, photo))
    }

    /// Returns which source has the message that is due first, and when it is due. If two times are equal, the source
    /// listed first in this function wins.
    fn soonest(&self, snapshot: &Snapshot) -> Option<(Duration, Source)> {
        let availability = (!self.is_announced).then_some((Duration::ZERO, Source::Availability));
        let old = self.old.as_ref().and_then(|old| old.due(snapshot)).map(|due| (due, Source::Old));
        let event = self.events.due(snapshot).map(|due| (due, Source::Event));
        let state = |resource| Some((self.states.due(resource, snapshot)?, Source::State(resource)));
        let home_assistant_feed =
            self.home_assistant_feed.as_ref().and_then(HomeAssistantFeed::due).map(|due| (due, Source::HomeAssistant));
        let one_of_each = [availability, old, event, home_assistant_feed];
        one_of_each.into_iter().chain(Resource::ALL.map(state)).flatten().min_by_key(|(due, _)| *due)
    }
}
