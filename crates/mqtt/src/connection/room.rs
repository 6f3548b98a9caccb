//! Measures how many bytes wait for a client, and says whether there is room for more. The program decides what to do
//! when there is no room.

use super::{ClientConnection, Mark};
use crate::limits::{ANSWER_ROOM, CLIENT_ROOM};

impl ClientConnection {
    /// Size in bytes of the answers and messages that wait for this client alone.
    #[must_use]
    pub fn held(&self) -> usize {
        let queue = self.subscription.subscriber().own_bytes();
        self.to_client.own() + queue + size_of::<Mark>() * self.marks.len()
    }

    /// Size in bytes of the messages that wait for this client or for its acknowledgement. Other clients may share
    /// these messages.
    #[must_use]
    pub fn shared(&self) -> usize {
        self.to_client.len() - self.to_client.own() + self.subscription.subscriber().bytes() + self.unacknowledged.bytes()
    }

    /// Size in bytes of all messages in memory that are not retained.
    #[must_use]
    pub fn beside(&self) -> usize {
        self.broker.beside()
    }

    /// Whether `limits::ANSWER_ROOM` bytes or more wait for the client. If so, do not handle more of its packets.
    #[must_use]
    pub fn is_unread(&self) -> bool {
        self.to_client.len() >= ANSWER_ROOM
    }

    /// Whether the client reads what is sent to it: fewer than `limits::CLIENT_ROOM` bytes wait.
    #[must_use]
    pub fn reads(&self) -> bool {
        self.to_client.len() < CLIENT_ROOM
    }

    /// Whether a message that needs an acknowledgement may go out. Pass this to `Subscriber::poll_come`.
    #[must_use]
    pub fn has_window(&self) -> bool {
        self.unacknowledged.has_window()
    }
}
