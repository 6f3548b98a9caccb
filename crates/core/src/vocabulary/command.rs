//! What can be asked of hallsweep, and by whom. `refused` has the reasons for which a command may be refused. The doors
//! decide how a command is written on a wire.

use std::sync::Arc;

use crate::units::{AlarmId, Cell, Celsius, Epoch, LuggageId};
use crate::words::is_visible;

/// The source of the operator's own readings.
pub const OPERATOR: &str = "operator";

/// The source of the robot's own thermometer.
pub const ROBOT: &str = "robot";

/// The common source of all readings for which there is no room among the sources that are told apart.
pub const OTHERS: &str = "others";

#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    pub command: Command,
    /// The epoch that the sender saw. It matters to movement commands only.
    pub epoch: Option<Epoch>,
    /// The epoch in which the command arrived, which counts if the sender named none.
    pub arrived: Option<Epoch>,
    /// Whether the command was sent before, at an unknown time. A movement command without an epoch may then be older
    /// than a stop or a restart.
    pub is_again: bool,
    pub issuer: Issuer,
    /// The sender's own id for this command. A command that comes again under the same id gets the same answer, and is
    /// not carried out again.
    pub id: Option<CommandId>,
}

impl Request {
    #[must_use]
    pub const fn new(command: Command, issuer: Issuer) -> Request {
        Request { command, epoch: None, arrived: None, is_again: false, issuer, id: None }
    }
}

#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CommandId(Arc<str>);

impl CommandId {
    /// Longest id, in bytes: longer than a UUID in any notation.
    pub const MOST: usize = 128;

    /// `None` unless the text has 1 to `MOST` visible ASCII characters.
    #[must_use]
    pub fn new(text: &str) -> Option<CommandId> {
        let sound = (1..=CommandId::MOST).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_graphic());
        sound.then(|| CommandId(Arc::from(text)))
    }

    #[must_use]
    pub fn text(&self) -> &str {
        &self.0
    }
}

/// Everything an operator, or a tool acting for one, can ask for (mission §4). `Display` is what the log says.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    Start,
    /// The halt is raised before this command is even queued.
    Stop,
    BackHome,
    Retrieve,
    /// Archive the mission and be idle.
    Reset,
    Move(Move),
    Goto(Cell),
    Verdict {
        luggage: LuggageRef,
        verdict: Verdict,
        note: Option<Note>,
    },
    RetakePhoto(LuggageId),
    Acknowledge(AlarmId),
    ChooseStrategy(Strategy),
    Temperature(TemperatureReport),
}

/// What a command carries beside its code.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carries<'a> {
    Nothing,
    Luggage(LuggageId),
    Alarm(AlarmId),
    Move(Move),
    Cell(Cell),
    Verdict(LuggageRef, Verdict, Option<&'a Note>),
    Strategy(Strategy),
    Temperature(&'a TemperatureReport),
}

impl Command {
    /// The codes of all commands. They stand in the journal, so a code never changes.
    pub const CODES: [&str; 12] = [
        "start",
        "stop",
        "backHome",
        "retrieve",
        "reset",
        "move",
        "goto",
        "verdict",
        "retake",
        "acknowledge",
        "strategy",
        "temperature",
    ];

    pub const BARE: [Command; 5] = [Command::Start, Command::Stop, Command::BackHome, Command::Retrieve, Command::Reset];

    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Command::Start => "start",
            Command::Stop => "stop",
            Command::BackHome => "backHome",
            Command::Retrieve => "retrieve",
            Command::Reset => "reset",
            Command::Move(_) => "move",
            Command::Goto(_) => "goto",
            Command::Verdict { .. } => "verdict",
            Command::RetakePhoto(_) => "retake",
            Command::Acknowledge(_) => "acknowledge",
            Command::ChooseStrategy(_) => "strategy",
            Command::Temperature(_) => "temperature",
        }
    }

    #[must_use]
    pub const fn carries(&self) -> Carries<'_> {
        match self {
            Command::Start | Command::Stop | Command::BackHome | Command::Retrieve | Command::Reset => Carries::Nothing,
            Command::Move(step) => Carries::Move(*step),
            Command::Goto(cell) => Carries::Cell(*cell),
            Command::Verdict { luggage, verdict, note } => Carries::Verdict(*luggage, *verdict, note.as_ref()),
            Command::RetakePhoto(id) => Carries::Luggage(*id),
            Command::Acknowledge(id) => Carries::Alarm(*id),
            Command::ChooseStrategy(strategy) => Carries::Strategy(*strategy),
            Command::Temperature(report) => Carries::Temperature(report),
        }
    }

    #[must_use]
    pub const fn luggage(&self) -> Option<LuggageRef> {
        match self.carries() {
            Carries::Verdict(luggage, ..) => Some(luggage),
            Carries::Luggage(id) => Some(LuggageRef::Id(id)),
            Carries::Nothing
            | Carries::Alarm(_)
            | Carries::Move(_)
            | Carries::Cell(_)
            | Carries::Strategy(_)
            | Carries::Temperature(_) => None,
        }
    }

    /// Whether the command can release a halted robot.
    #[must_use]
    pub const fn releases(&self) -> bool {
        match self {
            Command::Start | Command::BackHome | Command::Retrieve | Command::Reset | Command::Move(_) | Command::Goto(_) => true,
            Command::Stop
            | Command::Verdict { .. }
            | Command::RetakePhoto(_)
            | Command::Acknowledge(_)
            | Command::ChooseStrategy(_)
            | Command::Temperature(_) => false,
        }
    }
}

