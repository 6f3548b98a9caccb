//! Parses a text into a term. Any text is either accepted or refused, without a panic. Length and depth are bounded.
//! The values are in `term`.

use super::term::{Number, Term, begins_word, is_in_word};

/// Maximum length of a text in bytes, as for commands at this door. Outgoing texts, such as maps, may be longer.
pub(super) const LENGTH: usize = 4096;

/// Maximum depth of nested terms. Messages need a depth of five. Each level takes a little stack.
const DEPTH: usize = 32;

/// Why a text is not a term. `Display` gives a sentence for the log. `at` is a number of bytes from the beginning.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unreadable {
    #[error("the text has {0} bytes: the maximum is {LENGTH}")]
    TooLong(usize),
    #[error("the text is no UTF-8 from byte {at} on")]
    NotText {
        /// Position of the first byte that is not valid UTF-8.
        at: usize,
    },
    #[error("at byte {at} the text is nested deeper than {DEPTH} terms")]
    TooDeep { at: usize },
    #[error("at byte {at}: expected {expected}, found {}", found.map_or("the end".to_owned(), |found| format!("{found:?}")))]
    Unexpected {
        at: usize,
        /// The character at `at`; `None` at the end of the text.
        found: Option<char>,
        expected: &'static str,
    },
}

impl Term {
    /// Parses a text that consists of one term. Blanks may surround each part.
    ///
    /// # Errors
    /// When `text` is longer than `LENGTH`, nested deeper than `DEPTH`, or not a term.
    pub fn parse(text: &str) -> Result<Term, Unreadable> {
        TermReader::whole(text)
    }
}

