//! What becomes of a message by its topic. Each topic is judged once for a connection, and remembered by its print.

use std::collections::HashMap;

use super::{Ended, Gatehouse};
use crate::inbound::mqtt::gate::filter::{self, Unfit};
use crate::inbound::mqtt::gate::frame::Malformed;
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
    /// Topics that reached the engine: `Pass` or `Hear`.
    admitted: HashMap<u64, Route>,
}

impl Routes {
    /// What becomes of a message on this topic.
    ///
    /// # Errors
    /// When the topic is none, or one too many.
    pub(super) fn route(&mut self, topic: &[u8], guest: Guest, gatehouse: &Gatehouse) -> Result<Route, Ended> {
        if let Some(route) = self.last_route.filter(|_| self.last == topic) {
            return Ok(route);
        }
        let print = gatehouse.budget.print(topic);
        let route = match self.admitted.get(&print) {
            Some(route) => *route,
            None => self.judge(topic, print, guest, gatehouse)?,
        };
        self.last.clear();
        self.last.extend_from_slice(topic);
        self.last_route = Some(route);
        Ok(route)
    }

    /// Whether a command that was heard can go on to the engine.
    ///
    /// # Errors
    /// When its topic is one too many.
    pub(super) fn admits_command(&mut self, topic: &str, gatehouse: &Gatehouse) -> Result<bool, Ended> {
        let print = gatehouse.budget.print(topic.as_bytes());
        Ok(filter::topic(topic).is_ok() && (self.admitted.contains_key(&print) || self.admit(print, Route::Hear, gatehouse)?))
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
            self.admitted.insert(print, route);
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
