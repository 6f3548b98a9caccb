//! The part of MQTT 3.1.1 that a load needs. Frames are written and parsed by hand, so that the load costs little. A
//! server that sends anything unexpected ends the benchmark.

/// Packet types of a server, in the upper half of the first byte.
pub(crate) const CONNACK: u8 = 2;
pub(crate) const PUBLISH: u8 = 3;
pub(crate) const PUBACK: u8 = 4;
pub(crate) const SUBACK: u8 = 9;

/// Keep-alive in seconds, longer than any part of the benchmark.
const KEEP_ALIVE: u16 = 600;

/// CONNECT with a clean session.
pub(crate) fn connect(client: &str) -> Vec<u8> {
    let mut body = vec![0, 4, b'M', b'Q', b'T', b'T', 4, 2];
    body.extend_from_slice(&KEEP_ALIVE.to_be_bytes());
    text(&mut body, client);
    packet(1 << 4, &body)
}

pub(crate) fn subscribe(filter: &str, qos: u8) -> Vec<u8> {
    let mut body = vec![0, 1];
    text(&mut body, filter);
    body.push(qos);
    packet(8 << 4 | 2, &body)
}

/// Appends a PUBLISH whose payload of `length` bytes begins with its sequence number.
pub(crate) fn publish(out: &mut Vec<u8>, topic: &str, qos: u8, id: u16, sequence: u64, length: usize) {
    let head = 2 + topic.len() + if qos > 0 { 2 } else { 0 };
    out.push(PUBLISH << 4 | qos << 1);
    remaining(out, head + length);
    text(out, topic);
    if qos > 0 {
        out.extend_from_slice(&id.to_be_bytes());
    }
    out.extend_from_slice(&sequence.to_be_bytes());
    out.resize(out.len() + length - 8, b'.');
}

pub(crate) fn puback(out: &mut Vec<u8>, id: u16) {
    out.extend_from_slice(&[PUBACK << 4, 2]);
    out.extend_from_slice(&id.to_be_bytes());
}

/// First complete frame: its first byte, its body, and its total length.
pub(crate) fn first(bytes: &[u8]) -> Option<(u8, &[u8], usize)> {
    let (mut length, mut at) = (0, 1);
    loop {
        let byte = *bytes.get(at)?;
        length |= usize::from(byte & 0x7f) << (7 * (at - 1));
        at += 1;
        if byte & 0x80 == 0 {
            break;
        }
    }
    let body = bytes.get(at..at + length)?;
    Some((bytes[0], body, at + length))
}

/// Packet id of a PUBLISH at QoS 1, and the sequence number in its payload.
pub(crate) fn published(first: u8, body: &[u8]) -> (Option<u16>, u64) {
    let topic = usize::from(u16::from_be_bytes([body[0], body[1]]));
    let at = 2 + topic;
    let is_acked = first >> 1 & 3 > 0;
    let id = is_acked.then(|| u16::from_be_bytes([body[at], body[at + 1]]));
    let payload = &body[at + if is_acked { 2 } else { 0 }..];
    let sequence = payload.first_chunk().expect("a payload begins with its number");
    (id, u64::from_be_bytes(*sequence))
}

fn packet(first: u8, body: &[u8]) -> Vec<u8> {
    let mut out = vec![first];
    remaining(&mut out, body.len());
    out.extend_from_slice(body);
    out
}

fn remaining(out: &mut Vec<u8>, mut length: usize) {
    while length > 0x7f {
        out.push(length as u8 | 0x80);
        length >>= 7;
    }
    out.push(length as u8);
}

fn text(out: &mut Vec<u8>, text: &str) {
    out.extend_from_slice(&(text.len() as u16).to_be_bytes());
    out.extend_from_slice(text.as_bytes());
}
