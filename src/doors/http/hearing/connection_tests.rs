//! Tests of one connection over pipes: when it ends, what it leaves for other connections, and that its STOP halts
//! the robot before it is evicted.

use std::net::Ipv4Addr;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use axum::Router;
use axum::extract::Request;
use axum::middleware::{Next, from_fn};
use futures_util::FutureExt;
use tokio::io::DuplexStream;
use tokio::net::TcpListener;
use tokio::runtime::Handle;
use tokio::task::JoinHandle;
use tokio::time::sleep;

use super::*;
use crate::api::tests::fixture::searching;
use crate::doors::connection_limits::{ConnectionBudget, ConnectionSlots, PendingConnections};
use crate::doors::http::guard::Hosts;
use crate::doors::http::router;
use crate::doors::http::testing::{TestApp, app};
use crate::runtime::tests::within::within;
use hallsweep_core::units::Epoch;

const LOOK: &str = "GET /healthz HTTP/1.1\r\nHost: localhost\r\n\r\n";
const STOP: &str = "POST /h HTTP/1.1\r\nHost: localhost\r\n\r\n";
const HERE: Ipv4Addr = Ipv4Addr::LOCALHOST;

fn context(app: &TestApp, slots: usize) -> ServerContext {
    let hosts = Hosts::new(true, &[]);
    ServerContext {
        router: router(&app.halls(), hosts.clone()),
        hosts,
        tls: None,
        slots: ConnectionSlots::new(slots, ConnectionBudget::default(), &app.door.process.access),
        pending: PendingConnections::new(8),
        lingering: PendingConnections::new(8),
        work: Handle::current(),
        closing: app.door.process.closing.subscribe(),
        halls: app.halls(),
    }
}

/// Returns a connection from this machine, the two pipes of its client, and the signal for its eviction.
fn connected(context: &Arc<ServerContext>) -> (Connection<DuplexStream, DuplexStream>, DuplexStream, DuplexStream, Arc<Notify>) {
    let ((says, from), (to, hears)) = (tokio::io::duplex(100_000), tokio::io::duplex(100_000));
    let cut = Arc::new(Notify::new());
    let waiting = context.pending.admit(HERE.into(), Arc::clone(&cut));
    let peer = Peer { address: HERE.into(), is_encrypted: false };
    (Connection::new(from, to, peer, waiting, Arc::clone(&cut), Arc::clone(context)), says, hears, cut)
}

/// Whether the task ends after this number of seconds: it still runs one second earlier, and has ended one second
/// later.
async fn lasts(hearing: &mut JoinHandle<()>, seconds: u64) -> bool {
    sleep(Duration::from_secs(seconds - 1)).await;
    let is_there = !hearing.is_finished();
    sleep(Duration::from_secs(2)).await;
    is_there && hearing.is_finished()
}

/// Safety A5.
#[tokio::test(start_paused = true)]
async fn a_first_head_that_does_not_come_is_waited_for_20_seconds() {
    let app = app(searching());
    let (connection, mut says, _hears, _) = connected(&Arc::new(context(&app, 8)));
    let mut hearing = tokio::spawn(connection.hear(BytesMut::new()));
    says.write_all(b"POST /h HTTP/1.1\r\nHost: loc").await.unwrap();
    assert!(lasts(&mut hearing, 20).await);
}

/// Safety A5, A6.
#[tokio::test(start_paused = true)]
async fn what_a_client_that_is_gone_has_sent_is_carried_out_for_two_seconds() {
    let app = app(searching());
    let is_done = Arc::new(AtomicBool::new(false));
    let done = Arc::clone(&is_done);
    let router = Router::new().layer(from_fn(move |request: Request, next: Next| {
        let done = Arc::clone(&done);
        async move {
            match request.uri().path() {
                "/slow" => {
                    sleep(Duration::from_secs(1)).await;
                    done.store(true, Ordering::SeqCst);
                }
                "/hangs" => std::future::pending().await,
                _ => {}
            }
            next.run(request).await
        }
    }));
    let (connection, mut says, hears, _) = connected(&Arc::new(ServerContext { router, ..context(&app, 8) }));
    for path in ["/", "/slow", "/hangs"] {
        says.write_all(format!("GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n").as_bytes()).await.unwrap();
    }
    drop((says, hears));
    let mut hearing = tokio::spawn(connection.hear(BytesMut::new()));
    assert!(lasts(&mut hearing, 2).await);
    assert!(is_done.load(Ordering::SeqCst));
}