pub(super) struct TermReader<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> TermReader<'a> {
    pub(super) fn whole(text: &'a str) -> Result<Term, Unreadable> {
        if text.len() > LENGTH {
            return Err(Unreadable::TooLong(text.len()));
        }
        let mut reader = TermReader { text, at: 0 };
        let term = reader.term(1)?;
        match reader.next() {
            None => Ok(term),
            Some(_) => Err(reader.unexpected("the end")),
        }
    }

    fn term(&mut self, depth: usize) -> Result<Term, Unreadable> {
        let first = self.next();
        if depth > DEPTH {
            return Err(Unreadable::TooDeep { at: self.at });
        }
        let name = match first {
            Some('\'') => self.quoted()?,
            Some(first) if begins_word(first) => self.taken_while(is_in_word).to_owned(),
            Some('-' | '0'..='9') => return self.number(),
            Some(_) | None => return Err(self.unexpected("a word, a number or a text in '…'")),
        };
        if self.next() == Some('(') { self.parts(name, depth) } else { Ok(Term::Atom(name)) }
    }

    fn parts(&mut self, name: String, depth: usize) -> Result<Term, Unreadable> {
        self.at += 1;
        let mut parts = Vec::new();
        if self.next() != Some(')') {
            parts.push(self.term(depth + 1)?);
        }
        loop {
            match self.next() {
                Some(')') => break,
                Some(',') => self.at += 1,
                Some(_) | None => return Err(self.unexpected("`,` or `)`")),
            }
            parts.push(self.term(depth + 1)?);
        }
        self.at += 1;
        Ok(Term::Compound(name, parts))
    }

    /// Reads a text in quotes, from the opening quote on. Two quotes in a row stand for one quote in the text.
    fn quoted(&mut self) -> Result<String, Unreadable> {
        let mut text = String::new();
        loop {
            self.at += 1;
            text.push_str(self.taken_while(|letter| letter != '\''));
            if self.rest().is_empty() {
                return Err(self.unexpected("the closing `'`"));
            }
            self.at += 1;
            if !self.rest().starts_with('\'') {
                return Ok(text);
            }
            text.push('\'');
        }
    }

    fn number(&mut self) -> Result<Term, Unreadable> {
        let from = self.at;
        let text = self.taken_while(|letter| matches!(letter, '0'..='9' | '.' | '-'));
        let number = Number::new(text);
        if number.is_none() {
            self.at = from;
        }
        number.map(Term::Number).ok_or_else(|| self.unexpected("a number such as 3, -3 or 21.5"))
    }

    /// Skips blanks, and returns the next character without consuming it.
    fn next(&mut self) -> Option<char> {
        self.taken_while(|letter| letter.is_ascii_whitespace());
        self.rest().chars().next()
    }

    fn taken_while(&mut self, belongs: impl Fn(char) -> bool) -> &'a str {
        let rest = self.rest();
        let taken = rest.split_once(|letter| !belongs(letter)).map_or(rest, |(taken, _)| taken);
        self.at += taken.len();
        taken
    }

    fn rest(&self) -> &'a str {
        self.text.get(self.at..).unwrap_or_default()
    }

    fn unexpected(&self, expected: &'static str) -> Unreadable {
        Unreadable::Unexpected { at: self.at, found: self.rest().chars().next(), expected }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Term {
        Term::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"))
    }

    #[test]
    fn blanks_may_stand_between_the_parts_but_not_within_them() {
        let neat = read("content(robot(state(stopped),direction(downDir),position(0,-1)))");
        let blanks = " content ( robot( state( stopped ),\tdirection(downDir) ,\r\n position( 0, -1))) \n";
        assert_eq!(read(blanks), neat);
        assert_eq!(read("'r 1 X @'"), Term::atom("r 1 X @"), "in quotes they stay");
        assert!(Term::parse("start Cmd").is_err() && Term::parse("- 1").is_err());
    }

    #[test]
    fn quotes_belong_to_the_writing_and_two_of_them_are_one() {
        assert_eq!(read("'js'"), read("js"));
        assert_ne!(read("'1'"), read("1"));
        assert_eq!(read("'l''una'"), Term::atom("l'una"));
        assert_eq!(read("''"), Term::atom(""));
        assert_eq!(read("'a\\'"), Term::atom("a\\"), "a backslash means nothing");
        assert_eq!(read("'f'(x)"), read("f(x)"));
    }

    #[test]
    fn what_is_no_term_is_told_where_and_what_belongs_there() {
        let cases = [
            ("", "at byte 0: expected a word, a number or a text in '…', found the end"),
            ("f(a", "at byte 3: expected `,` or `)`, found the end"),
            ("f(a;b)", "at byte 3: expected `,` or `)`, found ';'"),
            ("f(,)", "at byte 2: expected a word, a number or a text in '…', found ','"),
            ("f(a,)", "at byte 4: expected a word, a number or a text in '…', found ')'"),
            ("f(a))", "at byte 4: expected the end, found ')'"),
            ("'open", "at byte 5: expected the closing `'`, found the end"),
            ("f(1.)", "at byte 2: expected a number such as 3, -3 or 21.5, found '1'"),
            ("è", "at byte 0: expected a word, a number or a text in '…', found 'è'"),
        ];
        for (text, words) in cases {
            assert_eq!(Term::parse(text).unwrap_err().to_string(), words, "{text}");
        }
    }

    /// Safety A7.
    #[test]
    fn length_and_depth_are_bounded() {
        let nested = |deep: usize| format!("{}x{}", "f(".repeat(deep - 1), ")".repeat(deep - 1));
        assert!(Term::parse(&nested(DEPTH)).is_ok());
        assert_eq!(Term::parse(&nested(DEPTH + 1)), Err(Unreadable::TooDeep { at: 2 * DEPTH }));
        assert_eq!(Term::parse(&"f(".repeat(LENGTH / 2)), Err(Unreadable::TooDeep { at: 2 * DEPTH }));
        assert!(Term::parse(&"x".repeat(LENGTH)).is_ok());
        assert_eq!(Term::parse(&"x".repeat(LENGTH + 1)), Err(Unreadable::TooLong(LENGTH + 1)));
    }
}
