//! From the payload of a command in JSON to the core's command, with its own name. What the fields mean stands in
//! `crate::api::command`, and what can come in `table`.

use super::problem::Problem;
use super::table::{CommandKind, Row};
use crate::api::command::{EpochBody, GotoBody, MoveBody, StrategyBody, TemperatureBody, VerdictBody, id_aside, number_aside};
use crate::api::fields::{Body, Fields, fields};
use crate::api::halt::says_halt;
use hallsweep_core::command::{Command, CommandId, LuggageRef};
use hallsweep_core::units::{AlarmId, Epoch, LuggageId};

/// Larger payloads are no commands: a command is a few dozen bytes.
pub(super) const LARGEST: usize = 4 * 1024;

/// The command that is asked for, and the epoch its sender saw.
pub(super) type Asked = Result<(Command, Option<Epoch>), Problem>;

/// What a payload says.
pub(super) struct Read {
    /// The command's own name, also when the rest cannot be read.
    pub(super) id: Option<CommandId>,
    /// What is asked for.
    pub(super) asked: Asked,
}

/// Reads the payload of a command. A STOP is one whatever its payload is.
pub(super) fn read(row: &Row, payload: &[u8]) -> Read {
    if row.kind == CommandKind::Stop || (row.kind == CommandKind::Move && says_halt(payload)) {
        return Read { id: id_of_a_stop(payload), asked: Ok((Command::Stop, None)) };
    }
    let nameless = |problem| Read { id: None, asked: Err(problem) };
    let mut fields = match sized(payload).and_then(|payload| fields_of(row, payload)) {
        Ok(fields) => fields,
        Err(problem) => return nameless(problem),
    };
    match id_aside(&mut fields) {
        Ok(id) => Read { id, asked: command(row.kind, &mut fields) },
        Err(unread) => nameless(unread.into()),
    }
}

/// A payload that is not larger than any command.
pub(super) fn sized(payload: &[u8]) -> Result<&[u8], Problem> {
    if payload.len() > LARGEST { Err(Problem::too_large(payload.len(), LARGEST)) } else { Ok(payload) }
}

/// A word without the blanks round it and the quotes of JSON.
pub(super) fn bare(text: &str) -> &str {
    let text = text.trim();
    text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or(text)
}

fn command(kind: CommandKind, fields: &mut Fields) -> Asked {
    let plain = |command| Ok((command, None));
    match kind {
        CommandKind::Stop => plain(Command::Stop),
        CommandKind::Start => with_epoch(Command::Start, fields),
        CommandKind::BackHome => with_epoch(Command::BackHome, fields),
        CommandKind::Retrieve => with_epoch(Command::Retrieve, fields),
        CommandKind::Reset => with_epoch(Command::Reset, fields),
        CommandKind::Move => Ok(body::<MoveBody>(fields)?.command()?),
        CommandKind::Goto => Ok(body::<GotoBody>(fields)?.command()?),
        CommandKind::Verdict => {
            let luggage = LuggageRef::Id(luggage(fields, r#"{"luggage":3,"verdict":"safe"}"#)?);
            plain(Command::Verdict { luggage, verdict: body::<VerdictBody>(fields)?.verdict()? })
        }
        CommandKind::Retake => {
            let id = luggage(fields, r#"{"luggage":3}"#)?;
            body::<EpochBody>(fields).and_then(|_| plain(Command::RetakePhoto(id)))
        }
        CommandKind::Acknowledge => {
            let id = AlarmId(number_aside(fields, "alarm", r#"{"alarm":2}"#)?);
            body::<EpochBody>(fields).and_then(|_| plain(Command::Acknowledge(id)))
        }
        CommandKind::Strategy => plain(Command::ChooseStrategy(body::<StrategyBody>(fields)?.strategy()?)),
        CommandKind::Temperature => plain(Command::Temperature(body::<TemperatureBody>(fields)?.report()?)),
    }
}

fn with_epoch(command: Command, fields: &Fields) -> Asked {
    Ok((command, body::<EpochBody>(fields)?.epoch()))
}

fn luggage(fields: &mut Fields, example: &str) -> Result<LuggageId, Problem> {
    Ok(LuggageId(number_aside(fields, "luggage", example)?))
}

fn body<T: Body>(fields: &Fields) -> Result<T, Problem> {
    fields.read().map_err(Problem::from)
}

/// The fields of a payload; without one, none, where the command can do without.
fn fields_of(row: &Row, payload: &[u8]) -> Result<Fields, Problem> {
    match (payload.trim_ascii().is_empty(), row.is_word) {
        (true, true) => Ok(Fields::default()),
        (true, false) => Err(Problem::malformed("the payload is empty: this command needs JSON, see docs/mqtt.md".to_owned())),
        (false, _) => Ok(fields(payload)?),
    }
}

/// The name of a STOP, where it can be read.
pub(super) fn id_of_a_stop(payload: &[u8]) -> Option<CommandId> {
    let mut fields = fields(sized(payload).ok()?).ok()?;
    id_aside(&mut fields).ok().flatten()
}
