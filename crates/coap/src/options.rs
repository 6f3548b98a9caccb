//! The options of a request (RFC 7252, section 5.10, and the other RFCs), read once and strictly. A critical option
//! that is unknown, repeated or of the wrong length is refused; an elective option with such a fault is ignored.

use std::net::SocketAddr;

use coap_lite::{CoapOption, Packet};

use super::block::Block;
use super::code::{Code, Method};
use super::format::Format;
use super::message::Incoming;
use super::request::{Conditions, Request};
use super::response::{ETag, Response};

pub(super) mod number {
    pub(crate) const IF_MATCH: u16 = 1;
    pub(crate) const URI_HOST: u16 = 3;
    pub(crate) const ETAG: u16 = 4;
    pub(crate) const IF_NONE_MATCH: u16 = 5;
    pub(crate) const OBSERVE: u16 = 6;
    pub(crate) const URI_PORT: u16 = 7;
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
    pub(crate) const REQUEST_TAG: u16 = 292;
}

use number::{
    ACCEPT, BLOCK1, BLOCK2, CONTENT_FORMAT, ECHO, ETAG, IF_MATCH, IF_NONE_MATCH, NO_RESPONSE, OBSERVE, PROXY_SCHEME, PROXY_URI,
    REQUEST_TAG, SIZE1, SIZE2, URI_HOST, URI_PATH, URI_PORT, URI_QUERY,
};

/// A request, with the options that the endpoint itself handles.
#[derive(Debug)]
pub(super) struct ParsedRequest {
    /// The request for the application, with the payload of this message only.
    pub(super) request: Request,
    pub(super) etags: Vec<ETag>,
    /// 0 to register an observer, 1 to deregister it.
    pub(super) observe: Option<u32>,
    pub(super) block1: Option<Block>,
    /// The requested block of the answer (RFC 7959, section 2.2).
    pub(super) block2: Option<Block>,
    pub(super) wants_size: bool,
    /// The announced length of the request's body, in bytes.
    pub(super) size1: Option<u32>,
    /// Request-Tag (RFC 9175, section 3): distinguishes bodies to the same path.
    pub(super) request_tags: Vec<Vec<u8>>,
    pub(super) echo: Option<Vec<u8>>,
}

/// Minimum and maximum length of a critical option's value in bytes, and whether the option may be repeated. `None`
/// for an unknown option.
const fn critical(number: u16) -> Option<(usize, usize, bool)> {
    Some(match number {
        IF_MATCH => (0, 8, true),
        URI_HOST => (1, 255, false),
        IF_NONE_MATCH => (0, 0, false),
        URI_PORT | ACCEPT => (0, 2, false),
        URI_PATH | URI_QUERY => (0, 255, true),
        BLOCK2 | BLOCK1 => (0, 3, false),
        _ => return None,
    })
}

/// Reads a request. The error is 4.02 for an unknown critical option, 4.00 for an impossible block, 4.05 for an
/// unknown method, and 5.05 for a request to a proxy.
pub(super) fn read(peer: SocketAddr, incoming: Incoming) -> Result<ParsedRequest, Response> {
    let Incoming { code, mut packet, .. } = incoming;
    if packet.get_option(CoapOption::from(PROXY_URI)).is_some() || packet.get_option(CoapOption::from(PROXY_SCHEME)).is_some() {
        return Err(Response::refusal(Code::NO_PROXY, "this server is no proxy: request its own resources"));
    }
    check_critical(&packet)?;
    let Some(method) = Method::of(code) else {
        return Err(Response::refusal(Code::METHOD_NOT_ALLOWED, format!("there is no method {code}")));
    };
    let payload = std::mem::take(&mut packet.payload);
    let tags = |number| values(&packet, number).map(|value| ETag::new(value)).collect::<Vec<Option<ETag>>>();
    let request = Request {
        peer,
        method,
        path: texts(&packet, URI_PATH)?,
        queries: texts(&packet, URI_QUERY)?,
        format: number_of(&packet, CONTENT_FORMAT, 2).and_then(format),
        accept: number_of(&packet, ACCEPT, 2).and_then(format),
        conditions: Conditions {
            if_match: tags(IF_MATCH),
            if_none_match: packet.get_option(CoapOption::from(IF_NONE_MATCH)).is_some(),
        },
        payload,
    };
    Ok(ParsedRequest {
        etags: tags(ETAG).into_iter().flatten().collect(),
        observe: number_of(&packet, OBSERVE, 3),
        block1: block(&packet, BLOCK1)?,
        block2: block(&packet, BLOCK2)?,
        wants_size: number_of(&packet, SIZE2, 4).is_some(),
        size1: number_of(&packet, SIZE1, 4),
        request_tags: values(&packet, REQUEST_TAG).filter(|tag| tag.len() <= 8).cloned().collect(),
        echo: values(&packet, ECHO).next().cloned(),
        request,
    })
}

/// The classes of answers that are not wanted, as bits (RFC 7967); 0 if all are wanted.
pub(super) fn no_response(packet: &Packet) -> u32 {
    number_of(packet, NO_RESPONSE, 1).unwrap_or(0)
}

/// The method and path of a request in words, as far as they can be read: `POST /commands/start`.
pub(super) fn asked(incoming: &Incoming) -> String {
    let method = Method::of(incoming.code).map_or_else(|| incoming.code.to_string(), |method| method.name().to_owned());
    let segments = values(&incoming.packet, URI_PATH).take(ASKED_SEGMENTS);
    let path: String = segments.map(|segment| format!("/{}", String::from_utf8_lossy(segment))).collect();
    format!("{method} {}", path.chars().take(ASKED_LETTERS).collect::<String>())
}

