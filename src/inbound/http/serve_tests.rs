//! The accept loop with real sockets: its end, and who gets a place when there are more clients than places.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream as Client};

use tokio::net::TcpListener;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tokio::time::timeout;

use super::*;
use crate::access::Access;
use crate::core::command::Command;
use crate::inbound::http::testing::{House, guarded_house, house, keys};
use crate::wire::fixture::searching;

/// A door that is served until it is told to end.
struct Served {
    address: SocketAddr,
    end: oneshot::Sender<()>,
    serving: JoinHandle<()>,
}

async fn served(house: &House, places: usize) -> Served {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let (end, ended) = oneshot::channel::<()>();
    let door = house.door.clone();
    let serving = tokio::spawn(async move {
        serve_so_many(listener.into(), door, Front::default(), &Places::new(places), async { drop(ended.await) }).await;
    });
    Served { address, end, serving }
}

fn client(address: SocketAddr, begins: &str) -> Client {
    let mut client = Client::connect(address).unwrap();
    client.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    client.write_all(begins.as_bytes()).unwrap();
    client
}

/// The first line of the answer; empty when the connection was closed instead.
fn answered(client: &mut Client) -> String {
    let mut first = [0; 12];
    match client.read_exact(&mut first) {
        Ok(()) => String::from_utf8_lossy(&first).into_owned(),
        Err(_) => String::new(),
    }
}

/// Whether the other end has hung up.
fn is_closed(client: &mut Client) -> bool {
    matches!(client.read(&mut [0]), Ok(0))
        || client.read(&mut [0]).is_err_and(|error| error.kind() == std::io::ErrorKind::ConnectionReset)
}

const LOOK: &str = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
const WATCH: &str = "GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n";
const STOP: &str = "POST /api/v1/commands/stop HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n";

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_end_comes_within_two_seconds_whatever_clients_do() {
    let house = house(searching());
    let Served { address, end, serving } = served(&house, PLACES).await;
    let _slow = client(address, "GET /api/v1/state HTTP/1.1\r\nHost: localhost\r\nX-Slow: ");
    let _half = client(address, "POST /api/v1/commands/move HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\n{");
    let mut watching = client(address, WATCH);
    assert_eq!(answered(&mut watching), "HTTP/1.1 200");

    end.send(()).unwrap();
    timeout(Duration::from_secs(2), serving).await.expect("it ends within two seconds").unwrap();
    watching.read_to_end(&mut Vec::new()).expect("the stream was closed, and in order");
}

/// Safety A5, S1.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn connections_that_ask_nothing_keep_no_stop_waiting() {
    let house = house(searching());
    let Served { address, end: _end, serving: _serving } = served(&house, 8).await;
    let mut idle: Vec<Client> = (0..8).map(|_| client(address, "")).collect();
    idle.extend((0..8).map(|_| client(address, "POST /api/v1/commands/stop HTTP/1.1\r\nHost: loc")));
    assert_eq!(answered(&mut client(address, STOP)), "HTTP/1.1 200");
    assert_eq!(house.last().command, Command::Stop);
    assert!(is_closed(&mut idle[0]), "the oldest was cut");
}

/// Safety A5, S1.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn neither_do_connections_that_have_asked_and_rest() {
    let house = house(searching());
    let Served { address, end: _end, serving: _serving } = served(&house, 8).await;
    let mut resting: Vec<Client> = (0..8).map(|_| client(address, LOOK)).collect();
    for client in &mut resting {
        assert_eq!(answered(client), "HTTP/1.1 200");
    }
    assert_eq!(answered(&mut client(address, STOP)), "HTTP/1.1 200");
}

/// Safety A5, S1, A3.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn nor_do_strangers_whose_refusal_is_held_back() {
    let (keyring, tokens) = keys();
    let house = guarded_house(searching(), Access::Keys(keyring));
    let Served { address, end: _end, serving: _serving } = served(&house, 8).await;
    let asked = |token: &str| STOP.replace("Host", &format!("Authorization: Bearer {token}\r\nHost"));
    let _strangers: Vec<Client> = (0..20).map(|_| client(address, &asked("wrong"))).collect();
    assert_eq!(answered(&mut client(address, &asked(&tokens.viewer))), "HTTP/1.1 200");
    assert_eq!(house.given.lock().unwrap().len(), 1);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn whoever_is_let_in_and_looks_on_is_not_cut_for_a_newcomer() {
    let house = house(searching());
    let Served { address, end: _end, serving: _serving } = served(&house, 4).await;
    let mut watching: Vec<Client> = (0..4).map(|_| client(address, WATCH)).collect();
    for client in &mut watching {
        assert_eq!(answered(client), "HTTP/1.1 200");
    }
    assert_eq!(answered(&mut client(address, LOOK)), "", "there is no place left");
    drop(watching.pop());
    // The place is free as soon as the door has seen that its client is gone.
    let mut tries = (0..500).map(|_| answered(&mut client(address, LOOK)));
    assert!(tries.any(|answer| answer == "HTTP/1.1 200"));
    for client in &mut watching {
        assert!(client.read(&mut [0; 64]).is_ok_and(|read| read > 0), "they look on");
    }
}
