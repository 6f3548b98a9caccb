//! Random commands at random moments in random halls: the rules hold whatever an operator does. A failure prints its
//! seed.

use std::sync::Arc;
use std::time::Duration;

use hallsweep_core::closing::AreaClosing;
use hallsweep_core::command::{Again, Command, Door, Issuer, LuggageRef, Move, Note, Request, TemperatureReport, Verdict};
use hallsweep_core::event::{Event, RobotEvent};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::robot::{RobotId, RobotState};
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{AlarmId, Cell, Celsius, Epoch, LuggageId};
use hallsweep_core::world::hall_map::{Bounds, Mark};
use hallsweep_sim::headless::Run;
use hallsweep_sim::{Hall, SimSettings, Truth};

use crate::halls;
use crate::operator::{Operator, sensor_reads};
use crate::random_halls::in_turn;
use crate::rules_areas::note_areas;

#[test]
fn whatever_the_operator_does_the_rules_hold_and_the_mission_can_be_brought_to_its_end() {
    for seed in 0..400 {
        let hall = halls::random(seed, 9);
        let mut dice = RandomStream::new(seed, "operator");
        let (sim, settings, strategy) = in_turn(seed, Settings::default());
        let mut watch = Watch { has_sonar: settings.sonar_cells > 0, ..Watch::default() };
        let sim = SimSettings { unknown_rate: 0.1, photo_failure_rate: 0.2, ..sim };
        let mut run = Run::new(hall.clone(), sim, settings, strategy);
        let now = run.now();
        note_areas(&mut run.engine, now);
        for _ in 0..120 {
            let command = any_command(&mut dice, &mut run);
            give_and_check(&mut run, &mut watch, &hall, command, seed);
            if dice.below(10) == 0 {
                from_outside(&mut dice, &mut run);
            }
            for _ in 0..dice.below(6) {
                let held = !run.holds().is_empty();
                let before = run.sim.pose_at(run.now());
                run.advance();
                check(&mut run, &hall, seed);
                watch.look(&run.state(), seed);
                let still_held = held && !run.holds().is_empty();
                assert!(!still_held || run.sim.pose_at(run.now()) == before, "seed {seed}: it moved while held");
            }
        }
        bring_to_the_end(&mut run, seed);
        check(&mut run, &hall, seed);
    }
}

pub(crate) fn any_command(dice: &mut RandomStream, run: &mut Run) -> Command {
    let pending = run.state().pending().map_or(1, |luggage| luggage.id.0);
    let verdict = if dice.below(12) == 0 { Verdict::Danger } else { Verdict::Safe };
    let moves = [Move::Forward, Move::Backward, Move::TurnLeft, Move::TurnRight, Move::NudgeLeft];
    match dice.below(16) {
        0..=3 => Command::Start,
        4 => Command::Stop,
        5 => Command::BackHome,
        6..=7 => Command::Verdict { luggage: LuggageRef::Id(LuggageId(pending)), verdict, note: None, hot: Default::default() },
        8 => Command::Verdict { luggage: LuggageRef::Pending, verdict, note: None, hot: Default::default() },
        9 => Command::Temperature(TemperatureReport::TooHigh),
        10 => Command::Temperature(TemperatureReport::Ok),
        11 => Command::Temperature(TemperatureReport::Reading(Celsius::new(20.0 + 8.0 * dice.fraction()).unwrap())),
        12 => Command::Move(moves[dice.below(5) as usize]),
        13 => Command::Goto(Cell::new(dice.below(12) as i32 - 2, dice.below(12) as i32 - 2)),
        14 if dice.below(2) == 0 => Command::RetakePhoto(LuggageId(pending)),
        14 => Command::Unsure { luggage: LuggageRef::Id(LuggageId(pending)), note: None, hot: Default::default() },
        _ => match dice.below(5) {
            0 => Command::Reset,
            1 => any_area(dice),
            2 => Command::Acknowledge(AlarmId(1)),
            3 => Command::Retrieve(None),
            _ => Command::ChooseStrategy(Default::default()),
        },
    }
}

/// A command about an area: by two corners, or by the name of one of `note_areas`.
pub(crate) fn any_area(dice: &mut RandomStream) -> Command {
    let area: Arc<str> = ["west", "east"][dice.below(2) as usize].into();
    match dice.below(6) {
        0 => return Command::OrderAreas(Arc::from([area])),
        1 => {
            let name = Note::new("Rossi").unwrap();
            return Command::CloseArea(AreaClosing { area, name, note: None, mission: None });
        }
        2 => return Command::SearchAgain(Again::Area(area)),
        _ => {}
    }
    let least = Cell::new(dice.below(9) as i32 - 1, dice.below(9) as i32 - 1);
    let most = Cell::new(least.x + dice.below(6) as i32, least.y + dice.below(6) as i32);
    Command::SearchAgain(Again::Within(Bounds { least, most }))
}

/// State that is checked from one moment to the next.
#[derive(Default)]
struct Watch {
    /// Goal of the search when it was interrupted.
    goal: Option<Cell>,
    /// Whether the robot waits for a START.
    waits: bool,
    /// Whether the robot has a sonar. On the way home it may see a better goal.
    has_sonar: bool,
}

impl Watch {
    /// A START before the OK is not remembered: only an accepted START ends the wait.
    fn look(&mut self, state: &Snapshot, seed: u64) {
        let waits = state.mission.holds.contains(&Hold::AwaitingStart);
        assert!(!self.waits || waits, "seed {seed}: something else than an accepted command ended the wait for START");
        self.waits = waits;
    }

