//! The words that mean STOP at every door. The body of a move is searched for these words before it is validated, so
//! that even an invalid body can stop the robot (safety S8). The search accepts more forms than the readers of
//! commands do. The doors check the sender and the rest of the body.

use minicbor::Decoder;

use super::{cbor, fields};

/// The words for STOP wherever a move or a bare word is expected, in upper or lower case. Old clients send `h`,
/// people write `stop`.
const HALTS: [&str; 2] = ["h", "stop"];

const MOVE: &str = "move";

/// The name of the field `move` as a short text in CBOR. The text with the word for STOP follows the name.
const MOVE_IN_CBOR: &[u8] = b"\x64move";

pub fn is_halt(word: &str) -> bool {
    HALTS.iter().any(|halt| word.eq_ignore_ascii_case(halt))
}

/// Removes blanks and control characters around a part of a path. A client that adds such characters still means STOP
/// (safety S8).
pub fn bare(part: &str) -> &str {
    part.trim_matches(|letter: char| letter.is_whitespace() || letter.is_control())
}

/// Whether a body is a bare word for STOP. Quotes, blanks and control characters (such as zero bytes) around the word
/// are allowed.
pub fn is_halt_word(body: &[u8]) -> bool {
    let is_round = |letter: char| letter.is_whitespace() || letter.is_control() || matches!(letter, '"' | '\'' | '\u{feff}');
    is_halt(String::from_utf8_lossy(body).trim_matches(is_round))
}

/// Whether the body of a move means STOP. The body may be the bare word, or have the word in the field `move` in
/// JSON, CBOR or a form. Any other text in the body that looks like this field counts as well.
pub fn says_halt(body: &[u8]) -> bool {
    let says_so = |fields: fields::BodyFields| fields.text(MOVE).is_ok_and(|word| word.is_some_and(|word| is_halt(word.trim())));
    is_halt_word(body)
        || fields::fields(body).is_ok_and(says_so)
        || cbor::fields(&mut Decoder::new(body)).is_ok_and(says_so)
        || says_halt_from(body, 0)
        || body.contains(&b'\\') && looks_like_halt(&unescaped(body), true)
}

/// Whether the field `move` with a word for STOP occurs anywhere in the body from the byte `start` on. Takes linear
/// time.
pub fn says_halt_from(body: &[u8], start: usize) -> bool {
    let rest = body.get(start..).unwrap_or_default();
    looks_like_halt_in_cbor(rest) || looks_like_halt(rest, start == 0)
}

/// Whether the field `move` with a word for STOP occurs anywhere in the body as CBOR. The body need not be valid
/// CBOR.
fn looks_like_halt_in_cbor(body: &[u8]) -> bool {
    let is_text = |rest: &[u8]| {
        HALTS.iter().any(|halt| rest.strip_prefix(&[0x60 | halt.len() as u8]).is_some_and(|rest| begins(rest, halt)))
    };
    behind(body, MOVE_IN_CBOR).any(|(_, rest)| is_text(rest))
}

/// Whether the field `move` with a word for STOP occurs anywhere in the body as text. The body need not be valid JSON
/// or a valid form, and may have other fields. If `is_beginning` is false, `body` may begin in the middle of a word,
/// so a field at its first byte does not count.
fn looks_like_halt(body: &[u8], is_beginning: bool) -> bool {
    // UTF-16 and UTF-32 have zero bytes between the letters.
    let letters: Vec<u8> = body.iter().copied().filter(|letter| *letter != 0).collect();
    let is_between = |letter: &u8| letter.is_ascii_whitespace() || matches!(letter, b'"' | b'\'' | b':' | b'=');
    behind(&letters, MOVE.as_bytes()).any(|(before, rest)| {
        let word = rest.iter().position(|letter| !is_between(letter)).map_or(&[][..], |start| &rest[start..]);
        let is_parted = word.len() < rest.len() && before.map_or(is_beginning, |before| !before.is_ascii_alphanumeric());
        // Compares no more letters than a word for STOP has. In a long body the field may occur thousands of times.
        is_parted && HALTS.iter().any(|halt| begins(word, halt) && !word.get(halt.len()).is_some_and(u8::is_ascii_alphanumeric))
    })
}

/// Replaces JSON's escapes of the letters up to U+00FF by the letters, for example `\u0068` by `h`. All letters of
/// the words for STOP are in this range.
fn unescaped(body: &[u8]) -> Vec<u8> {
    let mut plain = Vec::with_capacity(body.len());
    let mut rest = body;
    while let Some((&letter, behind)) = rest.split_first() {
        let digits = behind.get(..5).and_then(|escape| std::str::from_utf8(escape).ok()?.strip_prefix('u'));
        let meant = digits.filter(|_| letter == b'\\').and_then(|digits| u8::from_str_radix(digits, 16).ok());
        plain.push(meant.unwrap_or(letter));
        rest = if meant.is_some() { &behind[5..] } else { behind };
    }
    plain
}

