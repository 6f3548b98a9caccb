//! An operator who does everything an operator can: looks at the state, and presses what fits it, or now and then something else.

use std::time::Duration;

use hallsweep_core::rng::RandomStream;
use serde_json::Value;

use crate::ask::ask;

/// A person looks up so often; the robot does not wait for it except for verdicts.
const GLANCE: Duration = Duration::from_millis(5);

/// What is pressed although nothing asks for it, with its path and body.
const WHIMS: [(&str, &str, &str); 6] = [
    ("POST", "commands/stop", ""),
    ("POST", "commands/backHome", ""),
    ("POST", "commands/start", ""),
    ("PUT", "temperature", "{\"status\":\"tooHigh\"}"),
    ("PUT", "temperature", "{\"celsius\":31.5}"),
    ("POST", "commands/goto", "{\"x\":1,\"y\":1}"),
];

/// Plays one after the other mission.
pub(crate) struct Operator {
    address: String,
    chance: RandomStream,
    missions: u64,
    revision: u64,
}

impl Operator {
    /// An operator of the program at this address.
    pub(crate) fn new(address: &str) -> Operator {
        Operator { address: address.to_owned(), chance: RandomStream::new(1, "operator"), missions: 0, revision: 0 }
    }

    /// Missions that were brought to an end.
    pub(crate) const fn missions(&self) -> u64 {
        self.missions
    }

    /// The last revision that was seen.
    pub(crate) const fn revision(&self) -> u64 {
        self.revision
    }

    /// Looks once, and does what it likes.
    pub(crate) fn act(&mut self) {
        std::thread::sleep(GLANCE);
        let state = self.state();
        self.revision = state["revision"].as_u64().unwrap_or(self.revision);
        if self.chance.happens(0.02) {
            let whim = self.chance.below(WHIMS.len() as u64);
            let (method, path, body) = WHIMS[usize::try_from(whim).expect("a small number")];
            self.press(method, path, body);
            return;
        }
        self.remove_holds(&state["mission"]["holds"]);
        self.acknowledge(&state["alarms"]);
        match state["mission"]["phase"].as_str().unwrap_or_default() {
            "idle" => self.start(),
            "inspecting" | "driving" | "atHome" => self.answer(&state),
            "bombLocated" | "bagSecured" | "explored" => {
                self.missions += u64::from(self.press("POST", "commands/reset", ""));
            }
            "fault" => drop(self.press("POST", "commands/reset", "")),
            _ => {}
        }
    }

    /// Takes away what can be taken away, and starts again.
    fn remove_holds(&mut self, holds: &Value) {
        let has = |name: &str| holds.as_array().is_some_and(|all| all.iter().any(|hold| hold == name));
        if has("tooHigh") {
            self.press("PUT", "temperature", "{\"status\":\"ok\"}");
        }
        if has("temperature") {
            self.press("PUT", "temperature", "{\"celsius\":20.0}");
        }
        if ["operator", "awaitingStart", "restart"].into_iter().any(has) {
            self.start();
        }
    }

    fn acknowledge(&mut self, alarms: &Value) {
        for alarm in alarms.as_array().into_iter().flatten().filter(|alarm| alarm["acknowledged"].is_null()) {
            self.press("POST", &format!("alarms/{}/acknowledge", alarm["id"]), "");
        }
    }

    /// Looks at the photo and says what it is, or has another one taken; then goes on.
    fn answer(&mut self, state: &Value) {
        let pieces = state["luggage"].as_array().into_iter().flatten();
        for piece in pieces.filter(|piece| piece["verdict"] == "pending") {
            let id = &piece["id"];
            if self.chance.happens(0.1) {
                self.press("POST", &format!("luggage/{id}/photo"), "");
                continue;
            }
            drop(self.ask("GET", &format!("luggage/{id}/photo"), ""));
            let verdict = if self.chance.happens(0.05) { "danger" } else { "safe" };
            self.press("POST", &format!("luggage/{id}/verdict"), &format!("{{\"verdict\":\"{verdict}\"}}"));
        }
        if state["mission"]["phase"] == "atHome" {
            self.start();
        }
    }

    fn start(&mut self) {
        self.press("POST", "commands/start", "");
    }

    /// Whether it was accepted; a refusal, as of a button that was pressed too late, is part of the play.
    fn press(&mut self, method: &str, path: &str, body: &str) -> bool {
        let answer = self.ask(method, path, body);
        assert!(!answer.starts_with("HTTP/1.1 5"), "{method} {path} {body}: {answer}");
        answer.contains("\"accepted\":true")
    }

    fn state(&self) -> Value {
        let answer = self.ask("GET", "state", "");
        let body = answer.split_once("\r\n\r\n").map_or("", |(_, body)| body);
        serde_json::from_str(body).unwrap_or_else(|error| panic!("{error}: {answer}"))
    }

    fn ask(&self, method: &str, path: &str, body: &str) -> String {
        ask(&self.address, method, &format!("/api/v1/{path}"), body).expect("the program answers")
    }
}
