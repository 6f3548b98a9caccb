//! Writes packets. Whether a packet is allowed is not checked here.

use bytes::{BufMut, BytesMut};

use super::Qos;
use super::properties::{Property, put_variable, variable_length};
use super::reason::Reason;
use crate::frame::PacketKind;
use crate::limits::{ALIASES, CLIENT_PACKET, UNRELEASED};

/// A complete PINGRESP, which is the same in both versions (section 3.13).
pub const PINGRESP: [u8; 2] = [PacketKind::Pingresp.first_byte(), 0];

const DUPLICATE: u8 = 8;

/// The code in a SUBACK of MQTT 3.1.1 for a filter that is refused (section 3.9.3).
pub const REFUSED: u8 = 0x80;

/// The return code of a CONNACK of MQTT 3.1.1, from 0 to 5 (section 3.2.2.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Welcome {
    /// The client is connected; every other code ends the connection.
    Accepted = 0,
    /// The client speaks neither MQTT 3.1.1 nor 5.
    Version,
    /// The client id is not accepted because it is too long.
    ClientId,
    /// There is no room for another client.
    Unavailable,
    /// The user name or the password is wrong; the client is not told which.
    Login,
    /// The client may not do what it asked for, such as leave its will.
    NotAllowed,
}

impl Welcome {
    /// The return code in words, for the reason string that a client of MQTT 5 gets.
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            Welcome::Accepted => "the client is accepted",
            Welcome::Version => "this version of the protocol is not supported",
            Welcome::ClientId => "the client id is too long",
            Welcome::Unavailable => "the server accepts no more clients now",
            Welcome::Login => "name and password are not known",
            Welcome::NotAllowed => "a name and a password are required, or the will may not be published",
        }
    }

    /// The reason code that a client of MQTT 5 gets in place of the return code.
    #[must_use]
    pub const fn reason(self) -> Reason {
        match self {
            Welcome::Accepted => Reason::Success,
            Welcome::Version => Reason::Version,
            Welcome::ClientId => Reason::ClientId,
            Welcome::Unavailable => Reason::Unavailable,
            Welcome::Login => Reason::Login,
            Welcome::NotAllowed => Reason::NotAuthorized,
        }
    }
}

/// A CONNACK of MQTT 5 (section 3.2.2).
#[derive(Clone, Copy, Debug)]
pub struct Connack<'a> {
    /// `Reason::Success`, or why the connection is closed after this packet.
    pub reason: Reason,
    /// Whether the broker has a session of the client; never true in a refusal (section 3.2.2.1.1).
    pub session_present: bool,
    /// How long the session is stored, in seconds, if this differs from what the client asked for.
    pub session_expiry_s: Option<u32>,
    /// The client id that the broker has chosen for a client that sent an empty one (section 3.1.3.1).
    pub assigned_id: Option<&'a str>,
    /// The keep alive in seconds, if this differs from what the client asked for.
    pub keep_alive_s: Option<u16>,
    /// The reason in words. It is left out if the packet would otherwise be longer than the client accepts.
    pub words: Option<&'a str>,
}

