//! TD_COAP_OBS_01, 02, 04, 09, 10 and 11: observing, by CON and by NON, through changes and a restart.

use std::time::Duration;

use coap_endpoint::{Code, Method, limits::ACK_TIMEOUT};

use crate::rig::bench::{Bench, here};
use crate::rig::client::ask::Ask;
use crate::rig::message::{Kind, Message, option};
use crate::rig::network::Weather;
use crate::rig::scene::Scene;

#[track_caller]
pub(crate) fn observe(bench: &mut Bench, path: &str, token: &[u8]) -> Message {
    let id = u16::try_from(bench.server.asked.len()).unwrap();
    let request = Message::get(path, id).token(token).observe(0);
    let answer = bench.ask(&request);
    answer.answers(&request, Code::CONTENT);
    assert!(answer.observed().is_some(), "it is registered: {answer:?}");
    answer
}

/// Changes a thing, and returns what observers on this machine are told within this time.
pub(crate) fn told(bench: &mut Bench, path: &str, body: &str, within_ms: u64) -> Vec<Message> {
    bench.change(|server| server.set(path, body));
    bench.wait_ms(within_ms)
}

#[track_caller]
pub(crate) fn notifies(message: &Message, token: &[u8], text: &str) {
    assert_eq!((message.code, message.token.as_slice()), (Code::CONTENT, token), "{message:?}");
    assert_eq!((message.text().as_str(), message.value(option::CONTENT_FORMAT)), (text, Some(0)));
    assert!(message.observed().is_some_and(|number| number < 1 << 24), "{message:?}");
    assert_eq!(message.value(option::MAX_AGE).unwrap_or(60), 60);
}

#[test]
fn td_coap_obs_01_con_notifications() {
    let mut bench = Bench::new();
    let mut before = observe(&mut bench, "/obs", b"o1").observed().unwrap();
    for turn in 1..=5 {
        let text = format!("seen {turn}");
        bench.change(|server| server.set("/obs", &text));
        let mut cons = 0;
        for _ in 0..100 {
            for message in bench.wait_ms(50) {
                notifies(&message, b"o1", &text);
                assert!(message.observed().unwrap() > before, "{message:?}");
                before = message.observed().unwrap();
                if message.kind == Kind::Con {
                    cons += 1;
                    assert_eq!(bench.send(&Message::empty(Kind::Ack, message.id)), []);
                }
            }
        }
        assert_eq!(cons, 1, "the last state is sent with a wish for an acknowledgement, and not again after that");
    }
}

#[test]
fn td_coap_obs_02_non_notifications() {
    let mut bench = Bench::new();
    let mut before = observe(&mut bench, "/obs-non", b"o2").observed().unwrap();
    let mut ids = std::collections::BTreeSet::new();
    for turn in 1..=20 {
        let text = format!("seen {turn}");
        let said = told(&mut bench, "/obs-non", &text, 100);
        assert_eq!(said.len(), 1, "{said:?}");
        notifies(&said[0], b"o2", &text);
        assert_eq!(said[0].kind, Kind::Non);
        assert!(said[0].observed().unwrap() > before && ids.insert(said[0].id), "{said:?}");
        before = said[0].observed().unwrap();
    }
}

#[test]
fn td_coap_obs_04_registers_again_after_the_server_lost_its_state() {
    let mut scene = Scene::new(1, Weather::FAIR);
    let token = scene.begin(Ask::observe("/obs"));
    scene.wait(Duration::from_secs(1));
    scene.change(|server| server.set("/obs", "seen 1"));
    scene.wait(Duration::from_secs(10));
    assert_eq!(scene.clients[0].held(&token), Some(&b"seen 1"[..]));
    scene.restart();
    scene.change(|server| server.set("/obs", "seen 2"));
    scene.wait(Duration::from_secs(30));
    assert_eq!(scene.clients[0].held(&token), Some(&b"seen 1"[..]), "nobody could tell it");
    scene.wait(Duration::from_secs(60));
    assert_eq!(scene.clients[0].held(&token), Some(&b"seen 2"[..]), "its state grew old and it asked again");
    scene.change(|server| server.set("/obs", "seen 3"));
    scene.wait(Duration::from_secs(5));
    assert_eq!(scene.clients[0].states(&token).last().map(String::as_str), Some("seen 3"), "it observes again");
}

#[test]
fn td_coap_obs_09_update_in_the_same_format() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"o9");
    let put = Message::con(Method::Put, 900).path("/obs").token(b"pu").number(option::CONTENT_FORMAT, 0).payload("from outside");
    let answer = bench.ask_from(([127, 0, 0, 1], 40_001).into(), &put);
    answer.answers(&put, Code::CHANGED);
    let said = bench.wait_ms(100);
    assert_eq!(said.len(), 1, "{said:?}");
    notifies(&said[0], b"o9", "from outside");
}

#[test]
fn an_observer_that_changes_the_thing_itself_gets_its_answer_and_its_notification() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"o9");
    let put = Message::con(Method::Put, 900).path("/obs").token(b"pu").payload("from myself");
    bench.deliver(here(), &put.encoded());
    let said = bench.wait_ms(100);
    assert_eq!(said.len(), 2, "{said:?}");
    said[0].answers(&put, Code::CHANGED);
    notifies(&said[1], b"o9", "from myself");
}

#[test]
fn td_coap_obs_10_plain_get_beside_an_observation() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"o10");
    let request = Message::get("/obs", 100).token(b"plain");
    let answer = bench.ask(&request);
    answer.answers(&request, Code::CONTENT);
    assert_eq!(answer.observed(), None, "nobody asked to observe");
    let said = told(&mut bench, "/obs", "seen 1", 100);
    assert_eq!(said.len(), 1, "{said:?}");
    notifies(&said[0], b"o10", "seen 1");
}

/// A retransmission may carry a newer state, under an id of its own (RFC 7641, section 4.5.2): it then replaces the one
/// before when that is due to be sent again, not sooner, and the older one never comes again.
#[test]
fn td_coap_obs_11_never_two_outstanding_to_one_observer() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"o11");
    observe(&mut bench, "/obs-non", b"o11b");
    let mut outstanding: Option<(Duration, Message)> = None;
    let (mut replaced, mut repeated) = (Vec::new(), 0);
    for turn in 1..=60 {
        bench.change(|server| server.set("/obs", format!("seen {turn}")));
        bench.change(|server| server.set("/obs-non", format!("seen {turn}")));
        bench.wait(Duration::from_millis(if turn % 10 == 0 { 5_000 } else { 300 }));
        for (at, message) in bench.take().into_iter().map(|out| (out.at, Message::decoded(&out.bytes))) {
            if message.kind != Kind::Con {
                continue;
            }
            assert!(!replaced.contains(&message.id), "{message:?} was replaced");
            if let Some((sent, before)) = &outstanding {
                assert_eq!(message.token, before.token, "{message:?} beside {before:?}");
                assert!(at >= *sent + ACK_TIMEOUT, "{message:?} beside {before:?}");
                repeated += 1;
                if message.id != before.id {
                    replaced.push(before.id);
                }
            }
            outstanding = Some((at, message));
        }
        if turn % 20 == 0 {
            let (_, message) = outstanding.take().expect("after so long one wants an acknowledgement");
            let next = bench.send(&Message::empty(Kind::Ack, message.id)).into_iter().find(|message| message.kind == Kind::Con);
            outstanding = next.map(|message| (bench.now, message));
        }
    }
    assert!(repeated > 2 && !replaced.is_empty(), "{repeated} {replaced:?}");
}
