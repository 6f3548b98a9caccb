//! One search of one hall, and its measurements.

use std::time::Duration;

use hallsweep_core::command::Strategy;
use hallsweep_core::search::scored::choose;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::weights::Weights;
use hallsweep_core::search::{NextGoal, Search, View};
use hallsweep_core::units::Cell;
use hallsweep_sim::Truth;
use hallsweep_sim::headless::Moves;

use crate::Ground;
use crate::walk::{Walk, cost};
use hallsweep_core::search::Terms;

#[derive(Clone, Debug, PartialEq)]
pub enum Entrant {
    Strategy(Strategy),
    /// The score with weights from a file, instead of the weights that are built in.
    Weights {
        name: String,
        weights: Box<Weights>,
    },
}

impl Entrant {
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Entrant::Strategy(strategy) => strategy.name(),
            Entrant::Weights { name, .. } => name,
        }
    }

    fn heeds_news(&self) -> bool {
        match self {
            Entrant::Strategy(strategy) => strategy.heeds_news(),
            Entrant::Weights { .. } => true,
        }
    }

    fn begin(&self) -> Decider<'_> {
        match self {
            Entrant::Strategy(strategy) => Decider::Search(strategy.begin()),
            Entrant::Weights { weights, .. } => Decider::Score(weights),
        }
    }
}

enum Decider<'a> {
    Search(Search),
    Score(&'a Weights),
}

impl Decider<'_> {
    fn next(&mut self, view: &View<'_>, ways: &mut Ways) -> NextGoal {
        match self {
            Decider::Search(search) => search.next(view, ways),
            Decider::Score(weights) => {
                choose(view, ways, weights, 0, |_| ()).map_or(NextGoal::Finished, |(cell, route)| NextGoal::Visit(cell, route))
            }
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timings {
    pub step_s: f64,
    /// Duration of a quarter turn.
    pub turn_s: f64,
    /// Duration of a step that meets an obstacle, including the way back.
    pub bump_s: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Number of cells that can be reached, home included.
    pub cells: usize,
    /// Number of free cells, reachable or not.
    pub free_cells: usize,
    pub moves: Moves,
    /// Cost of all moves per reachable cell, in steps.
    pub moves_per_cell: f64,
    /// The number of moves before a cell of luggage was found, per reachable cell. It is a mean over all found cells.
    /// `None` if no luggage was found.
    pub to_a_piece: Option<f64>,
    /// The number of steps, divided by a lower bound. Cells are coloured like a chessboard. The bound is twice the
    /// number of cells of the more frequent colour.
    pub steps_over_bound: f64,
    /// Duration of all moves, in seconds. Photos and answers of the operator are not included.
    pub seconds: f64,
    /// Whether every cell was visited, all luggage was found, and the robot is at home again.
    pub complete: bool,
    pub decisions_ns: Vec<u32>,
}

/// Runs one search of a hall. `clock` measures how long decisions take, and has no effect on the moves.
#[expect(clippy::cast_precision_loss, reason = "no search makes 2^53 moves")]
pub fn trial(
    ground: &Ground,
    terms: Terms,
    timings: Timings,
    entrant: &Entrant,
    ways: &mut Ways,
    clock: &impl Fn() -> Duration,
) -> Trial {
    let (mut walk, mut decider) = (Walk::new(ground, terms), entrant.begin());
    walk.heeds_news = entrant.heeds_news();
    let mut decisions_ns = Vec::new();
    loop {
        let before = clock();
        let goal = decider.next(&walk.view(), ways);
        decisions_ns.push(u32::try_from((clock() - before).as_nanos()).unwrap_or(u32::MAX));
        if !walk.follow(ground, ways, goal) {
            break;
        }
    }
    let (moves, cells) = (walk.moves, ground.reachable as f64);
    Trial {
        cells: ground.reachable,
        free_cells: ground.free,
        moves,
        moves_per_cell: cost(moves, terms.costs) / cells,
        to_a_piece: (walk.found > 0).then(|| walk.found_after as f64 / walk.found as f64 / cells),
        steps_over_bound: moves.steps as f64 / bound(ground).max(1.0),
        seconds: moves.steps as f64 * timings.step_s + moves.turns as f64 * timings.turn_s + moves.bumps as f64 * timings.bump_s,
        complete: (walk.visited, walk.found) == (ground.reachable, ground.touchable) && walk.pose.cell == Cell::HOME,
        decisions_ns,
    }
}

/// A lower bound for the number of steps of a closed tour over all reachable cells. If cells are coloured like a
/// chessboard, every step changes the colour. So a tour has at least two steps for each cell of the more frequent
/// colour.
#[expect(clippy::cast_precision_loss, reason = "a hall has fewer cells than 2^53")]
fn bound(ground: &Ground) -> f64 {
    let cells = ground.cells().into_iter().filter(|cell| ground.at(*cell) == Truth::Free);
    let dark = cells.filter(|cell| (cell.x + cell.y).rem_euclid(2) == 0).count();
    2.0 * dark.max(ground.reachable - dark) as f64
}

#[must_use]
pub fn tour(ground: &Ground, terms: Terms, entrant: &Entrant, ways: &mut Ways) -> Vec<Cell> {
    let (mut walk, mut decider) = (Walk::new(ground, terms), entrant.begin());
    walk.heeds_news = entrant.heeds_news();
    walk.trail = Some(vec![walk.pose.cell]);
    loop {
        let goal = decider.next(&walk.view(), ways);
        if !walk.follow(ground, ways, goal) {
            return walk.trail.unwrap_or_default();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use hallsweep_core::search::Objective;
    use hallsweep_core::search::costs::Costs;
    use hallsweep_sim::Hall;

    const TERMS: Terms = Terms { objective: Objective::Cover, sonar_cells: 0, costs: Costs::EVEN };

    fn ground(rows: &[&str]) -> Ground {
        Ground::of(&Hall::from_rows("drawn", rows).expect("a valid drawing"))
    }

    fn run(ground: &Ground) -> Trial {
        let timings = Timings { step_s: 1.0, turn_s: 1.0, bump_s: 1.0 };
        trial(ground, TERMS, timings, &Entrant::Strategy(Strategy::Frontier), &mut Ways::default(), &|| Duration::ZERO)
    }

    #[test]
    fn a_trial_is_measured_by_hand() {
        // South is a wall and east is the bag, and the robot is already at home. So there is nothing to decide.
        let trial = run(&ground(&["ST", "##"]));
        assert_eq!((trial.cells, trial.complete), (1, true));
        assert_eq!((trial.moves.steps, trial.moves.turns > 0, trial.moves.bumps), (0, true, 4));
        assert_eq!(trial.moves_per_cell, trial.seconds);
        let corridor = run(&ground(&["S..T"]));
        assert_eq!((corridor.moves.steps, corridor.steps_over_bound), (4, 1.0), "there and back, and no tour does with less");
        assert!(corridor.to_a_piece.is_some_and(|moves| moves > 1.0));
    }

    #[test]
    fn a_tour_is_the_way_from_home_to_home_step_by_step() {
        let ground = ground(&["S..", ".T.", "..."]);
        let way = tour(&ground, TERMS, &Entrant::Strategy(Strategy::Columns), &mut Ways::default());
        assert_eq!((way.first(), way.last()), (Some(&Cell::HOME), Some(&Cell::HOME)));
        assert!(way.windows(2).all(|step| step[0].neighbours().contains(&step[1])));
        assert_eq!(way.iter().collect::<std::collections::BTreeSet<_>>().len(), 8);
    }
}
