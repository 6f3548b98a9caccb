//! The meaning of the original system's messages (mission §8). One table maps MSGIDs to commands. The table applies
//! to events as well as dispatches, from any sender with any number. What is done with a command is decided
//! elsewhere.

use std::sync::LazyLock;

use super::message::{Message, MessageKind, NoMessage};
use super::outgoing::MODEL_CONTENT;
use super::term::{Term, is_in_word};
use crate::api::command::{goto, move_word};
use crate::api::fields::in_short;
use crate::api::halt::is_halt;
use crate::api::old_clients::{Asks, DANGER, ROWS, SAFE, may_drive};
use crate::api::problem::refusal;
use hallsweep_core::asked;
use hallsweep_core::command::Command;
use hallsweep_core::refused::Refused;

#[derive(Clone, Debug, PartialEq)]
pub enum QakRequest {
    Command(Command),
    /// "Go on": retake a failed photo, or else START.
    GoOn,
    /// No command: a message that we published ourselves, or a reply to another actor.
    Nothing,
    /// An unknown MSGID. Other actors may send such messages to each other.
    Unknown(String),
}

/// `Display` is the sentence for the log and the record.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Wrong {
    #[error(transparent)]
    NoMessage(#[from] NoMessage),
    /// The MSGID is known, but the CONTENT has no meaning for it.
    #[error("the CONTENT of {id} is wrong: {words}")]
    Content { id: &'static str, words: String },
    /// The message asks to drive the robot. Old clients may do that only with `manual_driving`.
    #[error("{refused}")]
    Refused { command: Command, refused: Refused },
}

/// Returns the meaning of a payload on one of the old topics. A payload that begins with an unknown MSGID counts as
/// unknown, even if it is too long or not a message. Other actors may send each other such payloads.
///
/// # Errors
/// When the payload is not a message, or when the CONTENT of a known message has no meaning. Also when a message asks
/// to drive and `manual_driving` is false.
pub fn asked(payload: &[u8], manual_driving: bool) -> Result<QakRequest, Wrong> {
    if is_stop(payload) {
        return Ok(QakRequest::Command(Command::Stop));
    }
    if let Some(id) = beginning(payload).filter(|id| known(id).is_none()) {
        return Ok(of_others(id));
    }
    let message = Message::parse(payload)?;
    let Some(known) = known(&message.id) else { return Ok(of_others(message.id)) };
    if message.kind == MessageKind::Reply {
        return Ok(QakRequest::Nothing);
    }
    let command = known.command(&message.content).map_err(|words| Wrong::Content { id: known.id, words })?;
    if matches!(known.asks, Asks::GoOn) {
        return Ok(QakRequest::GoOn);
    }
    match may_drive(&command, manual_driving) {
        Ok(()) => Ok(QakRequest::Command(command)),
        Err(refused) => Err(Wrong::Refused { command, refused }),
    }
}

fn of_others(id: String) -> QakRequest {
    if id == MODEL_CONTENT { QakRequest::Nothing } else { QakRequest::Unknown(id) }
}

/// Whether a payload begins like a message with an unknown MSGID. Only the beginning is read.
pub fn is_of_others(payload: &[u8]) -> bool {
    beginning(payload).is_some_and(|id| known(&id).is_none())
}

/// Whether a payload means STOP. Other faults do not matter: a missing number, an invalid sender, a missing end,
/// excessive length (safety S1, S8). Only the beginning is read, except for messages such as `userCmd`, whose CONTENT
/// may be a STOP.
pub fn is_stop(payload: &[u8]) -> bool {
    let Some(id) = opening(payload) else { return false };
    match known(&id).map(|known| known.asks) {
        Some(Asks::Halt(command)) => *command == Command::Stop,
        Some(Asks::Move | Asks::Change) => {
            let letters: Vec<u8> = letters(payload).collect();
            MOVES.iter().any(|beginning| says_halt_behind(&letters, beginning))
        }
        Some(Asks::For(_) | Asks::GoOn | Asks::Goto) | None => false,
    }
}

impl Wrong {
    pub fn asked(&self) -> asked::Asked {
        match self {
            Wrong::NoMessage(_) => asked::Asked::Words("a message".to_owned()),
            Wrong::Content { id, .. } => asked::Asked::Words((*id).to_owned()),
            Wrong::Refused { command, .. } => asked::Asked::Command(command.clone()),
        }
    }

    pub fn refused(&self) -> Refused {
        match self {
            Wrong::NoMessage(_) => Refused::InWords(refusal("malformed", self.to_string())),
            Wrong::Content { .. } => Refused::InWords(refusal("unusable", self.to_string())),
            Wrong::Refused { refused, .. } => refused.clone(),
        }
    }
}

#[derive(Clone, Copy)]
struct Known {
    id: &'static str,
    asks: &'static Asks,
}

static MOVES: LazyLock<Vec<String>> = LazyLock::new(|| {
    let beginning = |Known { id, asks }: Known| match asks {
        Asks::Move => Some(format!("{id}(")),
        Asks::Change => Some(format!("{id}(robot,")),
        Asks::For(_) | Asks::Halt(_) | Asks::Goto | Asks::GoOn => None,
    };
    every().filter_map(beginning).collect()
});

fn every() -> impl Iterator<Item = Known> {
    ROWS.iter().flat_map(|row| row.messages.iter().map(|id| Known { id, asks: &row.asks }))
}

fn known(id: &str) -> Option<Known> {
    every().find(|known| known.id == id)
}

impl Known {
    fn command(&self, content: &Term) -> Result<Command, String> {
        let content = unquoted(content);
        match (self.asks, parts_of(self.id, &content)) {
            (Asks::Halt(command), _) | (Asks::For(command), Some(_)) => Ok(command.clone()),
            (Asks::GoOn, Some(_)) => Ok(Command::Start),
            (Asks::Goto, Some([Term::Number(x), Term::Number(y)])) => match (x.text().parse(), y.text().parse()) {
                (Ok(x), Ok(y)) => goto(x, y).map_err(|unusable| unusable.to_string()),
                _ => Err(self.other(&content)),
            },
            (Asks::Move, Some([Term::Atom(word)])) => move_word(word).map_err(|unusable| unusable.to_string()),
            (Asks::Change, Some([Term::Atom(of), Term::Atom(word)])) => match (of.as_str(), word.as_str()) {
                ("robot", word) => move_word(word).map_err(|unusable| unusable.to_string()),
                ("luggage", "safe") => Ok(SAFE),
                ("luggage", "danger") => Ok(DANGER),
                _ => Err(self.other(&content)),
            },
            (Asks::For(_) | Asks::GoOn | Asks::Goto | Asks::Move | Asks::Change, _) => Err(self.other(&content)),
        }
    }

    fn other(&self, content: &Term) -> String {
        let id = self.id;
        let expected = match self.asks {
            Asks::Halt(_) | Asks::For(_) | Asks::GoOn => id.to_owned(),
            Asks::Goto => format!("{id}(X,Y) with two whole numbers"),
            Asks::Move => format!("{id}(w) or another move"),
            Asks::Change => format!("{id}(robot,w) or another move, {id}(luggage,safe) or {id}(luggage,danger)"),
        };
        format!("expected {expected}, found {}", in_short(&content.to_string()))
    }
}

/// Returns the parts in the parentheses after `id`. Without parentheses the result is empty. Returns `None` if the
/// content does not begin with `id`.
fn parts_of<'a>(id: &str, content: &'a Term) -> Option<&'a [Term]> {
    match content {
        Term::Compound(name, parts) if name == id => Some(parts),
        Term::Atom(name) if name == id => Some(&[]),
        Term::Atom(_) | Term::Compound(..) | Term::Number(_) => None,
    }
}

