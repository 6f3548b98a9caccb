//! Searches of halls with areas: what is searched first, that nothing is left out but closed areas, and how much sooner
//! the bomb is found.

use std::collections::BTreeSet;
use std::sync::Arc;

use hallsweep_core::command::{Command, Strategy};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::search::areas::AreaPlan;
use hallsweep_core::search::costs::Costs;
use hallsweep_core::search::grid::Square;
use hallsweep_core::search::ways::Ways;
use hallsweep_core::search::{Objective, Terms};
use hallsweep_core::settings::Settings;
use hallsweep_core::state::Venue;
use hallsweep_core::units::{Cell, Now};
use hallsweep_core::world::areas::Area;
use hallsweep_core::world::coverage::{Sensor, SensorModel};
use hallsweep_evaluation::Ground;
use hallsweep_evaluation::areas::{areas, gain};
use hallsweep_evaluation::family::{Family, hall};
use hallsweep_evaluation::walk::Walk;
use hallsweep_sim::headless::Run;
use hallsweep_sim::{Camera, Hall, SimSettings, Truth};

fn terms(objective: Objective, sonar_cells: u8) -> Terms {
    Terms { objective, sonar_cells, costs: Costs::EVEN }
}

/// What a robot can reach without unsearched cells of closed areas, and the luggage beside it.
fn left_to_search(ground: &Ground, is_shut: impl Fn(Cell) -> bool) -> BTreeSet<Cell> {
    let (mut left, mut border) = (BTreeSet::from([Cell::HOME]), vec![Cell::HOME]);
    while let Some(cell) = border.pop() {
        for next in cell.neighbours() {
            if ground.at(next) != Truth::Wall && !is_shut(next) && left.insert(next) && ground.at(next) == Truth::Free {
                border.push(next);
            }
        }
    }
    left
}

/// Searches to the end. After some decisions, a person orders and closes areas.
fn search(
    ground: &Ground,
    strategy: Strategy,
    terms: Terms,
    plan: Option<&Arc<AreaPlan>>,
    mut later: Option<&Arc<AreaPlan>>,
) -> Walk {
    let (mut walk, mut ways, mut search) = (Walk::new(ground, terms), Ways::default(), strategy.begin());
    (walk.areas, walk.trail, walk.heeds_news) = (plan.cloned(), Some(Vec::new()), strategy.heeds_news());
    for decision in 0.. {
        let goal = search.next(&walk.view(), &mut ways);
        let has_ended = !walk.follow(ground, &mut ways, goal);
        if has_ended && later.is_none() {
            break;
        }
        if has_ended || decision == 60 {
            walk.areas = later.take().cloned().or(walk.areas);
        }
        assert!(decision < 100_000, "the search does not end");
    }
    walk
}

fn plan(areas: &[Area], order: &[Arc<str>], closed: &[Arc<str>]) -> Arc<AreaPlan> {
    let sensor = Sensor { cells: 3, model: Some(SensorModel::SimCamera) };
    let is_closed = |name: &str| closed.iter().any(|closed| **closed == *name);
    Arc::new(AreaPlan::new(areas, order, is_closed, sensor).expect("there are areas"))
}

/// A random half of the areas, in random order.
fn some(areas: &[Area], dice: &mut RandomStream) -> Vec<Arc<str>> {
    let mut names: Vec<Arc<str>> = areas.iter().filter(|_| dice.happens(0.5)).map(|area| Arc::clone(&area.name)).collect();
    names.sort_by_cached_key(|_| dice.number());
    names
}

#[test]
fn with_any_areas_every_strategy_searches_all_but_closed_areas_and_comes_home() {
    let halls = std::env::var("HALLSWEEP_HALLS").map_or(18, |halls| halls.parse().expect("HALLSWEEP_HALLS is a number"));
    for n in 0..halls {
        let mut dice = RandomStream::new(n, "hall with areas");
        let family = Family::ALL[usize::try_from(n).unwrap() % Family::ALL.len()];
        let [columns, lines] = [(); 2].map(|()| 8 + usize::try_from(dice.below(25)).unwrap());
        let hall = hall(family, columns, lines, &mut dice);
        let (ground, areas) = (Ground::of(&hall), areas(hall.bounds(), &mut dice));
        let (order, closed) = (some(&areas, &mut dice), some(&areas, &mut dice));
        let plans = [plan(&areas, &[], &[]), plan(&areas, &order, &[]), plan(&areas, &order, &closed)];
        for strategy in Strategy::ALL {
            for (sonar_cells, objective) in
                [(0, Objective::Find), (3, Objective::Find), (0, Objective::Cover), (3, Objective::Cover)]
            {
                let terms = terms(objective, sonar_cells);
                let usual = search(&ground, strategy, terms, None, None).moves.total();
                for (first, later) in [(0, 0), (1, 1), (2, 2), (0, 2), (2, 0)] {
                    let walk = search(&ground, strategy, terms, Some(&plans[first]), Some(&plans[later]));
                    let of = format!("hall {n}, {family} by {}, {terms:?}, plans {first} and {later}", strategy.name());
                    assert_eq!(walk.pose.cell, Cell::HOME, "{of}");
                    let is_shut = |cell| plans[later].is_closed(cell) && walk.grid.at(cell) != Square::Visited;
                    for cell in left_to_search(&ground, is_shut) {
                        let is_searched = matches!(walk.grid.at(cell), Square::Visited | Square::Luggage);
                        assert!(is_searched, "{of}: {cell} is left out");
                    }
                    if later == 0 {
                        assert_eq!((walk.visited, walk.found), (ground.reachable, ground.touchable), "{of}");
                    }
                    let entered = |cell: &&Cell| plans[2].is_closed(**cell) && **cell != Cell::HOME;
                    if (first, later, sonar_cells) == (2, 2, 0) && strategy != Strategy::Snail {
                        assert_eq!(walk.trail.iter().flatten().find(entered), None, "{of}: a closed area was entered");
                    }
                    assert!(walk.moves.total() <= 3 * usual + 60, "{of}: {} moves instead of {usual}", walk.moves.total());
                }
            }
        }
    }
}

