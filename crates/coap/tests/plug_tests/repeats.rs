//! Repeated messages: they get the same answer and have no second effect while their id stands for them. An urgent one
//! has a second effect when its first one was undone.

use std::time::Duration;

use coap_endpoint::{Code, Method, Request};

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

/// `/stop` is urgent, and so is `/word` with a body that says so.
fn urgent() -> Bench {
    fn is_urgent(request: &Request) -> bool {
        request.path == ["stop"]
            || request.path == ["word"] && request.payload.starts_with(b"stop") && request.payload.ends_with(b"now")
    }
    let mut bench = Bench::new();
    let endpoint = std::mem::replace(&mut bench.endpoint, Bench::seeded(2).endpoint);
    bench.endpoint = endpoint.with_urgent(is_urgent, "it took effect all the same");
    bench
}

fn urgent_messages() -> Vec<(&'static str, Vec<Vec<u8>>)> {
    let stop = |kind| Message { kind, ..Message::con(Method::Post, 0).path("/stop") };
    let word = |id, number, more, body: &str| {
        Message::con(Method::Put, id).path("/word").block1((number, more, 0)).payload(body).encoded()
    };
    let broken = |kind| [&stop(kind).encoded()[..], &[0xF0]].concat();
    vec![
        ("con", vec![stop(Kind::Con).encoded()]),
        ("non", vec![stop(Kind::Non).encoded()]),
        ("with a token", vec![stop(Kind::Con).token(b"t").encoded()]),
        ("refused", vec![stop(Kind::Con).with(65_001, b"").encoded()]),
        ("passed over", vec![stop(Kind::Non).with(65_001, b"").encoded()]),
        ("no answer wanted", vec![stop(Kind::Non).number(option::NO_RESPONSE, 26).encoded()]),
        ("broken, con", vec![broken(Kind::Con)]),
        ("broken, non", vec![broken(Kind::Non)]),
        ("a first block", vec![stop(Kind::Con).block1((0, true, 0)).payload([b'x'; 16]).encoded()]),
        ("a body in blocks", vec![word(0, 0, true, "stop the machine"), word(1, 1, false, " now")]),
    ]
}

#[test]
fn an_urgent_message_that_comes_again_acts_once_and_once_more_each_time_that_it_was_undone() {
    for (name, datagrams) in urgent_messages() {
        let mut bench = urgent();
        let mut acted = |undone: u64| {
            bench.endpoint.handle_undone(undone);
            datagrams.iter().for_each(|datagram| bench.deliver(here(), datagram));
            bench.server.asked.len()
        };
        for undone in 0..4_u64 {
            let times = usize::try_from(undone).unwrap() + 1;
            assert_eq!((acted(undone), acted(undone), acted(undone)), (times, times, times), "{name}: undone {undone} times");
        }
    }
}

#[test]
fn what_is_not_urgent_acts_once_whatever_was_undone() {
    let mut bench = urgent();
    let blocks = [(5, 0, true, [b'a'; 16].to_vec()), (6, 1, false, b"end".to_vec())].map(|(id, number, more, body)| {
        Message::con(Method::Put, id).path("/large-update").block1((number, more, 0)).payload(body)
    });
    for undone in 0..4 {
        bench.endpoint.handle_undone(undone);
        bench.ask(&put(1));
        bench.send(&Message { kind: Kind::Non, ..put(2) });
        bench.ask(&put(3).with(65_001, b""));
        blocks.iter().for_each(|block| drop(bench.ask(block)));
    }
    assert_eq!((bench.server.count(Method::Put, "/test"), bench.server.count(Method::Put, "/large-update")), (2, 1));
}

#[test]
fn an_urgent_message_that_comes_again_while_it_is_being_answered_acts_again_when_it_was_undone() {
    let mut bench = Bench::new();
    let endpoint = std::mem::replace(&mut bench.endpoint, Bench::seeded(2).endpoint);
    bench.endpoint = endpoint.with_urgent(|request| request.path == ["separate"], "");
    let request = Message::con(Method::Post, 1).token(b"s").path("/separate");
    for undone in [0, 0, 1, 1] {
        bench.endpoint.handle_undone(undone);
        bench.send(&request);
    }
    assert_eq!(bench.server.count(Method::Post, "/separate"), 2);
    let said = bench.wait_ms(100_000);
    assert!(said.iter().any(|message| message.text() == "done at last"), "{said:?}");
    bench.wait(Duration::from_secs(300));
    let counts = bench.endpoint.counts();
    assert_eq!((counts.open, counts.reliable), (0, 0), "{counts:?}");
}

#[test]
fn to_read_on_in_an_urgent_answer_acts_when_what_was_done_was_undone() {
    let mut bench = Bench::new();
    let endpoint = std::mem::replace(&mut bench.endpoint, Bench::seeded(2).endpoint);
    bench.endpoint = endpoint.with_urgent(|request| request.path == ["large-post"], "");
    let block = |id, number| Message::con(Method::Post, id).path("/large-post").payload([b'x'; 100]).block2((number, false, 0));
    for (undone, id, number, times) in [(0, 1, 0, 1), (0, 2, 1, 1), (1, 2, 1, 2), (1, 3, 2, 2), (2, 4, 3, 3), (2, 4, 3, 3)] {
        bench.endpoint.handle_undone(undone);
        bench.ask(&block(id, number));
        assert_eq!(bench.server.count(Method::Post, "/large-post"), times, "undone {undone} times, block {number}");
    }
}