/// Returns the CONTENT without surrounding quotes, as in `'startTest(1,2)'`.
fn unquoted(content: &Term) -> Term {
    let within = match content {
        Term::Atom(text) => Term::parse(text).ok(),
        Term::Number(_) | Term::Compound(..) => None,
    };
    within.unwrap_or_else(|| content.clone())
}

/// Returns the MSGID at the beginning of a payload, if a comma follows the MSGID.
fn beginning(payload: &[u8]) -> Option<String> {
    let id = opening(payload)?;
    (letters(payload).nth(OPENING.len() + id.len()) == Some(b',')).then_some(id)
}

const OPENING: &[u8] = b"msg(";

/// Number of bytes of a word that are compared. Every known MSGID is shorter than this.
const LONGEST: usize = 64;

/// Returns the word at the beginning of a message's first part, with or without quotes around it.
fn opening(payload: &[u8]) -> Option<String> {
    if !letters(payload).take(OPENING.len()).eq(OPENING.iter().copied()) {
        return None;
    }
    let word = letters(payload).skip(OPENING.len()).map(char::from).take_while(|letter| is_in_word(*letter));
    Some(word.take(LONGEST).collect())
}

/// The UTF-8 byte order mark. Some editors put it before a text.
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();

/// Returns the bytes of a payload without blanks, control characters and quotes. Double quotes are removed too,
/// although terms have only single quotes.
fn letters(payload: &[u8]) -> impl Iterator<Item = u8> {
    let text = payload.strip_prefix(BYTE_ORDER_MARK).unwrap_or(payload);
    let is_between = |letter: u8| letter.is_ascii_whitespace() || letter.is_ascii_control() || matches!(letter, b'\'' | b'"');
    text.iter().copied().filter(move |letter| !is_between(*letter))
}

/// Whether `beginning` occurs anywhere in `letters` with a STOP directly after it.
fn says_halt_behind(letters: &[u8], beginning: &str) -> bool {
    let starts = letters.windows(beginning.len()).enumerate().filter(|(_, window)| *window == beginning.as_bytes());
    starts.map(|(start, _)| &letters[start + beginning.len()..]).any(|rest| {
        let end = rest.iter().position(|letter| !is_in_word(char::from(*letter))).unwrap_or(rest.len());
        std::str::from_utf8(&rest[..end]).is_ok_and(is_halt)
    })
}

#[cfg(test)]
#[path = "incoming_tests.rs"]
mod tests;
