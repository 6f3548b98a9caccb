//! Peers beyond this machine: they cannot be used to flood others, prove their address by an Echo, and are told to wait
//! when they ask too much.

use std::net::SocketAddr;
use std::time::Duration;

use coap_endpoint::{Code, Method};

use crate::rig::bench::{Bench, here, stranger};
use crate::rig::message::{Kind, Message, option};

/// A request with an answer larger than itself.
fn greedy(id: u16) -> Message {
    match id % 5 {
        0 => Message::get("/large", id),
        1 => Message::get("/obs-large", id).token(b"g").observe(0),
        2 => Message::get("/.well-known/core", id),
        3 => Message::non(Method::Get, id).path("/large"),
        _ => Message::get("/separate", id).token(b"s"),
    }
}

/// Proves an address, and returns the Echo that proved it.
fn prove(bench: &mut Bench, peer: SocketAddr) -> Vec<u8> {
    let request = Message::get("/large", 1).token(b"e");
    let asked = bench.ask_from(peer, &request);
    asked.answers(&request, Code::UNAUTHORIZED);
    let echo = asked.values(option::ECHO)[0].to_vec();
    assert!((1..=40).contains(&echo.len()));
    let again = Message::get("/large", 2).token(b"e").with(option::ECHO, &echo);
    let answer = bench.ask_from(peer, &again);
    answer.answers(&again, Code::CONTENT);
    assert_eq!(answer.payload.len(), 1024, "a proved address gets what it asks for");
    echo
}

#[test]
fn an_address_that_proved_nothing_gets_at_most_three_times_what_it_sent() {
    let mut bench = Bench::new();
    let (mut received, mut sent) = (0, 0);
    for id in 0..300 {
        let bytes = greedy(id).encoded();
        received += bytes.len();
        bench.deliver(stranger(), &bytes);
        bench.deliver(stranger(), &bytes);
        received += bytes.len();
        bench.change(|server| server.set("/obs-large", vec![b'x'; 100 + usize::from(id)]));
        bench.wait(Duration::from_millis(u64::from(id) * 10));
        sent += bench.take().iter().map(|out| out.bytes.len()).sum::<usize>();
        assert!(sent <= 3 * received, "{sent} bytes for {received}");
    }
    bench.wait(Duration::from_secs(300));
    sent += bench.take().iter().map(|out| out.bytes.len()).sum::<usize>();
    assert!(sent <= 3 * received && sent > 0, "{sent} bytes for {received}");
}

#[test]
fn malformed_messages_are_not_answered_with_more_than_three_times_their_bytes() {
    for bytes in [&[0x40, 0, 1, 2][..], &[0x40, 1, 1, 2, 0xFF], &[0x40, 9, 1, 2], &[0x40, 1, 1, 3, 0xD1, 0xFF, 0]] {
        let mut bench = Bench::new();
        bench.deliver(stranger(), bytes);
        let sent: usize = bench.take().iter().map(|out| out.bytes.len()).sum();
        assert!(sent <= 3 * bytes.len(), "{sent} bytes for {bytes:02x?}");
    }
}

#[test]
fn an_echo_proves_the_address_for_the_requests_after_it() {
    let mut bench = Bench::new();
    prove(&mut bench, stranger());
    let request = Message::get("/large", 3).token(b"l");
    bench.ask_from(stranger(), &request).answers(&request, Code::CONTENT);
    let request = Message::get("/obs", 4).token(b"o").observe(0);
    assert!(bench.ask_from(stranger(), &request).observed().is_some(), "it may observe now");
}

#[test]
fn an_echo_of_another_address_or_of_long_ago_proves_nothing() {
    let mut bench = Bench::new();
    let echo = prove(&mut bench, stranger());
    let other = SocketAddr::from(([192, 0, 2, 8], 40_000));
    let request = Message::get("/large", 2).with(option::ECHO, &echo);
    assert_eq!(bench.ask_from(other, &request).code, Code::UNAUTHORIZED);
    let mut changed = echo.clone();
    *changed.last_mut().unwrap() ^= 1;
    let request = Message::get("/large", 3).with(option::ECHO, &changed);
    assert_eq!(bench.ask_from(other, &request).code, Code::UNAUTHORIZED);
    let mut bench = Bench::seeded(2);
    let asked = bench.ask_from(stranger(), &Message::get("/large", 1));
    bench.wait(Duration::from_secs(3600));
    let late = Message::get("/large", 2).with(option::ECHO, asked.values(option::ECHO)[0]);
    assert_eq!(bench.ask_from(stranger(), &late).code, Code::UNAUTHORIZED);
}

#[test]
fn whoever_guesses_message_ids_proves_nothing() {
    let mut bench = Bench::new();
    bench.deliver(stranger(), &Message::get("/separate", 1).token(b"longtokn").encoded());
    bench.wait(Duration::from_secs(2));
    assert_eq!(bench.endpoint.counts().reliable, 1, "an answer waits for its acknowledgement");
    for id in 0..=u16::MAX {
        bench.deliver(stranger(), &Message::empty(Kind::Ack, id).encoded());
    }
    assert_eq!(bench.endpoint.counts().reliable, 0, "one of them was it");
    bench.take();
    let request = Message::get("/obs", 2).token(b"o").observe(0);
    bench.ask_from(stranger(), &request).answers(&request, Code::UNAUTHORIZED);
}

