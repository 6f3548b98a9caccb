//! Mission §4 on verdicts by two judges, and on the three questions about a piece.

use std::collections::BTreeSet;
use std::sync::Arc;

use hallsweep_core::asked::Asked;
use hallsweep_core::command::{
    Accepted, Command, CommandId, Door, Hot, HotAnswer, Issuer, LuggageRef, Note, Request, Strategy, Verdict,
};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::{Refusal, RefusalKind, Refused};
use hallsweep_core::rng::RandomStream;
use hallsweep_core::settings::{HotRule, Rules, SafeBy, Settings};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::LuggageId;
use hallsweep_sim::headless::Run;
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::mortal::Mortal;
use crate::operator::{Operator, PLENTY};

const TWO: Rules = Rules { safe_by: SafeBy::Two, ..ONE };
const ONE: Rules = Rules {
    after_danger: hallsweep_core::settings::AfterDanger::Return,
    keep_out_m: 0.0,
    safe_by: SafeBy::One,
    hot: HotRule::Optional,
    unsure_views: Rules::MOST_VIEWS,
};

const DOORS: [&str; 3] = ["http", "mqtt", "console"];

fn hall() -> Arc<Hall> {
    Arc::new(Hall::from_rows("drawn", &["S...", "..a.", "....", "b..."]).expect("it is sound"))
}

fn at_a_piece(rules: Rules) -> Run {
    let settings = Settings { rules, ..Settings::default() };
    let mut run = Run::new(hall(), SimSettings::new(1, Camera::Stub), settings, Strategy::Auto);
    run.give(Command::Start).unwrap();
    run.until_pending();
    run
}

fn said(who: &str, verdict: Verdict, luggage: LuggageRef) -> Request {
    let issuer = Issuer { door: Door(DOORS[who.len() % 3]), who: who.into(), from: "192.0.2.7".into() };
    Request::new(Command::Verdict { luggage, verdict, note: Note::new("seen"), hot: Hot::default() }, issuer)
}

fn waits(rules: Rules) -> Mortal {
    let settings = Settings { rules, ..Settings::default() };
    let mut mortal = Mortal::searching_by(Strategy::Auto, settings, hall(), SimSettings::new(1, Camera::Stub));
    mortal.give(Command::Start).unwrap();
    until_pending(&mut mortal);
    mortal
}

fn until_pending(mortal: &mut Mortal) {
    for _ in 0..PLENTY {
        mortal.keep_all();
        if mortal.state().pending().is_some() {
            return;
        }
        mortal.advance();
    }
    panic!("no piece waits in {:?}", mortal.state().mission);
}

fn say(run: &mut Run, who: &str, verdict: Verdict) -> Result<Accepted, Refused> {
    run.ask(said(who, verdict, LuggageRef::Id(LuggageId(1))))
}

/// Everything that anybody can see of a run: the snapshot, the log and the journal.
fn seen(run: &mut Run) -> String {
    let state: Arc<Snapshot> = run.state();
    let revision = (state.revision, state.revisions);
    let log: Vec<String> = state.log.iter().map(|line| line.said.to_string()).collect();
    format!("{revision:?} {:?} {:?} {:?} {log:?} {:?}", state.mission, state.luggage, state.alarms, run.journal)
}

#[test]
fn a_piece_is_safe_when_two_keys_have_said_so_and_nothing_shows_the_first_answer() {
    let mut run = at_a_piece(TWO);
    let before = seen(&mut run);
    let first = say(&mut run, "anna", Verdict::Safe).unwrap();
    assert!(first.is_kept_back && first.luggage == Some(LuggageId(1)));
    assert_eq!(seen(&mut run), before, "nothing has changed for anybody");
    for again in ["anna", "anna (Anna)", "anna (Otto)"] {
        assert!(say(&mut run, again, Verdict::Safe).unwrap().is_kept_back, "one key is one judge: {again}");
        assert_eq!(seen(&mut run), before, "{again}");
    }
    let second = run.ask(said("ben", Verdict::Safe, LuggageRef::Pending)).unwrap();
    assert!(!second.is_kept_back);
    let state = run.state();
    let luggage = state.luggage(LuggageId(1)).unwrap();
    let decision = luggage.verdict.as_ref().unwrap();
    assert_eq!((decision.verdict, &*decision.who), (Verdict::Safe, "ben"));
    assert_eq!(luggage.judged.iter().map(|judged| &*judged.issuer.who).collect::<Vec<_>>(), ["anna"]);
    assert_eq!(run.phase(), PhaseName::Exploring);
    assert!(state.log.iter().any(|line| line.said.to_string().contains("kept back until now: luggage #1 safe, by anna")));
}