#[test]
fn equal_probabilities_everywhere_change_no_move() {
    for n in 0..12 {
        let mut dice = RandomStream::new(n, "flat");
        let hall = hall(Family::ALL[usize::try_from(n).unwrap() % 9], 30, 25, &mut dice);
        let ground = Ground::of(&hall);
        let all = vec![Area { name: "hall".into(), probability: 1.0, corners: [hall.bounds().least, hall.bounds().most].into() }];
        let cells = f64::from(hall.bounds().width() * hall.bounds().height());
        let mut some = areas(hall.bounds(), &mut dice);
        some.iter_mut().for_each(|area| area.probability = area.cells().count() as f64 / cells);
        for areas in [some, all] {
            for strategy in Strategy::ALL {
                for terms in [terms(Objective::Find, 0), terms(Objective::Find, 3)] {
                    let plain = search(&ground, strategy, terms, None, None);
                    let flat = search(&ground, strategy, terms, Some(&plan(&areas, &[], &[])), None);
                    assert_eq!(flat.trail, plain.trail, "hall {n} by {}, {terms:?}", strategy.name());
                }
            }
        }
    }
}

/// An empty hall of 21×21 with one area of 5×5 in each corner but the first. The area in the east is the most probable.
fn corners() -> (Ground, Vec<Area>) {
    let mut rows = vec![".".repeat(21); 21];
    rows[0].replace_range(0..1, "S");
    let hall = Hall::from_rows("corners", &rows.iter().map(String::as_str).collect::<Vec<_>>()).expect("a hall");
    let area = |name: &str, probability, x: i32, y: i32| Area {
        name: name.into(),
        probability,
        corners: [Cell::new(x, y), Cell::new(x + 4, y + 4)].into(),
    };
    (Ground::of(&hall), vec![area("south", 0.2, 0, 16), area("east", 0.5, 16, 0), area("far", 0.1, 16, 16)])
}

/// The areas in the order in which their last cells are searched.
fn finished(ground: &Ground, areas: &[Area], walk: &Walk) -> Vec<Arc<str>> {
    let trail = walk.trail.as_ref().expect("it was asked for");
    let last = |area: &Area| {
        let cells = area.cells().filter(|cell| ground.is_within(*cell));
        cells.map(|cell| trail.iter().position(|at| *at == cell)).max().expect("an area has cells")
    };
    let mut ends: Vec<(Option<usize>, Arc<str>)> = areas.iter().map(|area| (last(area), Arc::clone(&area.name))).collect();
    ends.sort();
    ends.into_iter().map(|(_, name)| name).collect()
}

#[test]
fn the_search_goes_to_the_most_probable_area_first_and_then_to_the_next() {
    let (ground, areas) = corners();
    for (strategy, sonar_cells) in [(Strategy::Auto, 0), (Strategy::Frontier, 0), (Strategy::Columns, 0), (Strategy::Auto, 3)] {
        let walk = search(&ground, strategy, terms(Objective::Find, sonar_cells), Some(&plan(&areas, &[], &[])), None);
        let trail = walk.trail.as_ref().unwrap();
        let first = trail.iter().find_map(|cell| areas.iter().find(|area| area.cells().any(|of| of == *cell)));
        assert_eq!(first.map(|area| &*area.name), Some("east"), "{strategy:?}");
        if sonar_cells == 0 {
            assert_eq!(*finished(&ground, &areas, &walk)[0], *"east", "{strategy:?}");
            let whole = trail.iter().collect::<BTreeSet<_>>().len();
            let east = trail
                .iter()
                .position(|cell| *cell == Cell::new(20, 4))
                .max(trail.iter().position(|cell| *cell == Cell::new(16, 4)));
            assert!(east.unwrap() < whole / 3, "{strategy:?}: not before most of the rest");
        }
    }
}

