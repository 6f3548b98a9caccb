//! Tests of `hearing`: a STOP halts whatever else is wrong with it. All input is passed on.

use bytes::BytesMut;
use proptest::prelude::*;
use tokio::io::AsyncWriteExt;
use tokio::sync::mpsc;

use super::*;
use crate::access::{Caller, Key, Keyring, Keys, OPERATOR, Role, Token};
use crate::api::tests::fixture::searching;
use crate::doors::mqtt::commands::Commands;
use crate::doors::mqtt::identity::Identity;
use crate::doors::mqtt::read_ahead::{Pool, Taker, read_ahead};
use crate::doors::mqtt::topics::Topics;
use crate::runtime::tests::obedient::{Script, obedient};
use crate::runtime::tests::within::within;
use hallsweep_core::command::Command;
use mqtt_gate::packet::{Qos, write};

struct Scene {
    hearing: Hearing,
    taker: Taker,
    script: Script,
}

fn viewer() -> Caller {
    let token = || Token::draw().expect("the system gives chance");
    let keys = [(OPERATOR, Role::Operator), ("wall", Role::Viewer)].map(|(name, role)| Key::new(name, role, token()).unwrap());
    let keyring = Keyring::of(Keys::new(Vec::from(keys)).unwrap()).unwrap();
    let shown = keyring.keys().named("wall").unwrap().token.reveal().to_owned();
    Caller::Known(keyring.check(&shown).unwrap())
}

impl Scene {
    fn of(identity: &Identity) -> Scene {
        let (handle, script) = obedient(searching());
        let topics = Topics::new("hallsweep", "discovery", "unibo/qak");
        let commands = Commands::new(handle, topics, false, mpsc::channel(1024).0);
        let (feeder, taker) = read_ahead(&Pool::default());
        let listener = identity.listener(&commands.into(), [127, 0, 0, 1].into());
        Scene { hearing: Hearing::new(Version::Three, listener, feeder, Clock::default(), Handle::current()), taker, script }
    }

    /// Returns the number of STOPs that reached the loop. Fails if the loop has received anything else.
    async fn halted(&self) -> usize {
        for _ in 0..8 {
            tokio::task::yield_now().await;
        }
        let given = self.script.given.lock().unwrap();
        assert!(given.iter().all(|given| given.command == Command::Stop), "{given:?}");
        given.len()
    }

    fn passed_on(&self) -> (Vec<u8>, Vec<u64>) {
        let (mut bytes, mut halted) = (BytesMut::new(), Vec::new());
        while self.taker.take(&mut bytes, |mark| halted.extend(mark.heard_ahead.then_some(mark.begins))) {}
        (bytes.to_vec(), halted)
    }
}

fn publish(topic: &[u8], payload: &[u8]) -> BytesMut {
    let mut out = BytesMut::new();
    write::publish(&mut out, topic, payload, Qos::Zero, 0, false);
    out
}

const COMMAND: &str = "hallsweep/discovery/command";

