//! For `embedded`: routers that are ended by what is known to end them, from the inside, where no gate stands in between.

use std::collections::HashSet;

use rumqttc::{Connect, ConnectReturnCode, Login, Packet};
use socket2::SockRef;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::net::TcpListener;
use tokio::sync::oneshot;

use super::*;
use crate::access::Token;
use crate::api::fixture::{idle, touch};
use crate::doors::mqtt::commands::Commands;
use crate::doors::mqtt::identity::OWN_SESSION;
use crate::doors::mqtt::session::testing::{Album, Peer, publish, topics};
use crate::doors::mqtt::session::{Hearing, Link, Parts, Session, Times};
use crate::runtime::archive_reader::Reader;
use crate::runtime::obedient::{Script, obedient};
use crate::runtime::within::within;
use hallsweep_core::command::Command;
use hallsweep_core::world::resource::Resource;
use hallsweep_core::world::snapshot::Snapshot;
use mqtt_gate::limits::{FILTERS, ROUTER_FILTERS};

/// A broker with our own session at it.
struct TestBroker {
    address: SocketAddr,
    router: watch::Receiver<Arc<Router>>,
    health: watch::Sender<Health>,
    script: Script,
    _shutdown: oneshot::Sender<()>,
}

impl TestBroker {
    async fn start() -> TestBroker {
        TestBroker::before(None).await
    }

    /// A broker before this router, or one of its own.
    async fn before(other: Option<Router>) -> TestBroker {
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("there is a free port");
        let address = listener.local_addr().expect("it is bound");
        let (handle, script) = obedient(idle());
        let (give, answers) = mpsc::channel(16);
        let (told, secret) = (watch::Sender::new(Health::Unproven), Token::draw().expect("the system gives chance"));
        let link = Link {
            host: address.ip().to_string(),
            port: address.port(),
            tls: None,
            login: Some((OWN_SESSION.to_owned(), secret.reveal().to_owned())),
            client_id: "hallsweep-discovery".to_owned(),
        };
        let clients = Clients::new(mqtt_gate::Broker::new(topics()), Commands::new(handle, topics(), true, give), secret);
        let embedded = Embedded::start(clients).await.expect("it starts");
        let router = embedded.router.subscribe();
        if let Some(other) = other {
            embedded.router.send_replace(Arc::new(other));
        }
        let (_, web_clients) = mpsc::channel(1);
        let ways = Ways {
            listeners: listener.into(),
            access: Access::Open,
            web_clients,
            hearing: Handle::current(),
            health: told.subscribe(),
        };
        let (shutdown, ended) = oneshot::channel();
        let session = Session::new(Parts {
            link,
            hearing: Hearing::Own,
            topics: topics(),
            home_assistant: true,
            states: script.publish.subscribe(),
            answers,
            archive: Reader::new(Arc::new(Album)),
            health: told.clone(),
            seed: 1,
            times: Times::default(),
        });
        tokio::spawn(session.run(std::future::pending()));
        tokio::spawn(embedded.serve(ways, async { drop(ended.await) }));
        TestBroker { address, router, health: told, script, _shutdown: shutdown }
    }

    /// A client that gets in, sooner or later.
    async fn client(&self) -> Peer {
        self.client_named("client").await
    }

    async fn client_named(&self, id: &str) -> Peer {
        within("a place", async {
            loop {
                let mut peer = Peer::come(self.address).await;
                if peer.introduces(connect(id, None)).await == Some(ConnectReturnCode::Success) {
                    return peer;
                }
                // It is only just being started anew.
                tokio::time::sleep(Duration::from_millis(20)).await;
            }
        })
        .await
    }

    /// What a newcomer is told; `None`: nothing.
    async fn knock(&self) -> Option<ConnectReturnCode> {
        Peer::come(self.address).await.introduces(connect("newcomer", None)).await
    }

    /// So many STOPs have come to the loop.
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

    /// One who has come past the gate.
    async fn burglar(&self, id: &str) -> Peer {
        let (address, login) = {
            let router = self.router.borrow();
            (router.address, router.login().1.to_owned())
        };
        let mut peer = Peer::come(address).await;
        peer.introduces(connect(id, Some(Login::new("gate", login)))).await;
        peer
    }

    /// The router is started anew, and everything is as it was: whoever comes again finds every state, and hears of the next change.
    async fn is_whole_again(&mut self) {
        within("another router", self.router.changed()).await.expect("it runs");
        let mut client = self.client().await;
        client.asks_for(["hallsweep/#"]).await;
        let mut wanted: HashSet<String> = Resource::ALL.map(|resource| topics().state(resource)).into();
        while !wanted.is_empty() {
            // Kept by the gate, or said just now by our own session, which has come again too.
            let said = client.hears_message().await;
            wanted.remove(&said.topic);
        }
        let mut newer = Snapshot::clone(&self.script.publish.borrow());
        let next = newer.revision.0 + 1;
        touch(&mut newer, next, &[Resource::Robot]);
        let revision = format!("\"revision\":{next}");
        self.script.publish.send_replace(newer.into());
        loop {
            let said = client.hears_message().await;
            if said.topic == topics().state(Resource::Robot) && String::from_utf8_lossy(&said.payload).contains(&revision) {
                break;
            }
        }
    }
}

fn connect(id: &str, login: Option<Login>) -> Packet {
    let mut connect = Connect::new(id);
    connect.login = login;
    Packet::Connect(connect)
}