/// Finds each occurrence of `part`, in upper or lower case. Returns the byte before and the bytes after it.
fn behind<'a>(body: &'a [u8], part: &'a [u8]) -> impl Iterator<Item = (Option<u8>, &'a [u8])> {
    let places = body.windows(part.len()).enumerate().filter(|(_, window)| window.eq_ignore_ascii_case(part));
    places.map(|(start, window)| (start.checked_sub(1).map(|before| body[before]), &body[start + window.len()..]))
}

fn begins(rest: &[u8], word: &str) -> bool {
    rest.get(..word.len()).is_some_and(|beginning| beginning.eq_ignore_ascii_case(word.as_bytes()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety S8: a word for STOP is recognised whatever surrounds it.
    #[test]
    fn the_word_is_known_whatever_stands_round_it() {
        for word in ["h", " h\r\n", "\"h\"", "'h'", "\" h \"", "h\0", "\u{feff}h", "\"h", "H", "stop", " STOP ", "\"Stop\""] {
            assert!(is_halt_word(word.as_bytes()) && says_halt(word.as_bytes()), "{word:?}");
        }
        for other in ["", "hh", "w", "h w", "{h}", "\\h", "sto", "stops"] {
            assert!(!is_halt_word(other.as_bytes()) && !says_halt(other.as_bytes()), "{other:?}");
        }
        assert!(!is_halt_word(b"\xffh"));
    }

    /// Safety S8: a move that means STOP is recognised whatever else its body has.
    #[test]
    fn a_move_that_halts_is_known_whatever_else_its_body_says() {
        let bodies: [&[u8]; 32] = [
            br#"{"move":"h"}"#,
            br#"{"move":"H"}"#,
            br#"{"move":"Stop"}"#,
            br#"{"move":" h "}"#,
            br#"{"Move":"h"}"#,
            br#"{"move":"h" "zz":0}"#,
            b"move=h",
            b"epoch=1&move=h&zz=1",
            b"move = stop",
            b"--x\r\nContent-Disposition: form-data; name=\"move\"\r\n\r\nh\r\n--x--",
            b"\xff\xfe{\0\"\0m\0o\0v\0e\0\"\0:\0\"\0h\0\"\0}\0",
            b"\xa1\x64move\x64STOP",
            b"\xa2\x64move\x61H\x62zz\xff and more",
            br#" { "move" : "h" } "#,
            br#"{"move":"h","zz":0}"#,
            br#"{"zz":[{}],"move":"h"}"#,
            br#"{"move":"\u0068"}"#,
            br#"{"move":"\u0068""#,
            br#"{"move":"\u0068"}}"#,
            br#"{"move":"\u0068","move":"w"}"#,
            br#"{"m\u006fve":"h""#,
            br#"{"mov\u0065":"\u0073to\u0070","#,
            br#"{"move":"h""#,
            br#"{"move":"h"#,
            br#"{"move":"h"}}"#,
            br#"{"move":"w","move":"h"}"#,
            br#"{'move':'h'}"#,
            b"{move:h}",
            b"\xa1\x64move\x61h",
            b"\xbf\x64move\x7f\x61h\xff\xff",
            b"\xa2\x62zz\x80\x64move\x61h",
            b"\xa1\x64move\x61h and more",
        ];
        for body in bodies {
            assert!(says_halt(body), "{}", String::from_utf8_lossy(body));
        }
        assert!(says_halt(&[br#"{"move":"h","zz":""#.to_vec(), vec![b'z'; 70_000]].concat()), "too long");
    }

    /// Safety S8: other clients wait while a body is searched. Searching the rest of the body again for each field
    /// would take hours.
    #[test]
    fn a_long_body_that_names_the_field_over_and_over_is_looked_at_once() {
        for field in ["move", "move=", "move:w ", "=move", "move ", "move=stopmove", "dmove", "move=hmove\""] {
            let mut body = field.repeat((2 << 20) / field.len()).into_bytes();
            assert!(!says_halt_from(&body, 0) && !says_halt(&body), "{field}");
            body.extend(b"&move=h");
            assert!(says_halt(&body), "{field}");
        }
    }

    #[test]
    fn a_word_that_was_begun_before_is_none() {
        assert!(says_halt_from(b"zz&move=h", 2) && says_halt_from(b"remove=h&move=h", 2));
        assert!(!says_halt_from(b"remove=h", 2) && !says_halt_from(b"move=h", 1) && !says_halt_from(b"move=h", 7));
    }

    #[test]
    fn no_other_move_is_taken_for_a_halt() {
        let bodies: [&[u8]; 14] = [
            b"",
            b"moveh",
            b"move=w&why=h",
            b"remove=h",
            br#"{"move":"","h":1}"#,
            b"\xa1\x64move\x64stow",
            br#"{"move":"w"}"#,
            br#"{"move":"hh"}"#,
            br#"{"move":"w","why":"he"}"#,
            br#"{"remove":"h"}"#,
            br#"{"word":"h"}"#,
            br#"{"why":"\"move\":\"h\""}"#,
            b"\xa1\x64move\x61w",
            b"\xa1\x64move\x62hh",
        ];
        for body in bodies {
            assert!(!says_halt(body), "{}", String::from_utf8_lossy(body));
        }
    }
}
