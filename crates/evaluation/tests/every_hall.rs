//! Searches with any hall, strategy, goal, sensing and costs: nothing that can be reached is left out, and the robot
//! comes home. By bare walks, which are quick, and now and then by a whole mission. A failure prints the number of its
//! hall. `HALLSWEEP_HALLS=10000` sets the number of halls.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use hallsweep_core::command::Strategy;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::{Objective, Terms};
use hallsweep_core::settings::Settings;
use hallsweep_core::units::Cell;
use hallsweep_evaluation::Ground;
use hallsweep_evaluation::family::{Family, hall};
use hallsweep_evaluation::walk::Walk;
use hallsweep_sim::headless::{Verdicts, explore};
use hallsweep_sim::{Camera, Hall, SimSettings};

/// Number of halls by default.
const HALLS: u64 = 180;

/// One hall of this many is searched by a mission too, in one of the ways; no multiple of the number of families, so
/// that each has its turn.
const MISSION: u64 = 20;

const SONARS: [u8; 3] = [0, 1, 3];

/// Costs of a turn: even costs, those of the simulated robot, and steps alone.
const TURNS: [f64; 3] = [1.0, 1.5, 0.0];

/// In turn one hall of each family, 5 to 40 cells a side.
fn drawn(n: u64) -> Hall {
    let mut dice = RandomStream::new(n, "every hall");
    let family = Family::ALL[place(n, Family::ALL.len())];
    let [columns, lines] = [(); 2].map(|()| 5 + place(dice.number(), 36));
    hall(family, columns, lines, &mut dice)
}

fn place(n: u64, of: usize) -> usize {
    usize::try_from(n % of as u64).expect("it is below a usize")
}

/// Every way to search: strategy and terms.
fn ways_to_search(n: u64) -> Vec<(Strategy, Terms)> {
    let costs =
        Costs::weighed(1.0, TURNS[place(n / Family::ALL.len() as u64, TURNS.len())], 1.0).expect("costs that can be weighed");
    let goals = || Objective::ALL.into_iter().flat_map(|objective| SONARS.map(|sonar_cells| (objective, sonar_cells)));
    let of = |strategy| goals().map(move |(objective, sonar_cells)| (strategy, Terms { objective, sonar_cells, costs }));
    Strategy::ALL.into_iter().flat_map(of).collect()
}

fn walk(n: u64, ways: &mut Ways) {
    let ground = Ground::of(&drawn(n));
    for (strategy, terms) in ways_to_search(n) {
        let mut walk = Walk::new(&ground, terms);
        walk.finish(&ground, ways, strategy.begin());
        let of = format!("hall {n} by {}, {terms:?}", strategy.name());
        assert_eq!((walk.visited, walk.found), (ground.reachable, ground.touchable), "{of}: something was left out");
        assert_eq!(walk.pose.cell, Cell::HOME, "{of}: not home");
    }
}

fn mission(n: u64) {
    let hall = Arc::new(drawn(n));
    let all = ways_to_search(n);
    let (strategy, Terms { objective, sonar_cells, costs }) = all[place(RandomStream::new(n, "mission").number(), all.len())];
    let sim = SimSettings { sonar_cells, ..SimSettings::new(n, Camera::Stub) };
    let settings = Settings { objective, sonar_cells, costs: Some(costs), ..Settings::default() };
    let figures = explore(&hall, sim, settings, strategy, Verdicts::AllSafe, |_| {});
    let of = format!("hall {n} by {}, {settings:?}", strategy.name());
    assert_eq!(figures.stuck, None, "{of}");
    assert!(figures.complete && figures.home, "{of}: complete {}, home {}", figures.complete, figures.home);
}

#[test]
fn every_strategy_searches_every_hall_completely_and_comes_home() {
    let asked = std::env::var("HALLSWEEP_HALLS").ok();
    let halls = asked.map_or(HALLS, |number| number.parse().expect("HALLSWEEP_HALLS is a number"));
    let next = AtomicU64::new(0);
    let worker = || {
        let mut ways = Ways::default();
        loop {
            let n = next.fetch_add(1, Ordering::Relaxed);
            if n >= halls {
                return;
            }
            walk(n, &mut ways);
            if n.is_multiple_of(MISSION) {
                mission(n);
            }
        }
    };
    std::thread::scope(|scope| {
        for worker in [scope.spawn(worker), scope.spawn(worker)] {
            worker.join().expect("a hall failed; which one is printed above");
        }
    });
    eprintln!("{halls} halls, {} walks and {} missions", halls * ways_to_search(0).len() as u64, halls.div_ceil(MISSION));
}
