//! Blocks at their bounds: the largest numbers, the reserved size, past the end, gaps, and bodies that are too large.

use coap_endpoint::{Code, Method};

use crate::rig::bench::{Bench, here};
use crate::rig::client::ask::Ask;
use crate::rig::client::exchange::Outcome;
use crate::rig::message::{Message, option};
use crate::rig::network::Weather;
use crate::rig::scene::Scene;
use crate::rig::server::thing::long_body;

fn put(id: u16, number: u32, more: bool, payload: &[u8]) -> Message {
    Message::con(Method::Put, id).token(b"b").path("/large-update").block1((number, more, 0)).payload(payload)
}

#[test]
fn a_body_of_more_than_4096_blocks_is_read_to_its_end() {
    let mut scene = Scene::new(1, Weather::FAIR);
    let body = long_body(16 * 5000 + 7);
    scene.bench.server.set("/large", &body);
    let Outcome::Answered { body: got, last, .. } = scene.ask(Ask::get("/large").early(0)) else { panic!("silence") };
    assert_eq!(got, body);
    assert_eq!(last.block(option::BLOCK2), Some((5000, false, 0)), "a number that takes three bytes");
}

#[test]
fn each_block_is_itself_and_no_other() {
    let mut bench = Bench::new();
    let body = long_body(70_000);
    bench.server.set("/large", &body);
    for exponent in 0..=6_u8 {
        let last = u32::try_from((body.len() - 1) >> (exponent + 4)).unwrap();
        for number in [0, 1, 15, 16, 63, last / 2, last - 1, last].into_iter().filter(|number| *number <= last) {
            let request = Message::get("/large", 1).block2((number, false, exponent));
            bench.wait(std::time::Duration::from_secs(300));
            let answer = bench.ask(&request);
            answer.answers(&request, Code::CONTENT);
            let start = usize::try_from(number).unwrap() << (exponent + 4);
            let end = body.len().min(start + (16 << exponent));
            assert_eq!(answer.payload, body[start..end]);
            assert_eq!(answer.block(option::BLOCK2), Some((number, number < last, exponent)));
        }
    }
}

#[test]
fn the_reserved_size_is_refused() {
    let mut bench = Bench::new();
    for (id, request) in
        [Message::get("/large", 1).block2((0, false, 7)), put(2, 0, false, b"x").block2((0, false, 7))].into_iter().enumerate()
    {
        let request = Message { id: u16::try_from(id).unwrap(), ..request };
        bench.ask(&request).answers(&request, Code::BAD_REQUEST);
    }
    let request = Message::con(Method::Put, 3).path("/large-update").block1((0, true, 7)).payload([1; 16]);
    bench.ask(&request).answers(&request, Code::BAD_REQUEST);
    assert!(bench.server.asked.is_empty());
}

#[test]
fn past_the_end_is_refused_and_never_block_0() {
    let mut bench = Bench::new();
    let beyond = [(1, 2, 6), (2, 80, 6), (3, 4096, 6), (4, (1 << 20) - 1, 6), (7, 80, 0), (8, 5, 4), (9, 81, 0)];
    for (id, number, exponent) in beyond {
        let request = Message::get("/large", id).token(b"e").block2((number, false, exponent));
        let answer = bench.ask(&request);
        assert!([Code::BAD_REQUEST, Code::BAD_OPTION].contains(&answer.code), "{answer:?}");
        assert!(answer.block(option::BLOCK2).is_none_or(|(number, ..)| number != 0), "{answer:?}");
    }
    let small = Message::get("/test", 5).block2((1, false, 0));
    bench.ask(&small).answers(&small, Code::BAD_REQUEST);
    let first = Message::get("/test", 6).block2((0, false, 0));
    assert_eq!(bench.ask(&first).text(), "a test");
}

#[test]
fn the_length_is_told_to_whoever_asks_for_it() {
    let request = Message::get("/large", 1).block2((0, false, 2)).number(option::SIZE2, 0);
    assert_eq!(Bench::new().ask(&request).value(option::SIZE2), Some(1280));
}

