//! Every table of the endpoint has a bound, and requests beyond it get a proper answer. Bounds on strangers are in
//! `strangers`.

use std::net::SocketAddr;
use std::time::Duration;

use coap_endpoint::{Code, Method, limits};

use crate::rig::bench::{Bench, here};
use crate::rig::message::{Kind, Message};

fn peer(n: usize) -> SocketAddr {
    let (high, low) = (u8::try_from(n >> 14).unwrap(), u16::try_from(n & 0x3FFF).unwrap());
    SocketAddr::from(([127, 0, 1, high], 10_000 + low))
}

#[test]
fn one_peer_has_so_many_observations_and_then_plain_answers() {
    let mut bench = Bench::new();
    let most = limits::OBSERVERS_OF_A_PEER;
    for n in 0..most + 10 {
        let id = u16::try_from(n).unwrap();
        let request = Message::get("/obs", id).token(&id.to_be_bytes()).observe(0);
        let answer = bench.ask(&request);
        answer.answers(&request, Code::CONTENT);
        assert_eq!(answer.observed().is_some(), n < most, "number {n}");
    }
    assert_eq!(bench.endpoint.counts().observers, most);
    let again = Message::get("/obs", 5_000).token(&0_u16.to_be_bytes()).observe(0);
    assert!(bench.ask(&again).observed().is_some(), "to register again is always possible");
    let other = Message::get("/obs", 1).token(b"o").observe(0);
    assert!(bench.ask_from(peer(1), &other).observed().is_some(), "others are not concerned");
}

#[test]
fn there_are_so_many_observations_in_all_and_then_plain_answers() {
    let mut bench = Bench::new();
    for n in 0..limits::OBSERVERS + 100 {
        let request = Message::get("/obs", 1).token(b"o").observe(0);
        let answer = bench.ask_from(peer(n), &request);
        answer.answers(&request, Code::CONTENT);
        assert_eq!(answer.observed().is_some(), n < limits::OBSERVERS, "number {n}");
    }
    assert_eq!(bench.endpoint.counts().observers, limits::OBSERVERS);
    let cancel = Message::get("/obs", 2).token(b"o").observe(1);
    bench.ask_from(peer(0), &cancel);
    let request = Message::get("/obs", 1).token(b"o").observe(0);
    assert!(bench.ask_from(peer(9_000), &request).observed().is_some(), "there is room again");
}

#[test]
fn a_flood_of_questions_leaves_the_tables_bounded_and_forgets_no_deed() {
    let mut bench = Bench::new();
    let put = Message::con(Method::Put, 1).path("/test").payload("once");
    let done = bench.ask(&put);
    for n in 0..30_000 {
        bench.deliver(peer(n), &Message::get("/test", 1).encoded());
    }
    bench.take();
    let counts = bench.endpoint.counts();
    assert!(counts.exchanges <= 2 * limits::EXCHANGES, "{counts:?}");
    assert_eq!((counts.open, counts.reliable, counts.assemblies), (0, 0, 0));
    assert_eq!(bench.ask(&put), done, "what was done is not forgotten for what was only asked");
    assert_eq!(bench.server.count(Method::Put, "/test"), 1);
}

#[test]
fn bodies_that_are_never_finished_give_way() {
    let mut bench = Bench::new();
    let block = |n: u32, more| Message::con(Method::Put, u16::from(n > 0)).path("/test").block1((n, more, 0)).payload([1; 16]);
    for n in 0..2_000 {
        assert_eq!(bench.ask_from(peer(n), &block(0, true)).code, Code::CONTINUE);
    }
    assert!(bench.endpoint.counts().assemblies <= limits::ASSEMBLIES);
    assert_eq!(bench.ask_from(peer(0), &block(1, false)).code, Code::INCOMPLETE, "the oldest gave way");
    assert_eq!(bench.ask_from(peer(1_999), &block(1, false)).code, Code::CHANGED, "the newest did not");
}

#[test]
fn answers_that_are_never_read_on_give_way() {
    let mut bench = Bench::new();
    for n in 0..1_000 {
        let request = Message::con(Method::Post, 1).path("/large-post").payload([b'x'; 100]).block2((0, false, 0));
        assert_eq!(bench.ask_from(peer(n), &request).code, Code::CHANGED);
    }
    assert!(bench.endpoint.counts().long_answers <= limits::ASSEMBLIES, "{:?}", bench.endpoint.counts());
}

