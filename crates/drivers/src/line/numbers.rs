//! The numbers of the line protocol, and the numbers of orders. They are decimal integers. Only numbers that can be
//! negative may have a sign.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

/// The number of an order on the wire. The next order has the next number.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Seq(u32);

impl Seq {
    pub const FIRST: Seq = Seq(1);

    /// The last possible number. With three orders a second, it is reached after twenty years.
    pub const LAST: Seq = Seq(i32::MAX as u32);

    #[must_use]
    pub fn new(number: u32) -> Option<Seq> {
        (1..=Seq::LAST.0).contains(&number).then_some(Seq(number))
    }

    #[must_use]
    pub const fn number(self) -> u32 {
        self.0
    }

    pub(super) fn next(self) -> Option<Seq> {
        Seq::new(self.0 + 1)
    }

    pub(super) fn before(self) -> Seq {
        Seq::new(self.0 - 1).unwrap_or(Seq::FIRST)
    }

    pub(super) fn read(text: &str) -> Option<Seq> {
        number(text).and_then(Seq::new)
    }
}

impl fmt::Display for Seq {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.0)
    }
}

/// Reads a number that has only digits. The standard library would also accept a plus sign.
pub(super) fn number<N: FromStr>(text: &str) -> Option<N> {
    let is_digits = !text.is_empty() && text.bytes().all(|byte| byte.is_ascii_digit());
    is_digits.then(|| text.parse().ok()).flatten()
}

pub(super) fn signed(text: &str) -> Option<i32> {
    let size: i16 = number(text.strip_prefix('-').unwrap_or(text))?;
    Some(if text.starts_with('-') { -i32::from(size) } else { i32::from(size) })
}

/// Converts to whole milliseconds. A longer time becomes the largest number that fits into a line.
pub(super) fn millis(time: Duration) -> u32 {
    u32::try_from(time.as_millis()).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_digits_are_a_number() {
        assert_eq!((number::<u32>("0"), number::<u32>("4294967295")), (Some(0), Some(u32::MAX)));
        for wrong in ["", "+1", "-1", "1.0", "4294967296", " 1"] {
            assert_eq!(number::<u32>(wrong), None, "{wrong}");
        }
        assert_eq!((signed("-32767"), signed("12"), signed("--1"), signed("-")), (Some(-32767), Some(12), None, None));
    }

    #[test]
    fn orders_have_numbers_from_one_on() {
        assert_eq!((Seq::new(0), Seq::new(1), Seq::new(u32::MAX)), (None, Some(Seq::FIRST), None));
        assert_eq!((Seq::LAST.next(), Seq::FIRST.before()), (None, Seq::FIRST));
    }
}