#[test]
fn a_gap_in_a_body_is_refused_and_nothing_is_done() {
    let mut bench = Bench::new();
    let lone = put(1, 3, true, &[1; 16]);
    bench.ask(&lone).answers(&lone, Code::INCOMPLETE);
    bench.ask(&put(2, 0, true, &[1; 16])).answers(&put(2, 0, true, &[1; 16]), Code::CONTINUE);
    let gap = put(3, 2, false, &[3; 16]);
    bench.ask(&gap).answers(&gap, Code::INCOMPLETE);
    assert!(bench.server.asked.is_empty());
}

#[test]
fn to_read_on_what_was_never_answered_does_nothing() {
    let mut bench = Bench::new();
    let request = Message::con(Method::Post, 1).token(b"r").path("/large-post").block2((1, false, 2));
    bench.ask(&request).answers(&request, Code::INCOMPLETE);
    let posted = Message::con(Method::Post, 2).path("/large-post").payload(long_body(900)).block2((0, false, 2));
    assert_eq!(bench.ask(&posted).block(option::BLOCK2), Some((0, true, 2)));
    let mut other = here();
    other.set_port(40_001);
    assert_eq!(bench.ask_from(other, &request).code, Code::INCOMPLETE, "it is the answer of whoever did it");
    bench.wait(std::time::Duration::from_secs(300));
    assert_eq!(bench.ask(&request).code, Code::INCOMPLETE, "after so long it is forgotten");
    assert_eq!(bench.server.asked.len(), 1);
}

#[test]
fn a_block_that_comes_twice_counts_once() {
    let mut bench = Bench::new();
    let first = put(1, 0, true, &[1; 16]);
    let answer = bench.ask(&first);
    assert_eq!(bench.ask(&first), answer);
    let last = put(2, 1, false, b"end");
    let done = bench.ask(&last);
    assert_eq!(bench.ask(&last), done);
    assert_eq!(bench.server.asked.len(), 1);
    assert_eq!(bench.server.asked[0].payload, [&[1; 16][..], b"end"].concat());
}

#[test]
fn a_body_that_begins_anew_forgets_the_beginning_before() {
    let mut bench = Bench::new();
    bench.ask(&put(1, 0, true, &[1; 16]));
    bench.ask(&put(2, 0, true, &[2; 16]));
    bench.ask(&put(3, 1, false, b"end")).answers(&put(3, 1, false, b""), Code::CHANGED);
    assert_eq!(bench.server.asked[0].payload, [&[2; 16][..], b"end"].concat());
}

#[test]
fn bodies_of_two_clients_are_not_mixed() {
    let mut bench = Bench::new();
    let mut other = here();
    other.set_port(40_001);
    bench.ask(&put(1, 0, true, &[1; 16]));
    bench.ask_from(other, &put(1, 0, true, &[2; 16]));
    bench.ask(&put(2, 1, false, b"mine"));
    bench.ask_from(other, &put(2, 1, false, b"yours"));
    assert_eq!(bench.server.asked[0].payload, [&[1; 16][..], b"mine"].concat());
    assert_eq!(bench.server.asked[1].payload, [&[2; 16][..], b"yours"].concat());
}

#[test]
fn a_body_that_is_too_large_is_refused_with_the_largest_there_may_be() {
    let mut bench = Bench::new();
    let mut refused = None;
    for number in 0..4096 {
        let id = u16::try_from(number).unwrap();
        let request = Message::con(Method::Put, id).path("/large-update").block1((number, true, 6)).payload([7; 1024]);
        let answer = bench.ask(&request);
        if answer.code != Code::CONTINUE {
            refused = Some((number, answer));
            break;
        }
    }
    let (number, answer) = refused.expect("there is a largest body");
    assert_eq!(answer.code, Code::TOO_LARGE);
    let size = answer.value(option::SIZE1).expect("4.13 says how much there may be");
    assert_eq!(size / 1024, number, "and that is where it stopped");
    assert!(bench.server.asked.is_empty());
    let announced = put(5000, 0, true, &[1; 16]).number(option::SIZE1, size + 1);
    let answer = bench.ask(&announced);
    answer.answers(&announced, Code::TOO_LARGE);
    assert_eq!(answer.value(option::SIZE1), Some(size), "also before it was sent");
}
