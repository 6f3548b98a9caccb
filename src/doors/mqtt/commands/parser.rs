//! Determines the meaning of a message from its topic and payload. It may be a command in JSON, the bare name of a
//! command, or a message of the original system. Rights and results are handled elsewhere.

use super::super::qak::incoming;
use super::super::topics::{TopicKind, Topics};
use super::IncomingMessage;
use super::problem::Problem;
use super::read::{AskedCommand, Read, bare, id_in, read, sized};
use super::results::Reply;
use super::unknown::{UNKNOWN, Unknown};
use crate::access::Need;
use crate::api::commands;
use crate::api::fields::in_short;
use crate::api::halt::{is_halt, says_halt};
use hallsweep_core::asked as recorded;
use hallsweep_core::command::Command;

const STOP: &str = "stop";

const MOVE: &str = "move";

#[derive(Debug)]
pub(super) struct CommandParser {
    topics: Topics,
    manual_driving: bool,
    unknown: Unknown,
}

#[derive(Debug)]
pub(super) struct ParsedCommand {
    pub(super) asked: AskedCommand,
    /// The right that the sender needs if the command cannot be read.
    pub(super) need: Need,
    /// What is recorded if the command cannot be read.
    pub(super) unread: recorded::Asked,
    /// Whether the message means "go on": retake a failed photo, or else START.
    pub(super) goes_on: bool,
    pub(super) reply: Reply,
}

impl CommandParser {
    pub(super) fn new(topics: Topics, manual_driving: bool) -> CommandParser {
        CommandParser { topics, manual_driving, unknown: Unknown::default() }
    }

    pub(super) const fn topics(&self) -> &Topics {
        &self.topics
    }

    /// Returns the STOP that topic and payload name. Other faults do not matter: invalid text, wildcards, additional
    /// levels or characters (safety S8).
    pub(super) fn stop(&self, topic: &[u8], payload: &[u8]) -> Option<ParsedCommand> {
        let topic = String::from_utf8_lossy(topic);
        self.stop_on(&topic, payload).or_else(|| self.stop_on(&tidied(&topic)?, payload))
    }

    fn stop_on(&self, topic: &str, payload: &[u8]) -> Option<ParsedCommand> {
        let reply = match self.topics.kind_of(topic) {
            TopicKind::Command(name) if is_halt(name) => self.reply(STOP),
            TopicKind::Command(name) if name.eq_ignore_ascii_case(MOVE) && says_halt(payload) => self.reply(MOVE),
            // The word may be surrounded by any characters except letters and digits.
            TopicKind::Word
                if is_halt(String::from_utf8_lossy(payload).trim_matches(|letter: char| !letter.is_alphanumeric())) =>
            {
                self.reply(STOP)
            }
            TopicKind::Old if incoming::is_stop(payload) => Reply::default(),
            TopicKind::Command(_) | TopicKind::Word | TopicKind::Old | TopicKind::Ours | TopicKind::Elsewhere => return None,
        };
        let id = if reply.topic.is_some() { id_in(payload) } else { None };
        let reply = Reply { id, ..reply };
        Some(ParsedCommand { asked: Ok((Command::Stop, None)), need: Need::Stop, unread: unread(STOP), goes_on: false, reply })
    }

    /// Whether a message is certainly not for this program, decided without parsing it. This is so if it is on
    /// another topic, or if other actors send it to each other on the old topics.
    pub(super) fn is_of_others(&self, heard: &IncomingMessage<'_>) -> bool {
        match self.topics.kind_of(heard.topic) {
            TopicKind::Command(_) | TopicKind::Word => false,
            TopicKind::Old => incoming::is_of_others(heard.payload),
            TopicKind::Ours | TopicKind::Elsewhere => true,
        }
    }

    /// Returns the command in a message, or `None` if the message contains no command.
    pub(super) fn parse(&self, heard: &IncomingMessage<'_>) -> Option<ParsedCommand> {
        match self.topics.kind_of(heard.topic) {
            TopicKind::Command(name) => Some(self.named(name, heard.payload)),
            TopicKind::Word => Some(self.word(heard.payload)),
            TopicKind::Old => self.old(heard.payload),
            TopicKind::Ours | TopicKind::Elsewhere => None,
        }
    }

    pub(super) fn is_old(&self, topic: &str) -> bool {
        self.topics.kind_of(topic) == TopicKind::Old
    }