#[test]
fn questions_that_are_never_answered_give_way() {
    let mut bench = Bench::new();
    bench.server.slow = Duration::from_secs(100_000);
    for n in 0..limits::OPEN + 500 {
        bench.deliver(peer(n), &Message::get("/separate", 1).encoded());
    }
    assert!(bench.endpoint.counts().open <= limits::OPEN, "{:?}", bench.endpoint.counts());
    let request = Message::get("/test", 2);
    bench.ask(&request).answers(&request, Code::CONTENT);
}

#[test]
fn a_peer_that_acknowledges_nothing_fills_no_queue() {
    let mut bench = Bench::new();
    for id in 0..500 {
        bench.deliver(here(), &Message::get("/separate", id).token(&id.to_be_bytes()).encoded());
    }
    bench.wait(Duration::from_millis(1_500));
    assert!(bench.endpoint.counts().reliable <= limits::WAITING + 1, "{:?}", bench.endpoint.counts());
    let said = bench.said_to(here());
    let answers = said.iter().filter(|message| message.code == Code::CONTENT).count();
    assert_eq!(answers, 500 - limits::WAITING, "the others went out without a wish for an acknowledgement");
    assert!(said.iter().any(|message| message.kind == Kind::Non));
    bench.wait(Duration::from_secs(36_000));
    assert_eq!(bench.endpoint.counts().reliable, 0, "in the end all are given up");
}

#[test]
fn observers_that_are_all_gone_are_all_found_out() {
    let mut bench = Bench::new();
    for n in 0..500 {
        bench.deliver(peer(n), &Message::get("/obs", 1).token(b"o").observe(0).encoded());
    }
    bench.change(|server| server.set("/obs", "seen 1"));
    bench.wait(Duration::from_secs(200));
    let counts = bench.endpoint.counts();
    assert_eq!((counts.observers, counts.reliable, bench.endpoint.subjects().len()), (0, 0, 0));
    let sent = bench.take().len();
    assert!(sent <= 500 * 7, "each got its answer, a NON, a CON and four retransmissions: {sent}");
}

#[test]
fn peers_that_acknowledge_nothing_are_only_so_many() {
    let mut bench = Bench::new();
    for n in 0..limits::RELIABLE_PEERS + 500 {
        bench.deliver(peer(n), &Message::get("/separate", 1).encoded());
        if n % 1000 == 0 {
            bench.wait(Duration::from_millis(1_300));
        }
    }
    bench.wait(Duration::from_millis(1_300));
    assert!(bench.endpoint.counts().reliable <= limits::RELIABLE_PEERS, "{:?}", bench.endpoint.counts());
    let nons = bench.take().into_iter().filter(|out| Message::decoded(&out.bytes).kind == Kind::Non).count();
    assert!(nons >= 500, "the others went out without a wish for an acknowledgement: {nons}");
}

/// Safety S9: peers of this machine do not give way to those beyond it.
#[test]
fn observers_that_acknowledge_nothing_give_way_to_newcomers_and_those_that_do_stay() {
    let mut bench = Bench::new();
    let register = |bench: &mut Bench, peer, token: &[u8]| {
        let request = Message::get("/obs", 1).token(token).observe(0);
        bench.ask_from(peer, &request).observed().is_some()
    };
    for n in 0..limits::OBSERVERS {
        assert!(register(&mut bench, peer(n), b"o"), "number {n}");
    }
    // Every tenth observer acknowledges.
    let is_there = |n: usize| n.is_multiple_of(10);
    let acknowledge = |bench: &mut Bench| {
        let came: Vec<_> = bench.take().into_iter().map(|out| (out.peer, Message::decoded(&out.bytes))).collect();
        for (peer, message) in came {
            let number = usize::from(peer.port()) - 10_000;
            if message.kind == Kind::Con && is_there(number) {
                bench.deliver(peer, &Message::empty(Kind::Ack, message.id).encoded());
            }
        }
    };
    for _ in 0..100 {
        bench.wait(Duration::from_millis(100));
        acknowledge(&mut bench);
    }
    let newcomers = limits::OBSERVERS - limits::UNPROVED_OBSERVERS - limits::OBSERVERS / 10 - 10;
    for n in 0..newcomers {
        assert!(register(&mut bench, peer(9_000 + n), b"n"), "newcomer {n} of {newcomers}");
    }
    assert_eq!(bench.endpoint.counts().observers, limits::OBSERVERS);
    bench.take();
    bench.change(|server| server.set("/obs", "seen 1"));
    bench.wait(Duration::from_millis(500));
    let told: std::collections::BTreeSet<_> = bench.take().into_iter().map(|out| out.peer).collect();
    for n in 0..limits::OBSERVERS {
        assert!(!is_there(n) || told.contains(&peer(n)), "number {n} is there and has lost its place");
    }
}

