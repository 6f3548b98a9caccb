//! Packets of MQTT 3.1.1, good ones and bad ones, as bytes. Whoever sends them stands in `client`.

/// Flags of a PUBLISH.
pub(crate) const RETAIN: u8 = 1;

/// The first bytes of packets that a test looks for or misuses.
pub(crate) const CONNACK: u8 = 0x20;
pub(crate) const PUBACK: u8 = 0x40;
pub(crate) const PUBREC: u8 = 0x50;
pub(crate) const PUBREL: u8 = 0x62;
pub(crate) const PUBCOMP: u8 = 0x70;
pub(crate) const SUBACK: u8 = 0x90;
pub(crate) const UNSUBACK: u8 = 0xB0;

pub(crate) const PINGREQ: [u8; 2] = [0xC0, 0];
pub(crate) const PINGRESP: u8 = 0xD0;
pub(crate) const DISCONNECT: [u8; 2] = [0xE0, 0];

/// A packet with this first byte.
pub(crate) fn packet(first: u8, body: &[u8]) -> Vec<u8> {
    let mut packet = vec![first];
    let mut rest = body.len();
    loop {
        let (low, high) = (rest % 128, rest / 128);
        packet.push(u8::try_from(low).expect("less than 128") | if high > 0 { 0x80 } else { 0 });
        rest = high;
        if rest == 0 {
            break;
        }
    }
    packet.extend_from_slice(body);
    packet
}

/// Text after its length.
pub(crate) fn text(text: &str) -> Vec<u8> {
    let length = u16::try_from(text.len()).expect("texts of tests are short");
    [&length.to_be_bytes()[..], text.as_bytes()].concat()
}

/// A CONNECT of a client that wants nothing to be remembered.
pub(crate) fn connect(client_id: &str, keep_alive_s: u16) -> Vec<u8> {
    connect_with(4, 2, keep_alive_s, &text(client_id))
}

/// The same of somebody with a key.
pub(crate) fn connect_as(client_id: &str, (name, token): (&str, &str)) -> Vec<u8> {
    connect_with(4, 0xC2, 60, &[text(client_id), text(name), text(token)].concat())
}

/// A CONNECT of this level of the protocol, with these flags and all that follows the keep alive.
pub(crate) fn connect_with(level: u8, flags: u8, keep_alive_s: u16, rest: &[u8]) -> Vec<u8> {
    packet(0x10, &[&text("MQTT")[..], &[level, flags], &keep_alive_s.to_be_bytes(), rest].concat())
}

/// A PUBLISH; `id` is left out at QoS 0.
pub(crate) fn publish(topic: &str, payload: &[u8], qos: u8, flags: u8, id: u16) -> Vec<u8> {
    let id = if qos == 0 { Vec::new() } else { id.to_be_bytes().to_vec() };
    packet(0x30 | qos << 1 | flags, &[&text(topic)[..], &id, payload].concat())
}

/// A SUBSCRIBE to one filter.
pub(crate) fn subscribe(id: u16, filter: &str, qos: u8) -> Vec<u8> {
    packet(0x82, &[&id.to_be_bytes()[..], &text(filter), &[qos]].concat())
}

/// An UNSUBSCRIBE of one filter.
pub(crate) fn unsubscribe(id: u16, filter: &str) -> Vec<u8> {
    packet(0xA2, &[&id.to_be_bytes()[..], &text(filter)].concat())
}

/// A packet that is nothing but the id of another.
pub(crate) fn ack(first: u8, id: u16) -> Vec<u8> {
    packet(first, &id.to_be_bytes())
}