impl Connack<'_> {
    /// A CONNACK with this reason; the caller may set its other fields.
    #[must_use]
    pub const fn of(reason: Reason) -> Connack<'static> {
        Connack { reason, session_present: false, session_expiry_s: None, assigned_id: None, keep_alive_s: None, words: None }
    }

    /// Writes the CONNACK, without its optional parts if it would otherwise be longer than `largest` bytes.
    #[must_use]
    pub fn written(self, largest: u32) -> Vec<u8> {
        let needed = [
            self.session_expiry_s.map(Property::SessionExpiry),
            self.assigned_id.map(Property::AssignedClientId),
            self.keep_alive_s.map(Property::ServerKeepAlive),
        ];
        let most = u16::try_from(UNRELEASED).expect("it is a few thousand");
        let longest = u32::try_from(CLIENT_PACKET).expect("it is some kilobytes");
        let ours = [Property::ReceiveMaximum(most), Property::MaximumPacket(longest), Property::TopicAliasMaximum(ALIASES)];
        let of_use = ours.into_iter().filter(|_| !self.reason.is_refusal()).chain(self.words.map(Property::ReasonString));
        let needed: Vec<_> = needed.into_iter().flatten().collect();
        let full = self.with(&needed.iter().copied().chain(of_use).collect::<Vec<_>>());
        if full.len() <= largest as usize { full } else { self.with(&needed) }
    }

    fn with(self, properties: &[Property<'_>]) -> Vec<u8> {
        let (mut out, properties) = (BytesMut::new(), written(properties));
        head(&mut out, PacketKind::Connack.first_byte(), 2 + properties.len());
        out.put_slice(&[u8::from(self.session_present), self.reason as u8]);
        out.put_slice(&properties);
        out.to_vec()
    }
}

/// A complete CONNACK of MQTT 3.1.1, which has no properties.
#[must_use]
pub const fn connack(welcome: Welcome, session_present: bool) -> [u8; 4] {
    [PacketKind::Connack.first_byte(), 2, session_present as u8, welcome as u8]
}

/// Writes a CONNECT of MQTT 3.1.1 without a will. Panics if a text is longer than 65,535 bytes.
pub fn connect(out: &mut BytesMut, client_id: &str, clean_session: bool, keep_alive_s: u16, name: &str, password: &str) {
    head(out, PacketKind::Connect.first_byte(), 16 + client_id.len() + name.len() + password.len());
    text(out, "MQTT");
    out.put_slice(&[4, 0xC0 | u8::from(clean_session) << 1]);
    out.put_u16(keep_alive_s);
    [client_id, name, password].into_iter().for_each(|field| text(out, field));
}

/// Writes a PUBLISH of MQTT 3.1.1; `id` is not used at QoS 0.
pub fn publish(out: &mut BytesMut, topic: &[u8], payload: &[u8], qos: Qos, id: u16, retain: bool) {
    PublishHead { topic, qos, id, retain, is_duplicate: false, properties: None }.with(out, payload);
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct PublishHead<'a> {
    /// The topic; empty if an alias stands for it.
    pub(crate) topic: &'a [u8],
    pub(crate) qos: Qos,
    /// The packet id; 0 at QoS 0.
    pub(crate) id: u16,
    pub(crate) retain: bool,
    /// The DUP flag, which is not written at QoS 0.
    pub(crate) is_duplicate: bool,
    /// The properties; `None` for MQTT 3.1.1.
    pub(crate) properties: Option<PublishProperties<'a>>,
}

#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct PublishProperties<'a> {
    pub(crate) expiry_s: Option<u32>,
    pub(crate) alias: Option<u16>,
    /// The ids of the subscriptions that match (MQTT 5, section 3.3.2.3.8).
    pub(crate) ids: &'a [u32],
    /// The publisher's properties, in the encoding of MQTT 5.
    pub(crate) others: &'a [u8],
}

impl PublishHead<'_> {
    pub(crate) fn with(self, out: &mut BytesMut, payload: &[u8]) {
        out.reserve(self.length(payload.len()));
        self.before(out, payload.len());
        out.put_slice(payload);
    }

    /// Length in bytes of the whole packet if its payload has this many bytes.
    pub(crate) fn length(&self, payload: usize) -> usize {
        let rest = self.rest() + payload;
        1 + variable_length(rest) + rest
    }

    fn rest(&self) -> usize {
        let id = if self.qos == Qos::Zero { 0 } else { 2 };
        let properties = self.properties.map_or(0, |properties| variable_length(properties.length()) + properties.length());
        2 + self.topic.len() + id + properties
    }

    /// Writes the bytes before the payload. `payload` is the length of the payload in bytes.
    pub(crate) fn before(self, out: &mut BytesMut, payload: usize) {
        let again = if self.is_duplicate && self.qos > Qos::Zero { DUPLICATE } else { 0 };
        let first = PacketKind::Publish.first_byte() | again | (self.qos as u8) << 1 | u8::from(self.retain);
        head(out, first, self.rest() + payload);
        bytes(out, self.topic);
        if self.qos != Qos::Zero {
            out.put_u16(self.id);
        }
        if let Some(properties) = self.properties {
            properties.put(out);
        }
    }
}

