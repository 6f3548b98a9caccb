//! What a score is made of: the numbers of its linear part, and its tables, by the names that files of weights use. How an outlook comes
//! to a number or a row stands in `outlook`.

/// How many numbers the linear part of a score weighs.
pub const LINEAR: usize = 28;

/// What each of them is, as files of weights call it.
pub const LINEAR_NAMES: [&str; LINEAR] = [
    "behindUnknown",
    "oneSideUnknown",
    "bothSidesUnknown",
    "aloneStraightOn",
    "runAhead",
    "manhattanGain",
    "chebyshevGain",
    "smallComponent",
    "unknownAheadAside",
    "unknownBackAside",
    "unknownFarAside",
    "unknownFarAheadAside",
    "unknownAheadFarAside",
    "unknownBackFarAside",
    "unknownTwoAhead",
    "unknownThreeAhead",
    "blockedAhead",
    "blockedAside",
    "blockedAheadAside",
    "blockedBackAside",
    "straightOn",
    "turnsBack",
    "sameTurn",
    "knownDiagonal",
    "unknownDiagonal",
    "vertical",
    "rightKnown",
    "seenRun",
];

/// The tables: what each is called in files of weights, and how many rows it has.
pub const TABLES: [(&str, usize); 14] = [
    ("round", power(3, 7)),
    ("unknown", power(2, 12)),
    ("behind", power(3, 5) * 4),
    ("left", power(2, 10)),
    ("right", power(2, 10)),
    ("ahead", power(3, 9)),
    ("runAndWidth", (RUN + 1) * 4 * (RUN + 1) * (RUN + 1)),
    ("turnAndWay", 4 * 12 * 9),
    ("component", (SMALL + 1) * 16),
    ("blocked", 8 * power(3, 4)),
    ("wall", 8 * power(3, 4)),
    ("roundTurnAndWay", power(3, 7) * 4 * 3),
    ("wide", power(2, 12) * 4),
    ("far", power(3, 8)),
];

/// Where each table begins among the rows of all.
pub const STARTS: [usize; TABLES.len() + 1] = {
    let mut starts = [0; TABLES.len() + 1];
    let mut n = 0;
    while n < TABLES.len() {
        starts[n + 1] = starts[n] + TABLES[n].1;
        n += 1;
    }
    starts
};

/// How many rows all tables have.
pub const ROWS: usize = STARTS[TABLES.len()];

/// So far ahead a run, or an edge along it, is followed.
pub(super) const RUN: usize = 6;

/// Unknown cells that hang together are counted up to so many.
pub(super) const SMALL: usize = 10;

const fn power(base: usize, exponent: u32) -> usize {
    base.pow(exponent)
}
