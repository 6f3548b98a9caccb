//! Decides what becomes of a message on each topic, and who receives it.

use std::sync::Arc;
use std::time::Duration;

use super::Ended;
use crate::Broker;
use crate::filter::{self, Unfit};
use crate::frame::Malformed;
use crate::limits::{LONG, PIECE, PROPERTIES};
use crate::message::{Message, SubscriberId};
use crate::packet::reason::Reason;
use crate::packet::text;
use crate::readers::TopicReaders;
use crate::rights::{Scope, Tier};
use crate::subscriber::Subscriber;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Route {
    Pass,
    /// The topic may carry a command; the listener decides.
    Hear,
    /// The message is acknowledged, but nobody receives it.
    Drop(Dropped),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum Dropped {
    #[error("the sender may not publish on this topic")]
    Forbidden,
    #[error(transparent)]
    Unfit(Unfit),
    #[error("the properties of the message are longer than {PROPERTIES} bytes")]
    Properties,
}

impl Dropped {
    pub(super) const fn reason(self) -> Reason {
        match self {
            Dropped::Forbidden => Reason::NotAuthorized,
            Dropped::Unfit(_) => Reason::Topic,
            Dropped::Properties => Reason::Quota,
        }
    }
}

/// The latest topic and its route. They are cached because many clients publish on one topic only.
#[derive(Debug)]
pub(super) struct Routes {
    topic: Arc<str>,
    route: Option<Route>,
    /// The generation in which the topic was judged.
    judged: u64,
    /// The topic's readers, as of `generation`.
    readers: TopicReaders,
    generation: Option<u64>,
    /// Whether messages were sent since the last check for readers that lag behind.
    is_unsettled: bool,
    /// Number of messages passed on since the last `take_passed`. A long message counts more than once ([`LONG`]).
    passed: u64,
    piece: usize,
    /// Readers that lagged behind after a message was sent to them.
    behind: Vec<Arc<Subscriber>>,
}

impl Default for Routes {
    fn default() -> Routes {
        Routes {
            topic: Arc::from(""),
            route: None,
            judged: 0,
            readers: TopicReaders::default(),
            generation: None,
            is_unsettled: false,
            passed: 0,
            piece: 0,
            behind: Vec::new(),
        }
    }
}

impl Routes {
    pub(super) fn route(&mut self, topic: &[u8], who: Tier, scope: &Scope, broker: &Broker) -> Result<Route, Ended> {
        let generation = broker.readers.generation();
        if let Some(route) = self.route.filter(|_| self.judged == generation && self.topic.as_bytes() == topic) {
            return Ok(route);
        }
        self.settle();
        let topic = text(topic, "topic")?;
        let route = judge(topic, who, scope, broker)?;
        (self.topic, self.route, self.judged, self.generation) = (Arc::from(topic), Some(route), generation, None);
        Ok(route)
    }

    pub(super) fn topic(&self) -> Arc<str> {
        Arc::clone(&self.topic)
    }

    pub(super) fn is_read(&mut self, publisher: SubscriberId, broker: &Broker) -> bool {
        let generation = broker.readers.generation();
        if self.generation != Some(generation) {
            self.settle();
            (self.readers, self.generation) = (broker.readers.of(&self.topic, Some(publisher)), Some(generation));
        }
        !self.readers.is_empty()
    }

    pub(super) fn send(&mut self, message: &Arc<Message>, publisher: SubscriberId, broker: &Broker) {
        if !self.is_read(publisher, broker) {
            return;
        }
        broker.send(message, &self.readers);
        self.passed += 1 + ((message.payload().len() + message.properties().len()) / LONG) as u64;
        self.piece += message.cost();
        self.is_unsettled = true;
    }

    /// Checks which readers of the last messages lag behind. This takes the readers' locks, so it is done only once
    /// per topic or turn.
    pub(super) fn settle(&mut self) {
        if !std::mem::take(&mut self.is_unsettled) {
            return;
        }
        for reader in self.readers.all().filter(|reader| reader.subscriber.lags()) {
            if !self.behind.iter().any(|known| Arc::ptr_eq(known, &reader.subscriber)) {
                self.behind.push(Arc::clone(&reader.subscriber));
            }
        }
    }

    /// Whether at least `PIECE` bytes were passed on since this last returned true. If so, check which readers lag
    /// behind.
    pub(super) const fn take_piece(&mut self) -> bool {
        let is_piece = self.piece >= PIECE;
        if is_piece {
            self.piece = 0;
        }
        is_piece
    }

    pub(super) fn take_passed(&mut self) -> u64 {
        std::mem::take(&mut self.passed)
    }

    pub(super) fn behind(&mut self, now: Duration) -> Vec<Arc<Subscriber>> {
        self.behind.retain(|reader| reader.is_behind(now));
        self.behind.clone()
    }
}

fn judge(topic: &str, who: Tier, scope: &Scope, broker: &Broker) -> Result<Route, Ended> {
    if topic.is_empty() || topic.contains(['+', '#']) {
        return Err(Malformed::Topic.into());
    }
    // Decided before the rights, so that the answer is the same whatever the topic is for.
    if !scope.contains(topic) {
        return Ok(Route::Drop(Dropped::Forbidden));
    }
    if broker.rights.is_for_commands(topic) {
        return Ok(Route::Hear);
    }
    if !broker.rights.may_publish(who, topic) {
        return Ok(Route::Drop(Dropped::Forbidden));
    }
    Ok(filter::topic(topic).map_or_else(|unfit| Route::Drop(Dropped::Unfit(unfit)), |()| Route::Pass))
}
