//! Reads datagrams strictly and writes messages, with the codec of coap-lite. The codec accepts versions, markers and
//! empty messages that the RFC forbids, so they are checked here. The meaning of options is not read here.

use coap_lite::Packet;

use super::code::Code;
use super::limits::HEAD;

/// The type of a message (RFC 7252, section 4.1), with its bits in the first byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum MessageKind {
    Con = 0x00,
    Non = 0x10,
    Ack = 0x20,
    Rst = 0x30,
}

/// The token by which a client recognises its answers, of at most 8 bytes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Token {
    bytes: [u8; 8],
    length: u8,
}

#[derive(Debug)]
pub(super) enum Received {
    /// Not a CoAP message, or a message that gets no answer.
    Nothing,
    /// A message that cannot be read, or that no client may send to a server. A CON is answered with a RST of this
    /// id.
    Malformed(MessageKind, u16),
    Ack(u16),
    Rst(u16),
    Request(Incoming),
}

#[derive(Debug)]
pub(super) struct Incoming {
    pub(super) kind: MessageKind,
    pub(super) id: u16,
    pub(super) token: Token,
    pub(super) code: Code,
    pub(super) packet: Packet,
}

impl Token {
    /// A token of these bytes; bytes beyond the eighth are dropped.
    pub(super) fn new(given: &[u8]) -> Token {
        let given = &given[..given.len().min(8)];
        let mut bytes = [0; 8];
        bytes[..given.len()].copy_from_slice(given);
        Token { bytes, length: u8::try_from(given.len()).unwrap_or(8) }
    }

    pub(super) fn bytes(&self) -> &[u8] {
        &self.bytes[..usize::from(self.length)]
    }
}

pub(super) fn parse(bytes: &[u8]) -> Received {
    let [first, code, high, low, ..] = *bytes else { return Received::Nothing };
    if !is_of_this_version(bytes) {
        return Received::Nothing;
    }
    let (kind, code, id) = (kind(first), Code(code), u16::from_be_bytes([high, low]));
    match (kind, code) {
        (MessageKind::Ack, _) => Received::Ack(id),
        (MessageKind::Rst, Code::EMPTY) if bytes.len() == 4 => Received::Rst(id),
        (MessageKind::Rst, _) => Received::Nothing,
        // An empty message is a ping, and an empty message with further bytes is an error. Both get the same answer.
        (MessageKind::Con | MessageKind::Non, Code::EMPTY) => Received::Malformed(kind, id),
        (MessageKind::Con | MessageKind::Non, _) if code.class() != 0 => Received::Malformed(kind, id),
        (MessageKind::Con | MessageKind::Non, _) => match Packet::from_bytes(bytes) {
            Ok(packet) if written_length(&packet) == bytes.len() => {
                Received::Request(Incoming { kind, id, token: Token::new(packet.get_token()), code, packet })
            }
            _ => Received::Malformed(kind, id),
        },
    }
}

/// Whether a datagram is long enough for a message, and of version 1 (RFC 7252, section 3).
pub(super) fn is_of_this_version(bytes: &[u8]) -> bool {
    matches!(bytes, [first, _, _, _, ..] if first >> 6 == 1)
}

/// The code of a datagram that may be a request, valid or not; `None` for acknowledgements, resets and empty
/// messages.
pub(super) fn asks(bytes: &[u8]) -> Option<Code> {
    let [first, code, _, _, ..] = *bytes else { return None };
    (is_of_this_version(bytes) && Code(code) != Code::EMPTY && matches!(kind(first), MessageKind::Con | MessageKind::Non))
        .then_some(Code(code))
}

/// An empty message of four bytes (RFC 7252, section 4.1), as an acknowledgement or a reset.
pub(super) fn empty(kind: MessageKind, id: u16) -> Vec<u8> {
    let [high, low] = id.to_be_bytes();
    vec![0x40 | kind as u8, 0, high, low]
}

/// A message that is being written. Options are added in the order of their numbers; type and id are filled in last.
/// All bytes go into one buffer. The codec would allocate three buffers for each option.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Outgoing {
    bytes: Vec<u8>,
    option: u16,
}

impl Outgoing {
    /// A message without options and payload, with memory reserved for a payload of this many bytes.
    pub(super) fn new(code: Code, token: Token, payload: usize) -> Outgoing {
        let mut bytes = Vec::with_capacity(HEAD + payload);
        bytes.extend([0x40 | token.length, code.0, 0, 0]);
        bytes.extend(token.bytes());
        Outgoing { bytes, option: 0 }
    }

    /// Adds an option. Options must be added in ascending order of their numbers.
    pub(super) fn add(&mut self, option: u16, value: &[u8]) {
        debug_assert!(option >= self.option, "options stand in the order of their numbers");
        let (delta, length) = (usize::from(option - self.option), value.len());
        self.bytes.push(half(delta) << 4 | half(length));
        for extended in [delta, length] {
            match extended {
                0..13 => {}
                13..269 => self.bytes.push((extended - 13) as u8),
                _ => self.bytes.extend(((extended - 269) as u16).to_be_bytes()),
            }
        }
        self.bytes.extend(value);
        self.option = option;
    }

    /// Adds an option whose value is a number, in the shortest form (RFC 7252, section 3.2).
    pub(super) fn add_number(&mut self, option: u16, value: u32) {
        let skipped = value.leading_zeros() / 8;
        self.add(option, &value.to_be_bytes()[skipped as usize..]);
    }

