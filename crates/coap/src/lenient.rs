//! Reads as much as possible of a malformed request, which the strict reader refuses. So an urgent request takes
//! effect even if it is malformed. The application decides which requests are urgent. `inward` sends the refusal.

use std::iter;
use std::net::SocketAddr;

use super::code::{Code, Method};
use super::limits::BODY;
use super::options::number::{PROXY_URI, URI_PATH};
use super::request::{Conditions, Request};

/// Length of the header in bytes. The token follows it.
const HEADER: usize = 4;

/// The byte between options and payload (RFC 7252, section 3).
const MARKER: u8 = 0xFF;

/// The longest token, in bytes (RFC 7252, section 3).
const TOKEN: usize = 8;

/// Maximum number of options that are read, so that no datagram takes long.
const OPTIONS: usize = 128;

/// Whether a message with this code may ask for a change. Also true for request codes of unknown methods.
pub(super) fn is_command(code: Code) -> bool {
    code.class() == 0 && !Method::of(code).is_some_and(Method::is_safe)
}

/// Reads the datagram in every possible way: one request for each possible length of its token. The length that the
/// datagram states comes first, as RFC 7252 and RFC 8974 define it, and then every other length. Requests that only
/// read are skipped, and so are messages that are no requests.
pub(super) fn requests(peer: SocketAddr, bytes: &[u8]) -> impl Iterator<Item = Request> {
    let (code, said) = (bytes.get(1).copied().map_or(Code::CONTENT, Code), bytes.first().map_or(0, |first| first & 0x0F));
    let method = Method::of(code).unwrap_or(Method::Post);
    let tokens = is_command(code).then(|| token_lengths(said, bytes)).into_iter().flatten();
    tokens.filter_map(move |token| request(peer, method, bytes.get(HEADER + token..)?))
}

/// The possible lengths of the token, including the bytes of an extended length. The lengths that the four bits may
/// state come first, then all other lengths.
fn token_lengths(bits: u8, bytes: &[u8]) -> impl Iterator<Item = usize> + use<> {
    let (said, rest) = (usize::from(bits), bytes.get(HEADER..).unwrap_or_default());
    let extended = extended(bits, rest).map(|(length, after)| rest.len() - after.len() + length);
    iter::once(said).chain(extended.filter(|length| *length != said)).chain((0..=TOKEN).filter(move |length| *length != said))
}

/// Reads the request that follows the token. Options are read until one is invalid or cut off. If a payload marker
/// comes next, the payload follows it. Otherwise the payload is what follows the last marker in the remaining bytes,
/// or all of these bytes if they have no marker. It may be the command of an old client. Returns `None` if the
/// options name no path.
fn request(peer: SocketAddr, method: Method, mut rest: &[u8]) -> Option<Request> {
    let (mut path, mut proxy, mut number) = (Vec::new(), None, 0_usize);
    for _ in 0..OPTIONS {
        let Some((delta, value, after)) = option(rest) else { break };
        number = number.saturating_add(delta);
        if number == usize::from(URI_PATH) {
            path.push(String::from_utf8_lossy(value).into_owned());
        } else if number == usize::from(PROXY_URI) {
            proxy.get_or_insert(value);
        }
        rest = after;
    }
    if let Some(proxy) = proxy.filter(|_| path.is_empty()) {
        path = segments(proxy);
    }
    if path.is_empty() {
        return None;
    }
    let payload = match rest {
        [MARKER, payload @ ..] => payload,
        _ => rest.iter().rposition(|byte| *byte == MARKER).map_or(rest, |marker| &rest[marker + 1..]),
    };
    // Only the first `BODY` bytes are read, because a command is at the beginning of the payload.
    let payload = payload[..payload.len().min(BODY)].to_vec();
    Some(Request {
        peer,
        method,
        path,
        queries: Vec::new(),
        format: None,
        accept: None,
        conditions: Conditions::default(),
        payload,
    })
}

/// The path segments of an absolute URI, like the values of Uri-Path (RFC 7252, section 5.10.2). The host does not
/// matter.
fn segments(address: &[u8]) -> Vec<String> {
    let address = String::from_utf8_lossy(address);
    let address = address.split(['?', '#']).next().unwrap_or_default();
    let behind = address.split_once("://").map_or(address, |(_, behind)| behind.split_once('/').map_or("", |(_, path)| path));
    behind.split('/').filter(|segment| !segment.is_empty()).map(str::to_owned).collect()
}

/// Reads the first option: the delta of its number, the part of its value that has arrived, and the bytes after the
/// option. `None` for a reserved form, or if the head of the option is cut off.
fn option(bytes: &[u8]) -> Option<(usize, &[u8], &[u8])> {
    let (head, rest) = bytes.split_first()?;
    let (delta, rest) = extended(head >> 4, rest)?;
    let (length, rest) = extended(head & 0x0F, rest)?;
    let (value, after) = rest.split_at(length.min(rest.len()));
    Some((delta, value, after))
}

