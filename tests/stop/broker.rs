//! The MQTT door of the app: the broker, and the session that publishes the answers.

use std::net::SocketAddr;
use std::sync::Arc;

use tokio::net::TcpListener;
use tokio::sync::{mpsc, watch};

use hallsweep::access::Access;
use hallsweep::doors::mqtt::commands::Commands;
use hallsweep::doors::mqtt::session::OwnSession;
use hallsweep::doors::mqtt::topics::Topics;
use hallsweep::doors::mqtt::{Clients, Ways, serve};
use hallsweep::runtime::archive_reader::ArchiveReader;
use hallsweep::runtime::handle::Handle;
use hallsweep::storage::sqlite::MemoryStore;
use mqtt_gate::Broker;

/// Opens the door on a free local port, until `closed` is set. Must be called inside a runtime.
pub(crate) async fn open(handle: Handle, closed: watch::Receiver<bool>) -> SocketAddr {
    let listener = TcpListener::bind("127.0.0.1:0").await.expect("this machine has a free port");
    let address = listener.local_addr().expect("a bound socket has an address");
    let topics = Topics::new("hallsweep", "discovery", "unibo/qak");
    let (answer, answers) = mpsc::channel(256);
    let broker = Arc::new(Broker::new(topics.clone()));
    let clients = Clients::new(Arc::clone(&broker), Commands::new(handle.clone(), topics.clone(), false, answer));
    let (_, web_clients) = mpsc::channel(1);
    let hearing = tokio::runtime::Handle::current();
    let ways = Ways { listeners: listener.into(), access: Access::Open, web_clients, hearing };
    let archive = ArchiveReader::new(MemoryStore::new().archive());
    let session = OwnSession::new(broker, topics, false, handle.watch(), answers, archive);
    let until = |mut closed: watch::Receiver<bool>| async move { drop(closed.wait_for(|closing| *closing).await) };
    tokio::spawn(session.run(until(closed.clone())));
    tokio::spawn(serve(clients, ways, until(closed)));
    address
}
