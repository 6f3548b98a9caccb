//! An operator who uses every command: mostly one that fits the state, sometimes another.

use std::time::Duration;

use hallsweep_core::rng::RandomStream;
use serde_json::Value;

use crate::ask::ask;

/// Interval between the operator's looks at the state; the robot waits for the operator only at verdicts.
const GLANCE: Duration = Duration::from_millis(5);

/// Method, path and body of commands that the operator sends at random.
const WHIMS: [(&str, &str, &str); 6] = [
    ("POST", "commands/stop", ""),
    ("POST", "commands/backHome", ""),
    ("POST", "commands/start", ""),
    ("PUT", "temperature", "{\"status\":\"tooHigh\"}"),
    ("PUT", "temperature", "{\"celsius\":31.5}"),
    ("POST", "commands/goto", "{\"x\":1,\"y\":1}"),
];

/// Plays missions one after the other.
pub(crate) struct Operator {
    address: String,
    chance: RandomStream,
    missions: u64,
    revision: u64,
}

impl Operator {
    pub(crate) fn new(address: &str) -> Operator {
        Operator { address: address.to_owned(), chance: RandomStream::new(1, "operator"), missions: 0, revision: 0 }
    }

    /// Number of missions that ended.
    pub(crate) const fn missions(&self) -> u64 {
        self.missions
    }

    /// Last revision seen.
    pub(crate) const fn revision(&self) -> u64 {
        self.revision
    }

    /// Reads the state once and sends a command.
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

    /// Removes the holds that the operator can remove, and sends START again.
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

    /// Gives a verdict on the photo or requests another photo, then resumes.
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

    /// Sends a command and returns whether it was accepted. A refusal, for example because the state has changed, is
    /// expected.
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
