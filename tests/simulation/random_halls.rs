//! The explorer on a thousand random halls: all complete, all home, and the map equal to the truth wherever it says anything.

use hallsweep::core::explore::Strategy;
use hallsweep::core::settings::Settings;
use hallsweep::core::world::hall_map::Mark;
use hallsweep::headless::{Figures, Verdicts, explore};
use hallsweep::outbound::robot::sim::{Camera, Hall, SimSettings, Truth};

use crate::halls;

/// Every cell of the map says what is there.
pub(crate) fn map_is_true(figures: &Figures, hall: &Hall) {
    let bounds = figures.state.map.known_bounds();
    for y in bounds.least.y..=bounds.most.y {
        for x in bounds.least.x..=bounds.most.x {
            let cell = hallsweep::core::units::Cell::new(x, y);
            let truth = hall.truth(cell);
            let right = match figures.state.map.at(cell) {
                Mark::Unknown => true,
                Mark::Visited => truth == Truth::Free,
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

fn run(seed: u64, most: u64, settings: Settings) -> Figures {
    let hall = halls::random(seed, most);
    let figures = explore(&hall, SimSettings::new(seed, Camera::Stub), settings, Strategy::Snail, Verdicts::AllSafe, |_| {});
    assert_eq!(figures.stuck, None, "hall {seed}");
    assert!(figures.complete && figures.home, "hall {seed}: complete {}, home {}", figures.complete, figures.home);
    map_is_true(&figures, &hall);
    figures
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
