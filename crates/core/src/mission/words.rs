//! Commands in words, as they stand in the log and in the journal, and back: the journal keeps the words alone, and whoever reads them
//! makes them a command again where they come in. Commands are compared as values, never by their words.

use super::{Input, InputContext};
use crate::command::{Command, Door, Issuer, LuggageRef, Move, Note, OPERATOR, Strategy, TemperatureReport, Verdict};
use crate::units::{AlarmId, Cell, Celsius, LuggageId};

/// Where the note begins in the words of a verdict.
const NOTE: &str = "(note: ";

/// What is asked, in words.
#[must_use]
pub fn in_words(command: &Command) -> String {
    let (input, context) = InputContext::of(command, &Issuer::operator(Door::LOCAL), None);
    format!("{}{}", input.in_words(), context.in_words())
}

/// The command that has these words; `None` when none has them, as those of a newer journal.
#[must_use]
#[expect(clippy::wildcard_enum_match_arm, reason = "no event is a command; a test holds that every command comes back")]
pub(super) fn from_words(words: &str) -> Option<Command> {
    let (input, about) = Input::from_words(words)?;
    let about = about.trim_start();
    let verdict = |verdict| {
        let (about, note) = noted(about)?;
        Some(Command::Verdict { luggage: piece(about)?, verdict, note })
    };
    let command = match input {
        Input::Start => Command::Start,
        Input::Stop => Command::Stop,
        Input::BackHome => Command::BackHome,
        Input::Retrieve => Command::Retrieve,
        Input::Reset => Command::Reset,
        Input::Move => Command::Move(Move::ALL.into_iter().find(|step| step.in_words() == about)?),
        Input::Goto => Command::Goto(Cell::from_words(about)?),
        Input::Safe => verdict(Verdict::Safe)?,
        Input::Danger => verdict(Verdict::Danger)?,
        Input::RetakePhoto => Command::RetakePhoto(number(about)?),
        Input::Acknowledge => Command::Acknowledge(AlarmId(about.parse().ok()?)),
        Input::Strategy => Command::ChooseStrategy(Strategy::named(about)?),
        Input::TemperatureOk => Command::Temperature(TemperatureReport::Ok),
        Input::TemperatureTooHigh => Command::Temperature(TemperatureReport::TooHigh),
        Input::Reading => Command::Temperature(TemperatureReport::Reading(degrees(about.strip_suffix(" °C")?)?)),
        Input::SensorReading => {
            let (sensor, reading) = about.strip_suffix(" °C")?.rsplit_once(' ')?;
            let sensor = TemperatureReport::sensor_name(sensor)?;
            Command::Temperature(TemperatureReport::Sensor(sensor, degrees(reading)?))
        }
        _ => return None,
    };
    // Words that say the same in another way, as `safe #03`, are not what this command is written as.
    (in_words(&command) == words).then_some(command)
}

impl Input {
    /// The input with whose words those of a command begin, and the rest of them: what it is about.
    #[must_use]
    pub(crate) fn from_words(words: &str) -> Option<(Input, &str)> {
        let ends = |about: &str| about.is_empty() || about.starts_with(' ');
        let about = |input: Input| words.strip_prefix(input.in_words()).filter(|about| ends(about));
        Input::COMMANDS.into_iter().find_map(|input| Some((input, about(input)?)))
    }
}

impl InputContext {
    /// What the command is about, for the log: ` #3`, ` #3 (note: red)`, ` (1, 2)`, or nothing.
    #[must_use]
    pub(crate) fn in_words(&self) -> String {
        let luggage = self.luggage.map(|id| format!(" #{id}"));
        let cell = self.cell.map(|cell| format!(" {cell}"));
        let step = self.step.map(|step| format!(" {}", step.in_words()));
        let alarm = self.alarm.map(|id| format!(" {id}"));
        let strategy = self.strategy.map(|strategy| format!(" {}", strategy.name()));
        let named = |source: &str| if source == OPERATOR { String::new() } else { format!(" {source}") };
        let reading = self.reading.as_ref().map(|(source, celsius)| format!("{} {} °C", named(source), celsius.degrees()));
        let note = self.note.as_ref().map(|note| format!(" {NOTE}{note})"));
        [luggage, note, cell, step, alarm, strategy, reading].into_iter().flatten().collect()
    }
}

/// `#3 (note: red)`: what stands before the note, and the note.
fn noted(words: &str) -> Option<(&str, Option<Note>)> {
    let Some((about, note)) = words.split_once(NOTE) else { return Some((words, None)) };
    Some((about.trim_end(), Some(Note::new(note.strip_suffix(')')?)?)))
}

/// `#3`, or nothing where the pending piece is meant.
fn piece(words: &str) -> Option<LuggageRef> {
    if words.is_empty() { Some(LuggageRef::Pending) } else { number(words).map(LuggageRef::Id) }
}

