//! Tests of what is shown while the store is slow (safety R4). Few views wait, nothing is shown early, and nothing
//! contradicts what a button does.

use super::*;
use crate::rng::RandomStream;
use crate::snapshot::Refusals;

fn give(engine: &mut Engine, command: Command) -> Result<Ticket, Refused> {
    engine.handle_command(Request::new(command, Issuer::operator(Door::LOCAL)), now(1))
}

/// Safety R4 and A5.
#[test]
fn at_most_64_views_wait_for_a_store_that_lags_and_none_is_shown_early() {
    let mut engine = sweep_in(PhaseName::Idle, &[]);
    engine.state.luggage = Default::default();
    let mut begun = Vec::new();
    for _ in 0..60 {
        give(&mut engine, Command::Start).unwrap();
        begun.push((engine.written(), engine.state.mission));
        give(&mut engine, Command::Stop).unwrap();
        give(&mut engine, Command::Reset).unwrap();
        assert!(engine.on_record.waiting() <= 64, "{}", engine.on_record.waiting());
    }
    assert_eq!(engine.on_record.waiting(), 64);
    for (nth, (seq, mission)) in begun.iter().enumerate() {
        engine.handle_event(Event::Recorded(*seq), now(1));
        let shown = engine.snapshot().mission.id;
        assert!(shown <= *mission, "{shown:?} is not on record yet");
        assert!(nth >= 20 || shown == *mission, "{mission:?} is on record and was not given up");
    }
    let last = engine.written();
    engine.handle_event(Event::Recorded(last), now(1));
    let state = engine.snapshot();
    assert_eq!((state.mission.id, state.mission.phase), (begun[59].1, PhaseName::Idle), "and the latest is shown in the end");
}

/// Safety R4: a button that is shown as enabled is not refused. Once everything is recorded, a refusal has exactly
/// the words that are shown.
#[test]
fn nothing_that_is_shown_contradicts_a_button() {
    for seed in 0..200 {
        let mut dice = RandomStream::new(seed, "buttons");
        let mut engine = sweep_in(PhaseName::ALL[dice.below(PhaseName::ALL.len() as u64) as usize], &[]);
        let mut kept = engine.written().0;
        for _ in 0..30 {
            let input = Input::COMMANDS[dice.below(Input::COMMANDS.len() as u64) as usize];
            let _ = command(input).map(|command| give(&mut engine, command));
            if dice.below(3) == 0 {
                kept += dice.below(engine.written().0 - kept + 1);
                engine.handle_event(Event::Recorded(Seq(kept)), now(1));
            }
            check_buttons(&mut engine, seed);
        }
    }
}

fn check_buttons(engine: &mut Engine, seed: u64) {
    let state = engine.snapshot();
    // Whether an area can be searched again depends on the area, too.
    let Refusals { start, back_home, go_on, search_again: _, retrieve, reset, drive, strategy, retake } = &state.mission.refusals;
    let buttons = [
        (start, Command::Start),
        (back_home, Command::BackHome),
        (go_on, Command::GoOn),
        (retrieve, Command::Retrieve(None)),
        (reset, Command::Reset),
        (drive, Command::Move(Move::TurnLeft)),
        (strategy, Command::ChooseStrategy(Strategy::Snail)),
        (retake, Command::RetakePhoto(state.mission.inspected.unwrap_or(LuggageId(1)))),
    ];
    for (shown, command) in buttons {
        let does = give(&mut engine.clone(), command.clone()).err();
        if shown.is_none() {
            assert_eq!(does, None, "seed {seed}: {command:?} in {:?}", state.mission.phase);
        }
        if engine.on_record.is_current() && !matches!(command, Command::RetakePhoto(_)) {
            assert_eq!(&does, shown, "seed {seed}: {command:?} in {:?}", state.mission.phase);
        }
    }
    let held = state.mission.holds.iter().any(|hold| !hold.cleared_by_start());
    assert!(!held || start.is_some(), "seed {seed}: a hold is shown, and START is offered");
}
