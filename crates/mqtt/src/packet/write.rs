//! Packets, written. Nobody here asks whether they are wise.

use bytes::{BufMut, BytesMut};

use super::Qos;
use crate::frame::Kind;

/// PINGRESP.
pub const PINGRESP: [u8; 2] = [Kind::Pingresp.first_byte(), 0];

/// The flag of a PUBLISH that may have been sent before.
const DUPLICATE: u8 = 8;

/// The code of a SUBACK for a filter that is refused.
pub const REFUSED: u8 = 0x80;

/// What a CONNACK says (section 3.2.2.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Welcome {
    /// Come in.
    Accepted = 0,
    /// This version is not spoken.
    Version,
    /// No such client id.
    ClientId,
    /// The broker is not there, or full.
    Unavailable,
    /// Name or password are not known.
    Login,
    /// This may not be done: a forbidden will.
    NotAllowed,
}

/// A CONNACK.
#[must_use]
pub const fn connack(welcome: Welcome, session_present: bool) -> [u8; 4] {
    [Kind::Connack.first_byte(), 2, session_present as u8, welcome as u8]
}

/// A CONNECT with this client id, name and password, and without a will.
pub fn connect(out: &mut BytesMut, client_id: &str, clean_session: bool, keep_alive_s: u16, (name, password): (&str, &str)) {
    head(out, Kind::Connect.first_byte(), 16 + client_id.len() + name.len() + password.len());
    text(out, "MQTT");
    out.put_slice(&[4, 0xC0 | u8::from(clean_session) << 1]);
    out.put_u16(keep_alive_s);
    [client_id, name, password].into_iter().for_each(|field| text(out, field));
}

/// A PUBLISH; `id` is of no matter at QoS 0.
pub fn publish(out: &mut BytesMut, topic: &[u8], payload: &[u8], qos: Qos, id: u16, retain: bool) {
    PublishHead { topic, qos, id, retain, is_duplicate: false }.with(out, payload);
}

/// All of a PUBLISH but its payload.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PublishHead<'a> {
    pub(crate) topic: &'a [u8],
    pub(crate) qos: Qos,
    /// 0 at QoS 0.
    pub(crate) id: u16,
    pub(crate) retain: bool,
    /// Whether it may have been sent before.
    pub(crate) is_duplicate: bool,
}

impl PublishHead<'_> {
    pub(crate) fn with(self, out: &mut BytesMut, payload: &[u8]) {
        out.reserve(5 + 2 + self.topic.len() + 2 + payload.len());
        self.before(out, payload.len());
        out.put_slice(payload);
    }

    /// What comes before a payload of so many bytes.
    pub(crate) fn before(self, out: &mut BytesMut, payload: usize) {
        let PublishHead { topic, qos, id, retain, is_duplicate } = self;
        let id_length = if qos == Qos::Zero { 0 } else { 2 };
        let again = if is_duplicate && qos > Qos::Zero { DUPLICATE } else { 0 };
        let first = Kind::Publish.first_byte() | again | (qos as u8) << 1 | u8::from(retain);
        head(out, first, 2 + topic.len() + id_length + payload);
        bytes(out, topic);
        if qos != Qos::Zero {
            out.put_u16(id);
        }
    }
}

/// PUBACK, PUBREC, PUBREL, PUBCOMP or UNSUBACK.
pub fn ack(out: &mut BytesMut, kind: Kind, id: u16) {
    let [high, low] = id.to_be_bytes();
    out.put_slice(&[kind.first_byte(), 2, high, low]);
}

/// A SUBACK with a code for each filter.
pub fn suback(out: &mut BytesMut, id: u16, codes: &[u8]) {
    head(out, Kind::Suback.first_byte(), 2 + codes.len());
    out.put_u16(id);
    out.put_slice(codes);
}

/// A SUBSCRIBE to these filters, of which there is at least one.
pub fn subscribe(out: &mut BytesMut, id: u16, filters: &[(&str, Qos)]) {
    head(out, Kind::Subscribe.first_byte(), 2 + filters.iter().map(|(filter, _)| 3 + filter.len()).sum::<usize>());
    out.put_u16(id);
    for (filter, qos) in filters {
        text(out, filter);
        out.put_u8(*qos as u8);
    }
}

/// An UNSUBSCRIBE from these filters, of which there is at least one.
pub fn unsubscribe(out: &mut BytesMut, id: u16, filters: &[&str]) {
    head(out, Kind::Unsubscribe.first_byte(), 2 + filters.iter().map(|filter| 2 + filter.len()).sum::<usize>());
    out.put_u16(id);
    for filter in filters {
        text(out, filter);
    }
}

fn head(out: &mut BytesMut, first: u8, mut length: usize) {
    out.put_u8(first);
    while length > 0x7F {
        out.put_u8((length & 0x7F) as u8 | 0x80);
        length >>= 7;
    }
    out.put_u8(length as u8);
}

fn text(out: &mut BytesMut, text: &str) {
    bytes(out, text.as_bytes());
}

/// A length in two bytes, and as many bytes. What is written here came out of such a field, or is short.
fn bytes(out: &mut BytesMut, bytes: &[u8]) {
    out.put_u16(u16::try_from(bytes.len()).expect("it was read from a field of at most so many bytes, or is bounded by TOPIC"));
    out.put_slice(bytes);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::frame;
    use crate::packet::{connect, filters::Filters, publish as read};

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
                let expected = read::Publish { topic: b"a/b", payload: &payload, qos, id, is_duplicate: false, retain };
                assert_eq!(read::read(&frame, &out), Ok(expected));
            }
        }
    }

    #[test]
    fn questions_to_the_router_are_read_again() {
        let mut out = BytesMut::new();
        connect(&mut out, "c17", true, 65_535, ("gate", "secret"));
        let connect = connect::read(body(&out)).unwrap();
        let credentials = connect.credentials;
        assert_eq!((credentials.name.as_deref(), credentials.password.as_deref()), (Some("gate"), Some(&b"secret"[..])));
        assert_eq!((&*connect.client_id, connect.clean_session, connect.keep_alive_s), ("c17", true, 65_535));
        let mut out = BytesMut::new();
        subscribe(&mut out, 7, &[("a/+", Qos::One), ("b", Qos::Zero)]);
        assert_eq!(Filters::of_subscribe(body(&out)).unwrap().collect::<Vec<_>>(), [("a/+", Qos::One), ("b", Qos::Zero)]);
        let mut out = BytesMut::new();
        unsubscribe(&mut out, 7, &["a/+"]);
        assert_eq!(Filters::of_unsubscribe(body(&out)).unwrap().map(|(filter, _)| filter).collect::<Vec<_>>(), ["a/+"]);
    }

    #[test]
    fn answers_are_as_the_standard_has_them() {
        let mut out = BytesMut::new();
        ack(&mut out, Kind::Pubrel, 0x0102);
        suback(&mut out, 3, &[1, REFUSED]);
        out.extend_from_slice(&connack(Welcome::Login, false));
        out.extend_from_slice(&connack(Welcome::Accepted, true));
        out.extend_from_slice(&PINGRESP);
        assert_eq!(out[..], [0x62, 2, 1, 2, 0x90, 4, 0, 3, 1, 0x80, 0x20, 2, 0, 4, 0x20, 2, 1, 0, 0xD0, 0]);
    }
}
