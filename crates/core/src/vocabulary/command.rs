//! What can be asked of hallsweep, and by whom. Why it may be refused stands in `refused`.
//! How a command is written on a wire is the business of the doors.

use std::sync::Arc;

pub use crate::refused::{CODES, Refusal, RefusalKind, Refused};

use crate::units::{AlarmId, Cell, Celsius, Epoch, LuggageId};
use crate::words::is_visible;

/// The source of the operator's own readings.
pub const OPERATOR: &str = "operator";

/// The source of the robot's own thermometer.
pub const ROBOT: &str = "robot";

/// The source of all for whom there is no room.
pub const OTHERS: &str = "others";

/// A command with what came with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// What is asked.
    pub command: Command,
    /// The epoch its sender saw. Only movement commands look at it.
    pub epoch: Option<Epoch>,
    /// The epoch in which it arrived, which counts where the sender named none.
    pub arrived: Option<Epoch>,
    /// It was sent before, and nobody knows when: a movement command that names no epoch may be from before a stop or a restart.
    pub is_again: bool,
    /// Who asks.
    pub issuer: Issuer,
    /// The sender's own name for this command: one that comes again is answered as before, and not carried out again.
    pub id: Option<CommandId>,
}

impl Request {
    /// A command as its sender gave it, without an epoch or an id.
    #[must_use]
    pub const fn new(command: Command, issuer: Issuer) -> Request {
        Request { command, epoch: None, arrived: None, is_again: false, issuer, id: None }
    }
}

/// A sender's own name for one command.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct CommandId(Arc<str>);

impl CommandId {
    /// The longest name taken, in bytes: more than a UUID in any writing.
    pub const MOST: usize = 128;

    /// `text` as a name: 1 to `MOST` visible ASCII characters, else `None`.
    #[must_use]
    pub fn new(text: &str) -> Option<CommandId> {
        let sound = (1..=CommandId::MOST).contains(&text.len()) && text.bytes().all(|byte| byte.is_ascii_graphic());
        sound.then(|| CommandId(Arc::from(text)))
    }

    /// The name.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.0
    }
}

/// Everything an operator, or a tool acting for one, can ask for (mission §4). `Display` is what the log says.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Begin, or go on with what was halted.
    Start,
    /// Halt the robot where it is. The handle raises the halt before this command is even queued.
    Stop,
    /// Go to the home cell and wait.
    BackHome,
    /// Fetch the dangerous piece.
    Retrieve,
    /// Archive the mission and be idle.
    Reset,
    /// One basic move by hand.
    Move(Move),
    /// Drive to a cell by hand.
    Goto(Cell),
    /// Say of a piece of luggage what it is.
    Verdict {
        /// The piece meant.
        luggage: LuggageRef,
        /// What it is.
        verdict: Verdict,
        /// What is to be remembered of it.
        note: Option<Note>,
    },
    /// Take the photo of the piece being inspected again.
    RetakePhoto(LuggageId),
    /// The operator has seen the alarm.
    Acknowledge(AlarmId),
    /// Choose the order of the search.
    ChooseStrategy(Strategy),
    /// What is known of the temperature.
    Temperature(TemperatureReport),
}

impl Command {
    /// The piece of luggage it is about, where it is about one.
    #[must_use]
    pub const fn luggage(&self) -> Option<LuggageRef> {
        match self {
            Command::Verdict { luggage, .. } => Some(*luggage),
            Command::RetakePhoto(id) => Some(LuggageRef::Id(*id)),
            Command::Start
            | Command::Stop
            | Command::BackHome
            | Command::Retrieve
            | Command::Reset
            | Command::Move(_)
            | Command::Goto(_)
            | Command::Acknowledge(_)
            | Command::ChooseStrategy(_)
            | Command::Temperature(_) => None,
        }
    }

    /// Whether it can let a halted robot go.
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
    /// The move that undoes this one.
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
    /// What the operator says of a piece.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Verdict {
        /// The search goes on.
        Safe = "safe",
        /// The robot comes home and the piece is fetched.
        Danger = "danger",
    }
}

