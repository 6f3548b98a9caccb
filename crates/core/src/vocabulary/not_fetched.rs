//! Who fetches a dangerous piece, and why a piece was not fetched. `pair` has the reasons that stop the two robots of
//! a pair.

use std::fmt;

use crate::pair::RetrievalFault;

named! {
    ALL by name;
    /// Who fetches a dangerous piece (mission §4).
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Fetcher {
        /// Two mobile manipulators, SRM1 and SRM2.
        Pair = "pair",
        /// The robot that searches also fetches.
        Discovery = "discovery",
        /// Nobody fetches, and RETRIEVE is refused.
        None = "none",
    }
}

/// Why a piece was not fetched. `Display` gives the text for an operator.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum NotFetched {
    /// The pair of robots could not continue. The text is the error of a behaviour tree, if that was the cause.
    Pair(RetrievalFault, Option<String>),
    Alone(AloneFault),
    /// The settings now name another fetcher than the one that began the retrieval. The robots of the first fetcher
    /// may stand anywhere, with the piece in their grip.
    OtherFetcher {
        began: Fetcher,
        /// The fetcher that the settings now name.
        set: Fetcher,
    },
    /// The robots that fetch cannot go back outside. If they had to go out without the piece, the second value says
    /// why they do not have it.
    Stuck(StuckFault, Option<Box<NotFetched>>),
    /// A reason that another version of the program recorded, as text.
    Other(String),
}

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum AloneFault {
        OtherPiece = "otherPiece",
        PieceLost = "pieceLost",
        NoWayHome = "noWayHome",
        NoWayToPiece = "noWayToPiece",
        CannotTake = "cannotTake",
        NotRecognised = "notRecognised",
    }
}

impl AloneFault {
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            AloneFault::OtherPiece => "the robot has taken another piece than the one it was sent for",
            AloneFault::PieceLost => "the robot does not hold the piece any more, and it is not in the container",
            AloneFault::NoWayHome => "no known way leads home with the piece",
            AloneFault::NoWayToPiece => "no way leads to the piece",
            AloneFault::CannotTake => "the robot cannot take hold of the piece",
            AloneFault::NotRecognised => "the robot does not recognise the piece where it should stand",
        }
    }
}

named! {
    ALL by name;
    /// The reason why robots that fetched a piece cannot leave the hall.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum StuckFault {
        RobotFails = "robotFails",
        NoWayOut = "noWayOut",
    }
}

impl StuckFault {
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            StuckFault::RobotFails => "a robot that fetches cannot do what it is told",
            StuckFault::NoWayOut => "no way leads the robots that fetch back outside",
        }
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
            NotFetched::Stuck(fault, Some(before)) => write!(f, "{before}; and {}", fault.in_words()),
            NotFetched::Other(words) => f.write_str(words),
        }
    }
}