    /// Returns the MSGID of a message on the old topics if the program does not know this MSGID.
    pub(super) fn unknown_to_all(&self, heard: &IncomingMessage<'_>) -> Option<String> {
        match self.is_old(heard.topic).then(|| incoming::asked(heard.payload, self.manual_driving))? {
            Ok(incoming::QakRequest::Unknown(id)) => Some(id),
            Ok(incoming::QakRequest::Command(_) | incoming::QakRequest::GoOn | incoming::QakRequest::Nothing) | Err(_) => None,
        }
    }

    fn named(&self, name: &str, payload: &[u8]) -> ParsedCommand {
        let Some(row) = commands::named(name) else {
            let unknown = self.unknown(self.unknown.answered_as(name), name, Problem::no_command(name));
            return ParsedCommand { reply: Reply { id: id_in(payload), ..unknown.reply }, ..unknown };
        };
        let Read { id, asked } = read(row, payload);
        let reply = Reply { id, ..self.reply(row.name) };
        ParsedCommand { asked, need: row.need, unread: unread(name), goes_on: false, reply }
    }

    fn word(&self, payload: &[u8]) -> ParsedCommand {
        let text = String::from_utf8_lossy(payload);
        let word = bare(&text);
        if let Err(problem) = sized(payload) {
            return self.unknown(UNKNOWN, word, problem);
        }
        match commands::named(word).filter(|row| row.is_word()) {
            Some(row) => self.named(row.name, &[]),
            None => self.unknown(self.unknown.answered_as(word), word, Problem::no_word(word)),
        }
    }

    /// Reads a message of the original system. If its command is refused, the reason is shown in place of a piece on
    /// old consoles: the original system has no other message for an answer.
    fn old(&self, payload: &[u8]) -> Option<ParsedCommand> {
        let read = |command: Command| (Ok((command.clone(), None)), recorded::Asked::Command(command));
        let ((asked, unread), goes_on) = match incoming::asked(payload, self.manual_driving) {
            Ok(incoming::QakRequest::Nothing | incoming::QakRequest::Unknown(_)) => return None,
            Ok(incoming::QakRequest::GoOn) => (read(Command::Start), true),
            Ok(incoming::QakRequest::Command(command)) => (read(command), false),
            Err(wrong) => ((Err(Problem::refused(&wrong.refused())), wrong.asked()), false),
        };
        let explained = asked.is_ok().then(|| self.topics.old_events());
        Some(ParsedCommand { asked, need: Need::Act, unread, goes_on, reply: Reply { explained, ..Reply::default() } })
    }

    fn unknown(&self, answered_as: &str, name: &str, problem: Problem) -> ParsedCommand {
        let reply = self.reply(answered_as);
        ParsedCommand { asked: Err(problem), need: Need::See, unread: unread(name), goes_on: false, reply }
    }

    fn reply(&self, name: &str) -> Reply {
        Reply { topic: Some(self.topics.result(name)), ..Reply::default() }
    }
}

impl ParsedCommand {
    /// Returns the right that the sender needs: the right to stop for any form of STOP, the right to act for every
    /// other command.
    pub(super) fn need(&self) -> Need {
        match &self.asked {
            Ok((Command::Stop, _)) => Need::Stop,
            Ok(_) => Need::Act,
            Err(_) => self.need,
        }
    }

    /// Removes the explanation on the old topics. Senders without the right to give the command get no explanation
    /// there.
    pub(super) fn unexplained(self) -> ParsedCommand {
        ParsedCommand { reply: Reply { explained: None, ..self.reply }, ..self }
    }

    pub(super) fn for_record(&self) -> recorded::Asked {
        self.asked.as_ref().map_or_else(|_| self.unread.clone(), |(command, _)| recorded::Asked::Command(command.clone()))
    }
}

/// Corrects a topic: removes wildcards, empty levels and invisible characters. Returns `None` if the topic needs no
/// correction.
pub(crate) fn tidied(topic: &str) -> Option<String> {
    let is_plain = |byte: u8| byte.is_ascii_graphic() && byte != b'+' && byte != b'#';
    let has_empty_level = topic.starts_with('/') || topic.ends_with('/') || topic.contains("//");
    if topic.bytes().all(is_plain) && !has_empty_level {
        return None;
    }
    let is_seen = |letter: &char| letter.is_ascii_graphic() && !matches!(letter, '+' | '#');
    let levels = topic.split('/').map(|level| level.chars().filter(is_seen).collect::<String>());
    Some(levels.filter(|level| !level.is_empty()).collect::<Vec<_>>().join("/"))
}

fn unread(name: &str) -> recorded::Asked {
    recorded::Asked::Words(format!("command {}", in_short(name)))
}
