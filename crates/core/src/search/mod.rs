//! The order in which a hall is searched: one file per strategy, one list of all strategies, and the ways that they
//! use. A strategy reads a view and returns what to do next. It moves nothing. This module ensures that no strategy
//! leaves out anything reachable.
//!
//! ```text
//!   map ─ marks ─► Grid ─┐
//!   pose, gait, terms ────┴─► View ─► strategy ─► a cell and the moves that enter it · home · nothing left
//!                                        └─ weighs entries (entries) by their outlook (outlook)
//! ```

pub mod areas;
mod auto;
pub mod census;
mod columns;
pub mod costs;
mod entries;
mod far;
mod focus;
pub mod forecast;
mod frontier;
pub mod grid;
pub mod outlook;
pub(crate) mod pace;
pub(crate) mod plan;
pub mod scored;
mod snail;
mod spiral;
pub mod tables;
mod view;
pub mod ways;
pub mod weights;

use self::entries::{Visit, nearest};
use self::snail::Snail;
pub use self::view::{Gait, Goal, NextGoal, Objective, Sensing, Terms, View};
use self::ways::Ways;
use crate::command::Strategy;

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Search {
    Snail(Snail),
    /// A strategy that stores no progress.
    Of(Strategy),
}

impl Strategy {
    #[must_use]
    pub fn named(name: &str) -> Option<Strategy> {
        Strategy::ALL.into_iter().find(|strategy| strategy.name() == name)
    }

    /// Whether the strategy must be asked again as soon as anything new is seen. Other strategies keep their chosen
    /// goal. They are asked only when the goal is reached or proves to be blocked.
    #[must_use]
    pub const fn heeds_news(self) -> bool {
        matches!(self, Strategy::Auto | Strategy::Scored)
    }

    #[must_use]
    pub fn resume(self, notes: &[i64]) -> Search {
        match self {
            Strategy::Snail => Search::Snail(Snail::from_notes(notes)),
            Strategy::Auto | Strategy::Scored | Strategy::Frontier | Strategy::Columns | Strategy::Spiral => Search::Of(self),
        }
    }

    #[must_use]
    pub fn begin(self) -> Search {
        self.resume(&[])
    }
}

impl Search {
    #[must_use]
    pub const fn strategy(&self) -> Strategy {
        match self {
            Search::Snail(_) => Strategy::Snail,
            Search::Of(strategy) => *strategy,
        }
    }

    /// Returns the strategy's progress, as plain numbers for the record.
    #[must_use]
    pub fn notes(&self) -> Vec<i64> {
        match self {
            Search::Snail(snail) => snail.notes(),
            Search::Of(_) => Vec::new(),
        }
    }

    /// Returns the next goal. It is called when the last goal is reached, has turned out to be an obstacle, or cannot
    /// be reached.
    pub fn next(&mut self, view: &View<'_>, ways: &mut Ways) -> NextGoal {
        let strategy = match self {
            Search::Snail(snail) => return snail.next(view, ways),
            Search::Of(strategy) => strategy,
        };
        let focused = match view.focused(ways) {
            Ok(focused) => focused,
            Err(Visit { cell, route }) => return NextGoal::Visit(cell, route),
        };
        let visit = match strategy {
            Strategy::Auto | Strategy::Snail => auto::next(&focused, ways),
            Strategy::Scored => scored::next(&focused, ways),
            Strategy::Frontier => frontier::next(&focused, ways),
            Strategy::Columns => columns::next(&focused, ways),
            Strategy::Spiral => spiral::next(&focused, ways),
        };
        guarded(visit, view, ways)
    }
}

/// Returns the proposed goal. If there is no proposal but the hall is not searched completely, returns the nearest
/// open place.
fn guarded(proposed: Option<Visit>, view: &View<'_>, ways: &mut Ways) -> NextGoal {
    match proposed.or_else(|| nearest(view, ways, |_| true)) {
        Some(Visit { cell, route }) => NextGoal::Visit(cell, route),
        None => NextGoal::Finished,
    }
}

#[cfg(test)]
mod tests {
    use super::costs::Costs;
    use super::grid::Grid;
    use super::*;
    use crate::command::Move;
    use crate::units::{Cell, Pose, Revision};
    use crate::world::hall_map::{HallMap, Mark};

    /// Returns what a robot at home does, with these walls round it, when its strategy proposes `proposed`.
    fn next(walls: &[Cell], proposed: Option<Visit>) -> NextGoal {
        let mut map = HallMap::new(Cell::HOME, Revision(1));
        for wall in walls {
            map.mark(*wall, Mark::Wall, Revision(1));
        }
        let terms = Terms { objective: Objective::Find, sonar_cells: 0, costs: Costs::EVEN };
        let view = View { grid: &Grid::of(&map), pose: Pose::START, gait: Gait::default(), terms, areas: None };
        guarded(proposed, &view, &mut Ways::default())
    }

    #[test]
    fn a_strategy_that_proposes_nothing_does_not_end_a_search_while_something_is_open() {
        let (east, south) = (Cell::new(1, 0), Cell::new(0, 1));
        let [west, north] = [Cell::new(-1, 0), Cell::new(0, -1)];
        assert!(matches!(next(&[west, north, south], None), NextGoal::Visit(cell, _) if cell == east));
        assert_eq!(next(&[west, north, south, east], None), NextGoal::Finished);
    }

    #[test]
    fn what_a_strategy_proposes_is_done_though_something_else_is_nearer() {
        let cell = Cell::new(-1, 0);
        let proposed = Visit { cell, route: vec![Move::TurnRight, Move::Forward] };
        assert_eq!(next(&[], Some(proposed)), NextGoal::Visit(cell, vec![Move::TurnRight, Move::Forward]));
    }
}