/// The router panics when a topic does not begin with an ASCII character.
#[tokio::test]
async fn a_router_that_has_ended_is_started_anew() {
    let mut broker = TestBroker::start().await;
    let mut client = broker.client().await;
    let mut burglar = broker.burglar("burglar").await;
    burglar.asks_for(["any"]).await;
    burglar.says(Packet::Publish(publish("ü", "", 1))).await;
    client.is_left().await;
    broker.is_whole_again().await;
}

/// A client id with a wildcard, twice, poisons a lock, after which the router lets nobody in and serves whoever is there.
#[tokio::test]
async fn a_router_that_lets_nobody_in_is_started_anew() {
    let mut broker = TestBroker::start().await;
    let mut client = broker.client().await;
    for _ in 0..2 {
        broker.burglar("a+").await;
    }
    // The gate does not wait for the router to welcome somebody, and learns behind him how that is.
    assert_eq!(broker.knock().await, Some(ConnectReturnCode::Success));
    client.is_left().await;
    broker.is_whole_again().await;
}

/// Safety S1, S7: nothing that a client says first waits for the router, its STOP least of all.
#[tokio::test]
async fn a_first_stop_halts_although_the_router_hangs() {
    let hangs = TcpListener::bind("127.0.0.1:0").await.expect("there is a free port");
    let broker = TestBroker::before(Some(Router::hanging(hangs.local_addr().expect("it is bound")))).await;
    let stop = || Packet::Publish(publish("hallsweep/discovery/command/stop", "", 1));
    let mut patient = Peer::come(broker.address).await;
    assert_eq!(patient.introduces(connect("patient", None)).await, Some(ConnectReturnCode::Success));
    patient.says(stop()).await;
    broker.halts(1).await;
    let mut hasty = Peer::come(broker.address).await;
    hasty.says(connect("hasty", None)).await;
    hasty.says(stop()).await;
    broker.halts(2).await;
    drop(hangs);
}

/// What is acknowledged is passed on, though whoever said it left before there was a way to the router for it.
#[tokio::test]
async fn what_a_client_says_that_leaves_at_once_reaches_those_who_read_it() {
    let broker = TestBroker::start().await;
    let mut reader = broker.client_named("reader").await;
    reader.asks_for(["said/#"]).await;
    for n in 0..50 {
        let mut hasty = Peer::come(broker.address).await;
        hasty.says(connect("hasty", None)).await;
        hasty.says(Packet::Publish(publish(&format!("said/{n}"), "", 1))).await;
        hasty.says(Packet::Disconnect).await;
        drop(hasty);
        assert_eq!(reader.hears_message().await.topic, format!("said/{n}"));
    }
}

/// Safety S8: who asks is known, and what is asked; that the rest of the CONNECT is refused comes second.
#[tokio::test]
async fn a_stop_behind_a_connect_that_is_refused_halts() {
    let broker = TestBroker::start().await;
    let mut refused = Peer::come(broker.address).await;
    refused.says(connect(&"x".repeat(257), None)).await;
    refused.says(Packet::Publish(publish("hallsweep/discovery/command/stop", "", 1))).await;
    broker.halts(1).await;
}

/// Safety A5.
#[tokio::test]
async fn a_router_that_was_shown_more_than_it_can_remember_is_started_anew() {
    let mut broker = TestBroker::start().await;
    let mut holders = Vec::new();
    for n in 0..=ROUTER_FILTERS / FILTERS {
        let mut holder = broker.client_named(&n.to_string()).await;
        let filters: Vec<String> = (0..FILTERS).map(|filter| format!("{n}/{filter}")).collect();
        holder.asks_for(filters.iter().map(String::as_str)).await;
        holders.push(holder);
    }
    for holder in &mut holders {
        holder.is_left().await;
    }
    broker.is_whole_again().await;
}

/// What our own session finds is believed, though the router seems to run.
#[tokio::test]
async fn a_router_that_is_called_ill_is_started_anew() {
    let mut broker = TestBroker::start().await;
    let mut client = broker.client().await;
    // Its own echoes pass: it is not believed at once.
    let calls = async {
        loop {
            broker.health.send_replace(Health::Ill);
            tokio::task::yield_now().await;
        }
    };
    tokio::select! {
        () = client.is_left() => {}
        () = calls => {}
    }
    broker.is_whole_again().await;
}

/// Safety S9: as when the system has no more descriptors.
#[tokio::test]
async fn a_port_that_lets_nobody_in_keeps_no_web_client_waiting() {
    let port = TcpListener::bind("127.0.0.1:0").await.expect("there is a free port");
    SockRef::from(&port).shutdown(std::net::Shutdown::Both).expect("it lets nobody in any more");
    let mut listeners = Listeners::from(port);
    assert!(listeners.accept().await.is_err());
    let secret = Token::draw().expect("the system gives chance");
    let clients = Clients::new(
        mqtt_gate::Broker::new(topics()),
        Commands::new(obedient(idle()).0, topics(), true, mpsc::channel(1).0),
        secret,
    );
    let (_routers, router) = watch::channel(Arc::new(Router::hanging("127.0.0.1:9".parse().expect("an address"))));
    let (come, web_clients) = mpsc::channel(1);
    tokio::spawn(Reception { clients, access: Access::Open, router, work: Handle::current() }.receive(listeners, web_clients));
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