impl PublishProperties<'_> {
    fn length(&self) -> usize {
        let ids: usize = self.ids.iter().map(|id| 1 + variable_length(*id as usize)).sum();
        self.expiry_s.map_or(0, |_| 5) + self.alias.map_or(0, |_| 3) + ids + self.others.len()
    }

    fn put(self, out: &mut BytesMut) {
        put_variable(out, self.length() as u32);
        let own = [self.expiry_s.map(Property::MessageExpiry), self.alias.map(Property::TopicAlias)];
        own.into_iter().flatten().for_each(|property| property.write(out));
        self.ids.iter().for_each(|id| Property::SubscriptionId(*id).write(out));
        out.put_slice(self.others);
    }
}

/// Writes a successful PUBACK, PUBREC, PUBREL or PUBCOMP, or an UNSUBACK of MQTT 3.1.1.
pub fn ack(out: &mut BytesMut, kind: PacketKind, id: u16) {
    let [high, low] = id.to_be_bytes();
    out.put_slice(&[kind.first_byte(), 2, high, low]);
}

/// Writes a PUBACK, PUBREC, PUBREL or PUBCOMP of MQTT 5. Pass `words` only if the client wants them.
pub fn ack_with(out: &mut BytesMut, kind: PacketKind, id: u16, reason: Reason, words: Option<&str>) {
    let properties = reason_string(words);
    head(out, kind.first_byte(), 3 + properties.len());
    out.put_u16(id);
    out.put_u8(reason as u8);
    out.put_slice(&properties);
}

/// Writes a SUBACK of MQTT 3.1.1. `codes` has the granted QoS or [`REFUSED`] for each filter, in order.
pub fn suback(out: &mut BytesMut, id: u16, codes: &[u8]) {
    codes_of(out, PacketKind::Suback, id, &[], codes);
}

/// Writes a SUBACK or an UNSUBACK of MQTT 5. `codes` has a reason code for each filter, in order.
pub fn codes_five(out: &mut BytesMut, kind: PacketKind, id: u16, codes: &[u8], words: Option<&str>) {
    codes_of(out, kind, id, &reason_string(words), codes);
}

fn codes_of(out: &mut BytesMut, kind: PacketKind, id: u16, properties: &[u8], codes: &[u8]) {
    head(out, kind.first_byte(), 2 + properties.len() + codes.len());
    out.put_u16(id);
    out.put_slice(properties);
    out.put_slice(codes);
}

/// Writes a DISCONNECT of MQTT 5; a server of MQTT 3.1.1 sends none.
pub fn disconnect(out: &mut BytesMut, reason: Reason, words: Option<&str>) {
    let properties = reason_string(words);
    head(out, PacketKind::Disconnect.first_byte(), 1 + properties.len());
    out.put_u8(reason as u8);
    out.put_slice(&properties);
}

/// Writes a SUBSCRIBE of MQTT 3.1.1 to these filters, at least one.
pub fn subscribe(out: &mut BytesMut, id: u16, filters: &[(&str, Qos)]) {
    head(out, PacketKind::Subscribe.first_byte(), 2 + filters.iter().map(|(filter, _)| 3 + filter.len()).sum::<usize>());
    out.put_u16(id);
    for (filter, qos) in filters {
        text(out, filter);
        out.put_u8(*qos as u8);
    }
}

