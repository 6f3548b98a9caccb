//! The cross-entropy method for the linear part of the weights. Candidates are drawn around a mean. Mean and spread
//! then move towards the best candidates.

use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::tables::LINEAR;
use hallsweep_core::search::weights::Weights;

use super::Task;
use crate::{Ground, parallel};

const CANDIDATES: usize = 44;

/// Number of best candidates that determine the next generation.
const BEST: usize = 10;

/// Number of new halls per generation, in which every candidate is tested.
const HALLS: u64 = 24;

/// Initial and smallest spread of the candidates, in thousandths of a step.
const SPREAD: (f64, f64) = (700.0, 40.0);

/// How far mean and spread move towards the best candidates of a generation, 0–1.
const PACE: f64 = 0.7;

/// Returns better weights after this number of generations. `told` is called with the mean cost of each generation's
/// best candidates.
#[must_use]
#[expect(clippy::cast_possible_truncation, reason = "weights are small whole numbers")]
pub fn cross_entropy(task: &Task, start: &Weights, generations: u64, mut told: impl FnMut(u64, f64)) -> Weights {
    let mut mean = start.linear.map(f64::from);
    let mut spread = [SPREAD.0; LINEAR];
    let mut dice = RandomStream::new(task.seed, "cross-entropy");
    let weights = |linear: [f64; LINEAR]| Weights { linear: linear.map(|weight| weight as i32), ..start.clone() };
    for generation in 0..generations {
        let mut draw = || std::array::from_fn(|n| mean[n] + dice.normal(spread[n]));
        let drawn: Vec<[f64; LINEAR]> = (0..CANDIDATES).map(|n| if n == 0 { mean } else { draw() }).collect();
        let grounds: Vec<Ground> = (0..HALLS).map(|n| task.ground("cross-entropy", generation * HALLS + n)).collect();
        let prices = parallel::each(CANDIDATES, |n, ways| {
            let candidate = weights(drawn[n]);
            grounds.iter().map(|ground| task.price(ground, &candidate, ways)).sum::<f64>()
        });
        let mut order: Vec<usize> = (0..CANDIDATES).collect();
        order.sort_by(|a, b| prices[*a].total_cmp(&prices[*b]));
        let best = &order[..BEST];
        for n in 0..LINEAR {
            let of_best = |value: &dyn Fn(f64) -> f64| best.iter().map(|m| value(drawn[*m][n])).sum::<f64>() / BEST as f64;
            let middle = of_best(&|weight| weight);
            let deviation = of_best(&|weight| (weight - middle).powi(2)).sqrt();
            mean[n] += PACE * (middle - mean[n]);
            spread[n] = (spread[n] + PACE * (deviation - spread[n])).max(SPREAD.1);
        }
        told(generation, best.iter().map(|n| prices[*n]).sum::<f64>() / (BEST as f64 * HALLS as f64));
    }
    weights(mean)
}
