//! Mission §14: what the pieces of an exercise were is recorded once, at its end, also when a kill comes in between.

use std::sync::Arc;

use hallsweep_core::closing::Closing;
use hallsweep_core::command::{Command, Door, Issuer, LuggageRef, Note, Request, Strategy, Verdict};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::settings::{AfterDanger, Rules, SafeBy, Settings};
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{LuggageId, Now};
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::mortal::Mortal;
use crate::operator::PLENTY;

fn hall() -> Arc<Hall> {
    let hall = Hall::from_rows("drawn", &["S....", ".....", "..a..", ".....", "b...."]).expect("it is sound");
    Arc::new(hall.with_tests(1, 3).expect("there is room"))
}

fn searching(hall: &Arc<Hall>) -> Mortal {
    let rules = Rules { safe_by: SafeBy::Two, after_danger: AfterDanger::GoOn, ..Rules::default() };
    let settings = Settings { rules, ..Settings::default() };
    let mut mortal = Mortal::searching_by(Strategy::Auto, settings, Arc::clone(hall), SimSettings::new(1, Camera::Stub));
    mortal.engine.begin_exercise(hall.inspectable(), Now::default());
    mortal.give(Command::Start).expect("nothing holds it");
    mortal
}

/// Waits for a piece without a verdict; `None` at the end of the search.
fn pending(mortal: &mut Mortal) -> Option<LuggageId> {
    for _ in 0..PLENTY {
        mortal.keep_all();
        if let Some(piece) = mortal.state().pending() {
            return Some(piece.id);
        }
        if !mortal.state().robot.led_blinking {
            return None;
        }
        mortal.advance();
    }
    panic!("the search does not end: {:?}", mortal.state().mission);
}

fn say(mortal: &mut Mortal, who: &str, verdict: Verdict, luggage: LuggageId) {
    let issuer = Issuer { door: Door("http"), who: who.into(), from: "192.0.2.7".into() };
    let luggage = LuggageRef::Id(luggage);
    let command = Command::Verdict { luggage, verdict, note: None, hot: Default::default() };
    mortal.ask(Request::new(command, issuer)).expect("the piece waits");
}

fn revealed(mortal: &Mortal, luggage: LuggageId) -> Vec<bool> {
    let of_it = |fact: &Fact| match fact {
        Fact::Revealed { luggage: of, is_test } if *of == luggage => Some(*is_test),
        _ => None,
    };
    mortal.disk.iter().filter_map(|entry| of_it(&entry.fact)).collect()
}

#[test]
fn all_pieces_are_revealed_together_after_the_last_verdict_and_the_hall_is_hidden_until_then() {
    let hall = hall();
    let mut mortal = searching(&hall);
    let mut judged = Vec::new();
    while let Some(id) = pending(&mut mortal) {
        assert!(mortal.state().mission.is_truth_hidden);
        let is_told = |mortal: &mut Mortal| mortal.state().luggage.iter().any(|luggage| luggage.truth.is_some());
        say(&mut mortal, "anna", Verdict::Safe, id);
        mortal.keep_all();
        assert!(!is_told(&mut mortal), "one judge is missing");
        say(&mut mortal, "ben", Verdict::Safe, id);
        assert!(!is_told(&mut mortal), "the verdict is not on record");
        judged.push(id);
        mortal.keep_all();
        assert_eq!(is_told(&mut mortal), judged.len() == hall.inspectable().len(), "{judged:?}");
    }
    for id in judged {
        let record = Arc::clone(mortal.state().luggage(id).unwrap());
        let truth = hall.is_dangerous(record.piece.expect("it was recognised"));
        assert_eq!((revealed(&mortal, id), record.truth), (vec![truth], Some(truth)));
    }
    assert!(!mortal.state().mission.is_truth_hidden, "every piece has its verdict");
    assert_eq!(mortal.state().luggage.iter().filter(|luggage| luggage.truth == Some(true)).count(), 1);
    let again = mortal.give(Command::Start);
    assert_eq!(again.map(drop), Err(Refused::ExerciseOver), "whoever knows the pieces does not judge them again");
}

#[test]
fn closing_reveals_what_was_judged_and_later_answers_do_not_count() {
    let mut mortal = searching(&hall());
    let id = pending(&mut mortal).expect("a piece");
    say(&mut mortal, "anna", Verdict::Danger, id);
    mortal.keep_all();
    mortal.give(Command::BackHome).expect("it explores");
    mortal.keep_all();
    while mortal.state().mission.phase != PhaseName::BombLocated {
        assert!(mortal.advance());
        mortal.keep_all();
    }
    let state = mortal.state();
    assert!(state.mission.is_truth_hidden);
    let seen = state.mission.open.code(state.mission.id).into();
    let name = Note::new("Anna Rossi").expect("it is a name");
    mortal.give(Command::Close(Closing { name, note: None, seen })).expect("all open points were seen");
    assert!(mortal.state().mission.is_truth_hidden, "it is not on record");
    mortal.keep_all();
    assert!(!mortal.state().mission.is_truth_hidden && mortal.state().luggage(id).unwrap().truth.is_some());
    mortal.give(Command::GoOn).expect("a bomb is located");
    let later = pending(&mut mortal).expect("another piece");
    say(&mut mortal, "anna", Verdict::Danger, later);
    mortal.keep_all();
    assert_eq!(mortal.state().luggage(later).unwrap().truth, None, "anna may have seen the hall");
}

#[test]
fn a_mission_that_is_put_away_early_reveals_what_was_judged_and_no_other_begins() {
    let mut mortal = searching(&hall());
    let id = pending(&mut mortal).expect("a piece");
    mortal.give(Command::Stop).expect("STOP is never refused");
    for who in ["anna", "ben"] {
        say(&mut mortal, who, Verdict::Safe, id);
    }
    mortal.keep_all();
    assert_eq!(revealed(&mortal, id), [false; 0]);
    mortal.give(Command::Reset).expect("nothing waits");
    mortal.keep_all();
    assert_eq!(revealed(&mortal, id).len(), 1);
    assert_eq!(mortal.give(Command::Start).map(drop), Err(Refused::ExerciseOver));
}

#[test]
fn a_kill_between_the_last_verdict_and_what_the_pieces_were_loses_nothing_and_repeats_nothing() {
    let hall = hall();
    for durable in 0..4 {
        let mut mortal = searching(&hall);
        let mut judged = 0;
        let last = loop {
            let id = pending(&mut mortal).expect("a piece");
            judged += 1;
            if judged == hall.inspectable().len() {
                break id;
            }
            say(&mut mortal, "anna", Verdict::Danger, id);
            mortal.keep_all();
        };
        say(&mut mortal, "anna", Verdict::Danger, last);
        if durable > 1 {
            mortal.keep_one();
        }
        let mut mortal = mortal.killed(durable);
        mortal.engine.begin_exercise(hall.inspectable(), Now::default());
        mortal.wait_a_minute();
        mortal.keep_all();
        if mortal.state().luggage(last).unwrap().is_pending() {
            assert_eq!((durable, revealed(&mortal, last)), (0, vec![]));
            say(&mut mortal, "anna", Verdict::Danger, last);
            mortal.keep_all();
        }
        for luggage in mortal.state().luggage.iter() {
            let truth = luggage.truth.expect("every piece has its verdict");
            assert_eq!(revealed(&mortal, luggage.id), [truth], "{durable} pages were on the disk");
        }
    }
}
