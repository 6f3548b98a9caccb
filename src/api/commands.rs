//! THE TABLE of commands, from which every door makes its own: HTTP its routes, CoAP its paths, MQTT its topics, and their pages. A new
//! command is one row here, and what it does in the core. What its fields mean stands in `command`; how a payload is read is each door's own.

use super::command::{EpochBody, GotoBody, MoveBody, StrategyBody, TemperatureBody, VerdictBody};
use super::fields::{Body, Unusable};
use crate::access::Need;
use hallsweep_core::command::{Command, LuggageRef};
use hallsweep_core::units::{AlarmId, Epoch, LuggageId};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CommandKind {
    Start,
    Stop,
    BackHome,
    Retrieve,
    Reset,
    Move,
    Goto,
    Verdict,
    Retake,
    Acknowledge,
    Strategy,
    Temperature,
}

/// Where the number of what a command is about comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// It is about nothing that has a number.
    None,
    /// About a piece: its number stands in the path, and in `luggage` where there is none.
    Luggage,
    /// About an alarm: its number stands in the path, and in `alarm` where there is none.
    Alarm,
}

/// The methods by which a path asks for a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Methods {
    /// It is done anew each time: POST.
    Post,
    /// It says how something is: POST over HTTP, PUT as well over CoAP.
    PostOrPut,
    /// It sets what is shown at its path: PUT over HTTP, POST as well over CoAP.
    Put,
}

/// One command.
#[derive(Clone, Copy, Debug)]
pub struct CommandRow {
    /// The last word of its topic.
    pub name: &'static str,
    /// What it does, in a few words.
    pub title: &'static str,
    /// Which it is.
    pub kind: CommandKind,
    /// What its sender must be allowed at least. A move may turn out to be a STOP, and asks for more when it is none.
    pub need: Need,
    /// Its path under `/api/v1` and at the CoAP door; `{id}` stands for the number of its subject.
    pub path: &'static str,
    /// How it is asked for there.
    pub methods: Methods,
    /// What it is about.
    pub subject: Subject,
    /// What it carries where there are no paths, beside its own name.
    pub body: &'static [&'static str],
    /// Whether it can do without a payload, and so come as a bare word.
    pub is_word: bool,
}

