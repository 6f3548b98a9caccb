//! How much waits for a client and for the engine, and whether there is room for more. What is done when there is none, is the pump's
//! business.

use super::{Mark, Turnstile};
use crate::limits::{ANSWER_ROOM, CLIENT_ROOM, ENGINE_ROOM};

impl Turnstile {
    /// Whether there is room for more from the client.
    #[must_use]
    pub fn wants_client(&self) -> bool {
        self.to_engine.len() < ENGINE_ROOM && !self.subscriptions.has_asked_much() && !self.is_unread()
    }

    /// How many bytes of answers and messages wait for the client, which nobody else has, and of messages for the engine.
    #[must_use]
    pub fn held(&self) -> usize {
        self.to_engine.len() + self.to_client.own() + size_of::<Mark>() * self.marks.len()
    }

    /// How many bytes of what waits for its client others have as well, and how many wait at the engine.
    #[must_use]
    pub fn elsewhere(&self) -> (usize, usize) {
        let ledger = self.account.ledger();
        (self.to_client.len() - self.to_client.own() + ledger.parcels_bytes(), ledger.at_engine())
    }

    /// How many bytes wait for clients beside what each has alone and what is kept.
    #[must_use]
    pub fn beside(&self) -> usize {
        self.gatehouse.retained.beside()
    }

    /// Whether more answers wait for the client than it may leave unread, or those of the engine that have to come first cannot.
    #[must_use]
    pub fn is_unread(&self) -> bool {
        let waits_in_vain = self.subscriptions.has_asked_much() && !self.wants_engine();
        waits_in_vain || self.to_client.len() >= ANSWER_ROOM
    }

    /// Whether there is room for more from the engine.
    #[must_use]
    pub fn wants_engine(&self) -> bool {
        self.to_client.len() < CLIENT_ROOM
    }
}
