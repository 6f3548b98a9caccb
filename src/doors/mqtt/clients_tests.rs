//! Tests of `clients`: what happens to a client before it is served.

use tokio::io::AsyncReadExt;
use tokio::sync::{mpsc, watch};

use super::*;
use crate::access::{Access, Caller, Key, Keyring, Keys, OPERATOR, Role, Token};
use crate::api::tests::fixture::idle;
use crate::doors::connection_limits::CONNECTIONS;
use crate::doors::mqtt::commands::Commands;
use crate::doors::mqtt::identity::Identity;
use crate::doors::mqtt::session::testing::topics;
use crate::runtime::tests::obedient::{Script, obedient};
use crate::runtime::tests::within::within;
use hallsweep_core::command::Command;
use mqtt_gate::packet::connect::{Credentials, NoConnect};

fn clients() -> (Clients, Script) {
    let (handle, script) = obedient(idle());
    let commands = Commands::new(handle, topics(), true, mpsc::channel(1).0);
    (Clients::new(Arc::new(Broker::new(topics())), commands), script)
}

fn from_here(access: Access) -> Origin {
    Origin { from: "127.0.0.1".parse().expect("an address"), caller: None, access }
}

/// Safety A5, S9: clients that wait for the same id take no more places than there are sessions.
#[tokio::test(start_paused = true)]
async fn whoever_waits_for_the_name_of_another_goes_when_his_seat_is_needed() {
    let (clients, _script) = clients();
    let (_runs, running) = watch::channel(());
    let origin = from_here(Access::Open);

    let mut hello = BytesMut::new();
    write::connect(&mut hello, "panel", false, 60, "anna", "x");
    let connect = connect::read(&hello[2..]).expect("it is one");
    let identity = Identity::of(&connect.credentials, &origin).expect("everybody is let in");
    let name = Name { who: identity.name(), client: "panel".to_owned() };
    let (mut hangs, _) = clients.0.ids.take(name, Memory { resumes: true, wants: true }).await;

    let (mut client, stream) = tokio::io::duplex(1024);
    let incoming = IncomingConnection::over(stream, origin);
    let waiting = clients.admit_pending(incoming.origin.from);
    let served = tokio::spawn(clients.clone().attend(incoming, waiting, running, Handle::current()));
    client.write_all(&hello).await.expect("it is taken");
    within("somebody of the same name", hangs.wanted()).await;
    let owner = identity.owner();
    let _newer: Vec<_> = (0..CONNECTIONS).map(|_| clients.0.sessions.take(owner.clone(), Duration::MAX)).collect();
    tokio::time::timeout(Duration::from_millis(100), served).await.expect("it waits no longer").expect("it ends in order");
    assert_eq!(client.read(&mut [0]).await.ok(), Some(0));
}

/// Sends these bytes as a new client. Returns how many STOPs reached the loop, and the answer.
async fn says(access: Access, bytes: &[u8]) -> (usize, Vec<u8>) {
    let (clients, script) = clients();
    let (_runs, running) = watch::channel(());
    let origin = from_here(access);
    let (mut client, stream) = tokio::io::duplex(64 * 1024);
    let waiting = clients.admit_pending(origin.from);
    let served = tokio::spawn(clients.attend(IncomingConnection::over(stream, origin), waiting, running, Handle::current()));
    // The bytes are sent in pieces, so that the CONNECT arrives before the rest.
    for piece in bytes.chunks(40) {
        // The program may have disconnected the client already, so errors are ignored.
        let _ = client.write_all(piece).await;
        tokio::task::yield_now().await;
    }
    let mut answer = Vec::new();
    within("the answer", client.read_to_end(&mut answer)).await.expect("it ends in order");
    drop(client);
    within("the end", served).await.expect("it ends in order");
    let given = script.given.lock().expect("nobody panicked");
    assert!(given.iter().all(|given| given.command == Command::Stop), "{given:?}");
    (given.len(), answer)
}

fn field(bytes: &[u8]) -> Vec<u8> {
    [&u16::try_from(bytes.len()).expect("it is short").to_be_bytes(), bytes].concat()
}

fn packet(first: u8, body: &[u8]) -> Vec<u8> {
    [&[first, u8::try_from(body.len()).ok().filter(|length| *length < 128).expect("it is short")], body].concat()
}

