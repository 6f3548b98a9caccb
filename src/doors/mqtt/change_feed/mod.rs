//! Decides what is published, and when: it compares the newest state with what was published. Whoever holds the connection
//! polls it only when a message can be sent, so that a returned message counts as sent. Sockets, clocks and acknowledgements
//! are not here. The last will `offline`, which a broker publishes when the connection is lost, is not here either.

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

/// Payload on the availability topic when the program does not run: the session's last will, and its last message.
pub const OFFLINE: &str = "offline";

/// All times passed in and returned are since the door was made.
pub struct ChangeFeed {
    topics: Topics,
    snapshot: Option<Arc<Snapshot>>,
    is_announced: bool,
    states: States,
    events: Events,
    old: Old,
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
    /// Publishes nothing before the first state.
    pub fn new(topics: Topics, home_assistant: bool) -> ChangeFeed {
        ChangeFeed {
            home_assistant_feed: home_assistant.then(|| HomeAssistantFeed::new(&topics)),
            topics,
            snapshot: None,
            is_announced: false,
            states: States::default(),
            events: Events::default(),
            old: Old::default(),
        }
    }

    /// Takes a newer state, which replaces an unpublished one. But of luggage every changed piece is published.
    pub fn handle_state(&mut self, snapshot: Arc<Snapshot>) {
        let older = self.snapshot.as_deref();
        self.old.handle_state(older, &snapshot);
        if let Some(home_assistant_feed) = &mut self.home_assistant_feed {
            home_assistant_feed.handle_state(older, &snapshot);
        }
        self.snapshot = Some(snapshot);
    }

    /// The next message to send, or `None` when none is due before `poll_timeout`. Among several due messages it is the one
    /// that waited longest. A returned message counts as sent, so poll only when it can be sent.
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
            Source::Old => self.old.take(&snapshot, now).map(|message| Publication::passing(topics.old_events(), message)),
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

    /// When the next message is due; the time may be in the past. `None` when everything is published.
    pub fn poll_timeout(&self) -> Option<Duration> {
        self.soonest(self.snapshot.as_ref()?).map(|(due, _)| due)
    }

    /// A new connection begins. Everything that a broker retains is published again, and the newest version of each old item.
    /// Of the old messages with a counted number (`is_numbered`), the last `unacknowledged` were not acknowledged on the
    /// previous connection. They count as never sent: their numbers are used again, so that subscribers see no gap, and their
    /// luggage is published again. Event lines are not repeated.
    pub fn renew(&mut self, unacknowledged: u64) {
        self.is_announced = false;
        self.states.renew();
        self.old.renew(unacknowledged, self.snapshot.as_deref());
        if let Some(home_assistant_feed) = &mut self.home_assistant_feed {
            home_assistant_feed.renew();
        }
    }

    /// Whether this is an old message with our SEQNUM. `renew` needs the number of unacknowledged messages of this kind.
    pub fn is_numbered(&self, publication: &Publication) -> bool {
        publication.topic == self.topics.old_events() && outgoing::is_counted(&publication.payload)
    }

    /// Home Assistant has started, so the description is published again.
    pub fn handle_birth(&mut self) {
        if let Some(home_assistant_feed) = &mut self.home_assistant_feed {
            home_assistant_feed.handle_birth();
        }
    }

    /// A photo that should be published and was not requested before. The caller reads it from the archive where blocking is
    /// allowed, one at a time, and passes it to `handle_photo`; a photo that cannot be read is not passed. A photo is requested
    /// once. If it was never passed, it is requested again after `renew`.
    pub fn poll_photo(&mut self) -> Option<Picture> {
        self.home_assistant_feed.as_mut()?.photos.poll()
    }

    /// Takes the requested photo; returns whether it will be published. A photo is not published if there is a newer one by
    /// now, or if it is larger than `PHOTO_MOST`.
    pub fn handle_photo(&mut self, picture: Picture, photo: Photo) -> bool {
        self.home_assistant_feed.as_mut().is_some_and(|home_assistant_feed| home_assistant_feed.photos.handle(picture, photo))
    }

    /// The source that is due first, and when. Among equal times, the first in the order here.
    fn soonest(&self, snapshot: &Snapshot) -> Option<(Duration, Source)> {
        let availability = (!self.is_announced).then_some((Duration::ZERO, Source::Availability));
        let old = self.old.due(snapshot).map(|due| (due, Source::Old));
        let event = self.events.due(snapshot).map(|due| (due, Source::Event));
        let state = |resource| Some((self.states.due(resource, snapshot)?, Source::State(resource)));
        let home_assistant_feed =
            self.home_assistant_feed.as_ref().and_then(HomeAssistantFeed::due).map(|due| (due, Source::HomeAssistant));
        let one_of_each = [availability, old, event, home_assistant_feed];
        one_of_each.into_iter().chain(Resource::ALL.map(state)).flatten().min_by_key(|(due, _)| *due)
    }
}
