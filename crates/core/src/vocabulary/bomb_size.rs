//! How large a bomb may be, and how far people must keep away from it. `docs/mission.md` prints the table with its source.

use std::fmt;

/// What a judge takes a bomb for, or the radius that the judge names instead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BombSize {
    /// A pipe bomb of 2.3 kg.
    Pipe,
    /// A vest of 9.2 kg.
    Vest,
    /// A suitcase of 23 kg.
    Suitcase,
    /// A car with 227 kg.
    Car,
    /// A radius in metres.
    Radius(u16),
}

impl BombSize {
    pub const NAMED: [BombSize; 4] = [BombSize::Pipe, BombSize::Vest, BombSize::Suitcase, BombSize::Car];

    /// Largest radius, in metres.
    pub const WIDEST_M: u16 = 5000;

    /// Reads what `Display` writes.
    #[must_use]
    pub fn read(text: &str) -> Option<BombSize> {
        let radius = text.parse().ok().filter(|metres| (1..=BombSize::WIDEST_M).contains(metres)).map(BombSize::Radius);
        BombSize::NAMED.into_iter().chain(radius).find(|size| size.to_string() == text)
    }

    /// The size with its unit, for a sentence. Example: `size: vest, 9.2 kg`.
    #[must_use]
    pub fn in_words(self) -> String {
        match self {
            BombSize::Pipe => "size: pipe bomb, 2.3 kg".to_owned(),
            BombSize::Vest => "size: vest, 9.2 kg".to_owned(),
            BombSize::Suitcase => "size: suitcase, 23 kg".to_owned(),
            BombSize::Car => "size: car, 227 kg".to_owned(),
            BombSize::Radius(metres) => format!("radius: {metres} m"),
        }
    }

    /// Distance in metres that everybody must keep.
    #[must_use]
    pub const fn mandatory_m(self) -> u16 {
        match self {
            BombSize::Pipe => 21,
            BombSize::Vest => 34,
            BombSize::Suitcase => 46,
            BombSize::Car => 98,
            BombSize::Radius(metres) => metres,
        }
    }

    /// Distance in metres within which people outdoors must go into a building; `None` if it is not known.
    #[must_use]
    pub const fn preferred_m(self) -> Option<u16> {
        match self {
            BombSize::Pipe => Some(366),
            BombSize::Vest => Some(518),
            BombSize::Suitcase => Some(564),
            BombSize::Car => Some(580),
            BombSize::Radius(_) => None,
        }
    }
}

impl fmt::Display for BombSize {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            BombSize::Pipe => f.write_str("pipe"),
            BombSize::Vest => f.write_str("vest"),
            BombSize::Suitcase => f.write_str("suitcase"),
            BombSize::Car => f.write_str("car"),
            BombSize::Radius(metres) => metres.fmt(f),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_is_a_name_of_the_table_or_a_whole_number_of_metres() {
        for size in BombSize::NAMED.into_iter().chain([1, 120, 5000].map(BombSize::Radius)) {
            assert_eq!(BombSize::read(&size.to_string()), Some(size));
        }
        for unsound in ["", "0", "5001", "65536", "-1", "+1", "01", "1.5", "Pipe", "bus", " pipe"] {
            assert_eq!(BombSize::read(unsound), None, "{unsound:?}");
        }
    }
}
