//! Large foreign maps searched completely by `auto`, for either goal.

use hallsweep_core::command::Strategy;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::{Objective, Terms};

use crate::cpu::micros;
use crate::explored::{Explored, HEADING};
use crate::foreign::{MAPS, ground};
use crate::goals;

/// Slowest decision of all in milliseconds: the goal, and the first measured value. That value is from a maze of half
/// a million cells whose nearest unknown cell was at the opposite end.
const WORST: f64 = 10.0;
const BEFORE: f64 = 16.0;

pub(crate) fn run() {
    println!("foreign maps, by auto");
    println!("  map   type           side  goal  {HEADING}");
    let mut worst = 0.0_f64;
    for (name, kind, side) in MAPS {
        let ground = ground(name, kind, side);
        for objective in Objective::ALL {
            let explored = Explored::of(&ground, Terms { objective, sonar_cells: 0, costs: Costs::EVEN }, Strategy::Auto);
            println!("  {name:<5} {kind:<13} {side:>5}  {:<5} {}", objective.name(), explored.line());
            worst = worst.max(micros(explored.decisions.worst()));
        }
    }
    goals::known("the slowest decision in a foreign map, ms", worst / 1000.0, WORST, BEFORE);
}
