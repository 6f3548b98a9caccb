//! Tests of situations that no interface can create at will. `by_hand` tests the outcome of every pair of phase and
//! input. `shown` tests what is shown meanwhile.

mod areas;
mod by_hand;
mod clock;
mod endless;
mod fetching;
mod floods;
mod shown;
mod simulated;
mod temperature;

use std::time::Duration;

use super::*;
use crate::closing::{AreaClosing, Closing};
use crate::command::{Again, Command, CommandId, Door, Issuer, LuggageRef, Move, Note, TemperatureReport, Verdict};
use crate::effect::Action;
use crate::event::{Capabilities, Obstacle, RobotEvent};
use crate::hand_over::HandOver;
use crate::hold::{Hold, Holds};
use crate::phase::{FaultCause, PhaseName};
use crate::robot::Parts;
use crate::settings::Rules;
use crate::state::{Conditions, Inspection, Phase, Stage, Venue};
use crate::units::{AlarmId, Cell, Celsius, OrderId, Pose, Seq, WallTime};
use crate::world::areas::Area;
use crate::world::hall_map::Bounds;
use crate::world::luggage::{Luggage, PhotoState};

fn now(seconds: u64) -> Now {
    Now { since_start: Duration::from_secs(seconds), wall: WallTime::default() }
}

fn phase(name: PhaseName) -> Phase {
    let inspection = Inspection {
        cell: Cell::new(0, 2),
        piece: None,
        pose: Pose { cell: Cell::new(0, 1), ..Pose::START },
        stage: Stage::AwaitingVerdict(LuggageId(1)),
        views: 0,
    };
    match name {
        PhaseName::Idle => Phase::Idle,
        PhaseName::Exploring => Phase::Exploring,
        PhaseName::Inspecting => Phase::Inspecting(inspection),
        PhaseName::Driving => Phase::Driving { goal: Some(Cell::new(0, 5)), next: None, interrupted: Box::new(Phase::Exploring) },
        PhaseName::ReturningHome => Phase::ReturningHome,
        PhaseName::AtHome => Phase::AtHome,
        PhaseName::ReturningWithAlarm => Phase::ReturningWithAlarm,
        PhaseName::BombLocated => Phase::BombLocated,
        PhaseName::Retrieving => Phase::Retrieving,
        PhaseName::BagSecured => Phase::BagSecured,
        PhaseName::Explored => Phase::Explored,
        PhaseName::Fault => Phase::Fault { cause: FaultCause::Unanswered, interrupted: Box::new(Phase::Exploring) },
    }
}

/// A hall with one area, of two cells: the cell where `sweep_in` puts the robot, and the cell of the piece.
fn with_area() -> Venue {
    let area = Area { name: "gate".into(), probability: 0.5, corners: [Cell::new(0, 1), Cell::new(0, 2)].into() };
    Venue { areas: [area].into(), ..Venue::default() }
}

/// Returns an engine in this phase and under these holds. A linked robot stands at the centre of a cell away from
/// home, and one piece is pending.
fn sweep_in(name: PhaseName, holds: &[Hold]) -> Engine {
    let mut engine = Engine::new(Settings::default(), Strategy::Snail, "test".into());
    let quick = Duration::from_millis(1);
    let can =
        Capabilities { step: quick, turn: quick, photo: quick, arm: Duration::ZERO, nudges: false, parts: Parts::ROUND_ROBOT };
    engine.handle_event(Event::Robot(RobotId::discovery(), RobotEvent::LinkUp(can)), now(0));
    engine.state.pose.cell = Cell::new(0, 1);
    engine.mark(Cell::new(0, 1), crate::world::hall_map::Mark::Visited);
    let luggage = Luggage {
        id: LuggageId(1),
        cell: Cell::new(0, 2),
        pose: engine.state.pose,
        taken: WallTime::default(),
        first_taken: WallTime::default(),
        photo: PhotoState::Taken { bytes: 1, take: 1 },
        verdict: None,
        seen_from: Vec::new(),
        unsure: Vec::new(),
        judged: Vec::new(),
        truth: None,
        piece: None,
        secured: None,
        clock_set_ms: 0,
    };
    engine.state.luggage.insert(Arc::new(luggage));
    engine.state.last_luggage = LuggageId(1);
    engine.state.conditions =
        Some(Conditions { venue: with_area(), threshold: engine.settings.threshold, rules: Rules::default() });
    engine.state.phase = phase(name);
    engine.state.holds = Holds::default();
    for hold in holds {
        engine.state.holds.raise(*hold);
    }
    while let Some(effect) = engine.poll_effect() {
        if let Effect::Record(page) = effect {
            engine.outbox.keep(page.last());
        }
    }
    engine
}