    /// An interrupted goal is resumed, unless it was dealt with meanwhile.
    fn resumes(&mut self, before: &Snapshot, after: &Snapshot, hall: &Hall, seed: u64) {
        let away = matches!(before.mission.phase, PhaseName::Exploring | PhaseName::AtHome);
        let (Some(goal), true, PhaseName::Exploring) = (self.goal.take(), away, after.mission.phase) else { return };
        let open = goal != Cell::HOME && !self.has_sonar && matches!(after.map.at(goal), Mark::Unknown | Mark::NotInspected);
        let reachable = hall.reachable();
        let reachable = std::iter::once(goal).chain(goal.neighbours()).any(|cell| reachable.contains(&cell));
        assert!(!open || !reachable || after.mission.goal == Some(goal), "seed {seed}: {goal} became {:?}", after.mission.goal);
    }
}

/// An external event: the link or a sensor fails and returns, or the store fails and recovers.
pub(crate) fn from_outside(dice: &mut RandomStream, run: &mut Run) {
    if dice.below(3) == 0 {
        run.engine.watch_sensor("roof".into(), Duration::from_secs(3600), run.now());
        return drop(run.give(sensor_reads("roof", 20.0)));
    }
    let (gone, back) = match dice.below(2) {
        0 => (Event::StoreFailed("disk full".to_owned()), Event::StoreRestored),
        _ => (robot(RobotEvent::LinkLost("cable".to_owned())), robot(RobotEvent::LinkUp(run.sim.capabilities()))),
    };
    let can_be_cut = !run.sim.is_developing() && !run.sim.is_busy();
    if can_be_cut || !matches!(gone, Event::Robot(..)) {
        run.happen(gone);
        run.happen(back);
    }
}

fn robot(report: RobotEvent) -> Event {
    Event::Robot(RobotId::discovery(), report)
}

/// A refused command changes only the log; an accepted START leaves no hold; a STOP always holds; a command from
/// before the last STOP is outdated.
fn give_and_check(run: &mut Run, watch: &mut Watch, hall: &Hall, command: Command, seed: u64) {
    let epoch = run.state().mission.epoch;
    if epoch > Epoch(0) && command == Command::Start {
        let old = Request { epoch: Some(Epoch(epoch.0 - 1)), ..Request::new(Command::Start, Issuer::operator(Door::LOCAL)) };
        assert!(matches!(run.ask(old), Err(Refused::Outdated { .. })), "seed {seed}: an old START was taken");
    }
    let before = run.state();
    let result = run.give(command.clone());
    let after = run.state();
    if result.is_ok() {
        watch.waits = after.mission.holds.contains(&Hold::AwaitingStart);
        // A drive by hand or round a piece may show more of the hall, and other commands forget the goal.
        let is_drive = matches!(command, Command::Move(_) | Command::Goto(_) | Command::Unsure { .. });
        let is_of_area = matches!(command, Command::SearchAgain(_) | Command::OrderAreas(_) | Command::CloseArea(_));
        if is_drive
            || is_of_area
            || matches!(command, Command::Reset | Command::ChooseStrategy(_))
            || after.mission.id != before.mission.id
        {
            watch.goal = None;
        }
    }
    let halted = after.mission.phase != before.mission.phase || !after.mission.holds.is_empty();
    let explored_on = before.mission.phase == PhaseName::Exploring && before.mission.holds.is_empty();
    if explored_on && halted {
        watch.goal = before.mission.goal;
    }
    if command == Command::Start && result.is_ok() {
        watch.resumes(&before, &after, hall, seed);
    }
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
    let at_home = matches!(state.mission.phase, PhaseName::AtHome | PhaseName::BombLocated | PhaseName::Explored);
    let is_home = state.robot.pose.cell == Cell::HOME && !state.robot.off_centre;
    assert!(!at_home || is_home, "seed {seed}: {:?} away from home", state.mission.phase);
    assert_eq!(hall.truth(state.robot.pose.cell), Truth::Free, "seed {seed}: it stands in an obstacle");
    let bounds = state.map.known_bounds();
    for (x, y) in (bounds.least.x..=bounds.most.x).flat_map(|x| (bounds.least.y..=bounds.most.y).map(move |y| (x, y))) {
        let cell = Cell::new(x, y);
        let free = hall.truth(cell) == Truth::Free;
        let mark = state.map.at(cell);
        assert!(
            mark == Mark::Unknown || matches!(mark, Mark::Visited | Mark::Seen) == free,
            "seed {seed}: the map is wrong at {cell}"
        );
        assert!(mark != Mark::Wall || hall.truth(cell) == Truth::Wall, "seed {seed}: no wall at {cell}");
    }
}

/// Cools the hall, gives the pending verdicts and presses START. The search must end explored, or at home with the
/// bomb located and the LED off.
fn bring_to_the_end(run: &mut Run, seed: u64) {
    run.reading(20.0).unwrap();
    run.temperature(TemperatureReport::Ok).unwrap();
    for _ in 0..20_000 {
        let state = run.state();
        match state.mission.phase {
            PhaseName::Explored | PhaseName::BombLocated => {
                // After a find the LED blinks while cells are to be searched again.
                let is_over = !run.sim.led() || !state.mission.again.is_empty();
                assert!(state.robot.pose.cell == Cell::HOME && is_over, "seed {seed}: ended away from home or blinking");
                return;
            }
            _ => {}
        }
        if state.mission.holds.contains(&Hold::TemperatureStale) {
            run.give(sensor_reads("roof", 20.0)).unwrap();
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
