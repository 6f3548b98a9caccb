//! Bytes come in pieces of any size: what comes of them is the same.

use bytes::BytesMut;
use proptest::prelude::*;
use std::time::Duration;

use super::scene::{OPERATOR, STOP, Scene, in_words, packets, publish, subscribe, taken, unsubscribe};
use crate::Ended;
use crate::filter;
use crate::frame::Kind;
use crate::packet::Qos;
use crate::packet::filters::Filters;

/// What came of a client's bytes.
#[derive(Debug, PartialEq)]
struct Outcome {
    ended: Option<Ended>,
    heard: Vec<String>,
    to_router: Vec<u8>,
    to_client: Vec<u8>,
}

/// Gives a connection these pieces, one after the other.
fn outcome<'a>(pieces: impl Iterator<Item = &'a [u8]>) -> Outcome {
    let mut scene = Scene::of(OPERATOR);
    let mut unread = BytesMut::new();
    let mut ended = None;
    for piece in pieces {
        unread.extend_from_slice(piece);
        ended = ended.or(scene.connection.handle_client(&mut unread, Duration::ZERO).err());
        if ended.is_some() {
            break;
        }
    }
    let heard = scene.heard();
    Outcome { ended, heard, to_router: scene.connection.to_router().to_vec(), to_client: taken(scene.connection.to_client()) }
}

fn packet() -> impl Strategy<Value = Vec<u8>> {
    let topic = prop::sample::select(vec!["a", "a/b", STOP, "é", "$SYS/a", "site/robot/event", "old/x", "#", ""]);
    let filter = prop::sample::select(vec!["a", "#", "a/+", "$SYS/#", "b#", "broker-pulse"]);
    let qos = prop::sample::select(vec![Qos::Zero, Qos::One, Qos::Two]);
    prop_oneof![
        8 => (topic, 0_u8..16, "[a-c]{0,200}", 0_u16..5)
            .prop_filter("QoS 3 cannot be written", |(_, flags, ..)| flags >> 1 & 3 != 3)
            .prop_map(|(topic, flags, payload, id)| publish(0x30 | flags, topic, &payload, id).to_vec()),
        2 => (1_u16..9, prop::collection::vec((filter.clone(), qos), 1..4)).prop_map(|(id, filters)| subscribe(id, &filters).to_vec()),
        1 => (1_u16..9, prop::collection::vec(filter, 1..4)).prop_map(|(id, filters)| unsubscribe(id, &filters).to_vec()),
        1 => prop::collection::vec(any::<u8>(), 0..8),
        2 => (prop::sample::select(vec![0x40, 0x50, 0x62, 0x70_u8]), 1_u8..5).prop_map(|(first, id)| vec![first, 2, 0, id]),
        1 => Just(vec![0xC0, 0]),
    ]
}

/// What may reach the router, and nothing else.
fn is_harmless(bytes: &[u8]) -> bool {
    in_words(bytes);
    packets(bytes).into_iter().all(|(kind, body)| {
        if kind == Kind::Publish {
            let length = usize::from(u16::from_be_bytes([body[0], body[1]]));
            return filter::topic(std::str::from_utf8(&body[2..2 + length]).unwrap()).is_ok();
        }
        if kind == Kind::Subscribe {
            return Filters::of_subscribe(body).unwrap().all(|(name, qos)| filter::filter(name).is_ok() && qos < Qos::Two);
        }
        if kind == Kind::Unsubscribe {
            return Filters::of_unsubscribe(body).unwrap().all(|(name, _)| filter::filter(name).is_ok());
        }
        kind == Kind::Pingreq
    })
}

proptest! {
    #[test]
    fn however_the_bytes_are_cut_the_outcome_is_the_same(
        script in prop::collection::vec(packet(), 0..30),
        cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..40),
    ) {
        let script = script.concat();
        let whole = outcome(std::iter::once(&script[..]));
        let mut cuts: Vec<usize> = cuts.iter().map(|cut| cut.index(script.len() + 1)).chain([0, script.len()]).collect();
        cuts.sort_unstable();
        prop_assert_eq!(&whole, &outcome(cuts.windows(2).map(|cut| &script[cut[0]..cut[1]])));
        prop_assert_eq!(&whole, &outcome(script.chunks(1)));
        prop_assert!(is_harmless(&whole.to_router));
    }
}
