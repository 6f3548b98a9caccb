//! Compares strategies: each searches the same halls, and the results are measured.
//!
//! ```text
//!   Halls ─ ground ─┐
//!   Entrant ────────┼─► trial ─► Trial ─► Measure ─► Estimate: mean and interval
//!   Terms ──────────┘
//! ```
//! The comparisons of the tables in the documentation are in `rows`.

mod estimate;
mod halls;
pub mod rows;
mod trial;

pub use self::estimate::Estimate;
pub use self::halls::{Halls, Kind, KindError};
pub use self::trial::{Entrant, Timings, Trial, tour, trial};

use std::time::Duration;

use crate::parallel;
use hallsweep_core::search::Terms;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// The cost of all moves per reachable cell.
    MovesPerCell,
    /// The number of moves before a piece of luggage was found, per reachable cell. It is a mean over all pieces.
    ToAPiece,
    /// The number of steps, divided by a lower bound for closed tours over the same cells.
    StepsOverBound,
    Seconds,
}

impl Measure {
    /// All measures, in the order in which they are printed.
    pub const ALL: [Measure; 4] = [Measure::MovesPerCell, Measure::ToAPiece, Measure::StepsOverBound, Measure::Seconds];

    /// Takes this measure of a search. `None` for `ToAPiece` if no luggage was found.
    #[must_use]
    pub fn of(self, trial: &Trial) -> Option<f64> {
        match self {
            Measure::MovesPerCell => Some(trial.moves_per_cell),
            Measure::ToAPiece => trial.to_a_piece,
            Measure::StepsOverBound => Some(trial.steps_over_bound),
            Measure::Seconds => Some(trial.seconds),
        }
    }
}

#[derive(Clone, Debug)]
pub struct Contest {
    pub halls: Halls,
    pub terms: Terms,
    pub timings: Timings,
}

impl Contest {
    /// Lets every entrant (a strategy or other weights) search every hall. Returns the trials of each entrant, in the
    /// order of the halls. `clock` measures how long each decision takes. `done` is called after each trial, from any
    /// thread.
    pub fn run(&self, entrants: &[Entrant], clock: impl Fn() -> Duration + Sync, done: impl Fn() + Sync) -> Vec<Vec<Trial>> {
        let halls = self.halls.count();
        let mut trials = parallel::each(halls * entrants.len(), |n, ways| {
            // The entrants take turns, so that the trials of the slowest one are not all at the end.
            let (hall, entrant) = (n / entrants.len(), n % entrants.len());
            let trial = trial(&self.halls.ground(hall), self.terms, self.timings, &entrants[entrant], ways, &clock);
            done();
            trial
        })
        .into_iter();
        let mut of_each: Vec<Vec<Trial>> = entrants.iter().map(|_| Vec::with_capacity(halls)).collect();
        for _ in 0..halls {
            for (trials, trial) in of_each.iter_mut().zip(&mut trials) {
                trials.push(trial);
            }
        }
        of_each
    }
}

/// The mean of a measure over all trials. `None` if the measure applies to no trial.
#[must_use]
pub fn over(trials: &[Trial], measure: Measure) -> Option<Estimate> {
    Estimate::of(trials.iter().filter_map(|trial| measure.of(trial)))
}

/// The mean difference between two entrants: the first minus the second, in the same halls.
#[must_use]
pub fn against(trials: &[Trial], others: &[Trial], measure: Measure) -> Option<Estimate> {
    let pairs = trials.iter().zip(others);
    Estimate::of(pairs.filter_map(|(trial, other)| Some(measure.of(trial)? - measure.of(other)?)))
}

