//! Tests a robot that never meets an obstacle, for example because its bumper is broken. It comes to the end of its
//! reach, and the core continues.

use super::*;
use crate::command::Strategy;
use crate::event::Whereabouts;
use crate::units::Heading;
use crate::world::hall_map::REACH;

fn linked(strategy: Strategy) -> Engine {
    let mut engine = Engine::new(Settings::default(), strategy, "test".into());
    let quick = Duration::from_millis(1);
    let can =
        Capabilities { step: quick, turn: quick, photo: quick, arm: Duration::ZERO, nudges: false, parts: Parts::ROUND_ROBOT };
    engine.handle_event(Event::Robot(RobotId::discovery(), RobotEvent::LinkUp(can)), now(0));
    engine
}

fn give(engine: &mut Engine, command: Command) -> Result<(), Refused> {
    engine.handle_command(Request::new(command, Issuer::operator(Door::LOCAL)), now(1)).map(drop)
}

/// Returns the next order. Records are stored at once.
fn next_order(engine: &mut Engine) -> Option<OrderId> {
    let mut ordered = None;
    while let Some(effect) = engine.poll_effect() {
        match effect {
            Effect::Record(page) => engine.handle_event(Event::Recorded(page.last()), now(1)),
            Effect::Order(_, order) => ordered = Some(order.id),
            Effect::Halt(_) | Effect::Led(..) | Effect::Answer(..) => {}
        }
    }
    ordered
}

#[test]
fn a_hall_without_walls_is_searched_up_to_the_reach_of_the_robot() {
    for strategy in Strategy::ALL {
        let mut engine = linked(strategy);
        give(&mut engine, Command::Start).unwrap();
        for step in 1..15_000 {
            let Some(id) = next_order(&mut engine) else { break };
            let ended = if step % 50 == 0 {
                give(&mut engine, Command::Stop).unwrap();
                RobotEvent::Halted(id, true)
            } else {
                RobotEvent::Done(id)
            };
            engine.handle_event(Event::Robot(RobotId::discovery(), ended), now(1));
            if step % 50 == 0 {
                next_order(&mut engine);
                give(&mut engine, Command::Start).unwrap();
            }
            let Cell { x, y } = engine.state.pose.cell;
            assert!(x.abs() <= REACH && y.abs() <= REACH, "{strategy:?}: {:?}", engine.state.pose);
        }
        assert_eq!(engine.phase_name(), PhaseName::Exploring, "{strategy:?}");
    }
}

/// Returns an engine whose robot stands at the edge of its reach, and the robot's pose.
fn at_the_edge() -> (Engine, Pose) {
    let mut engine = linked(Strategy::Snail);
    let pose = Pose { cell: Cell::new(0, REACH), heading: Heading::South };
    let stands = RobotEvent::Stands(Whereabouts { pose, off_centre: false });
    engine.handle_event(Event::Robot(RobotId::discovery(), stands), now(1));
    next_order(&mut engine);
    (engine, pose)
}

#[test]
fn no_step_beyond_the_reach_is_ordered() {
    let (mut engine, pose) = at_the_edge();
    give(&mut engine, Command::Start).unwrap();
    engine.state.phase = Phase::Driving { goal: None, next: Some(Move::Forward), interrupted: Box::new(Phase::Idle) };
    engine.mission.is_driven = false;
    assert_eq!((next_order(&mut engine), engine.phase_name(), engine.state.pose), (None, PhaseName::Idle, pose));
}

#[test]
fn a_robot_that_went_beyond_the_reach_is_a_fault_and_stays_where_it_was_recorded() {
    let (mut engine, pose) = at_the_edge();
    give(&mut engine, Command::Start).unwrap();
    engine.moved(&RobotId::discovery(), Move::Forward);
    assert_eq!((engine.phase_name(), engine.state.pose), (PhaseName::Fault, pose));
}

#[test]
fn a_robot_that_reports_an_impossible_place_or_is_recorded_at_one_moves_nowhere() {
    for place in [Cell::new(i32::MIN, 0), Cell::new(0, i32::MAX), Cell::new(-REACH - 1, REACH)] {
        let mut engine = linked(Strategy::Snail);
        give(&mut engine, Command::Start).unwrap();
        let pose = Pose { cell: place, heading: Heading::South };
        let stands = RobotEvent::Stands(Whereabouts { pose, off_centre: false });
        engine.handle_event(Event::Robot(RobotId::discovery(), stands), now(1));
        assert_eq!((engine.phase_name(), engine.state.pose.cell), (PhaseName::Fault, Cell::HOME), "{place:?}");
    }
    for place in [Cell::new(2 * REACH, -2 * REACH), Cell::new(5000, 5000)] {
        let mut engine = linked(Strategy::Snail);
        engine.state.pose.cell = place;
        give(&mut engine, Command::Start).unwrap();
        assert_eq!((next_order(&mut engine), engine.phase_name()), (None, PhaseName::Fault), "{place:?}");
    }
}
