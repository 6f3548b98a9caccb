//! Delivery of a message by a router other than the gate itself. Readers whom the router has not reached get the
//! message when its delivery is dropped, so that nobody misses one: a router may be slow, lose messages or die.

use std::fmt::Debug;
use std::sync::Arc;

use crate::message::Message;
use crate::subscriber::{Delivery, Subscriber, TopicReader};

/// Carries messages to subscribers. No method may block.
pub trait Router: Debug + Send + Sync {
    /// From now on, delivers messages on topics that this filter matches to this subscriber. Not called for shared
    /// filters.
    fn subscribe(&self, filter: &str, subscriber: &Arc<Subscriber>);

    /// Ends what `subscribe` began for this pair. Messages that are on their way may still arrive.
    fn unsubscribe(&self, filter: &str, subscriber: &Arc<Subscriber>);

    /// Takes over a message: [`RoutedDelivery::arrive`] hands it to one reader, and dropping it to those that are left.
    fn carry(&self, delivery: RoutedDelivery);
}

/// A message on its way to its readers. When it is dropped, those that it has not reached get it.
#[derive(Debug)]
pub struct RoutedDelivery {
    message: Arc<Message>,
    /// Readers whom it has not reached yet.
    readers: Vec<TopicReader>,
    /// Whether it may wait for a subscriber that is away.
    has_room: bool,
}

impl RoutedDelivery {
    /// Begins the delivery. The message counts as waiting for its readers at once, since flooding publishers wait for
    /// those.
    pub(crate) fn begin(message: Arc<Message>, readers: &[TopicReader], has_room: bool) -> RoutedDelivery {
        for reader in readers {
            reader.subscriber.expect(&message);
        }
        RoutedDelivery { message, readers: readers.to_vec(), has_room }
    }

    /// The topic, by which a router finds the subscribers whose filters match.
    #[must_use]
    pub fn topic(&self) -> &str {
        self.message.topic()
    }

    /// Delivers the message to this subscriber. Nothing happens if it had it already, or is not among its readers.
    pub fn arrive(&mut self, subscriber: &Arc<Subscriber>) {
        let place = self.readers.iter().position(|reader| Arc::ptr_eq(&reader.subscriber, subscriber));
        if let Some(place) = place {
            let reader = self.readers.swap_remove(place);
            self.bring(&reader);
        }
    }

    fn bring(&self, reader: &TopicReader) {
        reader.subscriber.unexpect(&self.message);
        reader.subscriber.put(Delivery::of(&self.message, reader), || self.has_room);
    }

    /// Whether the message has reached all its readers, so that dropping it does nothing more.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.readers.is_empty()
    }
}

impl Drop for RoutedDelivery {
    fn drop(&mut self) {
        let readers = std::mem::take(&mut self.readers);
        readers.iter().for_each(|reader| self.bring(reader));
    }
}