const STOPS: [(&str, &[u8]); 9] = [
    ("hallsweep/discovery/command/stop", b""),
    ("hallsweep/discovery/command/stop", br#"{"id":"k7"}"#),
    ("hallsweep/discovery/command/move", br#"{"move":"h"}"#),
    (COMMAND, b"stop"),
    (COMMAND, b"\"STOP\""),
    (COMMAND, b"h"),
    ("unibo/qak/robotmind", b"msg(stopCmd,event,js,none,stopCmd,1)"),
    ("unibo/qak/events", b"msg(stopExplore,dispatch,js,robotmind,stopExplore,1)"),
    ("unibo/qak/robotmind", b"msg(userCmd,dispatch,js,robotmind,userCmd(h),1)"),
];

fn raw(first: u8, topic: &[u8], id: Option<u16>, payload: &[u8]) -> Vec<u8> {
    let id = id.map(u16::to_be_bytes);
    let plain = publish(topic, &[id.as_ref().map_or(&[][..], |id| &id[..]), payload].concat());
    [&[first], &plain[1..]].concat()
}

fn wrong_stop() -> impl Strategy<Value = Vec<u8>> {
    let junk = || prop::sample::select(vec![&b"\xff\xfe"[..], b"\0", b" ", b"!", b"}", b",", b"\r\n", b"\xc3"]);
    (0..STOPS.len(), 0_u8..16, any::<u16>(), 0..9_usize, junk()).prop_map(|(stop, flags, id, fault, junk)| {
        let (topic, payload) = STOPS[stop];
        let (topic, plain) = (topic.as_bytes(), raw(0x30, topic.as_bytes(), None, payload));
        let padded = |with: &[u8]| [payload, &with.repeat(5000)].concat();
        match fault {
            // Any combination of flags: DUP with QoS 0, QoS 3 with or without a packet id, retain. The packet id is
            // any number, or 0.
            0 | 1 => raw(0x30 | flags, topic, (flags & 6 != 0).then_some(if fault == 0 { id } else { 0 }), payload),
            2 => raw(0x36, topic, None, payload),
            // The payload is not valid text, JSON or term, or it is too long.
            3 => raw(0x30, topic, None, &[payload, junk].concat()),
            4 => raw(0x30, topic, None, &padded(junk)),
            // Topics on which no client may publish.
            5 => raw(0x30, &[topic, junk_of_topics(id)].concat(), None, payload),
            6 => raw(0x30, &[b"/", topic].concat(), None, payload),
            // The STOP is followed by bytes that are not a packet, or is sent between packets that no client sends.
            7 => [plain, vec![0x30, 0x80, 0x80, 0x80, 0x80]].concat(),
            _ => [vec![0xF7, 1, 7], plain, vec![0x20, 0]].concat(),
        }
    })
}

fn junk_of_topics(id: u16) -> &'static [u8] {
    [&b"/#"[..], b"#", b"/+", b"+", b"/", b"\xff", b"\0", b" "][usize::from(id) % 8]
}

proptest! {
    /// Safety S8: a STOP with any single fault still halts. Its sender is a viewer, and it may arrive in two pieces.
    #[test]
    fn a_stop_halts_whatever_else_is_wrong_with_it(stop in wrong_stop(), cut in any::<prop::sample::Index>()) {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
        runtime.block_on(async {
            let mut scene = Scene::of(&Identity(viewer()));
            let (first, second) = stop.split_at(cut.index(stop.len() + 1));
            scene.hearing.begin(first).await;
            scene.hearing.begin(second).await;
            let (bytes, halted) = scene.passed_on();
            assert_eq!(bytes, stop, "all of it is judged later");
            assert_eq!((scene.halted().await, halted.len()), (1, 1));
        });
    }
}

/// Safety S8: other messages do not halt.
#[tokio::test]
async fn nothing_else_halts() {
    let mut scene = Scene::of(&Identity(Caller::Here));
    for (topic, payload) in [
        ("hallsweep/discovery/command/start", &b"stop"[..]),
        ("hallsweep/discovery/command/stop/result", b""),
        ("hallsweep/discovery/command/move", br#"{"move":"w","remove":"h"}"#),
        ("hallsweep/discovery/command/move", br#"{"move":"halt"}"#),
        (COMMAND, b"stop it"),
        (COMMAND, b"start"),
        ("hallsweep/other/command/stop", b""),
        ("unibo/qak/robotmind", b"msg(startCmd,event,js,none,startCmd,1)"),
        ("unibo/qak/a/b", b"msg(stopCmd,event,js,none,stopCmd,1)"),
        ("sensors/door", b"stop"),
    ] {
        scene.hearing.begin(&raw(0x30, topic.as_bytes(), None, payload)).await;
    }
    // Acknowledgements and all other packets except PUBLISH do not halt.
    let stop = publish(STOPS[0].0.as_bytes(), b"");
    for first in [0x40, 0x50, 0x82, 0xE0] {
        scene.hearing.begin(&[&[first], &stop[1..]].concat()).await;
    }
    assert_eq!(scene.halted().await, 0);
}

/// Safety S1: each of the three STOPs halts although the input is not taken. The first STOP follows many bytes. The
/// second is sent while the first still waits. The third is received before the connection ends.
#[tokio::test]
async fn a_stop_in_what_was_read_ahead_or_is_left_behind_halts_although_nothing_is_taken() {
    let (mut client, stream) = tokio::io::duplex(8 * 1024 * 1024);
    let Scene { hearing, taker, script } = Scene::of(&Identity(Caller::Here));
    let flood = publish(b"sensors/door", &[7; 1000]).repeat(300);
    let stop = publish(STOPS[0].0.as_bytes(), b"");
    let (reader, _writer) = tokio::io::split(stream);
    tokio::spawn(hearing.run(Box::new(reader)));
    let given = async |so_many| {
        within("so many stops", async {
            while script.given.lock().unwrap().len() < so_many {
                tokio::task::yield_now().await;
            }
        })
        .await;
    };
    for waits in 1..=2 {
        client.write_all(&[&flood[..], &stop].concat()).await.unwrap();
        given(waits).await;
    }
    client.write_all(&flood.repeat(10)).await.unwrap();
    client.write_all(&stop).await.unwrap();
    std::future::poll_fn(|cx| taker.poll_full(cx)).await;
    taker.leave(Left::HearsRest);
    given(3).await;
}

/// After its key was removed, a client can no longer stop the robot.
#[tokio::test]
async fn whoever_is_not_known_any_more_is_not_heard() {
    let (mut client, stream) = tokio::io::duplex(8 * 1024 * 1024);
    let Scene { hearing, taker, script } = Scene::of(&Identity(Caller::Here));
    taker.leave(Left::Deaf);
    client.write_all(&publish(STOPS[0].0.as_bytes(), b"")).await.unwrap();
    hearing.run(Box::new(stream)).await;
    assert!(script.given.lock().unwrap().is_empty());
}
