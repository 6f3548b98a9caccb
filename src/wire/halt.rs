//! Whether the body of a move says STOP, whatever else is wrong with it (safety S8): read before it is judged, and more liberally
//! than any command. Whose body it is, and what becomes of it, is the doors' business.

use minicbor::Decoder;

use super::{cbor, fields};

/// The word that is STOP wherever a move is asked for.
const HALT: &str = "h";

/// The field in which a move's word comes.
const MOVE: &str = "move";

/// The field and its word in CBOR: two short texts, one behind the other.
const IN_CBOR: &[u8] = b"\x64move\x61h";

/// The same in JSON, without quotes and blanks.
const IN_JSON: &[u8] = b"move:h";

/// Whether a body is the bare word for STOP, with whatever quotes, blanks and zero bytes round it.
#[must_use]
pub fn is_halt_word(body: &[u8]) -> bool {
    let is_round = |letter: char| letter.is_whitespace() || letter.is_control() || matches!(letter, '"' | '\'' | '\u{feff}');
    String::from_utf8_lossy(body).trim_matches(is_round) == HALT
}

/// Whether the body of a move says STOP: as the bare word, as a field in JSON or CBOR, or as what would be that field if the rest
/// of the body made sense.
#[must_use]
pub fn says_halt(body: &[u8]) -> bool {
    let is_halt = |fields: fields::Fields| fields.text(MOVE).is_ok_and(|word| word.as_deref() == Some(HALT));
    is_halt_word(body)
        || fields::fields(body).is_ok_and(is_halt)
        || cbor::fields(&mut Decoder::new(body)).is_ok_and(is_halt)
        || body.windows(IN_CBOR.len()).any(|window| window == IN_CBOR)
        || looks_like_halt(body)
}

/// Whether the field stands somewhere in what is no JSON, or has other fields beside it.
fn looks_like_halt(body: &[u8]) -> bool {
    let is_passed_over = |letter: &u8| letter.is_ascii_whitespace() || matches!(letter, b'"' | b'\'');
    let letters: Vec<u8> = body.iter().copied().filter(|letter| !is_passed_over(letter)).collect();
    let is_bounded = |place: Option<&u8>| place.is_none_or(|letter| !letter.is_ascii_alphanumeric());
    let starts = letters.windows(IN_JSON.len()).enumerate().filter(|(_, window)| *window == IN_JSON);
    starts.map(|(start, _)| start).any(|start| {
        let before = start.checked_sub(1).and_then(|before| letters.get(before));
        is_bounded(before) && is_bounded(letters.get(start + IN_JSON.len()))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety S8.
    #[test]
    fn the_word_is_known_whatever_stands_round_it() {
        for word in ["h", " h\r\n", "\"h\"", "'h'", "\" h \"", "h\0", "\u{feff}h", "\"h"] {
            assert!(is_halt_word(word.as_bytes()) && says_halt(word.as_bytes()), "{word:?}");
        }
        for other in ["", "H", "hh", "w", "h w", "{h}", "\\h"] {
            assert!(!is_halt_word(other.as_bytes()) && !says_halt(other.as_bytes()), "{other:?}");
        }
        assert!(!is_halt_word(b"\xffh"));
    }

    /// Safety S8.
    #[test]
    fn a_move_that_halts_is_known_whatever_else_its_body_says() {
        let bodies: [&[u8]; 15] = [
            br#"{"move":"h"}"#,
            br#" { "move" : "h" } "#,
            br#"{"move":"h","zz":0}"#,
            br#"{"zz":[{}],"move":"h"}"#,
            br#"{"move":"\u0068"}"#,
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

    #[test]
    fn no_other_move_is_taken_for_a_halt() {
        let bodies: [&[u8]; 9] = [
            b"",
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
