//! Random missions over a connection that breaks at random times. A subscriber sees every number once or twice,
//! without a gap. It gets the last record of every piece.

use std::collections::BTreeMap;

use proptest::prelude::*;

use super::*;

#[derive(Clone, Debug)]
enum Happens {
    Step,
    Found(u64),
    Retaken(u64),
    Emptied,
    /// The feed may send this many messages.
    Sent(usize),
    /// The connection breaks while this many old messages are unacknowledged. The flag says whether these messages
    /// arrived.
    Broken(u64, bool),
}

fn happens() -> impl Strategy<Value = Happens> {
    prop_oneof![
        4 => Just(Happens::Step),
        2 => (1_u64..20).prop_map(Happens::Found),
        2 => (1_u64..20).prop_map(Happens::Retaken),
        1 => Just(Happens::Emptied),
        6 => (0_usize..12).prop_map(Happens::Sent),
        1 => (0_u64..6, any::<bool>()).prop_map(|(lost, arrived)| Happens::Broken(lost, arrived)),
    ]
}

fn record(content: &str) -> Option<(u64, String)> {
    let (_, rest) = content.split_once("photo ")?;
    let (id, rest) = rest.split_once(',')?;
    Some((id.parse().ok()?, rest.split_once("date: ")?.1.trim_end_matches(['\'', ')']).to_owned()))
}

proptest! {
    #[test]
    fn no_number_is_left_out_and_no_piece_either(story in prop::collection::vec(happens(), 1..120)) {
        let (mut feed, mut state) = (feed(), idle());
        let (mut heard, mut stands) = (Vec::<Publication>::new(), BTreeMap::new());
        feed.handle_state(Arc::new(state.clone()));
        for (now, event) in (0_u64..).step_by(7).zip(story) {
            let before = state.revision;
            match event {
                Happens::Step => step(&mut state),
                Happens::Found(id) | Happens::Retaken(id) => put(&mut state, found(id, i64::try_from(now).unwrap())),
                Happens::Emptied => {
                    state.luggage = Default::default();
                    let revision = state.revision.0 + 1;
                    touch(&mut state, revision, &[Resource::Luggage]);
                }
                Happens::Sent(most) => {
                    let sent = (0..most).map_while(|_| feed.poll_publication(ms(now)));
                    heard.extend(sent.filter(|publication| publication.topic == "unibo/qak/events"));
                }
                Happens::Broken(lost, arrived) => {
                    let lost = usize::try_from(lost).unwrap().min(heard.len());
                    feed.renew(lost.try_into().unwrap());
                    if !arrived {
                        heard.truncate(heard.len() - lost);
                    }
                }
            }
            stands.extend(state.luggage.iter().map(|piece| (piece.id.0, crate::api::time::rfc3339(piece.taken))));
            if state.revision != before {
                feed.handle_state(Arc::new(state.clone()));
            }
        }
        heard.extend((0..50).flat_map(|round| all(&mut feed, ms(10_000 + round * 20))));
        let mut last = 0;
        for number in numbers(&heard) {
            prop_assert!(number <= last + 1, "{number} follows {last}");
            last = number;
        }
        let records: BTreeMap<u64, String> = old(&heard).iter().filter_map(|content| record(content)).collect();
        prop_assert_eq!(records, stands);
    }
}
