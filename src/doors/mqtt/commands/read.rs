//! Parses the JSON payload of a command into the core's command and the command id. The fields are described in
//! `crate::api::command`, the commands in `crate::api::commands`.

use super::problem::Problem;
use crate::api::command::{id_aside, number_aside};
use crate::api::commands::{self, CommandKind, CommandRow, Payload, Subject};
use crate::api::fields::{Body, BodyFields, fields};
use crate::api::halt::says_halt;
use hallsweep_core::command::{Command, CommandId};
use hallsweep_core::units::Epoch;

/// Maximum size of a payload in bytes: a command is a few dozen bytes.
pub(super) const LARGEST: usize = 4 * 1024;

pub(super) type AskedCommand = Result<(Command, Option<Epoch>), Problem>;

pub(super) struct Read {
    /// The command id, even if the other fields are invalid.
    pub(super) id: Option<CommandId>,
    pub(super) asked: AskedCommand,
}

/// Reads the command in a payload. A STOP is accepted whatever its payload is (safety S8).
pub(super) fn read(row: &CommandRow, payload: &[u8]) -> Read {
    if row.kind == CommandKind::Stop || (row.kind == CommandKind::Move && says_halt(payload)) {
        return Read { id: id_in(payload), asked: Ok((Command::Stop, None)) };
    }
    let nameless = |problem| Read { id: None, asked: Err(problem) };
    let mut fields = match sized(payload).and_then(|payload| fields_of(row, payload)) {
        Ok(fields) => fields,
        Err(problem) => return nameless(problem),
    };
    match id_aside(&mut fields) {
        Ok(id) => Read { id, asked: command(row, &mut fields) },
        Err(unread) => nameless(unread.into()),
    }
}

pub(super) fn sized(payload: &[u8]) -> Result<&[u8], Problem> {
    if payload.len() <= LARGEST {
        return Ok(payload);
    }
    let bytes = payload.len();
    Err(Problem::too_large(format!("the payload has {bytes} bytes: the maximum is {LARGEST}; a command needs a few dozen")))
}

/// Returns a word without surrounding blanks and double quotes, because a sender may write it as a JSON string.
pub(super) fn bare(text: &str) -> &str {
    let text = text.trim();
    text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or(text)
}

fn command(row: &CommandRow, fields: &mut BodyFields) -> AskedCommand {
    let number = match row.subject {
        Subject::None => 0,
        Subject::Luggage => number_aside(fields, "luggage", row.body[0])?,
        Subject::Alarm => number_aside(fields, "alarm", row.body[0])?,
    };
    commands::asked(row.kind, number, &CarriedFields(fields))
}

/// The fields of a payload. The command id and the number of the piece or alarm were removed before.
struct CarriedFields<'a>(&'a BodyFields);

impl Payload for CarriedFields<'_> {
    type Problem = Problem;

    fn needed<T: Body>(&self) -> Result<T, Problem> {
        self.0.read().map_err(Problem::from)
    }

    fn optional<T: Body + Default>(&self) -> Result<T, Problem> {
        self.needed()
    }
}

/// Returns the fields of a payload. For a command without arguments the payload may be empty.
fn fields_of(row: &CommandRow, payload: &[u8]) -> Result<BodyFields, Problem> {
    match (payload.trim_ascii().is_empty(), row.is_word()) {
        (true, true) => Ok(BodyFields::default()),
        (true, false) => Err(Problem::malformed("the payload is empty: this command needs JSON, see docs/mqtt.md".to_owned())),
        (false, _) => Ok(fields(payload)?),
    }
}

/// Returns the command id in a payload, and ignores all other fields. This is used for a STOP, for example.
pub(super) fn id_in(payload: &[u8]) -> Option<CommandId> {
    let mut fields = fields(sized(payload).ok()?).ok()?;
    id_aside(&mut fields).ok().flatten()
}
