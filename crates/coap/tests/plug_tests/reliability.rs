//! Messages of the endpoint that need an acknowledgement: sent again in time, given up in time, and one at a time for
//! each peer.

use std::time::Duration;

use coap_endpoint::Code;

use crate::rig::bench::{Bench, Out, here};
use crate::rig::each_seed;
use crate::rig::message::{Kind, Message};

fn answered_late(seed: u64) -> (Bench, Out) {
    let mut bench = Bench::seeded(seed);
    bench.deliver(here(), &Message::get("/separate", 1).token(b"s").encoded());
    let slow = bench.server.slow;
    bench.wait(slow);
    let answer = bench.take().pop().expect("it is answered");
    assert_eq!(Message::decoded(&answer.bytes).kind, Kind::Con);
    (bench, answer)
}

#[test]
fn an_answer_is_sent_again_after_2_to_3_seconds_and_then_after_twice_as_long_four_times() {
    each_seed(20, |seed| {
        let (mut bench, first) = answered_late(seed);
        bench.wait(Duration::from_secs(300));
        let again = bench.take();
        assert_eq!(again.len(), 4, "{again:?}");
        assert!(again.iter().all(|out| out.bytes == first.bytes), "the same message each time");
        let times: Vec<f64> = again.iter().map(|out| (out.at - first.at).as_secs_f64()).collect();
        assert!((2.0..=3.0).contains(&times[0]), "{times:?}");
        for (turn, time) in times.iter().enumerate() {
            let expect = times[0] * f64::from((2_u32 << turn) - 1);
            assert!((time - expect).abs() < 0.001, "{times:?}");
        }
    });
}

#[test]
fn an_acknowledgement_or_a_rejection_ends_it_whenever_it_comes() {
    for (kind, after_s) in [(Kind::Ack, 0), (Kind::Ack, 10), (Kind::Rst, 0), (Kind::Rst, 10)] {
        let (mut bench, first) = answered_late(1);
        bench.wait(Duration::from_secs(after_s));
        bench.take();
        let id = Message::decoded(&first.bytes).id;
        assert_eq!(bench.send(&Message::empty(kind, id)), []);
        assert_eq!(bench.wait_ms(300_000), []);
    }
}

#[test]
fn an_acknowledgement_of_something_else_ends_nothing() {
    let (mut bench, first) = answered_late(1);
    let id = Message::decoded(&first.bytes).id;
    bench.send(&Message::empty(Kind::Ack, id.wrapping_add(1)));
    bench.send_from(([127, 0, 0, 1], 40_001).into(), &Message::empty(Kind::Ack, id));
    assert_eq!(bench.wait_ms(3_000).len(), 1);
}

#[test]
fn one_message_at_a_time_waits_for_its_acknowledgement() {
    let mut bench = Bench::new();
    for n in 0..4_u16 {
        bench.deliver(here(), &Message::get("/separate", n).token(&n.to_be_bytes()).encoded());
    }
    bench.wait(Duration::from_millis(1500));
    let mut tokens = Vec::new();
    for _ in 0..4 {
        let cons: Vec<Message> = bench.said_to(here()).into_iter().filter(|message| message.kind == Kind::Con).collect();
        assert_eq!(cons.len(), 1, "one at a time: {cons:?}");
        assert_eq!(cons[0].code, Code::CONTENT);
        tokens.push(cons[0].token.clone());
        bench.deliver(here(), &Message::empty(Kind::Ack, cons[0].id).encoded());
    }
    let expect: Vec<Vec<u8>> = (0..4_u16).map(|n| n.to_be_bytes().to_vec()).collect();
    assert_eq!(tokens, expect, "in the order in which they were answered");
    assert_eq!(bench.wait_ms(300_000), []);
}

#[test]
fn one_peer_that_does_not_acknowledge_does_not_keep_another_waiting() {
    let (mut bench, _) = answered_late(1);
    let other = ([127, 0, 0, 1], 40_001).into();
    assert_eq!(bench.ask_from(other, &Message::get("/test", 1)).code, Code::CONTENT);
    assert_eq!(bench.ask(&Message::get("/test", 2)).code, Code::CONTENT, "nor itself");
}

#[test]
fn an_answer_that_is_given_up_lets_the_next_one_go() {
    let (mut bench, _) = answered_late(1);
    bench.deliver(here(), &Message::get("/separate", 2).token(b"2").encoded());
    let said = bench.wait_ms(100_000);
    let second = said.iter().find(|message| message.token == b"2" && message.kind == Kind::Con);
    assert!(second.is_some(), "{said:?}");
}
