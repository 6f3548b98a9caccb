//! Random commands at random moments in random halls: whatever an operator does, the rules hold. A failure prints its seed.

use hallsweep::core::command::{Command, LuggageRef, Move, TemperatureReport, Verdict};
use hallsweep::core::mission::{Hold, PhaseName};
use hallsweep::core::rng::Stream;
use hallsweep::core::settings::Settings;
use hallsweep::core::units::{AlarmId, Cell, Celsius, LuggageId};
use hallsweep::core::world::hall_map::Mark;
use hallsweep::core::world::robot::RobotState;
use hallsweep::headless::Run;
use hallsweep::outbound::robot::sim::{Camera, Hall, SimSettings, Truth};

use crate::halls;
use crate::operator::Operator;

#[test]
fn whatever_the_operator_does_the_rules_hold_and_the_mission_can_be_brought_to_its_end() {
    for seed in 0..400 {
        let hall = halls::random(seed, 9);
        let mut dice = Stream::new(seed, "operator");
        let sim = SimSettings { unknown_rate: 0.1, photo_failure_rate: 0.2, ..SimSettings::new(seed, Camera::Stub) };
        let mut run = Run::new(hall.clone(), sim, Settings::default(), Default::default());
        for _ in 0..120 {
            let command = any_command(&mut dice, &mut run);
            give_and_check(&mut run, command, seed);
            for _ in 0..dice.below(6) {
                let held = !run.holds().is_empty();
                let before = run.sim.pose_at(run.now());
                run.advance();
                check(&mut run, &hall, seed);
                let still_held = held && !run.holds().is_empty();
                assert!(!still_held || run.sim.pose_at(run.now()) == before, "seed {seed}: it moved while held");
            }
        }
        bring_to_the_end(&mut run, seed);
        check(&mut run, &hall, seed);
    }
}

fn any_command(dice: &mut Stream, run: &mut Run) -> Command {
    let pending = run.state().pending().map_or(1, |luggage| luggage.id.0);
    let verdict = if dice.below(12) == 0 { Verdict::Danger } else { Verdict::Safe };
    let moves = [Move::Forward, Move::Backward, Move::TurnLeft, Move::TurnRight, Move::NudgeLeft];
    match dice.below(16) {
        0..=3 => Command::Start,
        4 => Command::Stop,
        5 => Command::BackHome,
        6..=7 => Command::Verdict { luggage: LuggageRef::Id(LuggageId(pending)), verdict },
        8 => Command::Verdict { luggage: LuggageRef::Pending, verdict },
        9 => Command::Temperature(TemperatureReport::TooHigh),
        10 => Command::Temperature(TemperatureReport::Ok),
        11 => Command::Temperature(TemperatureReport::Reading(Celsius::new(20.0 + 8.0 * dice.fraction()).unwrap())),
        12 => Command::Move(moves[dice.below(5) as usize]),
        13 => Command::Goto(Cell::new(dice.below(12) as i32 - 2, dice.below(12) as i32 - 2)),
        14 => Command::RetakePhoto(LuggageId(pending)),
        _ => match dice.below(4) {
            0 => Command::Reset,
            1 => Command::Acknowledge(AlarmId(1)),
            2 => Command::Retrieve,
            _ => Command::ChooseStrategy(Default::default()),
        },
    }
}

/// A refused command changes nothing but the log; an accepted start leaves no hold; a stop always holds.
fn give_and_check(run: &mut Run, command: Command, seed: u64) {
    let before = run.state();
    let result = run.give(command.clone());
    let after = run.state();
    if result.is_err() {
        assert_eq!(before.mission, after.mission, "seed {seed}: {command:?} was refused but changed the mission");
        assert_eq!(before.robot, after.robot, "seed {seed}: {command:?} was refused but moved the robot");
    }
    if command == Command::Stop {
        assert!(result.is_ok() && after.mission.holds.contains(&Hold::Operator), "seed {seed}");
        assert!(after.mission.epoch > before.mission.epoch, "seed {seed}");
    }
    if command == Command::Start && result.is_ok() {
        assert!(after.mission.holds.is_empty(), "seed {seed}: an accepted start leaves nothing that holds");
    }
}

fn check(run: &mut Run, hall: &Hall, seed: u64) {
    let state = run.state();
    let moving = !matches!(state.robot.state, RobotState::Stopped | RobotState::TakingPhoto | RobotState::SendingPhoto);
    assert!(!moving || state.mission.holds.is_empty(), "seed {seed}: told to move while held by {:?}", state.mission.holds);
    let into = state.map.at(state.robot.pose.ahead());
    let drives_ahead = state.robot.state == RobotState::MovingForward && !state.robot.off_centre;
    assert!(!drives_ahead || !matches!(into, Mark::Wall | Mark::Luggage), "seed {seed}: driven into a known obstacle");
    assert_eq!(hall.truth(state.robot.pose.cell), Truth::Free, "seed {seed}: it stands in an obstacle");
    let bounds = state.map.known_bounds();
    for (x, y) in (bounds.least.x..=bounds.most.x).flat_map(|x| (bounds.least.y..=bounds.most.y).map(move |y| (x, y))) {
        let cell = Cell::new(x, y);
        let free = hall.truth(cell) == Truth::Free;
        let mark = state.map.at(cell);
        assert!(mark == Mark::Unknown || (mark == Mark::Visited) == free, "seed {seed}: the map is wrong at {cell}");
        assert!(mark != Mark::Wall || hall.truth(cell) == Truth::Wall, "seed {seed}: no wall at {cell}");
    }
}

/// Cools the hall, answers what waits, presses START: the search ends explored, or at home with the bomb located and the LED off.
fn bring_to_the_end(run: &mut Run, seed: u64) {
    run.reading(20.0).unwrap();
    run.temperature(TemperatureReport::Ok).unwrap();
    for _ in 0..20_000 {
        let state = run.state();
        match state.mission.phase {
            PhaseName::Explored | PhaseName::BombLocated => {
                assert!(state.robot.pose.cell == Cell::HOME && !run.sim.led(), "seed {seed}: ended away from home or blinking");
                return;
            }
            _ => {}
        }
        let waits = state.pending().filter(|luggage| luggage.has_photo()).map(|luggage| luggage.id.0);
        let gave = match waits {
            Some(id) => run.verdict(id, Verdict::Safe).is_ok(),
            None if state.mission.refusals.retake.is_none() => {
                run.give(Command::RetakePhoto(state.mission.inspected.unwrap())).is_ok()
            }
            None if !state.mission.holds.is_empty() || matches!(state.mission.phase, PhaseName::Idle | PhaseName::AtHome) => {
                run.give(Command::Start).is_ok()
            }
            None => false,
        };
        assert!(gave || run.advance(), "seed {seed}: stuck in {:?} held by {:?}", state.mission.phase, state.mission.holds);
    }
    panic!("seed {seed}: the mission did not come to its end; it is {:?}", run.phase());
}
