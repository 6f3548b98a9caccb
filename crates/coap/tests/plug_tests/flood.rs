//! Floods: which datagrams are handled first, which wait, and which are lost. Real sockets and times are not here.

use std::net::SocketAddr;

use coap_endpoint::{Backlog, Code, Method, Request};

use crate::rig::bench::{Bench, here, stranger};
use crate::rig::message::{Kind, Message, option};

type Flood = (u16, fn(u16) -> Vec<u8>);

fn flooder(n: u16) -> SocketAddr {
    SocketAddr::from(([127, 0, 0, 2], 10_000 + n))
}

fn is_urgent(request: &Request) -> bool {
    request.peer.ip().is_loopback() && !request.method.is_safe() && request.path == ["stop"]
}

fn bench() -> Bench {
    let mut bench = Bench::new();
    bench.endpoint =
        std::mem::replace(&mut bench.endpoint, Bench::seeded(2).endpoint).with_urgent(is_urgent, "it took effect all the same");
    bench.backlog = Backlog::new(is_urgent);
    bench
}

fn asked(bench: &Bench) -> Vec<String> {
    bench.server.asked.iter().map(|request| format!("{} {}", request.method.name(), request.path_text())).collect()
}

#[test]
fn an_urgent_request_behind_thousands_of_reads_is_acted_on_before_any_of_them_is_answered() {
    let stop = || Message::con(Method::Post, 1).path("/stop");
    let half = [stop().encoded(), b"\xF0".to_vec()].concat();
    let long_token = [b"\x4F\x02\x00\x01".to_vec(), stop().encoded()[4..].to_vec()].concat();
    let refused = stop().with(65_001, b"").encoded();
    for stop in [stop().encoded(), Message { kind: Kind::Non, ..stop() }.encoded(), refused, half, long_token] {
        let mut bench = bench();
        for id in 0..10_000 {
            bench.hear(flooder(id % 3), &Message::get("/test", id).encoded());
        }
        bench.hear(flooder(1), &stop);
        bench.take_turn();
        assert_eq!(asked(&bench), ["POST /stop"], "{stop:02x?}");
        bench.catch_up();
        assert!(bench.server.count(Method::Get, "/test") > 5_000, "many are answered afterwards");
        assert_eq!(bench.server.count(Method::Post, "/stop"), 1);
    }
}

/// Its options and payload may be as long as a datagram holds.
#[test]
fn an_urgent_request_as_long_as_a_datagram_can_be_is_acted_on_in_a_flood() {
    let mut bench = bench();
    (0..10_000).for_each(|id| bench.hear(flooder(id % 3), &Message::get("/test", id).encoded()));
    let mut stop = Message::con(Method::Post, 1).path("/stop").payload([b'x'; 65_507]).encoded();
    stop.truncate(65_507);
    bench.hear(here(), &stop);
    bench.take_turn();
    assert_eq!(asked(&bench), ["POST /stop"]);
}

/// A command that came before could otherwise undo the effect of the urgent request.
#[test]
fn commands_that_came_before_an_urgent_request_are_taken_before_it_and_those_that_came_after_it_later() {
    let mut bench = bench();
    let put = |path: &str, id| Message::con(Method::Put, id).path(path).payload("x").encoded();
    for (n, path) in ["/test", "/create1", "/create2"].iter().enumerate() {
        let id = u16::try_from(n).unwrap();
        (0..40).for_each(|more| bench.hear(flooder(id), &put(path, more)));
    }
    bench.hear(here(), &Message::con(Method::Post, 1).path("/stop").encoded());
    bench.hear(here(), &put("/create3", 2));
    bench.hear(here(), &Message::get("/test", 3).encoded());
    bench.catch_up();
    assert_eq!(asked(&bench)[120..], ["POST /stop", "PUT /create3", "GET /test"]);
}

