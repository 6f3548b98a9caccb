//! Messages that command: from topic and payload to a command, and from what became of it to the result that is published. There
//! are no sockets here, and no copies: what a broker had kept, and packets that came twice, were left out before.

mod nobody;
mod pace;
mod parser;
mod places;
mod problem;
mod publisher;
mod read;
mod results;
pub mod table;
mod unknown;

use std::sync::Arc;

use tokio::sync::mpsc;

use self::nobody::Nobody;
use self::pace::Pace;
use self::parser::{CommandParser, ParsedCommand};
use self::problem::Problem;
pub use self::publisher::Publisher;
use self::results::Results;
pub use self::results::{ANSWERS, Answer};
use super::topics::Topics;
use crate::access::Need;
use crate::runtime::clock::Clock;
use crate::runtime::figures::Figures;
use crate::runtime::handle::Handle;
use hallsweep_core::command::{Command, Request};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::Epoch;
use hallsweep_core::world::luggage::PhotoState;
use mqtt_gate::{AnswerTo, filter};

/// A message that was published just now.
#[derive(Clone, Copy, Debug)]
pub struct IncomingMessage<'a> {
    /// Where.
    pub topic: &'a str,
    /// What.
    pub payload: &'a [u8],
    /// In which epoch of stops it came, where that is known.
    pub arrived: Option<Epoch>,
    /// Whether its sender says that it was sent before.
    pub is_again: bool,
    /// Where its sender wants the answer, in MQTT 5.
    pub answer_to: Option<AnswerTo<'a>>,
}

/// By no longer word than this an answer is known to whoever wants it, in bytes.
const CORRELATION: usize = 1024;

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
pub struct Commands {
    handle: Handle,
    parser: Arc<CommandParser>,
    results: Results,
    pace: Arc<Pace>,
    nobody: Arc<Nobody>,
    clock: Clock,
}

impl Commands {
    /// Commands go to `handle`, results to `answers`; `manual_driving` says whether old clients may drive the robot.
    pub fn new(handle: Handle, topics: Topics, manual_driving: bool, answers: mpsc::Sender<Answer>) -> Commands {
        let parser = Arc::new(CommandParser::new(topics, manual_driving));
        let (pace, nobody) = (Arc::default(), Arc::default());
        Commands { handle, parser, results: Results::new(answers), pace, nobody, clock: Clock::default() }
    }

