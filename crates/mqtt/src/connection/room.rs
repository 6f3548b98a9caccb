//! How much waits for a client and for the router, and whether there is room for more. What is done when there is none, is the business of
//! whoever moves the bytes.

use super::{ClientConnection, Mark};
use crate::limits::{ANSWER_ROOM, CLIENT_ROOM, ROUTER_ROOM};

impl ClientConnection {
    /// Whether there is room for more from the client.
    #[must_use]
    pub fn wants_client(&self) -> bool {
        self.to_router.len() < ROUTER_ROOM && !self.subscriptions.has_asked_much() && !self.is_unread()
    }

    /// How many bytes of answers and messages wait for the client, which nobody else has, and of messages for the router.
    #[must_use]
    pub fn held(&self) -> usize {
        self.to_router.len() + self.to_client.own() + size_of::<Mark>() * self.marks.len()
    }

    /// How many bytes of what waits for its client others have as well, and how many wait at the router.
    #[must_use]
    pub fn elsewhere(&self) -> (usize, usize) {
        let lag = self.lag_guard.lag();
        (self.to_client.len() - self.to_client.own() + lag.parcels_bytes(), lag.at_router())
    }

    /// How many bytes wait for clients beside what each has alone and what is kept.
    #[must_use]
    pub fn beside(&self) -> usize {
        self.broker.retained.beside()
    }

    /// Whether more answers wait for the client than it may leave unread, or those of the router that have to come first cannot.
    #[must_use]
    pub fn is_unread(&self) -> bool {
        let waits_in_vain = self.subscriptions.has_asked_much() && !self.wants_router();
        waits_in_vain || self.to_client.len() >= ANSWER_ROOM
    }

    /// Whether there is room for more from the router.
    #[must_use]
    pub fn wants_router(&self) -> bool {
        self.to_client.len() < CLIENT_ROOM
    }
}
