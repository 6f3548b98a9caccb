//! Where a client says something urgent in what has come from it, before anything of that is judged: it is to be heard although much
//! stands before it, and whatever is wrong with it. No more of a packet is read than names it, in whatever pieces it comes; what is
//! wrong with packets is found in `frame`, `packet` and `connection`, later.

use super::frame::{Kind, Malformed, length};

/// So much of a packet is looked at when it comes in pieces, in bytes: what is urgent is named at its beginning, and is to be
/// no longer than half of this.
const LOOKED_AT: usize = 8 * 1024;

/// A PUBLISH, as far as it can be read at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PartialPublish<'a> {
    /// The bytes of its topic.
    pub topic: &'a [u8],
    /// What of its payload has come.
    pub payload: &'a [u8],
}

/// The search through all that one client sends after its CONNECT.
#[derive(Debug, Default)]
pub struct UrgentSearch {
    /// Where in the stream the packet under way begins.
    begins: u64,
    /// How it begins, when it is not there whole;
    beginning: Vec<u8>,
    /// and how much of it was looked at or passed over.
    seen: usize,
    is_found: bool,
    /// It cannot be said any more where packets begin.
    is_lost: bool,
    /// Whether MQTT 5 is spoken, in which properties stand before a payload.
    is_five: bool,
}

#[derive(Clone, Copy)]
struct Head {
    first: u8,
    head: usize,
    length: usize,
}

impl UrgentSearch {
    /// The same through what a client of MQTT 5 sends.
    #[must_use]
    pub fn for_mqtt5() -> UrgentSearch {
        UrgentSearch { is_five: true, ..UrgentSearch::default() }
    }

