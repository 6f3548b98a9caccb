//! Finds the object literal in a JavaScript module, and limits how deep it nests. The contents of the literal are not
//! read here.

use crate::hall::error::HallFault;

/// Maximum nesting depth. Real scenes nest five deep. The limit is needed because the reader of the literal recurses
/// once per level.
const MAX_DEPTH: usize = 16;

/// The literal from its first brace to its last, and the line on which it begins.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Literal<'a> {
    pub(super) text: &'a str,
    pub(super) line: usize,
}

/// The first object literal that is assigned to a name or exported as the default. On failure, the line and the
/// fault.
pub(super) fn literal(text: &str) -> Result<Literal<'_>, (usize, HallFault)> {
    let begin = begin(text).ok_or((1, HallFault::NoLiteral))?;
    let line_of = |place: usize| json5::Position::from_offset(place, text).line + 1;
    let rest = text.get(begin..).unwrap_or_default();
    let mut depth = 0;
    for (place, byte) in Code::of(rest) {
        match byte {
            b'{' | b'[' if depth == MAX_DEPTH => return Err((line_of(begin + place), HallFault::TooDeep(MAX_DEPTH))),
            b'{' | b'[' => depth += 1,
            b'}' | b']' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            let text = rest.get(..=place).unwrap_or_default();
            return Ok(Literal { text, line: line_of(begin) });
        }
    }
    Err((line_of(begin), HallFault::UnclosedLiteral))
}

/// The place where the literal begins. Its brace follows `=` or `default`, or it is the first character of the code.
/// Other braces, such as those of an import, are skipped.
fn begin(text: &str) -> Option<usize> {
    let mut last = None;
    for (place, byte) in Code::of(text).filter(|(_, byte)| !byte.is_ascii_whitespace()) {
        let before = last.map_or("", |last| text.get(..=last).unwrap_or_default());
        if byte == b'{' && (last.is_none() || before.ends_with('=') || before.ends_with("default")) {
            return Some(place);
        }
        last = Some(place);
    }
    None
}

/// Iterates over the bytes of a script that are in no comment and in no string, each with its place.
struct Code<'a> {
    text: &'a [u8],
    at: usize,
}

impl Code<'_> {
    fn of(text: &str) -> Code<'_> {
        Code { text: text.as_bytes(), at: 0 }
    }
}

impl Iterator for Code<'_> {
    type Item = (usize, u8);

    fn next(&mut self) -> Option<(usize, u8)> {
        loop {
            let rest = self.text.get(self.at..)?;
            let (at, first) = (self.at, *rest.first()?);
            self.at += match rest {
                [b'/', b'/', ..] => rest.iter().position(|byte| *byte == b'\n').unwrap_or(rest.len()),
                [b'/', b'*', inner @ ..] => inner.windows(2).position(|pair| pair == b"*/").map_or(rest.len(), |place| place + 4),
                [b'"' | b'\'', ..] => string_length(rest, first),
                _ => {
                    self.at += 1;
                    return Some((at, first));
                }
            };
        }
    }
}

/// Length of a string, including both quotes. A string that is not closed extends to the end of the text.
fn string_length(rest: &[u8], quote: u8) -> usize {
    let mut place = 1;
    while let Some(byte) = rest.get(place) {
        place += if *byte == b'\\' { 2 } else { 1 };
        if *byte == quote {
            return place;
        }
    }
    rest.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_literal_is_found_whatever_stands_round_it() {
        for (text, expect) in [
            ("const config = {a: 1}; export default config;", "{a: 1}"),
            ("import {b} from 'c';\nexport default {a: {}}", "{a: {}}"),
            ("{}", "{}"),
            ("// {\n/* = { */ const a = {b: '}', c: \"\\\"}\"} }", "{b: '}', c: \"\\\"}\"}"),
            ("x = { // }\n}", "{ // }\n}"),
        ] {
            assert_eq!(literal(text).map(|literal| literal.text), Ok(expect), "{text}");
        }
        assert_eq!(literal("\n\nx = {}").map(|literal| literal.line), Ok(3));
    }

    #[test]
    fn a_module_without_one_or_with_one_too_deep_is_refused_with_a_line() {
        for text in ["", "function f() {}", "import {a} from 'b'", "// = {}", "'= {}"] {
            assert_eq!(literal(text), Err((1, HallFault::NoLiteral)), "{text}");
        }
        for text in ["\nx = {", "\nx = {'}", "\nx = {/*}", "\nx = {[}"] {
            assert_eq!(literal(text), Err((2, HallFault::UnclosedLiteral)), "{text}");
        }
        let deep = format!("\nx =\n {{a:{}", "[".repeat(100_000));
        assert_eq!(literal(&deep), Err((3, HallFault::TooDeep(MAX_DEPTH))));
    }
}
