//! Instructions to a client, and the messages that it received. How each client gets its instructions is in `client`.

use serde_json::{Value, json};

/// How a client connects.
#[derive(Clone, Debug)]
pub(crate) struct Hello<'a> {
    /// Client id. Empty if the client has none.
    pub(crate) id: &'a str,
    /// Whether the session survives a disconnection.
    pub(crate) remembered: bool,
    /// Name and password.
    pub(crate) login: Option<(&'a str, &'a str)>,
    /// Keep alive, in seconds.
    pub(crate) keepalive_s: u16,
    /// Will: message that the broker publishes if the client disappears.
    pub(crate) will: Option<Say<'a>>,
    /// Headers of the HTTP request of a WebSocket client.
    pub(crate) headers: Vec<(&'a str, &'a str)>,
    /// Filters of the subscription, each with its QoS.
    pub(crate) follow: Vec<(&'a str, u8)>,
}

/// Message to publish.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Say<'a> {
    pub(crate) topic: &'a str,
    pub(crate) payload: &'a str,
    pub(crate) qos: u8,
    pub(crate) retain: bool,
}

/// A received message.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Message {
    pub(crate) topic: String,
    pub(crate) payload: String,
    pub(crate) qos: u64,
    /// Whether the broker had stored the message before the subscription.
    pub(crate) kept: bool,
}

impl<'a> Hello<'a> {
    /// A new client that subscribes to these filters with this QoS.
    pub(crate) fn following(filters: &[&'a str], qos: u8) -> Hello<'a> {
        let follow = filters.iter().map(|filter| (*filter, qos)).collect();
        Hello { id: "", remembered: false, login: None, keepalive_s: 60, will: None, headers: Vec::new(), follow }
    }

    /// A client that publishes. It subscribes to the availability only because mosquitto's command needs a filter.
    pub(crate) fn speaking() -> Hello<'a> {
        Hello::following(&[super::AVAILABILITY], 0)
    }

    /// Gives the client this id and a persistent session.
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

    /// Instruction for the scripts.
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
    /// Message with QoS 0.
    pub(crate) const fn plain(topic: &'a str, payload: &'a str) -> Say<'a> {
        Say { topic, payload, qos: 0, retain: false }
    }

    pub(crate) const fn at(self, qos: u8) -> Say<'a> {
        Say { qos, ..self }
    }

    pub(crate) const fn kept(self) -> Say<'a> {
        Say { retain: true, ..self }
    }

    /// Instruction for the scripts.
    pub(super) fn json(self) -> Value {
        json!({"topic": self.topic, "payload": self.payload, "qos": self.qos, "retain": self.retain})
    }
}

impl Message {
    /// Parses a line of JSON that a client printed in the format of `mosquitto_sub -F %j`.
    pub(super) fn read(line: &str) -> Message {
        let read: Value = serde_json::from_str(line).unwrap_or_else(|error| panic!("{error}: {line}"));
        let text = |name: &str| read[name].as_str().unwrap_or_default().to_owned();
        let qos = read["qos"].as_u64().expect("a QoS");
        Message { topic: text("topic"), payload: text("payload"), qos, kept: read["retain"] == 1 }
    }

    /// Payload as JSON.
    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.payload).unwrap_or_else(|error| panic!("{error}: {self:?}"))
    }
}
