//! Splits a script into numbers, texts, names and signs, each with its place.

use super::ScriptError;
use crate::value::{Value, finite};

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Token {
    Value(Value),
    Name(String),
    Sign(&'static str),
    End,
}

/// All signs. If two signs have the same beginning, the longer one comes first.
const SIGNS: [&str; 29] = [
    ":=", "==", "!=", "<=", ">=", "&&", "||", "+=", "-=", "*=", "/=", "..", "+", "-", "*", "/", "&", "|", "^", "~", "!", "<",
    ">", "=", "?", ":", "(", ")", ";",
];

/// Returns all tokens, each with the place of its first character. The last token is `End`.
pub(super) fn tokens(text: &str) -> Result<Vec<(usize, Token)>, ScriptError> {
    let mut tokens = Vec::new();
    let mut at = 0;
    while let Some(first) = text[at..].chars().next() {
        if first.is_whitespace() {
            at += first.len_utf8();
            continue;
        }
        let (token, length) = token(text, at, first)?;
        tokens.push((at, token));
        at += length;
    }
    tokens.push((text.len(), Token::End));
    Ok(tokens)
}

fn token(text: &str, at: usize, first: char) -> Result<(Token, usize), ScriptError> {
    let rest = &text[at..];
    if first.is_ascii_digit() {
        return number(at, rest);
    }
    if first == '\'' || first == '"' {
        let inside = &rest[1..];
        let unexpected = || ScriptError::Unexpected { at, found: "a text without an end".to_owned(), wanted: "a closing quote" };
        let end = inside.find(first).ok_or_else(unexpected)?;
        return Ok((Token::Value(Value::text(&inside[..end])), end + 2));
    }
    if first.is_alphabetic() || first == '_' || first == '@' {
        let is_inner = |(place, letter): &(usize, char)| *place == 0 || letter.is_alphanumeric() || *letter == '_';
        let length = rest.char_indices().take_while(is_inner).map(|(_, letter)| letter.len_utf8()).sum();
        let token = match &rest[..length] {
            // Booleans are numbers, as in BehaviorTree.CPP.
            "true" => Token::Value(Value::Int(1)),
            "false" => Token::Value(Value::Int(0)),
            name => Token::Name(name.to_owned()),
        };
        return Ok((token, length));
    }
    match SIGNS.into_iter().find(|sign| rest.starts_with(sign)) {
        Some(sign) => Ok((Token::Sign(sign), sign.len())),
        None => Err(ScriptError::Unexpected { at, found: format!("a {first:?}"), wanted: "a value, a name or an operator" }),
    }
}

fn number(at: usize, rest: &str) -> Result<(Token, usize), ScriptError> {
    let digits = |from: usize| rest[from..].bytes().take_while(u8::is_ascii_digit).count();
    let byte = |place: usize| rest.as_bytes().get(place).copied().unwrap_or(0);
    let bad = |length: usize| ScriptError::Unexpected { at, found: format!("{:?}", &rest[..length]), wanted: "a number" };
    let (value, length) = if rest.starts_with("0x") || rest.starts_with("0X") {
        let length = 2 + rest[2..].bytes().take_while(u8::is_ascii_hexdigit).count();
        (i64::from_str_radix(&rest[2..length], 16).ok().map(Value::Int), length)
    } else {
        let mut length = digits(0);
        let mut is_whole = true;
        if byte(length) == b'.' && byte(length + 1).is_ascii_digit() {
            length += 1 + digits(length + 1);
            is_whole = false;
        }
        if matches!(byte(length), b'e' | b'E') {
            let sign = usize::from(matches!(byte(length + 1), b'+' | b'-'));
            length += 1 + sign + digits(length + 1 + sign);
            is_whole = false;
        }
        let text = &rest[..length];
        (if is_whole { text.parse().ok().map(Value::Int) } else { text.parse().ok().and_then(finite) }, length)
    };
    let ends = rest[length..].chars().next().is_none_or(|next| !next.is_alphabetic() && next != '_');
    match value {
        Some(value) if ends => Ok((Token::Value(value), length)),
        _ => Err(bad(length)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(text: &str) -> Vec<Token> {
        tokens(text).expect("it is well written").into_iter().map(|(_, token)| token).collect()
    }

    #[test]
    fn numbers_texts_names_and_signs_are_told_apart() {
        let expected = [
            Token::Name("x".to_owned()),
            Token::Sign(":="),
            Token::Value(Value::Int(16)),
            Token::Sign(";"),
            Token::Name("@y_1".to_owned()),
            Token::Sign("+="),
            Token::Value(Value::Number(1.5e-3)),
            Token::Sign(".."),
            Token::Value(Value::text("it's")),
            Token::End,
        ];
        assert_eq!(values("x:=0x10; @y_1 += 1.5e-3 .. \"it's\""), expected);
    }

    #[test]
    fn what_is_no_piece_is_said_with_its_place() {
        for (text, said) in [
            ("x := 3x", "expected a number at character 5, found \"3\""),
            ("x := 'a", "expected a closing quote at character 5, found a text without an end"),
            ("x # 3", "expected a value, a name or an operator at character 2, found a '#'"),
            ("1e", "expected a number at character 0, found \"1e\""),
            ("99999999999999999999", "expected a number at character 0, found \"99999999999999999999\""),
        ] {
            assert_eq!(tokens(text).expect_err(text).to_string(), said);
        }
    }
}