#[test]
fn an_order_comes_before_everything_with_any_goal_and_a_closed_area_is_skipped() {
    let (ground, areas) = corners();
    let order: Vec<Arc<str>> = ["far", "south", "east"].map(Arc::from).to_vec();
    for strategy in Strategy::ALL.into_iter().filter(|strategy| *strategy != Strategy::Snail) {
        for objective in Objective::ALL {
            for sonar_cells in [0, 3] {
                let terms = terms(objective, sonar_cells);
                let walk = search(&ground, strategy, terms, Some(&plan(&areas, &order, &[])), None);
                assert_eq!(finished(&ground, &areas, &walk), order, "{strategy:?} {objective:?} {sonar_cells}");
                let closed = [Arc::from("far")];
                let walk = search(&ground, strategy, terms, Some(&plan(&areas, &order, &closed)), None);
                let names = finished(&ground, &areas[..2], &walk);
                assert_eq!(names, order[1..], "{strategy:?} {objective:?} {sonar_cells}");
            }
        }
    }
}

/// The ordered area is a closed room. The search must give it up.
#[test]
fn an_ordered_area_that_cannot_be_entered_does_not_stop_the_search() {
    let rows = ["S.......", ".TTT....", ".T.T....", ".TTT....", "........"];
    let hall = Hall::from_rows("room", &rows).expect("a hall");
    let ground = Ground::of(&hall);
    let areas = [Area { name: "room".into(), probability: 0.9, corners: [Cell::new(2, 2), Cell::new(2, 2)].into() }];
    for order in [vec![], vec![Arc::from("room")]] {
        for strategy in Strategy::ALL {
            let walk = search(&ground, strategy, terms(Objective::Find, 0), Some(&plan(&areas, &order, &[])), None);
            assert_eq!((walk.visited, walk.found), (ground.reachable, ground.touchable), "{strategy:?}");
        }
    }
}

/// The figures of docs/search.md, from few halls. There, 600 halls give less than half.
#[test]
fn knowing_where_the_bomb_probably_is_saves_time() {
    let kind = "luggage-10:50x50".parse().expect("a kind of halls");
    let random = gain(kind, 0, 30, 2).expect("there are halls");
    assert!(random.ratio.mean <= 0.85, "{random:?}");
}

/// A robot that changed its mind between areas would enter them again and again.
#[test]
fn the_robot_does_not_go_back_and_forth_between_areas() {
    for n in 0..20 {
        let mut dice = RandomStream::new(n, "back and forth");
        let hall = hall(Family::Luggage(0.1), 40, 40, &mut dice);
        let (ground, areas) = (Ground::of(&hall), areas(hall.bounds(), &mut dice));
        for sonar_cells in [0, 3] {
            let terms = terms(Objective::Find, sonar_cells);
            let usual = search(&ground, Strategy::Auto, terms, None, None);
            let walk = search(&ground, Strategy::Auto, terms, Some(&plan(&areas, &[], &[])), None);
            let entries = |walk: &Walk| -> usize {
                let of = |area: &Area| {
                    let cells: BTreeSet<Cell> = area.cells().collect();
                    let trail = walk.trail.as_ref().unwrap();
                    trail.windows(2).filter(|pair| !cells.contains(&pair[0]) && cells.contains(&pair[1])).count()
                };
                areas.iter().map(of).sum()
            };
            let (more, than) = (walk.moves.total(), usual.moves.total());
            assert!(entries(&walk) <= entries(&usual), "hall {n}, sonar {sonar_cells}: {} entries", entries(&walk));
            assert!(more * 4 <= than * 5, "hall {n}, sonar {sonar_cells}: {more} moves instead of {than}");
        }
    }
}

/// A walk with areas must make the moves of a mission in the same hall. These halls have no luggage.
#[test]
fn a_mission_makes_the_moves_of_a_walk_with_the_same_areas() {
    for (n, family) in (0..).zip([Family::Luggage(0.0), Family::Maze, Family::Maze]) {
        let mut dice = RandomStream::new(n, "mission with areas");
        let hall = Arc::new(hall(family, 17, 15, &mut dice));
        let areas = areas(hall.bounds(), &mut dice);
        let plan = Arc::new(AreaPlan::new(&areas, &[], |_| false, Sensor::default()).expect("there are areas"));
        for strategy in Strategy::ALL {
            for terms in [terms(Objective::Find, 0), terms(Objective::Find, 3)] {
                let walk = search(&Ground::of(&hall), strategy, terms, Some(&plan), None);
                let sim = SimSettings { sonar_cells: terms.sonar_cells, ..SimSettings::new(n, Camera::Stub) };
                let settings = Settings { sonar_cells: terms.sonar_cells, costs: Some(terms.costs), ..Settings::default() };
                let mut run = Run::new(Arc::clone(&hall), sim, settings, strategy);
                let venue = Venue { name: "drawn".into(), areas: areas.clone().into(), ..Venue::default() };
                run.engine.note_venue(venue, Now::default());
                run.give(Command::Start).expect("it may start");
                assert!(run.run_until(1_000_000, |state| state.mission.phase == PhaseName::Explored));
                assert_eq!(run.moves, walk.moves, "{family} by {}, {terms:?}", strategy.name());
            }
        }
    }
}
