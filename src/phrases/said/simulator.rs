//! Words for what the simulator says, and for the changes made to the simulator.

use std::borrow::Cow;
use std::collections::BTreeSet;

use crate::phrases::Language;
use hallsweep_core::simulated::{Change, Simulated};
use hallsweep_core::speed::Speed;
use hallsweep_core::units::Cell;

impl Language {
    /// Words that a robot sent. The words of the simulator become a phrase; other words are unchanged.
    pub fn robot_said(self, words: &str) -> Cow<'_, str> {
        let said = match words {
            "the simulator keeps it lost" => self.say("simulated-lost"),
            "the shutter did not open: take the photo again" => self.say("simulated-no-photo"),
            _ => match words.strip_prefix("it is put down in the hall ") {
                Some(hall) => self.say("simulated-is-put-down").with("hall", hall),
                None => return Cow::Borrowed(words),
            },
        };
        Cow::Owned(said.to_string())
    }

    pub(super) fn simulated(self, simulated: &Simulated) -> String {
        let said = match simulated {
            Simulated::Changed(change) => self.say("simulated").with("changes", self.changes(change)),
            Simulated::Step => self.say("simulated-step"),
            Simulated::PutDown(hall) => self.say("simulated-put-down").with("hall", hall),
            Simulated::Kept(hall) => self.say("simulated-keeps").with("hall", hall),
            Simulated::Discarded(hall) => self.say("simulated-discards").with("hall", hall),
        };
        said.to_string()
    }

    fn changes(self, Change { speed, is_paused, link_lost, no_thermometer, camera_fails, blocked }: &Change) -> String {
        let either = |is_so: &Option<bool>, so, not| is_so.map(|is_so| self.say(if is_so { so } else { not }));
        let speed = speed.map(|speed| match speed {
            Speed::Max => self.say("simulated-speed-max"),
            Speed::Times(factor) => self.say("simulated-speed").with("speed", self.number(&factor.to_string())),
        });
        let cells = |cells: &BTreeSet<Cell>| cells.iter().map(Cell::to_string).collect::<Vec<_>>().join(", ");
        let blocked = blocked.as_ref().map(|blocked| match blocked.len() {
            0 => self.say("simulated-nothing-blocked"),
            _ => self.say("simulated-blocked").with("cells", cells(blocked)),
        });
        let changes = [
            either(is_paused, "simulated-paused", "simulated-going-on"),
            speed,
            either(link_lost, "simulated-linkLost", "simulated-linked"),
            either(no_thermometer, "simulated-noThermometer", "simulated-thermometer"),
            either(camera_fails, "simulated-cameraFails", "simulated-camera"),
            blocked,
        ];
        changes.into_iter().flatten().map(|change| change.to_string()).collect::<Vec<_>>().join(", ")
    }
}
