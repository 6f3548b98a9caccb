//! Tests every phase with every command and event. The outcomes are written by hand from mission §4, independently of
//! the table in the code. Rules for all phases are tested further below: what clears which hold, what blinks, what is
//! recorded.

use super::*;
use crate::closing::OpenInArea;
use crate::settings::AfterDanger;
use crate::state::fact::Fact;
use crate::world::hall_map::Mark;

/// The commands that have a column in the tables below. The other commands are accepted in every phase and do not
/// change the phase: OK, a reading, a sensor's reading, the acknowledgement of an alarm and the order of the areas. A
/// hand-over and the end of an area are accepted in every phase while a mission is under way, as it is here.
const COLUMNS: [Input; 16] = [
    Input::Start,
    Input::Stop,
    Input::BackHome,
    Input::GoOn,
    Input::Safe,
    Input::Danger,
    Input::Unsure,
    Input::TemperatureTooHigh,
    Input::Retrieve,
    Input::Reset,
    Input::Close,
    Input::SearchAgain,
    Input::Move,
    Input::Goto,
    Input::RetakePhoto,
    Input::Strategy,
];

/// The outcomes while a piece with a usable photo waits for its verdict. `.` means that the phase stays, a short
/// name is the new phase after all records are stored, and `!` is a refusal. In `a/b`, `a` is the outcome without a
/// hold, and `b` the outcome after STOP.
const PENDING: &str = "
    id ex  .  !np !np .  .  !ni .  !np !vp     !np !np dr     dr     !np .
    ex !vp .  rh  !vp .  ra !ni .  !np !mv/!vp !np !vp !ns/dr !ns/dr !np !np
    in !vp .  rh  !vp ex ra .   .  !np !vp     !np !vp !np    !np    .   !np
    dr !dr ex !dr !dr .  .  !ni ex !np !mv     !np !dr !dr    !dr    !np !np
    rh .   .  .   !np .  ra !ni .  !np !mv/!vp !np !np !ns/dr !ns/dr !np !np
    ah !vp .  .   !vp .  bl !ni .  !np !vp     .   !vp dr     dr     !np !np
    ra .   .  !np !np .  .  !ni .  !np !mv/!vp !np !np !ns/dr !ns/dr !np !np
    bl !np .  !np !vp .  .  !ni .  !nr !vp     .   !vp !np    !np    !np !np
    re .   .  !np !np .  .  !ni .  !np !mv/!vp !np !np !np    !np    !np !np
    bs !vp .  !np !vp .  bl !ni .  !np !vp     .   !vp !np    !np    !np .
    ed !vp .  !np !np .  bl !ni .  !np !vp     .   !vp !np    !np    !np .
    fa !vp .  !np !np .  .  !ni .  !np !vp     .   !np !np    !np    !np !np
";

/// Like `PENDING`, but the verdict on this piece is safe.
const DECIDED: &str = "
    id ex  .  !np !np . !de !de .  !np .      !np !np dr     dr     !np .
    ex .   .  rh  .   . !de !de .  !np !mv/id !np .   !ns/dr !ns/dr !np !np
    in .   .  rh  .   . !de !de .  !np id     !np .   !np    !np    !ni !np
    dr !dr ex !dr !dr . !de !de ex !np !mv    !np !dr !dr    !dr    !np !np
    rh .   .  .   !np . !de !de .  !np !mv/id !np !np !ns/dr !ns/dr !np !np
    ah ex  .  .   ex  . !de !de .  !np id     .   ex  dr     dr     !np !np
    ra .   .  !np !np . !de !de .  !np !mv/id !np !np !ns/dr !ns/dr !np !np
    bl !np .  !np ex  . !de !de .  !nr id     .   ex  !np    !np    !np !np
    re .   .  !np !np . !de !de .  !np !mv/id !np !np !np    !np    !np !np
    bs ex  .  !np ex  . !de !de .  !np id     .   ex  !np    !np    !np .
    ed ex  .  !np !np . !de !de .  !np id     .   ex  !np    !np    !np .
    fa ex  .  !np !np . !de !de .  !np id     .   !np !np    !np    !np !np
";

