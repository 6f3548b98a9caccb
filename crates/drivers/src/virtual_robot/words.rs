//! The messages of the virtual robot's server in both versions: JSON between semicolons over TCP, and JSON messages
//! over WebSocket. Other files decide how to react to them.
//!
//! The server ends if a message comes in two parts or is not valid JSON. So each message is sent as a whole, and is
//! written by `serde_json`.

use std::time::Duration;

use serde::Deserialize;
use serde_json::{Value, json};

use hallsweep_core::words::is_visible;

/// Maximum number of stored bytes of an incomplete message. No message of the server is nearly that long.
const LONGEST: usize = 4096;

/// Maximum length of a thing's name, in letters. A longer name is cut, because it is written into a log line, a
/// drawing and a small file.
const LONGEST_NAME: usize = 64;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Command {
    Forward(Duration),
    Backward(Duration),
    Left(Duration),
    Right(Duration),
    /// Stops driving straight. A turn goes on.
    Alarm,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Heard {
    /// A page with the robot is open.
    Page,
    /// The robot has met something. The name is included if the server reports it.
    Contact(Option<String>),
    /// A move has ended, with or without a contact. The name of the move is included if the server reports it.
    Ended(Option<&'static str>),
    /// A move was refused because another one was running. The name of the move is included if the server reports it.
    Refused(Option<&'static str>),
}

/// The names of moves. Servers append suffixes to them: `_notallowed`, `_Asynch_halted`, `-collision`, `_notallowed
/// (asynch)`.
const MOVES: [&str; 4] = ["moveForward", "moveBackward", "turnLeft", "turnRight"];

impl Command {
    pub(super) const fn word(self) -> &'static str {
        match self {
            Command::Forward(_) => "moveForward",
            Command::Backward(_) => "moveBackward",
            Command::Left(_) => "turnLeft",
            Command::Right(_) => "turnRight",
            Command::Alarm => "alarm",
        }
    }

    fn ms(self) -> Option<u64> {
        match self {
            Command::Forward(lasts) | Command::Backward(lasts) | Command::Left(lasts) | Command::Right(lasts) => {
                u64::try_from(lasts.as_millis()).ok()
            }
            Command::Alarm => None,
        }
    }

    /// The message in the form for the first version of the server.
    pub(super) fn between_semicolons(self) -> Vec<u8> {
        let message = match self.ms() {
            Some(ms) => json!({"type": self.word(), "arg": ms}),
            None => json!({"type": self.word()}),
        };
        format!(";{message};").into_bytes()
    }

    /// The message in the form for the server of 2021.
    pub(super) fn as_message(self) -> Vec<u8> {
        json!({"robotmove": self.word(), "time": self.ms().unwrap_or(0)}).to_string().into_bytes()
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct Stream {
    begun: Vec<u8>,
    /// Whether the message was too long, so that the rest of it is skipped.
    skips: bool,
}

impl Stream {
    pub(super) fn read(&mut self, bytes: &[u8]) -> Vec<Heard> {
        let mut heard = Vec::new();
        for byte in bytes {
            if *byte == b';' {
                let message = std::mem::take(&mut self.begun);
                if !std::mem::take(&mut self.skips) {
                    heard.extend(typed(&message));
                }
            } else if self.begun.len() < LONGEST {
                self.begun.push(*byte);
            } else {
                self.skips = true;
            }
        }
        heard
    }

    /// Drops an incomplete message when a new connection begins.
    pub(super) fn begin(&mut self) {
        *self = Stream::default();
    }
}

#[derive(Deserialize)]
struct Typed {
    r#type: String,
    #[serde(default)]
    arg: Value,
}

fn typed(message: &[u8]) -> Option<Heard> {
    let Typed { r#type, arg } = serde_json::from_slice(message).ok()?;
    match r#type.as_str() {
        "webpage-ready" => Some(Heard::Page),
        "collision" => Some(Heard::Contact(arg.get("objectName").and_then(name))),
        // The sonars belong to the hall and see the robot. The robot has no sonar of its own.
        _ => None,
    }
}

/// Reads a message of the server of 2021 or later. The versions differ. A collision may have a target. A move ends
/// with `true` or `"true"`. A refusal is `"notallowed"`, or the name of the move followed by this word.
pub(super) fn message(bytes: &[u8]) -> Option<Heard> {
    let said: Value = serde_json::from_slice(bytes.get(..bytes.len().min(LONGEST))?).ok()?;
    if said.get("collision").is_some_and(|collision| *collision != Value::Bool(false)) {
        return Some(Heard::Contact(said.get("target").and_then(name)));
    }
    let ended = said.get("endmove")?;
    let which = said.get("move").and_then(Value::as_str).unwrap_or_default();
    let of = MOVES.into_iter().find(|word| which.starts_with(word));
    let says = |word| which.contains(word) || ended.as_str().is_some_and(|ended| ended.contains(word));
    if says("notallowed") {
        return Some(Heard::Refused(of));
    }
    // The contact itself has a message of its own.
    if ["halt", "interrupted", "collision"].into_iter().any(says) {
        return None;
    }
    let is = |value: bool| *ended == Value::Bool(value) || ended.as_str() == Some(if value { "true" } else { "false" });
    // A result `false` means a collision, which has its own message. With the name of a move, `false` can also be the
    // result of another move, which the server reports under this name.
    (is(true) || (is(false) && of.is_some())).then_some(Heard::Ended(of))
}

fn name(value: &Value) -> Option<String> {
    let name: String = value.as_str()?.chars().filter(|letter| is_visible(*letter)).take(LONGEST_NAME).collect();
    (!name.is_empty()).then_some(name)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn read(text: &str) -> Vec<Heard> {
        Stream::default().read(text.as_bytes())
    }

    #[test]
    fn commands_are_as_the_servers_want_them() {
        let forward = Command::Forward(Duration::from_millis(330));
        assert_eq!(String::from_utf8(forward.between_semicolons()).unwrap(), r#";{"arg":330,"type":"moveForward"};"#);
        assert_eq!(String::from_utf8(Command::Alarm.between_semicolons()).unwrap(), r#";{"type":"alarm"};"#);
        let left = Command::Left(Duration::from_millis(400));
        assert_eq!(String::from_utf8(left.as_message()).unwrap(), r#"{"robotmove":"turnLeft","time":400}"#);
    }

    #[test]
    fn what_the_first_server_says_is_understood_however_it_comes() {
        let said = ";{\"type\":\"webpage-ready\",\"arg\":{}};\n;{\"type\":\"collision\",\"arg\":{\"objectName\":\"wallRight\"}};\n\
                    ;{\"type\":\"sonar-activated\",\"arg\":{\"sonarName\":\"sonar2\",\"distance\":14,\"axis\":\"x\"}};\n;rubbish;";
        let expect = [Heard::Page, Heard::Contact(Some("wallRight".into()))];
        assert_eq!(read(said), expect);
        let mut stream = Stream::default();
        let in_bytes: Vec<Heard> = said.bytes().flat_map(|byte| stream.read(&[byte])).collect();
        assert_eq!(in_bytes, expect);
    }

    #[test]
    fn what_is_too_long_is_passed_over_and_the_next_is_read() {
        let long = format!(";{{\"type\":\"{}\"}};\n;{{\"type\":\"webpage-ready\"}};", "x".repeat(LONGEST));
        assert_eq!(read(&long), [Heard::Page]);
        let turned = ";{\"type\":\"collision\",\"arg\":{\"objectName\":\"wall\u{202e}\u{2028}Right 2\"}};";
        assert_eq!(read(turned), [Heard::Contact(Some("wallRight 2".into()))]);
        let name = format!(";{{\"type\":\"collision\",\"arg\":{{\"objectName\":\"{}\"}}}};", "n".repeat(500));
        assert_eq!(read(&name), [Heard::Contact(Some("n".repeat(LONGEST_NAME)))]);
    }

    #[test]
    fn what_the_later_servers_say_is_understood_in_each_of_their_ways() {
        for (said, expect) in [
            (r#"{"endmove":true,"move":"moveForward"}"#, Some(Heard::Ended(Some("moveForward")))),
            (r#"{"endmove":"true","move":"turnLeft"}"#, Some(Heard::Ended(Some("turnLeft")))),
            (r#"{"endmove":true}"#, Some(Heard::Ended(None))),
            (r#"{"endmove":false,"move":"moveForward"}"#, Some(Heard::Ended(Some("moveForward")))),
            (r#"{"endmove":"halted","move":"moveForward"}"#, None),
            (r#"{"endmove":false,"move":"moveForward_halted"}"#, None),
            (r#"{"endmove":false,"move":"moveForward_notallowed"}"#, Some(Heard::Refused(Some("moveForward")))),
            (r#"{"endmove":"notallowed","move":"moveForward"}"#, Some(Heard::Refused(Some("moveForward")))),
            (r#"{"endmove":"notallowed"}"#, Some(Heard::Refused(None))),
            (r#"{"endmove":"false","move":"moveBackward_notallowed (asynch)"}"#, Some(Heard::Refused(Some("moveBackward")))),
            (r#"{"endmove":false,"move":"turnRight_Asynch_halted"}"#, None),
            (r#"{"endmove":"false","move":"moveForward-interrupted"}"#, None),
            (r#"{"endmove":"false","move":"moveForward-collision"}"#, None),
            (r#"{"endmove":"true","move":"haltnoop"}"#, None),
            (r#"{"endmove":"JSON error","move":"unknown"}"#, None),
            (r#"{"endmove":true,"move":"forward"}"#, Some(Heard::Ended(None))),
            (r#"{"collision":"moveForward","target":"wallDown"}"#, Some(Heard::Contact(Some("wallDown".into())))),
            (r#"{"collision":true,"move":"unknown"}"#, Some(Heard::Contact(None))),
            (r#"{"sonarName":"sonar1","distance":1,"axis":"x"}"#, None),
            ("[]", None),
            ("", None),
        ] {
            assert_eq!(message(said.as_bytes()), expect, "{said}");
        }
    }

    proptest! {
        #[test]
        fn no_bytes_however_cut_make_more_of_it_than_it_is(bytes: Vec<u8>, cut: prop::sample::Index) {
            let (first, second) = bytes.split_at(cut.index(bytes.len() + 1));
            let mut stream = Stream::default();
            let mut heard = stream.read(first);
            heard.extend(stream.read(second));
            prop_assert_eq!(heard, Stream::default().read(&bytes));
            prop_assert!(stream.begun.len() <= LONGEST);
            message(&bytes);
        }
    }
}
