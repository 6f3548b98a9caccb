//! CoAP datagrams as plain bytes: requests are built once and numbered when they are sent, and answers are parsed in
//! place. This module does not use hallsweep's codec, so that an error in the codec cannot hide itself.

pub(crate) const GET: u8 = 1;
pub(crate) const POST: u8 = 2;
pub(crate) const PUT: u8 = 3;

/// Codes 2.05 and 2.31.
pub(crate) const CONTENT: u8 = 0x45;
pub(crate) const CONTINUE: u8 = 0x5F;

/// Option numbers (RFC 7252 §5.10, RFC 7641 and RFC 7959).
pub(crate) const OBSERVE: u16 = 6;
pub(crate) const FORMAT: u16 = 12;
pub(crate) const BLOCK2: u16 = 23;
pub(crate) const BLOCK1: u16 = 27;
const URI_PATH: u16 = 11;

/// Content-Format of `application/json`.
pub(crate) const JSON: u8 = 50;

/// SZX value of the Block options for blocks of 1,024 bytes.
pub(crate) const SZX_1024: u32 = 6;

/// A confirmable request with a token of four bytes.
#[derive(Clone)]
pub(crate) struct Asking(Vec<u8>);

impl Asking {
    /// Builds a request for a resource; `options` may be in any order.
    pub(crate) fn new(method: u8, path: &str, options: &[(u16, &[u8])], payload: &[u8]) -> Asking {
        let segments = path.split('/').filter(|segment| !segment.is_empty());
        let mut all: Vec<(u16, &[u8])> = segments.map(|segment| (URI_PATH, segment.as_bytes())).collect();
        all.extend(options);
        all.sort_by_key(|(number, _)| *number);
        let mut bytes = vec![0x44, method, 0, 0, 0, 0, 0, 0];
        let mut before = 0;
        for (number, value) in all {
            option(&mut bytes, number - before, value);
            before = number;
        }
        if !payload.is_empty() {
            bytes.push(0xFF);
            bytes.extend_from_slice(payload);
        }
        Asking(bytes)
    }

    /// Sets the message id and the token, and returns the bytes.
    pub(crate) fn numbered(&mut self, id: u16, token: u32) -> &[u8] {
        self.0[2..4].copy_from_slice(&id.to_be_bytes());
        self.0[4..8].copy_from_slice(&token.to_be_bytes());
        &self.0
    }
}

fn option(bytes: &mut Vec<u8>, delta: u16, value: &[u8]) {
    let length = u16::try_from(value.len()).expect("an option is short");
    let (delta, more_delta) = nibble(delta);
    let (length, more_length) = nibble(length);
    bytes.push(delta << 4 | length);
    bytes.extend(more_delta.into_iter().chain(more_length));
    bytes.extend_from_slice(value);
}

/// Encodes a number below 269 as four bits and, from 13 on, one more byte.
fn nibble(number: u16) -> (u8, Option<u8>) {
    match number {
        0..13 => (number as u8, None),
        _ => (13, Some(u8::try_from(number - 13).expect("numbers here are below 269"))),
    }
}

/// Value of a Block option with blocks of 1,024 bytes.
pub(crate) fn block(number: u32, more: bool) -> [u8; 3] {
    let value = (number << 4 | u32::from(more) << 3 | SZX_1024).to_be_bytes();
    [value[1], value[2], value[3]]
}

pub(crate) fn acknowledgement(id: u16) -> [u8; 4] {
    let id = id.to_be_bytes();
    [0x60, 0, id[0], id[1]]
}

/// Message that came from a server.
pub(crate) struct Told<'a> {
    /// Whether the message must be acknowledged.
    pub(crate) confirmable: bool,
    pub(crate) code: u8,
    pub(crate) id: u16,
    /// Token of four bytes in the order sent; `None` when the token has another length.
    pub(crate) token: Option<u32>,
    pub(crate) payload: &'a [u8],
}

impl Told<'_> {
    /// Parses a message; `None` when the bytes are not a message.
    pub(crate) fn read(bytes: &[u8]) -> Option<Told<'_>> {
        let [first, code, high, low, ..] = *bytes else { return None };
        let token = bytes.get(4..4 + usize::from(first & 0xF))?;
        Some(Told {
            confirmable: first >> 4 & 3 == 0,
            code,
            id: u16::from_be_bytes([high, low]),
            token: token.try_into().ok().map(u32::from_be_bytes),
            payload: payload(&bytes[4 + token.len()..])?,
        })
    }
}

/// Bytes after the options and the payload marker.
fn payload(mut rest: &[u8]) -> Option<&[u8]> {
    while let Some((first, after)) = rest.split_first() {
        if *first == 0xFF {
            return Some(after);
        }
        let (_, after) = wide(first >> 4, after)?;
        let (length, after) = wide(first & 0xF, after)?;
        rest = after.get(length..)?;
    }
    Some(&[])
}

/// Decodes an option's delta or length from its four bits and the extended bytes; also returns the bytes that follow.
fn wide(bits: u8, rest: &[u8]) -> Option<(usize, &[u8])> {
    match bits {
        13 => rest.split_first().map(|(byte, rest)| (usize::from(*byte) + 13, rest)),
        14 => rest.split_first_chunk().map(|(bytes, rest)| (usize::from(u16::from_be_bytes(*bytes)) + 269, rest)),
        15 => None,
        bits => Some((usize::from(bits), rest)),
    }
}
