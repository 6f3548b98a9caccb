//! The pair's calls to the operator, and the reasons why it cannot go on, each with a name and in words.

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
    pub enum RetrievalFault {
        NothingToFetch = "nothingToFetch",
        /// As far as is known, the two cannot both stand beside the parcel and carry it to its destination.
        NoWayToParcel = "noWayToParcel",
        /// The two hold the parcel, and no way leads to its destination.
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
    /// A call of the pair to the operator: an alarm, which has to be acknowledged before the trees go on.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Saying {
        /// No parcel is recognised where one should be.
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