/// What a movement command may carry.
const EPOCH: &[&str] = &[r#"{"epoch":4}"#];

/// All of them, in the order in which they are listed.
#[rustfmt::skip]
pub const COMMANDS: [CommandRow; 12] = [
    word("start", "/commands/start", "begin, or go on", CommandKind::Start, EPOCH),
    CommandRow { need: Need::Stop, ..word("stop", "/commands/stop", "halt the robot", CommandKind::Stop, &[]) },
    word("backHome", "/commands/backHome", "go home and wait", CommandKind::BackHome, EPOCH),
    word("retrieve", "/commands/retrieve", "fetch the dangerous piece", CommandKind::Retrieve, EPOCH),
    word("reset", "/commands/reset", "put the mission away", CommandKind::Reset, &[]),
    CommandRow { need: Need::Stop, ..with("move", "/commands/move", "one move by hand", CommandKind::Move,
        &[r#"{"move":"w"}"#, r#"{"move":"h"}"#]) },
    with("goto", "/commands/goto", "drive to a cell", CommandKind::Goto, &[r#"{"x":1,"y":1}"#]),
    CommandRow { subject: Subject::Luggage, methods: Methods::PostOrPut,
        ..with("verdict", "/luggage/{id}/verdict", "safe or danger", CommandKind::Verdict,
            &[r#"{"luggage":3,"verdict":"safe"}"#, r#"{"luggage":3,"verdict":"danger","note":"wires"}"#]) },
    CommandRow { subject: Subject::Luggage,
        ..with("retake", "/luggage/{id}/photo", "take the photo again", CommandKind::Retake, &[r#"{"luggage":3}"#]) },
    CommandRow { subject: Subject::Alarm,
        ..with("acknowledge", "/alarms/{id}/acknowledge", "the alarm was seen", CommandKind::Acknowledge, &[r#"{"alarm":2}"#]) },
    CommandRow { methods: Methods::Put,
        ..with("strategy", "/strategy", "choose the order of the search", CommandKind::Strategy, &[r#"{"name":"snail"}"#]) },
    CommandRow { methods: Methods::Put,
        ..with("temperature", "/temperature", "what is known of the temperature", CommandKind::Temperature,
            &[r#"{"celsius":21.5}"#, r#"{"celsius":21.5,"sensor":"roof"}"#, r#"{"status":"ok"}"#, r#"{"status":"tooHigh"}"#]) },
];

/// The command of this name.
pub fn named(name: &str) -> Option<&'static CommandRow> {
    COMMANDS.iter().find(|row| row.name == name)
}

impl CommandKind {
    pub fn row(self) -> &'static CommandRow {
        COMMANDS.iter().find(|row| row.kind == self).expect("every kind has its row: a test holds that")
    }
}

/// What came with a command, as a door reads it.
pub trait Payload {
    /// What the door says when it cannot be read.
    type Problem: From<Unusable>;

    /// The body that a command needs.
    fn needed<T: Body>(&self) -> Result<T, Self::Problem>;

    /// The body that a command can do without.
    fn optional<T: Body + Default>(&self) -> Result<T, Self::Problem>;
}

/// The command that is asked for, and the epoch its sender saw; `number` is that of its subject.
pub fn asked<P: Payload>(kind: CommandKind, number: u64, payload: &P) -> Result<(Command, Option<Epoch>), P::Problem> {
    let with_epoch = |command| Ok((command, payload.optional::<EpochBody>()?.epoch()));
    let bare = |command| payload.optional::<EpochBody>().map(|_| (command, None));
    let luggage = LuggageRef::Id(LuggageId(number));
    match kind {
        CommandKind::Stop => Ok((Command::Stop, None)),
        CommandKind::Start => with_epoch(Command::Start),
        CommandKind::BackHome => with_epoch(Command::BackHome),
        CommandKind::Retrieve => with_epoch(Command::Retrieve),
        CommandKind::Reset => with_epoch(Command::Reset),
        CommandKind::Move => Ok(payload.needed::<MoveBody>()?.command()?),
        CommandKind::Goto => Ok(payload.needed::<GotoBody>()?.command()?),
        CommandKind::Verdict => Ok((payload.needed::<VerdictBody>()?.command(luggage)?, None)),
        CommandKind::Retake => bare(Command::RetakePhoto(LuggageId(number))),
        CommandKind::Acknowledge => bare(Command::Acknowledge(AlarmId(number))),
        CommandKind::Strategy => Ok((Command::ChooseStrategy(payload.needed::<StrategyBody>()?.strategy()?), None)),
        CommandKind::Temperature => Ok((Command::Temperature(payload.needed::<TemperatureBody>()?.report()?), None)),
    }
}

/// A command for operators that can do without a payload.
const fn word(
    name: &'static str,
    path: &'static str,
    title: &'static str,
    kind: CommandKind,
    body: &'static [&'static str],
) -> CommandRow {
    CommandRow { name, title, kind, need: Need::Act, path, methods: Methods::Post, subject: Subject::None, body, is_word: true }
}

/// A command for operators that needs a payload.
const fn with(
    name: &'static str,
    path: &'static str,
    title: &'static str,
    kind: CommandKind,
    body: &'static [&'static str],
) -> CommandRow {
    CommandRow { is_word: false, ..word(name, path, title, kind, body) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_name_is_there_twice_and_every_name_is_a_part_of_a_topic() {
        let mut names: Vec<&str> = COMMANDS.iter().map(|row| row.name).collect();
        assert!(names.iter().all(|name| name.bytes().all(|byte| byte.is_ascii_alphabetic())));
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), COMMANDS.len());
        assert!(COMMANDS.iter().all(|row| named(row.name).is_some_and(|found| found.kind == row.kind)));
    }

    /// As many rows as kinds, each with its own: whoever adds a kind adds its row.
    #[test]
    fn every_kind_has_its_row() {
        let last = CommandKind::Temperature as usize;
        let mut kinds: Vec<usize> = COMMANDS.iter().map(|row| row.kind as usize).collect();
        kinds.sort_unstable();
        assert_eq!(kinds, (0..=last).collect::<Vec<_>>());
        assert!(COMMANDS.iter().all(|row| row.kind.row().name == row.name));
    }

    #[test]
    fn a_path_has_a_place_for_the_number_of_what_it_is_about() {
        assert!(COMMANDS.iter().all(|row| row.path.contains("{id}") == (row.subject != Subject::None)));
    }

    /// Safety S1.
    #[test]
    fn only_what_may_be_a_stop_asks_for_no_operator() {
        let open: Vec<CommandKind> = COMMANDS.iter().filter(|row| row.need != Need::Act).map(|row| row.kind).collect();
        assert_eq!(open, [CommandKind::Stop, CommandKind::Move]);
    }
}
