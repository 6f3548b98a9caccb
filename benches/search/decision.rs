//! Decisions during the search of a whole hall, beside the nearest unknown cell that `pathfinding` finds with
//! Dijkstra from the same views.

use std::time::Duration;

use hallsweep_core::command::Strategy;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::{Objective, Terms};
use hallsweep_evaluation::Ground;
use hallsweep_evaluation::family::{Family, hall};
use hallsweep_evaluation::walk::Walk;

use crate::cpu::{Times, micros, ratio, timed};
use crate::{goals, rivals};

const SIDE: usize = 400;

/// The rival also decides on one in this many views.
const SAMPLED: usize = 50;

/// Largest ratio of `frontier`'s mean to the rival's, which searches for nearly the same. `score` has no goal,
/// because it weighs every near entry and takes longer.
const MEAN: f64 = 1.0;

pub(crate) fn run() {
    println!("decisions in a hall of {SIDE} a side, 10 % luggage, one of {SAMPLED} shown to pathfinding, µs");
    println!("                                 mean        p99      worst   mean, of Dijkstra's");
    let ground = Ground::of(&hall(Family::Luggage(0.1), SIDE, SIDE, &mut RandomStream::new(1, "decision")));
    for (strategy, objective) in [
        (Strategy::Auto, Objective::Find),
        (Strategy::Auto, Objective::Cover),
        (Strategy::Scored, Objective::Cover),
        (Strategy::Frontier, Objective::Cover),
    ] {
        let ratio = beside(&ground, strategy, Terms { objective, sonar_cells: 0, costs: Costs::EVEN });
        if strategy == Strategy::Frontier {
            goals::at_most("decisions of frontier against Dijkstra's, mean", ratio, MEAN);
        }
    }
}

/// Mean decision time of a strategy, as a ratio to the rival's.
fn beside(ground: &Ground, strategy: Strategy, terms: Terms) -> f64 {
    let (mut walk, mut search, mut ways) = (Walk::new(ground, terms), strategy.begin(), Ways::default());
    let (mut ours, mut theirs) = (Times::default(), Times::default());
    let (mut slowest, mut beside_slowest) = (Duration::ZERO, Duration::ZERO);
    for n in 0.. {
        let (time, goal) = timed(|| search.next(&walk.view(), &mut ways));
        let is_sampled = n % SAMPLED == 0;
        if is_sampled || time > slowest {
            let (rival, _) = timed(|| rivals::nearest(&walk.grid, terms.costs, walk.pose));
            if is_sampled {
                ours.add(time);
                theirs.add(rival);
            }
            if time > slowest {
                (slowest, beside_slowest) = (time, rival);
            }
        }
        if !walk.follow(ground, &mut ways, goal) {
            break;
        }
    }
    let said = format!("{} to {}", strategy.name(), terms.objective.name());
    for (name, times) in [(said.as_str(), &ours), ("  pathfinding", &theirs)] {
        let [mean, p99, worst] = [times.mean(), times.within(99), times.worst()].map(micros);
        println!("  {name:<24} {mean:>10.2} {p99:>10.1} {worst:>10.1}   {:>5.2}", ratio(times.mean(), theirs.mean()));
    }
    println!("    the slowest of all took {slowest:.2?}, pathfinding from that view {beside_slowest:.2?}");
    ratio(ours.mean(), theirs.mean())
}
