//! Conversion between packets of MQTT 3.1.1 and equivalent packets of MQTT 5, so that each test can run in both
//! versions. Invalid packets are not changed.

/// Converts the packets of a client to MQTT 5.
pub(crate) fn dressed(mut bytes: &[u8]) -> Vec<u8> {
    let mut out = Vec::new();
    while let Some((length, head)) = whole(bytes) {
        let (packet, rest) = bytes.split_at(length);
        match with_properties(packet[0], &packet[head..]) {
            Some(body) => out.extend(super::packets::packet(packet[0], &body)),
            None => out.extend_from_slice(packet),
        }
        bytes = rest;
    }
    [out, bytes.to_vec()].concat()
}

/// Inserts empty properties where MQTT 5 has properties.
fn with_properties(first: u8, body: &[u8]) -> Option<Vec<u8>> {
    let mut body = body.to_vec();
    match first >> 4 {
        1 if body.starts_with(b"\0\x04MQTT\x04") && body.len() > 11 => {
            let (has_will, after_id) = (body[7] & 4 != 0, 12 + text_length(&body, 10)?);
            if has_will && after_id <= body.len() {
                body.insert(after_id, 0);
            }
            body[6] = 5;
            body.insert(10, 0);
        }
        3 => {
            let after = 2 + text_length(&body, 0)? + if first & 6 == 0 { 0 } else { 2 };
            (after <= body.len()).then(|| body.insert(after, 0))?;
        }
        8 | 10 if body.len() >= 2 => body.insert(2, 0),
        _ => return None,
    }
    Some(body)
}

fn text_length(body: &[u8], at: usize) -> Option<usize> {
    Some(usize::from(u16::from_be_bytes([*body.get(at)?, *body.get(at + 1)?])))
}

/// Converts a packet of the broker to MQTT 3.1.1. Returns `None` if that version has no such packet.
pub(crate) fn bare(first: u8, body: &[u8]) -> Option<Vec<u8>> {
    let mut body = body.to_vec();
    match first >> 4 {
        2 => {
            body.truncate(2);
            body[1] = match body[1] {
                0x84 => 1,
                0x85 => 2,
                0x88 => 3,
                0x86 => 4,
                0x87 => 5,
                other => other,
            };
        }
        3 => {
            let at = 2 + text_length(&body, 0).expect("a topic") + if first & 6 == 0 { 0 } else { 2 };
            without_properties(&mut body, at);
        }
        4..=7 => body.truncate(2),
        9 => {
            without_properties(&mut body, 2);
            body[2..].iter_mut().filter(|code| **code > 0x80).for_each(|code| *code = 0x80);
        }
        11 => body.truncate(2),
        14 => return None,
        _ => {}
    }
    Some(body)
}

fn without_properties(body: &mut Vec<u8>, at: usize) {
    let (mut length, mut own) = (0, 0);
    loop {
        let byte = body[at + own];
        length |= usize::from(byte & 0x7F) << (7 * own);
        own += 1;
        if byte & 0x80 == 0 {
            break;
        }
    }
    body.drain(at..at + own + length);
}

/// Length of the first packet and offset of its body, if the packet is complete.
pub(crate) fn whole(bytes: &[u8]) -> Option<(usize, usize)> {
    let mut body = 0;
    for (place, byte) in bytes.iter().skip(1).take(4).enumerate() {
        body |= usize::from(byte & 0x7F) << (7 * place);
        if byte & 0x80 == 0 {
            let (head, length) = (2 + place, 2 + place + body);
            return (bytes.len() >= length).then_some((length, head));
        }
    }
    None
}
