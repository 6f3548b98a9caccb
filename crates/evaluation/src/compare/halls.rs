//! The halls of a comparison: random halls of a family, or one hall that somebody drew.

use std::borrow::Cow;
use std::fmt;
use std::str::FromStr;

use hallsweep_core::rng::RandomStream;
use hallsweep_sim::{Hall, MAX_PIECES};

use crate::Ground;
use crate::family::{Family, hall};

#[derive(Clone, Debug)]
pub enum Halls {
    /// Random halls. They are drawn from their own random stream, so no hall of a comparison was used for tuning.
    Random {
        kind: Kind,
        count: usize,
        seed: u64,
    },
    Drawn(Box<Hall>),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kind {
    pub family: Family,
    pub columns: usize,
    pub lines: usize,
}

/// Maximum side of a random hall, in cells.
const MOST_SIDE: usize = 2048;

impl Halls {
    #[must_use]
    pub const fn count(&self) -> usize {
        match self {
            Halls::Random { count, .. } => *count,
            Halls::Drawn(_) => 1,
        }
    }

    /// Returns the hall with this number, counted from 0.
    #[must_use]
    pub fn hall(&self, number: usize) -> Cow<'_, Hall> {
        match self {
            Halls::Random { kind: Kind { family, columns, lines }, seed, .. } => {
                let mut dice = RandomStream::new(seed.wrapping_mul(1_000_003).wrapping_add(number as u64), "evaluate");
                Cow::Owned(hall(*family, *columns, *lines, &mut dice))
            }
            Halls::Drawn(hall) => Cow::Borrowed(hall),
        }
    }

    pub(super) fn ground(&self, number: usize) -> Ground {
        Ground::of(&self.hall(number))
    }
}

impl fmt::Display for Halls {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Halls::Random { kind, .. } => kind.fmt(f),
            Halls::Drawn(hall) => f.write_str(hall.name()),
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Kind { family, columns, lines } = self;
        write!(f, "{family}:{columns}x{lines}")
    }
}

/// Reads a family and a size, such as `luggage-10:50x50`.
impl FromStr for Kind {
    type Err = KindError;

    fn from_str(written: &str) -> Result<Kind, KindError> {
        let (family, size) = written.split_once(':').unwrap_or((written, ""));
        let family: Family = family.parse().map_err(|()| match family.strip_prefix("luggage-") {
            Some(percent) if percent.bytes().all(|digit| digit.is_ascii_digit()) => KindError::Share,
            Some(_) | None => KindError::NoFamily,
        })?;
        let side = |side: &str| side.parse().ok().filter(|side| (1..=MOST_SIDE).contains(side));
        let sides = size.split_once('x').and_then(|(columns, lines)| Some((side(columns)?, side(lines)?)));
        let (columns, lines) = sides.ok_or_else(|| KindError::Size(size.to_owned()))?;
        if family.most_pieces(columns * lines) > MAX_PIECES {
            return Err(KindError::TooMuch(size.to_owned()));
        }
        Ok(Kind { family, columns, lines })
    }
}

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum KindError {
    /// The text does not begin with a family. It may still be the name of a hall or of a file.
    #[error("no family of halls")]
    NoFamily,
    #[error("luggage-PERCENT goes from luggage-1 to luggage-30")]
    Share,
    #[error("a hall of {0} would hold too much luggage, more than 262,144 pieces: take a smaller one, or less luggage")]
    TooMuch(String),
    #[error("{0:?} is no size: write columns and lines, as 50x50, each from 1 to 2048")]
    Size(String),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halls_are_read_as_they_are_written() {
        for written in ["empty:10x8", "luggage-10:50x50", "walls:7x2048", "maze:1x1"] {
            assert_eq!(written.parse::<Kind>().map(|kind| kind.to_string()), Ok(written.to_owned()));
        }
        let error = |written: &str| written.parse::<Kind>().map(|kind| kind.to_string()).unwrap_err();
        for written in ["airport", "halls/x.toml", "c:/x.map", "luggage-x:5x5", ""] {
            assert_eq!(error(written), KindError::NoFamily, "{written}");
        }
        for share in ["0", "31", "99999"] {
            assert_eq!(error(&format!("luggage-{share}:5x5")), KindError::Share);
        }
        assert_eq!(error("luggage-10"), KindError::Size(String::new()), "a family without any");
        assert_eq!(error("luggage-30:1000x1000"), KindError::TooMuch("1000x1000".to_owned()));
        for size in ["", "5", "0x5", "5x2049", "5x-1", "5x5x5"] {
            assert_eq!(error(&format!("walls:{size}")), KindError::Size(size.to_owned()));
        }
    }

    #[test]
    fn halls_of_one_seed_are_the_same_and_of_another_others() {
        let kind = Kind { family: Family::Luggage(0.2), columns: 20, lines: 20 };
        let halls = |seed| Halls::Random { kind, count: 2, seed };
        assert_eq!(halls(1).hall(0), halls(1).hall(0));
        assert_ne!(halls(1).hall(0), halls(1).hall(1));
        assert_ne!(halls(1).hall(0), halls(2).hall(0));
    }
}
