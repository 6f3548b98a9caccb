//! Messages with commands: turns topic and payload into a command, and the command's result into the published
//! answer. There are no sockets here. Retained messages and repeated packets are filtered out before this code.

mod nobody;
mod parser;
mod problem;
mod publisher;
mod read;
mod results;
pub mod table;
mod unknown;

use std::sync::Arc;

use tokio::sync::mpsc;

use self::nobody::Nobody;
pub(super) use self::parser::tidied;
use self::parser::{CommandParser, ParsedCommand};
use self::problem::Problem;
pub use self::publisher::Publisher;
use self::results::Results;
pub use self::results::{ANSWERS, ResultMessage};
use super::topic_map::TopicMap;
use super::topics::{TopicKind, Topics};
use crate::access::Need;
use crate::doors::connection_limits::CommandRate;
use crate::runtime::clock::Clock;
use crate::runtime::figures::Figures;
use crate::runtime::handle::Handle;
use hallsweep_core::command::{Command, Request, Verdict};
use hallsweep_core::engine::tells_of_verdict;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::settings::SafeBy;
use hallsweep_core::units::Epoch;
use hallsweep_core::world::luggage::PhotoState;
use mqtt_gate::{AnswerTo, filter};

#[derive(Clone, Copy, Debug)]
pub struct IncomingMessage<'a> {
    pub topic: &'a str,
    pub payload: &'a [u8],
    pub arrived: Option<Epoch>,
    /// The DUP flag (MQTT 5, section 3.3.1.1). If set, this may be a repetition of an earlier message.
    pub is_again: bool,
    /// Where the sender wants the answer: Response Topic and Correlation Data of MQTT 5.
    pub answer_to: Option<AnswerTo<'a>>,
}

/// Maximum length of correlation data in bytes.
const CORRELATION: usize = 1024;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Taken {
    /// The message contains no command for this program.
    NotACommand,
    /// The message contains a command. Its result is published and recorded.
    Taken,
    /// The message contains a verdict that other clients must not read, because it may be the first of two.
    InConfidence,
    /// The sender may not publish this message. If it contains a command, the refusal is published and recorded.
    /// Messages above the sender's rate are dropped instead.
    Forbidden,
}

#[derive(Clone, Debug)]
pub struct Commands {
    handle: Handle,
    parser: Arc<CommandParser>,
    results: Results,
    rate: Arc<CommandRate>,
    nobody: Arc<Nobody>,
    clock: Clock,
    /// Whether a *safe* needs two judges, so that nobody may read a verdict here.
    keeps_verdicts: bool,
    /// The topics of all halls, on which no answer may be requested; `None` if there is one hall only.
    all_topics: Option<TopicMap>,
}

impl Commands {
    /// If `manual_driving` is true, old clients may drive the robot.
    pub fn new(handle: Handle, topics: Topics, manual_driving: bool, answers: mpsc::Sender<ResultMessage>) -> Commands {
        let parser = Arc::new(CommandParser::new(topics, manual_driving));
        let (rate, nobody) = (Arc::default(), Arc::default());
        let (results, clock) = (Results::new(answers), Clock::default());
        Commands { handle, parser, results, rate, nobody, clock, keeps_verdicts: false, all_topics: None }
    }

    /// These commands in a program with several halls.
    #[must_use]
    pub fn among(self, all: TopicMap) -> Commands {
        Commands { all_topics: Some(all), ..self }
    }

    pub(super) fn topics(&self) -> &Topics {
        self.parser.topics()
    }

    pub fn with_judges(self, safe_by: SafeBy) -> Commands {
        Commands { keeps_verdicts: safe_by == SafeBy::Two, ..self }
    }

