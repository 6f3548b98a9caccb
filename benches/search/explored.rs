//! A hall searched whole, once for the time of all of it and again for the time of each decision.

use std::time::Duration;

use hallsweep_core::command::Strategy;
use hallsweep_core::search::Terms;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::units::Cell;
use hallsweep_evaluation::Ground;
use hallsweep_evaluation::walk::Walk;

use crate::cpu::{Times, micros, timed};

/// Runs in which each decision is timed.
const RUNS: usize = 3;

/// What it came to.
pub(crate) struct Explored {
    pub(crate) cells: usize,
    pub(crate) moves: u64,
    /// All of it, the simulated robot included.
    pub(crate) all: Duration,
    pub(crate) decisions: Times,
}

impl Explored {
    /// Panics where anything was left out: figures of half a search are none.
    pub(crate) fn of(ground: &Ground, terms: Terms, strategy: Strategy) -> Explored {
        let mut walk = Walk::new(ground, terms);
        let (all, ()) = timed(|| walk.finish(ground, &mut Ways::default(), strategy.begin()));
        assert_eq!((walk.visited, walk.found), (ground.reachable, ground.touchable), "everything was visited and found");
        assert_eq!(walk.pose.cell, Cell::HOME, "the robot is home");
        let first = decisions(ground, terms, strategy);
        let decisions = (1..RUNS).fold(first, |times, _| times.shorter(&decisions(ground, terms, strategy)));
        Explored { cells: ground.reachable, moves: walk.moves.total(), all, decisions }
    }

    /// Both together.
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

    /// Cells, moves a cell, microseconds a move; mean, 99th percentile and worst of the decisions.
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

/// The columns of a line.
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
