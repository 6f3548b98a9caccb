//! The phases of a mission, each with exactly the data it needs (mission §4).
//! What leads from one to the next stands in `table`.

use crate::command::Move;
use crate::event::Piece;
use crate::retrieval::NotFetched;
use crate::units::{Cell, LuggageId, Pose};

/// Where the mission stands.
#[derive(Clone, Debug, PartialEq)]
pub enum Phase {
    /// No mission.
    Idle,
    /// Searching, the last way home included.
    Exploring,
    /// At a piece of luggage, from the bump on.
    Inspecting(Inspection),
    /// Driven by hand; keeps the phase it interrupted.
    Driving {
        /// The cell of a goto; `None` for a single move.
        goal: Option<Cell>,
        /// The move that is still to be ordered.
        next: Option<Move>,
        /// What goes on afterwards.
        interrupted: Box<Phase>,
    },
    /// On the way home after backHome.
    ReturningHome,
    /// At home after backHome, waiting for START.
    AtHome,
    /// On the way home after danger.
    ReturningWithAlarm,
    /// Home, and a bomb is known to be in the hall.
    BombLocated,
    /// The bomb is being fetched.
    Retrieving,
    /// The bomb is in the container.
    BagSecured,
    /// The whole hall is searched and the robot is home.
    Explored,
    /// Something went wrong; keeps the phase it interrupted.
    Fault {
        /// What went wrong.
        cause: FaultCause,
        /// Where START goes back to once the cause is gone.
        interrupted: Box<Phase>,
    },
}

impl Phase {
    /// Its name, without the data.
    #[must_use]
    pub const fn name(&self) -> PhaseName {
        match self {
            Phase::Idle => PhaseName::Idle,
            Phase::Exploring => PhaseName::Exploring,
            Phase::Inspecting(_) => PhaseName::Inspecting,
            Phase::Driving { .. } => PhaseName::Driving,
            Phase::ReturningHome => PhaseName::ReturningHome,
            Phase::AtHome => PhaseName::AtHome,
            Phase::ReturningWithAlarm => PhaseName::ReturningWithAlarm,
            Phase::BombLocated => PhaseName::BombLocated,
            Phase::Retrieving => PhaseName::Retrieving,
            Phase::BagSecured => PhaseName::BagSecured,
            Phase::Explored => PhaseName::Explored,
            Phase::Fault { .. } => PhaseName::Fault,
        }
    }

    /// The phase this one interrupts, if it is an interruption.
    #[must_use]
    pub fn interrupted(&self) -> Option<&Phase> {
        if let Phase::Driving { interrupted, .. } | Phase::Fault { interrupted, .. } = self { Some(interrupted) } else { None }
    }

    /// The phase that goes on when every interruption ends: itself, unless it is one.
    pub(crate) fn underlying(&self) -> &Phase {
        self.interrupted().map_or(self, Phase::underlying)
    }

    /// The phase that many interruptions below this one.
    pub(crate) fn below_mut(&mut self, depth: usize) -> &mut Phase {
        if depth == 0 || self.interrupted().is_none() {
            return self;
        }
        let (Phase::Driving { interrupted, .. } | Phase::Fault { interrupted, .. }) = self else { return self };
        interrupted.below_mut(depth - 1)
    }

    /// As `underlying`, to be changed.
    pub(crate) fn underlying_mut(&mut self) -> &mut Phase {
        self.below_mut(usize::MAX)
    }

    /// The inspection under way, interrupted or not.
    #[must_use]
    pub fn inspection(&self) -> Option<&Inspection> {
        if let Phase::Inspecting(inspection) = self.underlying() { Some(inspection) } else { None }
    }

    pub(crate) const fn fault(&self) -> Option<&FaultCause> {
        if let Phase::Fault { cause, .. } = self { Some(cause) } else { None }
    }

    /// Whether the robot moves in it, unless something holds it.
    pub(crate) const fn is_motion(&self) -> bool {
        match self {
            Phase::Exploring | Phase::ReturningHome | Phase::ReturningWithAlarm | Phase::Driving { .. } | Phase::Retrieving => {
                true
            }
            Phase::Inspecting(inspection) => matches!(inspection.stage, Stage::BackingUp),
            Phase::Idle | Phase::AtHome | Phase::BombLocated | Phase::BagSecured | Phase::Explored | Phase::Fault { .. } => false,
        }
    }

    /// Whether a mission is under way: raising a hold then also raises `awaitingStart`.
    #[must_use]
    pub fn is_mission(&self) -> bool {
        !matches!(self.underlying(), Phase::Idle | Phase::Explored | Phase::BagSecured) || self.fault().is_some()
    }
}

named! {
    ALL by name;
    /// The phases by the names that every door shows.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
    #[expect(missing_docs, reason = "the variants are documented at `Phase`")]
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
    /// The same for an operator.
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

/// A piece being inspected.
#[derive(Clone, Debug, PartialEq)]
pub struct Inspection {
    /// The cell of the obstacle.
    pub cell: Cell,
    /// Which piece the camera takes it for, if it can tell.
    pub piece: Option<Piece>,
    /// Where the robot stands to photograph it.
    pub pose: Pose,
    /// How far it has come.
    pub stage: Stage,
}

/// How far an inspection has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Returning to the centre of the cell it came from: the only part that is motion.
    BackingUp,
    /// The photo is to be taken, or is being taken.
    TakingPhoto,
    /// The record is on its way to the store.
    Recording(LuggageId),
    /// The record is kept; the operator decides.
    AwaitingVerdict(LuggageId),
    /// As before, and the photo is being taken again.
    RetakingPhoto(LuggageId),
}

impl Inspection {
    /// The record of this piece, once there is one.
    #[must_use]
    pub const fn luggage(&self) -> Option<LuggageId> {
        match self.stage {
            Stage::Recording(id) | Stage::AwaitingVerdict(id) | Stage::RetakingPhoto(id) => Some(id),
            Stage::BackingUp | Stage::TakingPhoto => None,
        }
    }
}

/// Why a mission is in fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FaultCause {
    /// No known way leads home.
    NoWayHome,
    /// The robot did not finish an order in time.
    Unanswered,
    /// The search went round in circles without giving an order.
    Undecided,
    /// The robot could not carry out an order; its own words.
    Robot(String),
    /// The piece cannot be fetched; why.
    NotFetched(NotFetched),
}

/// What stands before and behind a robot's own words.
const ROBOT: (&str, &str) = ("the robot could not carry out its order (", "): look after it, then press START");

/// What stands before why a piece was not fetched.
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
    /// The cause that has these words; `None` when none has them, as those of another version.
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
    use crate::retrieval::RetrievalFault;
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
