//! The accept loop with real sockets: how it ends, and which clients get a slot when there are too many clients.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpStream as Client};

use std::net::Shutdown;

use tokio::io::AsyncReadExt;
use tokio::net::TcpListener;
use tokio::sync::oneshot;
use tokio::task::JoinHandle;
use tokio::time::timeout;

use super::*;
use crate::access::Access;
use crate::api::tests::fixture::searching;
use crate::doors::http::Hall;
use crate::doors::http::testing::{TestApp, app, guarded_app, keys};
use crate::runtime::clock::Clock;
use crate::runtime::tests::within::within;
use hallsweep_core::command::Door;
use hallsweep_core::command::{Command, Issuer, Request};

/// Serves the door of this app until `shutdown`. Returns its address and its task.
async fn serve_until(
    app: &TestApp,
    slots: usize,
    shutdown: impl Future<Output = ()> + Send + 'static,
) -> (SocketAddr, JoinHandle<()>) {
    let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
    let address = listener.local_addr().unwrap();
    let halls = app.halls();
    let waiting = slots.min(WAITING);
    let serving =
        tokio::spawn(async move { serve_so_many(listener.into(), halls, Front::default(), slots, waiting, shutdown).await });
    (address, serving)
}

/// Serves this app until the test ends. Returns its address.
async fn served(app: &TestApp, slots: usize) -> SocketAddr {
    serve_until(app, slots, std::future::pending()).await.0
}

async fn open_app(slots: usize) -> (TestApp, SocketAddr) {
    let app = app(searching());
    let address = served(&app, slots).await;
    (app, address)
}

fn client(address: SocketAddr, begins: &str) -> Client {
    let mut client = Client::connect(address).unwrap();
    client.set_read_timeout(Some(Duration::from_secs(5))).unwrap();
    client.write_all(begins.as_bytes()).unwrap();
    client
}

/// Returns the beginning of the answer's first line. Empty if the connection was closed instead.
fn answered(client: &mut Client) -> String {
    let mut first = [0; 12];
    match client.read_exact(&mut first) {
        Ok(()) => String::from_utf8_lossy(&first).into_owned(),
        Err(_) => String::new(),
    }
}

fn is_closed(client: &mut Client) -> bool {
    matches!(client.read(&mut [0]), Ok(0))
        || client.read(&mut [0]).is_err_and(|error| error.kind() == std::io::ErrorKind::ConnectionReset)
}

/// Waits until `expect` STOPs have reached the loop. Fails if there are more.
async fn stops(app: &TestApp, expect: usize) {
    let count = || app.given.lock().unwrap().iter().filter(|given| given.command == Command::Stop).count();
    let come = async {
        while count() < expect {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    };
    timeout(Duration::from_secs(30), come).await.unwrap_or_else(|_| panic!("{} of {expect} STOPs came", count()));
    // Commands pass through the loop's queue in order. After this one, no earlier STOP is still in the queue.
    assert!(app.door.hall.handle.give(Request::new(Command::Reset, Issuer::operator(Door::LOCAL))).await.is_ok());
    assert_eq!(count(), expect, "one press is one STOP");
}

fn press(route: &str, headers: &str, body: &str) -> String {
    format!("POST {route} HTTP/1.1\r\nHost: localhost\r\n{headers}\r\n{body}")
}

const LOOK: &str = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
const WATCH: &str = "GET /api/v1/events HTTP/1.1\r\nHost: localhost\r\n\r\n";
const STOP: &str = "POST /api/v1/commands/stop HTTP/1.1\r\nHost: localhost\r\nContent-Length: 0\r\n\r\n";

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn the_end_comes_within_two_seconds_whatever_clients_do() {
    let app = app(searching());
    let (end, ended) = oneshot::channel::<()>();
    let (address, serving) = serve_until(&app, SLOTS, async { drop(ended.await) }).await;
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
    let (app, address) = open_app(8).await;
    let mut idle: Vec<Client> = (0..8).map(|_| client(address, "")).collect();
    idle.extend((0..8).map(|_| client(address, "POST /api/v1/commands/stop HTTP/1.1\r\nHost: loc")));
    assert_eq!(answered(&mut client(address, STOP)), "HTTP/1.1 200");
    assert_eq!(app.last().command, Command::Stop);
    assert!(is_closed(&mut idle[0]), "the oldest was cut");
}

/// Safety A5, S1.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn neither_do_connections_that_have_asked_and_rest() {
    let (_house, address) = open_app(8).await;
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
    let app = guarded_app(searching(), Access::Keys(keyring));
    let address = served(&app, 8).await;
    let asked = |token: &str| STOP.replace("Host", &format!("Authorization: Bearer {token}\r\nHost"));
    let _strangers: Vec<Client> = (0..20).map(|_| client(address, &asked("wrong"))).collect();
    assert_eq!(answered(&mut client(address, &asked(&tokens.viewer))), "HTTP/1.1 200");
    assert_eq!(app.given.lock().unwrap().len(), 1);
}

