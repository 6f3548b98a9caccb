//! Tunes the weights of the score. The linear part is tuned by the cross-entropy method, and the tables by regression
//! on trials of other choices. The same task and seed give the same weights on any number of processors.
//!
//! ```text
//!   cross_entropy    candidates around a mean ─► all search the same halls ─► mean and spread of the best ─► again
//!   counterfactual   At random decisions, another cell is entered, and the search continues up to a horizon. `rest`
//!                    estimates the cost of the remaining search. The target is the real additional cost minus the
//!                    additional cost that the scores predicted. Ridge regression explains it by the difference of
//!                    the outlooks (features) ─► better weights ─► again
//! ```

mod counterfactual;
mod cross_entropy;
mod rest;
mod ridge;

pub use self::counterfactual::{Lessons, Round};
pub use self::cross_entropy::cross_entropy;

use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::Objective;
use hallsweep_core::search::scored::choose;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::weights::Weights;

use crate::Ground;
use crate::family::{Family, below, hall};
use crate::walk::Walk;
use hallsweep_core::search::Terms;

#[derive(Clone, Debug)]
pub struct Task {
    pub terms: Terms,
    /// Smallest and largest side of the halls, in cells.
    pub sides: (usize, usize),
    /// The families of the halls. Each is equally frequent.
    pub families: Vec<Family>,
    pub seed: u64,
}

impl Task {
    #[must_use]
    pub fn usual(terms: Terms, seed: u64) -> Task {
        Task { terms, sides: (20, 30), families: vec![Family::Luggage(0.1)], seed }
    }

    /// The weights with which tuning begins. If the goal is to cover a hall, these are the weights of the pocket rule
    /// (prefer cells with few unvisited neighbours). If the goal is to find luggage, they are zero.
    #[must_use]
    pub fn first_weights(&self) -> Weights {
        let mut weights = Weights { least: -3000, ..Weights::nothing() };
        if self.terms.objective == Objective::Cover {
            weights.linear[..3].copy_from_slice(&[2500, 2500, 5000]);
        }
        weights
    }

    fn ground(&self, purpose: &str, number: u64) -> Ground {
        let mut dice = RandomStream::new(self.seed.wrapping_mul(1_000_003).wrapping_add(number), purpose);
        let (least, most) = self.sides;
        let family = self.families[below(self.families.len(), &mut dice)];
        let mut side = || least + below(most - least + 1, &mut dice);
        let (columns, lines) = (side(), side());
        Ground::of(&hall(family, columns, lines, &mut dice))
    }

    /// The cost of a whole search with these weights, per cell. If the goal is to cover a hall, this is the cost of
    /// all moves. If the goal is to find luggage, this is the mean number of moves before a cell or a piece is known.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "a hall has fewer cells than 2^53")]
    pub fn price(&self, ground: &Ground, weights: &Weights, ways: &mut Ways) -> f64 {
        let mut walk = Walk::new(ground, self.terms);
        while let Some((cell, route)) = choose(&walk.view(), ways, weights, 0, |_| ()) {
            walk.enter(ground, cell, &route);
        }
        walk.go_home(ground, ways);
        let cells = ground.reachable as f64;
        match self.terms.objective {
            Objective::Cover => walk.cost() / cells,
            Objective::Find => walk.known_after as f64 / (ground.reachable + ground.touchable) as f64 / cells,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::search::costs::Costs;

    fn task(objective: Objective) -> Task {
        let terms = Terms { objective, sonar_cells: 0, costs: Costs::EVEN };
        Task { sides: (10, 14), ..Task::usual(terms, 3) }
    }

    /// A short tuning on the smallest possible halls. The result must be better on halls that were not used for
    /// tuning, and the same every time.
    #[test]
    fn tuning_finds_better_weights_and_the_same_ones_again() {
        for objective in Objective::ALL {
            let task = task(objective);
            let tuned = || {
                let linear = cross_entropy(&task, &task.first_weights(), 4, |_, _| ());
                let mut lessons = Lessons::new(&task, &linear, 30);
                let round = Round { number: 0, halls: 60, horizon: 100.0, tried: 0.3, ridge: 3000.0, taken: 0.9 };
                lessons.learn(&linear, &round).weights
            };
            let weights = tuned();
            let price = |weights: &Weights| {
                let grounds = (0..40).map(|n| task.ground("test", n));
                grounds.map(|ground| task.price(&ground, weights, &mut Ways::default())).sum::<f64>() / 40.0
            };
            let (before, after) = (price(&task.first_weights()), price(&weights));
            assert!(after < before, "{}: {after} after tuning, {before} before", objective.name());
            assert_eq!(tuned(), weights);
        }
    }
}
