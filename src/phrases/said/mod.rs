//! Values of the core as phrases. The English phrases are the core's own sentences, which programs and records use;
//! tests compare phrases and sentences. One phrase differs: if a verdict does not name its piece, the phrase adds the
//! piece before the note, and the core's sentence adds it after the note. Words from outside, such as those of a
//! robot or a disk, stay as they are.

mod asked;
mod coverage;
mod exercise;
mod fact;
mod fault;
mod line;
mod refused;
mod simulator;

use std::fmt::Display;

use super::{Language, Phrase};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::state::{Conditions, Participant, PersistentState};
use hallsweep_core::units::{Cell, Celsius, Heading};

impl Language {
    pub fn phase(self, phase: PhaseName) -> Phrase<'static> {
        self.say_of("phase", phase.name())
    }

    pub fn came_to(self, phase: PhaseName, is_put_away: bool) -> Phrase<'static> {
        match phase {
            PhaseName::Explored => self.say("missions-searched"),
            PhaseName::BombLocated => self.say("missions-bomb-located"),
            PhaseName::BagSecured => self.say("missions-bomb-secured"),
            PhaseName::Idle
            | PhaseName::Exploring
            | PhaseName::Inspecting
            | PhaseName::Driving
            | PhaseName::ReturningHome
            | PhaseName::AtHome
            | PhaseName::ReturningWithAlarm
            | PhaseName::Retrieving
            | PhaseName::Fault => self.ended_while(self.phase(phase), is_put_away),
        }
    }

    /// The result of an unfinished mission: its present phase, or its last phase if the mission was archived.
    pub fn ended_while(self, phase: impl Display, is_put_away: bool) -> Phrase<'static> {
        self.say(if is_put_away { "missions-archived-while" } else { "missions-under-way" }).with("phase", phase)
    }

    /// The result `came_to` of a mission, followed by the number of places that were not searched and the kind of the
    /// searching robot.
    pub fn headline(self, came_to: &str, state: &PersistentState) -> String {
        let searcher = state.conditions.as_ref().and_then(|conditions| conditions.venue.robots.first());
        let unsearched = match state.map.unsearched() {
            0 => String::new(),
            places => format!(" · {}", self.say("unsearched").with("count", places)),
        };
        format!("{came_to}{unsearched} · {}", self.engine(searcher))
    }

    pub fn engine(self, searcher: Option<&Participant>) -> Phrase<'_> {
        match searcher.map(|robot| &*robot.kind) {
            None => self.say("engine-not-on-record"),
            Some("sim") => self.say("engine-sim"),
            Some("virtual-tcp" | "virtual-ws") => self.say("engine-virtual"),
            Some(other) => self.say("engine-other").with("kind", other),
        }
    }

    /// The robots that took part, each with its kind and its address. In a simulated hall, the seed follows.
    pub fn team(self, conditions: Option<&Conditions>) -> String {
        let Some(venue) = conditions.map(|conditions| &conditions.venue).filter(|venue| !venue.robots.is_empty()) else {
            return self.say("robots-not-on-record").to_string();
        };
        let one = |robot: &Participant| {
            let address = robot.address.as_ref().map_or_else(String::new, |address| format!(", {address}"));
            format!("{} ({}{address})", robot.name, self.engine(Some(robot)))
        };
        let robots = self.list(&venue.robots.iter().map(one).collect::<Vec<_>>());
        match venue.seed {
            Some(seed) => self.say("robots-and-seed").with("robots", robots).with("seed", seed).to_string(),
            None => robots,
        }
    }

    pub fn phase_and_before(self, phase: PhaseName, interrupted: Option<PhaseName>) -> String {
        let said = self.phase(phase);
        interrupted.map_or_else(
            || said.to_string(),
            |before| self.say("interrupted").with("phase", &said).with("before", self.phase(before)).to_string(),
        )
    }

    pub fn hold(self, hold: Hold) -> Phrase<'static> {
        self.say_of("hold", hold.name())
    }

    pub fn heading(self, heading: Heading) -> Phrase<'static> {
        self.say_of("heading", heading.name())
    }

    /// The word for a verdict. `name` is `safe`, `danger` or `pending`.
    pub fn verdict(self, name: &str) -> Phrase<'_> {
        self.say_of("verdict", name)
    }

    /// A temperature such as `21.5 °C`, with the decimal mark of the language.
    pub fn celsius(self, celsius: Celsius) -> String {
        self.number(&celsius.to_string())
    }

    /// A cell as `column 3, row 4`.
    pub fn place(self, cell: Cell) -> String {
        self.say("place").with("column", cell.x).with("row", cell.y).to_string()
    }
}

#[cfg(test)]
mod tests;
