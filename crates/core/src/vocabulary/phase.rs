//! The names of the phases, and why a mission is in fault.

use super::not_fetched::NotFetched;

named! {
    ALL by name;
    /// The phases by the names that every door shows; `state::Phase` explains them.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum PhaseName {
        #[default]
        Idle = "idle",
        Exploring = "exploring",
        Inspecting = "inspecting",
        Driving = "driving",
        ReturningHome = "returningHome",
        AtHome = "atHome",
        ReturningWithAlarm = "returningWithAlarm",
        BombLocated = "bombLocated",
        Retrieving = "retrieving",
        BagSecured = "bagSecured",
        Explored = "explored",
        Fault = "fault",
    }
}

impl PhaseName {
    /// For an operator.
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            PhaseName::Idle => "idle",
            PhaseName::Exploring => "exploring",
            PhaseName::Inspecting => "inspecting luggage",
            PhaseName::Driving => "driving by hand",
            PhaseName::ReturningHome => "returning home",
            PhaseName::AtHome => "waiting at home",
            PhaseName::ReturningWithAlarm => "returning home with an alarm",
            PhaseName::BombLocated => "home, bomb located",
            PhaseName::Retrieving => "retrieving the bag",
            PhaseName::BagSecured => "bag secured",
            PhaseName::Explored => "hall explored",
            PhaseName::Fault => "in fault",
        }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FaultCause {
    NoWayHome,
    /// The robot did not finish an order in time.
    Unanswered,
    /// The search went round in circles without giving an order.
    Undecided,
    /// The robot could not carry out an order; with its own words.
    Robot(String),
    NotFetched(NotFetched),
}

/// Stands before and behind a robot's own words.
const ROBOT: (&str, &str) = ("the robot could not carry out its order (", "): look after it, then press START");

/// Stands before the reason why a piece was not fetched.
const NOT_FETCHED: &str = "the piece was not fetched: ";

impl std::fmt::Display for FaultCause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FaultCause::NoWayHome => f.write_str("no known way leads home: clear the way, or fetch the robot"),
            FaultCause::Undecided => f.write_str("the search finds no next step: press RESET and begin anew"),
            FaultCause::Unanswered => f.write_str("the robot did not finish its order in time: look after it, then press START"),
            FaultCause::NotFetched(why) => write!(f, "{NOT_FETCHED}{why}"),
            FaultCause::Robot(words) => write!(f, "{}{words}{}", ROBOT.0, ROBOT.1),
        }
    }
}

impl FaultCause {
    /// The cause with these words; `None` for others, such as those of another version.
    #[must_use]
    pub fn from_words(words: &str) -> Option<FaultCause> {
        let robot = || words.strip_prefix(ROBOT.0)?.strip_suffix(ROBOT.1);
        let not_fetched = || words.strip_prefix(NOT_FETCHED).map(NotFetched::from_words);
        let fixed = [FaultCause::NoWayHome, FaultCause::Unanswered, FaultCause::Undecided];
        let read = fixed.into_iter().find(|cause| cause.to_string() == words);
        read.or_else(|| robot().map(|words| FaultCause::Robot(words.to_owned())))
            .or_else(|| not_fetched().map(FaultCause::NotFetched))
            .filter(|cause| cause.to_string() == words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pair::RetrievalFault;
    use crate::rng::RandomStream;
    use crate::words::hostile;

    #[test]
    fn every_cause_of_a_fault_comes_back_from_its_words() {
        let mut dice = RandomStream::new(1, "faults");
        for _ in 0..5000 {
            for cause in [
                FaultCause::NoWayHome,
                FaultCause::Unanswered,
                FaultCause::Undecided,
                FaultCause::Robot(hostile(&mut dice)),
                FaultCause::NotFetched(NotFetched::Pair(RetrievalFault::Tree, Some(hostile(&mut dice)))),
                FaultCause::NotFetched(NotFetched::from_words(&hostile(&mut dice))),
            ] {
                assert_eq!(FaultCause::from_words(&cause.to_string()), Some(cause));
            }
        }
    }

    #[test]
    fn words_of_another_version_are_no_cause() {
        for words in ["", "the robot is tired", "the robot could not carry out its order ("] {
            assert_eq!(FaultCause::from_words(words), None);
        }
    }
}
