//! A message of the original system, `msg(MSGID,MSGTYPE,SENDER,RECEIVER,CONTENT,SEQNUM)`. Parsing accepts small
//! deviations; printing follows the exact form. The meaning of messages is in `incoming` and `outgoing`.

use std::fmt;

use super::reader::Unreadable;
use super::term::{Number, Printed, Term};
use crate::api::fields::in_short;

const MSG: &str = "msg";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// The MSGID, such as `startCmd`.
    pub id: String,
    pub kind: MessageKind,
    /// The SENDER, such as `js`.
    pub sender: String,
    /// The RECEIVER. It is `none` for an event.
    pub receiver: String,
    pub content: Term,
    /// The SEQNUM. Old clients write 1 in every message.
    pub number: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MessageKind {
    /// A message to all actors that listen.
    Event,
    /// A message to one receiver, without an answer.
    Dispatch,
    /// A message to one receiver, which must answer.
    Request,
    /// A message to one receiver, which may answer.
    Invitation,
    Reply,
}

/// `Display` gives a sentence for the log.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoMessage {
    #[error("the payload is no message: {0}")]
    Unreadable(#[from] Unreadable),
    #[error("the payload is no message: expected msg(MSGID,MSGTYPE,SENDER,RECEIVER,CONTENT,SEQNUM), found {0}")]
    OtherTerm(String),
    #[error("{part} is {found}: expected {expected}")]
    Part {
        /// The name of the part, such as `SENDER`.
        part: &'static str,
        found: String,
        expected: &'static str,
    },
}

impl Message {
    /// Parses a payload. Blanks around its parts and a line end after it are ignored.
    ///
    /// # Errors
    /// When the payload is not text, not a term, or a term that is not a message.
    pub fn parse(payload: &[u8]) -> Result<Message, NoMessage> {
        let no_text = |error: std::str::Utf8Error| Unreadable::NotText { at: error.valid_up_to() };
        match Term::parse(std::str::from_utf8(payload).map_err(no_text)?)? {
            Term::Compound(name, parts) if name == MSG => Message::of(parts),
            other @ (Term::Atom(_) | Term::Number(_) | Term::Compound(..)) => {
                Err(NoMessage::OtherTerm(in_short(&other.to_string())))
            }
        }
    }

    fn of(parts: Vec<Term>) -> Result<Message, NoMessage> {
        let parts: [Term; 6] =
            parts.try_into().map_err(|parts: Vec<Term>| NoMessage::OtherTerm(format!("msg with {} parts", parts.len())))?;
        let [id, kind, sender, receiver, content, number] = parts;
        Ok(Message {
            id: atom("MSGID", id)?,
            kind: MessageKind::of(kind)?,
            sender: atom("SENDER", sender)?,
            receiver: atom("RECEIVER", receiver)?,
            content,
            number: count(&number)?,
        })
    }
}

impl fmt::Display for Message {
    /// Prints the message without blanks around the commas.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (id, sender, receiver) = (Printed(&self.id), Printed(&self.sender), Printed(&self.receiver));
        write!(f, "{MSG}({id},{},{sender},{receiver},{},{})", self.kind.name(), self.content, self.number)
    }
}

impl MessageKind {
    pub const ALL: [MessageKind; 5] =
        [MessageKind::Event, MessageKind::Dispatch, MessageKind::Request, MessageKind::Invitation, MessageKind::Reply];

    pub const fn name(self) -> &'static str {
        match self {
            MessageKind::Event => "event",
            MessageKind::Dispatch => "dispatch",
            MessageKind::Request => "request",
            MessageKind::Invitation => "invitation",
            MessageKind::Reply => "reply",
        }
    }

    fn of(term: Term) -> Result<MessageKind, NoMessage> {
        let expected = "event, dispatch, request, invitation or reply";
        let known =
            matches!(term, Term::Atom(_)).then(|| MessageKind::ALL.into_iter().find(|kind| term.name() == Some(kind.name())));
        known.flatten().ok_or_else(|| wrong("MSGTYPE", &term, expected))
    }
}

fn atom(part: &'static str, term: Term) -> Result<String, NoMessage> {
    match term {
        Term::Atom(text) => Ok(text),
        other @ (Term::Number(_) | Term::Compound(..)) => Err(wrong(part, &other, "a word")),
    }
}