/// Nobody delays another's urgent request with his own, and a command goes before one only if it came before it.
#[test]
fn a_flood_of_urgent_requests_loses_its_own_and_no_command_overtakes_one_that_waits() {
    let mut bench = bench();
    let stop = |id| Message::con(Method::Post, id).path("/stop").encoded();
    for id in 0..10_000 {
        bench.hear(flooder(id), &stop(id));
    }
    bench.hear(here(), &Message::con(Method::Put, 1).path("/create1").payload("x").encoded());
    bench.hear(here(), &stop(2));
    bench.hear(here(), &Message::con(Method::Put, 3).path("/create2").payload("x").encoded());
    bench.catch_up();
    let asked = asked(&bench);
    assert_eq!((asked[0].as_str(), asked[asked.len() - 1].as_str()), ("PUT /create1", "PUT /create2"));
    assert!(bench.server.asked[1..4].iter().any(|request| request.peer == here()), "its turn comes");
    assert!((300..1_000).contains(&asked.len()), "{} of them are kept", asked.len());
}

/// The waiting urgent requests take effect in place of one that is dropped.
#[test]
fn no_command_that_came_before_an_urgent_request_without_room_acts_later_than_those_that_wait() {
    let mut bench = bench();
    let stop = |id| Message::con(Method::Post, id).path("/stop").encoded();
    let put = |path: &str, id| Message::con(Method::Put, id).path(path).payload("x").encoded();
    (0..10_000).for_each(|id| bench.hear(here(), &stop(id)));
    bench.hear(here(), &put("/create1", 10_001));
    bench.hear(here(), &stop(10_002));
    bench.hear(here(), &put("/create2", 10_003));
    bench.catch_up();
    let asked = asked(&bench);
    assert!((100..10_000).contains(&(asked.len() - 2)), "not all of them have room: {}", asked.len());
    assert_eq!((asked[0].as_str(), asked[asked.len() - 1].as_str()), ("PUT /create1", "PUT /create2"));
    assert!(asked[1..asked.len() - 1].iter().all(|asked| asked == "POST /stop"));
}

#[test]
fn what_is_not_urgent_waits_for_its_turn() {
    let mut bench = bench();
    let put = |path: &str, id| Message::con(Method::Put, id).path(path).payload("x").encoded();
    bench.hear(here(), &put("/create1", 1));
    bench.hear(here(), &put("/create2", 2));
    bench.hear(stranger(), &Message::con(Method::Post, 3).path("/stop").encoded());
    bench.catch_up();
    assert_eq!(asked(&bench), ["PUT /create1", "POST /stop", "PUT /create2"]);

    let of_another_version = [b"\x80\x02".to_vec(), Message::con(Method::Post, 5).path("/stop").encoded()[2..].to_vec()].concat();
    bench.hear(here(), &of_another_version);
    assert!(bench.backlog.is_empty(), "it is nothing");
    bench.server.asked.clear();
    bench.hear(here(), &Message::get("/test", 6).encoded());
    for (id, method) in [(7, Method::Get), (8, Method::Fetch)] {
        bench.hear(here(), &Message::con(method, id).path("/stop").encoded());
    }
    bench.catch_up();
    assert_eq!(asked(&bench), ["GET /test", "GET /stop", "FETCH /stop"]);
}