#[test]
fn one_danger_wins_before_and_after_a_first_safe_whoever_gives_it() {
    for (first, second) in [(None, "ben"), (Some("anna"), "ben"), (Some("anna"), "anna")] {
        let mut run = at_a_piece(TWO);
        if let Some(first) = first {
            say(&mut run, first, Verdict::Safe).unwrap();
        }
        assert!(!say(&mut run, second, Verdict::Danger).unwrap().is_kept_back);
        assert_eq!(run.phase(), PhaseName::ReturningWithAlarm, "{first:?}, {second}");
        let state = run.state();
        let luggage = state.luggage(LuggageId(1)).unwrap();
        assert_eq!((luggage.is_dangerous(), luggage.judged.len()), (true, usize::from(first.is_some())));
        let too_late = say(&mut run, "carl", Verdict::Safe);
        assert_eq!(too_late, Err(Refused::Decided { luggage: LuggageId(1), verdict: Verdict::Danger }));
    }
}

/// An answer is about the photo that the judge saw.
#[test]
fn an_answer_about_an_earlier_photo_does_not_count() {
    let mut run = at_a_piece(TWO);
    say(&mut run, "anna", Verdict::Safe).unwrap();
    run.give(Command::RetakePhoto(LuggageId(1))).unwrap();
    run.until("the second photo", |state| state.luggage(LuggageId(1)).is_some_and(|piece| piece.first_taken != piece.taken));
    assert!(say(&mut run, "ben", Verdict::Safe).unwrap().is_kept_back, "anna has not seen this photo");
    assert!(say(&mut run, "ben", Verdict::Safe).unwrap().is_kept_back, "ben is one judge");
    assert!(!say(&mut run, "anna", Verdict::Safe).unwrap().is_kept_back);
    assert_eq!(run.state().luggage(LuggageId(1)).unwrap().judged.len(), 2, "her first answer is on record, too");
}

/// A judge may change or complete the answer. A bare *safe* only repeats it.
#[test]
fn a_later_answer_of_the_same_judge_replaces_the_first_unless_it_adds_nothing() {
    let hot = Hot { hidden: Some(HotAnswer::No), obvious: Some(HotAnswer::No), typical: Some(HotAnswer::Yes), size: None };
    let issuer = |who: &str| Issuer { door: Door("http"), who: who.into(), from: "192.0.2.7".into() };
    let safe = |hot, note: Option<&str>| {
        let (luggage, note) = (LuggageRef::Pending, note.and_then(Note::new));
        Command::Verdict { luggage, verdict: Verdict::Safe, note, hot }
    };
    let mut run = at_a_piece(Rules { hot: HotRule::Required, ..TWO });
    let mut ask = |who, hot, note| run.ask(Request::new(safe(hot, note), issuer(who))).map(|accepted| accepted.is_kept_back);
    assert_eq!(ask("anna", hot, Some("first")), Ok(true));
    assert_eq!(ask("anna", Hot { hidden: Some(HotAnswer::CannotSay), ..hot }, Some("second")), Ok(true));
    assert_eq!(ask("anna", Hot::default(), None), Ok(true), "she has answered the questions already");
    assert_eq!(ask("ben", Hot::default(), None), Err(Refused::HotUnanswered(LuggageId(1))));
    assert_eq!(ask("ben", hot, None), Ok(false));
    let state = run.state();
    let judged = &state.luggage(LuggageId(1)).unwrap().judged;
    let notes: Vec<&str> = judged.iter().filter_map(|judged| Some(judged.note.as_ref()?.text())).collect();
    assert_eq!((notes, judged[0].hot.hidden), (vec!["second"], Some(HotAnswer::CannotSay)));
}

#[test]
fn a_safe_over_coap_is_no_answer_of_a_judge_and_leaves_no_trace() {
    let mut run = at_a_piece(TWO);
    let before = seen(&mut run);
    let issuer = Issuer { door: Door::COAP, who: "operator".into(), from: "127.0.0.1".into() };
    let command = |verdict| Command::Verdict { luggage: LuggageRef::Pending, verdict, note: None, hot: Hot::default() };
    let refused = run.ask(Request::new(command(Verdict::Safe), issuer.clone())).unwrap_err();
    assert_eq!((refused.code(), seen(&mut run)), ("notAllowed", before));
    let unsure = Command::Unsure { luggage: LuggageRef::Pending, note: None, hot: Hot::default() };
    assert_eq!(run.ask(Request::new(unsure, issuer.clone())).unwrap_err().code(), "notAllowed", "it could withdraw an answer");
    run.ask(Request::new(command(Verdict::Danger), issuer)).unwrap();
    assert_eq!(run.phase(), PhaseName::ReturningWithAlarm, "a danger needs no key");
}

