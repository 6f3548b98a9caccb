//! Ways between two visited cells, beside A* of `pathfinding` over the same states.

use hallsweep_core::command::Move;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::costs::{Costs, STEP};
use hallsweep_core::search::grid::{Grid, Square};
use hallsweep_core::search::ways::Ways;
use hallsweep_core::units::{Cell, Heading, Pose};
use hallsweep_evaluation::Ground;
use hallsweep_evaluation::family::{Family, hall};
use hallsweep_sim::Truth;

use crate::cpu::{Times, micros, ratio, timed};
use crate::{goals, rivals};

/// Sides of the halls, and the number of ways searched in each.
const HALLS: [(usize, usize); 3] = [(100, 2000), (400, 300), (1000, 60)];

/// Side of the hall that has fewer states than the limit after which a search ignores turns.
const ALWAYS_EXACT: usize = 100;

/// Largest ratio of the mean time to that of A*.
const MEAN: f64 = 0.4;

const COSTS: Costs = Costs::EVEN;

pub(crate) fn run() {
    println!("ways over visited cells, 20 % obstacles, over cell and heading, µs");
    println!("  side   ways              p50       mean      worst   mean, of A*");
    for (side, count) in HALLS {
        beside(side, count);
    }
}

fn beside(side: usize, count: usize) {
    let mut dice = RandomStream::new(1, "replan");
    let ground = Ground::of(&hall(Family::Luggage(0.2), side, side, &mut dice));
    let (grid, free) = known(&ground);
    let mut ways = Ways::default();
    let (mut ours, mut theirs, mut dearer) = (Times::default(), Times::default(), Vec::new());
    for _ in 0..count {
        let [from, goal] = [(); 2].map(|()| free[below(free.len(), &mut dice)]);
        let start = Pose { cell: from, heading: Heading::ALL[below(4, &mut dice)] };
        let (time, way) = timed(|| ways.way_over_visited(&grid, COSTS, start, goal));
        ours.add(time);
        let (time, least) = timed(|| rivals::way(&grid, COSTS, start, goal));
        theirs.add(time);
        let way = way.expect("every visited cell can be reached from every other");
        dearer.extend(excess(&grid, start, goal, &way, least.expect("there is a way, as was just seen")));
    }
    assert!(side > ALWAYS_EXACT || dearer.is_empty(), "a way was not the cheapest");
    for (name, times) in [("hallsweep", &ours), ("pathfinding", &theirs)] {
        let [p50, mean, worst] = [times.within(50), times.mean(), times.worst()].map(micros);
        print!("  {side:>4}  {count:>5}  {name:<11} {p50:>10.1} {mean:>10.1} {worst:>10.1}");
        println!("   {:>5.2}", ratio(times.mean(), theirs.mean()));
    }
    if !dearer.is_empty() {
        let more = dearer.iter().sum::<f64>() / dearer.len() as f64 * 100.0;
        println!(
            "        {} of them, which lead far, have no step too many but turn more often: {more:.1} % dearer",
            dearer.len()
        );
    }
    goals::at_most(&format!("ways in a hall of {side} a side against A*, mean"), ratio(ours.mean(), theirs.mean()), MEAN);
}

/// Relative excess of a way's cost over the cheapest; `None` when they are equal. A more expensive way must still
/// reach the goal with the fewest possible steps.
fn excess(grid: &Grid, start: Pose, goal: Cell, way: &[Move], least: u32) -> Option<f64> {
    let steps = way.iter().filter(|step| **step == Move::Forward).count();
    let cost =
        u32::try_from(steps).unwrap_or(u32::MAX) * STEP + u32::try_from(way.len() - steps).unwrap_or(u32::MAX) * COSTS.turn;
    assert!(cost >= least, "no way is cheaper than the cheapest");
    if cost == least {
        return None;
    }
    assert_eq!(Some(steps), rivals::steps(grid, start.cell, goal), "a far way takes as few steps as there are");
    Some(f64::from(cost) / f64::from(least) - 1.0)
}

/// Grid of a hall with every reachable cell known, and the visited cells.
fn known(ground: &Ground) -> (Grid, Vec<Cell>) {
    let mut grid = Grid::with_room_for(ground.bounds());
    let (free, luggage): (Vec<Cell>, Vec<Cell>) = ground.cells().into_iter().partition(|cell| ground.at(*cell) == Truth::Free);
    for (cells, square) in [(&free, Square::Visited), (&luggage, Square::Luggage)] {
        cells.iter().for_each(|cell| grid.set(*cell, square));
    }
    (grid, free)
}

fn below(bound: usize, dice: &mut RandomStream) -> usize {
    usize::try_from(dice.below(bound as u64)).expect("it is below a number of this type")
}
