//! What goes out, and when: from the newest state to the messages that say what is new in it. Whoever holds the connection polls
//! it, only when it can hand a message on, so that what was returned counts as sent. Sockets, clocks and acknowledgements are not
//! here, and neither is the last will `offline`: a broker says that, when we cannot.

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

/// What stands on the topic of availability while the program is there.
pub const ONLINE: &str = "online";

/// What a broker says there when it is not: the session's last will, and its last word.
pub const OFFLINE: &str = "offline";

/// What is still to be said. Times are those since the start of the program.
pub struct ChangeFeed {
    topics: Topics,
    snapshot: Option<Arc<Snapshot>>,
    is_announced: bool,
    states: States,
    events: Events,
    old: Old,
    home_assistant_feed: Option<HomeAssistantFeed>,
}

/// What can be new.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Source {
    Availability,
    Old,
    Event,
    State(Resource),
    HomeAssistant,
}

impl ChangeFeed {
    /// Nothing is known yet, and nothing goes out before the first state. With `home_assistant` Home Assistant is told, too.
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

    /// There is a newer state. What it shows replaces what was not said yet, but for luggage, of which every piece is said.
    pub fn handle_state(&mut self, snapshot: Arc<Snapshot>) {
        let older = self.snapshot.as_deref();
        self.old.handle_state(older, &snapshot);
        if let Some(home_assistant_feed) = &mut self.home_assistant_feed {
            home_assistant_feed.handle_state(older, &snapshot);
        }
        self.snapshot = Some(snapshot);
    }

    /// The next message to hand on, of several the one that waited longest; `None` when nothing is to be said before
    /// `poll_timeout`. What is returned counts as sent: poll only when it can be handed on.
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

    /// When the next message is due, which may be a time that is over; `None` when everything is said.
    pub fn poll_timeout(&self) -> Option<Duration> {
        self.soonest(self.snapshot.as_ref()?).map(|(due, _)| due)
    }

    /// The connection is a new one: whatever a broker keeps is said again, and the newest of each old item. Of the old messages
    /// (those that `is_numbered`) the last `unacknowledged` were not acknowledged on the connection before and count as never
    /// sent: their numbers are used again, so that whoever listens meets no gap, and their luggage is said again. Event lines are
    /// not repeated.
    pub fn renew(&mut self, unacknowledged: u64) {
        self.is_announced = false;
        self.states.renew();
        self.old.renew(unacknowledged, self.snapshot.as_deref());
        if let Some(home_assistant_feed) = &mut self.home_assistant_feed {
            home_assistant_feed.renew();
        }
    }

    /// Whether this is an old message that carries our SEQNUM: how many of these were not acknowledged is what `renew` asks for.
    pub fn is_numbered(&self, publication: &Publication) -> bool {
        publication.topic == self.topics.old_events() && outgoing::is_counted(&publication.payload)
    }

    /// Home Assistant has started: it is told of the robot again.
    pub fn handle_birth(&mut self) {
        if let Some(home_assistant_feed) = &mut self.home_assistant_feed {
            home_assistant_feed.handle_birth();
        }
    }

    /// A photo that is to be shown and was not asked for before. Reading it is the caller's business: it looks it up in the
    /// archive where blocking is allowed, one at a time, and gives it back to `handle_photo`; what cannot be read is not given
    /// back. It is asked for once, and again after `renew` if it was never given back.
    pub fn poll_photo(&mut self) -> Option<Picture> {
        self.home_assistant_feed.as_mut()?.photos.poll()
    }

    /// The photo that was asked for. It goes out unless there is a newer one to be shown by now, or it is larger than
    /// `PHOTO_MOST`; false when it does not go out.
    pub fn handle_photo(&mut self, picture: Picture, photo: Photo) -> bool {
        self.home_assistant_feed.as_mut().is_some_and(|home_assistant_feed| home_assistant_feed.photos.handle(picture, photo))
    }

    /// What is due first, and when. Of several at the same time the first in this order.
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
