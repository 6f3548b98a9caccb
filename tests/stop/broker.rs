//! The MQTT door of the app: our own broker, and our session that publishes the answers.

use std::net::SocketAddr;

use tokio::net::TcpListener;
use tokio::sync::{mpsc, watch};

use hallsweep::access::{Access, Token};
use hallsweep::doors::mqtt::commands::Commands;
use hallsweep::doors::mqtt::session::{Health, Hearing, Link, Parts, Session, Times};
use hallsweep::doors::mqtt::topics::Topics;
use hallsweep::doors::mqtt::{Clients, Embedded, OWN_SESSION, Ways};
use hallsweep::runtime::archive_reader::Reader;
use hallsweep::runtime::handle::Handle;
use hallsweep::storage::sqlite::MemoryStore;
use mqtt_gate::Broker;

/// Opens the door on a free port of this machine; it ends when `closed` does. Must be called inside a runtime.
pub(crate) async fn open(handle: Handle, closed: watch::Receiver<bool>) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("this machine has a free port");
    let address = listener.local_addr().expect("a bound socket has an address");
    let topics = Topics::new("hallsweep", "discovery", "unibo/qak");
    let (answer, answers) = mpsc::channel(256);
    let (health, secret) = (watch::Sender::new(Health::Unproven), Token::draw().expect("the system gives chance"));
    let link = Link {
        host: address.ip().to_string(),
        port: address.port(),
        tls: None,
        login: Some((OWN_SESSION.to_owned(), secret.reveal().to_owned())),
        client_id: "hallsweep-discovery".to_owned(),
    };
    let commands = Commands::new(handle.clone(), topics.clone(), false, answer);
    let broker = Embedded::start(Clients::new(Broker::new(topics.clone()), commands, secret)).await.expect("a router starts");
    let (_, web_clients) = mpsc::channel(1);
    let hearing = tokio::runtime::Handle::current();
    let ways = Ways { listeners: listener.into(), access: Access::Open, web_clients, hearing, health: health.subscribe() };
    let session = Session::new(Parts {
        link,
        hearing: Hearing::Own,
        topics,
        home_assistant: false,
        states: handle.watch(),
        answers,
        archive: Reader::new(MemoryStore::new().archive()),
        health,
        seed: 1,
        times: Times::default(),
    });
    let until = |mut closed: watch::Receiver<bool>| async move { drop(closed.wait_for(|closing| *closing).await) };
    tokio::spawn(session.run(until(closed.clone())));
    tokio::spawn(broker.serve(ways, until(closed)));
    address
}