fn extended(half: u8, rest: &[u8]) -> Option<(usize, &[u8])> {
    match (half, rest) {
        (0..13, rest) => Some((usize::from(half), rest)),
        (13, [more, rest @ ..]) => Some((13 + usize::from(*more), rest)),
        (14, [high, low, rest @ ..]) => Some((269 + usize::from(u16::from_be_bytes([*high, *low])), rest)),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::super::message::{MessageKind, Outgoing, Token};
    use super::*;

    fn peer() -> SocketAddr {
        "127.0.0.1:40000".parse().unwrap()
    }

    fn message(code: u8, token: &[u8], options: &[(u16, &[u8])], payload: &[u8]) -> Vec<u8> {
        let mut message = Outgoing::new(Code(code), Token::new(token), 0);
        options.iter().for_each(|(number, value)| message.add(*number, value));
        message.carry(payload);
        message.datagram(MessageKind::Con, 1)
    }

    fn reads(bytes: &[u8], path: &[&str], payload: &[u8]) -> bool {
        requests(peer(), bytes).any(|request| request.path == path && request.payload == payload)
    }

    const URGENT: [(u16, &[u8]); 2] = [(URI_PATH, b"commands"), (URI_PATH, b"stop")];
    const PATH: [&str; 2] = ["commands", "stop"];

    #[test]
    fn what_is_sound_is_read_as_it_is() {
        let options = [URGENT[0], URGENT[1], (15, &b"id=1"[..]), (2049, &[0; 300])];
        assert!(reads(&message(2, b"tokn", &options, b"body"), &PATH, b"body"));
    }

    #[test]
    fn a_path_is_read_whatever_breaks_the_grammar_behind_it() {
        let sound = message(2, b"", &URGENT, b"");
        for broken in
            [&b"\xFF"[..], b"\xF0", b"\x0F", b"\xD0", b"\xE0\x00", b"\x45abc", b"\x0E\xFF\xFF", b"\xE0\xFF\xFF\xE0\xFF\xFF"]
        {
            let bytes = [&sound[..], broken].concat();
            assert!(requests(peer(), &bytes).any(|request| request.path.starts_with(&PATH.map(str::to_owned))), "{broken:?}");
        }
        assert!(reads(&sound[..sound.len() - 1], &["commands", "sto"], b""), "what is cut is read as far as it came");
    }

    #[test]
    fn a_token_of_any_length_is_passed_over() {
        for bits in 0..16_u8 {
            for token in [0, 3, 8, usize::from(bits)] {
                let mut bytes = message(2, b"", &URGENT, b"");
                bytes[0] |= bits;
                bytes.splice(4..4, vec![0x33; token]);
                assert!(reads(&bytes, &PATH, b""), "{bits} said, {token} there");
            }
        }
        let long = |bits: u8, length: &[u8], token: usize| {
            let mut bytes = message(2, b"", &URGENT, b"");
            bytes[0] |= bits;
            bytes.splice(4..4, [length, &vec![0x33; token]].concat());
            bytes
        };
        assert!(reads(&long(13, &[7], 20), &PATH, b"") && reads(&long(14, &[0, 1], 270), &PATH, b""), "RFC 8974");
    }

    #[test]
    fn a_payload_is_found_behind_what_breaks_the_grammar_and_without_its_marker() {
        let sound = message(3, b"t", &[(URI_PATH, b"resourcemodel")], b"");
        for tail in [&b"\xFFh"[..], b"\xF0\x01\xFFh", b"\xFEh\xFFh", b"\xF0\xFFx\xFFh"] {
            assert!(reads(&[&sound[..], tail].concat(), &["resourcemodel"], b"h"), "{tail:?}");
        }
        assert!(reads(&[&sound[..], b"\xF0h"].concat(), &["resourcemodel"], b"\xF0h"));
        assert!(reads(&[&sound[..], b"\xFFh\xFFx"].concat(), &["resourcemodel"], b"h\xFFx"), "the first marker is one");
    }

    #[test]
    fn a_path_that_comes_as_a_whole_address_is_read_where_there_is_no_other() {
        for address in ["coap://host:5683/commands/stop", "coap://host//commands/stop/?a=/b#c", "/commands/stop"] {
            assert!(reads(&message(2, b"t", &[(PROXY_URI, address.as_bytes())], b"h"), &PATH, b"h"), "{address}");
        }
        assert!(reads(&message(2, b"", &[URGENT[0], URGENT[1], (PROXY_URI, b"coap://host/map")], b""), &PATH, b""));
        let escaped = message(2, b"t", &[(PROXY_URI, b"coap://host/%63ommands/stop")], b"h");
        assert!(reads(&escaped, &["%63ommands", "stop"], b"h"), "as it is written");
        for none in ["coap://commands", "coap://host/", "", "?/commands/stop"] {
            assert_eq!(requests(peer(), &message(2, b"", &[(PROXY_URI, none.as_bytes())], b"")).count(), 0, "{none}");
        }
    }

    /// Reading one datagram must not delay the other datagrams.
    #[test]
    fn no_more_than_so_many_options_are_read() {
        let many = message(2, b"", &[(URI_PATH, &b""[..]); 60_000], b"");
        assert!(requests(peer(), &many).all(|request| request.path.len() <= OPTIONS));
        let behind = [[(1, &b"x"[..]); 100].as_slice(), &URGENT].concat();
        assert!(reads(&message(2, b"", &behind, b""), &PATH, b""));
    }

    /// Reading one datagram must not delay the other datagrams.
    #[test]
    fn of_a_long_payload_no_more_is_read_than_a_body_may_have() {
        let long = message(2, b"", &URGENT, &[b'x'; 60_000]);
        assert!(requests(peer(), &long).count() > 0 && requests(peer(), &long).all(|request| request.payload.len() <= BODY));
    }

    #[test]
    fn what_only_reads_and_what_is_no_request_is_not_read() {
        for code in 0..=255 {
            let count = requests(peer(), &message(code, b"", &URGENT, b"")).count();
            assert_eq!(count > 0, code < 32 && code != 1 && code != 5, "{code}");
        }
        for short in [&b""[..], b"\x40", b"\x40\x02", b"\x40\x02\x00"] {
            assert_eq!(requests(peer(), short).count(), 0);
        }
    }
}
