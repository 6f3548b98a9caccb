//! Client with a key at the published port of a container: reads the state, sends commands, and gives verdicts.

use std::io::Read;
use std::net::SocketAddr;
use std::time::Duration;

use serde_json::Value;

use crate::engine::{Container, text, until};

pub(crate) struct Client {
    address: SocketAddr,
    token: String,
    agent: ureq::Agent,
}

impl Client {
    /// Client with the operator's key, which `hallsweep token` prints in the container.
    pub(crate) fn of(container: &Container<'_>) -> Client {
        let shown = until("there is a key", || {
            let shown = container.exec(&["hallsweep", "token"]);
            shown.status.success().then(|| text(&shown.stdout))
        });
        let token = shown.lines().find_map(|line| line.trim().strip_prefix("token ")).expect("the token is shown").trim();
        Client::at(container.published("8080/tcp"), token)
    }

    pub(crate) fn at(address: SocketAddr, token: &str) -> Client {
        let config = ureq::Agent::config_builder().http_status_as_error(false).proxy(None).max_redirects(0);
        let agent = config.timeout_global(Some(Duration::from_secs(60))).build().into();
        Client { address, token: token.to_owned(), agent }
    }

    /// Status and body of a GET with this Host header.
    pub(crate) fn look(&self, path: &str, host: Option<&str>) -> (u16, String) {
        let request = self.agent.get(format!("http://{}{path}", self.address));
        let request = request.header("authorization", format!("Bearer {}", self.token));
        let request = if let Some(host) = host { request.header("host", host) } else { request };
        let mut answer = request.call().expect("it answers");
        (answer.status().as_u16(), answer.body_mut().read_to_string().expect("the answer is whole"))
    }

    pub(crate) fn state(&self) -> Value {
        let (status, body) = self.look("/api/v1/state", None);
        assert_eq!(status, 200, "{body}");
        serde_json::from_str(&body).expect("JSON")
    }

    /// Sends a command, which must be accepted.
    pub(crate) fn post(&self, path: &str, body: &str) {
        let (status, said) = self.send(path, body);
        assert_eq!(status, 200, "{path}: {said}");
    }

    /// Status and body of the answer to a command.
    pub(crate) fn send(&self, path: &str, body: &str) -> (u16, String) {
        let request = self.agent.post(format!("http://{}/api/v1/{path}", self.address));
        let request =
            request.header("authorization", format!("Bearer {}", self.token)).header("content-type", "application/json");
        let mut answer = request.send(body).expect("it answers");
        (answer.status().as_u16(), answer.body_mut().read_to_string().expect("the answer is whole"))
    }

    /// Event stream, which has begun and lasts until the connection ends.
    pub(crate) fn events(&self) -> impl Read + use<> {
        let request = self.agent.get(format!("http://{}/api/v1/events", self.address));
        let request = request.header("authorization", format!("Bearer {}", self.token));
        let mut events = request.call().expect("it answers").into_body().into_reader();
        events.read_exact(&mut [0]).expect("what stands comes first");
        events
    }

    pub(crate) fn until(&self, wanted: &str, is_so: impl Fn(&Value) -> bool) -> Value {
        until(wanted, || Some(self.state()).filter(|state| is_so(state)))
    }

    /// Waits until a piece needs a verdict, and returns its number.
    pub(crate) fn until_asked(&self) -> u64 {
        pending(&self.until("a verdict is asked for", |state| pending(state).is_some())).expect("it was there just now")
    }

    /// Runs a whole mission from START on; every piece gets the verdict safe.
    pub(crate) fn search_the_hall(&self) -> Value {
        self.post("commands/start", "");
        loop {
            let is_over = |state: &Value| phase(state) == "explored";
            let state = self.until("a piece, or the end", |state| pending(state).is_some() || is_over(state));
            let Some(piece) = pending(&state) else { return state };
            self.post(&format!("luggage/{piece}/verdict"), r#"{"verdict":"safe"}"#);
        }
    }
}

/// Parts of the state that a restart must preserve: the phase of the mission, the luggage and the map.
pub(crate) fn kept(state: &Value) -> Value {
    let mission = &state["mission"];
    serde_json::json!({
        "mission": { "id": mission["id"], "phase": mission["phase"] },
        "luggage": state["luggage"],
        "rows": state["map"]["rows"],
    })
}

pub(crate) fn phase(state: &Value) -> &str {
    state["mission"]["phase"].as_str().unwrap_or_default()
}

fn pending(state: &Value) -> Option<u64> {
    let asks = phase(state) == "inspecting";
    let pieces = state["luggage"].as_array().filter(|_| asks)?.iter();
    pieces.filter(|piece| piece["verdict"] == "pending").find_map(|piece| piece["id"].as_u64())
}