/// Stores records at once, like a store in memory. Returns the orders that were given.
fn settle(engine: &mut Engine) -> Vec<Action> {
    let mut orders = Vec::new();
    while let Some(effect) = engine.poll_effect() {
        match effect {
            Effect::Record(page) => engine.handle_event(Event::Recorded(page.last()), now(1)),
            Effect::Order(_, order) => orders.push(order.action),
            Effect::Halt(_) | Effect::Led(..) | Effect::Answer(..) => {}
        }
    }
    orders
}

fn command(input: Input) -> Option<Command> {
    let luggage = LuggageRef::Id(LuggageId(1));
    Some(match input {
        Input::Start => Command::Start,
        Input::Stop => Command::Stop,
        Input::BackHome => Command::BackHome,
        Input::GoOn => Command::GoOn,
        Input::Safe => Command::Verdict { luggage, verdict: Verdict::Safe, note: None, hot: Default::default() },
        Input::Danger => Command::Verdict { luggage, verdict: Verdict::Danger, note: None, hot: Default::default() },
        Input::Unsure => Command::Unsure { luggage, note: None, hot: Default::default() },
        Input::Close => Command::Close(Closing { name: Note::new("Anna Rossi")?, note: None, seen: "".into() }),
        Input::HandOver => Command::HandOver(HandOver { mission: None, to: Note::new("police")?, note: None }),
        Input::SearchAgain => Command::SearchAgain(Again::Within(Bounds { least: Cell::HOME, most: Cell::new(1, 0) })),
        Input::OrderAreas => Command::OrderAreas(["gate".into()].into()),
        Input::CloseArea => {
            let (area, name) = ("gate".into(), Note::new("Anna Rossi")?);
            Command::CloseArea(AreaClosing { area, name, note: None, mission: None })
        }
        Input::TemperatureOk => Command::Temperature(TemperatureReport::Ok),
        Input::TemperatureTooHigh => Command::Temperature(TemperatureReport::TooHigh),
        Input::Reading => Command::Temperature(TemperatureReport::Reading(Celsius::new(20.0)?)),
        Input::SensorReading => {
            Command::Temperature(TemperatureReport::Sensor("roof".into(), Celsius::new(20.0).expect("a believable temperature")))
        }
        Input::Retrieve => Command::Retrieve(None),
        Input::Reset => Command::Reset,
        Input::Move => Command::Move(Move::TurnLeft),
        Input::Goto => Command::Goto(Cell::new(3, 3)),
        Input::RetakePhoto => Command::RetakePhoto(LuggageId(1)),
        Input::Acknowledge => Command::Acknowledge(AlarmId(1)),
        Input::Strategy => Command::ChooseStrategy(Strategy::Snail),
        Input::Done
        | Input::Blocked
        | Input::AtPiece
        | Input::PhotoTaken
        | Input::PhotoFailed
        | Input::LuggageRecorded
        | Input::SafeRecorded
        | Input::DangerRecorded
        | Input::CameHome
        | Input::AllExplored
        | Input::DriveEnded
        | Input::Secured
        | Input::NotFetched
        | Input::NoWayHome
        | Input::Unanswered
        | Input::RobotFailed
        | Input::LinkLost
        | Input::LinkUp
        | Input::Heat
        | Input::Cool
        | Input::SensorSilent
        | Input::SensorBack
        | Input::StoreFailed
        | Input::StoreRestored
        | Input::Restarted => return None,
    })
}

#[test]
fn a_hold_raised_during_a_mission_also_waits_for_a_start() {
    for name in PhaseName::ALL {
        let mut engine = sweep_in(name, &[]);
        engine.feed(Input::Heat, &InputContext::default());
        let mission = !matches!(name, PhaseName::Idle | PhaseName::Explored | PhaseName::BagSecured);
        assert_eq!(engine.state.holds.contains(Hold::AwaitingStart), mission, "{name:?}");
    }
}

