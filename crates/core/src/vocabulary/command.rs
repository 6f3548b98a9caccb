//! The commands that hallsweep accepts, and their senders. `refused` lists the reasons for a refusal. Each interface
//! (HTTP, CoAP, MQTT) defines its own encoding of the commands.

use std::sync::Arc;

use crate::bomb_size::BombSize;
use crate::closing::{AreaClosing, Closing};
use crate::hand_over::HandOver;
use crate::units::{AlarmId, Bounds, Cell, Celsius, Epoch, LuggageId};
use crate::words::is_visible;

/// Source name of temperature readings that the operator enters.
pub const OPERATOR: &str = "operator";

/// Source name of readings from the robot's own thermometer.
pub const ROBOT: &str = "robot";

/// Source name that all further sources share when too many sources report readings.
pub const OTHERS: &str = "others";

#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    pub command: Command,
    /// The epoch (count of stops) that the sender saw. Only movement commands use it.
    pub epoch: Option<Epoch>,
    /// The epoch when the command arrived. It is used if the sender gave no epoch.
    pub arrived: Option<Epoch>,
    /// Whether the command was delivered again, so that it was first sent at an unknown earlier time. A movement
    /// command without an epoch may then be older than a stop or a restart.
    pub is_again: bool,
    pub issuer: Issuer,
    /// The sender's own id for this command. If a command is repeated with the same id, it gets the same answer and
    /// is not executed again.
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
    /// Maximum length of an id, in bytes. A UUID fits in any notation.
    pub const MOST: usize = 128;

    /// Returns an id if the text has 1 to `MOST` visible ASCII characters, otherwise `None`.
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

/// A command from an operator, or from a tool that acts for an operator (mission §4). `Display` gives its text in the
/// log.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    Start,
    /// The halt is raised before this command enters the queue.
    Stop,
    BackHome,
    /// Go on with the search after a bomb was found.
    GoOn,
    /// Fetch this dangerous piece, or the one that was found first.
    Retrieve(Option<LuggageId>),
    /// Archive the mission and return to idle.
    Reset,
    /// The person in charge states that the search is over.
    Close(Closing),
    HandOver(HandOver),
    SearchAgain(Again),
    /// The names of the areas that are to be searched first, in this order. An empty list leaves the order to the
    /// search.
    OrderAreas(Arc<[Arc<str>]>),
    /// The person in charge states that the search of an area is over.
    CloseArea(AreaClosing),
    Move(Move),
    Goto(Cell),
    Verdict {
        luggage: LuggageRef,
        verdict: Verdict,
        note: Option<Note>,
        hot: Hot,
    },
    /// The sender cannot judge the piece from its photo. The robot takes photos from other sides, and asks again.
    Unsure {
        luggage: LuggageRef,
        note: Option<Note>,
        hot: Hot,
    },
    RetakePhoto(LuggageId),
    Acknowledge(AlarmId),
    ChooseStrategy(Strategy),
    Temperature(TemperatureReport),
}

/// The searched cells that the robot has to visit once more.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Again {
    Within(Bounds),
    /// The area of this name. If it was closed, it is open again.
    Area(Arc<str>),
}

impl std::fmt::Display for Again {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Again::Within(bounds) => write!(f, "{} to {}", bounds.least, bounds.most),
            Again::Area(name) => f.write_str(name),
        }
    }
}

