//! Mission §4 on judges who are unsure: the robot takes photos from other places, and asks again.

use std::sync::Arc;

use hallsweep_core::command::{Command, Door, Hot, HotAnswer, Issuer, LuggageRef, Note, Request, Strategy, Verdict};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::settings::{Rules, SafeBy, Settings};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{Cell, LuggageId, Pose};
use hallsweep_core::world::luggage::{Luggage, PhotoState};
use hallsweep_sim::headless::Run;
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::mortal::Mortal;
use crate::operator::{Operator, PLENTY};

fn waits(rows: &[&str], rules: Rules) -> Run {
    let hall = Arc::new(Hall::from_rows("drawn", rows).expect("the tests draw sound halls"));
    let settings = Settings { rules, ..Settings::default() };
    let mut run = Run::new(hall, SimSettings::new(1, Camera::Stub), settings, Strategy::Auto);
    run.give(Command::Start).unwrap();
    run.until_pending();
    run
}

fn unsure() -> Command {
    Command::Unsure { luggage: LuggageRef::Id(LuggageId(1)), note: None, hot: Hot::default() }
}

fn piece(run: &mut Run) -> Luggage {
    Luggage::clone(run.state().luggage(LuggageId(1)).expect("it was found"))
}

/// Says unsure, and waits until the piece is asked again. Returns the poses of the new photos.
fn look_again(run: &mut Run) -> Vec<Pose> {
    let before = piece(run).seen_from.len();
    run.give(unsure()).expect("the piece waits");
    run.until("the question", |state| state.mission.phase != PhaseName::Inspecting || state.mission.refusals.retake.is_none());
    let piece = piece(run);
    piece.seen_from.iter().copied().chain([piece.pose]).skip(before + 1).collect()
}

fn steps_off(pose: Pose, cell: Cell) -> u32 {
    pose.cell.x.abs_diff(cell.x) + pose.cell.y.abs_diff(cell.y)
}

fn faces(pose: Pose, cell: Cell) -> bool {
    let one = pose.cell.ahead(pose.heading);
    one == cell || one.ahead(pose.heading) == cell
}

#[test]
fn an_unsure_judge_gets_a_photo_from_another_side_and_one_from_two_cells_off_and_is_asked_again() {
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules::default());
    let first = piece(&mut run);
    let poses = look_again(&mut run);
    let found = piece(&mut run);
    assert_eq!(poses.len(), 2, "{poses:?}");
    assert!(poses.iter().all(|pose| faces(*pose, found.cell)), "{poses:?}");
    assert!(steps_off(poses[0], found.cell) == 1 && poses[0].heading != first.pose.heading, "{poses:?}");
    assert_eq!(steps_off(poses[1], found.cell), 2);
    assert!(matches!(found.photo, PhotoState::Taken { take: 3, .. }), "{:?}", found.photo);
    assert_eq!((run.phase(), found.is_pending(), found.unsure.len()), (PhaseName::Inspecting, true, 1));
    run.verdict(1, Verdict::Safe).unwrap();
    run.until_explored();
}

#[test]
fn what_an_unsure_judge_says_is_on_record_and_no_side_is_photographed_twice() {
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules::default());
    let note = Note::new("a shadow under the handle");
    let hot = Hot { hidden: Some(HotAnswer::CannotSay), ..Hot::default() };
    run.give(Command::Unsure { luggage: LuggageRef::Pending, note: note.clone(), hot }).unwrap();
    run.until("the question", |state| state.mission.refusals.retake.is_none());
    let found = piece(&mut run);
    let doubt = &found.unsure[0];
    assert_eq!((&*doubt.who, &doubt.note, doubt.hot), ("operator", &note, hot));
    let mut places: Vec<Pose> = found.seen_from.iter().copied().chain([found.pose]).collect();
    for _ in 0..6 {
        places.extend(look_again(&mut run));
    }
    let mut distinct = places.clone();
    distinct.sort_by_key(|pose| (pose.cell, pose.heading as usize));
    distinct.dedup();
    assert_eq!(distinct.len(), places.len(), "{places:?}");
    assert_eq!(places.len(), 8, "four sides, near and two cells off");
    let log = run.state().log.iter().map(|line| line.said.to_string()).collect::<String>();
    assert!(log.contains("luggage #1 cannot be photographed from another side"), "{log}");
    run.verdict(1, Verdict::Danger).unwrap();
}

#[test]
fn the_operator_decides_while_the_robot_goes_round_the_piece() {
    for verdict in [Verdict::Safe, Verdict::Danger] {
        let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules::default());
        run.give(unsure()).unwrap();
        run.give(unsure()).expect("a second press changes nothing");
        run.advance();
        assert_eq!(run.give(Command::RetakePhoto(LuggageId(1))), Err(Refused::PhotoUnderWay));
        run.verdict(1, verdict).unwrap();
        assert_eq!(piece(&mut run).unsure.len(), 1);
        let expected = if verdict == Verdict::Safe { PhaseName::Exploring } else { PhaseName::ReturningWithAlarm };
        assert_eq!(run.phase(), expected);
    }
}

#[test]
fn nothing_moves_round_a_piece_while_it_is_held_and_start_continues() {
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules::default());
    run.give(unsure()).unwrap();
    run.give(Command::Stop).unwrap();
    for _ in 0..20 {
        run.advance();
    }
    let held = run.sim.pose_at(run.now());
    for _ in 0..20 {
        run.advance();
    }
    assert_eq!(run.sim.pose_at(run.now()), held);
    run.give(Command::Start).expect("the views go on");
    run.until("the question", |state| state.mission.refusals.retake.is_none());
    assert!(matches!(piece(&mut run).photo, PhotoState::Taken { take: 3, .. }));
    assert_eq!(run.give(Command::Start), Err(Refused::VerdictPending(LuggageId(1))));
}

