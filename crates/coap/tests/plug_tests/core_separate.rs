//! TD_COAP_CORE_09, 11, 16 and 17: answers that take longer than a client waits for an acknowledgement.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::time::Duration;

use coap_endpoint::{Code, Method};

use crate::rig::bench::{Bench, here};
use crate::rig::client::ask::Ask;
use crate::rig::client::exchange::Outcome;
use crate::rig::each_seed;
use crate::rig::message::{Kind, Message};
use crate::rig::network::Weather;
use crate::rig::scene::Scene;

/// An empty acknowledgement at once or soon, then a CON with the answer, which comes no more once it is acknowledged.
fn separate(token: &[u8]) {
    let mut bench = Bench::new();
    let request = Message::get("/separate", 0x0102).token(token);
    let began = bench.now;
    bench.deliver(here(), &request.encoded());
    bench.wait(Duration::from_millis(1999));
    let out = bench.take();
    assert_eq!(out.len(), 2, "{out:?}");
    assert_eq!(out[0].bytes, [0x60, 0, 1, 2], "an empty acknowledgement of four bytes");
    assert!(out[0].at - began < Duration::from_secs(2), "before the client asks again");
    let answer = Message::decoded(&out[1].bytes);
    assert_eq!((answer.kind, answer.code, answer.token.as_slice()), (Kind::Con, Code::CONTENT, token));
    assert_eq!(answer.text(), "it took long");
    assert!(bench.send(&Message::empty(Kind::Ack, answer.id)).is_empty());
    assert!(bench.wait_ms(300_000).is_empty(), "what was acknowledged is not sent again");
    assert_eq!(bench.server.asked.len(), 1);
}

#[test]
fn td_coap_core_09_separate_response() {
    separate(b"");
}

#[test]
fn td_coap_core_11_separate_response_with_a_token() {
    separate(b"eightbyt");
}

#[test]
fn td_coap_core_16_separate_response_lossy() {
    let answered = Cell::new(0);
    each_seed(100, |seed| answered.set(answered.get() + u32::from(lossy(seed))));
    assert!(answered.get() >= 90, "{} of 100 got their answer", answered.get());
}

/// One slow PUT over a network that loses three datagrams in ten. Returns whether the client got its answer.
fn lossy(seed: u64) -> bool {
    let mut scene = Scene::new(seed, Weather::foul(0.3));
    let outcome = scene.ask(Ask::of(Method::Put, "/separate", "once"));
    scene.wait(Duration::from_secs(120));
    let done = scene.bench.server.count(Method::Put, "/separate");
    assert!(done <= 1, "it was done {done} times");
    let cons = scene.clients[0].seen.iter().filter(|(_, message)| message.kind == Kind::Con);
    let ids: BTreeSet<u16> = cons.map(|(_, message)| message.id).collect();
    assert!(ids.len() <= 1, "the answer is repeated under one id: {ids:?}");
    match outcome {
        Outcome::Answered { code, body, .. } => {
            assert_eq!((code, body.as_slice(), done), (Code::CONTENT, &b"done at last"[..], 1));
            true
        }
        Outcome::Silence => false,
    }
}

#[test]
fn td_coap_core_17_separate_response_non() {
    let mut bench = Bench::new();
    let request = Message::non(Method::Get, 5).token(b"tk").path("/separate");
    assert!(bench.send(&request).is_empty(), "a NON is not acknowledged");
    let said = bench.wait_ms(300_000);
    assert_eq!(said.len(), 1, "{said:?}");
    assert_eq!((said[0].kind, said[0].code, said[0].token.as_slice()), (Kind::Non, Code::CONTENT, &b"tk"[..]));
    assert_eq!(said[0].text(), "it took long");
}
