//! A secret of 256 bits, as text that can be part of a link. Other files store tokens and know their owners.

use std::fmt;

use super::error::AccessError;

const BYTES: usize = 32;

/// A secret: 64 hexadecimal digits. Only `reveal` shows it.
#[derive(Clone)]
pub struct Token(Box<str>);

impl Token {
    /// Draws a new token from the system's random source.
    pub fn draw() -> Result<Token, AccessError> {
        Ok(Token(hexadecimal(&chance()?).into()))
    }

    pub fn read(text: &str) -> Option<Token> {
        let is_one = text.len() == 2 * BYTES && text.bytes().all(|byte| matches!(byte, b'0'..=b'9' | b'a'..=b'f'));
        is_one.then(|| Token(text.into()))
    }

    /// Returns the secret itself: to show it to its owner, to store it, or to compare it.
    pub fn reveal(&self) -> &str {
        &self.0
    }
}

impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token(…)")
    }
}

/// Bytes that nobody can guess, from the system's random source.
pub fn chance() -> Result<[u8; BYTES], AccessError> {
    let mut bytes = [0; BYTES];
    getrandom::fill(&mut bytes).map_err(|error| AccessError::Chance(error.to_string()))?;
    Ok(bytes)
}

pub(super) fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety A1.
    #[test]
    fn a_token_has_256_bits_and_is_never_the_same_twice() {
        let (one, other) = (Token::draw().unwrap(), Token::draw().unwrap());
        assert_eq!(one.reveal().len() * 4, 256);
        assert_ne!(one.reveal(), other.reveal());
        assert_eq!(Token::read(one.reveal()).unwrap().reveal(), one.reveal());
    }

    #[test]
    fn only_what_draw_writes_is_read() {
        let whole = "0123456789abcdef".repeat(4);
        assert!(Token::read(&whole).is_some());
        for wrong in ["", &whole[1..], &whole.to_uppercase(), &format!("{whole}0"), &whole.replace('0', " ")] {
            assert!(Token::read(wrong).is_none(), "{wrong}");
        }
    }

    #[test]
    fn printing_for_a_programmer_does_not_betray_it() {
        let token = Token::draw().unwrap();
        assert!(!format!("{token:?}").contains(&token.reveal()[..4]));
    }
}
