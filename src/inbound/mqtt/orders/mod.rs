//! Messages that command: from topic and payload to a command, and from what became of it to the result that is published. There
//! are no sockets here, and no copies: what a broker had kept, and packets that came twice, were left out before.

mod ear;
mod pace;
mod problem;
mod read;
mod results;
mod sender;
pub mod table;
mod unknown;

use std::sync::Arc;

use tokio::sync::mpsc;

use self::ear::{Ear, Order};
use self::pace::Pace;
use self::problem::Problem;
use self::results::Results;
pub use self::results::UNDER_WAY;
pub use self::sender::Sender;
use super::publication::Publication;
use super::topics::Topics;
use crate::access::Need;
use crate::core::command::{Command, Refused, Request};
use crate::core::units::Epoch;
use crate::runtime::clock::Clock;
use crate::runtime::handle::Handle;

/// A message that was published just now.
#[derive(Clone, Copy, Debug)]
pub struct Heard<'a> {
    /// Where.
    pub topic: &'a str,
    /// What.
    pub payload: &'a [u8],
}

/// What became of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// It asks for nothing: its topic is for other things, or its words are.
    NotACommand,
    /// It asks for something; what becomes of that is published, and on record.
    Taken,
    /// Its sender may not say this here; where it asks for something, that is published and on record as well. Or he says too much
    /// at once, and nothing becomes of it.
    Forbidden,
}

/// Takes commands out of messages. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Orders {
    handle: Handle,
    ear: Arc<Ear>,
    results: Results,
    pace: Arc<Pace>,
    clock: Clock,
}

impl Orders {
    /// Commands go to `handle`, results to `answers`; `manual_driving` says whether old clients may drive the robot.
    #[must_use]
    pub fn new(handle: Handle, topics: Topics, manual_driving: bool, answers: mpsc::Sender<Publication>) -> Orders {
        let ear = Arc::new(Ear::new(topics, manual_driving));
        Orders { handle, ear, results: Results::new(answers), pace: Arc::default(), clock: Clock::default() }
    }

    /// Takes a message. Its command is given at the call, so that commands keep the order in which they came, and a STOP has
    /// halted the robot when this returns; its result is published later. Must be called inside a runtime.
    pub fn take(&self, heard: &Heard<'_>, sender: &Sender) -> Taken {
        if self.halts(heard.topic.as_bytes(), heard.payload, sender) {
            return Taken::Taken;
        }
        if self.ear.is_of_others(heard) {
            // Old clients believe what they hear on the old topics, so that not everybody may say something there.
            let is_forbidden = self.ear.is_old(heard.topic) && sender.may(Need::Act).is_err();
            return if is_forbidden { Taken::Forbidden } else { Taken::NotACommand };
        }
        // Before it is read: who says too much costs nobody the time to read it.
        if !self.pace.admits(sender, self.clock.now().since_start) {
            return Taken::Forbidden;
        }
        let Some(order) = self.ear.order(heard) else {
            let is_forbidden = sender.may(Need::Act).is_err();
            return if is_forbidden { Taken::Forbidden } else { Taken::NotACommand };
        };
        if let Err(refused) = sender.may(order.need()) {
            self.refuse(&order, &Problem::refused(&refused, None), sender);
            return Taken::Forbidden;
        }
        match &order.asked {
            Ok((command, epoch)) => self.give(&order, command, *epoch, sender),
            Err(problem) => self.refuse(&order, problem, sender),
        }
        Taken::Taken
    }

    /// Halts the robot if a message names STOP, whatever else is wrong with it (safety S8); whether it does. No more of it need have come
    /// than names it. Must be called inside a runtime.
    pub fn halts(&self, topic: &[u8], payload: &[u8], sender: &Sender) -> bool {
        if sender.may(Need::Stop).is_err() {
            return false;
        }
        let stop = self.ear.stop(topic, payload);
        if let Some(reply) = &stop {
            self.give(reply, &Command::Stop, None, sender);
        }
        stop.is_some()
    }

    /// Gives a command if there is room for one more, and a STOP always.
    fn give(&self, order: &Order, command: &Command, epoch: Option<Epoch>, sender: &Sender) {
        let place = self.results.place();
        if place.is_none() && *command != Command::Stop {
            return self.refuse(order, &Problem::too_many(UNDER_WAY), sender);
        }
        let id = order.reply.id.clone();
        let given = self.handle.carry_out(Request { id, epoch, ..Request::new(command.clone(), sender.issuer()) });
        if let Some(place) = place {
            self.results.follow(given, order.reply.clone(), place);
        }
    }

    /// Puts on record that something was not taken (safety A6), and answers so.
    fn refuse(&self, order: &Order, problem: &Problem, sender: &Sender) {
        self.handle.note_refused_at_once(sender.issuer(), order.in_words(), Refused::Before(problem.refusal()));
        self.results.refused(&order.reply, problem);
    }
}

#[cfg(test)]
mod bounds_tests;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
