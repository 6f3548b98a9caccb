//! How much waits for a client, and whether there is room for more. What happens when there is none is decided by
//! whoever moves the bytes.

use super::{ClientConnection, Mark};
use crate::limits::{ANSWER_ROOM, CLIENT_ROOM};

impl ClientConnection {
    /// Size in bytes of the answers and messages that wait for this client alone.
    #[must_use]
    pub fn held(&self) -> usize {
        let queue = self.subscription.subscriber().own_bytes();
        self.to_client.own() + queue + size_of::<Mark>() * self.marks.len()
    }

    /// Size in bytes of what waits for this client, or for its answers, and may be shared with other clients.
    #[must_use]
    pub fn shared(&self) -> usize {
        self.to_client.len() - self.to_client.own() + self.subscription.subscriber().bytes() + self.unacknowledged.bytes()
    }

    /// Size in bytes of what waits for clients and is neither one client's alone nor retained.
    #[must_use]
    pub fn beside(&self) -> usize {
        self.broker.beside()
    }

    /// Whether `limits::ANSWER_ROOM` bytes or more wait for the client, so that no more of its packets are to be
    /// handled.
    #[must_use]
    pub fn is_unread(&self) -> bool {
        self.to_client.len() >= ANSWER_ROOM
    }

    /// Whether the client takes what comes for it: fewer than `limits::CLIENT_ROOM` bytes wait.
    #[must_use]
    pub fn reads(&self) -> bool {
        self.to_client.len() < CLIENT_ROOM
    }

    /// Whether a message may go out that the client has to acknowledge, as `Subscriber::poll_come` needs to know.
    #[must_use]
    pub fn has_window(&self) -> bool {
        self.unacknowledged.has_window()
    }
}
