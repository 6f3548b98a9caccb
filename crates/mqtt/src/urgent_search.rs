//! Finds urgent messages in a client's bytes before anything else is read or checked. They are found after any amount
//! of other data, and even in malformed packets. Only the part of a packet that names the command has to arrive, and
//! it may arrive in any pieces. `frame`, `packet` and `connection` find errors in packets later.

use std::collections::HashMap;

use super::connection::{AnswerTo, Said};
use super::frame::{Malformed, PacketKind, length};
use super::limits::{ALIASES, PROPERTIES, TOPIC};
use super::packet::properties::Property;
use super::packet::{PacketFields, Version};

/// Number of bytes searched in a packet that arrives in pieces. An urgent payload is at most a few KiB long. It
/// begins right after the topic and the properties of MQTT 5.
const LOOKED_AT: usize = 8 * 1024 + PROPERTIES;

/// An incomplete packet is searched again when it has grown by 1/`MORE` since the last search.
const MORE: usize = 16;

/// Topics by their aliases. The bytes may not be valid text.
type Aliases = HashMap<u16, Box<[u8]>>;

/// The search through all bytes that one client sends after its CONNECT.
#[derive(Debug, Default)]
pub struct UrgentSearch {
    /// Where the current packet begins, in bytes since the CONNECT.
    begins: u64,
    /// The beginning of the current packet while it is incomplete.
    beginning: Vec<u8>,
    /// Number of bytes of the current packet that were searched or skipped.
    seen: usize,
    /// Length of `beginning` when the listener was last asked.
    asked: usize,
    is_found: bool,
    /// Set when it is no longer known where packets end.
    is_lost: bool,
    /// Topic aliases in MQTT 5; `None` in MQTT 3.1.1.
    aliases: Option<Aliases>,
}

#[derive(Clone, Copy)]
struct Head {
    first: u8,
    head: usize,
    length: usize,
}

impl UrgentSearch {
    /// A search from the first byte after the CONNECT. The version says whether packets have properties and aliases.
    #[must_use]
    pub fn new(version: Version) -> UrgentSearch {
        UrgentSearch { aliases: (version == Version::Five).then(Aliases::new), ..UrgentSearch::default() }
    }

