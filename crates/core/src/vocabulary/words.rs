//! Decides which characters of a text from outside may be shown to people.

/// Whether this character is visible and does not change how other characters are shown. Control characters, line
/// breaks, changes of writing direction and zero-width formatting characters do not qualify.
#[must_use]
pub fn is_visible(letter: char) -> bool {
    let is_hidden = matches!(letter, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}');
    !letter.is_control() && !is_hidden
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_of_every_writing_are_shown_and_what_turns_writing_round_is_not() {
        assert!("wall 2 Mu\u{308}ll καφές 鞄".chars().all(is_visible));
        for hidden in ['\n', '\u{7f}', '\u{200b}', '\u{200f}', '\u{2028}', '\u{202e}', '\u{2066}', '\u{feff}'] {
            assert!(!is_visible(hidden), "{hidden:?}");
        }
    }
}