/// Safety S8, S9.
#[tokio::test(start_paused = true)]
async fn who_gets_no_further_answer_has_no_slot_and_is_heard_for_five_seconds() {
    let app = app(searching());
    let context = Arc::new(context(&app, 8));
    let (connection, mut says, mut hears, _) = connected(&context);
    let mut hearing = tokio::spawn(connection.hear(BytesMut::new()));
    says.write_all(b"GET / HTTP/1.1\r\nno header\r\n\r\n").await.unwrap();
    let mut refused = String::new();
    hears.read_to_string(&mut refused).await.unwrap();
    assert!(refused.starts_with("HTTP/1.1 400"), "{refused}");
    let before = app.door.hall.handle.epoch();
    says.write_all(STOP.as_bytes()).await.unwrap();
    while app.door.hall.handle.epoch() == before {
        sleep(Duration::from_millis(1)).await;
    }
    assert_eq!((context.slots.held(), hearing.is_finished()), (0, false));
    assert!(lasts(&mut hearing, 5).await);
}

/// Safety S8: the word for STOP is escaped and comes after the first KiB. Only a search of the whole body finds it.
#[tokio::test(start_paused = true)]
async fn a_move_that_says_stop_halts_when_it_is_refused() {
    let app = app(searching());
    let (connection, mut says, _hears, _) = connected(&Arc::new(context(&app, 8)));
    let hearing = tokio::spawn(connection.hear(BytesMut::new()));
    let head = "POST /console/move HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n";
    let (beginning, end) = (format!(r#"{{"note":"{}"#, "z".repeat(1_100)), r#"","move":"\u0068"}"#);
    says.write_all(format!("{head}{:x}\r\n{beginning}\r\n", beginning.len()).as_bytes()).await.unwrap();
    // Waits until the bytes sent so far are read.
    sleep(Duration::from_millis(1)).await;
    let before = app.door.hall.handle.epoch();
    says.write_all(format!("{:x}\r\n{end}\r\n \r\n", end.len()).as_bytes()).await.unwrap();
    for _ in 0..1_000 {
        sleep(Duration::from_millis(1)).await;
    }
    assert_eq!((app.door.hall.handle.epoch() == before, hearing.is_finished()), (false, false));
}

/// Safety S9: connections that may be about to send STOP are evicted last.
#[tokio::test]
async fn a_system_without_descriptors_is_relieved_of_who_gets_no_answer_then_of_slots_then_of_newcomers() {
    let app = app(searching());
    let context = context(&app, 8);
    let cuts: [Arc<Notify>; 3] = Default::default();
    let _newcomer = context.pending.admit(HERE.into(), Arc::clone(&cuts[2]));
    let _slot = context.slots.take(SlotClaim::new(HERE.into(), None), false, Arc::clone(&cuts[1])).unwrap();
    let _lingering = context.lingering.admit(HERE.into(), Arc::clone(&cuts[0]));
    for number in 0..4 {
        assert_eq!(context.evict_some(), usize::from(number < 3));
        for (other, cut) in cuts.iter().enumerate() {
            assert_eq!(cut.notified().now_or_never().is_some(), other == number, "{number} {other}");
        }
    }
}

/// Returns the client's end of a connection over a real socket, and the task that serves it.
async fn accepted(context: &Arc<ServerContext>) -> (std::net::TcpStream, JoinHandle<()>) {
    let listener = TcpListener::bind((HERE, 0)).await.unwrap();
    let client = std::net::TcpStream::connect(listener.local_addr().unwrap()).unwrap();
    client.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    let (stream, address) = listener.accept().await.unwrap();
    (client, tokio::spawn(converse(stream, address, Arc::clone(context))))
}

/// Safety S9: bytes that the operating system has received are scanned before the eviction.
#[tokio::test]
async fn a_stop_that_has_come_halts_before_its_connection_gives_way() {
    use std::io::Write;
    let app = app(searching());
    let context = Arc::new(context(&app, 8));
    for number in 1..20 {
        let (mut client, hearing) = accepted(&context).await;
        // Half of the connections are pending, the other half are idle in a slot.
        if number % 2 == 0 {
            client.write_all(LOOK.as_bytes()).unwrap();
            while context.slots.held() == 0 {
                sleep(Duration::from_millis(1)).await;
            }
        } else {
            sleep(Duration::from_millis(1)).await;
        }
        client.write_all(STOP.as_bytes()).unwrap();
        assert_eq!(context.evict_some(), 1);
        within("it gives way", hearing).await.unwrap();
        assert_eq!(app.door.hall.handle.epoch(), Epoch(1 + number));
    }
}

/// Safety S9: an evicted connection does not cause the eviction of another one. Its STOP has halted the robot.
#[tokio::test]
async fn who_had_to_make_room_takes_no_slot() {
    let app = app(searching());
    let context = Arc::new(context(&app, 1));
    let cut = Arc::new(Notify::new());
    let other = context.slots.take(SlotClaim::new(HERE.into(), None), false, Arc::clone(&cut)).unwrap();
    let (connection, mut says, mut hears, _) = connected(&context);
    says.write_all(STOP.as_bytes()).await.unwrap();
    assert_eq!(context.pending.evict_some(), 1);
    let hearing = tokio::spawn(connection.hear(BytesMut::new()));
    drop(says);
    let mut refused = String::new();
    within("the refusal", hears.read_to_string(&mut refused)).await.unwrap();
    assert!(refused.contains("noPlace") && refused.contains("has halted"), "{refused}");
    within("its end", hearing).await.unwrap();
    assert_eq!((context.slots.held(), app.door.hall.handle.epoch()), (1, Epoch(2)));
    assert!(cut.notified().now_or_never().is_none());
    drop(other);
}

/// Safety S7.
#[tokio::test]
async fn others_have_their_turns_while_much_is_heard_of_one() {
    let app = app(searching());
    let (mut connection, _says, _hears, _) = connected(&Arc::new(context(&app, 8)));
    let turns = Arc::new(AtomicUsize::new(0));
    let others = tokio::spawn({
        let turns = Arc::clone(&turns);
        async move {
            loop {
                turns.fetch_add(1, Ordering::Relaxed);
                tokio::task::yield_now().await;
            }
        }
    });
    connection.read.extend_from_slice("GET / HTTP/1.1\n\n".repeat(10 * HEADS).as_bytes());
    connection.scan().await;
    assert!(turns.swap(0, Ordering::Relaxed) >= 10, "one after so many heads");
    connection.turn = TURN;
    connection.take_turns().await;
    assert!(turns.load(Ordering::Relaxed) >= 1 && connection.turn == 0, "and one after so many bytes");
    others.abort();
}

/// Safety S7, S9: the STOP of a new connection does not wait for the turns of earlier connections.
#[tokio::test]
async fn a_stop_that_a_newcomer_has_sent_already_halts_before_anything_is_waited_for() {
    let app = app(searching());
    let listener = TcpListener::bind((HERE, 0)).await.unwrap();
    let mut client = std::net::TcpStream::connect(listener.local_addr().unwrap()).unwrap();
    std::io::Write::write_all(&mut client, STOP.as_bytes()).unwrap();
    let (stream, address) = listener.accept().await.unwrap();
    let before = app.door.hall.handle.epoch();
    let mut conversation = Box::pin(converse(stream, address, Arc::new(context(&app, 8))));
    assert!(conversation.as_mut().now_or_never().is_none());
    assert!(app.door.hall.handle.epoch() > before);
}
