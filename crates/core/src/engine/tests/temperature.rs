//! Tests of past temperatures that are read from the journal.

use super::*;
use crate::command::OPERATOR;
use crate::engine::Past;
use crate::engine::recall::Recalled;
use crate::state::fact::Entry;

struct Kept {
    engine: Engine,
    entries: Vec<Entry>,
}

impl Kept {
    fn at(second: i64) -> Now {
        let wall = WallTime { unix_ms: 1_000_000 + 1000 * second, offset_s: 0 };
        Now { wall, ..now(second.unsigned_abs()) }
    }

    fn report(&mut self, report: RobotEvent, second: i64) {
        self.engine.handle_event(Event::Robot(RobotId::discovery(), report), Kept::at(second));
        self.check(second);
    }

    fn give(&mut self, command: Command, second: i64) {
        let request = Request::new(command, Issuer::operator(Door("test")));
        self.engine.handle_command(request, Kept::at(second)).expect("it may be given");
        self.keep(second);
    }

    fn restart(&mut self, second: i64) {
        let (state, written) = (self.engine.persistent_state(), Seq(self.entries.len() as u64));
        let recalled = Recalled { state, written, commands: Vec::new(), kept_back: Vec::new(), latest: Vec::new() };
        self.engine = Engine::recall(Settings::default(), "again".into(), recalled, Kept::at(second));
        self.check(second);
    }

    /// Checks that a later view of this moment shows the same as the view at that time.
    fn check(&mut self, second: i64) {
        self.keep(second);
        let past = Past {
            seq: Seq(0),
            state: self.engine.persistent_state(),
            trail: Vec::new(),
            temperatures: self.entries.clone(),
            latest: Vec::new(),
        };
        let (then, live) = (past.reading(), self.engine.snapshot().temperature.clone());
        assert_eq!(then.map(|then| then.celsius), live.celsius, "after {second} s");
        let ages = then.map(|then| (then.read, then.silent_since)).unwrap_or_default();
        assert_eq!(ages, (live.read, live.silent_since), "after {second} s");
    }

    fn keep(&mut self, second: i64) {
        while let Some(effect) = self.engine.poll_effect() {
            if let Effect::Record(page) = effect {
                self.engine.handle_event(Event::Recorded(page.last()), Kept::at(second));
                self.entries.extend(page.entries);
            }
        }
    }
}

fn celsius(degrees: f64) -> Celsius {
    Celsius::new(degrees).expect("the tests use believable temperatures")
}

fn said(degrees: f64) -> Command {
    Command::Temperature(TemperatureReport::Reading(celsius(degrees)))
}

#[test]
fn what_was_known_of_the_temperature_is_shown_later_as_it_was_shown_then() {
    let read = |degrees| RobotEvent::Temperature(celsius(degrees));
    let mut kept = Kept { engine: sweep_in(PhaseName::Idle, &[]), entries: Vec::new() };
    kept.report(read(21.5), 1);
    kept.engine.handle_timeout(Kept::at(40));
    kept.check(40);
    let is_silent = |kept: &Kept| kept.entries.iter().any(|entry| entry.fact == Fact::ThermometerSilent("robot".into()));
    assert!(is_silent(&kept), "30 s are over, and its link is up");
    kept.report(read(21.5), 50);
    kept.report(RobotEvent::LinkLost("cable".to_owned()), 55);
    kept.give(said(24.0), 60);
    kept.check(60);
    kept.restart(70);
    assert!(kept.engine.snapshot().temperature.silent_since.is_some(), "how old the operator's is nobody knows");
    kept.report(read(20.0), 80);
    kept.engine.note_clock(600_000, Kept::at(81));
    kept.check(81);
    kept.give(said(22.0), 90);
    kept.check(90);
    kept.engine.handle_timeout(Kept::at(130));
    kept.check(130);
    assert_eq!(kept.engine.snapshot().temperature.celsius, Some(celsius(22.0)), "the robot's is not known");
    kept.report(read(19.0), 140);
    kept.restart(150);
    assert!(kept.engine.snapshot().temperature.silent_since.is_some(), "nobody has read anything since the start");
}

#[test]
fn what_an_operator_said_before_a_mission_is_no_reading_of_it() {
    let mut kept = Kept { engine: sweep_in(PhaseName::Idle, &[]), entries: Vec::new() };
    kept.give(said(22.0), 1);
    kept.report(RobotEvent::Temperature(celsius(21.5)), 2);
    kept.give(Command::Start, 20);
    let began = kept.entries.iter().position(|entry| matches!(entry.fact, Fact::MissionBegan(..))).expect("it began");
    let read = |source: &str, degrees| Fact::Temperature(source.into(), celsius(degrees));
    let holds = |fact| kept.entries[began..].iter().any(|entry| entry.fact == fact);
    assert!(holds(read("robot", 21.5)) && !holds(read(OPERATOR, 22.0)));
}