#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn whoever_is_let_in_and_looks_on_is_not_cut_for_a_newcomer() {
    let (app, address) = open_app(4).await;
    let mut watching: Vec<Client> = (0..4).map(|_| client(address, WATCH)).collect();
    for client in &mut watching {
        assert_eq!(answered(client), "HTTP/1.1 200");
    }
    let mut late = client(address, LOOK);
    assert_eq!(answered(&mut late), "HTTP/1.1 503", "there is no place left");
    late.write_all(STOP.as_bytes()).unwrap();
    stops(&app, 1).await;
    let refused = std::io::read_to_string(client(address, STOP)).expect("an answer in order");
    assert!(refused.starts_with("HTTP/1.1 503") && refused.contains("has halted the robot"), "{refused}");
    stops(&app, 2).await;
    drop(watching.pop());
    // The slot becomes free when the door notices that its client is gone.
    let mut tries = (0..500).map(|_| answered(&mut client(address, LOOK)));
    assert!(tries.any(|answer| answer == "HTTP/1.1 200"));
    for client in &mut watching {
        assert!(client.read(&mut [0; 64]).is_ok_and(|read| read > 0), "they look on");
    }
}

/// Safety S9.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn bodies_that_do_not_come_keep_no_stop_out() {
    let (app, address) = open_app(8).await;
    let half = "POST /api/v1/commands/goto HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\n{";
    let mut half_said = Vec::new();
    for number in 0..10 {
        half_said.extend((0..20).map(|_| client(address, half)));
        assert_eq!(answered(&mut client(address, STOP)), "HTTP/1.1 200", "{number}");
    }
    stops(&app, 10).await;
}

/// Safety A5.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn heads_longer_than_the_bound_are_refused_and_shorter_ones_are_not() {
    let (_house, address) = open_app(SLOTS).await;
    for (filler, status) in [(65_000, "200"), (66_000, "431"), (70_000, "431")] {
        let look = LOOK.replace("Host", &format!("X: {}\r\nHost", "x".repeat(filler)));
        assert_eq!(answered(&mut client(address, &look)), format!("HTTP/1.1 {status}"), "{filler}");
        // The second request of a connection has the same limit.
        assert_eq!(answered(&mut client(address, &format!("{LOOK}{look}"))), "HTTP/1.1 200");
    }
}

/// Safety S8: it does not matter why the request to change the protocol failed.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_stop_behind_an_upgrade_that_is_refused_and_over_halts() {
    let (app, address) = open_app(SLOTS).await;
    let upgrade = "GET /mqtt HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nno header\r\n\r\n";
    for number in 1..=20 {
        let mut client = client(address, upgrade);
        let refused = std::io::read_to_string(&mut client).expect("an answer in order");
        assert!(refused.starts_with("HTTP/1.1 400"), "{refused}");
        client.write_all(press("/h", "", "").as_bytes()).unwrap();
        stops(&app, number).await;
    }
}

/// Safety S8, S9: the bytes of such a connection are not HTTP, even if they look like it. The connection has no
/// slot, and is not evicted to make room.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn a_connection_that_was_handed_over_is_not_heard_here_and_takes_no_slot() {
    let mut app = app(searching());
    let (bring, mut brought) = tokio::sync::mpsc::channel(1);
    let hall = Hall::new(move |visitor| bring.try_send(visitor).expect("there is one"));
    Arc::make_mut(&mut app.door.process).mqtt = Some(hall);
    let address = served(&app, 1).await;
    let mut carried = client(
        address,
        "GET /mqtt HTTP/1.1\r\nHost: localhost\r\nConnection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: mqtt\r\n\r\n",
    );
    assert_eq!(answered(&mut carried), "HTTP/1.1 101");
    let mut visitor = within("whoever was brought", brought.recv()).await.unwrap();
    let stop = "POST /h HTTP/1.1\n\n";
    for _ in 0..3 {
        assert_eq!(answered(&mut client(address, LOOK)), "HTTP/1.1 200");
        // A mask of zeros is valid.
        carried.write_all(&[&[0x82, 0x80 | stop.len() as u8, 0, 0, 0, 0], stop.as_bytes()].concat()).unwrap();
        let mut said = vec![0; stop.len()];
        within("what it says", visitor.stream.read_exact(&mut said)).await.unwrap();
        assert_eq!(said, stop.as_bytes());
    }
    stops(&app, 0).await;
}