/// Maximum number of segments of a path in the record.
const ASKED_SEGMENTS: usize = 8;

/// Maximum number of letters of a path in the record, enough to recognise it.
const ASKED_LETTERS: usize = 60;

fn check_critical(packet: &Packet) -> Result<(), Response> {
    let bad = |words: String| Err(Response::refusal(Code::BAD_OPTION, words));
    for (number, values) in packet.options().filter(|(number, _)| **number % 2 == 1) {
        let Some((least, most, repeatable)) = critical(*number) else {
            return bad(format!("option {number} is not supported"));
        };
        if values.len() > 1 && !repeatable {
            return bad(format!("option {number} occurs more than once"));
        }
        if values.iter().any(|value| !(least..=most).contains(&value.len())) {
            return bad(format!("option {number} must have {least} to {most} bytes"));
        }
    }
    Ok(())
}

fn values(packet: &Packet, number: u16) -> impl Iterator<Item = &Vec<u8>> {
    packet.get_option(CoapOption::from(number)).into_iter().flatten()
}

fn texts(packet: &Packet, number: u16) -> Result<Vec<String>, Response> {
    let text = |value: &Vec<u8>| {
        let no_text = |_| Response::refusal(Code::BAD_OPTION, format!("option {number} is not UTF-8"));
        String::from_utf8(value.clone()).map_err(no_text)
    };
    values(packet, number).map(text).collect()
}

/// The first value of an option as a number; a value that is too long counts as absent.
fn number_of(packet: &Packet, number: u16, longest: usize) -> Option<u32> {
    let value = values(packet, number).next().filter(|value| value.len() <= longest)?;
    Some(value.iter().fold(0, |so_far, byte| (so_far << 8) | u32::from(*byte)))
}

fn format(number: u32) -> Option<Format> {
    u16::try_from(number).ok().map(Format)
}

fn block(packet: &Packet, number: u16) -> Result<Option<Block>, Response> {
    let Some(value) = number_of(packet, number, 3) else { return Ok(None) };
    let reserved = "a block must have 16 to 1024 bytes: the size exponent 7 is reserved";
    Block::of(value).map(Some).ok_or_else(|| Response::refusal(Code::BAD_REQUEST, reserved))
}

#[cfg(test)]
mod tests {
    use super::super::message::{MessageKind, Token};
    use super::*;

    fn packet(options: &[(u16, &[u8])]) -> Incoming {
        let mut packet = Packet::new();
        for (number, value) in options {
            packet.add_option(CoapOption::from(*number), value.to_vec());
        }
        Incoming { kind: MessageKind::Con, id: 1, token: Token::default(), code: Code(1), packet }
    }

    fn refused(options: &[(u16, &[u8])]) -> Code {
        let peer = "127.0.0.1:1".parse().unwrap();
        read(peer, packet(options)).unwrap_err().code
    }

    fn read_of(options: &[(u16, &[u8])]) -> ParsedRequest {
        let peer = "127.0.0.1:1".parse().unwrap();
        read(peer, packet(options)).unwrap()
    }

    #[test]
    fn a_critical_option_that_is_not_understood_is_refused() {
        assert_eq!(refused(&[(9, b"")]), Code::BAD_OPTION, "OSCORE");
        assert_eq!(refused(&[(65_001, b"")]), Code::BAD_OPTION);
        assert_eq!(refused(&[(ACCEPT, b"\0"), (ACCEPT, b"\0")]), Code::BAD_OPTION, "twice");
        assert_eq!(refused(&[(ACCEPT, b"\0\0\0")]), Code::BAD_OPTION, "too long");
        assert_eq!(refused(&[(URI_HOST, b"")]), Code::BAD_OPTION, "too short");
        assert_eq!(refused(&[(URI_PATH, b"\xFF")]), Code::BAD_OPTION, "no text");
        assert_eq!(refused(&[(PROXY_URI, b"coap://x")]), Code::NO_PROXY);
        assert_eq!(refused(&[(PROXY_SCHEME, b"coap")]), Code::NO_PROXY);
        assert_eq!(refused(&[(BLOCK2, &[7])]), Code::BAD_REQUEST, "a reserved size");
    }

    #[test]
    fn an_elective_option_that_is_not_understood_is_passed_over() {
        let read = read_of(&[(65_000, b"x"), (OBSERVE, b"\0\0\0\0"), (CONTENT_FORMAT, b"\0\0\x32"), (URI_PATH, b"map")]);
        assert_eq!((read.observe, read.request.format), (None, None), "of the wrong length");
        assert_eq!(read.request.path, ["map"]);
    }

    #[test]
    fn options_say_what_they_say() {
        let block: u32 = (5000 << 4) | 6;
        let options: [(u16, &[u8]); 8] = [
            (URI_PATH, b"lamps"),
            (URI_PATH, b"3"),
            (URI_QUERY, b"a=b"),
            (IF_MATCH, b""),
            (ETAG, b"t"),
            (ACCEPT, &[60]),
            (OBSERVE, b""),
            (BLOCK2, &block.to_be_bytes()[1..]),
        ];
        let read = read_of(&options);
        assert_eq!(read.request.path_text(), "/lamps/3");
        assert_eq!((read.request.accept, read.observe), (Some(Format::CBOR), Some(0)));
        assert_eq!(read.request.conditions.if_match, [None]);
        assert_eq!(read.etags, [ETag::new(b"t").unwrap()]);
        assert_eq!(read.block2.map(|block| (block.number, block.size())), Some((5000, 1024)));
    }
}