    /// Goes on with `bytes`, which follow those before, up to the next urgent message: where in the stream its packet begins. What was
    /// looked through is taken off `bytes`; `None` when nothing is left of them. `hear` is asked what is urgent, and so hears it.
    pub fn next(&mut self, bytes: &mut &[u8], mut hear: impl FnMut(PartialPublish<'_>) -> bool) -> Option<u64> {
        while !bytes.is_empty() && !self.is_lost {
            if self.seen == 0
                && let Ok(Some(head)) = Head::of(bytes)
                && head.length <= bytes.len()
            {
                let (packet, rest) = bytes.split_at(head.length);
                *bytes = rest;
                let begins = self.begins;
                self.begins += head.length as u64;
                if head.said(packet, self.is_five).any(&mut hear) {
                    return Some(begins);
                }
                continue;
            }
            if let Some(begins) = self.piece(bytes, &mut hear) {
                return Some(begins);
            }
        }
        if self.is_lost {
            *bytes = &[];
        }
        None
    }

    /// Takes a piece of a packet that is not there whole, and asks again when more of it has come.
    fn piece(&mut self, bytes: &mut &[u8], hear: &mut impl FnMut(PartialPublish<'_>) -> bool) -> Option<u64> {
        let wanted = match Head::of(&self.beginning) {
            Ok(Some(head)) => head.length,
            Ok(None) | Err(_) => self.beginning.len() + 1,
        };
        let (piece, rest) = bytes.split_at(bytes.len().min(wanted - self.seen));
        let room = LOOKED_AT.saturating_sub(self.beginning.len());
        self.beginning.extend_from_slice(&piece[..piece.len().min(room)]);
        self.seen += piece.len();
        *bytes = rest;
        let head = match Head::of(&self.beginning) {
            Ok(Some(head)) => head,
            Ok(None) => return None,
            Err(_) => {
                self.is_lost = true;
                return None;
            }
        };
        let (begins, is_whole) = (self.begins, self.seen >= head.length);
        let is_asked = !self.is_found && room > 0 && (is_whole || bytes.is_empty());
        let is_urgent = is_asked && head.said(&self.beginning, self.is_five).any(hear);
        self.is_found |= is_urgent;
        if is_whole {
            *self = UrgentSearch { begins: begins + head.length as u64, is_five: self.is_five, ..UrgentSearch::default() };
        }
        is_urgent.then_some(begins)
    }
}

impl Head {
    /// `None` when not enough has come; an error for a length that does not end, behind which nobody knows where the next packet begins.
    fn of(bytes: &[u8]) -> Result<Option<Head>, Malformed> {
        let Some((&first, rest)) = bytes.split_first() else { return Ok(None) };
        Ok(length(rest)?.map(|(body, bytes)| Head { first, head: 1 + bytes, length: 1 + bytes + body }))
    }

    /// What a PUBLISH says, when its topic has come, without the properties of MQTT 5 and, if that is spoken, with them.
    fn said(self, packet: &[u8], is_five: bool) -> impl Iterator<Item = PartialPublish<'_>> {
        let said = self.readings(packet).into_iter().flatten();
        said.flat_map(move |said| {
            let payload = if is_five { behind_properties(said.payload) } else { None };
            std::iter::once(said).chain(payload.map(|payload| PartialPublish { payload, ..said }))
        })
    }

    /// There is no QoS 3, so that nobody knows whether an id follows the topic then: both are tried.
    fn readings(self, packet: &[u8]) -> [Option<PartialPublish<'_>>; 2] {
        let nothing = [None, None];
        if self.first >> 4 != Kind::Publish as u8 {
            return nothing;
        }
        let Some((length, rest)) = packet.get(self.head..).and_then(|body| body.split_first_chunk::<2>()) else { return nothing };
        let Some((topic, rest)) = rest.split_at_checked(usize::from(u16::from_be_bytes(*length))) else { return nothing };
        let without_id = Some(PartialPublish { topic, payload: rest });
        let with_id = Some(PartialPublish { topic, payload: rest.get(2..).unwrap_or_default() });
        match self.first >> 1 & 3 {
            0 => [without_id, None],
            1 | 2 => [with_id, None],
            _ => [with_id, without_id],
        }
    }
}

/// What follows the properties at the head of this (MQTT 5, section 3.3.2.3).
fn behind_properties(bytes: &[u8]) -> Option<&[u8]> {
    let (properties, own) = length(bytes).ok()??;
    bytes.get(own + properties..)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A packet with this first byte.
    fn packet(first: u8, body: &[u8]) -> Vec<u8> {
        let length = body.len();
        let low = |length: usize| u8::try_from(length & 0x7F).unwrap();
        let head =
            if length < 128 { vec![low(length)] } else { vec![low(length) | 0x80, low(length >> 7) | 0x80, low(length >> 14)] };
        [&[first], &head[..], body].concat()
    }

    fn publish(first: u8, topic: &str, rest: &[u8]) -> Vec<u8> {
        let length = u16::try_from(topic.len()).unwrap();
        packet(first, &[&length.to_be_bytes(), topic.as_bytes(), rest].concat())
    }

    /// On `stop` everything is urgent, and on `word` what begins so.
    fn is_urgent(said: PartialPublish<'_>) -> bool {
        said.topic == b"stop" || said.topic == b"word" && said.payload.starts_with(b"stop")
    }

    /// Where a search finds urgent messages in these pieces.
    fn found<'a>(search: &mut UrgentSearch, pieces: impl IntoIterator<Item = &'a [u8]>) -> Vec<u64> {
        let mut found = Vec::new();
        for mut piece in pieces {
            while let Some(begins) = search.next(&mut piece, is_urgent) {
                found.push(begins);
            }
            assert!(piece.is_empty());
        }
        found
    }

    fn any_packet() -> impl Strategy<Value = (Vec<u8>, bool)> {
        let body = || prop::collection::vec(any::<u8>(), 0..300);
        prop_oneof![
            3 => (0x30_u8..0x40, body()).prop_map(|(first, rest)| (publish(first, "stop", &rest), true)),
            2 => (body(), any::<bool>()).prop_map(|(rest, id)| {
                let (first, id): (u8, &[u8]) = if id { (0x32, &[0, 7]) } else { (0x31, &[]) };
                (publish(first, "word", &[id, b"stop", &rest].concat()), true)
            }),
            3 => (0x30_u8..0x40, body()).prop_map(|(first, rest)| (publish(first, "other", &rest), false)),
            3 => (0x00_u8..0x30, body()).prop_map(|(first, body)| (packet(first, &body), false)),
            1 => (0x40_u8.., body()).prop_map(|(first, body)| (packet(first, &body), false)),
            1 => Just((publish(0x30, "other", &[7; 2 * LOOKED_AT]), false)),
        ]
    }

