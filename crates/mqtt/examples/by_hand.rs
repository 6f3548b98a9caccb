//! A client's bytes through a connection, by hand: what is heard as a command, what reaches the router, and what the client is
//! answered. A program does the same between two sockets.
#![expect(clippy::print_stdout, reason = "an example shows what comes out")]

use std::{sync::Arc, time::Duration};

use bytes::{Buf, BytesMut};
use mqtt_gate::packet::{Qos, write};
use mqtt_gate::{Broker, ClientConnection, CommandDecision, Ended, Epoch, Listener, Principal, Rights, Session, Terms, Tier};

/// Everybody may do everything, and commands are taken on one topic.
#[derive(Debug)]
struct Open;

impl Rights for Open {
    fn is_for_commands(&self, topic: &str) -> bool {
        topic == "site/robot/command"
    }

    fn may_publish(&self, _: Principal, _: &str) -> bool {
        true
    }

    fn may_subscribe(&self, _: Principal, _: &str) -> bool {
        true
    }
}

/// Prints what it hears; `stop` is urgent.
struct Printer;

impl Listener for Printer {
    fn hear_urgent(&self, topic: &[u8], payload: &[u8]) -> bool {
        Open.is_for_commands(&String::from_utf8_lossy(topic)) && payload.starts_with(b"stop")
    }

    fn hear(&self, topic: &str, payload: &[u8], _: (Option<Epoch>, bool)) -> CommandDecision {
        println!("command on {topic}: {}", payload.escape_ascii());
        CommandDecision::Pass
    }

    fn epoch(&self) -> Epoch {
        Epoch(0)
    }
}

fn main() -> Result<(), Ended> {
    let (principal, listener, session) = (Principal::Client(Tier::Full), Arc::new(Printer), Session::default());
    let terms = Terms { principal, name: "panel".into(), has_key: false, listener, keep_alive_s: 60, will: None, session };
    let mut connection = ClientConnection::new(terms, Arc::new(Broker::new(Open)), Duration::ZERO);

    let mut said = BytesMut::new();
    write::publish(&mut said, b"site/temperature", b"21.5", Qos::One, 1, true);
    write::subscribe(&mut said, 2, &[("site/#", Qos::One)]);
    write::publish(&mut said, b"site/robot/command", b"start", Qos::One, 3, false);
    connection.handle_client(&mut said, Duration::from_secs(1))?;
    println!("to the router: {}", connection.to_router().split().escape_ascii());

    // The router answers the SUBSCRIBE; only then the client gets the kept message.
    let mut answer = BytesMut::new();
    write::suback(&mut answer, 2, &[Qos::One as u8]);
    connection.handle_router(&mut answer)?;
    let waiting = connection.to_client().remaining();
    println!("to the client: {}", connection.to_client().copy_to_bytes(waiting).escape_ascii());
    Ok(())
}
