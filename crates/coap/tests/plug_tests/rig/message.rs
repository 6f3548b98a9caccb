//! Messages as tests write and read them, on coap-lite's packets. Reading is strict: a message that is not in the one
//! shortest form, or ends in a marker without payload, fails the test. What a message means is not here.

use std::fmt;

use coap_endpoint::{Code, Method};
use coap_lite::{CoapOption, MessageClass, MessageType, Packet};

pub(crate) mod option {
    pub(crate) const IF_MATCH: u16 = 1;
    pub(crate) const ETAG: u16 = 4;
    pub(crate) const IF_NONE_MATCH: u16 = 5;
    pub(crate) const OBSERVE: u16 = 6;
    pub(crate) const LOCATION_PATH: u16 = 8;
    pub(crate) const URI_PATH: u16 = 11;
    pub(crate) const CONTENT_FORMAT: u16 = 12;
    pub(crate) const MAX_AGE: u16 = 14;
    pub(crate) const URI_QUERY: u16 = 15;
    pub(crate) const ACCEPT: u16 = 17;
    pub(crate) const LOCATION_QUERY: u16 = 20;
    pub(crate) const BLOCK2: u16 = 23;
    pub(crate) const BLOCK1: u16 = 27;
    pub(crate) const SIZE2: u16 = 28;
    pub(crate) const PROXY_URI: u16 = 35;
    pub(crate) const PROXY_SCHEME: u16 = 39;
    pub(crate) const SIZE1: u16 = 60;
    pub(crate) const ECHO: u16 = 252;
    pub(crate) const NO_RESPONSE: u16 = 258;
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Con,
    Non,
    Ack,
    Rst,
}

/// A block option's value: number, whether more follow, size exponent.
pub(crate) type Block = (u32, bool, u8);

#[derive(Clone, PartialEq, Eq)]
pub(crate) struct Message {
    pub(crate) kind: Kind,
    pub(crate) code: Code,
    pub(crate) id: u16,
    pub(crate) token: Vec<u8>,
    pub(crate) options: Vec<(u16, Vec<u8>)>,
    pub(crate) payload: Vec<u8>,
}

impl Message {
    pub(crate) fn con(method: Method, id: u16) -> Message {
        Message { kind: Kind::Con, code: method.code(), id, token: Vec::new(), options: Vec::new(), payload: Vec::new() }
    }

    pub(crate) fn non(method: Method, id: u16) -> Message {
        Message { kind: Kind::Non, ..Message::con(method, id) }
    }

    pub(crate) fn get(path: &str, id: u16) -> Message {
        Message::con(Method::Get, id).path(path)
    }

    pub(crate) fn empty(kind: Kind, id: u16) -> Message {
        Message { kind, code: Code::EMPTY, ..Message::con(Method::Get, id) }
    }

    pub(crate) fn token(mut self, token: &[u8]) -> Message {
        self.token = token.to_vec();
        self
    }

    /// Sets the path and the query, from a text such as `/obs?a=b&c`.
    pub(crate) fn path(mut self, path: &str) -> Message {
        let (path, query) = path.split_once('?').unwrap_or((path, ""));
        for segment in path.split('/').skip(1).filter(|segment| !segment.is_empty()) {
            self = self.with(option::URI_PATH, segment.as_bytes());
        }
        for part in query.split('&').filter(|part| !part.is_empty()) {
            self = self.with(option::URI_QUERY, part.as_bytes());
        }
        self
    }

    pub(crate) fn with(mut self, number: u16, value: &[u8]) -> Message {
        self.options.push((number, value.to_vec()));
        self
    }

    pub(crate) fn number(self, number: u16, value: u32) -> Message {
        let bytes = value.to_be_bytes();
        let skipped = bytes.iter().take_while(|byte| **byte == 0).count();
        self.with(number, &bytes[skipped..])
    }

    pub(crate) fn observe(self, value: u32) -> Message {
        self.number(option::OBSERVE, value)
    }

    pub(crate) fn accept(self, format: u16) -> Message {
        self.number(option::ACCEPT, u32::from(format))
    }

    pub(crate) fn block1(self, block: Block) -> Message {
        self.number(option::BLOCK1, block_value(block))
    }