#[test]
fn an_address_that_proved_nothing_observes_nothing() {
    let mut bench = Bench::new();
    let request = Message::get("/obs", 1).token(b"o").observe(0);
    let answer = bench.ask_from(stranger(), &request);
    assert_eq!((answer.code, answer.observed()), (Code::UNAUTHORIZED, None));
    assert_eq!(bench.endpoint.counts().observers, 0);
    bench.change(|server| server.set("/obs", "seen 1"));
    bench.wait(Duration::from_secs(60));
    assert_eq!(bench.said_to(stranger()), []);
}

#[test]
fn a_small_answer_is_had_without_a_proof() {
    let request = Message::get("/test", 1).token(b"tokentok");
    Bench::new().ask_from(stranger(), &request).answers(&request, Code::CONTENT);
}

#[test]
fn whoever_knows_no_echo_reads_in_blocks_of_16_bytes() {
    let mut bench = Bench::new();
    let mut body = Vec::new();
    for number in 0.. {
        let request = Message::get("/large", u16::try_from(number).unwrap()).token(b"to").block2((number, false, 0));
        let answer = bench.ask_from(stranger(), &request);
        answer.answers(&request, Code::CONTENT);
        body.extend_from_slice(&answer.payload);
        if !answer.block(option::BLOCK2).is_some_and(|(_, more, _)| more) {
            break;
        }
    }
    assert_eq!(body.len(), 1280);
}

#[test]
fn what_a_stranger_asked_before_its_proof_is_not_done_twice() {
    let mut bench = Bench::new();
    let request = Message::con(Method::Post, 1).path("/large-post").payload([b'p'; 400]);
    let said = bench.send_from(stranger(), &request);
    assert_eq!(said.len(), 1, "{said:?}");
    let done = bench.server.asked.len();
    bench.send_from(stranger(), &request);
    assert_eq!(bench.server.asked.len(), done, "the same message again");
}

#[test]
fn whoever_is_on_this_machine_needs_no_proof() {
    for peer in ["127.0.0.1:40000", "127.8.9.10:40000", "[::1]:40000", "[::ffff:127.0.0.1]:40000"] {
        let mut bench = Bench::new();
        let peer: SocketAddr = peer.parse().unwrap();
        for id in 0..2_000 {
            let request = Message::get("/large", id);
            bench.ask_from(peer, &request).answers(&request, Code::CONTENT);
        }
        let request = Message::get("/obs-large", 3_000).token(b"o").observe(0);
        assert!(bench.ask_from(peer, &request).observed().is_some());
    }
}

#[test]
fn a_stranger_that_asks_too_much_is_told_to_wait_and_others_are_not() {
    let mut bench = Bench::new();
    prove(&mut bench, stranger());
    let mut refused = 0;
    for id in 10..3_000 {
        let answer = bench.ask_from(stranger(), &Message::get("/test", id));
        match answer.code {
            Code::TOO_MANY_REQUESTS => {
                assert!(answer.value(option::MAX_AGE).is_some(), "it says for how long: {answer:?}");
                refused += 1;
            }
            code => assert_eq!(code, Code::CONTENT),
        }
    }
    assert!((1..2_990).contains(&refused), "{refused} of 2990 were refused");
    let other = SocketAddr::from(([198, 51, 100, 1], 40_000));
    let request = Message::get("/test", 1).token(b"tokentok");
    bench.ask_from(other, &request).answers(&request, Code::CONTENT);
    bench.ask_from(here(), &request).answers(&request, Code::CONTENT);
    bench.wait(Duration::from_secs(5));
    let request = Message::get("/test", 5_000);
    bench.ask_from(stranger(), &request).answers(&request, Code::CONTENT);
}

#[test]
fn a_stranger_that_observes_is_told_at_the_pace_of_its_distance() {
    let mut bench = Bench::new();
    prove(&mut bench, stranger());
    assert!(bench.ask_from(stranger(), &Message::get("/obs", 9).token(b"o").observe(0)).observed().is_some());
    bench.change(|server| server.set("/obs", "seen 1"));
    bench.wait(Duration::from_secs(10));
    let said = bench.said_to(stranger());
    let con = said.iter().find(|message| message.kind == Kind::Con).expect("the first asks how far away it is");
    assert_eq!(con.text(), "seen 1");
}

#[test]
fn strangers_drive_out_no_body_of_this_machine_and_no_memory_of_what_it_did() {
    let mut bench = Bench::new();
    let begun = Message::con(Method::Put, 1).path("/large-update").block1((0, true, 0)).payload([b'a'; 16]);
    assert_eq!(bench.ask(&begun).code, Code::CONTINUE);
    let done = Message::con(Method::Put, 2).path("/test").payload("once");
    let answer = bench.ask(&done);
    for n in 0..10_000_u16 {
        let [network, host] = (n / 100).to_be_bytes();
        let peer = SocketAddr::from(([198, 18 + network, host, 1], 40_000 + n % 100));
        bench.deliver(peer, &Message { id: n, ..begun.clone() }.encoded());
    }
    bench.take();
    bench.server.asked.clear();
    assert_eq!(bench.ask(&done), answer);
    assert_eq!(bench.server.asked.len(), 0, "it is not done twice");
    let last = Message::con(Method::Put, 3).path("/large-update").block1((1, false, 0)).payload("b");
    assert_eq!(bench.ask(&last).code, Code::CHANGED);
}