/// Builds a CONNECT packet from these fields. With level 5 it also asks for an unknown authentication method.
fn hello(protocol: &str, level: u8, flags: u8, name: &str, password: &str) -> Vec<u8> {
    let properties = if level == 5 { &[4, 0x15, 0, 1, b'S'][..] } else { &[] };
    let [protocol, name, password] = [protocol, name, password].map(|text| field(text.as_bytes()));
    packet(0x10, &[&protocol, &[level, flags, 0, 60][..], properties, &field(b"old"), &name, &password].concat())
}

const VERSION: [u8; 4] = [0x20, 2, 0, 1];
/// Safety S8: sender and command are known, so the STOP counts although the sender cannot be admitted.
#[tokio::test]
async fn a_stop_behind_a_connect_that_is_none_to_go_on_with_halts_where_everybody_may() {
    let stop = packet(0x30, &field(b"hallsweep/discovery/command/stop"));
    let word = |properties: &[u8]| packet(0x30, &[&field(b"hallsweep/discovery/command"), properties, b"stop"].concat());
    let told = NoConnect::Authentication.answer();
    for (hello, stop, answer) in [
        (hello("MQIsdp", 3, 0xC2, "anna", "x"), &stop, &VERSION[..]),
        (hello("MQIsdp", 3, 0xC2, "anna", "x"), &word(&[]), &VERSION),
        (hello("MQTT", 5, 0xC2, "anna", "x"), &stop, &told),
        (hello("MQTT", 5, 0xC2, "anna", "x"), &word(&[0]), &told),
        (hello("MQTT", 5, 0xC2, "anna", "x"), &word(&[2, 1, 1]), &told),
        (hello("MQTT", 9, 0xC2, "anna", "x"), &stop, &VERSION),
        (hello("HTTP", 4, 0xC2, "anna", "x"), &stop, &[]),
        (hello("MQTT", 4, 0xC3, "anna", "x"), &stop, &[]),
        (hello("MQTT", 4, 0x02, "anna", "x"), &stop, &[]),
        (packet(0x1F, b"?"), &stop, &[]),
        (Vec::new(), &stop, &[]),
    ] {
        let said = says(Access::Open, &[&hello[..], stop].concat()).await;
        assert_eq!(said, (1, answer.to_vec()), "{hello:?}");
    }
    assert_eq!(says(Access::Open, &hello("MQIsdp", 3, 0xC2, "anna", "x")).await, (0, VERSION.to_vec()));
}

/// Safety S8: without a valid key, a STOP never halts.
#[tokio::test(start_paused = true)]
async fn with_keys_a_stop_behind_such_a_connect_halts_for_whoever_shows_one() {
    let token = || Token::draw().expect("the system gives chance");
    let keys = [(OPERATOR, Role::Operator), ("wall", Role::Viewer)].map(|(name, role)| Key::new(name, role, token()).unwrap());
    let keyring = Keyring::of(Keys::new(Vec::from(keys)).unwrap()).unwrap();
    let shown = keyring.keys().named("wall").unwrap().token.reveal().to_owned();
    let access = Access::Keys(keyring);
    let stop = packet(0x30, &field(b"hallsweep/discovery/command/stop"));
    let told = NoConnect::Authentication.answer();
    for (protocol, level, flags, answer) in
        [("MQIsdp", 3, 0xC2, &VERSION[..]), ("MQTT", 5, 0xC2, &told), ("MQTT", 4, 0xC3, &[]), ("HTTP", 4, 0xC2, &[])]
    {
        for (name, password, halts) in [("wall", &*shown, 1), ("wall", "wrong", 0), (OPERATOR, &shown, 0), ("nobody", "", 0)] {
            let said = says(access.clone(), &[hello(protocol, level, flags, name, password), stop.clone()].concat()).await;
            assert_eq!(said, (halts, answer.to_vec()), "{protocol} {level} {flags:x} {name} {password}");
        }
    }
    let flagged = |password: &str| {
        let mut hello = hello("MQTT", 4, 0xC2, "wall", password);
        hello[0] = 0x1F;
        [hello, stop.clone()].concat()
    };
    assert_eq!(says(access.clone(), &flagged(&shown)).await, (1, Vec::new()));
    assert_eq!(says(access.clone(), &flagged("wrong")).await, (0, Vec::new()));
    for nobody in [&hello("MQTT", 5, 2, "", "")[..], &packet(0x1F, b"?"), &[]] {
        assert_eq!(says(access.clone(), &[nobody, &stop].concat()).await.0, 0);
    }
}