/// The events that lead from one phase to another. In all other phases, these events change nothing.
const EVENTS: &[(Input, &str)] = &[
    (Input::Blocked, "ex>in"),
    (Input::AtPiece, "ex>in"),
    (Input::SafeRecorded, "in>ex"),
    (Input::DangerRecorded, "ex>ra in>ra rh>ra ah>bl bs>bl ed>bl"),
    (Input::CameHome, "rh>ah ra>bl"),
    (Input::AllExplored, "ex>ed"),
    (Input::DriveEnded, "dr>ex"),
    // `moment` lets the LED blink, so the search is under way.
    (Input::Secured, "re>ah"),
    (Input::NotFetched, "re>fa"),
    (Input::NoWayHome, "ex>fa rh>fa ra>fa"),
    (Input::Unanswered, "id>fa ex>fa in>fa dr>fa rh>fa ah>fa ra>fa bl>fa re>fa bs>fa ed>fa"),
    (Input::RobotFailed, "id>fa ex>fa in>fa dr>fa rh>fa ah>fa ra>fa bl>fa re>fa bs>fa ed>fa"),
    (Input::LinkLost, "dr>ex"),
    (Input::Heat, "dr>ex"),
    (Input::SensorSilent, "dr>ex"),
    (Input::StoreFailed, "dr>ex"),
    (Input::Restarted, "dr>ex"),
    (Input::Done, ""),
    (Input::PhotoTaken, ""),
    (Input::PhotoFailed, ""),
    (Input::LuggageRecorded, ""),
    (Input::LinkUp, ""),
    (Input::Cool, ""),
    (Input::SensorBack, ""),
    (Input::StoreRestored, ""),
];

const CAUSES: [(Hold, Input, Input); 4] = [
    (Hold::RobotLink, Input::LinkLost, Input::LinkUp),
    (Hold::Temperature, Input::Heat, Input::Cool),
    (Hold::TemperatureStale, Input::SensorSilent, Input::SensorBack),
    (Hold::Store, Input::StoreFailed, Input::StoreRestored),
];

fn named(short: &str) -> PhaseName {
    match short {
        "id" => PhaseName::Idle,
        "ex" => PhaseName::Exploring,
        "in" => PhaseName::Inspecting,
        "dr" => PhaseName::Driving,
        "rh" => PhaseName::ReturningHome,
        "ah" => PhaseName::AtHome,
        "ra" => PhaseName::ReturningWithAlarm,
        "bl" => PhaseName::BombLocated,
        "re" => PhaseName::Retrieving,
        "bs" => PhaseName::BagSecured,
        "ed" => PhaseName::Explored,
        "fa" => PhaseName::Fault,
        other => panic!("no phase is called {other}"),
    }
}

fn code(short: &str) -> &'static str {
    match short {
        "np" => "notInPhase",
        "vp" => "verdictPending",
        "mv" => "moving",
        "ns" => "notStopped",
        "dr" => "driving",
        "de" => "decided",
        "ni" => "notInspected",
        "nr" => "noRetrievalRobot",
        other => panic!("no refusal is called {other}"),
    }
}

