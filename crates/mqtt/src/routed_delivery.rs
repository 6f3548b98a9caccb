//! How a message gets to those who read it when another router than the gate itself carries it there. Whoever it has not been brought to
//! has it when the delivery is over, however that ends: a router may be slow, lose messages or die, and nobody misses anything.

use std::fmt::Debug;
use std::sync::Arc;

use crate::message::Message;
use crate::subscriber::{Delivery, Subscriber, TopicReader};

/// Carries messages to those who subscribed. Nothing here may block.
pub trait Router: Debug + Send + Sync {
    /// From now on what is published on topics that this filter matches reaches this subscriber.
    fn subscribe(&self, filter: &str, subscriber: &Arc<Subscriber>);

    /// It does not any more.
    fn unsubscribe(&self, filter: &str, subscriber: &Arc<Subscriber>);

    /// A message is to be brought to those who read it.
    fn carry(&self, delivery: RoutedDelivery);
}

/// A message on its way to those who read it.
#[derive(Debug)]
pub struct RoutedDelivery {
    message: Arc<Message>,
    /// To whom it was not brought yet.
    readers: Vec<TopicReader>,
    /// Whether it may wait for one who is away.
    has_room: bool,
}

impl RoutedDelivery {
    /// It waits for its readers from now on, as if it had come already: whoever publishes in a flood waits for those who read.
    pub(crate) fn begin(message: Arc<Message>, readers: &[TopicReader], has_room: bool) -> RoutedDelivery {
        for reader in readers {
            reader.subscriber.expect(&message);
        }
        RoutedDelivery { message, readers: readers.to_vec(), has_room }
    }

    /// Where it was published.
    #[must_use]
    pub fn topic(&self) -> &str {
        self.message.topic()
    }

    /// It has come to this one. What was brought before, or is not for him, changes nothing.
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

    /// Whether it has come to all.
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
