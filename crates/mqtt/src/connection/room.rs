//! How much waits for a client, and whether there is room for more. What is done when there is none, is the business of whoever moves the
//! bytes.

use super::{ClientConnection, Mark};
use crate::limits::{ANSWER_ROOM, CLIENT_ROOM};

impl ClientConnection {
    /// How many bytes of answers and messages wait for the client, which nobody else has.
    #[must_use]
    pub fn held(&self) -> usize {
        let queue = self.subscription.subscriber().own_bytes();
        self.to_client.own() + queue + size_of::<Mark>() * self.marks.len()
    }

    /// How many bytes of what waits for its client, or for its answers, others may have as well.
    #[must_use]
    pub fn shared(&self) -> usize {
        self.to_client.len() - self.to_client.own() + self.subscription.subscriber().bytes() + self.unacknowledged.bytes()
    }

    /// How many bytes wait for clients beside what each has alone and what is kept.
    #[must_use]
    pub fn beside(&self) -> usize {
        self.broker.beside()
    }

    /// Whether more answers wait for the client than it may leave unread.
    #[must_use]
    pub fn is_unread(&self) -> bool {
        self.to_client.len() >= ANSWER_ROOM
    }

    /// Whether the client takes what comes for it.
    #[must_use]
    pub fn reads(&self) -> bool {
        self.to_client.len() < CLIENT_ROOM
    }

    /// Whether something may go out that the client is to acknowledge.
    #[must_use]
    pub fn has_window(&self) -> bool {
        self.unacknowledged.has_window()
    }
}