    /// Where an answer goes that is wanted there: where its sender may say something himself, and nobody's business is here, so that nobody
    /// makes the program say what he may not say.
    pub fn answer_to<'a>(&self, wanted: Option<AnswerTo<'a>>, publisher: &Publisher) -> Option<AnswerTo<'a>> {
        let is_short = |wanted: &AnswerTo<'_>| wanted.correlation.is_none_or(|data| data.len() <= CORRELATION);
        let is_topic = |AnswerTo { topic, .. }: &AnswerTo<'_>| {
            !topic.is_empty() && !topic.contains(['+', '#']) && filter::topic(topic).is_ok()
        };
        let is_theirs = |AnswerTo { topic, .. }: &AnswerTo<'_>| self.parser.is_elsewhere(topic);
        wanted.filter(is_short).filter(is_topic).filter(is_theirs).filter(|_| publisher.may(Need::Act).is_ok())
    }

    /// Where clients are counted.
    pub fn figures(&self) -> &Figures {
        self.handle.figures()
    }

    /// Takes a message. Its command is given at the call, so that commands keep the order in which they came, and a STOP has
    /// halted the robot when this returns; its result is published later. Must be called inside a runtime.
    pub fn take(&self, heard: &IncomingMessage<'_>, publisher: &Publisher) -> Taken {
        if self.halts((heard.topic.as_bytes(), heard.payload), heard.answer_to, publisher) {
            return Taken::Taken;
        }
        if self.parser.is_of_others(heard) {
            return self.ignore(heard, publisher);
        }
        // Before it is read: who says too much costs nobody the time to read it.
        if !self.pace.admits(publisher, self.clock.now().since_start) {
            return Taken::Forbidden;
        }
        let Some(mut parsed) = self.parser.parse(heard) else { return self.ignore(heard, publisher) };
        parsed.reply.is_wanted(heard.answer_to);
        let wrong = || parsed.asked.as_ref().err().filter(|_| publisher.is_viewer()).cloned();
        let forbidden = publisher.may(parsed.need()).err().map(|refused| Problem::refused(&refused)).or_else(wrong);
        if let Some(problem) = forbidden {
            self.refuse(&parsed.unexplained(), &problem, publisher);
            return Taken::Forbidden;
        }
        if let Some(again) = parsed.goes_on.then(|| to_retake(&self.handle.snapshot())).flatten() {
            parsed.asked = Ok((again, None));
        }
        match &parsed.asked {
            Ok((command, epoch)) => self.give(&parsed, (command, *epoch), Some(heard), publisher),
            Err(problem) => self.refuse(&parsed, problem, publisher),
        }
        Taken::Taken
    }

    /// Halts the robot if a message names STOP, whatever else is wrong with it (safety S8); whether it does. No more of it need have come
    /// than names it. Must be called inside a runtime.
    pub fn halts(&self, (topic, payload): (&[u8], &[u8]), answer_to: Option<AnswerTo<'_>>, publisher: &Publisher) -> bool {
        if publisher.may(Need::Stop).is_err() {
            return false;
        }
        let mut stop = self.parser.stop(topic, payload);
        if let Some(parsed) = &mut stop {
            parsed.reply.is_wanted(answer_to);
            self.give(parsed, (&Command::Stop, None), None, publisher);
        }
        stop.is_some()
    }

    /// The epoch that the last stop has made.
    pub fn epoch(&self) -> Epoch {
        self.handle.epoch()
    }

    /// What asks for nothing. Old clients believe what they hear on the old topics, so that not everybody may say something there.
    fn ignore(&self, heard: &IncomingMessage<'_>, publisher: &Publisher) -> Taken {
        if self.parser.is_old(heard.topic) && publisher.may(Need::Act).is_err() {
            return Taken::Forbidden;
        }
        if let Some(id) = self.parser.unknown_to_all(heard) {
            self.nobody.heard(&id, heard.payload, self.clock.now());
        }
        Taken::NotACommand
    }

    /// How many old messages nobody understood.
    #[cfg(test)]
    fn not_understood(&self) -> u64 {
        self.nobody.count()
    }

    /// Gives a command if there is room for one more, and a STOP always.
    fn give(
        &self,
        parsed: &ParsedCommand,
        (command, epoch): (&Command, Option<Epoch>),
        heard: Option<&IncomingMessage<'_>>,
        publisher: &Publisher,
    ) {
        let place = self.results.place(publisher);
        if let Err(under_way) = place
            && *command != Command::Stop
        {
            return self.refuse(parsed, &Problem::too_many(under_way), publisher);
        }
        let id = parsed.reply.id.clone();
        let (arrived, is_again) = heard.map_or((None, false), |heard| (heard.arrived, heard.is_again));
        let request = Request { id, epoch, arrived, is_again, ..Request::new(command.clone(), publisher.issuer()) };
        let given = self.handle.carry_out(request);
        if let Ok(place) = place {
            self.results.follow(given, (parsed.reply.clone(), publisher.clone()), place);
        }
    }

    /// Puts on record that something was not taken (safety A6), and answers so.
    fn refuse(&self, parsed: &ParsedCommand, problem: &Problem, publisher: &Publisher) {
        self.handle.note_refused_at_once(publisher.issuer(), parsed.for_record(), problem.for_record());
        self.results.refused(&parsed.reply, publisher, problem);
    }
}

/// What goes on where the robot stands before a piece whose photo has failed: the photo is taken again.
fn to_retake(snapshot: &Snapshot) -> Option<Command> {
    let piece = snapshot.mission.inspected.and_then(|id| snapshot.luggage(id)).filter(|piece| piece.is_pending())?;
    let has_failed = matches!(piece.photo, PhotoState::Failed(_)) && snapshot.mission.phase == PhaseName::Inspecting;
    has_failed.then_some(Command::RetakePhoto(piece.id))
}

#[cfg(test)]
mod bounds_tests;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
