//! Tests of a search in a hall with areas: the order, closed areas, and what a restart and the past make of them.

use super::*;
use crate::closing::ClosedArea;
use crate::engine::past::Past;
use crate::engine::recall::Recalled;
use crate::event::Obstacle;
use crate::search::{Goal, Objective};
use crate::state::Venue;
use crate::units::Seq;
use crate::world::areas::Area;

/// The hall has this number of columns and lines, and nothing in it.
const SIDE: i32 = 12;

fn area(name: &str, probability: f64, corners: [(i32, i32); 2]) -> Area {
    Area { name: name.into(), probability, corners: corners.map(|(x, y)| Cell::new(x, y)).into() }
}

/// Two areas in the east corners of the hall.
fn areas() -> [Area; 2] {
    [area("north", 0.3, [(8, 0), (11, 3)]), area("south", 0.3, [(8, 8), (11, 11)])]
}

fn started(strategy: Strategy, objective: Objective) -> Engine {
    let mut engine = Engine::new(Settings { objective, ..Settings::default() }, strategy, "test".into());
    engine.note_venue(Venue { name: "drawn".into(), areas: areas().into(), ..Venue::default() }, now(0));
    link(&mut engine);
    engine.handle_command(Request::new(Command::Start, Issuer::operator(Door::LOCAL)), now(1)).expect("it may start");
    engine
}

fn link(engine: &mut Engine) {
    let quick = Duration::from_millis(1);
    let can =
        Capabilities { step: quick, turn: quick, photo: quick, arm: Duration::ZERO, nudges: false, parts: Parts::ROUND_ROBOT };
    engine.handle_event(Event::Robot(RobotId::discovery(), RobotEvent::LinkUp(can)), now(0));
}

/// Carries out orders until there are none or this number is reached. Returns the cells that the robot enters.
fn drive(engine: &mut Engine, most: usize) -> Vec<Cell> {
    let (mut entered, mut given) = (Vec::new(), 0);
    while let Some(effect) = engine.poll_effect() {
        let order = match effect {
            Effect::Record(page) => {
                engine.handle_event(Event::Recorded(page.last()), now(1));
                continue;
            }
            Effect::Order(_, order) => order,
            Effect::Halt(_) | Effect::Led(..) | Effect::Answer(..) => continue,
        };
        let ahead = engine.state.pose.ahead();
        let is_free = (0..SIDE).contains(&ahead.x) && (0..SIDE).contains(&ahead.y);
        let steps = order.action == Action::Move(Move::Forward);
        let wall = Obstacle::Wall { left: 0, right: 0 };
        let event = if steps && !is_free { RobotEvent::Blocked(order.id, wall) } else { RobotEvent::Done(order.id) };
        if steps && is_free {
            entered.push(ahead);
        }
        engine.handle_event(Event::Robot(RobotId::discovery(), event), now(1));
        given += 1;
        if given == most {
            break;
        }
    }
    entered
}

fn order(engine: &mut Engine, names: &[&str]) {
    engine.state.area_order = names.iter().map(|name| Arc::from(*name)).collect();
    engine.handle_timeout(now(1));
    engine.pump();
}

fn close(engine: &mut Engine, names: &[&str]) {
    let closed = || ClosedArea {
        who: "anna".into(),
        name: Note::new("Anna Rossi").expect("a name"),
        note: None,
        open: Default::default(),
        wall: WallTime::default(),
    };
    engine.state.closed_areas = Arc::new(names.iter().map(|name| (Arc::from(*name), closed())).collect());
    engine.pump();
}

/// The name of the area whose last cell is entered first.
fn finished_first(entered: &[Cell]) -> Arc<str> {
    let last = |area: &Area| area.cells().map(|cell| entered.iter().position(|at| *at == cell)).max();
    areas().iter().min_by_key(|area| last(area)).map(|area| Arc::clone(&area.name)).expect("there are two areas")
}

#[test]
fn a_new_order_is_followed_at_once_by_any_strategy_with_any_goal() {
    for strategy in Strategy::ALL.into_iter().filter(|strategy| *strategy != Strategy::Snail) {
        for objective in Objective::ALL {
            for name in ["south", "north"] {
                let mut engine = started(strategy, objective);
                let mut entered = drive(&mut engine, 20);
                order(&mut engine, &[name, "no such area"]);
                let next = engine.state.goal;
                entered.extend(drive(&mut engine, usize::MAX));
                assert_eq!(*finished_first(&entered), *name, "{strategy:?} {objective:?} {next:?}");
                assert_eq!(engine.phase_name(), PhaseName::Explored, "{strategy:?} {objective:?}");
                assert_eq!(engine.snapshot().mission.progress.visited, (SIDE * SIDE) as usize);
            }
        }
    }
}