#[test]
fn whatever_peers_flood_the_request_of_another_has_its_turn() {
    let floods: [Flood; 6] = [
        (8_000, |id| Message::get("/large", id).encoded()),
        (8_000, |id| [&[0x4F, 0x01, id.to_be_bytes()[0], id.to_be_bytes()[1]][..], &[0xFF; 60]].concat()),
        (8_000, |id| Message::empty(Kind::Con, id).encoded()),
        (2_000, |id| Message::con(Method::Put, id).path("/test").with(65_001, b"").encoded()),
        (500, |id| Message::con(Method::Put, id).path("/test").payload([b'x'; 900]).encoded()),
        (10, |id| Message::con(Method::Put, id).path("/test").payload(vec![b'x'; 40_000]).encoded()),
    ];
    let neighbour = |n| SocketAddr::new(here().ip(), 10_000 + n);
    for (n, (datagrams, flood)) in floods.into_iter().enumerate() {
        for (from, peers) in [flooder, neighbour].into_iter().flat_map(|from| [1, 2, 8].map(|peers| (from, peers))) {
            let mut bench = bench();
            for id in 0..datagrams {
                bench.hear(from(id % peers), &flood(id));
            }
            let (look, command) = (Message::get("/test", 1), Message::con(Method::Put, 2).path("/create1").payload("x"));
            bench.hear(here(), &look.encoded());
            bench.hear(here(), &command.encoded());
            for _ in 0..3 * (peers + 1) {
                bench.take_turn();
            }
            let mut said = bench.said_to(here());
            said.sort_by_key(|answer| answer.id);
            assert_eq!(said.len(), 2, "flood {n} of {peers}: {said:?}");
            said[0].answers(&look, Code::CONTENT);
            said[1].answers(&command, Code::CREATED);
        }
    }
}

/// The ports of one address, or the addresses of one IPv6 network.
#[test]
fn a_crowd_of_ports_of_one_address_does_not_push_out_the_request_of_another() {
    let crowds: [fn(u16) -> SocketAddr; 2] = [flooder, |n| SocketAddr::from(([0x2001, 0xdb8, 0, 0, n, 0, 0, 1], 5683))];
    for crowd in crowds {
        let mut bench = bench();
        for n in 0..20_000 {
            bench.hear(crowd(n), &Message::con(Method::Put, n).path("/test").payload("x").encoded());
            bench.hear(crowd(n), &Message::get("/test", n).encoded());
        }
        let (look, command) = (Message::get("/test", 1), Message::con(Method::Put, 2).path("/create1").payload("x"));
        for message in [&look, &command] {
            bench.hear(here(), &message.encoded());
        }
        (0..6).for_each(|_| bench.take_turn());
        assert_eq!(bench.said_to(here()).len(), 2);
    }
}

#[test]
fn whoever_does_not_flood_loses_nothing_and_is_answered_in_order() {
    let mut bench = bench();
    for id in 0..500 {
        bench.hear(here(), &Message::get("/test", id).encoded());
    }
    assert_eq!(bench.catch_up(), 500);
    let ids: Vec<u16> = bench.said_to(here()).iter().map(|answer| answer.id).collect();
    assert!(ids.iter().copied().eq(0..500), "{ids:?}");
}

#[test]
fn acknowledgements_and_rejections_wait_behind_no_request() {
    let mut bench = bench();
    let first = bench.ask(&Message::get("/obs", 1).token(b"o").observe(0));
    assert!(first.observed().is_some());
    bench.change(|server| server.set("/obs", "another"));
    let told = bench.wait_ms(30);
    let id = told.last().expect("observers are told").id;
    for id in 0..1_000 {
        bench.hear(here(), &Message::get("/test", id).encoded());
        bench.hear(here(), &Message::con(Method::Put, 1_000 + id).path("/test").payload("x").encoded());
    }
    bench.hear(here(), &Message::empty(Kind::Rst, id).encoded());
    (0..3).for_each(|_| bench.take_turn());
    assert!(!bench.backlog.is_empty());
    assert_eq!(bench.endpoint.counts().observers, 0);
}

#[test]
fn every_command_that_an_urgent_request_overtakes_in_a_flood_is_noted_when_it_is_refused() {
    let mut bench = bench();
    for id in 0..300 {
        bench.hear(flooder(id % 30), &Message::con(Method::Put, id).path("/test").with(option::PROXY_URI, b"coap://x").encoded());
    }
    bench.hear(here(), &Message::con(Method::Post, 1).path("/stop").encoded());
    (0..301).for_each(|_| bench.take_turn());
    assert_eq!(asked(&bench), ["POST /stop"]);
    assert_eq!(std::iter::from_fn(|| bench.endpoint.poll_refused()).count(), 300);
}