/// `#3`
fn number(words: &str) -> Option<LuggageId> {
    words.strip_prefix('#')?.parse().ok().map(LuggageId)
}

fn degrees(words: &str) -> Option<Celsius> {
    words.parse().ok().and_then(Celsius::new)
}

#[cfg(test)]
mod tests {
    use super::{Input, from_words, in_words};
    use crate::command::{Command, LuggageRef, Move, Note, Strategy, TemperatureReport, Verdict};
    use crate::rng::RandomStream;
    use crate::units::{AlarmId, Cell, Celsius, LuggageId};
    use crate::words::{coordinate, number};

    fn reading(dice: &mut RandomStream) -> Celsius {
        loop {
            let any = [f64::from_bits(dice.number()), dice.fraction() * 100.0 - 50.0, f64::from(coordinate(dice) % 100)];
            if let Some(celsius) = Celsius::new(any[dice.below(3) as usize]) {
                return celsius;
            }
        }
    }

    fn sensor(dice: &mut RandomStream) -> std::sync::Arc<str> {
        loop {
            let ranges = [33..127, 0xa1..0x250, 0x4e00..0x9fff_u32];
            let letter = |dice: &mut RandomStream| {
                let range = &ranges[dice.below(3) as usize];
                char::from_u32(range.start + dice.below(u64::from(range.end - range.start)) as u32)
            };
            let length = 1 + dice.below(TemperatureReport::MOST as u64);
            let name: String = (0..length).filter_map(|_| letter(dice)).collect();
            if let Some(name) = TemperatureReport::sensor_name(&name) {
                return name;
            }
        }
    }

    fn note(dice: &mut RandomStream) -> Option<Note> {
        let parts = ["red", " ", "(note: ", ")", " #3", "ü鞄", "<b>", "safe"];
        let length = dice.below(6);
        let text: String = (0..length).map(|_| parts[dice.below(parts.len() as u64) as usize]).collect();
        Note::new(&text)
    }

    #[expect(clippy::wildcard_enum_match_arm, reason = "a command that is missing here ends the test")]
    fn command(input: Input, dice: &mut RandomStream) -> Command {
        let piece = |dice: &mut RandomStream| {
            if dice.happens(0.2) { LuggageRef::Pending } else { LuggageRef::Id(LuggageId(number(dice))) }
        };
        match input {
            Input::Start => Command::Start,
            Input::Stop => Command::Stop,
            Input::BackHome => Command::BackHome,
            Input::Safe => Command::Verdict { luggage: piece(dice), verdict: Verdict::Safe, note: note(dice) },
            Input::Danger => Command::Verdict { luggage: piece(dice), verdict: Verdict::Danger, note: note(dice) },
            Input::TemperatureOk => Command::Temperature(TemperatureReport::Ok),
            Input::TemperatureTooHigh => Command::Temperature(TemperatureReport::TooHigh),
            Input::Reading => Command::Temperature(TemperatureReport::Reading(reading(dice))),
            Input::SensorReading => Command::Temperature(TemperatureReport::Sensor(sensor(dice), reading(dice))),
            Input::Retrieve => Command::Retrieve,
            Input::Reset => Command::Reset,
            Input::Move => Command::Move(Move::ALL[dice.below(6) as usize]),
            Input::Goto => Command::Goto(Cell::new(coordinate(dice), coordinate(dice))),
            Input::RetakePhoto => Command::RetakePhoto(LuggageId(number(dice))),
            Input::Acknowledge => Command::Acknowledge(AlarmId(number(dice))),
            Input::Strategy => Command::ChooseStrategy(Strategy::ALL[dice.below(Strategy::ALL.len() as u64) as usize]),
            event => panic!("{event:?} is no command"),
        }
    }

    #[test]
    fn every_command_comes_back_from_its_words() {
        let mut dice = RandomStream::new(1, "words");
        for _ in 0..2000 {
            for input in Input::COMMANDS {
                let command = command(input, &mut dice);
                let words = in_words(&command);
                assert_eq!(from_words(&words), Some(command), "{words}");
                assert_eq!(Input::from_words(&words).map(|(input, _)| input), Some(input), "{words}");
            }
        }
    }

    #[test]
    fn words_of_another_version_are_no_command() {
        for words in [
            "",
            "start",
            "START ",
            "STOP, 3 times at once",
            "safe #03",
            "safe  #3",
            "safe 3",
            "safe #3 (note: )",
            "safe #3 (note: a",
            "safe #3(note: a)",
            "goto (note: a)",
            "goto (1,2)",
            "move",
            "fly",
        ] {
            assert_eq!(from_words(words), None, "{words}");
        }
    }
}
