//! Who fetches a piece, and why it was not fetched, in words and back: the journal stores only the words. What ends a
//! run of the pair stands in `pair`.

use std::fmt;

use crate::pair::RetrievalFault;

named! {
    ALL by name;
    /// Who fetches a dangerous piece (mission §4).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Fetcher {
        /// Two mobile manipulators, SRM1 and SRM2.
        Pair = "pair",
        /// The robot that searches, which plays both parts.
        Discovery = "discovery",
        /// Nobody: RETRIEVE is refused.
        None = "none",
    }
}

/// Stands between why the robots go out without the piece and why they cannot.
const AND: &str = "; and ";

/// Why a piece was not fetched. `Display` is what an operator reads, and what the journal stores.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotFetched {
    /// The pair could not go on; with the error of a tree, in the words of whoever read it.
    Pair(RetrievalFault, Option<String>),
    /// The robot that fetches by itself could not go on.
    Alone(AloneFault),
    /// The settings name another fetcher than the one that began, which may stand anywhere with the piece in the grip.
    OtherFetcher {
        began: Fetcher,
        /// The present setting.
        set: Fetcher,
    },
    /// The robots that fetched cannot go back outside; with the reason why they were to go without the piece, where
    /// there is one.
    Stuck(StuckFault, Option<Box<NotFetched>>),
    /// In words of another version.
    Other(String),
}

named! {
    ALL by in_words;
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum AloneFault {
        OtherPiece = "the robot has taken another piece than the one it was sent for",
        PieceLost = "the robot does not hold the piece any more, and it is not in the container",
        NoWayHome = "no known way leads home with the piece",
        NoWayToPiece = "no way leads to the piece",
        CannotTake = "the robot cannot take hold of the piece",
        NotRecognised = "the robot does not recognise the piece where it should stand",
    }
}

named! {
    ALL by in_words;
    /// What prevents the robots that fetched from leaving the hall.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum StuckFault {
        RobotFails = "a robot that fetches cannot do what it is told",
        NoWayOut = "no way leads the robots that fetch back outside",
    }
}

impl fmt::Display for NotFetched {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NotFetched::Pair(fault, None) => f.write_str(fault.in_words()),
            NotFetched::Pair(fault, Some(words)) => write!(f, "{} ({words})", fault.in_words()),
            NotFetched::Alone(fault) => f.write_str(fault.in_words()),
            NotFetched::OtherFetcher { began, set } => {
                write!(f, "it was begun with mission.retrieval = {:?}, which is {:?} now: set it back", began.name(), set.name())
            }
            NotFetched::Stuck(fault, None) => f.write_str(fault.in_words()),
            NotFetched::Stuck(fault, Some(before)) => write!(f, "{before}{AND}{}", fault.in_words()),
            NotFetched::Other(words) => f.write_str(words),
        }
    }
}

impl NotFetched {
    /// The reason with these words; `Other` when there is none.
    #[must_use]
    pub fn from_words(words: &str) -> NotFetched {
        let stuck = StuckFault::ALL.into_iter().find_map(|fault| {
            let before = words.strip_suffix(fault.in_words())?;
            let before = if before.is_empty() { None } else { Some(Box::new(once(before.strip_suffix(AND)?))) };
            Some(NotFetched::Stuck(fault, before))
        });
        stuck.unwrap_or_else(|| once(words))
    }
}

/// A single reason with these words: the many reasons that a damaged journal may hold are not taken apart any further.
fn once(words: &str) -> NotFetched {
    let pair = RetrievalFault::ALL.into_iter().find_map(|fault| {
        let more = words.strip_prefix(fault.in_words())?;
        let own = if more.is_empty() { None } else { Some(more.strip_prefix(" (")?.strip_suffix(')')?.to_owned()) };
        Some(NotFetched::Pair(fault, own))
    });
    let alone = AloneFault::ALL.into_iter().map(NotFetched::Alone);
    let fetchers = Fetcher::ALL.into_iter().flat_map(|began| Fetcher::ALL.map(|set| NotFetched::OtherFetcher { began, set }));
    let read = pair.into_iter().chain(alone).chain(fetchers).find(|read| read.to_string() == words);
    read.unwrap_or_else(|| NotFetched::Other(words.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rng::RandomStream;
    use crate::words::hostile;

    fn one(dice: &mut RandomStream) -> NotFetched {
        let fetcher = |dice: &mut RandomStream| Fetcher::ALL[dice.below(3) as usize];
        match dice.below(4) {
            0 => NotFetched::Pair(RetrievalFault::ALL[dice.below(10) as usize], None),
            1 => NotFetched::Pair(RetrievalFault::ALL[dice.below(10) as usize], Some(hostile(dice))),
            2 => NotFetched::Alone(AloneFault::ALL[dice.below(6) as usize]),
            _ => NotFetched::OtherFetcher { began: fetcher(dice), set: fetcher(dice) },
        }
    }

    #[test]
    fn every_reason_comes_back_from_its_words() {
        let mut dice = RandomStream::new(1, "not fetched");
        for _ in 0..5000 {
            let one = one(&mut dice);
            assert_eq!(NotFetched::from_words(&one.to_string()), one);
            let before = if dice.happens(0.2) { None } else { Some(Box::new(one)) };
            let stuck = NotFetched::Stuck(StuckFault::ALL[dice.below(2) as usize], before);
            assert_eq!(NotFetched::from_words(&stuck.to_string()), stuck);
        }
    }

    #[test]
    fn words_of_another_version_stay_as_they_are() {
        let mut dice = RandomStream::new(2, "not fetched");
        for _ in 0..5000 {
            let words = hostile(&mut dice);
            assert_eq!(NotFetched::from_words(&words).to_string(), words);
        }
        for words in ["", "no way leads to the piece.", "the pair has lost the parcel too often (", "a tree fell"] {
            assert_eq!(NotFetched::from_words(words), NotFetched::Other(words.to_owned()));
        }
    }

    #[test]
    fn words_without_end_are_taken_apart_once() {
        let words = format!("{AND}{}", StuckFault::NoWayOut.in_words()).repeat(100_000);
        assert!(matches!(
            NotFetched::from_words(&words),
            NotFetched::Stuck(_, Some(before)) if matches!(*before, NotFetched::Other(_))
        ));
    }
}