    pub(crate) fn block2(self, block: Block) -> Message {
        self.number(option::BLOCK2, block_value(block))
    }

    pub(crate) fn payload(mut self, payload: impl AsRef<[u8]>) -> Message {
        self.payload = payload.as_ref().to_vec();
        self
    }

    pub(crate) fn encoded(&self) -> Vec<u8> {
        let mut packet = Packet::new();
        packet.header.set_type(match self.kind {
            Kind::Con => MessageType::Confirmable,
            Kind::Non => MessageType::NonConfirmable,
            Kind::Ack => MessageType::Acknowledgement,
            Kind::Rst => MessageType::Reset,
        });
        packet.header.code = MessageClass::from(self.code.0);
        packet.header.message_id = self.id;
        packet.set_token(self.token.clone());
        for (number, value) in &self.options {
            packet.add_option(CoapOption::from(*number), value.clone());
        }
        packet.payload.clone_from(&self.payload);
        packet.to_bytes_unlimited().expect("the codec refuses nothing but what is too long")
    }

    pub(crate) fn decoded(bytes: &[u8]) -> Message {
        let packet = Packet::from_bytes(bytes).unwrap_or_else(|error| panic!("not a message, {error}: {bytes:02x?}"));
        assert_eq!(packet.header.get_version(), 1, "{bytes:02x?}");
        let kind = match packet.header.get_type() {
            MessageType::Confirmable => Kind::Con,
            MessageType::NonConfirmable => Kind::Non,
            MessageType::Acknowledgement => Kind::Ack,
            MessageType::Reset => Kind::Rst,
        };
        let options = packet.options().flat_map(|(number, values)| values.iter().map(|value| (*number, value.clone())));
        let message = Message {
            kind,
            code: Code(u8::from(packet.header.code)),
            id: packet.header.message_id,
            token: packet.get_token().to_vec(),
            options: options.collect(),
            payload: packet.payload.clone(),
        };
        assert_eq!(message.encoded(), bytes, "it is not written in the shortest way: {message:?}");
        message
    }

    pub(crate) fn values(&self, number: u16) -> Vec<&[u8]> {
        self.options.iter().filter(|(known, _)| *known == number).map(|(_, value)| value.as_slice()).collect()
    }

    pub(crate) fn texts(&self, number: u16) -> Vec<String> {
        self.values(number).into_iter().map(|value| String::from_utf8_lossy(value).into_owned()).collect()
    }

    /// An option's value as a number; the option must not be repeated.
    pub(crate) fn value(&self, number: u16) -> Option<u32> {
        let values = self.values(number);
        assert!(values.len() < 2, "option {number} is there {} times: {self:?}", values.len());
        values.first().map(|value| value.iter().fold(0, |so_far, byte| (so_far << 8) | u32::from(*byte)))
    }

    pub(crate) fn block(&self, number: u16) -> Option<Block> {
        self.value(number).map(|value| (value >> 4, value & 8 != 0, u8::try_from(value & 7).expect("three bits")))
    }

    pub(crate) fn observed(&self) -> Option<u32> {
        self.value(option::OBSERVE)
    }

    pub(crate) fn text(&self) -> String {
        String::from_utf8_lossy(&self.payload).into_owned()
    }

    /// Fails unless it acknowledges that request and answers it with this code.
    #[track_caller]
    pub(crate) fn answers(&self, request: &Message, code: Code) {
        assert_eq!((self.kind, self.id), (Kind::Ack, request.id), "it is no acknowledgement: {self:?}");
        assert_eq!((self.code, &self.token), (code, &request.token), "{self:?}");
    }
}

impl fmt::Debug for Message {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?} {} id {} token {:02x?}", self.kind, self.code, self.id, self.token)?;
        for (number, value) in &self.options {
            write!(f, " [{number}: {}]", value.escape_ascii())?;
        }
        let shown = &self.payload[..self.payload.len().min(80)];
        write!(f, " {} bytes \"{}\"", self.payload.len(), shown.escape_ascii())
    }
}

fn block_value((number, more, exponent): Block) -> u32 {
    (number << 4) | (u32::from(more) << 3) | u32::from(exponent)
}