impl std::fmt::Display for Command {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Command::Start => f.write_str("START"),
            Command::Stop => f.write_str("STOP"),
            Command::BackHome => f.write_str("BACK HOME"),
            Command::Retrieve => f.write_str("RETRIEVE"),
            Command::Reset => f.write_str("RESET"),
            Command::Move(step) => write!(f, "move {}", step.in_words()),
            Command::Goto(cell) => write!(f, "goto {cell}"),
            Command::Verdict { luggage, verdict, note } => {
                f.write_str(verdict.name())?;
                if let LuggageRef::Id(id) = luggage {
                    write!(f, " #{id}")?;
                }
                note.as_ref().map_or(Ok(()), |note| write!(f, " (note: {note})"))
            }
            Command::RetakePhoto(id) => write!(f, "retake photo #{id}"),
            Command::Acknowledge(id) => write!(f, "acknowledge alarm {id}"),
            Command::ChooseStrategy(strategy) => write!(f, "choose strategy {}", strategy.name()),
            Command::Temperature(TemperatureReport::Ok) => f.write_str("temperature OK"),
            Command::Temperature(TemperatureReport::TooHigh) => f.write_str("temperature TOO HIGH"),
            Command::Temperature(TemperatureReport::Reading(celsius)) => {
                write!(f, "temperature reading {} °C", celsius.degrees())
            }
            Command::Temperature(TemperatureReport::Sensor(sensor, celsius)) => {
                write!(f, "a sensor's reading {sensor} {} °C", celsius.degrees())
            }
        }
    }
}

named! {
    ALL by in_words;
    /// A basic move (mission §3).
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Move {
        /// One cell forward, `w`.
        Forward = "forward",
        /// One cell backward, `s`.
        Backward = "backward",
        /// 90° to the left, `a` (and `l` of old clients).
        TurnLeft = "left",
        /// 90° to the right, `d` (and `r` of old clients).
        TurnRight = "right",
        /// A small correction to the left, `z`; only some robots can.
        NudgeLeft = "a little left",
        /// A small correction to the right, `x`; only some robots can.
        NudgeRight = "a little right",
    }
}

impl Move {
    pub(crate) const fn reversed(self) -> Move {
        match self {
            Move::Forward => Move::Backward,
            Move::Backward => Move::Forward,
            Move::TurnLeft => Move::TurnRight,
            Move::TurnRight => Move::TurnLeft,
            Move::NudgeLeft => Move::NudgeRight,
            Move::NudgeRight => Move::NudgeLeft,
        }
    }
}

named! {
    by name;
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Verdict {
        /// The search goes on.
        Safe = "safe",
        /// The robot comes home and the piece is fetched.
        Danger = "danger",
    }
}

/// An operator's note with a verdict, for whoever reads the record later.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note(Arc<str>);

impl Note {
    /// Longest note, in characters: some sentences, and no more than fits a line of the log.
    pub const MOST: usize = 500;

