//! Measures how often a forecast of the remaining search time is correct. The forecast is checked throughout each
//! search, and each check is weighted by its duration. The bounds of the forecast were derived from other random
//! halls.

use hallsweep_core::command::Strategy;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::forecast::{FEW, Forecast, forecast};
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::{NextGoal, Objective, Terms};

use crate::compare::{Halls, Kind};
use crate::family::Family;
use crate::walk::Walk;
use crate::{Ground, parallel};

/// The searches that are made in each hall: strategy, goal, range of the sonar in cells.
const SEARCHES: [(Strategy, Objective, u8); 7] = [
    (Strategy::Auto, Objective::Find, 0),
    (Strategy::Auto, Objective::Find, 1),
    (Strategy::Auto, Objective::Cover, 0),
    (Strategy::Auto, Objective::Cover, 1),
    (Strategy::Frontier, Objective::Cover, 0),
    (Strategy::Columns, Objective::Cover, 0),
    (Strategy::Spiral, Objective::Cover, 0),
];

/// The sizes of the halls, in columns and rows.
const SIDES: [(usize, usize); 4] = [(12, 9), (20, 20), (40, 25), (50, 50)];

/// How often forecasts were correct, as shares of the search time.
#[derive(Clone, Copy, Debug, Default)]
pub struct Held {
    /// Share of the time in which an upper bound was given.
    pub with_most: f64,
    /// Of the time with an upper bound, the share in which the remaining time was within the bounds. `None` if no
    /// upper bound was given.
    pub within: Option<f64>,
    /// Of the time with only a lower bound, the share in which the remaining time was not below it. `None` if there
    /// was no time with only a lower bound.
    pub at_least: Option<f64>,
}

/// Sums of search time by kind of forecast. The duration of each search is scaled to 1, so that all searches have the
/// same weight.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    all: f64,
    with_most: f64,
    within: f64,
    with_least: f64,
    at_least: f64,
}

/// Measures how often forecasts are correct in halls of one family. There are `count` halls of each size.
#[must_use]
pub fn held(family: Family, count: usize, seed: u64) -> Held {
    let halls = SIDES.map(|(columns, lines)| Halls::Random { kind: Kind { family, columns, lines }, count, seed });
    let sums = parallel::each(halls.len() * count, |n, ways| {
        let ground = Ground::of(&halls[n / count].hall(n % count));
        SEARCHES.map(|(strategy, objective, sonar_cells)| search(&ground, strategy, objective, sonar_cells, ways))
    });
    let Sums { all, with_most, within, with_least, at_least } = sums.into_iter().flatten().fold(Sums::default(), Sums::and);
    let share = |part: f64, whole: f64| (whole > 0.0).then(|| part / whole);
    Held { with_most: with_most / all, within: share(within, with_most), at_least: share(at_least, with_least) }
}

/// Makes a whole search with the costs of the simulated robot, whose turn takes 1.5 times as long as a step.
fn search(ground: &Ground, strategy: Strategy, objective: Objective, sonar_cells: u8, ways: &mut Ways) -> Sums {
    let costs = Costs::weighed(1.0, 1.5, 1.0).expect("these are costs");
    let mut walk = Walk::new(ground, Terms { objective, sonar_cells, costs });
    walk.heeds_news = strategy.heeds_news();
    let (mut search, mut said) = (strategy.begin(), Vec::new());
    loop {
        let goal = search.next(&walk.view(), ways);
        said.push((walk.cost(), if goal == NextGoal::Finished { None } else { now(&walk, strategy) }));
        if !walk.follow(ground, ways, goal) {
            break;
        }
    }
    let end = walk.cost();
    let until = said.iter().skip(1).map(|(at, _)| *at).chain([end]);
    let moments = said.iter().zip(until).map(|((at, said), until)| (*at, *said, (until - at) / end));
    moments.map(|(at, said, lasts)| Sums::of(said, end - at, lasts)).fold(Sums::default(), Sums::and)
}

fn now(walk: &Walk, strategy: Strategy) -> Option<Forecast> {
    let cells = walk.grid.census().looked_at();
    if cells < FEW {
        return None;
    }
    forecast(&walk.grid, strategy, walk.pose.cell, walk.cost() / f64::from(cells), 0)
}

impl Sums {
    fn of(said: Option<Forecast>, left: f64, lasts: f64) -> Sums {
        let all = Sums { all: lasts, ..Sums::default() };
        let when = |so: bool| if so { lasts } else { 0.0 };
        match said {
            None => all,
            Some(Forecast { least, most: None }) => Sums { with_least: lasts, at_least: when(left >= least), ..all },
            Some(Forecast { least, most: Some(most) }) => {
                Sums { with_most: lasts, within: when((least..=most).contains(&left)), ..all }
            }
        }
    }

    fn and(self, other: Sums) -> Sums {
        Sums {
            all: self.all + other.all,
            with_most: self.with_most + other.with_most,
            within: self.within + other.within,
            with_least: self.with_least + other.with_least,
            at_least: self.at_least + other.at_least,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// These shares are stated in docs/search.md and on the console.
    #[test]
    fn a_forecast_holds_as_often_as_it_is_said_to() {
        let all = Family::ALL.map(|family| held(family, 3, 77));
        for (family, held) in Family::ALL.into_iter().zip(all) {
            // With few halls, the shares of corridors and mazes vary a lot.
            let least = if matches!(family, Family::Corridors | Family::Maze) { 0.6 } else { 0.9 };
            let is_held = |share: Option<f64>| share.is_none_or(|share| share >= least);
            assert!(is_held(held.within) && is_held(held.at_least), "{family}: {held:?}");
        }
    }
}