/// The durations of all decisions in these trials: the median, the 99th percentile, and the maximum.
#[must_use]
pub fn decisions(trials: &[Trial]) -> [Duration; 3] {
    let mut all: Vec<u32> = trials.iter().flat_map(|trial| &trial.decisions_ns).copied().collect();
    all.sort_unstable();
    let at = |share: usize| all.get((all.len() * share / 100).min(all.len().saturating_sub(1))).copied().unwrap_or(0);
    [50, 99, 100].map(|share| Duration::from_nanos(u64::from(at(share))))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::family::Family;
    use hallsweep_core::command::Strategy;
    use hallsweep_core::search::Objective;
    use hallsweep_core::search::costs::Costs;

    fn contest(family: Family) -> Contest {
        let terms = Terms { objective: Objective::Cover, sonar_cells: 0, costs: Costs::EVEN };
        let halls = Halls::Random { kind: Kind { family, columns: 12, lines: 9 }, count: 8, seed: 1 };
        Contest { halls, terms, timings: Timings { step_s: 1.0, turn_s: 2.0, bump_s: 1.5 } }
    }

    #[test]
    fn every_entrant_has_the_same_halls_in_the_same_order_however_many_threads_there_are() {
        let entrants = [Entrant::Strategy(Strategy::Frontier), Entrant::Strategy(Strategy::Snail)];
        let contest = contest(Family::Luggage(0.1));
        let run = || contest.run(&entrants, || Duration::ZERO, || ());
        let [frontier, snail] = run().try_into().expect("two entrants have two lists of trials");
        assert_eq!(frontier.len(), 8);
        for (one, other) in frontier.iter().zip(&snail) {
            assert_eq!(one.cells, other.cells);
            assert!(one.complete && other.complete);
        }
        let more = against(&snail, &frontier, Measure::MovesPerCell).expect("every hall has cells");
        assert!(more.mean - more.half_width > 0.0, "the snail goes home after every square: {more:?}");
        let moves = |trials: &[Vec<Trial>]| -> Vec<_> { trials.iter().flatten().map(|trial| trial.moves).collect() };
        assert_eq!(moves(&run()), moves(&run()));
    }

    #[test]
    fn auto_finds_luggage_along_the_walls_much_sooner_than_the_score_and_elsewhere_hardly_later() {
        let entrants = [Entrant::Strategy(Strategy::Auto), Entrant::Strategy(Strategy::Scored)];
        let to_a_piece = |family| {
            let kind = Kind { family, columns: 40, lines: 40 };
            let terms = Terms { objective: Objective::Find, sonar_cells: 0, costs: Costs::EVEN };
            let contest = Contest { halls: Halls::Random { kind, count: 30, seed: 2 }, terms, ..contest(family) };
            let trials = contest.run(&entrants, || Duration::ZERO, || ());
            [0, 1].map(|entrant| over(&trials[entrant], Measure::ToAPiece).expect("there is luggage").mean)
        };
        let ([auto, scored], [usual_auto, usual_scored]) = (to_a_piece(Family::Walls), to_a_piece(Family::Luggage(0.1)));
        assert!(auto < scored / 2.0, "along the walls {auto}, the score {scored}");
        assert!(usual_auto < usual_scored * 1.05, "anywhere {usual_auto}, the score {usual_scored}");
    }

    #[test]
    fn a_hall_without_luggage_says_nothing_of_the_time_to_a_piece() {
        let trials = contest(Family::Luggage(0.0)).run(&[Entrant::Strategy(Strategy::Columns)], || Duration::ZERO, || ());
        assert_eq!(over(&trials[0], Measure::ToAPiece), None);
        let seconds = over(&trials[0], Measure::Seconds).expect("it moves").mean;
        let moves = trials[0][0].moves;
        let expect = [(moves.steps, 1.0), (moves.turns, 2.0), (moves.bumps, 1.5)];
        #[expect(clippy::cast_precision_loss, reason = "a small hall")]
        let expect: f64 = expect.into_iter().map(|(moves, each)| moves as f64 * each).sum();
        assert_eq!(seconds, expect, "all halls of this family are the same");
    }

    #[test]
    fn decisions_are_told_by_their_median_the_slowest_of_a_hundred_and_the_slowest() {
        let mut trial =
            contest(Family::Maze).run(&[Entrant::Strategy(Strategy::Columns)], || Duration::ZERO, || ())[0][0].clone();
        trial.decisions_ns = (0..=1000).rev().collect();
        assert_eq!(decisions(&[trial]), [500, 990, 1000].map(Duration::from_nanos));
        assert_eq!(decisions(&[]), [Duration::ZERO; 3]);
    }
}