/// What an operator wrote down with a verdict, for whoever reads the record later.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note(Arc<str>);

impl Note {
    /// The longest note, in characters: some sentences, and no more than a line of the log can bear.
    pub const MOST: usize = 500;

    /// `text` without the blanks around it as a note: 1 to `MOST` visible characters, in one line; else `None`.
    #[must_use]
    pub fn new(text: &str) -> Option<Note> {
        let text = text.trim();
        let sound = (1..=Note::MOST).contains(&text.chars().count()) && text.chars().all(is_visible);
        sound.then(|| Note(Arc::from(text)))
    }

    /// The words.
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

/// How a verdict says which piece it means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LuggageRef {
    /// By its number.
    Id(LuggageId),
    /// An old client's bare word: the one piece whose verdict is pending.
    Pending,
}

/// What an operator or a tool reports of the temperature.
#[derive(Clone, Debug, PartialEq)]
pub enum TemperatureReport {
    /// The button OK; concerns the hold `tooHigh` alone.
    Ok,
    /// The button TOO HIGH.
    TooHigh,
    /// The operator's own reading, compared with the threshold.
    Reading(Celsius),
    /// A reading of the configured sensor of this name.
    Sensor(Arc<str>, Celsius),
}

impl TemperatureReport {
    /// The longest name of a sensor, in characters.
    pub const MOST: usize = 64;

    /// `text` as the name of a sensor: 1 to `MOST` visible characters, no blanks, no comma, and none of the names under which
    /// readings of others are kept; else `None`.
    #[must_use]
    pub fn sensor_name(text: &str) -> Option<Arc<str>> {
        let visible = |letter: char| !letter.is_whitespace() && !letter.is_control() && letter != ',';
        let sound = (1..=TemperatureReport::MOST).contains(&text.chars().count()) && text.chars().all(visible);
        (sound && ![OPERATOR, ROBOT, OTHERS].contains(&text)).then(|| Arc::from(text))
    }
}

/// Who gave a command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Issuer {
    /// By which door it came.
    pub door: Door,
    /// The name of whoever gave it, as far as it is known: that of a key, and behind it in brackets a person's.
    pub who: Arc<str>,
    /// Where it came from, as `192.0.2.7`; `here` where there is no address.
    pub from: Arc<str>,
}

impl Issuer {
    /// Somebody at a door that asks for no name.
    #[must_use]
    pub fn operator(door: Door) -> Issuer {
        Issuer { door, who: Arc::from("operator"), from: Arc::from("here") }
    }

    /// The name by which shares are counted and repeats are known: that of the key, without the person's behind it, as `operator` of
    /// `operator (Anna)`. Several names give nobody several shares.
    #[must_use]
    pub fn key(&self) -> Arc<str> {
        self.who.split_once(" (").map_or_else(|| Arc::clone(&self.who), |(key, _)| Arc::from(key))
    }
}

impl std::fmt::Display for Issuer {
    /// As `operator (console, 192.0.2.7)`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({}", self.who, self.door.0)?;
        if self.door == Door::LOCAL { f.write_str(")") } else { write!(f, ", {})", self.from) }
    }
}

/// A way in, by the word that records have for it. Which ways there are, the outside knows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Door(pub &'static str);

impl Door {
    /// None: whoever holds the engine itself, as the command line does (`hallsweep explore`).
    pub const LOCAL: Door = Door("local");
}

/// What an accepted command is answered with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Accepted {
    /// The revision of the state that contains its effect.
    pub revision: super::units::Revision,
    /// The epoch that held then: what a movement command may carry next.
    pub epoch: Epoch,
    /// The piece it concerned, where it concerned one.
    pub luggage: Option<LuggageId>,
}

named! {
    ALL by name;
    /// The ways to search a hall.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Strategy {
        /// For whoever does not want to choose: the tuned score, or along the walls where that finds luggage sooner.
        #[default]
        Auto = "auto",
        /// Whatever comes to the least by a tuned score of the way there and of what lies round it.
        Scored = "scored",
        /// The nearest unknown cell, lone ones first.
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
