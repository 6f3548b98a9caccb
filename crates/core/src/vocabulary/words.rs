//! Which letters of a text from outside may be shown to people.

/// Whether this letter is visible and does not change how others are shown: no control character, no line break, no
/// change of writing direction, and not without width.
#[must_use]
pub fn is_visible(letter: char) -> bool {
    let is_hidden = matches!(letter, '\u{200b}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}');
    !letter.is_control() && !is_hidden
}

/// Words of somebody who knows our sentences: pieces of those, and characters with a meaning in them.
#[cfg(test)]
pub(crate) fn hostile(dice: &mut crate::rng::RandomStream) -> String {
    const PIECES: [&str; 40] = [
        "the wheels slip",
        " ",
        "\n",
        "\"",
        "\\",
        "\u{301}",
        "\u{202e}",
        "ü鞄",
        "(",
        ")",
        " (",
        ": ",
        "; ",
        ", ",
        "#",
        "7",
        "18446744073709551616",
        "luggage #3",
        " at (1, 2)",
        " is dangerous",
        ", by operator (local)",
        " refused, by ",
        ", and 3 more that were refused",
        "STOP, 3 times at once",
        "STOP, 3 times within 1.2 s",
        "START",
        " (note: ",
        "nothing can be recorded: ",
        "; stopped by the operator",
        "mend the disk first",
        "not possible while held: ",
        "the fault still stands: ",
        "the robot could not carry out its order (",
        "): look after it, then press START",
        "the piece was not fetched: ",
        "no way leads to the piece",
        "; and no way leads the robots that fetch back outside",
        "the pair has lost the parcel too often",
        "it was begun with mission.retrieval = \"pair\"",
        ", which is \"none\" now: set it back",
    ];
    let length = dice.below(6);
    (0..length).map(|_| PIECES[dice.below(PIECES.len() as u64) as usize]).collect()
}

/// Any number, often one of the small ones that most people use.
#[cfg(test)]
pub(crate) fn number(dice: &mut crate::rng::RandomStream) -> u64 {
    let shift = dice.below(64);
    dice.number() >> shift
}

#[cfg(test)]
#[expect(clippy::cast_possible_truncation, reason = "any number of this size will do")]
pub(crate) fn coordinate(dice: &mut crate::rng::RandomStream) -> i32 {
    let shift = dice.below(32);
    (dice.number() as i32) >> shift
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
