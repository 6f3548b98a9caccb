//! The parts of a score, by their names in files of weights: the numbers of its linear part, and its tables.
//! `outlook` turns an outlook into these numbers and rows.

/// Number of values in the linear part of a score.
pub const LINEAR: usize = 28;

/// The names of the linear values in files of weights.
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

/// The name of each table in files of weights, and its number of rows.
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

/// The number of the first row of each table, when the rows of all tables are counted together.
pub const STARTS: [usize; TABLES.len() + 1] = {
    let mut starts = [0; TABLES.len() + 1];
    let mut n = 0;
    while n < TABLES.len() {
        starts[n + 1] = starts[n] + TABLES[n].1;
        n += 1;
    }
    starts
};

pub const ROWS: usize = STARTS[TABLES.len()];

/// Maximum length of a run, or of an edge along a run, in cells.
pub(super) const RUN: usize = 6;

/// A group of connected unknown cells counts as small up to this number of cells.
pub(super) const SMALL: usize = 10;

const fn power(base: usize, exponent: u32) -> usize {
    base.pow(exponent)
}
