//! What becomes of a message by its topic. Each topic is judged once for a connection, and remembered by its print.

use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;

use super::{Ended, Gatehouse};
use crate::inbound::mqtt::gate::filter::{self, Unfit};
use crate::inbound::mqtt::gate::frame::Malformed;
use crate::inbound::mqtt::gate::ledger::{Ledger, Readers, weight};
use crate::inbound::mqtt::gate::limits::TOPICS;
use crate::inbound::mqtt::gate::packet::text;
use crate::inbound::mqtt::gate::rights::Guest;
use crate::inbound::mqtt::topics::Place;

/// What becomes of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Route {
    /// It goes on to the engine.
    Pass,
    /// It may be a command: whoever hears those decides.
    Hear,
    /// It is acknowledged, and that is all.
    Drop(Dropped),
}

/// Why a message is dropped.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub(super) enum Dropped {
    #[error("its sender may not publish there")]
    Forbidden,
    #[error(transparent)]
    Unfit(Unfit),
    #[error("more topics than the engine can remember; a new engine is needed")]
    Budget,
}

/// The topics of a connection.
#[derive(Debug, Default)]
pub(super) struct Routes {
    /// The topic before, since many clients have but one, and what became of it.
    last: Vec<u8>,
    last_route: Option<Route>,
    /// The generation of ledgers that was looked at then.
    generation: u64,
    /// Topics that reached the engine: `Pass` or `Hear`, and who reads them.
    admitted: HashMap<u64, Admitted>,
    /// Who reads the topic before.
    readers: Readers,
    /// Messages on it that were passed on and are not in its readers' ledgers yet,
    unsettled: i64,
    /// and those of all topics, since somebody asked.
    passed: u64,
    /// Readers who were behind when something was published for them.
    behind: Vec<Arc<Ledger>>,
}

#[derive(Debug)]
struct Admitted {
    route: Route,
    readers: Readers,
    /// The readers are those of this generation.
    generation: u64,
}

impl Routes {
    /// What becomes of a message on this topic.
    ///
    /// # Errors
    /// When the topic is none, or one too many.
    pub(super) fn route(&mut self, topic: &[u8], guest: Guest, gatehouse: &Gatehouse) -> Result<Route, Ended> {
        let generation = gatehouse.ledgers.generation();
        if let Some(route) = self.last_route.filter(|_| self.generation == generation && self.last == topic) {
            return Ok(route);
        }
        self.settle();
        let print = gatehouse.budget.print(topic);
        let known = self.admitted.get(&print).map(|admitted| admitted.route);
        let route = known.map_or_else(|| self.judge(topic, print, guest, gatehouse), Ok)?;
        self.generation = generation;
        self.readers = self.readers_of(topic, print, gatehouse)?;
        self.last.clear();
        self.last.extend_from_slice(topic);
        self.last_route = Some(route);
        Ok(route)
    }

    /// A message on the topic of the last question, with so long a payload, was passed on to the engine.
    pub(super) fn passed(&mut self, payload: usize) {
        self.unsettled += weight(payload);
    }

    /// Puts what was passed on into the ledgers of those who are to get it.
    pub(super) fn settle(&mut self) {
        let passed = std::mem::take(&mut self.unsettled);
        if passed == 0 {
            return;
        }
        self.passed += passed.unsigned_abs();
        for reader in self.readers.iter() {
            if reader.owe(passed) && !self.behind.iter().any(|known| Arc::ptr_eq(known, reader)) {
                self.behind.push(Arc::clone(reader));
            }
        }
    }

    /// How many messages were passed on since this was asked.
    pub(super) fn take_passed(&mut self) -> u64 {
        std::mem::take(&mut self.passed)
    }

    /// The readers who are behind.
    pub(super) fn behind(&mut self, now: Duration) -> Vec<Arc<Ledger>> {
        self.behind.retain(|reader| reader.is_behind(now));
        self.behind.clone()
    }

    /// Who reads a topic, looked up again when anything has changed.
    fn readers_of(&mut self, topic: &[u8], print: u64, gatehouse: &Gatehouse) -> Result<Readers, Ended> {
        let Some(admitted) = self.admitted.get_mut(&print) else { return Ok(Readers::default()) };
        if admitted.generation != self.generation {
            admitted.readers = gatehouse.ledgers.readers(text(topic, "topic")?);
            admitted.generation = self.generation;
        }
        Ok(Arc::clone(&admitted.readers))
    }

    /// Whether a command that was heard can go on to the engine.
    ///
    /// # Errors
    /// When its topic is one too many.
    pub(super) fn admits_command(&mut self, topic: &str, gatehouse: &Gatehouse) -> Result<bool, Ended> {
        let print = gatehouse.budget.print(topic.as_bytes());
        if filter::topic(topic).is_err() {
            return Ok(false);
        }
        if !self.admitted.contains_key(&print) {
            if !self.admit(print, Route::Hear, gatehouse)? {
                return Ok(false);
            }
            self.readers = self.readers_of(topic.as_bytes(), print, gatehouse)?;
        }
        Ok(true)
    }

    fn judge(&mut self, topic: &[u8], print: u64, guest: Guest, gatehouse: &Gatehouse) -> Result<Route, Ended> {
        let topic = text(topic, "topic")?;
        if topic.is_empty() || topic.contains(['+', '#']) {
            return Err(Malformed::Topic.into());
        }
        let place = gatehouse.topics.place(topic);
        if is_for_commands(place) && guest != Guest::House {
            return Ok(Route::Hear);
        }
        if !guest.may_publish(place) {
            return Ok(Route::Drop(Dropped::Forbidden));
        }
        if let Err(unfit) = filter::topic(topic) {
            return Ok(Route::Drop(Dropped::Unfit(unfit)));
        }
        let admitted = self.admit(print, Route::Pass, gatehouse)?;
        Ok(if admitted { Route::Pass } else { Route::Drop(Dropped::Budget) })
    }

    fn admit(&mut self, print: u64, route: Route, gatehouse: &Gatehouse) -> Result<bool, Ended> {
        if self.admitted.len() >= TOPICS {
            return Err(Ended::TooMuch { what: "topics", most: TOPICS });
        }
        let admits = gatehouse.budget.admits_topic(print);
        if admits {
            // Who reads it is looked up before the first message is passed on.
            self.admitted.insert(print, Admitted { route, readers: Readers::default(), generation: u64::MAX });
        }
        Ok(admits)
    }
}

/// Whether commands are taken there. Nothing is ever kept there: a command is for now.
pub(super) const fn is_for_commands(place: Place<'_>) -> bool {
    match place {
        Place::Command(_) | Place::Word | Place::Old => true,
        Place::Ours | Place::Elsewhere => false,
    }
}
