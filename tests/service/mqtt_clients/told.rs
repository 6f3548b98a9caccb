//! What a client is told to do, and what it heard. How it is told is in `client`.

use serde_json::{Value, json};

/// How a client comes in.
#[derive(Clone, Debug)]
pub(crate) struct Hello<'a> {
    /// Its id; empty: none of its own.
    pub(crate) id: &'a str,
    /// Whether it is to be remembered while it is away.
    pub(crate) remembered: bool,
    /// Name and password.
    pub(crate) login: Option<(&'a str, &'a str)>,
    /// How long it may be silent, in seconds.
    pub(crate) keepalive_s: u16,
    /// What is published for it when it is gone without a word.
    pub(crate) will: Option<Say<'a>>,
    /// Headers of the request, where it comes by WebSocket.
    pub(crate) headers: Vec<(&'a str, &'a str)>,
    /// The filters it subscribes to, each with its QoS.
    pub(crate) follow: Vec<(&'a str, u8)>,
}

/// Something to be published.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Say<'a> {
    pub(crate) topic: &'a str,
    pub(crate) payload: &'a str,
    pub(crate) qos: u8,
    pub(crate) retain: bool,
}

/// A message that a client heard.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Message {
    pub(crate) topic: String,
    pub(crate) payload: String,
    pub(crate) qos: u64,
    /// Whether it had been kept before the client came.
    pub(crate) kept: bool,
}

impl<'a> Hello<'a> {
    /// A newcomer that follows these filters with this QoS.
    pub(crate) fn following(filters: &[&'a str], qos: u8) -> Hello<'a> {
        let follow = filters.iter().map(|filter| (*filter, qos)).collect();
        Hello { id: "", remembered: false, login: None, keepalive_s: 60, will: None, headers: Vec::new(), follow }
    }

    /// One that publishes, and follows only whether the program is there: mosquitto's command does not come to follow nothing.
    pub(crate) fn speaking() -> Hello<'a> {
        Hello::following(&[super::AVAILABILITY], 0)
    }

    /// One that is remembered under this id while it is away.
    pub(crate) fn remembered(self, id: &'a str) -> Hello<'a> {
        Hello { id, remembered: true, ..self }
    }

    pub(crate) fn with_will(self, will: Say<'a>) -> Hello<'a> {
        Hello { will: Some(will), ..self }
    }

    pub(crate) fn with_headers(self, headers: &[(&'a str, &'a str)]) -> Hello<'a> {
        Hello { headers: headers.to_vec(), ..self }
    }

    pub(crate) fn called(self, id: &'a str) -> Hello<'a> {
        Hello { id, ..self }
    }

    pub(crate) fn with_login(self, name: &'a str, password: &'a str) -> Hello<'a> {
        Hello { login: Some((name, password)), ..self }
    }

    /// As the scripts are told it.
    pub(super) fn json(&self, at: std::net::SocketAddr, web: bool, five: bool) -> Value {
        let (name, password) = self.login.unwrap_or_default();
        let headers: serde_json::Map<String, Value> =
            self.headers.iter().map(|(name, value)| ((*name).to_owned(), (*value).into())).collect();
        json!({
            "host": at.ip().to_string(), "port": at.port(), "web": web, "five": five, "headers": headers,
            "id": self.id, "remembered": self.remembered, "name": name, "password": password,
            "keepalive_s": self.keepalive_s, "will": self.will.map(Say::json), "follow": self.follow,
        })
    }
}

impl<'a> Say<'a> {
    /// Once at most.
    pub(crate) const fn plain(topic: &'a str, payload: &'a str) -> Say<'a> {
        Say { topic, payload, qos: 0, retain: false }
    }

    pub(crate) const fn at(self, qos: u8) -> Say<'a> {
        Say { qos, ..self }
    }

    pub(crate) const fn kept(self) -> Say<'a> {
        Say { retain: true, ..self }
    }

    /// As the scripts are told it.
    pub(super) fn json(self) -> Value {
        json!({"topic": self.topic, "payload": self.payload, "qos": self.qos, "retain": self.retain})
    }
}

impl Message {
    /// From a line of JSON that a client printed, as `mosquitto_sub -F %j` does.
    pub(super) fn read(line: &str) -> Message {
        let read: Value = serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"));
        let text = |name: &str| read[name].as_str().unwrap_or_default().to_owned();
        let qos = read["qos"].as_u64().expect("a QoS");
        Message { topic: text("topic"), payload: text("payload"), qos, kept: read["retain"] == 1 }
    }

    /// What it says, in JSON.
    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.payload).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
}