    /// Removes blanks around the text; `None` unless 1 to `MOST` visible characters in one line are left.
    #[must_use]
    pub fn new(text: &str) -> Option<Note> {
        let text = text.trim();
        let sound = (1..=Note::MOST).contains(&text.chars().count()) && text.chars().all(is_visible);
        sound.then(|| Note(Arc::from(text)))
    }

    #[must_use]
    pub fn text(&self) -> &str {
        &self.0
    }
}

impl std::fmt::Display for Note {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LuggageRef {
    Id(LuggageId),
    /// The one piece whose verdict is pending: the meaning of a bare word from an old client.
    Pending,
}

#[derive(Clone, Debug, PartialEq)]
pub enum TemperatureReport {
    /// The button OK; concerns the hold `tooHigh` alone.
    Ok,
    TooHigh,
    /// The operator's own reading, compared with the threshold.
    Reading(Celsius),
    /// A reading of the configured sensor of this name.
    Sensor(Arc<str>, Celsius),
}

impl TemperatureReport {
    /// Longest name of a sensor, in characters.
    pub const MOST: usize = 64;

    /// `None` unless the text has 1 to `MOST` visible characters, no blanks and no comma. The text must not be
    /// `OPERATOR`, `ROBOT` or `OTHERS`.
    #[must_use]
    pub fn sensor_name(text: &str) -> Option<Arc<str>> {
        let visible = |letter: char| !letter.is_whitespace() && !letter.is_control() && letter != ',';
        let sound = (1..=TemperatureReport::MOST).contains(&text.chars().count()) && text.chars().all(visible);
        (sound && ![OPERATOR, ROBOT, OTHERS].contains(&text)).then(|| Arc::from(text))
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Issuer {
    pub door: Door,
    /// The sender's name, as far as it is known: the name of the key, and then, in brackets, the name of a person.
    pub who: Arc<str>,
    /// The sender's address, such as `192.0.2.7`; `here` where there is none.
    pub from: Arc<str>,
}

impl Issuer {
    /// Somebody at a door that asks for no name.
    #[must_use]
    pub fn operator(door: Door) -> Issuer {
        Issuer { door, who: Arc::from("operator"), from: Arc::from("here") }
    }

    /// The name of the key without the name of a person, such as `operator` for `operator (Anna)`. This name counts for
    /// shares and for repeats, so nobody gets several shares by using several names.
    #[must_use]
    pub fn key(&self) -> Arc<str> {
        self.who.split_once(" (").map_or_else(|| Arc::clone(&self.who), |(key, _)| Arc::from(key))
    }
}

impl std::fmt::Display for Issuer {
    /// Written like `operator (console, 192.0.2.7)`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({}", self.who, self.door.0)?;
        if self.door == Door::LOCAL { f.write_str(")") } else { write!(f, ", {})", self.from) }
    }
}

/// A way in, by its word in records. The list of all ways in is not in the core.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Door(pub &'static str);

impl Door {
    /// No door: the caller owns the engine, as the command line does (`hallsweep explore`).
    pub const LOCAL: Door = Door("local");
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Accepted {
    /// The revision of the state that contains the command's effect.
    pub revision: super::units::Revision,
    /// The epoch of the state after the command, which the next movement command may carry.
    pub epoch: Epoch,
    pub luggage: Option<LuggageId>,
}

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Strategy {
        /// The default: along the walls if luggage is found sooner there, else the tuned score.
        #[default]
        Auto = "auto",
        /// The cell with the least tuned score, which adds the way there and the worth of its surroundings.
        Scored = "scored",
        /// The nearest unknown cell; lone cells come first.
        Frontier = "frontier",
        /// To and fro, column after column.
        Columns = "columns",
        /// Round and round, from the walls inwards.
        Spiral = "spiral",
        /// The seeds' *chiocciola*: growing squares, home after each.
        Snail = "snail",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_note_is_one_line_of_visible_characters() {
        let text = |text: &str| Note::new(text).map(|note| note.text().to_owned());
        assert_eq!(text("  red, with <b>wires</b> \n").as_deref(), Some("red, with <b>wires</b>"));
        assert_eq!(text(&"ü".repeat(Note::MOST)).map(|text| text.chars().count()), Some(500));
        for unsound in ["", " \n ", "two\nlines", "a\u{202e}b", "\u{0}", &"x".repeat(Note::MOST + 1)] {
            assert_eq!(text(unsound), None, "{unsound:?}");
        }
    }
}
