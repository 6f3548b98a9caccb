//! Rules of observing beside the plug-test cases: order, freshness, one registration for a token, several things at
//! once.

use std::time::Duration;

use coap_endpoint::{Code, Method};

use crate::observe::{notifies, observe, told};
use crate::rig::bench::{Bench, here};
use crate::rig::message::{Kind, Message, option};

fn acknowledge(bench: &mut Bench, said: &[Message]) {
    for message in said.iter().filter(|message| message.kind == Kind::Con) {
        bench.deliver(here(), &Message::empty(Kind::Ack, message.id).encoded());
    }
}

/// Whether a number is newer than another by the 24-bit rule (RFC 7641, section 3.4).
const fn is_newer(before: u32, after: u32) -> bool {
    (before < after && after - before < 1 << 23) || (before > after && before - after > 1 << 23)
}

#[test]
fn numbers_increase_across_their_wrap() {
    let mut bench = Bench::new();
    let mut before = observe(&mut bench, "/obs", b"n").observed().unwrap();
    let mut wraps = 0;
    for turn in 0..3_000 {
        let said = told(&mut bench, "/obs", &format!("turn {turn}"), 500);
        acknowledge(&mut bench, &said);
        for message in said {
            let number = message.observed().unwrap();
            assert!(number < 1 << 24 && is_newer(before, number), "{before} then {number}");
            wraps += u32::from(number < before);
            before = number;
        }
    }
    assert!(wraps >= 1, "25 minutes were to go once round");
}

#[test]
fn numbers_increase_across_a_restart_and_a_new_registration() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"n");
    let before = told(&mut bench, "/obs", "seen 1", 100)[0].observed().unwrap();
    bench.restart(2);
    bench.wait(Duration::from_secs(1));
    let after = bench.ask(&Message::get("/obs", 77).token(b"n").observe(0)).observed().unwrap();
    assert!(is_newer(before, after), "{before} then {after}");
}

#[test]
fn while_it_changes_all_the_time_an_acknowledgement_is_asked_for_now_and_then() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"c");
    let (mut cons, mut nons) = (0, 0);
    for turn in 0..1200 {
        let said = told(&mut bench, "/obs", &format!("turn {turn}"), 500);
        acknowledge(&mut bench, &said);
        cons += said.iter().filter(|message| message.kind == Kind::Con).count();
        nons += said.iter().filter(|message| message.kind == Kind::Non).count();
    }
    assert!(cons >= 1, "in ten minutes not once");
    assert!(nons > cons * 10, "mostly it is not: {cons} to {nons}");
}

#[test]
fn an_observer_that_is_gone_is_found_out_while_it_changes_all_the_time() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"c");
    for turn in 0..1200 {
        told(&mut bench, "/obs", &format!("turn {turn}"), 500);
    }
    assert_eq!(bench.endpoint.counts().observers, 0);
}

#[test]
fn what_changes_faster_than_it_is_told_is_told_by_its_newest() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"f");
    for turn in 0..1000 {
        bench.change(|server| server.set("/obs", format!("turn {turn}")));
        bench.wait(Duration::from_millis(1));
    }
    let during = bench.said_to(here());
    assert!(during.len() <= 60, "{} notifications in a second", during.len());
    let after = bench.wait_ms(100);
    let last = after.last().or(during.last()).expect("something was told");
    notifies(last, b"f", "turn 999");
}

#[test]
fn what_did_not_change_is_not_told() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"s");
    assert_eq!(told(&mut bench, "/obs-non", "another", 5_000), []);
    assert_eq!(told(&mut bench, "/obs", "seen 0", 5_000), [], "the same again is no news");
}

#[test]
fn one_token_of_one_peer_is_one_observation() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"t");
    observe(&mut bench, "/obs", b"t");
    assert_eq!(bench.endpoint.counts().observers, 1);
    assert_eq!(told(&mut bench, "/obs", "seen 1", 100).len(), 1);
    observe(&mut bench, "/obs-non", b"t");
    assert_eq!(bench.endpoint.counts().observers, 1, "the later one takes its place");
    assert_eq!(told(&mut bench, "/obs", "seen 2", 100), []);
    assert_eq!(told(&mut bench, "/obs-non", "seen 3", 100).len(), 1);
}

#[test]
fn two_tokens_or_two_peers_are_two_observations() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs", b"t1");
    observe(&mut bench, "/obs", b"t2");
    let other = ([127, 0, 0, 1], 40_001).into();
    assert!(bench.ask_from(other, &Message::get("/obs", 1).token(b"t1").observe(0)).observed().is_some());
    let mut said = told(&mut bench, "/obs", "seen 1", 100);
    said.sort_by(|a, b| a.token.cmp(&b.token));
    let tokens: Vec<&[u8]> = said.iter().map(|message| message.token.as_slice()).collect();
    assert_eq!(tokens, [b"t1", b"t2"]);
    assert_eq!(bench.said_to(other).len(), 1);
    assert_eq!(bench.endpoint.subjects().len(), 1, "of one thing");
}

#[test]
fn a_query_and_a_format_are_part_of_what_is_observed() {
    let mut bench = Bench::new();
    for (id, path) in [(1, "/obs"), (2, "/obs?a=1"), (3, "/obs?a=2"), (4, "/obs?a=1")] {
        assert!(bench.ask(&Message::get(path, id).token(&id.to_be_bytes()).observe(0)).observed().is_some());
    }
    assert!(bench.ask(&Message::get("/obs", 5).token(b"a").accept(0).observe(0)).observed().is_some());
    assert_eq!(bench.endpoint.subjects().len(), 4);
}

