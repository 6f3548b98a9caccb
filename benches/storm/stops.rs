//! An operator's STOP in five ways, from a client that waits for the answer.

use std::io::{self, Error};
use std::net::Ipv4Addr;
use std::time::Duration;

use crate::coap::Coap;
use crate::course::{Doors, OPERATOR};
use crate::http::{Kept, request};
use crate::packets::{PUBACK, SUBACK, publish, subscribe};
use crate::wire::{Wire, login};

const STOP: &str = "hallsweep/discovery/command/stop";

/// Way in which a STOP is sent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    HttpFresh,
    HttpKept,
    Coap,
    MqttKept,
    MqttFresh,
}

impl Way {
    pub(crate) const ALL: [Way; 5] = [Way::HttpFresh, Way::HttpKept, Way::Coap, Way::MqttKept, Way::MqttFresh];

    /// Name in the figures.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Way::HttpFresh => "HTTP, fresh",
            Way::HttpKept => "HTTP, kept",
            Way::Coap => "CoAP",
            Way::MqttKept => "MQTT, kept",
            Way::MqttFresh => "MQTT, fresh",
        }
    }
}

/// Operator with one persistent connection of each kind, opened before the storm.
pub(crate) struct Operator {
    doors: Doors,
    /// Time after which a STOP without an answer counts as failed.
    patience: Duration,
    kept: Kept,
    mqtt: Wire,
    coap: Coap,
    pressed: usize,
    /// Number of persistent connections that were lost and replaced.
    pub(crate) cut: usize,
}

impl Operator {
    /// Connects to every door.
    pub(crate) fn come(doors: &Doors, patience: Duration) -> io::Result<Operator> {
        let (kept, mqtt, coap) = (kept(doors, patience)?, listening(doors, patience)?, Coap::at(doors.coap));
        Ok(Operator { doors: doors.clone(), patience, kept, mqtt, coap, pressed: 0, cut: 0 })
    }

    /// Sends START on the persistent HTTP connection, or over CoAP.
    pub(crate) fn start(&mut self, over_coap: bool) -> io::Result<()> {
        if over_coap {
            return self.coap.ask("POST", "commands/start", "").and_then(|reply| accepted(&reply.text));
        }
        let start = request("POST", "/api/v1/commands/start", self.doors.http, Some(&self.doors.operator), "");
        match self.kept.ask(&start) {
            Ok(answer) => accepted(&answer.body),
            Err(error) => {
                self.cut += 1;
                self.kept = kept(&self.doors, self.patience)?;
                Err(error)
            }
        }
    }

    /// Sends STOP in this way and waits for the answer.
    pub(crate) fn stop(&mut self, way: Way) -> io::Result<()> {
        self.pressed += 1;
        let pressed = match way {
            Way::HttpFresh => http(&self.doors, self.patience).and_then(|mut fresh| by_http(&mut fresh, &self.doors)),
            Way::HttpKept => by_http(&mut self.kept, &self.doors),
            Way::Coap => self.coap.ask("POST", "commands/stop", "").and_then(|reply| accepted(&reply.text)),
            Way::MqttKept => by_mqtt(&mut self.mqtt, self.pressed),
            Way::MqttFresh => self.by_fresh_mqtt(),
        };
        if pressed.is_err() && matches!(way, Way::HttpKept | Way::MqttKept) {
            self.cut += 1;
            match way {
                Way::HttpKept => self.kept = kept(&self.doors, self.patience)?,
                Way::HttpFresh | Way::Coap | Way::MqttKept | Way::MqttFresh => self.mqtt = listening(&self.doors, self.patience)?,
            }
        }
        pressed
    }

    /// Connects a new client, sends STOP, and waits until the broker acknowledges it.
    fn by_fresh_mqtt(&mut self) -> io::Result<()> {
        let connect = login(&format!("newcomer-{}", self.pressed), OPERATOR, &self.doors.operator);
        let mut wire = Wire::let_in(self.doors.mqtt, Ipv4Addr::LOCALHOST, &connect, self.patience)?;
        wire.say(&publish(STOP, b"", 1, 0, 1))?;
        wire.until(PUBACK).map(drop)
    }
}

fn http(doors: &Doors, patience: Duration) -> io::Result<Kept> {
    Kept::to(doors.http, Ipv4Addr::LOCALHOST, patience)
}

/// Connection with an earlier request of the operator. Without one, the door would not know whose connection it is.
fn kept(doors: &Doors, patience: Duration) -> io::Result<Kept> {
    let mut kept = http(doors, patience)?;
    kept.ask(&request("GET", "/api/v1/state", doors.http, Some(&doors.operator), ""))?;
    Ok(kept)
}

/// Broker client that receives the results of its STOPs.
fn listening(doors: &Doors, patience: Duration) -> io::Result<Wire> {
    let connect = login("operator-kept", OPERATOR, &doors.operator);
    let mut wire = Wire::let_in(doors.mqtt, Ipv4Addr::LOCALHOST, &connect, patience)?;
    wire.say(&subscribe(1, &format!("{STOP}/result"), 0))?;
    wire.until(SUBACK)?;
    Ok(wire)
}

fn by_http(kept: &mut Kept, doors: &Doors) -> io::Result<()> {
    let stop = request("POST", "/api/v1/commands/stop", doors.http, Some(&doors.operator), "");
    kept.ask(&stop).and_then(|answer| accepted(&answer.body))
}

/// The result contains the name of this STOP, because results for new clients arrive here too.
fn by_mqtt(wire: &mut Wire, number: usize) -> io::Result<()> {
    let name = format!("\"id\":\"stop-{number}\"");
    wire.say(&publish(STOP, format!("{{{name}}}").as_bytes(), 0, 0, 0))?;
    loop {
        let result = String::from_utf8_lossy(&wire.until(0x30)?).into_owned();
        if result.contains(&name) {
            return accepted(&result);
        }
    }
}

fn accepted(answer: &str) -> io::Result<()> {
    if answer.contains("\"accepted\":true") { Ok(()) } else { Err(Error::other(answer.to_owned())) }
}
