//! What the simulator says of itself and of what was done to it. It says so in English words, which go on record like those of any robot, and
//! are read here.

use std::borrow::Cow;

use crate::phrases::{Language, Phrase};

impl Language {
    /// What a robot says, or whoever had something done to what is simulated: a phrase if these are words of the simulator, else as it was said.
    pub fn robot_said(self, words: &str) -> Cow<'_, str> {
        self.simulator(words).map_or(Cow::Borrowed(words), Cow::Owned)
    }

    fn simulator(self, words: &str) -> Option<String> {
        let said = |phrase: Phrase<'_>| Some(phrase.to_string());
        match words {
            "the simulator keeps it lost" => return said(self.say("simulated-lost")),
            "the shutter did not open: take the photo again" => return said(self.say("simulated-no-photo")),
            "simulator one step" => return said(self.say("simulated-step")),
            _ => {}
        }
        for (begin, id) in [
            ("put down in the hall ", "simulated-put-down"),
            ("it is put down in the hall ", "simulated-is-put-down"),
            ("simulator keeps the hall ", "simulated-keeps"),
            ("simulator discards the hall ", "simulated-discards"),
        ] {
            if let Some(hall) = words.strip_prefix(begin) {
                return said(self.say(id).with("hall", hall));
            }
        }
        let changes = self.changes(words.strip_prefix("simulator ")?)?;
        said(self.say("simulated").with("changes", changes.join(", ")))
    }

    /// `paused, speed 2, camera fails: yes, blocked (1, 2), (3, 4)`: the cells stand last.
    fn changes(self, words: &str) -> Option<Vec<String>> {
        let (before, blocked) = match words.split_once("blocked (") {
            Some((before, cells)) => (before.trim_end_matches(", "), Some(format!("({cells}"))),
            None => (words, None),
        };
        let mut changes: Vec<String> =
            before.split(", ").filter(|word| !word.is_empty()).map(|word| self.change(word)).collect::<Option<_>>()?;
        changes.extend(blocked.map(|cells| self.say("simulated-blocked").with("cells", cells).to_string()));
        (!changes.is_empty()).then_some(changes)
    }

    fn change(self, words: &str) -> Option<String> {
        let said = match words {
            "paused" => self.say("simulated-paused"),
            "going on" => self.say("simulated-going-on"),
            "speed max" => self.say("simulated-speed-max"),
            "no way blocked" => self.say("simulated-nothing-blocked"),
            "link lost: yes" => self.say("simulated-linkLost"),
            "link lost: no" => self.say("simulated-linked"),
            "no thermometer: yes" => self.say("simulated-noThermometer"),
            "no thermometer: no" => self.say("simulated-thermometer"),
            "camera fails: yes" => self.say("simulated-cameraFails"),
            "camera fails: no" => self.say("simulated-camera"),
            _ => self.say("simulated-speed").with("speed", self.number(words.strip_prefix("speed ")?)),
        };
        Some(said.to_string())
    }
}