/// The refusal of an id that was used for another command would tell of the answer that is kept back.
#[test]
fn an_id_that_was_used_before_tells_nothing_of_an_answer() {
    let mut run = at_a_piece(TWO);
    let named = |verdict, luggage| Request { id: CommandId::new("k7"), ..said("anna", verdict, luggage) };
    run.ask(named(Verdict::Safe, LuggageRef::Pending)).unwrap();
    let before = seen(&mut run);
    for verdict in [Verdict::Safe, Verdict::Danger] {
        let refused = run.ask(named(verdict, LuggageRef::Id(LuggageId(1)))).unwrap_err();
        assert_eq!((refused.code(), seen(&mut run)), ("otherContent", before.clone()));
    }
}

/// A request that a door could not read may be a verdict that is written wrongly.
#[test]
fn what_a_door_refuses_tells_nothing_while_two_judges_are_awaited() {
    let mut mortal = waits(TWO);
    let seen = |mortal: &mut Mortal| (mortal.state().log.len(), mortal.disk.len());
    let before = seen(&mut mortal);
    let issuer = Issuer { door: Door("http"), who: "anna".into(), from: "192.0.2.7".into() };
    let wrong = Refused::InWords(Refusal { code: "unusable", kind: RefusalKind::Conflict, words: "it is cut off".to_owned() });
    for words in [
        "POST /console/safe",
        "POST /api/v1/luggage/1/verdict",
        "command Verdict",
        "message luggageSafe",
        "continueExploreAfterPhoto",
    ] {
        mortal.note_refused(issuer.clone(), Asked::Words(words.to_owned()), &wrong);
        assert_eq!(seen(&mut mortal), before, "{words}");
    }
    mortal.note_refused(issuer, Asked::Words("POST /console/start".to_owned()), &wrong);
    assert_ne!(seen(&mut mortal), before, "everything else is recorded");
}

/// A danger that overtakes the second *safe* before it is stored: the answers stand in the journal once.
#[test]
fn a_danger_that_overtakes_the_second_safe_records_no_answer_twice() {
    let mut mortal = waits(TWO);
    for (who, verdict) in [("anna", Verdict::Safe), ("bo", Verdict::Safe), ("carla", Verdict::Danger)] {
        mortal.ask(said(who, verdict, LuggageRef::Pending)).unwrap();
    }
    mortal.keep_all();
    let judged = mortal.disk.iter().filter(|entry| matches!(entry.fact, Fact::Judged(_))).count();
    let state = mortal.state();
    let piece = state.luggage(LuggageId(1)).unwrap();
    assert_eq!((judged, piece.verdict_name(), piece.judged.len()), (1, "danger", 1));
}

/// Safety S4: a repeat of an answer that was kept back is no answer about the next piece, whatever happened between.
#[test]
fn a_bare_safe_that_comes_again_after_restarts_judges_no_other_piece() {
    let again = || Request { id: CommandId::new("k7"), ..said("anna", Verdict::Safe, LuggageRef::Pending) };
    for publishes_before_the_kill in [true, false] {
        let mut mortal = waits(TWO);
        assert!(mortal.ask(again()).is_ok());
        mortal.keep_all();
        if !publishes_before_the_kill {
            mortal = mortal.killed(0);
            mortal.keep_all();
        }
        mortal.ask(said("bo", Verdict::Safe, LuggageRef::Pending)).unwrap();
        mortal.keep_all();
        if publishes_before_the_kill {
            mortal = mortal.killed(0);
            mortal.keep_all();
        }
        mortal.give(Command::Start).unwrap();
        until_pending(&mut mortal);
        assert!(mortal.state().luggage(LuggageId(2)).is_some_and(|piece| piece.is_pending()));
        mortal.ask(again()).unwrap();
        mortal.keep_all();
        mortal.ask(said("bo", Verdict::Safe, LuggageRef::Pending)).unwrap();
        mortal.keep_all();
        let state = mortal.state();
        assert!(state.luggage(LuggageId(2)).unwrap().is_pending(), "{publishes_before_the_kill}: one judge is not two");
    }
}

/// The refusal of a *safe* would tell what its sender thinks of the piece.
#[test]
fn a_refused_safe_leaves_no_trace_while_two_judges_are_awaited() {
    let mut run = at_a_piece(Rules { hot: HotRule::Required, ..TWO });
    let before = seen(&mut run);
    assert_eq!(say(&mut run, "anna", Verdict::Safe), Err(Refused::HotUnanswered(LuggageId(1))));
    assert_eq!(seen(&mut run), before);
}