    proptest! {
        /// Whatever comes before it, and in whatever pieces.
        #[test]
        fn every_urgent_message_is_found_once_and_where_it_begins(
            packets in prop::collection::vec(any_packet(), 1..8),
            cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..8),
        ) {
            let (mut stream, mut expected) = (Vec::new(), Vec::new());
            for (packet, is_urgent) in &packets {
                expected.extend(is_urgent.then_some(stream.len() as u64));
                stream.extend_from_slice(packet);
            }
            let mut cuts: Vec<usize> = cuts.iter().map(|cut| cut.index(stream.len() + 1)).chain([0, stream.len()]).collect();
            cuts.sort_unstable();
            prop_assert_eq!(&found(&mut UrgentSearch::default(), [&stream[..]]), &expected);
            prop_assert_eq!(&found(&mut UrgentSearch::default(), cuts.windows(2).map(|cut| &stream[cut[0]..cut[1]])), &expected);
            prop_assert_eq!(&found(&mut UrgentSearch::default(), stream.chunks(1)), &expected);
        }

        #[test]
        fn whatever_comes_is_borne(stream in prop::collection::vec(any::<u8>(), 0..600), piece in 1_usize..50) {
            found(&mut UrgentSearch::default(), stream.chunks(piece));
        }
    }

    /// The rest need never come.
    #[test]
    fn an_urgent_message_is_found_as_soon_as_its_topic_has_come() {
        let mut search = UrgentSearch::default();
        let stop = publish(0x30, "stop", &[7; 100]);
        assert!(found(&mut search, [&stop[..7]]).is_empty());
        assert_eq!(found(&mut search, [&stop[7..8]]), [0]);
        assert_eq!(
            found(&mut search, [&stop[8..], &stop[..8]]),
            [stop.len() as u64],
            "the next one, too, and the first not again"
        );
    }

    /// A length that no packet may have, and an urgent message before a packet of which nobody knows where it ends.
    #[test]
    fn an_urgent_message_that_is_too_long_is_found_and_one_before_nonsense() {
        let too_long = [&[0x30, 0xFF, 0xFF, 0xFF, 0x7F, 0, 4][..], b"stop"].concat();
        assert_eq!(found(&mut UrgentSearch::default(), [&too_long[..]]), [0]);
        let mut search = UrgentSearch::default();
        let stop = publish(0x30, "stop", &[]);
        assert_eq!(found(&mut search, [&[&stop[..], &[0x30, 0x80, 0x80, 0x80, 0x80]].concat()[..]]), [0]);
        assert!(found(&mut search, [&stop[..]]).is_empty(), "nobody knows where it begins");
    }

    /// In MQTT 5 properties stand before the payload.
    #[test]
    fn a_word_is_found_behind_the_properties_of_mqtt_5_when_that_is_spoken() {
        let plain = publish(0x30, "word", b"\0stop");
        let more = publish(0x32, "word", &[&[0, 7, 5, 1, 1, 2, 0, 60][..], b"stop"].concat());
        let long = publish(0x30, "word", &[&[0x80, 1][..], &[7; 128], b"stop"].concat());
        let all = [&plain[..], &more, &long, &publish(0x30, "word", b"stop"), &publish(0x30, "word", &[0x80; 5])].concat();
        let places = vec![0, plain.len(), plain.len() + more.len(), plain.len() + more.len() + long.len()];
        let places: Vec<u64> = places.into_iter().map(|place| place as u64).collect();
        assert_eq!(found(&mut UrgentSearch::for_mqtt5(), [&all[..]]), places);
        assert_eq!(found(&mut UrgentSearch::for_mqtt5(), all.chunks(3)), places);
        assert_eq!(found(&mut UrgentSearch::default(), [&all[..]]), places[3..], "in MQTT 3.1.1 there are none");
    }
}
