//! What the core says, as phrases. The English ones are the core's own sentences, which programs and records have; tests hold that, but for a
//! piece that was meant and not named, which stands before the note here. What others say stays in their words: a robot, a disk.

mod asked;
mod fact;
mod fault;
mod line;
mod refused;
mod simulator;

use super::{Language, Phrase};
use hallsweep_core::mission::{Hold, PhaseName};
use hallsweep_core::units::{Cell, Celsius, Heading};

impl Language {
    pub fn phase(self, phase: PhaseName) -> Phrase<'static> {
        self.say_of("phase", phase.name())
    }

    /// A phase, and the one that it interrupts.
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

    /// `safe`, `danger` or `pending`.
    pub fn verdict(self, name: &str) -> Phrase<'_> {
        self.say_of("verdict", name)
    }

    /// `21.5 °C`
    pub fn celsius(self, celsius: Celsius) -> String {
        self.number(&celsius.to_string())
    }

    /// A cell in words: `column 3, row 4`.
    pub fn place(self, cell: Cell) -> String {
        self.say("place").with("column", cell.x).with("row", cell.y).to_string()
    }
}

#[cfg(test)]
mod tests;
