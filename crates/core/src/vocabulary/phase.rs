//! The names of the phases, and why a mission is in fault. `state::phase` has the data of each phase.

use super::not_fetched::NotFetched;

named! {
    ALL by name;
    /// The names of the phases, as every interface shows them. `state::Phase` explains the phases.
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
    Unanswered,
    /// The search repeated itself without giving an order.
    Undecided,
    /// The robot reported this fault.
    Robot(String),
    NotFetched(NotFetched),
}

impl std::fmt::Display for FaultCause {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            FaultCause::NoWayHome => f.write_str("no known way leads home: clear the way, or fetch the robot"),
            FaultCause::Undecided => f.write_str("the search finds no next step: press RESET and begin anew"),
            FaultCause::Unanswered => f.write_str("the robot did not finish its order in time: look after it, then press START"),
            FaultCause::NotFetched(why) => write!(f, "the piece was not fetched: {why}"),
            FaultCause::Robot(words) => {
                write!(f, "the robot could not carry out its order ({words}): look after it, then press START")
            }
        }
    }
}
