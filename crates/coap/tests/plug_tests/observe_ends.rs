//! TD_COAP_OBS_05 to 08 and 12: how observations end, and that nothing is sent after that.

use std::time::Duration;

use coap_endpoint::{Code, Method};

use crate::observe::{notifies, observe, told};
use crate::rig::bench::{Bench, here};
use crate::rig::message::{Kind, Message, option};

/// Nobody observes any more, and changes lead to no message.
#[track_caller]
fn is_silent(bench: &mut Bench) {
    assert_eq!((bench.endpoint.subjects().len(), bench.endpoint.counts().observers), (0, 0));
    for path in ["/obs", "/obs-non"] {
        if bench.server.things.contains_key(path) {
            assert_eq!(told(bench, path, "to nobody", 300_000), []);
        }
    }
    assert_eq!(bench.endpoint.counts().reliable, 0, "nothing waits");
}

#[test]
fn td_coap_obs_05_client_gone() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"o5");
    let first = bench.now;
    let said = told(&mut bench, "/obs", "seen 1", 6_000);
    let cons: Vec<&Message> = said.iter().filter(|message| message.kind == Kind::Con).collect();
    assert!(cons.len() >= 2, "it is sent again: {said:?}");
    assert!(cons.iter().all(|message| message.text() == "seen 1"));
    bench.change(|server| server.set("/obs", "seen 2"));
    bench.wait(Duration::from_secs(300));
    let later = bench.take();
    let last = Message::decoded(&later.last().expect("it goes on").bytes);
    notifies(&last, b"o5", "seen 2");
    assert!(cons.iter().all(|con| con.id == cons[0].id) && last.id != cons[0].id, "another state is another message");
    for out in &later {
        let message = Message::decoded(&out.bytes);
        assert_eq!((message.kind, message.text().as_str()), (Kind::Con, "seen 2"), "the newest state in the place of the old");
        assert!(message.observed().unwrap() > cons[0].observed().unwrap());
    }
    assert_eq!(cons.len() + later.len(), 5, "one message and four retransmissions, whatever is in them");
    assert!(later.last().unwrap().at - first < Duration::from_secs(60));
    is_silent(&mut bench);
}

#[test]
fn td_coap_obs_06_rejected_non_and_con() {
    for wanted in [Kind::Non, Kind::Con] {
        let mut bench = Bench::new();
        observe(&mut bench, "/obs", b"o6");
        let said = told(&mut bench, "/obs", "seen 1", 3_000);
        let message = said.iter().find(|message| message.kind == wanted).unwrap_or_else(|| panic!("no {wanted:?}: {said:?}"));
        assert_eq!(bench.send(&Message::empty(Kind::Rst, message.id)), []);
        is_silent(&mut bench);
    }
}

#[test]
fn a_rejected_registration_answer_of_a_slow_resource_or_an_old_notification_ends_it_too() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"o6");
    let old = told(&mut bench, "/obs", "seen 1", 50).remove(0);
    told(&mut bench, "/obs", "seen 2", 50);
    bench.send(&Message::empty(Kind::Rst, old.id));
    is_silent(&mut bench);
}

#[test]
fn a_rejection_from_another_address_ends_nothing() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"o6");
    let said = told(&mut bench, "/obs", "seen 1", 50);
    bench.send_from(([127, 0, 0, 1], 40_001).into(), &Message::empty(Kind::Rst, said[0].id));
    let said = told(&mut bench, "/obs", "seen 2", 50);
    notifies(&said[0], b"o6", "seen 2");
}

#[test]
fn td_coap_obs_07_resource_deleted() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"o7");
    let delete = Message::con(Method::Delete, 700).path("/obs");
    bench.ask_from(([127, 0, 0, 1], 40_001).into(), &delete).answers(&delete, Code::DELETED);
    let said = bench.wait_ms(100);
    assert_eq!(said.len(), 1, "{said:?}");
    assert_eq!((said[0].code, said[0].token.as_slice(), said[0].observed()), (Code::NOT_FOUND, &b"o7"[..], None));
    if said[0].kind == Kind::Con {
        bench.send(&Message::empty(Kind::Ack, said[0].id));
    }
    assert_eq!(bench.wait_ms(300_000), []);
    is_silent(&mut bench);
}

#[test]
fn td_coap_obs_08_content_format_no_longer_available() {
    let mut bench = Bench::new();
    let request = Message::get("/obs", 1).token(b"o8").observe(0).accept(0);
    assert!(bench.ask(&request).observed().is_some());
    let put = Message::con(Method::Put, 800).path("/obs").number(option::CONTENT_FORMAT, 50).payload("{}");
    bench.ask_from(([127, 0, 0, 1], 40_001).into(), &put).answers(&put, Code::CHANGED);
    let said = bench.wait_ms(100);
    assert_eq!(said.len(), 1, "{said:?}");
    assert_eq!((said[0].code, said[0].observed()), (Code::NOT_ACCEPTABLE, None));
    if said[0].kind == Kind::Con {
        bench.send(&Message::empty(Kind::Ack, said[0].id));
    }
    assert_eq!(bench.wait_ms(300_000), []);
    is_silent(&mut bench);
}

#[test]
fn a_last_word_is_sent_again_until_it_is_acknowledged() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"o7");
    bench.change(|server| {
        server.things.remove("/obs");
        server.has_changed = true;
    });
    let said = bench.wait_ms(4_000);
    assert!(said.len() >= 2 && said.iter().all(|message| *message == said[0]), "{said:?}");
    assert_eq!((said[0].kind, said[0].code), (Kind::Con, Code::NOT_FOUND));
    bench.send(&Message::empty(Kind::Ack, said[0].id));
    assert_eq!(bench.wait_ms(300_000), []);
}

#[test]
fn td_coap_obs_12_cancelled_with_observe_1() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"o12");
    let said = told(&mut bench, "/obs", "seen 1", 50);
    notifies(&said[0], b"o12", "seen 1");
    let request = Message::get("/obs", 1200).token(b"o12").observe(1);
    let answer = bench.ask(&request);
    answer.answers(&request, Code::CONTENT);
    assert_eq!((answer.observed(), answer.text().as_str()), (None, "seen 1"));
    is_silent(&mut bench);
}

#[test]
fn to_cancel_what_is_being_sent_again_ends_that_too() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"o12");
    let said = told(&mut bench, "/obs", "seen 1", 4_000);
    assert_eq!(said.last().unwrap().kind, Kind::Con);
    bench.ask(&Message::get("/obs", 1200).token(b"o12").observe(1));
    is_silent(&mut bench);
}

#[test]
fn to_cancel_what_was_never_observed_is_a_plain_get() {
    let mut bench = Bench::new();
    let request = Message::get("/obs", 1).token(b"x").observe(1);
    let answer = bench.ask(&request);
    answer.answers(&request, Code::CONTENT);
    assert_eq!(answer.observed(), None);
    assert!(bench.said_to(here()).is_empty());
}
