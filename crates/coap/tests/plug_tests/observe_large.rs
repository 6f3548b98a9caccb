//! TD_COAP_OBS_13 and 14: observing what does not fit into one message.

use std::time::Duration;

use coap_endpoint::Code;

use crate::observe::observe;
use crate::rig::bench::Bench;
use crate::rig::client::ask::Ask;
use crate::rig::each_seed;
use crate::rig::message::{Message, option};
use crate::rig::network::Weather;
use crate::rig::scene::Scene;
use crate::rig::server::thing::long_body;

/// Reads the rest of a body whose first block came in this message.
fn rest(bench: &mut Bench, first: &Message, path: &str, id: u16) -> Vec<u8> {
    let mut body = first.payload.clone();
    let Some((_, mut more, exponent)) = first.block(option::BLOCK2) else { return body };
    for id in id.. {
        if !more {
            break;
        }
        let number = u32::try_from(body.len() >> (exponent + 4)).unwrap();
        let request = Message::get(path, id).token(b"rest").block2((number, false, exponent));
        let answer = bench.ask(&request);
        answer.answers(&request, Code::CONTENT);
        assert_eq!(answer.observed(), None, "only a notification has a number");
        assert_eq!(answer.values(option::ETAG), first.values(option::ETAG), "of the same state");
        more = answer.block(option::BLOCK2).unwrap().1;
        body.extend_from_slice(&answer.payload);
    }
    body
}

#[test]
fn td_coap_obs_13_large_resource() {
    for exponent in [6, 2] {
        let mut bench = Bench::new();
        let request = Message::get("/obs-large", 1).token(b"o13").observe(0).block2((0, false, exponent));
        let first = bench.ask(&request);
        first.answers(&request, Code::CONTENT);
        assert!(first.observed().is_some());
        assert_eq!(first.block(option::BLOCK2), Some((0, true, exponent)));
        assert_eq!(rest(&mut bench, &first, "/obs-large", 100), long_body(1280));
        let new: Vec<u8> = long_body(1280).into_iter().rev().collect();
        bench.change(|server| server.set("/obs-large", &new));
        let said = bench.wait_ms(100);
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(said[0].observed() > first.observed());
        assert_eq!(said[0].block(option::BLOCK2), Some((0, true, exponent)), "blocks of the size that was asked for");
        assert_eq!(rest(&mut bench, &said[0], "/obs-large", 200), new);
        assert_eq!(bench.endpoint.counts().observers, 1, "reading the rest ended nothing");
    }
}

#[test]
fn td_coap_obs_14_size_changing_round_the_block_limit() {
    let mut bench = Bench::new();
    let first = observe(&mut bench, "/obs-large", b"o14");
    rest(&mut bench, &first, "/obs-large", 900);
    for (turn, length) in [16, 1023, 1024, 1025, 2048, 2049, 1, 0, 5000, 1024].into_iter().enumerate() {
        let body = long_body(length);
        bench.change(|server| server.set("/obs-large", &body));
        let said = bench.wait_ms(100);
        assert_eq!(said.len(), 1, "{length}: {said:?}");
        assert!(said[0].payload.len() <= 1024);
        let more = said[0].block(option::BLOCK2).is_some_and(|(_, more, _)| more);
        assert_eq!(more, length > 1024, "{said:?}");
        let id = u16::try_from(1000 + turn * 100).unwrap();
        assert_eq!(rest(&mut bench, &said[0], "/obs-large", id), body);
    }
}

#[test]
fn an_observer_of_a_large_resource_holds_the_last_state_through_a_bad_network() {
    each_seed(30, |seed| {
        let mut scene = Scene::new(seed, Weather::foul(0.1));
        let token = scene.begin(Ask::observe("/obs-large"));
        for turn in 0..20 {
            scene.wait(Duration::from_millis(700));
            scene.change(|server| server.set("/obs-large", long_body(800 + turn * 100)));
        }
        scene.wait(Duration::from_secs(150));
        let held = scene.clients[0].held(&token).map(<[u8]>::to_vec);
        assert_eq!(held, Some(long_body(2700)), "{:?}", scene.clients[0].seen.last());
    });
}

/// The further blocks are of the state that was begun, however often it changed since, and no news comes while they are
/// read.
#[test]
fn a_large_notification_can_be_read_to_its_end_though_it_changes_all_the_time() {
    let mut bench = Bench::new();
    let mut last = observe(&mut bench, "/obs-large", b"o");
    for turn in 0..5 {
        bench.change(|server| server.set("/obs-large", vec![turn; 1280]));
        assert_eq!(bench.wait_ms(30), [], "it is still being read");
        let request = Message::get("/obs-large", 100 + u16::from(turn)).token(b"rest").block2((1, false, 6));
        let mut said = bench.send(&request);
        said.extend(bench.wait_ms(30));
        assert_eq!(said.len(), 2, "the last block, and what has become of it since: {said:?}");
        said[0].answers(&request, Code::CONTENT);
        assert_eq!(said[0].values(option::ETAG), last.values(option::ETAG), "of one state");
        assert_eq!((said[1].payload[0], said[1].payload.len()), (turn, 1024));
        last = said.remove(1);
    }
}

/// An observer that does not read on is told all the same.
#[test]
fn who_reads_only_first_blocks_is_told_what_is_new_after_a_second() {
    let mut bench = Bench::new();
    observe(&mut bench, "/obs-large", b"o");
    bench.change(|server| server.set("/obs-large", vec![1; 3000]));
    assert_eq!(bench.wait_ms(900).len(), 0);
    assert_eq!(bench.wait_ms(200).len(), 1);
}

/// Of several things, the further blocks are of the one whose first block came, not of the one that changed last.
#[test]
fn the_rest_of_one_of_several_things_is_its_own() {
    let mut bench = Bench::new();
    observe(&mut bench, "/model", b"m");
    bench.wait_ms(200);
    bench.change(|server| server.set_model(1, &"m".repeat(2000)));
    let map = bench.wait_ms(100).pop().expect("the map is told");
    assert_eq!(rest(&mut bench, &map, "/model", 100), "m".repeat(2000).into_bytes());
}
