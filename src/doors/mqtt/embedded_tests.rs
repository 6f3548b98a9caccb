//! Tests of `embedded`: clients at our own broker, and the messages that the program publishes there.

use std::collections::HashSet;
use std::sync::Arc;

use rumqttc::{Connect, ConnectReturnCode, Packet};
use socket2::SockRef;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpListener;
use tokio::sync::oneshot;

use super::*;
use crate::api::tests::fixture::{idle, touch};
use crate::doors::mqtt::commands::Commands;
use crate::doors::mqtt::home_assistant::BIRTH;
use crate::doors::mqtt::session::OwnSession;
use crate::doors::mqtt::session::testing::{Album, Peer, publish, topics};
use crate::doors::mqtt::topics::HOME_ASSISTANT_STATUS;
use crate::runtime::archive_reader::ArchiveReader;
use crate::runtime::tests::obedient::{Script, obedient};
use crate::runtime::tests::within::within;
use hallsweep_core::command::Command;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::world::resource::Resource;
use mqtt_gate::Broker;

struct TestBroker {
    address: SocketAddr,
    script: Script,
    shutdown: Option<oneshot::Sender<()>>,
}

impl TestBroker {
    async fn start() -> TestBroker {
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("there is a free port");
        let address = listener.local_addr().expect("it is bound");
        let (handle, script) = obedient(idle());
        let (give, answers) = mpsc::channel(16);
        let broker = Arc::new(Broker::new(topics()));
        let clients = Clients::new(Arc::clone(&broker), Commands::new(handle, topics(), true, give));
        let (_, web_clients) = mpsc::channel(1);
        let ways = Ways { listeners: listener.into(), access: Access::Open, web_clients, hearing: Handle::current() };
        let (shutdown, ended) = oneshot::channel::<()>();
        let archive = ArchiveReader::new(Arc::new(Album));
        let session = OwnSession::new(broker, topics(), true, script.publish.subscribe(), answers, archive);
        let session = session.run(async { drop(ended.await) });
        tokio::spawn(serve(clients, ways, session));
        TestBroker { address, script, shutdown: Some(shutdown) }
    }

    async fn client(&self, id: &str) -> Peer {
        let mut peer = Peer::come(self.address).await;
        assert_eq!(peer.introduces(Packet::Connect(Connect::new(id))).await, Some(ConnectReturnCode::Success));
        peer
    }

    /// Waits until this many STOPs have reached the loop.
    async fn halts(&self, so_many: usize) {
        let given =
            || self.script.given.lock().expect("nobody panicked").iter().filter(|given| given.command == Command::Stop).count();
        within("the stops", async {
            while given() < so_many {
                tokio::task::yield_now().await;
            }
        })
        .await;
    }
}

#[tokio::test]
async fn whoever_subscribes_finds_every_state_and_hears_of_the_next_change_and_of_the_end() {
    let mut broker = TestBroker::start().await;
    let mut client = broker.client("client").await;
    client.asks_for(["hallsweep/#"]).await;
    let mut wanted: HashSet<String> = Resource::ALL.map(|resource| topics().state(resource)).into();
    while !wanted.is_empty() {
        wanted.remove(&client.hears_message().await.topic);
    }
    let mut newer = Snapshot::clone(&broker.script.publish.borrow());
    let next = newer.revision.0 + 1;
    touch(&mut newer, next, &[Resource::Robot]);
    broker.script.publish.send_replace(newer.into());
    let revision = format!("\"revision\":{next}");
    loop {
        let said = client.hears_message().await;
        if said.topic == topics().state(Resource::Robot) && String::from_utf8_lossy(&said.payload).contains(&revision) {
            break;
        }
    }
    drop(broker.shutdown.take());
    loop {
        let said = client.hears_message().await;
        if said.topic == topics().availability() && &said.payload[..] == b"offline" {
            break;
        }
    }
    client.is_left().await;
}

#[tokio::test]
async fn home_assistant_is_told_of_the_robot_again_when_it_has_started() {
    let broker = TestBroker::start().await;
    let mut client = broker.client("home-assistant").await;
    client.asks_for([topics().discovery().as_str()]).await;
    assert!(client.hears_message().await.payload.starts_with(b"{"));
    client.says(Packet::Publish(publish(HOME_ASSISTANT_STATUS, std::str::from_utf8(BIRTH).expect("text"), 1))).await;
    assert!(client.hears_message().await.payload.starts_with(b"{"));
}

/// The messages of a client reach their readers, even when the client leaves at once.
#[tokio::test]
async fn what_a_client_says_that_leaves_at_once_reaches_those_who_read_it() {
    let broker = TestBroker::start().await;
    let mut reader = broker.client("reader").await;
    reader.asks_for(["said/#"]).await;
    for n in 0..50 {
        let mut hasty = Peer::come(broker.address).await;
        hasty.says(Packet::Connect(Connect::new("hasty"))).await;
        hasty.says(Packet::Publish(publish(&format!("said/{n}"), "", 1))).await;
        hasty.says(Packet::Disconnect).await;
        drop(hasty);
        assert_eq!(reader.hears_message().await.topic, format!("said/{n}"));
    }
}

/// Safety S8: sender and command are known, so the STOP counts although the CONNECT is refused.
#[tokio::test]
async fn a_stop_behind_a_connect_that_is_refused_halts() {
    let broker = TestBroker::start().await;
    let mut refused = Peer::come(broker.address).await;
    refused.says(Packet::Connect(Connect::new("x".repeat(257)))).await;
    refused.says(Packet::Publish(publish("hallsweep/discovery/command/stop", "", 1))).await;
    broker.halts(1).await;
}

/// Safety S9: a port that cannot accept connections does not block web clients. The system may have no more
/// descriptors, for example.
#[tokio::test]
async fn a_port_that_lets_nobody_in_keeps_no_web_client_waiting() {
    let port = TcpListener::bind("127.0.0.1:0").await.expect("there is a free port");
    SockRef::from(&port).shutdown(std::net::Shutdown::Both).expect("it lets nobody in any more");
    let mut listeners = Listeners::from(port);
    assert!(listeners.accept().await.is_err());
    let commands = Commands::new(obedient(idle()).0, topics(), true, mpsc::channel(1).0);
    let clients = Clients::new(Arc::new(Broker::new(topics())), commands);
    let (_runs, running) = watch::channel(());
    let (come, web_clients) = mpsc::channel(1);
    tokio::spawn(Reception { clients, access: Access::Open, running, work: Handle::current() }.receive(listeners, web_clients));
    for _ in 0..3 {
        let (mut client, stream) = tokio::io::duplex(1024);
        let origin = Origin { from: "127.0.0.1".parse().expect("an address"), caller: None, access: Access::Open };
        assert!(come.send(IncomingConnection::over(stream, origin)).await.is_ok(), "somebody receives web clients");
        client.write_all(b"\x10\x0d\0\x04MQTT\x04\x02\0\x3c\0\x01a").await.expect("it is taken");
        let mut greeting = [0; 4];
        within("the greeting", client.read_exact(&mut greeting)).await.expect("it comes");
        assert_eq!(greeting, [0x20, 2, 0, 0]);
    }
}
