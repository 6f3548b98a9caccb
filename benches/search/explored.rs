//! A hall searched completely, once for the total time and again for the time of each decision.

use std::time::Duration;

use hallsweep_core::command::Strategy;
use hallsweep_core::search::Terms;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::units::Cell;
use hallsweep_evaluation::Ground;
use hallsweep_evaluation::walk::Walk;

use crate::cpu::{Times, micros, timed};

/// Number of runs in which each decision is timed.
const RUNS: usize = 3;

/// Results of a search.
pub(crate) struct Explored {
    pub(crate) cells: usize,
    pub(crate) moves: u64,
    /// Total time, including the simulated robot.
    pub(crate) all: Duration,
    pub(crate) decisions: Times,
}

impl Explored {
    /// Panics when the search left anything out, because figures of an incomplete search mean nothing.
    pub(crate) fn of(ground: &Ground, terms: Terms, strategy: Strategy) -> Explored {
        let mut walk = Walk::new(ground, terms);
        let (all, ()) = timed(|| walk.finish(ground, &mut Ways::default(), strategy.begin()));
        assert_eq!((walk.visited, walk.found), (ground.reachable, ground.touchable), "everything was visited and found");
        assert_eq!(walk.pose.cell, Cell::HOME, "the robot is home");
        let first = decisions(ground, terms, strategy);
        let decisions = (1..RUNS).fold(first, |times, _| times.shorter(&decisions(ground, terms, strategy)));
        Explored { cells: ground.reachable, moves: walk.moves.total(), all, decisions }
    }

    /// Adds two results.
    pub(crate) fn and(self, other: Explored) -> Explored {
        Explored {
            cells: self.cells + other.cells,
            moves: self.moves + other.moves,
            all: self.all + other.all,
            decisions: self.decisions.and(other.decisions),
        }
    }

    pub(crate) fn micros_a_move(&self) -> f64 {
        micros(self.all) / self.moves as f64
    }

    /// Table row: cells, moves per cell, and µs per move; then mean, 99th percentile and worst decision.
    pub(crate) fn line(&self) -> String {
        let Explored { cells, moves, decisions, .. } = self;
        let [mean, p99, worst] = [decisions.mean(), decisions.within(99), decisions.worst()].map(micros);
        format!(
            "{cells:>8} {:>13.3} {:>10.2} {mean:>10.2} {p99:>10.1} {worst:>10.1}",
            *moves as f64 / *cells as f64,
            self.micros_a_move()
        )
    }
}

/// Heading of the table whose rows are made by `line`.
pub(crate) const HEADING: &str = "   cells  moves a cell  µs a move  decision: mean        p99      worst, µs";

fn decisions(ground: &Ground, terms: Terms, strategy: Strategy) -> Times {
    let (mut walk, mut search, mut ways) = (Walk::new(ground, terms), strategy.begin(), Ways::default());
    let mut times = Times::default();
    loop {
        let (time, goal) = timed(|| search.next(&walk.view(), &mut ways));
        times.add(time);
        if !walk.follow(ground, &mut ways, goal) {
            return times;
        }
    }
}
