//! THE TABLE of commands. Every door derives its addresses from this table: HTTP its routes, CoAP its paths, MQTT its
//! topics. The lists of commands in `docs/` are derived from it, too. A new command needs one row here, and its
//! effect in the core. The fields of each command are in `command`; each door reads payloads in its own way.

use super::command::{
    AreaBody, CloseAreaBody, CloseBody, EpochBody, GotoBody, HandOverBody, MoveBody, OrderAreasBody, RetrieveBody, StrategyBody,
    TemperatureBody, VerdictBody,
};
use super::fields::{Body, Unusable};
use crate::access::Need;
use hallsweep_core::command::{Command, LuggageRef};
use hallsweep_core::units::{AlarmId, Epoch, LuggageId};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum CommandKind {
    Start,
    Stop,
    BackHome,
    GoOn,
    Retrieve,
    Reset,
    Close,
    HandOver,
    SearchAgain,
    OrderAreas,
    CloseArea,
    Move,
    Goto,
    Verdict,
    Retake,
    Acknowledge,
    Strategy,
    Temperature,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    None,
    /// A piece of luggage. Its number is in the path; at doors without paths, in the field `luggage`.
    Luggage,
    /// An alarm. Its number is in the path; at doors without paths, in the field `alarm`.
    Alarm,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Methods {
    /// POST, for a command that acts each time it is sent.
    Post,
    /// For a command that reports a state: POST over HTTP, POST or PUT over CoAP.
    PostOrPut,
    /// For a command that sets the resource at its path: PUT over HTTP, PUT or POST over CoAP.
    Put,
}

#[derive(Clone, Copy, Debug)]
pub struct CommandRow {
    pub name: &'static str,
    pub title: &'static str,
    pub kind: CommandKind,
    /// The least right that a sender needs. For `move` this is the right to STOP, because a move may be a STOP. Other
    /// moves need more rights.
    pub need: Need,
    /// Path under `/api/v1` and at the CoAP door; `{id}` stands for the number of the subject.
    pub path: &'static str,
    pub methods: Methods,
    pub subject: Subject,
    /// Examples of the payload at doors without paths. The command id is left out.
    pub body: &'static [&'static str],
}