    /// Adds the payload; no option may follow it.
    pub(super) fn carry(&mut self, payload: &[u8]) {
        if !payload.is_empty() {
            self.bytes.push(0xFF);
            self.bytes.extend(payload);
        }
    }

    pub(super) fn length(&self) -> usize {
        self.bytes.len()
    }

    pub(super) fn datagram(mut self, kind: MessageKind, id: u16) -> Vec<u8> {
        self.bytes[0] = self.bytes[0] & 0xCF | kind as u8;
        self.bytes[2..4].copy_from_slice(&id.to_be_bytes());
        self.bytes
    }
}

/// The four bits for an option's delta or length in its first byte (RFC 7252, section 3.1).
const fn half(value: usize) -> u8 {
    match value {
        0..13 => value as u8,
        13..269 => 13,
        _ => 14,
    }
}

const fn kind(first: u8) -> MessageKind {
    match (first >> 4) & 3 {
        0 => MessageKind::Con,
        1 => MessageKind::Non,
        2 => MessageKind::Ack,
        _ => MessageKind::Rst,
    }
}

/// Length in bytes of the packet when it is written. A received datagram that is longer than this ended in a payload
/// marker without a payload.
fn written_length(packet: &Packet) -> usize {
    let mut before = 0;
    let mut length = 4 + packet.get_token().len();
    for (number, values) in packet.options() {
        for value in values {
            length += 1 + extended(usize::from(number - before)) + extended(value.len()) + value.len();
            before = *number;
        }
    }
    length + if packet.payload.is_empty() { 0 } else { 1 + packet.payload.len() }
}

/// Number of bytes that an option's delta or length takes beyond its four bits (RFC 7252, section 3.1).
const fn extended(value: usize) -> usize {
    match value {
        0..13 => 0,
        13..269 => 1,
        _ => 2,
    }
}

#[cfg(test)]
mod tests {
    use coap_lite::CoapOption;

    use super::*;

    fn is_malformed(bytes: &[u8]) -> bool {
        matches!(parse(bytes), Received::Malformed(MessageKind::Con, 0x1234))
    }

    #[test]
    fn what_is_no_message_of_this_version_is_nothing() {
        for bytes in [&[][..], &[0x40], &[0x40, 1, 2], &[0x80, 1, 0x12, 0x34], &[0x00, 1, 0x12, 0x34], &[0xC0, 0, 1, 2]] {
            assert!(matches!(parse(bytes), Received::Nothing), "{bytes:?}");
        }
    }

    #[test]
    fn a_message_that_breaks_the_grammar_makes_no_sense() {
        assert!(is_malformed(&[0x49, 1, 0x12, 0x34, 0, 0, 0, 0, 0, 0, 0, 0, 0]), "a token of nine bytes");
        assert!(is_malformed(&[0x42, 1, 0x12, 0x34, 0]), "half a token");
        assert!(is_malformed(&[0x40, 1, 0x12, 0x34, 0xFF]), "a marker without a payload");
        assert!(is_malformed(&[0x40, 1, 0x12, 0x34, 0xB1, b'a', 0xFF]), "a marker after an option");
        assert!(is_malformed(&[0x40, 1, 0x12, 0x34, 0xF1, 0]), "a reserved delta");
        assert!(is_malformed(&[0x40, 1, 0x12, 0x34, 0xB5, b'a']), "half an option");
        assert!(is_malformed(&[0x40, 0, 0x12, 0x34, 0]), "an empty message with a payload");
        assert!(is_malformed(&[0x41, 0, 0x12, 0x34, 9]), "an empty message with a token");
        assert!(is_malformed(&[0x40, 0x45, 0x12, 0x34]), "a response to nobody");
    }

    #[test]
    fn a_value_that_ends_in_the_markers_byte_is_a_value() {
        let Received::Request(incoming) = parse(&[0x40, 1, 0x12, 0x34, 0xB1, 0xFF]) else { panic!("it is a request") };
        assert_eq!(incoming.packet.get_first_option(CoapOption::UriPath), Some(&vec![0xFF]));
    }

    #[test]
    fn what_is_written_is_read_again() {
        let mut message = Outgoing::new(Code(3), Token::new(b"tok"), 7);
        message.add(11, &[b'x'; 300]);
        message.add(11, &[b'y'; 13]);
        message.add_number(258, 0x0001_0203);
        message.add_number(65000, 0);
        message.carry(b"payload");
        let Received::Request(read) = parse(&message.datagram(MessageKind::Non, 77)) else { panic!("it is a request") };
        assert_eq!((read.kind, read.code, read.id, read.token), (MessageKind::Non, Code(3), 77, Token::new(b"tok")));
        assert_eq!(read.packet.payload, b"payload");
        let paths = read.packet.get_option(CoapOption::UriPath).map(|paths| paths.iter().map(Vec::len).collect::<Vec<_>>());
        assert_eq!(paths, Some(vec![300, 13]));
        assert_eq!(read.packet.get_first_option(CoapOption::from(258)), Some(&vec![1, 2, 3]));
        assert_eq!(read.packet.get_first_option(CoapOption::from(65000)), Some(&vec![]));
    }

    #[test]
    fn an_empty_message_is_four_bytes() {
        assert_eq!(empty(MessageKind::Rst, 0x1234), [0x70, 0, 0x12, 0x34]);
        assert!(matches!(parse(&empty(MessageKind::Ack, 5)), Received::Ack(5)));
        assert!(matches!(parse(&empty(MessageKind::Rst, 5)), Received::Rst(5)));
    }
}