fn count(term: &Term) -> Result<u64, NoMessage> {
    let number = match term {
        Term::Number(number) => Number::text(number).parse().ok(),
        Term::Atom(_) | Term::Compound(..) => None,
    };
    number.ok_or_else(|| wrong("SEQNUM", term, "a whole number from 0"))
}

fn wrong(part: &'static str, found: &Term, expected: &'static str) -> NoMessage {
    NoMessage::Part { part, found: in_short(&found.to_string()), expected }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::term::tests::any_term;
    use super::*;

    fn any_message() -> impl Strategy<Value = Message> {
        let word = || prop_oneof![3 => "[a-zA-Z]{1,10}", 1 => "\\PC{0,8}"];
        let parts = (word(), prop::sample::select(&MessageKind::ALL[..]), word(), word(), any_term(), any::<u64>());
        parts.prop_map(|(id, kind, sender, receiver, content, number)| Message { id, kind, sender, receiver, content, number })
    }

    proptest! {
        #[test]
        fn a_message_that_is_printed_is_read_again_as_the_same(message in any_message()) {
            let printed = message.to_string();
            let read = Message::parse(printed.as_bytes());
            prop_assert_eq!(read.as_ref(), Ok(&message));
            prop_assert_eq!(read.unwrap().to_string(), printed);
        }
    }

    #[test]
    fn messages_of_the_original_system_are_read_and_printed_as_they_were() {
        let texts = [
            "msg(startCmd,event,js,none,startCmd,1)",
            "msg(stopCmd,dispatch,js,robotmind,stopCmd,1)",
            "msg(startTest,dispatch,console,robotmind,startTest(0,8),3)",
            "msg(userCmd,dispatch,js,robotmind,userCmd(w),1)",
            "msg(sonarRobot,event,sonar,none,sonar(12.5),44)",
            "msg(modelContent,event,resourcemodel,none,content(robot(state(stopped),direction(downDir),position(0,0))),7)",
            "msg(modelContent,event,resourcemodel,none,content(roomMap(state('r 1 1 X @1 1 1 X @X X 0 X @'))),8)",
            "msg(answer,reply,a,b,done,2)",
        ];
        for text in texts {
            let message = Message::parse(text.as_bytes()).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!(message.to_string(), text);
        }
    }

    #[test]
    fn blanks_quotes_and_a_line_end_do_not_matter() {
        let neat = Message::parse(b"msg(startTest,dispatch,js,robotmind,startTest(1,2),1)").unwrap();
        for text in [
            "msg( startTest, dispatch, js, robotmind, startTest( 1, 2 ), 1 )\n",
            "\tmsg ('startTest',dispatch,'js',robotmind,startTest(1,2),01)\r\n",
        ] {
            assert_eq!(Message::parse(text.as_bytes()), Ok(neat.clone()), "{text}");
        }
    }

    #[test]
    fn what_is_no_message_is_told_why() {
        let cases: [(&[u8], &str); 9] = [
            (b"", "the payload is no message: at byte 0: expected a word, a number or a text in '\u{2026}', found the end"),
            (b"msg(\xff)", "the payload is no message: the text is no UTF-8 from byte 4 on"),
            (b"start", "the payload is no message: expected msg(MSGID,MSGTYPE,SENDER,RECEIVER,CONTENT,SEQNUM), found start"),
            (
                b"msg(a,b)",
                "the payload is no message: expected msg(MSGID,MSGTYPE,SENDER,RECEIVER,CONTENT,SEQNUM), found msg with 2 parts",
            ),
            (b"msg(1,event,a,none,a,1)", "MSGID is 1: expected a word"),
            (b"msg(a,shout,a,none,a,1)", "MSGTYPE is shout: expected event, dispatch, request, invitation or reply"),
            (b"msg(a,event(),a,none,a,1)", "MSGTYPE is event(): expected event, dispatch, request, invitation or reply"),
            (b"msg(a,event,f(x),none,a,1)", "SENDER is f(x): expected a word"),
            (b"msg(a,event,a,none,a,-1)", "SEQNUM is -1: expected a whole number from 0"),
        ];
        for (payload, words) in cases {
            assert_eq!(Message::parse(payload).unwrap_err().to_string(), words);
        }
    }
}