/// Writes an UNSUBSCRIBE of MQTT 3.1.1 from these filters, at least one.
pub fn unsubscribe(out: &mut BytesMut, id: u16, filters: &[&str]) {
    head(out, PacketKind::Unsubscribe.first_byte(), 2 + filters.iter().map(|filter| 2 + filter.len()).sum::<usize>());
    out.put_u16(id);
    for filter in filters {
        text(out, filter);
    }
}

fn head(out: &mut BytesMut, first: u8, length: usize) {
    out.put_u8(first);
    put_variable(out, length as u32);
}

/// The encoded properties, preceded by their length.
fn written(properties: &[Property<'_>]) -> BytesMut {
    let (mut out, mut all) = (BytesMut::new(), BytesMut::new());
    properties.iter().for_each(|property| property.write(&mut all));
    put_variable(&mut out, all.len() as u32);
    out.put_slice(&all);
    out
}

/// Encodes the reason in words, as the only property of a packet.
fn reason_string(words: Option<&str>) -> BytesMut {
    words.map_or_else(|| written(&[]), |words| written(&[Property::ReasonString(words)]))
}

fn text(out: &mut BytesMut, text: &str) {
    bytes(out, text.as_bytes());
}

/// Writes a field with its length in two bytes. Every value is short enough: it is bounded by `TOPIC`, or was read
/// from a field with a length of two bytes.
fn bytes(out: &mut BytesMut, bytes: &[u8]) {
    out.put_u16(u16::try_from(bytes.len()).expect("it comes from a field with a two-byte length, or is bounded by TOPIC"));
    out.put_slice(bytes);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::frame;
    use crate::packet::{
        Version, connect,
        filters::{Filters, Options},
        properties::Properties,
        publish as read,
    };

    fn body(out: &BytesMut) -> &[u8] {
        let frame = frame(out, usize::MAX).unwrap().unwrap();
        assert_eq!(frame.length, out.len());
        &out[frame.head..]
    }

    #[test]
    fn what_is_written_is_read_again() {
        for length in [0, 1, 120, 121, 122, 16_378, 16_379, 2_097_146, 2_097_147] {
            for (qos, id, retain) in [(Qos::Zero, 0, true), (Qos::One, 1001, false), (Qos::Two, 9, true)] {
                let mut out = BytesMut::new();
                let payload = vec![7; length];
                publish(&mut out, b"a/b", &payload, qos, id, retain);
                let frame = frame(&out, usize::MAX).unwrap().unwrap();
                assert_eq!(frame.length, out.len());
                let expected = read::Publish {
                    topic: b"a/b",
                    payload: &payload,
                    qos,
                    id,
                    is_duplicate: false,
                    retain,
                    properties: Properties::default(),
                };
                assert_eq!(read::read(&frame, &out, Version::Three), Ok(expected));
            }
        }
    }

    #[test]
    fn what_a_client_says_is_read_again() {
        let mut out = BytesMut::new();
        connect(&mut out, "c17", true, 65_535, "gate", "secret");
        let connect = connect::read(body(&out)).unwrap();
        let credentials = connect.credentials;
        assert_eq!((credentials.name.as_deref(), credentials.password.as_deref()), (Some("gate"), Some(&b"secret"[..])));
        assert_eq!((&*connect.client_id, connect.clean_start, connect.keep_alive_s), ("c17", true, 65_535));
        let mut out = BytesMut::new();
        subscribe(&mut out, 7, &[("a/+", Qos::One), ("b", Qos::Zero)]);
        let expected = [("a/+", Options::at(Qos::One)), ("b", Options::at(Qos::Zero))];
        assert_eq!(Filters::of_subscribe(body(&out), Version::Three).unwrap().collect::<Vec<_>>(), expected);
        let mut out = BytesMut::new();
        unsubscribe(&mut out, 7, &["a/+"]);
        assert_eq!(
            Filters::of_unsubscribe(body(&out), Version::Three).unwrap().map(|(filter, _)| filter).collect::<Vec<_>>(),
            ["a/+"]
        );
    }

    #[test]
    fn a_publish_of_mqtt_5_is_read_again_and_is_as_long_as_is_said() {
        let mut others = BytesMut::new();
        Property::User("who", "panel").write(&mut others);
        let properties = PublishProperties { expiry_s: Some(7), alias: Some(2), ids: &[1, 300], others: &others };
        for properties in [PublishProperties::default(), properties] {
            let head = PublishHead {
                topic: b"a/b",
                qos: Qos::One,
                id: 9,
                retain: false,
                is_duplicate: false,
                properties: Some(properties),
            };
            for length in [0, 100, 20_000] {
                let mut out = BytesMut::new();
                head.with(&mut out, &vec![7; length]);
                let frame = frame(&out, usize::MAX).unwrap().unwrap();
                assert_eq!((frame.length, head.length(length)), (out.len(), out.len()));
            }
        }
        let mut written = BytesMut::new();
        properties.put(&mut written);
        let mut fields = super::super::PacketFields::new(&written);
        let read: Vec<_> = Properties::of_server(&mut fields).collect();
        let ids = [Property::SubscriptionId(1), Property::SubscriptionId(300)];
        assert_eq!(
            read,
            [&[Property::MessageExpiry(7), Property::TopicAlias(2)], &ids[..], &[Property::User("who", "panel")]].concat()
        );
    }

    #[test]
    fn answers_of_mqtt_5_are_as_the_standard_has_them() {
        let mut out = BytesMut::new();
        ack_with(&mut out, PacketKind::Puback, 0x0102, Reason::NotAuthorized, None);
        ack_with(&mut out, PacketKind::Pubrec, 3, Reason::Quota, Some("no"));
        codes_five(&mut out, PacketKind::Suback, 3, &[1, 0x8F], None);
        codes_five(&mut out, PacketKind::Unsuback, 3, &[0x11], None);
        disconnect(&mut out, Reason::ShuttingDown, Some("end"));
        let expected: [&[u8]; 5] = [
            &[0x40, 4, 1, 2, 0x87, 0],
            &[0x50, 9, 0, 3, 0x97, 5, 0x1F, 0, 2, b'n', b'o'],
            &[0x90, 5, 0, 3, 0, 1, 0x8F],
            &[0xB0, 4, 0, 3, 0, 0x11],
            &[0xE0, 8, 0x8B, 6, 0x1F, 0, 3, b'e', b'n', b'd'],
        ];
        assert_eq!(out[..], expected.concat());
        assert_eq!(Connack::of(Reason::Login).written(100), [0x20, 3, 0, 0x86, 0]);
        let accepted = Connack { session_present: true, assigned_id: Some("id"), ..Connack::of(Reason::Success) };
        let needed = [0x12, 0, 2, b'i', b'd'];
        let full = [&[0x20, 19, 1, 0, 16][..], &needed, &[0x21, 0x10, 0, 0x27, 0, 4, 0, 0, 0x22, 0, 10]].concat();
        assert_eq!(accepted.written(full.len() as u32), full);
        let little = [&[0x20, 8, 1, 0, 5][..], &needed].concat();
        assert_eq!(accepted.written(full.len() as u32 - 1), little, "a client that takes little is told what it has to know");
    }

    #[test]
    fn answers_are_as_the_standard_has_them() {
        let mut out = BytesMut::new();
        ack(&mut out, PacketKind::Pubrel, 0x0102);
        suback(&mut out, 3, &[1, REFUSED]);
        out.extend_from_slice(&connack(Welcome::Login, false));
        out.extend_from_slice(&connack(Welcome::Accepted, true));
        out.extend_from_slice(&PINGRESP);
        assert_eq!(out[..], [0x62, 2, 1, 2, 0x90, 4, 0, 3, 1, 0x80, 0x20, 2, 0, 4, 0x20, 2, 1, 0, 0xD0, 0]);
    }
}