/// Safety A5, S9: only a limited number of connections without further answers is still read. If there are more, the
/// oldest is closed.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn whoever_lingers_makes_room_for_who_lingers_later() {
    let (app, address) = open_app(8).await;
    let mut lingering = Vec::new();
    for _ in 0..30 {
        let mut client = client(address, "GET / HTTP/1.1\r\nno header\r\n\r\n");
        std::io::read_to_string(&mut client).expect("an answer in order");
        lingering.push(client);
    }
    // A client gets its answer before its connection counts as lingering. The oldest connection is therefore closed a
    // moment later.
    let (mut heard, mut gone) = (lingering, Vec::new());
    while heard.len() > 8 {
        tokio::time::sleep(Duration::from_millis(1)).await;
        gone.extend(heard.extract_if(.., |client| client.write_all(b"\r\n").is_err()));
    }
    for client in &mut gone {
        // An error does not matter: the connection may be gone.
        let _ = client.write_all(press("/h", "", "").as_bytes());
    }
    heard.last_mut().expect("some are heard on").write_all(press("/h", "", "").as_bytes()).unwrap();
    stops(&app, 1).await;
}

/// Safety S9.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn an_operators_kept_connection_stays_whatever_strangers_and_viewers_send() {
    let (keyring, tokens) = keys();
    let app = guarded_app(searching(), Access::Keys(keyring));
    let address = served(&app, 8).await;
    let asks = |what: &str, token: &str| what.replace("Host", &format!("Authorization: Bearer {token}\r\nHost"));
    let mut kept = client(address, &asks(LOOK, &tokens.operator));
    assert_eq!(answered(&mut kept), "HTTP/1.1 200");
    let half = "POST /api/v1/commands/goto HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100\r\n\r\n{";
    let mut others = Vec::new();
    for _ in 0..30 {
        others.push(client(address, ""));
        others.push(client(address, "GET /api/v1/state HTTP/1.1\r\nHost: localhost\r\nX-Slow: x"));
        others.push(client(address, half));
        others.push(client(address, &asks(half, &tokens.viewer)));
        others.push(client(address, &asks(LOOK, &tokens.viewer)));
    }
    kept.write_all(asks(STOP, &tokens.operator).as_bytes()).unwrap();
    stops(&app, 1).await;
    let mut answers = Vec::new();
    while !String::from_utf8_lossy(&answers).contains("\"accepted\":true") {
        let mut bytes = [0; 1024];
        let read = kept.read(&mut bytes).unwrap();
        assert!(read > 0, "the connection was cut");
        answers.extend_from_slice(&bytes[..read]);
    }
}

/// Safety S1, R5.
#[tokio::test(flavor = "multi_thread", worker_threads = 2)]
async fn before_1970_it_is_said_that_the_clock_is_wrong_and_a_stop_halts_all_the_same() {
    let mut app = app(searching());
    Arc::make_mut(&mut app.door.process).clock = Clock::off_by(-(app.door.process.moment().unix_s + 3600) * 1000);
    let address = served(&app, SLOTS).await;
    for (asked, is_stop) in [(LOOK, false), (STOP, true)] {
        let answer = std::io::read_to_string(client(address, asked)).expect("an answer in order");
        assert!(answer.starts_with("HTTP/1.1 503") && answer.contains("noDate") && answer.contains("before 1970"), "{answer}");
        assert_eq!(answer.contains("has halted the robot"), is_stop, "{answer}");
    }
    stops(&app, 1).await;
}

#[path = "serve_stop_tests.rs"]
mod stop_tests;

/// Safety S7, S9, A7.
#[tokio::test]
async fn a_newcomer_is_heard_before_the_others_have_their_turn_and_a_mistake_ends_it_alone() {
    let mut connections = JoinSet::new();
    let (tell, mut told) = oneshot::channel();
    let newcomer = async move {
        let _ = tell.send(());
        std::future::pending().await
    };
    begin(&mut connections, newcomer).await;
    assert_eq!(told.try_recv(), Ok(()));
    begin(&mut connections, async { panic!("a mistake") }).await;
    begin(&mut connections, async {}).await;
    assert_eq!(connections.len(), 1, "the first goes on");
    assert!(connections.try_join_next().is_none());
}
