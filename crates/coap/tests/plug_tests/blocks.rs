//! TD_COAP_BLOCK_01 to 06: bodies in blocks, both ways, with sizes named early and late.

use coap_endpoint::{Code, Method};

use crate::rig::bench::Bench;
use crate::rig::client::ask::Ask;
use crate::rig::client::exchange::Outcome;
use crate::rig::each_seed;
use crate::rig::message::{Message, option};
use crate::rig::network::Weather;
use crate::rig::scene::Scene;
use crate::rig::server::thing::long_body;

/// First message id for reading; those for writing begin with 0.
const READING: u16 = 20_000;

/// Reads a body in blocks and checks each; after the first answer it asks for blocks of the exponent `then`.
fn read(bench: &mut Bench, path: &str, first: Option<u8>, then: u8) -> Vec<u8> {
    let mut body = Vec::new();
    let mut tag = None;
    for turn in 0.. {
        let number = u32::try_from(body.len() >> (then + 4)).unwrap();
        let request = Message::get(path, READING + turn).token(&turn.to_be_bytes());
        let request = match (turn, first) {
            (0, None) => request,
            (0, Some(exponent)) => request.block2((0, false, exponent)),
            _ => request.block2((number, false, then)),
        };
        let answer = bench.ask(&request);
        answer.answers(&request, Code::CONTENT);
        let (got, more, exponent) = answer.block(option::BLOCK2).expect("each answer says which block it is");
        assert_eq!(usize::try_from(got).unwrap() << (exponent + 4), body.len(), "{answer:?}");
        assert!(turn == 0 || exponent == then, "the size that was asked for: {answer:?}");
        assert!(!more || answer.payload.len() == 16 << exponent, "{answer:?}");
        let its = answer.values(option::ETAG)[0].to_vec();
        assert_eq!(tag.get_or_insert(its.clone()), &its, "one body has one tag");
        body.extend_from_slice(&answer.payload);
        if !more {
            break;
        }
    }
    body
}

/// Writes a body in blocks and checks each answer, the last of which it returns.
fn write(bench: &mut Bench, method: Method, path: &str, body: &[u8], exponent: u8) -> Message {
    let blocks: Vec<&[u8]> = body.chunks(16 << exponent).collect();
    for (turn, block) in blocks.iter().enumerate() {
        let id = u16::try_from(turn).unwrap();
        let more = turn + 1 < blocks.len();
        let named = (u32::from(id), more, exponent);
        let request = Message::con(method, id).token(&id.to_be_bytes()).path(path).block1(named).payload(block);
        let answer = bench.ask(&request);
        assert_eq!(answer.block(option::BLOCK1), Some(named), "{answer:?}");
        if !more {
            return answer;
        }
        answer.answers(&request, Code::CONTINUE);
        assert_eq!((answer.payload.len(), bench.server.count(method, path)), (0, 0), "only a whole body is handed on");
    }
    unreachable!("a body has a last block")
}

#[test]
fn td_coap_block_01_get_early_negotiation() {
    for exponent in 0..=6 {
        assert_eq!(read(&mut Bench::new(), "/large", Some(exponent), exponent), long_body(1280), "exponent {exponent}");
    }
}

#[test]
fn td_coap_block_02_get_late_negotiation() {
    for exponent in 0..=6 {
        assert_eq!(read(&mut Bench::new(), "/large", None, exponent), long_body(1280), "exponent {exponent}");
    }
}

#[test]
fn td_coap_block_03_put_block1() {
    for exponent in 0..=6 {
        let mut bench = Bench::new();
        let body = long_body(1400);
        let last = write(&mut bench, Method::Put, "/large-update", &body, exponent);
        assert_eq!(last.code, Code::CHANGED);
        assert_eq!(bench.server.asked.len(), 1);
        assert_eq!(read(&mut bench, "/large-update", None, exponent), body);
    }
}

#[test]
fn td_coap_block_04_post_block1() {
    let mut bench = Bench::new();
    let body = long_body(1401);
    let last = write(&mut bench, Method::Post, "/large-create", &body, 6);
    assert_eq!((last.code, last.texts(option::LOCATION_PATH)), (Code::CREATED, vec!["large-create".into(), "1".into()]));
    assert_eq!(read(&mut bench, "/large-create/1", None, 6), body);
}

#[test]
fn td_coap_block_05_post_block1_and_block2() {
    for exponent in 0..=6 {
        let mut bench = Bench::new();
        let body = long_body(2000);
        let first = write(&mut bench, Method::Post, "/large-post", &body, exponent);
        assert_eq!(first.code, Code::CHANGED);
        let mut got = first.payload.clone();
        let (_, mut more, used) = first.block(option::BLOCK2).expect("the answer does not fit into one message");
        for id in 1000.. {
            if !more {
                break;
            }
            let number = u32::try_from(got.len() >> (used + 4)).unwrap();
            let request = Message::con(Method::Post, id).token(b"p").path("/large-post").block2((number, false, used));
            let answer = bench.ask(&request);
            answer.answers(&request, Code::CHANGED);
            assert_eq!(answer.block(option::BLOCK2).map(|(got, ..)| got), Some(number));
            more = answer.block(option::BLOCK2).unwrap().1;
            got.extend_from_slice(&answer.payload);
        }
        got.reverse();
        assert_eq!(got, body, "exponent {exponent}");
        assert_eq!(bench.server.count(Method::Post, "/large-post"), 1, "to read on is not to do it again");
    }
}

#[test]
fn td_coap_block_06_get_blocks_of_16_bytes() {
    let mut bench = Bench::new();
    assert_eq!(read(&mut bench, "/large", Some(0), 0), long_body(1280));
    assert_eq!(bench.server.asked.len(), 80);
}

#[test]
fn blocks_come_through_a_bad_network_whole_and_once() {
    each_seed(40, |seed| {
        let mut scene = Scene::new(seed, Weather::foul(0.1));
        let body = long_body(900 + usize::try_from(seed).unwrap() * 31);
        let put = scene.ask(Ask::of(Method::Put, "/large-update", &body).early(3));
        assert!(scene.bench.server.count(Method::Put, "/large-update") <= 1);
        let Outcome::Answered { code, .. } = put else { return };
        assert_eq!(code, Code::CHANGED);
        assert_eq!(scene.bench.server.asked[0].payload, body);
        if let Outcome::Answered { body: got, code, .. } = scene.ask(Ask::get("/large-update").late(2)) {
            assert_eq!((code, got), (Code::CONTENT, body));
        }
    });
}
