//! Messages that come again: they get the same answer and have no second effect, as long as their id stands for them.

use std::time::Duration;

use coap_endpoint::{Code, Method};

use crate::rig::bench::{Bench, here};
use crate::rig::message::{Kind, Message, option};

fn put(id: u16) -> Message {
    Message::con(Method::Put, id).token(b"d").path("/test").payload("once")
}

#[test]
fn a_con_that_comes_again_gets_the_same_bytes_and_has_no_second_effect() {
    let mut bench = Bench::new();
    bench.deliver(here(), &put(1).encoded());
    let first = bench.take()[0].bytes.clone();
    for wait_s in [0, 2, 4, 90, 100] {
        bench.wait(Duration::from_secs(wait_s));
        bench.deliver(here(), &put(1).encoded());
        let again = bench.take();
        assert_eq!((again.len(), &again[0].bytes), (1, &first));
    }
    assert_eq!(bench.server.asked.len(), 1);
}

#[test]
fn what_comes_again_is_answered_as_it_was_though_the_resource_is_another_now() {
    let mut bench = Bench::new();
    let first = bench.ask(&Message::get("/test", 1));
    bench.change(|server| server.set("/test", "another"));
    assert_eq!(bench.ask(&Message::get("/test", 1)), first);
    assert_eq!(bench.ask(&Message::get("/test", 2)).text(), "another");
}

#[test]
fn a_non_that_comes_again_has_no_second_effect() {
    let mut bench = Bench::new();
    let request = Message { kind: Kind::Non, ..put(1) };
    let first = bench.send(&request);
    let again = bench.send(&request);
    assert!(again.is_empty() || again == first, "{again:?}");
    assert_eq!(bench.server.asked.len(), 1);
}

#[test]
fn an_id_stands_for_its_message_for_247_seconds_and_then_for_another() {
    let mut bench = Bench::new();
    bench.ask(&put(1));
    bench.wait(Duration::from_millis(246_900));
    bench.ask(&put(1));
    assert_eq!(bench.server.asked.len(), 1);
    bench.wait(Duration::from_millis(200));
    bench.ask(&put(1));
    assert_eq!(bench.server.asked.len(), 2, "it is forgotten");
}

#[test]
fn the_same_id_of_another_port_or_address_is_another_message() {
    let mut bench = Bench::new();
    bench.ask(&put(1));
    for (address, port) in [([127, 0, 0, 1], 40_001), ([127, 0, 0, 2], 40_000)] {
        bench.ask_from((address, port).into(), &put(1)).answers(&put(1), Code::CHANGED);
    }
    assert_eq!(bench.server.asked.len(), 3);
}

#[test]
fn what_comes_again_while_it_is_being_answered_is_acknowledged_and_not_asked_again() {
    let mut bench = Bench::new();
    let request = Message::con(Method::Put, 1).token(b"s").path("/separate");
    assert_eq!(bench.send(&request), []);
    bench.wait(Duration::from_millis(100));
    let hurried = bench.send(&request);
    assert!(hurried.is_empty() || hurried == [Message::empty(Kind::Ack, 1)], "{hurried:?}");
    let said = bench.wait_ms(1500);
    let answer = said.iter().find(|message| message.kind == Kind::Con).expect("the answer comes separately");
    bench.send(&Message::empty(Kind::Ack, answer.id));
    assert_eq!(bench.ask(&request), Message::empty(Kind::Ack, 1), "its acknowledgement may have been lost");
    assert_eq!(bench.server.asked.len(), 1);
    assert_eq!(bench.wait_ms(300_000), []);
}

#[test]
fn a_refusal_that_comes_again_is_the_same() {
    let mut bench = Bench::new();
    let request = Message::get("/test", 1).with(65_001, b"?");
    let first = bench.ask(&request);
    assert_eq!(bench.ask(&request), first);
    let lone = put(2).block1((3, true, 0)).payload([1; 16]);
    let first = bench.ask(&lone);
    assert_eq!(bench.ask(&lone), first);
    assert_eq!(first.code, Code::INCOMPLETE);
}

#[test]
fn a_registration_that_comes_again_is_one_observation() {
    let mut bench = Bench::new();
    let request = Message::get("/obs", 1).token(b"o").observe(0);
    let first = bench.ask(&request);
    assert_eq!(bench.ask(&request), first);
    bench.change(|server| server.set("/obs", "seen 1"));
    assert_eq!(bench.wait_ms(100).len(), 1);
    assert!(first.value(option::OBSERVE).is_some());
}
