//! Requests that the endpoint refuses by itself: in words, for the record, and without hiding what matters more.

use coap_endpoint::{Code, Method, Request, limits};

use crate::rig::bench::{Bench, here, stranger};
use crate::rig::message::{Block, Message, option};

fn block(number: u32, more: bool) -> Block {
    (number, more, 0)
}

#[test]
fn a_refused_change_says_so_and_is_for_the_record() {
    let cases = [
        (Message::con(Method::Put, 1).with(65_001, b""), Code::BAD_OPTION),
        (Message::con(Method::Put, 2).block1(block(3, false)).payload("x"), Code::INCOMPLETE),
        (Message::con(Method::Put, 3).number(option::SIZE1, 100_000), Code::TOO_LARGE),
        (Message::con(Method::Put, 4).with(option::PROXY_URI, b"coap://elsewhere"), Code::NO_PROXY),
        (Message::con(Method::Put, 5).with(option::BLOCK1, &[7]), Code::BAD_REQUEST),
    ];
    let mut bench = Bench::new();
    for (request, code) in cases {
        let answer = bench.ask(&request.path("/test"));
        assert_eq!(answer.code, code);
        assert!(answer.text().starts_with("refused: "), "{answer:?}");
        let refused = bench.endpoint.poll_refused().expect("it is noted");
        assert_eq!((refused.peer, refused.asked.as_str()), (here(), "PUT /test"));
        assert!(answer.text().ends_with(&refused.words));
        bench.deliver(stranger(), &Message::con(Method::Put, 9).path("/test").with(65_001, b"").encoded());
        assert_eq!(bench.endpoint.poll_refused(), None, "strangers must not fill the disk");
    }
    bench.ask(&Message::get("/test", 8).with(65_001, b""));
    assert_eq!(bench.endpoint.poll_refused(), None, "to look changes nothing");
}

#[test]
fn no_more_refusals_wait_than_there_is_room_for() {
    let mut bench = Bench::new();
    for id in 0..2000 {
        bench.send(&Message::non(Method::Put, id).path("/test").with(65_001, b""));
    }
    let noted = std::iter::from_fn(|| bench.endpoint.poll_refused()).count();
    assert_eq!(noted, limits::REFUSED);
}

#[test]
fn an_urgent_request_is_handed_over_whatever_is_wrong_with_its_body() {
    fn is_urgent(request: &Request) -> bool {
        request.path == ["stop"]
    }
    let mut bench = Bench::new();
    bench.endpoint =
        std::mem::replace(&mut bench.endpoint, Bench::seeded(2).endpoint).with_urgent(is_urgent, "it took effect all the same");
    let stop = |id| Message::con(Method::Post, id).path("/stop");
    for request in [
        stop(1).block1(block(0, true)).payload([b'x'; 16]),
        stop(2).block1(block(7, false)).payload("x"),
        stop(3).payload(vec![b'x'; limits::BODY + 1]),
        stop(4).number(option::SIZE1, 1 << 20),
    ] {
        bench.send(&request);
    }
    assert_eq!(bench.server.count(Method::Post, "/stop"), 4);
}

#[test]
fn another_command_under_an_old_id_is_another_command() {
    let mut bench = Bench::new();
    let start = Message::con(Method::Put, 1).token(b"a").path("/test").payload("start");
    let stop = Message::con(Method::Put, 1).token(b"b").path("/test").payload("stop");
    bench.ask(&start);
    let answer = bench.ask(&stop);
    answer.answers(&stop, Code::CHANGED);
    bench.ask(&start);
    assert_eq!(bench.server.count(Method::Put, "/test"), 2, "each of them once");
}

#[test]
fn an_error_is_told_whatever_block_of_it_is_asked_for() {
    let mut bench = Bench::new();
    let request = Message::get("/nothing-here", 1).block2((5, false, 2));
    let answer = bench.ask(&request);
    assert_ne!(answer.code, Code::BAD_REQUEST, "{answer:?}");
    let tag = bench.ask(&Message::get("/validate", 2)).values(option::ETAG)[0].to_vec();
    let request = Message::get("/validate", 3).with(option::ETAG, &tag).block2((3, false, 2));
    assert_eq!(bench.ask(&request).code, Code::VALID);
}

#[test]
fn a_block_that_is_sent_again_under_another_id_is_the_same_block() {
    let mut bench = Bench::new();
    let put = |id, number, more| Message::con(Method::Put, id).path("/large-update").block1(block(number, more));
    for (id, number) in [(1, 0), (2, 1), (3, 1), (4, 2)] {
        let body = [b'a' + u8::try_from(number).unwrap(); 16];
        assert_eq!(bench.ask(&put(id, number, true).payload(body)).code, Code::CONTINUE, "block {number}");
    }
    assert_eq!(bench.ask(&put(5, 3, false).payload("end")).code, Code::CHANGED);
    let body = &bench.server.asked.last().unwrap().payload;
    assert_eq!(body.len(), 3 * 16 + 3);
}

#[test]
fn an_error_that_nobody_wants_is_not_sent() {
    let mut bench = Bench::new();
    let unwanted = |id| Message::non(Method::Put, id).path("/test").number(option::NO_RESPONSE, 26);
    assert_eq!(bench.send(&unwanted(1).with(option::PROXY_URI, b"coap://elsewhere")), []);
    assert_eq!(bench.send(&unwanted(2).number(option::SIZE1, 100_000)), []);
    assert_eq!(bench.send(&unwanted(3).block1(block(3, false)).payload("x")), []);
}
