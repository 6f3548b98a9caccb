//! Valid and invalid packets of MQTT 3.1.1, as bytes. Their sender is in `client`.

/// Retain flag of a PUBLISH.
pub(crate) const RETAIN: u8 = 1;

/// First bytes of the packets that a test expects or misuses.
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

/// Text with its length before it.
pub(crate) fn text(text: &str) -> Vec<u8> {
    let length = u16::try_from(text.len()).expect("texts of tests are short");
    [&length.to_be_bytes()[..], text.as_bytes()].concat()
}

/// CONNECT of a client with a clean session.
pub(crate) fn connect(client_id: &str, keep_alive_s: u16) -> Vec<u8> {
    connect_with(4, 2, keep_alive_s, &text(client_id))
}

/// CONNECT with this key.
pub(crate) fn connect_as(client_id: &str, (name, token): (&str, &str)) -> Vec<u8> {
    connect_with(4, 0xC2, 60, &[text(client_id), text(name), text(token)].concat())
}

/// CONNECT with this protocol level, these flags, and all fields after the keep alive.
pub(crate) fn connect_with(level: u8, flags: u8, keep_alive_s: u16, rest: &[u8]) -> Vec<u8> {
    packet(0x10, &[&text("MQTT")[..], &[level, flags], &keep_alive_s.to_be_bytes(), rest].concat())
}

/// PUBLISH. `id` is omitted at QoS 0.
pub(crate) fn publish(topic: &str, payload: &[u8], qos: u8, flags: u8, id: u16) -> Vec<u8> {
    let id = if qos == 0 { Vec::new() } else { id.to_be_bytes().to_vec() };
    packet(0x30 | qos << 1 | flags, &[&text(topic)[..], &id, payload].concat())
}

/// SUBSCRIBE to several filters, at QoS 0.
pub(crate) fn subscribe_all(id: u16, filters: &[String]) -> Vec<u8> {
    let filters = filters.iter().flat_map(|filter| [&text(filter)[..], &[0]].concat());
    packet(0x82, &id.to_be_bytes().into_iter().chain(filters).collect::<Vec<u8>>())
}

/// SUBSCRIBE to one filter.
pub(crate) fn subscribe(id: u16, filter: &str, qos: u8) -> Vec<u8> {
    packet(0x82, &[&id.to_be_bytes()[..], &text(filter), &[qos]].concat())
}

/// UNSUBSCRIBE from one filter.
pub(crate) fn unsubscribe(id: u16, filter: &str) -> Vec<u8> {
    packet(0xA2, &[&id.to_be_bytes()[..], &text(filter)].concat())
}

/// Packet whose body is only the id of another packet.
pub(crate) fn ack(first: u8, id: u16) -> Vec<u8> {
    packet(first, &id.to_be_bytes())
}
