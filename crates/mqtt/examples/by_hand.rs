//! Puts a client's bytes through a connection by hand, and prints which commands were heard and what the client is
//! answered. A program does the same behind a socket.
#![expect(clippy::print_stdout, reason = "an example shows what comes out")]

use std::{sync::Arc, time::Duration};

use bytes::{Buf, Bytes, BytesMut};
use mqtt_gate::packet::Qos;
use mqtt_gate::packet::connect::Connect;
use mqtt_gate::packet::write::{self, Welcome};
use mqtt_gate::{Broker, ClientConnection, CommandDecision, Ended, Epoch, Listener, Rights, Said, Scope, Session, Terms, Tier};

/// Lets everybody publish and share everything, and takes commands on one topic.
#[derive(Debug)]
struct Open;

impl Rights for Open {
    fn is_for_commands(&self, topic: &str) -> bool {
        topic == "site/robot/command"
    }

    fn may_publish(&self, _: Tier, _: &str) -> bool {
        true
    }

    fn may_share(&self, _: Tier, _: &str) -> bool {
        true
    }
}

/// Prints what it hears; a payload of `stop` is urgent.
struct Printer;

impl Listener for Printer {
    fn hear_urgent(&self, said: Said<'_>) -> bool {
        Open.is_for_commands(&String::from_utf8_lossy(said.topic)) && said.payload.starts_with(b"stop")
    }

    fn hear(&self, topic: &str, said: Said<'_>, _: Option<Epoch>, _: bool) -> CommandDecision {
        println!("command on {topic}: {}", said.payload.escape_ascii());
        CommandDecision::Pass
    }

    fn epoch(&self) -> Epoch {
        Epoch(0)
    }
}

fn main() -> Result<(), Ended> {
    let terms = Terms {
        tier: Tier::Full,
        scope: Scope::default(),
        name: "panel".into(),
        has_key: false,
        listener: Arc::new(Printer),
        connect: Connect::default(),
        session: Session::default(),
        greeting: Bytes::copy_from_slice(&write::connack(Welcome::Accepted, false)),
    };
    let mut connection = ClientConnection::new(terms, Arc::new(Broker::new(Open)), Duration::ZERO);

    let mut said = BytesMut::new();
    write::publish(&mut said, b"site/temperature", b"21.5", Qos::One, 1, true);
    write::subscribe(&mut said, 2, &[("site/#", Qos::One)]);
    write::publish(&mut said, b"site/robot/command", b"start", Qos::One, 3, false);
    connection.handle_client(&mut said, Duration::from_secs(1))?;

    // Its own message comes back to it, since it subscribes to all of `site`.
    connection.handle_come(Duration::from_secs(1));
    let waiting = connection.to_client().remaining();
    println!("to the client: {}", connection.to_client().copy_to_bytes(waiting).escape_ascii());
    Ok(())
}