#[test]
fn the_place_of_whoever_has_been_silent_for_longest_is_given_away_and_of_nobody_who_may_still_answer() {
    let mut bench = Bench::new();
    let request = Message::get("/obs", 1).token(b"o").observe(0);
    for n in 0..limits::OBSERVERS {
        assert!(bench.ask_from(peer(n), &request).observed().is_some(), "number {n}");
        if n == limits::UNPROVED_OBSERVERS {
            bench.wait(Duration::from_millis(100));
        }
    }
    bench.wait(Duration::from_secs(2));
    let newcomer = peer(9_000);
    assert!(bench.ask_from(newcomer, &request).observed().is_none(), "nobody has been silent for long");
    bench.wait(Duration::from_secs(4));
    bench.take();
    let again = Message::get("/obs", 2).token(b"o").observe(0);
    assert!(bench.ask_from(newcomer, &again).observed().is_some());
    bench.wait(Duration::from_secs(30));
    let asked_again: std::collections::BTreeSet<_> = bench.take().into_iter().map(|out| out.peer).collect();
    let first = limits::UNPROVED_OBSERVERS;
    assert!(!asked_again.contains(&peer(first)), "the first that was asked has lost its place");
    assert!((first + 1..limits::OBSERVERS).all(|n| asked_again.contains(&peer(n))), "nobody else has");
}

/// An observer that was not asked for an acknowledgement does not owe one.
#[test]
fn an_observer_of_what_is_quiet_that_registers_again_keeps_its_place_in_a_crowd() {
    let mut bench = Bench::new();
    let early = peer(9_000);
    let request = |id| Message::get("/obs", id).token(b"o").observe(0);
    assert!(bench.ask_from(early, &request(1)).observed().is_some());
    bench.wait(Duration::from_secs(40));
    for n in 0..limits::UNPROVED_OBSERVERS {
        assert!(bench.ask_from(peer(n), &request(1)).observed().is_some(), "number {n}");
    }
    assert!(bench.ask_from(early, &request(2)).observed().is_some());
}

/// Safety S9: news is sent without a request for an acknowledgement, and must not hide that an observer is gone.
#[test]
fn observers_that_acknowledge_nothing_give_way_also_while_everything_changes_and_they_ask_anew() {
    let mut bench = Bench::new();
    let asked_anew = Duration::from_secs(1);
    let mut since_asked = asked_anew;
    let mut came_in = None;
    for tenth in 0..400_u32 {
        if since_asked >= asked_anew && came_in.is_none() {
            since_asked = Duration::ZERO;
            for n in 0..limits::OBSERVERS {
                bench.ask_from(peer(n), &Message::get("/obs", 1 + (tenth & 0xFF) as u16).token(b"o").observe(0));
            }
            assert!(tenth > 0 || bench.endpoint.counts().observers == limits::OBSERVERS);
        }
        bench.change(|server| server.set("/obs", format!("seen {tenth}")));
        bench.wait(Duration::from_millis(100));
        bench.take();
        since_asked += Duration::from_millis(100);
        if tenth % 10 == 9 && came_in.is_none() {
            let request = Message::get("/obs", 1000 + tenth as u16).token(b"n").observe(0);
            came_in = bench.ask_from(peer(9_000), &request).observed().map(|_| tenth / 10);
        }
    }
    assert!(came_in.is_some_and(|second| second < 10), "{came_in:?}");
}