/// The data of a command in addition to its code.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carries<'a> {
    Nothing,
    Luggage(LuggageId),
    Alarm(AlarmId),
    Move(Move),
    Cell(Cell),
    Verdict(LuggageRef, Verdict, Option<&'a Note>, Hot),
    Unsure(LuggageRef, Option<&'a Note>, Hot),
    Closing(&'a Closing),
    HandOver(&'a HandOver),
    Again(&'a Again),
    Areas(&'a Arc<[Arc<str>]>),
    AreaClosing(&'a AreaClosing),
    Strategy(Strategy),
    Temperature(&'a TemperatureReport),
}

impl Command {
    /// The codes of all commands. The journal stores these codes, so a code never changes.
    pub const CODES: [&str; 19] = [
        "start",
        "stop",
        "backHome",
        "goOn",
        "retrieve",
        "reset",
        "close",
        "handOver",
        "searchAgain",
        "orderAreas",
        "closeArea",
        "move",
        "goto",
        "verdict",
        "unsure",
        "retake",
        "acknowledge",
        "strategy",
        "temperature",
    ];

    pub const BARE: [Command; 5] = [Command::Start, Command::Stop, Command::BackHome, Command::GoOn, Command::Reset];

    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Command::Start => "start",
            Command::Stop => "stop",
            Command::BackHome => "backHome",
            Command::GoOn => "goOn",
            Command::Retrieve(_) => "retrieve",
            Command::Reset => "reset",
            Command::Close(_) => "close",
            Command::HandOver(_) => "handOver",
            Command::SearchAgain(_) => "searchAgain",
            Command::OrderAreas(_) => "orderAreas",
            Command::CloseArea(_) => "closeArea",
            Command::Move(_) => "move",
            Command::Goto(_) => "goto",
            Command::Verdict { .. } => "verdict",
            Command::Unsure { .. } => "unsure",
            Command::RetakePhoto(_) => "retake",
            Command::Acknowledge(_) => "acknowledge",
            Command::ChooseStrategy(_) => "strategy",
            Command::Temperature(_) => "temperature",
        }
    }

    #[must_use]
    pub const fn carries(&self) -> Carries<'_> {
        match self {
            Command::Start | Command::Stop | Command::BackHome | Command::GoOn | Command::Retrieve(None) | Command::Reset => {
                Carries::Nothing
            }
            Command::Retrieve(Some(id)) => Carries::Luggage(*id),
            Command::Close(closing) => Carries::Closing(closing),
            Command::HandOver(hand_over) => Carries::HandOver(hand_over),
            Command::SearchAgain(again) => Carries::Again(again),
            Command::OrderAreas(names) => Carries::Areas(names),
            Command::CloseArea(closing) => Carries::AreaClosing(closing),
            Command::Move(step) => Carries::Move(*step),
            Command::Goto(cell) => Carries::Cell(*cell),
            Command::Verdict { luggage, verdict, note, hot } => Carries::Verdict(*luggage, *verdict, note.as_ref(), *hot),
            Command::Unsure { luggage, note, hot } => Carries::Unsure(*luggage, note.as_ref(), *hot),
            Command::RetakePhoto(id) => Carries::Luggage(*id),
            Command::Acknowledge(id) => Carries::Alarm(*id),
            Command::ChooseStrategy(strategy) => Carries::Strategy(*strategy),
            Command::Temperature(report) => Carries::Temperature(report),
        }
    }

    #[must_use]
    pub const fn luggage(&self) -> Option<LuggageRef> {
        match self.carries() {
            Carries::Verdict(luggage, ..) | Carries::Unsure(luggage, ..) => Some(luggage),
            Carries::Luggage(id) => Some(LuggageRef::Id(id)),
            Carries::Nothing
            | Carries::Closing(_)
            | Carries::HandOver(_)
            | Carries::Again(_)
            | Carries::Areas(_)
            | Carries::AreaClosing(_)
            | Carries::Alarm(_)
            | Carries::Move(_)
            | Carries::Cell(_)
            | Carries::Strategy(_)
            | Carries::Temperature(_) => None,
        }
    }

    /// Whether the command can let a halted robot move again.
    #[must_use]
    pub const fn releases(&self) -> bool {
        match self {
            Command::Start
            | Command::BackHome
            | Command::GoOn
            | Command::Retrieve(_)
            | Command::Reset
            | Command::SearchAgain(_)
            | Command::Move(_)
            | Command::Goto(_) => true,
            Command::Stop
            | Command::Close(_)
            | Command::HandOver(_)
            | Command::OrderAreas(_)
            | Command::CloseArea(_)
            | Command::Verdict { .. }
            | Command::Unsure { .. }
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
            Command::GoOn => f.write_str("GO ON"),
            Command::Retrieve(None) => f.write_str("RETRIEVE"),
            Command::Retrieve(Some(id)) => write!(f, "RETRIEVE #{id}"),
            Command::Reset => f.write_str("RESET"),
            Command::Close(Closing { name, note, .. }) => {
                write!(f, "close, by {name}{}", Note::in_brackets(note.as_ref()))
            }
            Command::HandOver(HandOver { to, note, .. }) => write!(f, "hand over to {to}{}", Note::in_brackets(note.as_ref())),
            Command::SearchAgain(again) => write!(f, "search again {again}"),
            Command::OrderAreas(names) if names.is_empty() => f.write_str("order of areas: automatic"),
            Command::OrderAreas(names) => write!(f, "order of areas: {}", names.join(", ")),
            Command::CloseArea(AreaClosing { area, name, note, .. }) => {
                write!(f, "close area {area}, by {name}{}", Note::in_brackets(note.as_ref()))
            }
            Command::Move(step) => write!(f, "move {}", step.in_words()),
            Command::Goto(cell) => write!(f, "goto {cell}"),
            Command::Verdict { luggage, verdict, note, hot } => write_answer(f, verdict.name(), *luggage, note.as_ref(), *hot),
            Command::Unsure { luggage, note, hot } => write_answer(f, "unsure", *luggage, note.as_ref(), *hot),
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

fn write_answer(
    f: &mut std::fmt::Formatter<'_>,
    answer: &str,
    luggage: LuggageRef,
    note: Option<&Note>,
    hot: Hot,
) -> std::fmt::Result {
    f.write_str(answer)?;
    if let LuggageRef::Id(id) = luggage {
        write!(f, " #{id}")?;
    }
    if !hot.is_empty() {
        write!(f, " ({hot})")?;
    }
    f.write_str(&Note::in_brackets(note))
}

named! {
    ALL by in_words;
    /// A basic move (mission §3).
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum Move {
        /// One cell forward (`w`).
        Forward = "forward",
        /// One cell backward (`s`).
        Backward = "backward",
        /// 90° to the left (`a`, or `l` from old clients).
        TurnLeft = "left",
        /// 90° to the right (`d`, or `r` from old clients).
        TurnRight = "right",
        /// A small correction to the left (`z`). Only some robots can do it.
        NudgeLeft = "a little left",
        /// A small correction to the right (`x`). Only some robots can do it.
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
        /// The piece is harmless, and the search continues.
        Safe = "safe",
        /// The piece is dangerous. The robot comes home, and the piece is fetched.
        Danger = "danger",
    }
}

named! {
    ALL by name;
    /// An answer to one of the three questions about a piece.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum HotAnswer {
        Yes = "yes",
        No = "no",
        CannotSay = "cannotSay",
    }
}

/// A judge's answers about a piece: is it hidden, is it obviously suspicious, is it typical of this place? For a danger,
/// also how large the bomb may be. `None` for a question that was not answered.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Hot {
    pub hidden: Option<HotAnswer>,
    pub obvious: Option<HotAnswer>,
    pub typical: Option<HotAnswer>,
    /// How large the bomb may be. Only a danger has it.
    pub size: Option<BombSize>,
}

impl Hot {
    /// No question is answered.
    pub const NONE: Hot = Hot { hidden: None, obvious: None, typical: None, size: None };

    /// Returns the three questions by their names, with the answers.
    #[must_use]
    pub const fn answers(self) -> [(&'static str, Option<HotAnswer>); 3] {
        [("hidden", self.hidden), ("obvious", self.obvious), ("typical", self.typical)]
    }

    #[must_use]
    pub fn is_empty(self) -> bool {
        self == Hot::NONE
    }

    #[must_use]
    pub fn is_complete(self) -> bool {
        self.answers().iter().all(|(_, answer)| answer.is_some())
    }
}

impl std::fmt::Display for Hot {
    /// Example: `hidden: no, typical: yes`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let given = self.answers().into_iter().filter_map(|(question, answer)| Some((question, answer?)));
        let words = |(question, answer): (&str, HotAnswer)| {
            let answer = if answer == HotAnswer::CannotSay { "cannot say" } else { answer.name() };
            format!("{question}: {answer}")
        };
        f.write_str(&given.map(words).chain(self.size.map(BombSize::in_words)).collect::<Vec<_>>().join(", "))
    }
}

/// An operator's note on a verdict, for later readers of the record.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Note(Arc<str>);

impl Note {
    /// Maximum length of a note, in characters. This is enough for some sentences and fits one line of the log.
    pub const MOST: usize = 500;

    /// Removes blanks around the text. Returns `None` unless one line of 1 to `MOST` visible characters is left.
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

    /// Formats a note behind a sentence, as ` (note: red)`. Returns an empty text if there is none.
    #[must_use]
    pub fn in_brackets(note: Option<&Note>) -> String {
        note.map(|note| format!(" (note: {note})")).unwrap_or_default()
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
    /// The one piece that waits for a verdict. Old clients send a verdict without a number and mean this piece.
    Pending,
}

impl LuggageRef {
    /// Returns the number; `meant` if the sender named none.
    #[must_use]
    pub fn or(self, meant: Option<LuggageId>) -> Option<LuggageId> {
        match self {
            LuggageRef::Id(id) => Some(id),
            LuggageRef::Pending => meant,
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
pub enum TemperatureReport {
    /// The button OK. It concerns only the hold `tooHigh`.
    Ok,
    TooHigh,
    /// A temperature that the operator entered. It is compared with the threshold.
    Reading(Celsius),
    /// A reading of the configured sensor with this name.
    Sensor(Arc<str>, Celsius),
}

impl TemperatureReport {
    /// Maximum length of a sensor's name, in characters.
    pub const MOST: usize = 64;

    /// Returns `None` unless the text has 1 to `MOST` visible characters, without blanks and commas. The names
    /// `OPERATOR`, `ROBOT` and `OTHERS` are reserved and also give `None`.
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
    /// The sender: the name of the access key, followed by the name of the person in brackets if it is known.
    pub who: Arc<str>,
    /// The sender's address, such as `192.0.2.7`; `here` if there is no address.
    pub from: Arc<str>,
}

impl Issuer {
    /// Returns the sender that is used for an interface that asks for no name.
    #[must_use]
    pub fn operator(door: Door) -> Issuer {
        Issuer { door, who: Arc::from("operator"), from: Arc::from("here") }
    }

    /// Returns the key's name without the person's name, such as `operator` for `operator (Anna)`. Limits per
    /// sender and repeated ids are counted by this name, so nobody gets a larger limit by using several names.
    #[must_use]
    pub fn key(&self) -> Arc<str> {
        Arc::from(Issuer::key_of(&self.who))
    }

    pub(crate) fn key_of(who: &str) -> &str {
        who.split_once(" (").map_or(who, |(key, _)| key)
    }
}

impl std::fmt::Display for Issuer {
    /// Example: `operator (console, 192.0.2.7)`.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} ({}", self.who, self.door.0)?;
        if self.door == Door::LOCAL { f.write_str(")") } else { write!(f, ", {})", self.from) }
    }
}

/// An interface that accepts commands, such as HTTP. The text is its name in records. The core has no list of all
/// interfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Door(pub &'static str);

impl Door {
    /// No interface: the caller owns the engine, such as the command line (`hallsweep explore`).
    pub const LOCAL: Door = Door("local");
    /// The only interface without keys.
    pub const COAP: Door = Door("coap");
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Accepted {
    /// The revision of the state that contains the command's effect.
    pub revision: super::units::Revision,
    /// The epoch after the command. The next movement command may carry this epoch.
    pub epoch: Epoch,
    pub luggage: Option<LuggageId>,
    /// Whether the command is an answer of a judge that is kept back until another judge has answered.
    pub is_kept_back: bool,
}

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Strategy {
        /// The default. It follows the walls if luggage is found sooner there; otherwise it uses the tuned score.
        #[default]
        Auto = "auto",
        /// Go to the cell with the lowest tuned score. The score adds the cost of the way and the value of the
        /// surroundings.
        Scored = "scored",
        /// Go to the nearest unknown cell. Single unknown cells come first.
        Frontier = "frontier",
        /// Sweep the hall up and down, column by column.
        Columns = "columns",
        /// Go round the hall in rings, from the walls inwards.
        Spiral = "spiral",
        /// The *chiocciola* (snail) of the original specification: growing squares, with a return home after each
        /// square.
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
