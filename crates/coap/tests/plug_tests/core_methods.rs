//! TD_COAP_CORE_01 to 08, 10, 12, 13, 15 and 31: methods as CON and as NON, tokens, paths, loss, ping.

use std::cell::Cell;
use std::collections::BTreeSet;

use coap_endpoint::{Code, Method};

use crate::rig::bench::Bench;
use crate::rig::client::ask::Ask;
use crate::rig::client::exchange::Outcome;
use crate::rig::each_seed;
use crate::rig::message::{Kind, Message, option};
use crate::rig::network::Weather;
use crate::rig::scene::Scene;

fn request(method: Method, id: u16) -> Message {
    let message = Message::con(method, id).token(b"tk").path("/test");
    match method {
        Method::Put | Method::Post => message.number(option::CONTENT_FORMAT, 0).payload("new text"),
        _ => message,
    }
}

/// CON: the acknowledgement carries the answer, and the application was asked once and exactly this.
fn con(method: Method, code: Code) -> Message {
    let mut bench = Bench::new();
    let request = request(method, 0x1234);
    let answer = bench.ask(&request);
    answer.answers(&request, code);
    let asked = &bench.server.asked;
    assert_eq!((asked.len(), asked[0].method, asked[0].path_text().as_str()), (1, method, "/test"));
    assert_eq!(asked[0].payload, request.payload);
    assert!(bench.wait_ms(300_000).is_empty(), "nothing follows");
    answer
}

/// NON: the answer is a NON with an id of the endpoint's own, and the token of the request.
fn non(method: Method, code: Code) -> Message {
    let mut bench = Bench::new();
    let mut ids = BTreeSet::new();
    let mut last = None;
    for id in [7, 30_000, 65_535] {
        let answer = bench.ask(&Message { kind: Kind::Non, ..request(method, id) }.token(&id.to_be_bytes()));
        assert_eq!((answer.kind, answer.code, answer.token.as_slice()), (Kind::Non, code, &id.to_be_bytes()[..]));
        ids.insert(answer.id);
        last.get_or_insert(answer);
    }
    assert_eq!(ids.len(), 3, "each answer has an id of its own");
    assert_ne!(ids, BTreeSet::from([7, 30_000, 65_535]), "which is not the request's");
    assert!(bench.wait_ms(300_000).is_empty(), "nothing follows");
    last.unwrap()
}

#[test]
fn td_coap_core_01_get_con() {
    let answer = con(Method::Get, Code::CONTENT);
    assert_eq!((answer.text().as_str(), answer.value(option::CONTENT_FORMAT)), ("a test", Some(0)));
}

#[test]
fn td_coap_core_02_delete_con() {
    assert_eq!(con(Method::Delete, Code::DELETED).text(), "");
}

#[test]
fn td_coap_core_03_put_con() {
    assert_eq!(con(Method::Put, Code::CHANGED).text(), "");
}

#[test]
fn td_coap_core_04_post_con() {
    con(Method::Post, Code::CREATED);
}

#[test]
fn td_coap_core_05_get_non() {
    let answer = non(Method::Get, Code::CONTENT);
    assert_eq!((answer.text().as_str(), answer.value(option::CONTENT_FORMAT)), ("a test", Some(0)));
}

#[test]
fn td_coap_core_06_delete_non() {
    assert_eq!(non(Method::Delete, Code::DELETED).text(), "");
}

#[test]
fn td_coap_core_07_put_non() {
    assert_eq!(non(Method::Put, Code::CHANGED).text(), "");
}

#[test]
fn td_coap_core_08_post_non() {
    non(Method::Post, Code::CREATED);
}

#[test]
fn td_coap_core_10_get_with_a_token() {
    for length in 1..=8 {
        let token: Vec<u8> = (0..length).map(|n| 0xF0 | n).collect();
        let request = Message::get("/test", 9).token(&token);
        Bench::new().ask(&request).answers(&request, Code::CONTENT);
    }
}

#[test]
fn td_coap_core_12_get_with_an_empty_token() {
    let request = Message::get("/test", 9);
    Bench::new().ask(&request).answers(&request, Code::CONTENT);
}

#[test]
fn td_coap_core_13_several_uri_path_options() {
    let mut bench = Bench::new();
    let request = Message::get("/seg1/seg2/seg3", 1).token(b"t");
    assert_eq!(request.values(option::URI_PATH).len(), 3);
    let answer = bench.ask(&request);
    answer.answers(&request, Code::CONTENT);
    assert_eq!((answer.text().as_str(), answer.value(option::CONTENT_FORMAT)), ("three segments", Some(0)));
    assert_eq!(bench.server.asked[0].path, ["seg1", "seg2", "seg3"]);
}

/// Sends a request over a network that loses, duplicates and reorders. Returns the outcome, how often it was carried
/// out, and the different answers.
fn lossy(seed: u64, ask: Ask) -> (Outcome, usize, BTreeSet<Vec<u8>>) {
    let (method, path) = (ask.method, ask.path.clone());
    let mut scene = Scene::new(seed, Weather::foul(0.3));
    let outcome = scene.ask(ask);
    let ids: BTreeSet<u16> = scene.clients[0].sent.iter().map(|(_, message)| message.id).collect();
    assert_eq!(ids.len(), 1, "the client repeats under the same id");
    let answers = scene.clients[0].seen.iter().map(|(_, message)| message.encoded()).collect();
    (outcome, scene.bench.server.count(method, &path), answers)
}

#[test]
fn td_coap_core_15_get_con_lossy() {
    let answered = Cell::new(0);
    each_seed(200, |seed| {
        let (outcome, _, answers) = lossy(seed, Ask::get("/test"));
        if let Outcome::Answered { code, body, .. } = outcome {
            assert_eq!((code, String::from_utf8_lossy(&body).as_ref()), (Code::CONTENT, "a test"));
            answered.set(answered.get() + 1);
        }
        assert!(answers.len() <= 1, "each copy of the answer is the same: {answers:?}");
    });
    assert!(answered.get() > 150, "four repetitions arrive nearly always: {answered:?}");
}

#[test]
fn what_is_repeated_over_a_bad_network_is_done_once() {
    each_seed(200, |seed| {
        let (outcome, done, answers) = lossy(seed, Ask::of(Method::Put, "/test", "once"));
        if let Outcome::Answered { code, .. } = outcome {
            assert_eq!((code, done), (Code::CHANGED, 1));
        }
        assert!(done <= 1, "a repeated message has no second effect, but it was done {done} times");
        assert!(answers.len() <= 1, "each copy of the answer is the same: {answers:?}");
    });
}

#[test]
fn td_coap_core_31_ping() {
    let mut bench = Bench::new();
    bench.deliver(crate::rig::bench::here(), &[0x40, 0, 0xAB, 0xCD]);
    let said = bench.take();
    assert_eq!(said.len(), 1);
    assert_eq!(said[0].bytes, [0x70, 0, 0xAB, 0xCD], "a RST of four bytes with the same id");
    assert!(bench.server.asked.is_empty());
}
