//! Tests of a search in a hall with areas: the order, closed areas, and what a restart and the past make of them.

use super::*;
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

fn accept(engine: &mut Engine, command: Command) {
    engine.handle_command(Request::new(command, Issuer::operator(Door::LOCAL)), now(1)).expect("it is accepted");
}

fn order(engine: &mut Engine, names: &[&str]) {
    accept(engine, Command::OrderAreas(names.iter().map(|name| Arc::from(*name)).collect()));
}

fn closing(area: &str) -> Command {
    let name = Note::new("Anna Rossi").expect("a name");
    Command::CloseArea(AreaClosing { area: area.into(), name, note: None, mission: None })
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
                order(&mut engine, &[name]);
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
        accept(&mut engine, closing("south"));
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
        let entered = drive(&mut engine, 20);
        if is_asked_for {
            accept(&mut engine, Command::SearchAgain(Again::Within(Bounds::of(entered[0]))));
        }
        drive(&mut engine, 1);
        let goal = engine.state.goal;
        assert!(matches!(goal, Some(Goal::Visit(_))) && engine.state.again.is_empty() != is_asked_for, "{goal:?}");
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
        accept(&mut engine, closing("south"));
        drive(&mut engine, 1);
        let goal = engine.state.goal.map(Goal::cell).expect("the search goes on");
        assert!(!areas()[1].cells().any(|cell| cell == goal), "{strategy:?} {goal}");
    }
}

#[test]
fn cells_of_a_closed_area_are_searched_again_when_somebody_asks() {
    let mut engine = started(Strategy::Auto, Objective::Find);
    drive(&mut engine, usize::MAX);
    accept(&mut engine, closing("south"));
    let again = Again::Within(Bounds { least: Cell::new(9, 9), most: Cell::new(10, 10) });
    accept(&mut engine, Command::SearchAgain(again));
    let entered = drive(&mut engine, usize::MAX);
    assert!(entered.contains(&Cell::new(9, 10)) && engine.state.again.is_empty(), "{entered:?}");
}

#[test]
fn a_restart_and_the_past_know_the_order_and_the_closed_areas() {
    let mut engine = started(Strategy::Frontier, Objective::Cover);
    order(&mut engine, &["north"]);
    drive(&mut engine, 60);
    accept(&mut engine, closing("south"));
    let state = engine.persistent_state();
    let past = Past { seq: Seq(9), state: state.clone(), trail: Vec::new(), temperatures: Vec::new(), latest: Vec::new() };
    assert_eq!(past.snapshot(engine.settings, []).mission.progress.unknown, engine.progress().unknown);
    let goal = state.goal;
    let recalled = Recalled { state, written: Seq(900), commands: Vec::new(), kept_back: Vec::new(), latest: Vec::new() };
    let mut again = Engine::recall(engine.settings, "again".into(), recalled, now(2));
    assert_eq!((again.planner.areas.clone(), again.state.goal), (engine.planner.areas.clone(), goal), "nothing has changed");
    assert!(again.planner.areas.is_some());
    again.note_venue(Venue::default(), now(3));
    assert_eq!(again.planner.areas, None, "another hall has no areas");
}

#[test]
fn a_closed_area_keeps_its_place_in_the_order_until_it_is_searched_again() {
    for is_opened in [false, true] {
        let mut engine = started(Strategy::Auto, Objective::Find);
        accept(&mut engine, closing("south"));
        order(&mut engine, &["south", "north"]);
        let mut entered = drive(&mut engine, 12);
        let places = engine.snapshot().mission.areas.iter().map(|area| area.order).collect::<Vec<_>>();
        assert_eq!(places, [Some(2), Some(1)], "the closed area is in the order");
        if is_opened {
            accept(&mut engine, Command::SearchAgain(Again::Area("south".into())));
            assert!(engine.state.closed_areas.is_empty());
        }
        entered.extend(drive(&mut engine, usize::MAX));
        let has_entered = |area: &Area| area.cells().all(|cell| entered.contains(&cell));
        assert_eq!(areas().map(|area| has_entered(&area)), [true, is_opened]);
        assert!(!is_opened || &*finished_first(&entered) == "south", "{entered:?}");
        assert_eq!(engine.phase_name(), PhaseName::Explored);
    }
}

#[test]
fn closing_an_area_again_with_the_same_id_has_the_same_answer_and_changes_nothing() {
    let mut engine = started(Strategy::Auto, Objective::Find);
    drive(&mut engine, 20);
    let id = CommandId::new("1");
    let request = Request { id, ..Request::new(closing("south"), Issuer::operator(Door::LOCAL)) };
    let answer = |engine: &mut Engine| {
        let ticket = engine.handle_command(request.clone(), now(1)).expect("it is accepted");
        loop {
            match engine.poll_effect().expect("it is answered") {
                Effect::Record(page) => engine.handle_event(Event::Recorded(page.last()), now(1)),
                Effect::Answer(of, answer) if of == ticket => return answer,
                Effect::Order(..) | Effect::Halt(_) | Effect::Led(..) | Effect::Answer(..) => {}
            }
        }
    };
    let (first, state) = (answer(&mut engine), engine.persistent_state());
    assert!(first.is_ok() && state.closed_areas.contains_key("south"));
    assert_eq!((answer(&mut engine), engine.persistent_state()), (first, state));
    let anew = engine.handle_command(Request::new(closing("south"), Issuer::operator(Door::LOCAL)), now(1));
    assert_eq!(anew, Err(Refused::AreaClosed("south".into())));
}
