//! Terms like those of Prolog. The actors of the original system write their messages as such terms. The values and
//! their printing are here; parsing is in `reader`. No message has variables, lists or operators, so they are left
//! out.

use std::fmt;

/// A term, such as `startCmd`, `12`, or `content(robot(state(stopped)))`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Term {
    /// A word, or any text. As in Prolog, quotes are only notation: `'js'` and `js` are the same atom.
    Atom(String),
    Number(Number),
    /// A word or text, followed by terms in parentheses. Unlike in Prolog, `f()` is allowed; it is a compound without
    /// terms.
    Compound(String, Vec<Term>),
}

/// A number as it was written. Parsing and printing do not change its digits.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Number(String);

impl Term {
    pub fn atom(text: impl Into<String>) -> Term {
        Term::Atom(text.into())
    }

    pub fn whole(number: impl Into<i64>) -> Term {
        Term::Number(Number(number.into().to_string()))
    }

    pub fn compound(name: impl Into<String>, parts: impl Into<Vec<Term>>) -> Term {
        Term::Compound(name.into(), parts.into())
    }

    pub fn name(&self) -> Option<&str> {
        match self {
            Term::Atom(name) | Term::Compound(name, _) => Some(name),
            Term::Number(_) => None,
        }
    }
}

impl Number {
    /// Returns `text` as a number: an optional minus, digits, and an optional fraction. Returns `None` for any other
    /// text.
    pub fn new(text: &str) -> Option<Number> {
        let (whole, fraction) = text.split_once('.').map_or((text, None), |(whole, fraction)| (whole, Some(fraction)));
        let are_digits = |digits: &str| !digits.is_empty() && digits.bytes().all(|digit| digit.is_ascii_digit());
        let sound = are_digits(whole.strip_prefix('-').unwrap_or(whole)) && fraction.is_none_or(are_digits);
        sound.then(|| Number(text.to_owned()))
    }

    pub fn text(&self) -> &str {
        &self.0
    }
}

pub(super) const fn begins_word(letter: char) -> bool {
    letter.is_ascii_alphabetic() || letter == '_'
}

pub(super) const fn is_in_word(letter: char) -> bool {
    begins_word(letter) || letter.is_ascii_digit()
}

/// Prints a text as an atom. A word is printed bare (`startCmd`). Any other text is printed in quotes, and each quote
/// in it is doubled (`'l''una'`).
pub(super) struct Printed<'a>(pub(super) &'a str);

impl fmt::Display for Printed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.starts_with(begins_word) && self.0.chars().all(is_in_word) {
            return f.write_str(self.0);
        }
        write!(f, "'{}'", self.0.replace('\'', "''"))
    }
}

impl fmt::Display for Term {
    /// Prints the term without blanks, except for those inside quotes.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Term::Atom(text) => Printed(text).fmt(f),
            Term::Number(number) => f.write_str(number.text()),
            Term::Compound(name, parts) => {
                write!(f, "{}(", Printed(name))?;
                for (at, part) in parts.iter().enumerate() {
                    let comma = if at == 0 { "" } else { "," };
                    write!(f, "{comma}{part}")?;
                }
                f.write_str(")")
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Generates terms that are short and flat enough to be parsed again.
    pub(in super::super) fn any_term() -> impl Strategy<Value = Term> {
        let text = || prop_oneof![4 => "[a-zA-Z_][a-zA-Z0-9_]{0,8}", 1 => "['(), \\\\a-c\n]{0,6}", 1 => "\\PC{0,4}"];
        let number = "-?[0-9]{1,20}(\\.[0-9]{1,4})?".prop_map(|text| Term::Number(Number::new(&text).unwrap()));
        let leaf = prop_oneof![text().prop_map(Term::Atom), number];
        leaf.prop_recursive(8, 48, 4, move |inner| {
            (text(), prop::collection::vec(inner, 0..4)).prop_map(|(name, parts)| Term::Compound(name, parts))
        })
    }

    proptest! {
        #[test]
        fn a_term_that_is_printed_is_read_again_as_the_same(term in any_term()) {
            let printed = term.to_string();
            prop_assert_eq!(Term::parse(&printed), Ok(term));
        }

        #[test]
        fn what_was_printed_is_printed_again_as_the_same(term in any_term()) {
            let printed = term.to_string();
            prop_assert_eq!(Term::parse(&printed).unwrap().to_string(), printed);
        }

        /// Safety A7.
        #[test]
        fn any_text_is_a_term_or_says_why_not(text in "[a-c01.,()' \\-]{0,40}|\\PC{0,40}") {
            if let Ok(term) = Term::parse(&text) {
                prop_assert_eq!(Term::parse(&term.to_string()), Ok(term));
            }
        }
    }

    #[test]
    fn a_text_has_quotes_where_it_is_no_word() {
        let cases = [
            ("startCmd", "startCmd"),
            ("Robot_2", "Robot_2"),
            ("_", "_"),
            ("", "''"),
            ("12", "'12'"),
            ("2nd", "'2nd'"),
            ("r 1 X @", "'r 1 X @'"),
            ("l'una", "'l''una'"),
            ("'", "''''"),
            ("città", "'città'"),
        ];
        for (text, printed) in cases {
            assert_eq!(Term::atom(text).to_string(), printed);
        }
    }

    #[test]
    fn a_number_is_digits_with_a_minus_and_a_fraction_at_most() {
        for good in ["0", "-3", "007", "21.5", "-0.25", "123456789012345678901234567890"] {
            assert_eq!(Number::new(good).map(|number| number.text().to_owned()).as_deref(), Some(good));
        }
        for wrong in ["", "-", "1.", ".5", "1e5", "+1", "1.2.3", "--1", "x"] {
            assert_eq!(Number::new(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn a_compound_term_is_printed_without_blanks() {
        let position = Term::compound("position", [Term::whole(-3), Term::whole(12)]);
        assert_eq!(position.to_string(), "position(-3,12)");
        assert_eq!(Term::compound("two words", []).to_string(), "'two words'()");
    }
}