    /// Returns the topic that the sender requested for an answer, if the sender may publish there itself. Topics of
    /// this program are excluded. Otherwise a sender could make the program publish what the sender may not publish.
    pub fn answer_to<'a>(&self, wanted: Option<AnswerTo<'a>>, publisher: &Publisher) -> Option<AnswerTo<'a>> {
        let is_short = |wanted: &AnswerTo<'_>| wanted.correlation.is_none_or(|data| data.len() <= CORRELATION);
        let is_topic = |AnswerTo { topic, .. }: &AnswerTo<'_>| {
            !topic.is_empty() && !topic.contains(['+', '#']) && filter::topic(topic).is_ok()
        };
        let is_theirs = |AnswerTo { topic, .. }: &AnswerTo<'_>| {
            let all = self.all_topics.as_ref();
            let kind = all.map_or_else(|| self.topics().kind_of(topic), |all| all.kind_of(topic));
            kind == TopicKind::Elsewhere
        };
        wanted.filter(is_short).filter(is_topic).filter(is_theirs).filter(|_| publisher.may(Need::Act).is_ok())
    }

    pub fn figures(&self) -> &Figures {
        self.handle.figures()
    }

    /// Handles a message. Its command is sent immediately, so that commands keep their order. If the message is a
    /// STOP, the robot has been halted when this returns. The result is published later. Must be called inside a
    /// runtime.
    pub fn take(&self, heard: &IncomingMessage<'_>, publisher: &Publisher) -> Taken {
        if self.halts(heard.topic.as_bytes(), heard.payload, heard.answer_to, publisher) {
            return Taken::Taken;
        }
        if self.parser.is_of_others(heard) {
            return self.ignore(heard, publisher);
        }
        // The rate is checked before parsing, so that a sender with too many messages costs no time for parsing.
        if !self.rate.admits(publisher.issuer().who, publisher.is_viewer(), self.clock.now().since_start) {
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
        if parsed.goes_on {
            // If the robot stands before a piece whose photo has failed, "go on" means that the photo is retaken.
            let snapshot = self.handle.snapshot();
            let piece = snapshot.mission.inspected.and_then(|id| snapshot.luggage(id)).filter(|piece| piece.is_pending());
            let failed = piece.filter(|piece| matches!(piece.photo, PhotoState::Failed(_)));
            if let Some(piece) = failed.filter(|_| snapshot.mission.phase == PhaseName::Inspecting) {
                parsed.asked = Ok((Command::RetakePhoto(piece.id), None));
            }
        }
        let is_danger = matches!(parsed.asked, Ok((Command::Verdict { verdict: Verdict::Danger, .. }, _)));
        if self.is_confidential(heard, &parsed) && !is_danger {
            parsed.reply = parsed.reply.confidential();
        }
        match &parsed.asked {
            Ok((command, epoch)) => self.give(&parsed, command, *epoch, Some(heard), publisher),
            Err(problem) => self.refuse(&parsed, problem, publisher),
        }
        if self.is_confidential(heard, &parsed) { Taken::InConfidence } else { Taken::Taken }
    }

    /// Whether nobody else may read the message: it is an answer about a piece, or may be one that is written wrongly.
    fn is_confidential(&self, heard: &IncomingMessage<'_>, parsed: &ParsedCommand) -> bool {
        let tells = || tells_of_verdict(heard.topic) || tells_of_verdict(&String::from_utf8_lossy(heard.payload));
        let is_answer = matches!(parsed.asked, Ok((Command::Verdict { .. } | Command::Unsure { .. }, _)));
        self.keeps_verdicts && (is_answer || parsed.asked.is_err() && tells())
    }

    /// Halts the robot if a message names STOP, whatever else is wrong with the message (safety S8). Returns whether
    /// it names STOP. The rest of the message may be incomplete. Must be called inside a runtime.
    pub fn halts(&self, topic: &[u8], payload: &[u8], answer_to: Option<AnswerTo<'_>>, publisher: &Publisher) -> bool {
        if publisher.may(Need::Stop).is_err() {
            return false;
        }
        let mut stop = self.parser.stop(topic, payload);
        if let Some(parsed) = &mut stop {
            parsed.reply.is_wanted(answer_to);
            self.give(parsed, &Command::Stop, None, None, publisher);
        }
        stop.is_some()
    }

    pub fn epoch(&self) -> Epoch {
        self.handle.epoch()
    }

    /// Handles a message without a command. On the old topics only operators may publish such messages, because old
    /// clients trust everything there.
    fn ignore(&self, heard: &IncomingMessage<'_>, publisher: &Publisher) -> Taken {
        if self.parser.is_old(heard.topic) && publisher.may(Need::Act).is_err() {
            return Taken::Forbidden;
        }
        if let Some(id) = self.parser.unknown_to_all(heard) {
            self.nobody.heard(&id, heard.payload, self.clock.now());
        }
        Taken::NotACommand
    }

    #[cfg(test)]
    fn not_understood(&self) -> u64 {
        self.nobody.count()
    }

    /// Sends a command if there is room for one more. A STOP is sent in any case.
    fn give(
        &self,
        parsed: &ParsedCommand,
        command: &Command,
        epoch: Option<Epoch>,
        heard: Option<&IncomingMessage<'_>>,
        publisher: &Publisher,
    ) {
        let permit = self.results.permit(publisher);
        if let Err(under_way) = permit
            && *command != Command::Stop
        {
            return self.refuse(parsed, &Problem::too_many(under_way), publisher);
        }
        let id = parsed.reply.id.clone();
        let (arrived, is_again) = heard.map_or((None, false), |heard| (heard.arrived, heard.is_again));
        let request = Request { id, epoch, arrived, is_again, ..Request::new(command.clone(), publisher.issuer()) };
        let given = self.handle.carry_out(request);
        if let Ok(permit) = permit {
            self.results.follow(given, parsed.reply.clone(), publisher.clone(), permit);
        }
    }

    /// Records a refusal (safety A6), and publishes it as the answer.
    fn refuse(&self, parsed: &ParsedCommand, problem: &Problem, publisher: &Publisher) {
        // The refusal would tell what the sender thinks of the piece that waits.
        if parsed.reply.is_confidential && self.handle.snapshot().luggage.pending().next().is_some() {
            return;
        }
        self.handle.note_refused_at_once(publisher.issuer(), parsed.for_record(), problem.for_record());
        self.results.refused(&parsed.reply, publisher, problem);
    }
}

#[cfg(test)]
mod bounds_tests;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
