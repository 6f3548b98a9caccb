//! Measures how much sooner a search finds the bomb when it knows where the bomb probably is. Each random hall has
//! random areas, and is searched once with its areas and once without. The time to the bomb is not drawn but expected:
//! the mean over all cells that can be reached, weighted with the probability that the bomb is there.

use std::sync::Arc;

use hallsweep_core::command::Strategy;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::areas::AreaPlan;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::{Objective, Terms};
use hallsweep_core::units::{Bounds, Cell};
use hallsweep_core::world::areas::Area;
use hallsweep_core::world::coverage::Sensor;

use crate::compare::{Estimate, Halls, Kind};
use crate::family::below;
use crate::walk::Walk;
use crate::{Ground, parallel};

/// The comparisons of docs/search.md: halls, and range of the sonar in cells. 50×50 cells are as large as most halls of
/// that page. `islands` have rooms that cannot be entered.
pub const ROWS: [(&str, u8); 4] = [("luggage-10:50x50", 0), ("islands:50x50", 0), ("luggage-10:50x50", 3), ("islands:50x50", 3)];

#[derive(Clone, Copy, Debug)]
pub struct Gain {
    /// Mean expected cost until the bomb is found, in steps, without and with areas.
    pub to_bomb: [Estimate; 2],
    /// The mean with areas divided by the mean without.
    pub ratio: Estimate,
    /// The same ratio for the whole search.
    pub whole: Estimate,
}

/// Measures the gain in this number of halls. `None` if there are no halls.
#[must_use]
pub fn gain(kind: Kind, sonar_cells: u8, count: usize, seed: u64) -> Option<Gain> {
    let halls = Halls::Random { kind, count, seed };
    let terms = Terms { objective: Objective::Find, sonar_cells, costs: Costs::EVEN };
    let pairs = parallel::each(count, |n, ways| {
        let hall = halls.hall(n);
        let mut dice = RandomStream::new(seed.wrapping_mul(1_000_003).wrapping_add(n as u64), "areas");
        let areas = areas(hall.bounds(), &mut dice);
        let plan = AreaPlan::new(&areas, &[], |_| false, Sensor::default()).expect("at least one area is drawn");
        let (ground, plan) = (Ground::of(&hall), Arc::new(plan));
        [false, true].map(|is_known| search(&ground, &plan, is_known, terms, ways))
    });
    let of = |number: usize, is_known: usize| pairs.iter().map(move |pair| pair[is_known][number]);
    Some(Gain {
        to_bomb: [Estimate::of(of(0, 0))?, Estimate::of(of(0, 1))?],
        ratio: ratio(of(0, 0), of(0, 1))?,
        whole: ratio(of(1, 0), of(1, 1))?,
    })
}

/// The mean of the second numbers divided by the mean of the first. Its interval is linearised.
fn ratio(first: impl Iterator<Item = f64> + Clone, second: impl Iterator<Item = f64> + Clone) -> Option<Estimate> {
    let base = Estimate::of(first.clone())?.mean;
    let mean = Estimate::of(second.clone())?.mean / base;
    Estimate::of(first.zip(second).map(|(first, second)| mean + (second - mean * first) / base))
}

/// Searches a hall to the end. Returns the expected cost until the bomb is found, and the cost of the whole search.
fn search(ground: &Ground, plan: &Arc<AreaPlan>, is_known: bool, terms: Terms, ways: &mut Ways) -> [f64; 2] {
    let mut walk = Walk::new(ground, terms);
    (walk.areas, walk.known_at) = (is_known.then(|| Arc::clone(plan)), Some(Vec::new()));
    walk.finish(ground, ways, Strategy::Auto.begin());
    let (mut sum, mut weight) = (0.0, 0.0);
    for (cell, cost) in walk.known_at.iter().flatten() {
        let probability = plan.probability(*cell, ground.bounds().grown(-1));
        sum += probability * cost;
        weight += probability;
    }
    [sum / weight, walk.cost()]
}

/// Draws 4 to 12 areas, half of them rectangles and half of them quadrilaterals, each in a rectangle with sides of a
/// tenth to three tenths of the hall. Their weights are exponentially distributed, and the rest of the hall has up to
/// 40 % of the probability.
#[must_use]
pub fn areas(hall: Bounds, dice: &mut RandomStream) -> Vec<Area> {
    let (columns, lines) = (hall.width().unsigned_abs() as usize, hall.height().unsigned_abs() as usize);
    let (count, mut areas) = (4 + below(9, dice), Vec::new());
    // A small hall may have no room for so many areas.
    for n in 0..1000 {
        if areas.len() == count {
            break;
        }
        let [w, h] = [columns, lines].map(|side| side / 10 + below(side / 5 + 1, dice));
        let (x, y) = (below(columns - w, dice), below(lines - h, dice));
        let at = |dx: usize, dy: usize| {
            let [x, y] = [x + dx, y + dy].map(|n| i32::try_from(n).expect("a hall has few cells"));
            Cell::new(hall.least.x + x, hall.least.y + y)
        };
        let [north, east, south, west] = [w, h, w, h].map(|side| below(side + 1, dice));
        let is_rectangle = dice.happens(0.5);
        let corners =
            if is_rectangle { vec![at(0, 0), at(w, h)] } else { vec![at(north, 0), at(w, east), at(south, h), at(0, west)] };
        areas.push(Area { name: format!("area {n}").into(), probability: 0.0, corners: corners.into() });
        if Area::check(&areas, hall).is_err() {
            areas.pop();
        }
    }
    let weights: Vec<f64> = areas.iter().map(|_| -(1.0 - dice.fraction()).ln()).collect();
    let whole = weights.iter().sum::<f64>() / (1.0 - 0.4 * dice.fraction());
    areas.iter_mut().zip(weights).for_each(|(area, weight)| area.probability = weight / whole);
    areas
}