/// A client that wants to be remembered and cannot be is told so. Other clients get no such notice.
#[test]
fn a_client_of_mqtt_5_that_cannot_be_remembered_is_told_so() {
    let told = |session_expiry_s, is_remembered| {
        let credentials = Credentials { version: Version::Five, ..Credentials::default() };
        let connect = Connect { session_expiry_s, keep_alive_s: 60, credentials, ..Connect::default() };
        let known =
            IdentifiedClient { connect, has_new_id: false, identity: Identity(Caller::Here), origin: from_here(Access::Open) };
        let greeting = known.greeting(false, is_remembered);
        greeting.windows(5).any(|bytes| bytes == [0x11, 0, 0, 0, 0])
    };
    assert_eq!([told(60, false), told(60, true), told(0, false)], [true, false, false]);
}

/// Safety A5: clients that wait for the answer to a wrong password take at most `WAITING` places.
#[tokio::test(start_paused = true)]
async fn whoever_waits_for_the_answer_to_a_wrong_password_makes_room_for_newer_ones() {
    let key = Key::new(OPERATOR, Role::Operator, Token::draw().expect("the system gives chance")).unwrap();
    let access = Access::Keys(Keyring::of(Keys::new(vec![key]).unwrap()).unwrap());
    for (protocol, level, flags) in [("MQTT", 4, 0xC2), ("MQTT", 4, 0xC3), ("MQTT", 5, 0xC2)] {
        let (clients, _script) = clients();
        let (_runs, running) = watch::channel(());
        let mut crowd = Vec::new();
        for _ in 0..WAITING + LEAVING + 100 {
            let (mut client, stream) = tokio::io::duplex(1024);
            client.write_all(&hello(protocol, level, flags, OPERATOR, "wrong")).await.expect("it is taken");
            let origin = from_here(access.clone());
            let waiting = clients.admit_pending(origin.from);
            let incoming = IncomingConnection::over(stream, origin);
            crowd.push((client, tokio::spawn(clients.clone().attend(incoming, waiting, running.clone(), Handle::current()))));
        }
        let there = || crowd.iter().filter(|(_, served)| !served.is_finished()).count();
        tokio::time::sleep(Duration::from_millis(1)).await;
        assert_eq!(there(), WAITING, "{protocol} {level} {flags:x}");
        tokio::time::sleep(CONNECT_TIME).await;
        assert_eq!(there(), 0, "{protocol} {level} {flags:x}");
    }
}

/// Safety S7: most clients send STOP only after the greeting. A client that resumes a session is greeted later, but
/// its STOP halts too.
#[tokio::test]
async fn a_newcomer_is_greeted_and_heard_though_nothing_else_is_done() {
    let (clients, script) = clients();
    let (_runs, running) = watch::channel(());
    // The other work is given to a runtime that never runs.
    let idle = tokio::runtime::Builder::new_current_thread().build().expect("the system gives one");
    for (flags, is_greeted) in [(0xC2, true), (0xC0, false)] {
        let origin = from_here(Access::Open);
        let (mut client, stream) = tokio::io::duplex(1024);
        let waiting = clients.admit_pending(origin.from);
        let served =
            clients.clone().attend(IncomingConnection::over(stream, origin), waiting, running.clone(), idle.handle().clone());
        let served = tokio::spawn(served);
        client.write_all(&hello("MQTT", 4, flags, "anna", "x")).await.expect("it is taken");
        let mut greeting = [0; 4];
        if is_greeted {
            within("the greeting", client.read_exact(&mut greeting)).await.expect("it comes");
            assert_eq!(greeting, write::connack(Welcome::Accepted, false));
        }
        client.write_all(&packet(0x30, &field(b"hallsweep/discovery/command/stop"))).await.expect("it is taken");
        let stops = || script.given.lock().expect("nobody panicked").len();
        let expect = stops() + 1;
        within("the STOP", async {
            while stops() < expect {
                tokio::task::yield_now().await;
            }
        })
        .await;
        let is_told_more = tokio::time::timeout(Duration::ZERO, client.read(&mut greeting)).await.is_ok();
        assert!(!is_told_more, "what is remembered of it is looked up elsewhere, and nobody is greeted twice");
        served.abort();
    }
    idle.shutdown_background();
}