#[test]
fn a_closed_area_is_left_out_and_nothing_counts_as_left_in_it() {
    for strategy in Strategy::ALL {
        let mut engine = started(strategy, Objective::Find);
        drive(&mut engine, 20);
        close(&mut engine, &["south"]);
        let entered = drive(&mut engine, usize::MAX);
        let closed = &areas()[1];
        assert!(strategy == Strategy::Snail || !closed.cells().any(|cell| entered.contains(&cell)), "{strategy:?}");
        assert_eq!(engine.phase_name(), PhaseName::Explored, "{strategy:?}");
        let mission = engine.snapshot().mission.clone();
        assert_eq!((mission.progress.unknown, mission.progress.left), (0, None), "{strategy:?}");
        assert!(mission.open.places > 0, "{strategy:?}: whoever closes the mission sees what was not searched");
        let left = areas()[1].cells().filter(|cell| !entered.contains(cell)).count();
        assert!(engine.state.map.visited() + left >= (SIDE * SIDE) as usize, "{strategy:?}: more was left out");
    }
}

#[test]
fn a_goal_that_was_chosen_before_is_given_up_unless_somebody_asked_for_it() {
    for is_asked_for in [false, true] {
        let mut engine = started(Strategy::Frontier, Objective::Find);
        drive(&mut engine, 20);
        let goal = Some(Goal::Visit(Cell::new(1, 11)));
        engine.state.goal = goal;
        engine.state.again = Arc::new(goal.map(Goal::cell).filter(|_| is_asked_for).into_iter().collect());
        order(&mut engine, &["north"]);
        assert_eq!(engine.state.goal, goal.filter(|_| is_asked_for));
    }
}

#[test]
fn an_area_that_is_closed_while_the_robot_searches_it_is_left() {
    for strategy in [Strategy::Auto, Strategy::Frontier] {
        let mut engine = started(strategy, Objective::Find);
        order(&mut engine, &["south"]);
        while !areas()[1].cells().any(|cell| cell == engine.state.pose.cell) {
            drive(&mut engine, 1);
        }
        close(&mut engine, &["south"]);
        drive(&mut engine, 1);
        let goal = engine.state.goal.map(Goal::cell).expect("the search goes on");
        assert!(!areas()[1].cells().any(|cell| cell == goal), "{strategy:?} {goal}");
    }
}

#[test]
fn cells_of_a_closed_area_are_searched_again_when_somebody_asks() {
    let mut engine = started(Strategy::Auto, Objective::Find);
    drive(&mut engine, usize::MAX);
    close(&mut engine, &["south"]);
    let again = Again::Within(Bounds { least: Cell::new(9, 9), most: Cell::new(10, 10) });
    let again = Command::SearchAgain(again);
    engine.handle_command(Request::new(again, Issuer::operator(Door::LOCAL)), now(1)).expect("it was searched");
    let entered = drive(&mut engine, usize::MAX);
    assert!(entered.contains(&Cell::new(9, 10)) && engine.state.again.is_empty(), "{entered:?}");
}

#[test]
fn a_restart_and_the_past_know_the_order_and_the_closed_areas() {
    let mut engine = started(Strategy::Frontier, Objective::Cover);
    order(&mut engine, &["north"]);
    drive(&mut engine, 60);
    close(&mut engine, &["south"]);
    let state = engine.persistent_state();
    let past = Past { seq: Seq(9), state: state.clone(), trail: Vec::new(), temperatures: Vec::new(), latest: Vec::new() };
    assert_eq!(past.snapshot(engine.settings, []).mission.progress.unknown, engine.progress().unknown);
    let goal = state.goal;
    let recalled = Recalled { state, written: Seq(900), commands: Vec::new(), kept_back: Vec::new(), latest: Vec::new() };
    let mut again = Engine::recall(engine.settings, "again".into(), recalled, now(2));
    assert_eq!((again.planner.areas.clone(), again.state.goal), (engine.planner.areas.clone(), goal), "nothing has changed");
    assert!(again.planner.areas.is_some());
    again.state.conditions = None;
    again.pump();
    assert_eq!(again.planner.areas, None, "another hall has no areas");
}