#[test]
fn only_the_piece_before_the_robot_is_looked_at_again() {
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules::default());
    let other = Command::Unsure { luggage: LuggageRef::Id(LuggageId(7)), note: None, hot: Hot::default() };
    assert_eq!(run.give(other), Err(Refused::UnknownLuggage(LuggageId(7))));
    run.give(Command::BackHome).unwrap();
    assert_eq!(run.give(unsure()), Err(Refused::NotInspected(LuggageId(1))));
    run.verdict(1, Verdict::Safe).unwrap();
    assert_eq!(run.give(unsure()), Err(Refused::NotInspected(LuggageId(1))));
}

#[test]
fn without_further_views_the_answer_is_only_recorded() {
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules { unsure_views: 0, ..Rules::default() });
    assert_eq!(look_again(&mut run), []);
    assert_eq!(piece(&mut run).unsure.len(), 1);
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules { unsure_views: 1, ..Rules::default() });
    assert_eq!(look_again(&mut run).len(), 1);
}

/// In a corridor, the robot sees the piece from two cells off only.
#[test]
fn a_piece_at_the_end_of_a_corridor_is_photographed_from_two_cells_off() {
    let mut run = waits(&["S...a"], Rules::default());
    let poses = look_again(&mut run);
    assert_eq!(poses.iter().map(|pose| steps_off(*pose, Cell::new(4, 0))).collect::<Vec<_>>(), [2]);
}

/// Unsure counts as no answer, and answers about earlier photos do not count.
#[test]
fn of_two_judges_an_unsure_one_has_not_answered() {
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules { safe_by: SafeBy::Two, ..Rules::default() });
    assert!(run.verdict(1, Verdict::Safe).unwrap().is_kept_back);
    assert!(!run.give(unsure()).unwrap().is_kept_back);
    run.until("the question", |state| state.mission.refusals.retake.is_none());
    assert!(run.verdict(1, Verdict::Safe).unwrap().is_kept_back, "nobody has judged the new photos");
    assert!(piece(&mut run).is_pending());
}

#[test]
fn a_judge_who_is_unsure_takes_an_earlier_safe_back() {
    let rules = Rules { safe_by: SafeBy::Two, unsure_views: 0, ..Rules::default() };
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], rules);
    let by = |who: &str, command: Command| {
        Request::new(command, Issuer { door: Door("http"), who: who.into(), from: "192.0.2.7".into() })
    };
    let (luggage, note, hot) = (LuggageRef::Id(LuggageId(1)), None, Hot::NONE);
    let safe = Command::Verdict { luggage, verdict: Verdict::Safe, note, hot };
    assert!(run.ask(by("anna", safe.clone())).unwrap().is_kept_back);
    run.ask(by("anna (Anna)", unsure())).unwrap();
    assert!(run.ask(by("ben", safe.clone())).unwrap().is_kept_back, "anna is unsure");
    assert!(!run.ask(by("anna", safe)).unwrap().is_kept_back);
    assert_eq!(run.phase(), PhaseName::Exploring);
}

/// A kill at a random moment in half of 40 runs: the piece is asked again and keeps its record.
#[test]
fn after_a_kill_the_robot_goes_on_round_the_piece() {
    let mut photos = 0;
    for seed in 0..40 {
        let mut dice = RandomStream::new(seed, "unsure");
        let hall = Arc::new(Hall::from_rows("drawn", &["S.....", "...#..", "..a...", ".#....", "....b.", "......"]).unwrap());
        let settings = Settings::default();
        let mut mortal = Mortal::searching_by(Strategy::Auto, settings, hall, SimSettings::new(seed, Camera::Stub));
        mortal.give(Command::Start).unwrap();
        let until = |mortal: &mut Mortal, what: &str, is_so: fn(&Snapshot) -> bool| {
            for _ in 0..PLENTY {
                mortal.keep_all();
                if is_so(&mortal.state()) {
                    return;
                }
                mortal.advance();
            }
            panic!("seed {seed}: never {what}: {:?}", mortal.state().mission);
        };
        until(&mut mortal, "asked", |state| state.mission.refusals.retake.is_none());
        let id = mortal.state().pending().unwrap().id;
        mortal.give(Command::Unsure { luggage: LuggageRef::Id(id), note: None, hot: Hot::default() }).unwrap();
        mortal.keep_all();
        for _ in 0..dice.below(30) {
            mortal.advance();
            mortal.keep_all();
        }
        if dice.below(2) == 0 {
            mortal = mortal.killed(usize::MAX);
            let is_ready = |state: &Snapshot| state.mission.refusals.start.is_none() || state.mission.refusals.retake.is_none();
            until(&mut mortal, "ready", is_ready);
            mortal.give(Command::Start).ok();
        }
        until(&mut mortal, "asked again", |state| state.mission.refusals.retake.is_none());
        let piece = Luggage::clone(mortal.state().luggage(id).unwrap());
        assert_eq!((piece.unsure.len(), piece.is_pending()), (1, true), "seed {seed}");
        if let PhotoState::Taken { take, .. } = piece.photo {
            photos += take - 1;
        }
    }
    assert!(photos > 50, "{photos} further photos");
}
