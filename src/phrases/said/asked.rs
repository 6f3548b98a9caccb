//! Words for requests and for their senders; words for refusals are in `refused`.

use crate::phrases::{Language, Phrase};
use hallsweep_core::asked::Asked;
use hallsweep_core::bomb_size::BombSize;
use hallsweep_core::closing::{AreaClosing, Closing};
use hallsweep_core::command::{Again, Carries, Command, Door, Hot, Issuer, Move, Note, TemperatureReport, Verdict};
use hallsweep_core::hand_over::HandOver;
use hallsweep_core::units::{Celsius, LuggageId};

impl Language {
    /// Words for a request. If a verdict does not name its piece, `meant` is the piece that the verdict was about.
    pub fn asked(self, asked: &Asked, meant: Option<LuggageId>) -> String {
        match asked {
            Asked::Command(command) => self.command(command, meant),
            Asked::Stops { count, within: None } => self.say("asked-stops-at-once").with("count", count).to_string(),
            Asked::Stops { count, within: Some(within) } => {
                let seconds = self.number(&format!("{:.1}", within.as_secs_f64()));
                self.say("asked-stops-within").with("count", count).with("seconds", seconds).to_string()
            }
            Asked::Many { last, more } => {
                self.say("asked-many").with("last", self.asked(last, meant)).with("more", more).to_string()
            }
            Asked::Simulated(simulated) => self.simulated(simulated),
            Asked::Words(words) => words.clone(),
        }
    }

    /// Words for a sender, as `operator (console, 192.0.2.7)`.
    pub fn issuer(self, Issuer { door, who, from }: &Issuer) -> String {
        let said = self.say(if *door == Door::LOCAL { "issuer-local" } else { "issuer" }).with("who", who).with("door", door.0);
        if *door == Door::LOCAL { said.to_string() } else { said.with("from", from).to_string() }
    }

    fn command(self, command: &Command, meant: Option<LuggageId>) -> String {
        let named = self.say_of("asked", command.code());
        let noted = |said: Phrase, note: &Option<Note>| self.with_remarks(said, Hot::NONE, note.as_ref());
        let celsius = |celsius: &Celsius| self.number(&format!("{} °C", celsius.degrees()));
        let said = match command.carries() {
            Carries::Nothing => named,
            Carries::Luggage(id) if matches!(command, Command::Retrieve(_)) => {
                self.say("asked-of").with("asked", named).with("id", id)
            }
            Carries::Luggage(id) => named.with("id", id),
            Carries::Alarm(id) => named.with("id", id),
            Carries::Move(step) => named.with("move", self.say_of("move", letter(step))),
            Carries::Cell(cell) => named.with("cell", cell),
            Carries::Verdict(luggage, verdict, note, hot) => {
                let said = self.say(match verdict {
                    Verdict::Safe => "asked-safe",
                    Verdict::Danger => "asked-danger",
                });
                return self.answer_given(&said, luggage.or(meant), note, hot);
            }
            Carries::Closing(Closing { name, note, .. }) => return noted(named.with("name", name), note),
            Carries::HandOver(HandOver { to, note, .. }) => return noted(named.with("to", to), note),
            Carries::Again(Again::Within(bounds)) => named.with("from", bounds.least).with("to", bounds.most),
            Carries::Again(Again::Area(area)) => self.say("asked-area-again").with("area", area),
            Carries::Areas(names) => return self.area_order(names),
            Carries::AreaClosing(AreaClosing { area, name, note, .. }) => {
                return noted(named.with("area", area).with("name", name), note);
            }
            Carries::Unsure(luggage, note, hot) => return self.answer_given(&named, luggage.or(meant), note, hot),
            Carries::Strategy(strategy) => named.with("strategy", self.say_of("strategy", strategy.name())),
            Carries::Temperature(TemperatureReport::Ok) => self.say("asked-ok"),
            Carries::Temperature(TemperatureReport::TooHigh) => self.say("asked-too-high"),
            Carries::Temperature(TemperatureReport::Reading(read)) => self.say("asked-reading").with("celsius", celsius(read)),
            Carries::Temperature(TemperatureReport::Sensor(sensor, read)) => {
                self.say("asked-sensor").with("sensor", sensor).with("celsius", celsius(read))
            }
        };
        said.to_string()
    }

    fn answer_given(self, said: &Phrase<'_>, named: Option<LuggageId>, note: Option<&Note>, hot: Hot) -> String {
        let of = |id: LuggageId| self.say("asked-of").with("asked", said).with("id", id).to_string();
        let said = named.map_or_else(|| said.to_string(), of);
        self.with_remarks(said, hot, note)
    }

    /// Words for the answers about a piece, as `hidden: no, typical: yes`; `None` if there are none.
    pub fn hot(self, hot: Hot) -> Option<String> {
        let given = hot.answers().into_iter().filter_map(|(question, answer)| Some((question, answer?)));
        let said = given.map(|(question, answer)| {
            let (question, answer) = (self.say_of("hot", question), self.say_of("hot-answer", answer.name()));
            format!("{question}: {answer}")
        });
        let size = hot.size.map(|size| self.bomb_size(size));
        let said: Vec<String> = said.chain(size).collect();
        (!said.is_empty()).then(|| said.join(", "))
    }

    fn bomb_size(self, size: BombSize) -> String {
        let said = match size {
            BombSize::Radius(metres) => self.say("size-radius").with("metres", metres),
            BombSize::Pipe | BombSize::Vest | BombSize::Suitcase | BombSize::Car => {
                self.say("size-named").with("size", self.say_of("size", &size.to_string()))
            }
        };
        said.to_string()
    }
}

/// The letter that old clients send for a move.
const fn letter(step: Move) -> &'static str {
    match step {
        Move::Forward => "w",
        Move::Backward => "s",
        Move::TurnLeft => "a",
        Move::TurnRight => "d",
        Move::NudgeLeft => "z",
        Move::NudgeRight => "x",
    }
}
