//! Tests of a machine's clock that is set while the program runs, or while it is off.

use super::*;
use crate::engine::recall::{Recalled, RememberedLine};
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;

fn recorded(engine: &mut Engine) -> Vec<Fact> {
    let mut facts = Vec::new();
    while let Some(effect) = engine.poll_effect() {
        if let Effect::Record(page) = effect {
            engine.handle_event(Event::Recorded(page.last()), now(1));
            facts.extend(page.entries.into_iter().map(|entry| entry.fact));
        }
    }
    facts
}

fn waits_since(engine: &Engine) -> i64 {
    engine.persistent_state().luggage.get(LuggageId(1)).expect("it is there").waits_since().unix_ms
}

#[test]
fn a_clock_that_is_set_is_on_record_once_before_what_follows_and_a_piece_waits_as_long_as_it_did() {
    let mut engine = sweep_in(PhaseName::Inspecting, &[]);
    for small in [1999, -1999] {
        engine.note_clock(small, now(1));
    }
    assert_eq!(recorded(&mut engine), []);
    engine.note_clock(-600_000, now(1));
    engine.note_clock(-600_000, now(1));
    let safe = Request::new(command(Input::Safe).expect("a command"), Issuer::operator(Door("test")));
    engine.handle_command(safe, now(1)).expect("it may be given");
    assert_eq!(waits_since(&engine), -600_000);
    let facts = recorded(&mut engine);
    assert_eq!(facts[0], Fact::ClockSet(-600_000));
    assert_eq!(facts.iter().filter(|fact| matches!(fact, Fact::ClockSet(_))).count(), 1);
    engine.note_clock(3_000_000, now(2));
    assert_eq!(recorded(&mut engine), [Fact::ClockSet(3_600_000)]);
    assert_eq!(waits_since(&engine), -600_000, "it does not wait any more");
    assert_eq!(engine.snapshot().mission.clock_set_ms, 3_000_000);
}

#[test]
fn a_reading_and_a_lost_link_are_as_old_after_the_clock_was_set_as_before() {
    let mut engine = sweep_in(PhaseName::Inspecting, &[]);
    let at = |seconds| Now { wall: WallTime { unix_ms: 1000 * i64::from(seconds), offset_s: 0 }, ..now(u64::from(seconds)) };
    let shown = |engine: &mut Engine| {
        let snapshot = engine.snapshot();
        (snapshot.temperature.read.map(|read| read.unix_ms), snapshot.robot.unreached_since.map(|since| since.unix_ms))
    };
    let reading = Celsius::new(21.0).expect("it is believable");
    engine.handle_event(Event::Robot(RobotId::discovery(), RobotEvent::Temperature(reading)), at(1_u8));
    engine.handle_event(Event::Robot(RobotId::discovery(), RobotEvent::LinkLost("cable".into())), at(2));
    let (read, lost) = shown(&mut engine);
    assert!(read.is_some() && lost.is_some());
    engine.note_clock(46_800_000, at(3));
    assert_eq!(shown(&mut engine), (read.map(|ms| ms + 46_800_000), lost.map(|ms| ms + 46_800_000)));
}

#[test]
fn a_clock_that_was_set_back_while_the_program_was_off_is_on_record_before_its_start() {
    let line = RememberedLine { wall: WallTime { unix_ms: 100_000, offset_s: 0 }, tone: Tone::Info, said: Said::StartedAgain };
    let at = |unix_ms| Now { wall: WallTime { unix_ms, offset_s: 0 }, ..now(0) };
    for (began, back) in [(40_000, Some(-60_000)), (99_000, None), (5_000_000, None)] {
        let state = sweep_in(PhaseName::Inspecting, &[]).persistent_state();
        let recalled =
            Recalled { state, written: Seq(9), commands: Vec::new(), kept_back: Vec::new(), latest: vec![line.clone()] };
        let mut engine = Engine::recall(Settings::default(), "again".into(), recalled, at(began));
        let facts = recorded(&mut engine);
        let set = facts.iter().find_map(|fact| if let Fact::ClockSet(by_ms) = fact { Some(*by_ms) } else { None });
        assert_eq!(set, back, "{began}");
        assert!(back.is_none() || matches!(facts[..2], [Fact::ClockSet(_), Fact::ProgramStarted(_)]), "{facts:?}");
    }
}

#[test]
fn a_piece_whose_photo_is_taken_again_waits_since_the_first_of_them() {
    let mut engine = sweep_in(PhaseName::Inspecting, &[]);
    engine.note_clock(-600_000, now(1));
    recorded(&mut engine);
    let at = |seconds| Now { wall: WallTime { unix_ms: 90_000, offset_s: 0 }, ..now(seconds) };
    let again = Request::new(Command::RetakePhoto(LuggageId(1)), Issuer::operator(Door("test")));
    engine.handle_command(again, at(60)).expect("it may be given");
    let mut order = None;
    while let Some(effect) = engine.poll_effect() {
        match effect {
            Effect::Order(_, ordered) => order = Some(ordered.id),
            Effect::Record(page) => engine.handle_event(Event::Recorded(page.last()), at(60)),
            Effect::Halt(_) | Effect::Led(..) | Effect::Answer(..) => {}
        }
    }
    let photo = crate::event::Photo { bytes: [0].as_slice().into(), media_type: "image/png" };
    let taken = RobotEvent::Photo(order.expect("a photo is ordered"), photo);
    engine.handle_event(Event::Robot(RobotId::discovery(), taken), at(61));
    let facts = recorded(&mut engine);
    assert!(
        facts.iter().any(|fact| matches!(fact, Fact::Luggage { record, .. } if record.first_taken != record.taken)),
        "{facts:?}"
    );
    let known = engine.persistent_state().luggage.get(LuggageId(1)).map(Arc::clone).expect("it is there");
    assert_eq!((known.taken.unix_ms, known.photo.clone()), (90_000, PhotoState::Taken { bytes: 1, take: 2 }));
    assert_eq!(waits_since(&engine), -600_000, "by the clock as it was set meanwhile");
}