/// Returns the text of a cell of the table: the outcome after STOP if `stopped`, otherwise the outcome without a
/// hold.
fn cell(table: &'static str, phase: PhaseName, input: Input, stopped: bool) -> &'static str {
    let Some(column) = COLUMNS.into_iter().position(|known| known == input) else { return "." };
    let line = table.lines().find(|line| line.split_whitespace().next().is_some_and(|short| named(short) == phase));
    let cell = line.and_then(|line| line.split_whitespace().nth(column + 1)).expect("every cell is written");
    let (free, held) = cell.split_once('/').unwrap_or((cell, cell));
    if stopped { held } else { free }
}

/// Returns the meaning of a cell: the new phase, or the code of the refusal.
fn meant(cell: &'static str, phase: PhaseName) -> Result<PhaseName, &'static str> {
    match (cell, cell.strip_prefix('!')) {
        (_, Some(refusal)) => Err(code(refusal)),
        (".", None) => Ok(phase),
        (short, None) => Ok(named(short)),
    }
}

/// Mission §4: a movement command is refused while a hold is active that the command does not clear, unless the phase
/// already refuses the command. The refusal names the holds. With the hold `store`, commands that need a record are
/// refused too.
fn expected(table: &'static str, phase: PhaseName, input: Input, holds: &[Hold]) -> Result<PhaseName, &'static str> {
    let stopped = meant(cell(table, phase, input, true), phase);
    let moves = [Input::Start, Input::BackHome, Input::GoOn, Input::SearchAgain, Input::Retrieve, Input::Move, Input::Goto];
    let moves = moves.contains(&input);
    let recorded = [Input::Safe, Input::Danger, Input::TemperatureOk, Input::TemperatureTooHigh, Input::Reading, Input::Reset];
    let recorded = recorded.contains(&input)
        || [Input::Acknowledge, Input::Strategy, Input::Unsure, Input::Close, Input::HandOver].contains(&input)
        || [Input::OrderAreas, Input::CloseArea].contains(&input);
    let repeat = input == Input::Safe && table == DECIDED;
    match holds {
        [] => meant(cell(table, phase, input, false), phase),
        [Hold::Operator, ..] => stopped,
        _ if moves && !matches!(stopped, Err("notInPhase" | "driving")) => Err("held"),
        [Hold::Store, ..] if recorded && !repeat && stopped.is_ok() => Err("storeDown"),
        [Hold::Store, ..] if input == Input::RetakePhoto && stopped.is_ok() => Err("held"),
        _ => stopped,
    }
}

/// Returns the engine in this phase. In phases where the robot waits, the robot is at home; otherwise it is one cell
/// to the south. One alarm is recorded, and a sensor is configured. The piece has a verdict if the table is
/// `DECIDED`. At (1, 1) is an obstacle that was not inspected.
fn moment(name: PhaseName, table: &'static str, holds: &[Hold]) -> Engine {
    let mut engine = sweep_in(name, &[]);
    let waits = [PhaseName::Idle, PhaseName::AtHome, PhaseName::BombLocated, PhaseName::BagSecured, PhaseName::Explored];
    if waits.contains(&name) {
        engine.state.pose = Pose::START;
    }
    engine.state.under_way = true;
    engine.mark(Cell::new(1, 1), Mark::NotInspected);
    engine.mark(Cell::new(1, 0), Mark::Visited);
    engine.watchdog.begin("roof".into(), Duration::from_secs(3600));
    engine.watchdog.hear("roof", Duration::ZERO);
    engine.record(Fact::AlarmRaised(AlarmId(1), None, crate::world::alarm::AlarmCause::Other("something".to_owned())));
    engine.state.led_blinking = true;
    if table == DECIDED {
        let decision = crate::world::luggage::Decision {
            verdict: Verdict::Safe,
            who: Issuer::operator(Door::LOCAL).who,
            wall: WallTime::default(),
            note: None,
            hot: Default::default(),
        };
        let luggage = Luggage { verdict: Some(decision), ..Luggage::clone(&engine.state.luggage[0]) };
        engine.state.luggage.insert(Arc::new(luggage));
    }
    engine.record_state();
    while let Some(effect) = engine.poll_effect() {
        if let Effect::Record(page) = effect {
            engine.outbox.keep(page.last());
        }
    }
    engine.look();
    for hold in holds {
        engine.state.holds.raise(*hold);
    }
    engine
}

const HOLDS: [&[Hold]; 5] = [
    &[],
    &[Hold::Operator, Hold::Restart, Hold::AwaitingStart],
    &[Hold::TooHigh, Hold::AwaitingStart],
    &[Hold::Temperature, Hold::AwaitingStart],
    &[Hold::Store, Hold::AwaitingStart],
];

/// Mission §4: the outcome of every command in every phase. Safety S5: nothing passes the gate while a hold is
/// active.
#[test]
fn every_command_in_every_phase_does_what_the_mission_says() {
    for table in [PENDING, DECIDED] {
        for name in PhaseName::ALL {
            for input in Input::COMMANDS {
                // Any hold ends a drive by hand, so the phase driving never has a hold.
                for holds in HOLDS.into_iter().filter(|holds| holds.is_empty() || name != PhaseName::Driving) {
                    check_command(table, name, input, holds);
                }
            }
        }
    }
}

fn check_command(table: &'static str, name: PhaseName, input: Input, holds: &'static [Hold]) {
    let pair = format!("{name:?} × {input:?} under {holds:?}, {}", if table == DECIDED { "decided" } else { "pending" });
    let mut engine = moment(name, table, holds);
    let before = engine.clone();
    let mut command = command(input).expect("every input of COMMANDS is a command");
    if let Command::Close(closing) = &mut command {
        let open = before.open_points(&before.state.map, &before.state.luggage, before.state.again.len());
        closing.seen = open.code(before.state.mission).into();
    }
    let request = Request::new(command, Issuer::operator(Door::LOCAL));
    let answer = engine.handle_command(request, now(1)).map_err(|refused| refused.code());
    let moves = settle(&mut engine).into_iter().any(Action::is_motion);
    assert!(!moves || engine.state.holds.is_empty(), "{pair}: moved while held");
    let expected = expected(table, name, input, holds);
    assert_eq!(answer.map(|_| engine.state.phase.name()), expected, "{pair}");
    match expected {
        Ok(_) => check_effects(&before, &engine, input, table, &pair),
        Err(_) => {
            assert_eq!(before.state.phase, engine.state.phase, "{pair}");
            let cleared = before.state.holds.to_vec().into_iter().any(|hold| !engine.state.holds.contains(hold));
            assert!(!cleared, "{pair}: what was refused cleared a hold");
            let raises = input == Input::TemperatureTooHigh && engine.state.holds.contains(Hold::TooHigh);
            let alarms = input == Input::Danger && holds.first() == Some(&Hold::Store) && table == PENDING;
            assert!(raises || alarms || before.state.holds == engine.state.holds, "{pair}");
            assert_eq!(alarms, engine.state.holds.contains(Hold::Alarm), "{pair}: danger that could not be recorded holds");
            assert_eq!(alarms, engine.state.alarms.len() > before.state.alarms.len(), "{pair}: and alarms");
        }
    }
}

/// Checks what an accepted command does in addition to the change of the phase (mission §4).
#[expect(clippy::wildcard_enum_match_arm, reason = "whatever has no sentence of its own does nothing beside the phase")]
fn check_effects(before: &Engine, after: &Engine, input: Input, table: &str, pair: &str) {
    let (was, is) = (&before.state.holds, &after.state.holds);
    let waits = [Hold::Operator, Hold::Restart, Hold::AwaitingStart];
    let verdict = after.state.luggage.get(LuggageId(1)).and_then(|luggage| luggage.verdict.as_ref()).map(|kept| kept.verdict);
    match input {
        Input::SearchAgain => assert!(after.state.again.contains(&Cell::new(1, 0)), "{pair}"),
        Input::Start | Input::BackHome | Input::GoOn | Input::Retrieve | Input::Move | Input::Goto | Input::Reset => {
            assert!(!waits.into_iter().any(|hold| is.contains(hold)), "{pair}: it clears what waits for it");
        }
        Input::Stop => {
            assert!(is.contains(Hold::Operator) && after.state.epoch > before.state.epoch, "{pair}: STOP holds");
        }
        Input::TemperatureTooHigh => assert!(is.contains(Hold::TooHigh), "{pair}"),
        Input::TemperatureOk => assert!(!is.contains(Hold::TooHigh), "{pair}"),
        Input::Safe => assert_eq!(verdict, Some(Verdict::Safe), "{pair}"),
        Input::Danger => assert_eq!(verdict, Some(Verdict::Danger), "{pair}"),
        Input::Unsure => assert_eq!(after.state.luggage[0].unsure.len(), 1, "{pair}"),
        Input::Close => assert!(after.state.closed.is_some(), "{pair}"),
        Input::HandOver => {
            assert_eq!((&before.state.luggage, was), (&after.state.luggage, is), "{pair}: nothing follows from it")
        }
        Input::OrderAreas => assert_eq!(*after.state.area_order, ["gate".into()], "{pair}"),
        Input::CloseArea => {
            let open = after.state.closed_areas["gate"].open;
            let pending = after.state.luggage.pending().count();
            assert_eq!(open, OpenInArea { cells: 1, pending }, "{pair}: the piece is in the cell that was not visited");
        }
        Input::Acknowledge => assert!(after.state.alarms[0].acknowledged.is_some(), "{pair}"),
        Input::Reading | Input::SensorReading => assert!(after.world.thermometer.last.is_some(), "{pair}"),
        Input::RetakePhoto => assert_eq!(after.stage(), Some(Stage::RetakingPhoto(LuggageId(1))), "{pair}"),
        _ => {}
    }
    let cool = [Input::Reading, Input::SensorReading].contains(&input);
    let ended = |hold: Hold| match hold {
        Hold::TooHigh => input == Input::TemperatureOk,
        Hold::Temperature => cool,
        Hold::Operator | Hold::Restart | Hold::AwaitingStart => true,
        _ => false,
    };
    let stands = was.to_vec().into_iter().filter(|hold| !ended(*hold)).all(|hold| is.contains(hold));
    assert!(stands, "{pair}: nothing else is cleared");
    let ended = [PhaseName::Explored, PhaseName::BagSecured].contains(&before.phase_name());
    let begins = input == Input::Start && (ended || before.phase_name() == PhaseName::Idle);
    assert_eq!(after.state.mission.0 - before.state.mission.0, u64::from(begins), "{pair}: a mission begins");
    let fresh = begins && ended || input == Input::Reset && before.is_home();
    let known = |engine: &Engine| engine.state.map.at(Cell::new(1, 1)) == Mark::NotInspected;
    assert_eq!(known(after), !fresh, "{pair}: the map is emptied for a new search, and at home");
    let away = begins && ended || input == Input::Reset;
    assert_eq!(after.state.luggage.is_empty(), away, "{pair}: luggage is put away with its mission");
    let ends = input == Input::Reset || input == Input::Danger && table == PENDING;
    assert_eq!(after.state.led_blinking, !ends, "{pair}: the LED");
}

/// Mission §4: the outcome of every event in every phase. It checks the new phase, the holds that begin and end, and
/// what danger does.
#[test]
fn every_event_in_every_phase_does_what_the_mission_says() {
    for name in PhaseName::ALL {
        for input in Input::EVENTS {
            check_event(name, input);
        }
    }
}

fn check_event(name: PhaseName, input: Input) {
    let pair = format!("{name:?} × {input:?}");
    let ends = CAUSES.into_iter().find(|(_, _, end)| *end == input).map(|(hold, _, _)| hold);
    let mut engine = moment(name, PENDING, &ends.into_iter().collect::<Vec<_>>());
    let context = InputContext {
        luggage: Some(LuggageId(1)).filter(|_| input != Input::Blocked),
        cell: Some(Cell::new(1, 1)),
        words: Some("a test".to_owned()),
        ..InputContext::default()
    };
    if input == Input::DangerRecorded {
        engine.state.holds.raise(Hold::Operator);
    }
    engine.feed(input, &context);
    let (_, leads) = EVENTS.iter().find(|(known, _)| *known == input).expect("every event is written");
    let lead = leads.split_whitespace().filter_map(|lead| lead.split_once('>')).find(|(from, _)| named(from) == name);
    assert_eq!(engine.phase_name(), lead.map_or(name, |(_, to)| named(to)), "{pair}");
    let holds = &engine.state.holds;
    assert!(ends.is_none_or(|hold| !holds.contains(hold)), "{pair}: the cause has ended");
    let raised = CAUSES.into_iter().find(|(_, begin, _)| *begin == input).map(|(hold, _, _)| hold);
    let raised = raised.or(Some(Hold::Restart).filter(|_| input == Input::Restarted));
    assert!(raised.is_none_or(|hold| holds.contains(hold)), "{pair}: it holds");
    let mission = ![PhaseName::Idle, PhaseName::Explored, PhaseName::BagSecured].contains(&name);
    assert!(raised.is_none() || holds.contains(Hold::AwaitingStart) == mission, "{pair}: a mission then waits for a START");
    let drive_ends = name == PhaseName::Driving && (raised.is_some() || input == Input::DriveEnded);
    assert_eq!(holds.contains(Hold::Operator), drive_ends || input == Input::DangerRecorded, "{pair}: no drive goes on unasked");
    let over = input == Input::DangerRecorded || input == Input::AllExplored && name == PhaseName::Exploring;
    assert_eq!(engine.state.led_blinking, !over, "{pair}: the LED blinks until the search is over");
    let alarms = engine.state.alarms.iter().filter(|alarm| alarm.luggage == Some(LuggageId(1))).count();
    assert_eq!(alarms, usize::from(input == Input::DangerRecorded), "{pair}: danger alarms");
}

/// Mission §4, rule 4: in a fault, and during a drive by hand, verdicts act on the interrupted phase.
#[test]
fn a_verdict_acts_on_the_phase_that_was_interrupted() {
    for name in [PhaseName::Driving, PhaseName::Fault] {
        let mut engine = moment(name, PENDING, &[]);
        engine.feed(Input::DangerRecorded, &InputContext { luggage: Some(LuggageId(1)), ..InputContext::default() });
        assert_eq!(engine.phase_name(), name);
        assert_eq!(engine.state.phase.underlying().name(), PhaseName::ReturningWithAlarm, "{name:?}");
    }
}

/// Mission §4, rule 6: after a drive from idle, the phase is idle as before, and no hold waits for START.
#[test]
fn a_drive_from_idle_ends_in_idle_and_waits_for_nobody() {
    for (end, hold) in
        [(Input::DriveEnded, None), (Input::Heat, Some(Hold::Temperature)), (Input::LinkLost, Some(Hold::RobotLink))]
    {
        let mut engine = moment(PhaseName::Driving, DECIDED, &[]);
        engine.state.phase = Phase::Driving { goal: None, next: None, interrupted: Box::new(Phase::Idle) };
        engine.feed(end, &InputContext::default());
        assert_eq!((engine.phase_name(), engine.state.holds.to_vec()), (PhaseName::Idle, hold.into_iter().collect()), "{end:?}");
    }
}

/// Mission §4, rule 4: with `mission.after_danger = "go_on"`, a danger neither ends the search nor sends the robot home.
#[test]
fn where_the_search_goes_on_a_danger_only_alarms() {
    for name in PhaseName::ALL {
        let mut engine = moment(name, PENDING, &[]);
        engine.settings.rules.after_danger = AfterDanger::GoOn;
        engine.feed(Input::DangerRecorded, &InputContext { luggage: Some(LuggageId(1)), ..InputContext::default() });
        let expected = match name {
            PhaseName::Inspecting => PhaseName::Exploring,
            PhaseName::AtHome | PhaseName::BagSecured | PhaseName::Explored => PhaseName::BombLocated,
            PhaseName::Idle
            | PhaseName::Exploring
            | PhaseName::Driving
            | PhaseName::ReturningHome
            | PhaseName::ReturningWithAlarm
            | PhaseName::BombLocated
            | PhaseName::Retrieving
            | PhaseName::Fault => name,
        };
        assert_eq!((engine.phase_name(), engine.state.led_blinking, engine.state.alarms.len()), (expected, true, 2), "{name:?}");
        assert!(![PhaseName::ReturningWithAlarm].contains(&engine.state.phase.underlying().name()) || name == expected);
    }
}

/// Mission §4, rule 7: what follows after a piece is in the container, and after the robot has come home.
#[test]
fn after_a_fetch_the_next_bomb_comes_first_and_then_the_rest_of_the_search() {
    let after = |input, name, bomb: bool, searches: bool| {
        let mut engine = moment(name, PENDING, &[]);
        engine.state.led_blinking = searches;
        if bomb {
            let verdict = Fact::Verdict {
                luggage: LuggageId(1),
                verdict: Verdict::Danger,
                who: "anna".into(),
                note: None,
                hot: Default::default(),
            };
            engine.state.follow(&verdict, WallTime::default(), Revision(1));
        }
        engine.feed(input, &InputContext::default());
        engine.phase_name()
    };
    let secured = |bomb, searches| after(Input::Secured, PhaseName::Retrieving, bomb, searches);
    assert_eq!([secured(true, true), secured(true, false)], [PhaseName::BombLocated; 2]);
    assert_eq!([secured(false, true), secured(false, false)], [PhaseName::AtHome, PhaseName::BagSecured]);
    let explored = |bomb| after(Input::AllExplored, PhaseName::Exploring, bomb, true);
    assert_eq!([explored(true), explored(false)], [PhaseName::BombLocated, PhaseName::Explored]);
    let home = |bomb| after(Input::CameHome, PhaseName::ReturningHome, bomb, true);
    assert_eq!([home(true), home(false)], [PhaseName::BombLocated, PhaseName::AtHome]);
}