/// Safety V1: the first stored verdict is final. A danger that arrives before a safe is stored replaces the safe.
#[test]
fn a_danger_that_comes_before_a_safe_is_kept_replaces_it() {
    let give = |engine: &mut Engine, verdict| {
        let command = Command::Verdict { luggage: LuggageRef::Id(LuggageId(1)), verdict, note: None, hot: Default::default() };
        engine.handle_command(Request::new(command, Issuer::operator(Door::LOCAL)), now(1))
    };
    let mut engine = sweep_in(PhaseName::Inspecting, &[]);
    let safe = give(&mut engine, Verdict::Safe).unwrap();
    let danger = give(&mut engine, Verdict::Danger).unwrap();
    let refused = Refused::Decided { luggage: LuggageId(1), verdict: Verdict::Danger };
    assert_eq!(give(&mut engine, Verdict::Safe), Err(refused.clone()), "no safe takes the place of a danger");
    let mut answers = Vec::new();
    while let Some(effect) = engine.poll_effect() {
        match effect {
            Effect::Record(page) => engine.handle_event(Event::Recorded(page.last()), now(1)),
            Effect::Answer(ticket, answer) => answers.push((ticket, answer.map(|accepted| accepted.luggage))),
            Effect::Order(..) | Effect::Halt(_) | Effect::Led(..) => {}
        }
    }
    assert_eq!(answers, [(safe, Err(refused)), (danger, Ok(Some(LuggageId(1))))]);
    assert_eq!(engine.phase_name(), PhaseName::ReturningWithAlarm);
}

/// Safety S2: a motion starts only after its record is stored. A stop does not wait for a record.
#[test]
fn nothing_begins_to_move_before_its_record_is_kept_and_a_stop_is_answered_at_once() {
    let order = |effect: &Effect| matches!(effect, Effect::Order(..));
    let give = |engine: &mut Engine, command| {
        engine.handle_command(Request::new(command, Issuer::operator(Door::LOCAL)), now(1)).unwrap()
    };
    let mut engine = sweep_in(PhaseName::Idle, &[]);
    give(&mut engine, Command::Start);
    let effects: Vec<Effect> = std::iter::from_fn(|| engine.poll_effect()).collect();
    assert!(!effects.iter().any(order) && !effects.iter().any(|effect| matches!(effect, Effect::Answer(..))));
    give(&mut engine, Command::Stop);
    let effects: Vec<Effect> = std::iter::from_fn(|| engine.poll_effect()).collect();
    assert!(effects.contains(&Effect::Halt(RobotId::discovery())));
    assert!(effects.iter().any(|effect| matches!(effect, Effect::Answer(_, Ok(_)))));
    engine.handle_event(Event::Recorded(Seq(1000)), now(1));
    assert!(
        !std::iter::from_fn(|| engine.poll_effect()).any(|effect| order(&effect)),
        "the stop outlives the record of the start"
    );
}

/// Safety S5: every order has a deadline.
#[test]
fn an_order_that_is_not_answered_in_time_is_a_fault_and_start_recentres_first() {
    let mut engine = sweep_in(PhaseName::Exploring, &[]);
    engine.pump();
    assert!(matches!(settle(&mut engine)[..], [Action::Move(_)]));
    engine.state.luggage = Default::default();
    let due = engine.poll_timeout().expect("an open order has a deadline");
    engine.handle_timeout(Now { since_start: due, wall: WallTime::default() });
    assert_eq!(engine.phase_name(), PhaseName::Fault);
    settle(&mut engine);
    let start = Request::new(Command::Start, Issuer::operator(Door::LOCAL));
    engine.handle_command(start, now(9)).unwrap();
    assert_eq!(settle(&mut engine), [Action::Recentre]);
    assert_eq!(engine.phase_name(), PhaseName::Exploring);
}

#[test]
fn without_a_known_way_home_there_is_a_fault_and_start_tries_the_blocked_cell_again() {
    let mut engine = sweep_in(PhaseName::ReturningWithAlarm, &[]);
    let obstacle = |engine: &mut Engine, id| {
        let blocked = RobotEvent::Blocked(id, Obstacle::Unknown);
        engine.handle_event(Event::Robot(RobotId::discovery(), blocked), now(1));
    };
    engine.state.pose.heading = crate::units::Heading::North;
    engine.pump();
    assert_eq!(settle(&mut engine), [Action::Move(Move::Forward)], "home lies one step to the north");
    let open = engine.robots.searching().controller.open().expect("the step is under way").id;
    obstacle(&mut engine, open);
    settle(&mut engine);
    let recentre = engine.robots.searching().controller.open().map_or(OrderId(0), |order| order.id);
    engine.handle_event(Event::Robot(RobotId::discovery(), RobotEvent::Done(recentre)), now(1));
    assert_eq!(engine.phase_name(), PhaseName::Fault);
    let start = || Request::new(Command::Start, Issuer::operator(Door::LOCAL));
    settle(&mut engine);
    engine.handle_command(start(), now(1)).unwrap();
    assert_eq!(engine.phase_name(), PhaseName::ReturningWithAlarm, "a cell that was free once is tried again");
    assert_eq!(settle(&mut engine), [Action::Move(Move::Forward)]);
}