#[test]
fn what_cannot_be_observed_is_answered_plainly() {
    let mut bench = Bench::new();
    for (id, path, code) in [(1, "/test", Code::CONTENT), (2, "/nowhere", Code::NOT_FOUND), (3, "/separate", Code::EMPTY)] {
        let said = bench.send(&Message::get(path, id).token(b"p").observe(0));
        assert!(code == Code::EMPTY || said[0].code == code, "{said:?}");
        assert!(said.iter().all(|message| message.observed().is_none()), "{said:?}");
    }
    let put = Message::con(Method::Put, 9).path("/obs").token(b"w").observe(0).payload("x");
    assert_eq!(bench.ask(&put).observed(), None, "only a GET observes");
    assert_eq!(bench.endpoint.counts().observers, 0);
}

#[test]
fn an_observe_option_that_means_nothing_is_passed_over() {
    for value in [2, 77, 0xFF_FFFF] {
        let mut bench = Bench::new();
        let request = Message::get("/obs", 1).token(b"p").observe(value);
        let answer = bench.ask(&request);
        answer.answers(&request, Code::CONTENT);
        assert_eq!((answer.observed(), bench.endpoint.counts().observers), (None, 0));
    }
}

#[test]
fn a_registration_by_non_is_answered_by_non_and_told_like_any_other() {
    let mut bench = Bench::new();
    let answer = bench.ask(&Message::non(Method::Get, 1).path("/obs").token(b"non").observe(0));
    assert_eq!((answer.kind, answer.code, answer.observed().is_some()), (Kind::Non, Code::CONTENT, true));
    let said = told(&mut bench, "/obs", "seen 1", 100);
    notifies(&said[0], b"non", "seen 1");
}

#[test]
fn a_client_that_has_the_state_already_registers_with_2_03() {
    let mut bench = Bench::new();
    let tag = bench.ask(&Message::get("/obs", 1)).values(option::ETAG)[0].to_vec();
    let request = Message::get("/obs", 2).token(b"v").observe(0).with(option::ETAG, &tag);
    let answer = bench.ask(&request);
    answer.answers(&request, Code::VALID);
    assert!(answer.observed().is_some() && answer.payload.is_empty());
    let said = told(&mut bench, "/obs", "seen 1", 100);
    notifies(&said[0], b"v", "seen 1");
}

#[test]
fn several_things_are_told_each_when_it_changed_and_in_their_order() {
    let mut bench = Bench::new();
    let first = observe(&mut bench, "/model", b"m");
    assert_eq!(first.text(), "robot 0\nmap 0\nlamp 0");
    let said = bench.wait_ms(200);
    assert_eq!(said.iter().map(Message::text).collect::<Vec<_>>(), ["robot 0", "map 0", "lamp 0"], "none was shown alone");
    bench.change(|server| server.set_model(1, "map 1"));
    let said = bench.wait_ms(200);
    assert_eq!(said.iter().map(Message::text).collect::<Vec<_>>(), ["map 1"]);
    bench.change(|server| (0..3).for_each(|which| server.set_model(which, &format!("thing {which}"))));
    let said = bench.wait_ms(200);
    assert_eq!(said.iter().map(Message::text).collect::<Vec<_>>(), ["thing 0", "thing 1", "thing 2"]);
    let numbers: Vec<u32> = said.iter().map(|message| message.observed().unwrap()).collect();
    assert!(is_newer(numbers[0], numbers[1]) && is_newer(numbers[1], numbers[2]), "{numbers:?}");
}

#[test]
fn a_lamp_is_not_hidden_by_a_robot_and_a_map_that_change_all_the_time() {
    let mut bench = Bench::new();
    observe(&mut bench, "/model", b"m");
    let mut waited = None;
    for turn in 0..500_u32 {
        bench.change(|server| {
            server.set_model(0, &format!("robot {turn}"));
            server.set_model(1, &format!("map {turn}"));
            if turn == 250 {
                server.set_model(2, "lamp 1");
            }
        });
        let said = bench.wait_ms(10);
        acknowledge(&mut bench, &said);
        if said.iter().any(|message| message.text() == "lamp 1") {
            waited.get_or_insert(turn - 250);
        }
    }
    assert!(waited.is_some_and(|turns| turns <= 20), "it waited for {waited:?} turns of 10 ms");
}

#[test]
fn a_lamp_that_was_lost_on_its_way_is_told_again_with_an_acknowledgement() {
    let mut bench = Bench::new();
    observe(&mut bench, "/model", b"m");
    bench.change(|server| server.set_model(2, "lamp 1"));
    bench.wait_ms(100);
    let mut seen = Vec::new();
    for turn in 0..100 {
        bench.change(|server| server.set_model(0, &format!("robot {turn}")));
        let said = bench.wait_ms(500);
        acknowledge(&mut bench, &said);
        seen.extend(said);
    }
    let again = seen.iter().find(|message| message.text() == "lamp 1");
    assert_eq!(again.map(|message| message.kind), Some(Kind::Con), "while the robot goes on moving");
}

#[test]
fn an_observation_of_something_slow_begins_with_its_answer() {
    let mut bench = Bench::new();
    bench.server.slow = Duration::from_millis(700);
    bench.server.slow_observable = true;
    let request = Message::get("/separate", 1).token(b"sl").observe(0);
    assert_eq!(bench.send(&request), []);
    let said = bench.wait_ms(800);
    assert_eq!((said[0].clone(), said[1].kind), (Message::empty(Kind::Ack, 1), Kind::Con));
    assert!(said[1].observed().is_some(), "{said:?}");
    bench.send(&Message::empty(Kind::Ack, said[1].id));
    assert_eq!(bench.endpoint.counts().observers, 1);
}
