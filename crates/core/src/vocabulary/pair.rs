//! The two robots that fetch as a pair, their calls to the operator, and the reasons why they cannot continue.
//! Robots, calls and reasons have fixed names. Calls and reasons also have a text.

use crate::robot::RobotId;

named! {
    ALL by name;
    /// One of the two robots, named as in the original specification.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
    pub enum Which {
        /// The first robot, which leads the way.
        Srm1 = "SRM1",
        /// The second robot, which comes when it is told where to go.
        Srm2 = "SRM2",
    }
}

impl Which {
    #[must_use]
    pub const fn other(self) -> Which {
        match self {
            Which::Srm1 => Which::Srm2,
            Which::Srm2 => Which::Srm1,
        }
    }

    #[must_use]
    pub fn robot(self) -> RobotId {
        RobotId::new(match self {
            Which::Srm1 => "srm1",
            Which::Srm2 => "srm2",
        })
        .expect("both are names of robots")
    }

    #[must_use]
    pub const fn index(self) -> usize {
        match self {
            Which::Srm1 => 0,
            Which::Srm2 => 1,
        }
    }
}

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum RetrievalFault {
        NothingToFetch = "nothingToFetch",
        /// On the known map, the two robots cannot both stand beside the parcel and carry it to its destination.
        NoWayToParcel = "noWayToParcel",
        /// Both robots hold the parcel, but no way leads to its destination.
        NoWayToTarget = "noWayToTarget",
        NoWayBack = "noWayBack",
        WrongParcel = "wrongParcel",
        RobotFails = "robotFails",
        LostTooOften = "lostTooOften",
        NotAligned = "notAligned",
        TakesTooLong = "takesTooLong",
        Tree = "tree",
    }
}

impl RetrievalFault {
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            RetrievalFault::NothingToFetch => "the pair does not know what to fetch",
            RetrievalFault::NoWayToParcel => "the pair finds no way to take hold of the parcel from two sides and carry it off",
            RetrievalFault::NoWayToTarget => "the pair finds no way to carry the parcel to where it is to go",
            RetrievalFault::NoWayBack => "the pair finds no way back to the pallet",
            RetrievalFault::WrongParcel => "the pair has taken hold of another parcel than the one it was sent for",
            RetrievalFault::RobotFails => "a robot of the pair cannot do what it is told: look after it",
            RetrievalFault::LostTooOften => "the pair has lost the parcel too often",
            RetrievalFault::NotAligned => "the pair cannot bring the parcel exactly to where it is to be put down",
            RetrievalFault::TakesTooLong => "one step of the pair's work takes longer than it ever should",
            RetrievalFault::Tree => "a behaviour tree cannot be performed as it is written",
        }
    }
}

named! {
    ALL by name;
    /// A call of the pair to the operator. It raises an alarm. The behaviour trees continue only after the alarm is
    /// acknowledged.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Saying {
        /// The robot recognises no parcel at the expected place.
        CallOperator = "callOperator",
        PackageLost = "packageLost",
    }
}

impl Saying {
    #[must_use]
    pub const fn in_words(self) -> &'static str {
        match self {
            Saying::CallOperator => "the pair recognises no parcel: look what stands there, then acknowledge and press START",
            Saying::PackageLost => "the pair has lost the parcel: look where it lies, then acknowledge and press START",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_of_the_two_is_the_others_other_and_has_a_place_of_its_own() {
        for (index, which) in Which::ALL.into_iter().enumerate() {
            assert_eq!((which.index(), which.other().other()), (index, which));
            assert_ne!(which.other(), which);
        }
    }
}