#[test]
fn where_the_questions_are_compulsory_a_safe_needs_all_three_answers_and_a_danger_none() {
    let hot = Hot { hidden: Some(HotAnswer::No), obvious: Some(HotAnswer::CannotSay), ..Hot::NONE };
    let command = |hot, verdict| Command::Verdict { luggage: LuggageRef::Pending, verdict, note: None, hot };
    let mut run = at_a_piece(Rules { hot: HotRule::Required, ..ONE });
    for missing in [Hot::default(), hot] {
        assert_eq!(run.give(command(missing, Verdict::Safe)), Err(Refused::HotUnanswered(LuggageId(1))));
    }
    let whole = Hot { typical: Some(HotAnswer::Yes), ..hot };
    run.give(command(whole, Verdict::Safe)).unwrap();
    assert_eq!(run.state().luggage(LuggageId(1)).unwrap().verdict.as_ref().unwrap().hot, whole);
    run.until_pending();
    run.give(command(hot, Verdict::Danger)).unwrap();
    let asked = run.journal.iter().find_map(|entry| match &entry.fact {
        Fact::Verdict { verdict: Verdict::Danger, hot, .. } => Some(*hot),
        _ => None,
    });
    assert_eq!(asked, Some(hot), "incomplete answers are recorded, too");
}

/// Races of three keys at three doors, with repeats, kills of the program and pages that are stored late: no piece is
/// ever safe by one key, and a danger that was accepted is never lost.
#[test]
fn no_race_and_no_kill_makes_a_piece_safe_by_one_key() {
    let (mut safe, mut danger, mut kept_back) = (0, 0, 0);
    for seed in 0..400 {
        let mut dice = RandomStream::new(seed, "judges");
        let mut mortal = waits(TWO);
        let (mut by_key, mut danger_told) = (BTreeSet::new(), false);
        for _ in 0..dice.below(8) {
            match dice.below(10) {
                0..6 => {
                    let who = ["anna", "bo", "carla"][usize::try_from(dice.below(3)).unwrap()];
                    let verdict = if dice.below(8) == 0 { Verdict::Danger } else { Verdict::Safe };
                    if mortal.ask(said(who, verdict, LuggageRef::Id(LuggageId(1)))).is_ok() {
                        by_key.extend((verdict == Verdict::Safe).then_some(who));
                        danger_told |= verdict == Verdict::Danger;
                    }
                }
                6..9 => drop(mortal.keep_one()),
                _ => mortal = mortal.killed(usize::try_from(dice.below(3)).unwrap()),
            }
            let state = mortal.state();
            let piece = state.luggage(LuggageId(1)).unwrap();
            if piece.verdict.as_ref().is_some_and(|decision| decision.verdict == Verdict::Safe) {
                assert!(by_key.len() > 1, "seed {seed}: safe by {by_key:?}");
                assert_ne!(piece.judged[0].issuer.key(), piece.verdict.as_ref().unwrap().who, "seed {seed}");
            }
            let is_told = |line: &str| line.contains("safe") && !line.contains("unsafe");
            let told = state.log.iter().any(|line| is_told(&line.said.to_string()));
            assert!(!told || by_key.len() > 1 || danger_told, "seed {seed}: the log tells of an answer");
        }
        mortal.keep_all();
        let state = mortal.state();
        let piece = state.luggage(LuggageId(1)).unwrap();
        kept_back += usize::from(piece.is_pending() && !mortal.kept_back.is_empty());
        match piece.verdict.as_ref().map(|decision| decision.verdict) {
            Some(Verdict::Safe) => safe += 1,
            Some(Verdict::Danger) => danger += 1,
            None => {}
        }
    }
    assert!(safe > 40 && danger > 20 && kept_back > 40, "{safe} safe, {danger} dangerous, {kept_back} kept back");
}

#[test]
fn an_answer_that_is_kept_back_survives_a_kill_and_counts() {
    let mut mortal = waits(TWO);
    mortal.ask(said("anna", Verdict::Safe, LuggageRef::Pending)).unwrap();
    mortal.keep_all();
    let mut mortal = mortal.killed(0);
    mortal.keep_all();
    let named = |fact: &Fact| matches!(fact, Fact::Command { asked: Asked::Command(Command::Verdict { .. }), .. });
    assert!(!mortal.recalled().commands.iter().any(|entry| named(&entry.fact)));
    mortal.ask(said("bo", Verdict::Safe, LuggageRef::Pending)).unwrap();
    mortal.keep_all();
    let state = mortal.state();
    let piece = state.luggage(LuggageId(1)).unwrap();
    assert_eq!((piece.verdict_name(), piece.judged.len(), mortal.kept_back.len()), ("safe", 1, 0));
}
