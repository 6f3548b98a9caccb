//! The order in which a hall is searched: one file a strategy, behind one enum, and the planner under them.
//! A strategy looks at a view and returns the next goal; it performs nothing.

pub(crate) mod plan;
mod snail;

use self::plan::Planner;
use self::snail::Snail;
use super::units::{Cell, Pose};
use super::world::hall_map::HallMap;

named! {
    ALL by name;
    /// The ways to search a hall.
    #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
    pub enum Strategy {
        /// The seeds' *chiocciola*: growing squares, home after each.
        #[default]
        Snail = "snail",
    }
}

impl Strategy {
    /// The strategy of this name.
    #[must_use]
    pub fn named(name: &str) -> Option<Strategy> {
        Strategy::ALL.into_iter().find(|strategy| strategy.name() == name)
    }

    /// The search of which these notes were kept.
    #[must_use]
    pub fn resume(self, notes: &[i64]) -> Search {
        match self {
            Strategy::Snail => Search::Snail(Snail::from_notes(notes)),
        }
    }

    /// A search that has not begun yet.
    #[must_use]
    pub fn begin(self) -> Search {
        match self {
            Strategy::Snail => Search::Snail(Snail::default()),
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct View<'a> {
    pub(crate) map: &'a HallMap,
    pub(crate) pose: Pose,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NextGoal {
    /// Go to this cell, or find out what stands there.
    Visit(Cell),
    /// Go home, and ask again there.
    GoHome,
    /// Everything that can be reached is known, and the robot was sent home.
    Finished,
}

/// A search under way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Search {
    /// A snail's.
    Snail(Snail),
}

impl Search {
    /// How far it has come, as plain numbers for the record.
    #[must_use]
    pub fn notes(&self) -> Vec<i64> {
        match self {
            Search::Snail(snail) => snail.notes(),
        }
    }

    /// What to do now that the last goal is reached, has turned out to be an obstacle, or cannot be reached.
    pub(crate) fn next(&mut self, view: &View<'_>, planner: &mut Planner) -> NextGoal {
        match self {
            Search::Snail(snail) => snail.next(view, planner),
        }
    }
}