const EPOCH: &[&str] = &[r#"{"epoch":4}"#];

/// The doors and `docs/` list the commands in this order.
#[rustfmt::skip]
pub const COMMANDS: [CommandRow; 18] = [
    word("start", "/commands/start", "begin or resume the mission", CommandKind::Start, EPOCH),
    CommandRow { need: Need::Stop, ..word("stop", "/commands/stop", "halt the robot", CommandKind::Stop, &[]) },
    word("backHome", "/commands/backHome", "go home and wait", CommandKind::BackHome, EPOCH),
    word("goOn", "/commands/goOn", "go on with the search after a find", CommandKind::GoOn, EPOCH),
    word("retrieve", "/commands/retrieve", "fetch a dangerous piece", CommandKind::Retrieve,
        &[r#"{"epoch":4}"#, r#"{"luggage":3}"#]),
    word("reset", "/commands/reset", "end the mission", CommandKind::Reset, &[]),
    word("close", "/commands/close", "state that the search is over", CommandKind::Close,
        &[r#"{"name":"Anna Rossi","openPoints":"7:0,1,21,0,0,111,0"}"#]),
    word("handOver", "/commands/handOver", "hand the mission over", CommandKind::HandOver,
        &[r#"{"to":"Inspector Bianchi","mission":7}"#, r#"{"to":"court","note":"with the photos"}"#]),
    word("searchAgain", "/commands/searchAgain", "search an area again", CommandKind::SearchAgain,
        &[r#"{"x":1,"y":1,"toX":4,"toY":3}"#, r#"{"area":"gate 1"}"#]),
    word("orderAreas", "/commands/orderAreas", "choose which areas come first", CommandKind::OrderAreas,
        &[r#"{"areas":["gate 1","gate 2"]}"#, r#"{"areas":[]}"#]),
    word("closeArea", "/commands/closeArea", "state that the search of an area is over", CommandKind::CloseArea,
        &[r#"{"area":"gate 1","name":"Anna Rossi"}"#]),
    CommandRow { need: Need::Stop, ..word("move", "/commands/move", "move once by hand", CommandKind::Move,
        &[r#"{"move":"w"}"#, r#"{"move":"h"}"#]) },
    word("goto", "/commands/goto", "drive to a cell", CommandKind::Goto, &[r#"{"x":1,"y":1}"#]),
    CommandRow { subject: Subject::Luggage, methods: Methods::PostOrPut,
        ..word("verdict", "/luggage/{id}/verdict", "declare a piece safe or dangerous, or say unsure", CommandKind::Verdict,
            &[r#"{"luggage":3,"verdict":"safe"}"#, r#"{"luggage":3,"verdict":"danger","note":"wires"}"#,
                r#"{"luggage":3,"verdict":"unsure"}"#]) },
    CommandRow { subject: Subject::Luggage,
        ..word("retake", "/luggage/{id}/photo", "take the photo again", CommandKind::Retake, &[r#"{"luggage":3}"#]) },
    CommandRow { subject: Subject::Alarm,
        ..word("acknowledge", "/alarms/{id}/acknowledge", "acknowledge an alarm", CommandKind::Acknowledge,
            &[r#"{"alarm":2}"#]) },
    CommandRow { methods: Methods::Put,
        ..word("strategy", "/strategy", "choose the order of the search", CommandKind::Strategy, &[r#"{"name":"snail"}"#]) },
    CommandRow { methods: Methods::Put,
        ..word("temperature", "/temperature", "report the temperature", CommandKind::Temperature,
            &[r#"{"celsius":21.5}"#, r#"{"celsius":21.5,"sensor":"roof"}"#, r#"{"status":"ok"}"#, r#"{"status":"tooHigh"}"#]) },
];

pub fn named(name: &str) -> Option<&'static CommandRow> {
    COMMANDS.iter().find(|row| row.name == name)
}

impl CommandKind {
    pub fn row(self) -> &'static CommandRow {
        COMMANDS.iter().find(|row| row.kind == self).expect("every kind has its row, as a test shows")
    }
}

pub trait Payload {
    /// The door's error for a payload that cannot be read.
    type Problem: From<Unusable>;

    fn needed<T: Body>(&self) -> Result<T, Self::Problem>;

    fn optional<T: Body + Default>(&self) -> Result<T, Self::Problem>;
}

/// Returns the command, and the epoch that its sender saw. `number` is the number of the piece or alarm that the
/// command is about.
pub fn asked<P: Payload>(kind: CommandKind, number: u64, payload: &P) -> Result<(Command, Option<Epoch>), P::Problem> {
    let with_epoch = |command| Ok((command, payload.optional::<EpochBody>()?.epoch()));
    let bare = |command| payload.optional::<EpochBody>().map(|_| (command, None));
    let luggage = LuggageRef::Id(LuggageId(number));
    match kind {
        CommandKind::Stop => Ok((Command::Stop, None)),
        CommandKind::Start => with_epoch(Command::Start),
        CommandKind::BackHome => with_epoch(Command::BackHome),
        CommandKind::GoOn => with_epoch(Command::GoOn),
        CommandKind::Retrieve => Ok(payload.optional::<RetrieveBody>()?.command()),
        CommandKind::Reset => with_epoch(Command::Reset),
        CommandKind::Close => Ok((payload.needed::<CloseBody>()?.command()?, None)),
        CommandKind::HandOver => Ok((payload.needed::<HandOverBody>()?.command()?, None)),
        CommandKind::SearchAgain => Ok(payload.needed::<AreaBody>()?.command()?),
        CommandKind::OrderAreas => Ok((payload.needed::<OrderAreasBody>()?.command()?, None)),
        CommandKind::CloseArea => Ok((payload.needed::<CloseAreaBody>()?.command()?, None)),
        CommandKind::Move => Ok(payload.needed::<MoveBody>()?.command()?),
        CommandKind::Goto => Ok(payload.needed::<GotoBody>()?.command()?),
        CommandKind::Verdict => Ok((payload.needed::<VerdictBody>()?.command(luggage)?, None)),
        CommandKind::Retake => bare(Command::RetakePhoto(LuggageId(number))),
        CommandKind::Acknowledge => bare(Command::Acknowledge(AlarmId(number))),
        CommandKind::Strategy => Ok((Command::ChooseStrategy(payload.needed::<StrategyBody>()?.strategy()?), None)),
        CommandKind::Temperature => Ok((Command::Temperature(payload.needed::<TemperatureBody>()?.report()?), None)),
    }
}

impl CommandRow {
    /// Whether doors without paths accept the command without a payload. MQTT then accepts the bare name.
    pub fn is_word(&self) -> bool {
        self.subject == Subject::None && !self.needs_body()
    }

    pub const fn needs_body(&self) -> bool {
        use CommandKind::{Acknowledge, BackHome, GoOn, Reset, Retake, Retrieve, Start, Stop};
        !matches!(self.kind, Start | Stop | BackHome | GoOn | Retrieve | Reset | Retake | Acknowledge)
    }
}

/// A row with the usual values: POST, for operators, without a subject. The body has at most an epoch.
const fn word(
    name: &'static str,
    path: &'static str,
    title: &'static str,
    kind: CommandKind,
    body: &'static [&'static str],
) -> CommandRow {
    let (need, methods, subject) = (Need::Act, Methods::Post, Subject::None);
    CommandRow { name, title, kind, need, path, methods, subject, body }
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

    /// There are as many rows as kinds, all different. So a new kind needs a row.
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

    /// Safety S1: only commands that may be a STOP are open to everybody who is signed in.
    #[test]
    fn only_what_may_be_a_stop_asks_for_no_operator() {
        let open: Vec<CommandKind> = COMMANDS.iter().filter(|row| row.need != Need::Act).map(|row| row.kind).collect();
        assert_eq!(open, [CommandKind::Stop, CommandKind::Move]);
    }
}
