//! Long observations: things that disappear and return, things that never change, places for all, and the end.

use std::net::SocketAddr;
use std::time::Duration;

use coap_endpoint::{Code, Method, Response, limits};

use crate::observe::{observe, told};
use crate::rig::bench::{Bench, here};
use crate::rig::message::{Kind, Message, option};

/// What is sent within a second; every CON of it is acknowledged.
fn heard(bench: &mut Bench) -> Vec<String> {
    let mut texts = Vec::new();
    for _ in 0..100 {
        for message in bench.wait_ms(50) {
            texts.push(message.text());
            if message.kind == Kind::Con {
                bench.deliver(here(), &Message::empty(Kind::Ack, message.id).encoded());
            }
        }
    }
    texts
}

/// A thing that returns must not be taken for the earlier one.
#[test]
fn a_thing_that_went_away_and_comes_back_is_told() {
    let mut bench = Bench::new();
    observe(&mut bench, "/model", b"m");
    for photo in 1..=5 {
        bench.change(|server| server.set_model(2, &format!("photo {photo}")));
        heard(&mut bench);
    }
    bench.change(|server| server.set_model(2, ""));
    heard(&mut bench);
    for photo in 6..=8 {
        let text = format!("photo {photo}");
        bench.change(|server| server.set_model(2, &text));
        assert!(heard(&mut bench).contains(&text), "{text} was hidden");
    }
}

#[test]
fn who_observes_what_never_changes_is_told_before_max_age_is_over() {
    let mut bench = Bench::new();
    let answer = observe(&mut bench, "/obs", b"q");
    assert_eq!(answer.value(option::MAX_AGE).unwrap_or(60), 60);
    let mut silent_s = 0;
    for _ in 0..1000 {
        let said = bench.wait_ms(1000);
        silent_s = if said.is_empty() { silent_s + 1 } else { 0 };
        assert!(silent_s < 60, "nothing was said for a minute");
        for message in said {
            assert_eq!((message.kind, message.text().as_str()), (Kind::Con, "seen 0"));
            bench.deliver(here(), &Message::empty(Kind::Ack, message.id).encoded());
        }
    }
}

#[test]
fn who_is_gone_keeps_no_place_although_nothing_changes() {
    let mut bench = Bench::new();
    for port in 0..20 {
        let peer = SocketAddr::from(([127, 0, 0, 1], 50_000 + port));
        for token in 0..64_u8 {
            bench.deliver(peer, &Message::get("/obs", token.into()).token(&[token]).observe(0).encoded());
        }
    }
    assert_eq!(bench.endpoint.counts().observers, 20 * 64);
    bench.wait(Duration::from_secs(200));
    assert_eq!(bench.endpoint.counts().observers, 0);
}

#[test]
fn strangers_leave_places_to_this_machine() {
    let mut bench = Bench::new();
    for host in 0..6_u8 {
        for port in 0..5 {
            let peer = SocketAddr::from(([192, 0, 2, host], 40_000 + port));
            let asked = bench.ask_from(peer, &Message::get("/obs", 0).observe(0));
            let echo = asked.values(option::ECHO)[0].to_vec();
            for token in 0..64_u8 {
                let request = Message::get("/obs", u16::from(token) + 1).token(&[token]).observe(0);
                bench.deliver(peer, &request.with(option::ECHO, &echo).encoded());
            }
        }
        let of_networks = usize::from(host + 1) * limits::OBSERVERS_OF_A_NETWORK;
        assert_eq!(bench.endpoint.counts().observers, of_networks.min(limits::OBSERVERS_BEYOND));
    }
    observe(&mut bench, "/obs", b"here");
}

#[test]
fn a_target_that_is_too_long_is_shown_and_not_observed() {
    let mut bench = Bench::new();
    let request = Message::get("/obs", 1).token(b"l").with(option::URI_QUERY, &[b'q'; 255]).observe(0);
    assert_eq!(bench.ask(&request).observed(), None);
}

#[test]
fn observers_hear_of_the_end_and_then_nothing() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"e");
    bench.endpoint.close(&Response::refusal(Code::UNAVAILABLE, "the program ends"));
    bench.change(|_| ());
    let said = bench.said_to(here());
    assert_eq!(said.len(), 1);
    assert_eq!((said[0].code, said[0].token.as_slice(), said[0].observed()), (Code::UNAVAILABLE, &b"e"[..], None));
    assert_eq!(told(&mut bench, "/obs", "later", 100_000), []);
    let request = Message::con(Method::Get, 9).path("/obs");
    bench.ask(&request).answers(&request, Code::CONTENT);
}
