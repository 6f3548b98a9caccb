//! Cost of a move in halls from fifty to a thousand cells a side with 10 % luggage, and the memory of the largest
//! hall.

use hallsweep_core::command::Strategy;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::grid::Square;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::{Objective, Terms};
use hallsweep_core::units::Cell;
use hallsweep_evaluation::Ground;
use hallsweep_evaluation::drawing::{Curve, curves};
use hallsweep_evaluation::family::{Family, hall};
use hallsweep_evaluation::walk::Walk;

use crate::cpu::micros;
use crate::explored::{Explored, HEADING};
use crate::goals;

const SIDES: [usize; 6] = [50, 100, 200, 400, 800, 1000];

/// Approximate number of cells of all halls of one side together, so that small halls are measured as long as large
/// ones.
const CELLS: usize = 1_000_000;

/// Goals: bytes per cell; slowest and mean decision in the largest hall, in microseconds; ratio of the cost of a move
/// at 800 cells a side to that at 100.
const BYTES: f64 = 64.0;
const WORST: f64 = 10_000.0;
const MEAN: f64 = 1000.0;
const GROWTH: f64 = 1.5;

const TERMS: Terms = Terms { objective: Objective::Cover, sonar_cells: 0, costs: Costs::EVEN };

pub(crate) fn run(plot: Option<&str>) {
    memory();
    println!("halls of every size, 10 % luggage, by auto to cover");
    println!("  side {HEADING}");
    let measured: Vec<(usize, Explored)> = SIDES.iter().map(|side| (*side, of_side(*side))).collect();
    let a_move = |side: usize| measured.iter().find(|(of, _)| *of == side).map_or(f64::NAN, |(_, hall)| hall.micros_a_move());
    goals::at_most("a move with 800 cells a side against 100", a_move(800) / a_move(100), GROWTH);
    if let Some((side, largest)) = measured.last() {
        let [mean, worst] = [largest.decisions.mean(), largest.decisions.worst()].map(micros);
        goals::at_most(&format!("the slowest decision with {side} cells a side, µs"), worst, WORST);
        goals::at_most(&format!("the mean decision with {side} cells a side, µs"), mean, MEAN);
    }
    if let Some(file) = plot {
        match std::fs::write(file, picture(&measured)) {
            Ok(()) => println!("  drawn: {file}"),
            Err(error) => goals::left_out(file, true, &error.to_string()),
        }
    }
}

/// Searches enough halls of one side for a reliable time.
fn of_side(side: usize) -> Explored {
    let count = (CELLS / (side * side)).clamp(1, 40);
    let halls = (0..count).map(|n| hall(Family::Luggage(0.1), side, side, &mut RandomStream::new(n as u64, "growth")));
    let explored = halls.map(|hall| Explored::of(&Ground::of(&hall), TERMS, Strategy::Auto)).reduce(Explored::and);
    let explored = explored.expect("there is a hall at least");
    println!("  {side:>4} {}", explored.line());
    explored
}

/// Memory per cell of the grid and the ways in the largest hall, after a complete search. The system reports pages,
/// in kB.
fn memory() {
    let Some(side) = SIDES.last().copied() else { return };
    let ground = Ground::of(&hall(Family::Luggage(0.1), side, side, &mut RandomStream::new(1, "memory")));
    let Some(before) = resident_kb() else {
        return goals::left_out("memory", false, "this system has no /proc");
    };
    let (mut walk, mut ways) = (Walk::new(&ground, TERMS), Ways::default());
    walk.finish(&ground, &mut ways, Strategy::Auto.begin());
    // A way from end to end needs the most memory.
    let end = ground.cells().into_iter().rev().find(|cell| walk.grid.at(*cell) == Square::Visited);
    let way = ways.way_over_visited(&walk.grid, TERMS.costs, walk.pose, end.unwrap_or(Cell::HOME));
    assert!(way.is_some(), "the robot was there and is home");
    let after = resident_kb().unwrap_or(before);
    let bytes = after.saturating_sub(before) as f64 * 1024.0 / (side * side) as f64;
    goals::at_most(&format!("bytes a cell of grid and ways, {side} cells a side"), bytes, BYTES);
}

fn resident_kb() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    status.lines().find_map(|line| line.strip_prefix("VmRSS:")?.split_whitespace().next()?.parse().ok())
}

fn picture(measured: &[(usize, Explored)]) -> String {
    let curve = |name: &str, of: &dyn Fn(&Explored) -> f64| Curve {
        name: name.to_owned(),
        points: measured.iter().map(|(side, explored)| (*side as f64, of(explored))).collect(),
    };
    let drawn = [
        curve("a move, all told", &Explored::micros_a_move),
        curve("a decision, mean", &|explored| micros(explored.decisions.mean())),
    ];
    curves("What the search costs in halls of every size, 10 % luggage", ["cells a side", "µs"], &drawn)
}
