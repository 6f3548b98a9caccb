//! Messages that command: from topic and payload to a command, and from what became of it to the result that is published. There
//! are no sockets here, and no copies: what a broker had kept, and packets that came twice, were left out before.

mod problem;
mod read;
mod results;
mod sender;
pub mod table;
mod unknown;

use std::sync::Arc;

use tokio::sync::mpsc;

use self::problem::Problem;
use self::read::{Asked, Read, bare, read, sized};
pub use self::results::UNDER_WAY;
use self::results::{Reply, Results};
pub use self::sender::Sender;
use self::unknown::{UNKNOWN, Unknown};
use super::publication::Publication;
use super::topics::{Place, Topics};
use crate::access::Need;
use crate::core::command::{Command, Refused, Request};
use crate::core::mission::in_words;
use crate::runtime::handle::Handle;
use crate::wire::fields::in_short;

/// The word that halts on every topic where bare words are taken, in whatever letters.
const STOP: &str = "stop";

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
    /// It asks for something, and its sender is told what became of it.
    Taken,
    /// Its sender may not say this here; where it asked for something, he is told so.
    Forbidden,
}

/// Takes commands out of messages. Cheap to clone.
#[derive(Clone, Debug)]
pub struct Orders {
    handle: Handle,
    topics: Arc<Topics>,
    manual_driving: bool,
    results: Results,
    unknown: Arc<Unknown>,
}

/// What a message asks for, and where it is answered.
struct Order {
    /// In words for the record, where no command can be made of it.
    in_words: String,
    /// What its sender must be allowed, where no command can be made of it.
    need: Need,
    reply: Reply,
    asked: Asked,
}

impl Orders {
    /// Commands go to `handle`, results to `answers`; `manual_driving` says whether old clients may drive the robot.
    #[must_use]
    pub fn new(handle: Handle, topics: Topics, manual_driving: bool, answers: mpsc::Sender<Publication>) -> Orders {
        let results = Results::new(answers);
        Orders { handle, topics: Arc::new(topics), manual_driving, results, unknown: Arc::default() }
    }

    /// Takes a message. Its command is given at the call, so that commands keep the order in which they came, and a STOP has
    /// halted the robot when this returns; its result is published later. Must be called inside a runtime.
    pub fn take(&self, heard: &Heard<'_>, sender: &Sender) -> Taken {
        match self.topics.place(heard.topic) {
            Place::Command(name) => self.give(self.named(name, heard.payload), sender),
            Place::Word => self.give(self.word(heard.payload), sender),
            Place::Old => Taken::NotACommand,
            Place::Ours | Place::Elsewhere => Taken::NotACommand,
        }
    }

    /// A command in JSON, named by its topic.
    fn named(&self, name: &str, payload: &[u8]) -> Order {
        let in_words = format!("command {}", in_short(name));
        let Some(row) = table::named(name) else {
            let reply = self.reply(self.unknown.answered_as(name));
            return Order { in_words, need: Need::See, reply, asked: Err(Problem::no_command(name)) };
        };
        let Read { id, asked } = read(row, payload);
        Order { in_words, need: row.need, reply: Reply { id, ..self.reply(row.name) }, asked }
    }

    /// A command that is nothing but its name.
    fn word(&self, payload: &[u8]) -> Order {
        let text = String::from_utf8_lossy(payload);
        let word = bare(&text);
        if word.eq_ignore_ascii_case(STOP) || word == "h" {
            return self.named(STOP, &[]);
        }
        match sized(payload).map(|_| table::named(word).filter(|row| row.is_word)) {
            Ok(Some(row)) => self.named(row.name, &[]),
            Ok(None) => self.no_word(self.unknown.answered_as(word), word, Problem::no_word(word)),
            Err(problem) => self.no_word(UNKNOWN, word, problem),
        }
    }

    fn no_word(&self, answered_as: &str, word: &str, problem: Problem) -> Order {
        let in_words = format!("command {}", in_short(word));
        Order { in_words, need: Need::See, reply: self.reply(answered_as), asked: Err(problem) }
    }

    fn reply(&self, name: &str) -> Reply {
        Reply { topic: Some(self.topics.result(name)), id: None }
    }

    /// Gives the command of an order, if there is one, its sender may, and there is room for it.
    fn give(&self, order: Order, sender: &Sender) -> Taken {
        let need = match &order.asked {
            Ok((Command::Stop, _)) => Need::Stop,
            Ok(_) => Need::Act,
            Err(_) => order.need,
        };
        if let Err(refused) = sender.may(need) {
            self.refuse(order, &Problem::refused(&refused, None), sender);
            return Taken::Forbidden;
        }
        let (command, epoch) = match &order.asked {
            Ok((command, epoch)) => (command.clone(), *epoch),
            Err(problem) => {
                let problem = problem.clone();
                self.refuse(order, &problem, sender);
                return Taken::Taken;
            }
        };
        let place = self.results.place();
        if place.is_none() && command != Command::Stop {
            self.refuse(order, &Problem::too_many(UNDER_WAY), sender);
            return Taken::Taken;
        }
        let request = Request { id: order.reply.id.clone(), epoch, ..Request::new(command, sender.issuer()) };
        let done = self.handle.carry_out(request);
        if let Some(place) = place {
            self.results.follow(done, order.reply, place);
        }
        Taken::Taken
    }

    /// Puts on record that something was not taken (safety A6), and answers so.
    fn refuse(&self, order: Order, problem: &Problem, sender: &Sender) {
        let asked = order.asked.map_or(order.in_words, |(command, _)| in_words(&command));
        self.handle.note_refused_at_once(sender.issuer(), asked, Refused::Before(problem.refusal()));
        self.results.refused(&order.reply, problem);
    }
}