    /// Searches `bytes`, which follow the bytes of the last call, up to the next urgent message. Returns where in the
    /// stream the packet of that message begins, or `None` when all bytes were searched. Searched bytes are removed
    /// from `bytes`. `hear` decides which messages are urgent, and acts on them.
    pub fn next(&mut self, bytes: &mut &[u8], mut hear: impl FnMut(Said<'_>) -> bool) -> Option<u64> {
        while !bytes.is_empty() && !self.is_lost {
            if self.seen == 0
                && let Ok(Some(head)) = Head::of(bytes)
                && head.length <= bytes.len()
            {
                let (packet, rest) = bytes.split_at(head.length);
                *bytes = rest;
                let begins = self.begins;
                self.begins += head.length as u64;
                let is_urgent = head.is_urgent(packet, self.aliases.as_ref(), &mut hear);
                head.learn(packet, self.aliases.as_mut());
                if is_urgent {
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

    /// Takes a piece of an incomplete packet, and asks `hear` again when the packet has grown enough.
    fn piece(&mut self, bytes: &mut &[u8], hear: &mut impl FnMut(Said<'_>) -> bool) -> Option<u64> {
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
        // Asking at each byte would take quadratic time for a long packet.
        let has_grown = self.beginning.len() >= self.asked + (self.asked / MORE).max(1) || self.asked < TOPIC * 2;
        let is_asked = !self.is_found && room > 0 && (is_whole || bytes.is_empty() && has_grown);
        if is_asked {
            self.asked = self.beginning.len();
        }
        let is_urgent = is_asked && head.is_urgent(&self.beginning, self.aliases.as_ref(), hear);
        self.is_found |= is_urgent;
        if is_whole {
            head.learn(&self.beginning, self.aliases.as_mut());
            let aliases = self.aliases.take();
            *self = UrgentSearch { begins: begins + head.length as u64, aliases, ..UrgentSearch::default() };
        }
        is_urgent.then_some(begins)
    }
}

impl Head {
    /// The head of a packet; `None` if too little has arrived. An error if the length field does not end: the
    /// beginning of the next packet is then unknown.
    fn of(bytes: &[u8]) -> Result<Option<Head>, Malformed> {
        let Some((&first, rest)) = bytes.split_first() else { return Ok(None) };
        Ok(length(rest)?.map(|(body, bytes)| Head { first, head: 1 + bytes, length: 1 + bytes + body }))
    }

    /// Whether a PUBLISH is urgent, once its topic has arrived. Two readings are tried: without properties and, in
    /// MQTT 5, also with properties.
    fn is_urgent(self, packet: &[u8], aliases: Option<&Aliases>, hear: &mut impl FnMut(Said<'_>) -> bool) -> bool {
        self.readings(packet).into_iter().flatten().any(|(topic, rest)| {
            let plain = Said { topic, payload: rest, answer_to: None };
            let Some(aliases) = aliases else { return hear(plain) };
            let five = Five::read(rest);
            let named = five.aliases().filter(|_| topic.is_empty()).filter_map(|alias| aliases.get(&alias));
            named.map(|named| &**named).chain([topic]).any(|topic| {
                five.payload.is_some_and(|payload| hear(Said { topic, payload, answer_to: five.answer_to }))
                    || hear(Said { topic, ..plain })
            })
        })
    }

    /// Stores the topic aliases that a PUBLISH sets in any possible reading.
    fn learn(self, packet: &[u8], aliases: Option<&mut Aliases>) {
        let Some(aliases) = aliases else { return };
        for (topic, rest) in self.readings(packet).into_iter().flatten().filter(|(topic, _)| !topic.is_empty()) {
            for alias in Five::read(rest).aliases() {
                aliases.remove(&alias);
                if topic.len() <= TOPIC {
                    aliases.insert(alias, topic.into());
                }
            }
        }
    }

    /// The topic of a PUBLISH and the bytes after it, in each possible reading. A QoS of 3 is invalid, so it is
    /// unknown whether an id follows, and both readings are tried.
    fn readings(self, packet: &[u8]) -> [Option<(&[u8], &[u8])>; 2] {
        let nothing = [None, None];
        if self.first >> 4 != PacketKind::Publish as u8 {
            return nothing;
        }
        let Some((length, rest)) = packet.get(self.head..).and_then(|body| body.split_first_chunk::<2>()) else { return nothing };
        let Some((topic, rest)) = rest.split_at_checked(usize::from(u16::from_be_bytes(*length))) else { return nothing };
        let without_id = Some((topic, rest));
        let with_id = Some((topic, rest.get(2..).unwrap_or_default()));
        match self.first >> 1 & 3 {
            0 => [without_id, None],
            1 | 2 => [with_id, None],
            _ => [with_id, without_id],
        }
    }
}

/// The part of a PUBLISH of MQTT 5 after its topic and id, as far as it has arrived.
#[derive(Default)]
struct Five<'a> {
    /// A bit for each topic alias that the properties name; a valid packet names at most one.
    aliases: u16,
    answer_to: Option<AnswerTo<'a>>,
    /// The payload; `None` if the properties have not arrived completely.
    payload: Option<&'a [u8]>,
}

/// The property Topic Alias (MQTT 5, section 3.3.2.3.4).
const ALIAS: u8 = 0x23;

/// The bit of a topic alias; 0 for an alias out of range.
const fn bit(alias: u16) -> u16 {
    if alias >= 1 && alias <= ALIASES { 1 << alias } else { 0 }
}

impl<'a> Five<'a> {
    fn aliases(&self) -> impl Iterator<Item = u16> + use<> {
        let named = self.aliases;
        (1..=ALIASES).filter(move |alias| named & bit(*alias) != 0)
    }

    fn read(rest: &'a [u8]) -> Five<'a> {
        let Ok(Some((size, own))) = length(rest) else { return Five::default() };
        if size > PROPERTIES {
            // A message with larger properties is refused, so it sets no alias.
            return Five { payload: rest.get(own + size..), ..Five::default() };
        }
        let payload = rest.get(own + size..);
        let mut fields = PacketFields::new(rest.get(own..own + size).unwrap_or(&rest[own..]));
        let (mut aliases, mut topic, mut correlation) = (0, None, None);
        while let Ok(property) = Property::read(&mut fields) {
            if let Property::TopicAlias(number) = property {
                aliases |= bit(number);
            } else if let Property::ResponseTopic(at) = property {
                topic = Some(at);
            } else if let Property::CorrelationData(data) = property {
                correlation = Some(data);
            }
        }
        // After an invalid property it is unknown where the next property begins. So any three bytes that look like
        // an alias count as one.
        for said in fields.rest().windows(3) {
            if let [ALIAS, high, low] = said {
                aliases |= bit(u16::from_be_bytes([*high, *low]));
            }
        }
        Five { aliases, answer_to: topic.map(|topic| AnswerTo { topic, correlation }), payload }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

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

    /// Every message on the topic `stop` is urgent. On the topic `word`, payloads that begin with `stop` are urgent.
    fn is_urgent(said: Said<'_>) -> bool {
        said.topic == b"stop" || said.topic == b"word" && said.payload.starts_with(b"stop")
    }

    /// Returns where the packets of the urgent messages begin.
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

    #[derive(Clone, Debug)]
    struct PacketOfFive {
        topic: &'static str,
        alias: u8,
        is_by_alias: bool,
        /// The value of a user property before the alias.
        padding: Vec<u8>,
        payload: Vec<u8>,
    }

    fn any_packet_of_five() -> impl Strategy<Value = PacketOfFive> {
        let padding =
            prop_oneof![3 => Just(0), 2 => 0..300_usize, 1 => Just(PROPERTIES - 20)].prop_map(|length| vec![b'p'; length]);
        let payload = prop::sample::select(vec![&b"stop"[..], b"other", b""]).prop_map(<[u8]>::to_vec);
        let topic = prop::sample::select(vec!["stop", "word", "other"]);
        (topic, 1..4_u8, any::<bool>(), padding, payload).prop_map(|(topic, alias, is_by_alias, padding, payload)| PacketOfFive {
            topic,
            alias,
            is_by_alias,
            padding,
            payload,
        })
    }

    proptest! {
        /// Other packets may come before the urgent message, and the bytes may arrive in any pieces.
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

        /// The packets have properties and topic aliases.
        #[test]
        fn every_urgent_message_of_mqtt_5_is_found(
            packets in prop::collection::vec(any_packet_of_five(), 1..12),
            cuts in prop::collection::vec(any::<prop::sample::Index>(), 0..8),
        ) {
            let (mut stream, mut expected, mut aliases) = (Vec::new(), Vec::new(), HashMap::new());
            for PacketOfFive { topic, alias, is_by_alias, padding, payload } in &packets {
                let named = is_by_alias.then(|| aliases.get(alias).copied()).flatten();
                if !is_by_alias {
                    aliases.insert(*alias, *topic);
                }
                let meant = if *is_by_alias { named } else { Some(*topic) };
                let is_urgent = meant == Some("stop") || meant == Some("word") && payload.starts_with(b"stop");
                expected.extend(is_urgent.then_some(stream.len() as u64));
                let mut properties = vec![0x26, 0, 1, b'k'];
                properties.extend(u16::try_from(padding.len()).unwrap().to_be_bytes());
                properties.extend(padding);
                properties.extend([0x23, 0, *alias]);
                let mut rest = bytes::BytesMut::new();
                crate::packet::properties::put_variable(&mut rest, properties.len() as u32);
                let rest = [&rest[..], &properties, payload].concat();
                stream.extend(publish(0x30, if *is_by_alias { "" } else { topic }, &rest));
            }
            let mut cuts: Vec<usize> = cuts.iter().map(|cut| cut.index(stream.len() + 1)).chain([0, stream.len()]).collect();
            cuts.sort_unstable();
            let search = || UrgentSearch::new(Version::Five);
            prop_assert_eq!(&found(&mut search(), [&stream[..]]), &expected);
            prop_assert_eq!(&found(&mut search(), cuts.windows(2).map(|cut| &stream[cut[0]..cut[1]])), &expected);
            prop_assert_eq!(&found(&mut search(), stream.chunks(7)), &expected);
        }

        #[test]
        fn whatever_comes_is_borne(stream in prop::collection::vec(any::<u8>(), 0..600), piece in 1_usize..50) {
            found(&mut UrgentSearch::default(), stream.chunks(piece));
            found(&mut UrgentSearch::new(Version::Five), stream.chunks(piece));
        }
    }

    /// The rest of the packet may never arrive.
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

    /// Two cases: a packet that is longer than allowed, and an urgent message before bytes in which no end of a
    /// packet can be found.
    #[test]
    fn an_urgent_message_that_is_too_long_is_found_and_one_before_nonsense() {
        let too_long = [&[0x30, 0xFF, 0xFF, 0xFF, 0x7F, 0, 4][..], b"stop"].concat();
        assert_eq!(found(&mut UrgentSearch::default(), [&too_long[..]]), [0]);
        let mut search = UrgentSearch::default();
        let stop = publish(0x30, "stop", &[]);
        assert_eq!(found(&mut search, [&[&stop[..], &[0x30, 0x80, 0x80, 0x80, 0x80]].concat()[..]]), [0]);
        assert!(found(&mut search, [&stop[..]]).is_empty(), "nobody knows where it begins");
    }

    /// In MQTT 5, properties come before the payload.
    #[test]
    fn a_word_is_found_behind_the_properties_of_mqtt_5_when_that_is_spoken() {
        let plain = publish(0x30, "word", b"\0stop");
        let more = publish(0x32, "word", &[&[0, 7, 5, 1, 1, 2, 0, 60][..], b"stop"].concat());
        let long = publish(0x30, "word", &[&[0x80, 1][..], &[7; 128], b"stop"].concat());
        let all = [&plain[..], &more, &long, &publish(0x30, "word", b"stop"), &publish(0x30, "word", &[0x80; 5])].concat();
        let places = vec![0, plain.len(), plain.len() + more.len(), plain.len() + more.len() + long.len()];
        let places: Vec<u64> = places.into_iter().map(|place| place as u64).collect();
        assert_eq!(found(&mut UrgentSearch::new(Version::Five), [&all[..]]), places);
        assert_eq!(found(&mut UrgentSearch::new(Version::Five), all.chunks(3)), places);
        assert_eq!(found(&mut UrgentSearch::default(), [&all[..]]), places[3..], "in MQTT 3.1.1 there are none");
    }

    /// In MQTT 5, an alias may stand for a topic that was named before.
    #[test]
    fn a_topic_is_known_by_the_number_that_stands_for_it() {
        let named = publish(0x30, "stop", &[3, 0x23, 0, 2]);
        let by_number = publish(0x32, "", &[0, 7, 3, 0x23, 0, 2]);
        let by_another = publish(0x30, "", &[3, 0x23, 0, 1]);
        let renamed = publish(0x30, "other", &[3, 0x23, 0, 2]);
        let all = [&by_number[..], &named, &by_another, &by_number, &renamed, &by_number].concat();
        let places = [by_number.len(), by_number.len() + named.len() + by_another.len()].map(|place| place as u64);
        for piece in [1, 3, 7, 1000] {
            assert_eq!(found(&mut UrgentSearch::new(Version::Five), all.chunks(piece)), places, "{piece}");
        }
        let mut search = UrgentSearch::new(Version::Five);
        found(&mut search, [&publish(0x30, "stop", &[3, 0x23, 0, 11])[..], &publish(0x30, "x", &[3, 0x23, 0, 0])]);
        assert!(search.aliases.as_ref().unwrap().is_empty(), "numbers that nobody may use cost nothing");
        let long = publish(0x30, &"x".repeat(TOPIC + 1), &[3, 0x23, 0, 2]);
        assert!(
            found(&mut search, [&[&named[..], &long, &by_number].concat()[..]]) == [21],
            "nor do long topics, and they stand there"
        );
        assert!(search.aliases.as_ref().unwrap().is_empty());
        let mut many = bytes::BytesMut::new();
        crate::packet::properties::put_variable(&mut many, u32::try_from(PROPERTIES + 4).unwrap());
        many.extend_from_slice(
            &[&[0x23, 0, 2, 0x26, 0, 1, b'k'][..], &(PROPERTIES as u16 - 5).to_be_bytes(), &[b'p'; PROPERTIES - 5]].concat(),
        );
        found(&mut search, [&publish(0x30, "stop", &many)[..]]);
        assert!(
            search.aliases.unwrap().is_empty(),
            "a message that is not taken, there being too many properties, names nothing"
        );
    }

    /// Other properties of the packet may be invalid.
    #[test]
    fn a_topic_is_known_by_its_number_among_properties_that_are_none() {
        let named = publish(0x30, "stop", &[3, 0x23, 0, 1]);
        for properties in [&[7, 0x7F, 0, 0, 0, 0x23, 0, 1][..], &[6, 0x23, 0, 1, 0x23, 0, 2], &[6, 0x23, 0, 2, 0x23, 0, 1]] {
            let stream = [&named[..], &publish(0x30, "", properties)].concat();
            assert_eq!(found(&mut UrgentSearch::new(Version::Five), [&stream[..]]), [0, named.len() as u64], "{properties:?}");
        }
    }

    #[test]
    fn it_is_known_where_an_answer_is_wanted() {
        let stop = publish(0x30, "stop", &[&[12, 8, 0, 3][..], b"a/b", &[9, 0, 3], b"7", &[0, 0], b"x"].concat());
        let (mut wanted, mut bytes) = (Vec::new(), &stop[..]);
        UrgentSearch::new(Version::Five).next(&mut bytes, |said| {
            wanted.push(said.answer_to.map(|to| (to.topic.to_owned(), to.correlation.map(<[u8]>::to_vec))));
            true
        });
        assert_eq!(wanted, [Some(("a/b".to_owned(), Some(b"7\0\0".to_vec())))]);
    }
}
