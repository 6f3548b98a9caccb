//! The explorer in a thousand random halls: each search is complete and ends at home, and the map never contradicts
//! the truth.

use hallsweep_core::command::Strategy;
use hallsweep_core::search::Objective;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::settings::Settings;
use hallsweep_core::units::Cell;
use hallsweep_core::world::hall_map::Mark;
use hallsweep_sim::headless::{Figures, Verdicts, explore};
use hallsweep_sim::{Camera, Hall, SimSettings, Truth};

use crate::halls;

/// Whether every cell of the map agrees with the hall.
pub(crate) fn map_is_true(figures: &Figures, hall: &Hall) {
    let bounds = figures.state.map.known_bounds();
    for y in bounds.least.y..=bounds.most.y {
        for x in bounds.least.x..=bounds.most.x {
            let cell = Cell::new(x, y);
            let truth = hall.truth(cell);
            let right = match figures.state.map.at(cell) {
                Mark::Unknown => true,
                Mark::Seen | Mark::Visited => truth == Truth::Free,
                Mark::Wall => truth == Truth::Wall,
                Mark::Luggage | Mark::NotInspected => matches!(truth, Truth::Luggage(_)),
            };
            assert!(
                right,
                "{}: the map is wrong at {cell}: {:?}, but there is {truth:?}",
                figures.hall,
                figures.state.map.at(cell)
            );
        }
    }
}

/// Settings of a search; the seeds take turns through every strategy, goal and sensing.
pub(crate) fn in_turn(seed: u64, settings: Settings) -> (SimSettings, Settings, Strategy) {
    let pick = |n: u64, of: usize| usize::try_from(n).unwrap() % of;
    let strategy = Strategy::ALL[pick(seed, Strategy::ALL.len())];
    let turn = seed / Strategy::ALL.len() as u64;
    let sonar_cells = [0, 1, 0, 3][pick(turn, 4)];
    let objective = Objective::ALL[pick(turn / 4, 2)];
    let costs = [None, Costs::weighed(1.0, 1.0, 1.0), Costs::weighed(1.0, 0.0, 0.0)][pick(turn / 8, 3)];
    let sim = SimSettings { sonar_cells, ..SimSettings::new(seed, Camera::Stub) };
    (sim, Settings { sonar_cells, objective, costs, ..settings }, strategy)
}

fn run(seed: u64, most: u64, settings: Settings) -> Figures {
    let hall = halls::random(seed, most);
    let (sim, settings, strategy) = in_turn(seed, settings);
    let figures = explore(&hall, sim, settings, strategy, Verdicts::AllSafe, |_| {});
    let of = format!("hall {seed} by {}, sonar {}", strategy.name(), settings.sonar_cells);
    assert_eq!(figures.stuck, None, "{of}");
    assert!(figures.complete && figures.home, "{of}: complete {}, home {}", figures.complete, figures.home);
    map_is_true(&figures, &hall);
    figures
}

/// Minimum variety of the thousand halls, so that nobody makes them easier by accident.
#[test]
fn the_random_halls_are_as_various_as_they_should_be() {
    let halls: Vec<_> = (0..1000).map(|seed| halls::random(seed, 30)).collect();
    let count = |what: &dyn Fn(&Hall) -> bool| halls.iter().filter(|hall| what(hall)).count();
    assert!(count(&|hall| hall.reachable().len() > 200) > 300);
    assert!(count(&|hall| hall.reachable().iter().any(|cell| cell.x < 0 || cell.y < 0)) > 300);
    assert!(count(&|hall| hall.pieces().iter().any(|bag| bag.cells.len() > 1)) > 300);
    assert!(count(&|hall| hall.pieces().len() > 40) > 200);
    assert!(count(&|hall| free(hall) > hall.reachable().len()) > 300, "islands");
}

fn free(hall: &Hall) -> usize {
    let bounds = hall.bounds();
    let cells = (bounds.least.y..=bounds.most.y).flat_map(|y| (bounds.least.x..=bounds.most.x).map(move |x| Cell::new(x, y)));
    cells.filter(|cell| hall.truth(*cell) == Truth::Free).count()
}

#[test]
fn a_thousand_random_halls_are_searched_completely_and_the_robot_comes_home() {
    let workers: Vec<_> = (0..2)
        .map(|part| std::thread::spawn(move || (part..1000).step_by(2).for_each(|seed| drop(run(seed, 30, Settings::default())))))
        .collect();
    for worker in workers {
        worker.join().expect("a hall failed; its seed is printed above");
    }
}

#[test]
fn halls_are_completed_under_the_strict_rule_too() {
    let strict = Settings { wall_lines: false, ..Settings::default() };
    (2000..2050).for_each(|seed| drop(run(seed, 20, strict)));
}
