//! Delivers a message through a router outside this crate. A router may be slow, lose messages or fail. When a
//! delivery is dropped, all readers that it has not reached get the message. So no reader misses a message.

use std::fmt::Debug;
use std::sync::Arc;

use crate::message::Message;
use crate::subscriber::{Delivery, Subscriber, TopicReader};

/// Carries messages to subscribers. No method may block.
pub trait Router: Debug + Send + Sync {
    /// Begins to deliver messages to this subscriber, on all topics that the filter matches. Not called for shared
    /// filters.
    fn subscribe(&self, filter: &str, subscriber: &Arc<Subscriber>);

    /// Ends the deliveries that `subscribe` began for this filter and subscriber. Messages on their way may still
    /// arrive.
    fn unsubscribe(&self, filter: &str, subscriber: &Arc<Subscriber>);

    /// Delivers a message: [`RoutedDelivery::arrive`] passes it to one reader, and dropping the delivery passes it to
    /// all remaining readers.
    fn carry(&self, delivery: RoutedDelivery);
}

/// A message on its way to its readers. When the delivery is dropped, all readers that it has not reached get the
/// message.
#[derive(Debug)]
pub struct RoutedDelivery {
    message: Arc<Message>,
    /// Readers that the message has not reached yet.
    readers: Vec<TopicReader>,
    /// Whether the message may wait for a subscriber that is away.
    has_room: bool,
}

impl RoutedDelivery {
    /// Begins the delivery. From now on the message counts as waiting for its readers, since flooding publishers wait
    /// for readers that lag behind.
    pub(crate) fn begin(message: Arc<Message>, readers: &[TopicReader], has_room: bool) -> RoutedDelivery {
        for reader in readers {
            reader.subscriber.expect(&message);
        }
        RoutedDelivery { message, readers: readers.to_vec(), has_room }
    }

    /// The topic, by which a router finds the subscribers.
    #[must_use]
    pub fn topic(&self) -> &str {
        self.message.topic()
    }

    /// Delivers the message to this subscriber. Does nothing if the subscriber already has the message, or is not one
    /// of the message's readers.
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
