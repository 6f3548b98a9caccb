//! Tests that the result does not depend on the pieces in which a client's bytes arrive.

use bytes::BytesMut;
use proptest::prelude::*;
use std::time::Duration;

use super::scene::{OPERATOR, STOP, Scene, in_words, publish, subscribe, taken, unsubscribe};
use crate::Ended;
use crate::packet::Qos;

#[derive(Debug, PartialEq)]
struct Outcome {
    ended: Option<Ended>,
    heard: Vec<String>,
    to_others: Vec<String>,
    /// The messages and the answers to the client, in two lists, because the order of a message and an answer does
    /// not matter.
    to_client: (Vec<String>, Vec<String>),
}

fn outcome<'a>(pieces: impl Iterator<Item = &'a [u8]>) -> Outcome {
    let mut scene = Scene::of(OPERATOR);
    let mut everybody = scene.everybody();
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
    scene.connection.handle_come(scene.now);
    let to_client = in_words(&taken(scene.connection.to_client()));
    let to_client = to_client.into_iter().partition(|words| words.starts_with("Publish"));
    Outcome { ended, heard, to_others: everybody.got(), to_client }
}

fn packet() -> impl Strategy<Value = Vec<u8>> {
    let topic = prop::sample::select(vec!["a", "a/b", STOP, "é", "$SYS/a", "site/robot/event", "old/x", "#", ""]);
    let filter = prop::sample::select(vec!["a", "#", "a/+", "$SYS/#", "b#"]);
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
    }
}
