//! Mission §4 on judges who are unsure: the robot takes photos from other places, and asks again.

use std::sync::Arc;

use hallsweep_core::command::{
    Command, Door, Hot, HotAnswer, Issuer, LuggageRef, Note, Request, Strategy, TemperatureReport, Verdict,
};
use hallsweep_core::effect::Action;
use hallsweep_core::event::{Event, RobotEvent, Whereabouts};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::robot::{RobotId, RobotState};
use hallsweep_core::settings::{AfterDanger, Rules, SafeBy, Settings};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::snapshot::said::Said;
use hallsweep_core::units::{Cell, LuggageId, Pose};
use hallsweep_core::world::luggage::{Luggage, PhotoState};
use hallsweep_sim::headless::Run;
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::bare::Bare;
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

fn robot(report: RobotEvent) -> Event {
    Event::Robot(RobotId::discovery(), report)
}

fn advance(run: &mut Run, moments: usize) {
    for _ in 0..moments {
        run.advance();
    }
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
    assert!(log.contains("no further place for a photo of luggage #1 can be reached"), "{log}");
    run.verdict(1, Verdict::Danger).unwrap();
}

#[test]
fn the_operator_decides_while_the_robot_goes_round_the_piece() {
    for verdict in [Verdict::Safe, Verdict::Danger] {
        let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules::default());
        run.give(unsure()).unwrap();
        run.advance();
        assert_eq!(run.give(Command::RetakePhoto(LuggageId(1))), Err(Refused::PhotoUnderWay));
        run.verdict(1, verdict).unwrap();
        let expected = if verdict == Verdict::Safe { PhaseName::Exploring } else { PhaseName::ReturningWithAlarm };
        assert_eq!(run.phase(), expected);
    }
}

/// Every hold stops the robot in the middle of a view, also during its photo. START continues when the cause is gone.
#[test]
fn nothing_moves_round_a_piece_while_it_is_held_and_start_continues() {
    type Cause = fn(&mut Run);
    let causes: [(Cause, Cause); 4] = [
        (|run| drop(run.give(Command::Stop)), |_| {}),
        (
            |run| drop(run.give(Command::Temperature(TemperatureReport::TooHigh))),
            |run| drop(run.give(Command::Temperature(TemperatureReport::Ok))),
        ),
        (|run| run.happen(Event::StoreFailed("disk full".to_owned())), |run| run.happen(Event::StoreRestored)),
        (
            |run| run.happen(robot(RobotEvent::LinkLost("cable".to_owned()))),
            |run| {
                let can = run.sim.capabilities();
                run.happen(robot(RobotEvent::LinkUp(can)));
            },
        ),
    ];
    for (n, (hold, end)) in causes.into_iter().enumerate() {
        for moments in 0..14 {
            let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules::default());
            run.give(unsure()).unwrap();
            advance(&mut run, moments);
            if n == 3 && (run.sim.is_developing() || run.sim.is_busy()) {
                continue;
            }
            hold(&mut run);
            advance(&mut run, 20);
            let held = run.sim.pose_at(run.now());
            advance(&mut run, 20);
            assert_eq!(run.sim.pose_at(run.now()), held, "cause {n} after {moments} moments");
            end(&mut run);
            advance(&mut run, 5);
            if run.state().mission.refusals.start.is_none() {
                run.give(Command::Start).expect("the views go on");
            }
            run.until("the question", |state| state.mission.refusals.retake.is_none());
            let taken = piece(&mut run).photo;
            assert!(matches!(taken, PhotoState::Taken { take: 3, .. }), "cause {n} after {moments} moments: {taken:?}");
        }
    }
}

#[test]
fn back_home_leaves_the_piece_and_it_still_waits() {
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules::default());
    run.give(unsure()).unwrap();
    advance(&mut run, 3);
    run.give(Command::BackHome).unwrap();
    run.until("home", |state| state.mission.phase == PhaseName::AtHome);
    assert!(piece(&mut run).is_pending());
}

/// A view is neither taken from inside a keep-out ring nor from a place that is far away.
#[test]
fn no_view_is_taken_inside_a_keep_out_ring_or_far_away() {
    let rules = Rules { after_danger: AfterDanger::GoOn, keep_out_m: 1.0, ..Rules::default() };
    let mut run = waits(&["S.....", "..b...", "......", ".a....", "......", "......"], rules);
    run.verdict(1, Verdict::Danger).unwrap();
    run.until("the other piece", |state| {
        state.mission.inspected == Some(LuggageId(2)) && state.mission.refusals.retake.is_none()
    });
    let other = Command::Unsure { luggage: LuggageRef::Pending, note: None, hot: Hot::default() };
    for _ in 0..4 {
        run.give(other.clone()).unwrap();
        run.until("the question", |state| state.mission.refusals.retake.is_none());
    }
    let state = run.state();
    let other = state.luggage(LuggageId(2)).unwrap();
    let ring = &state.mission.keep_out;
    let places: Vec<Pose> = other.seen_from.iter().copied().chain([other.pose]).collect();
    assert!(places.len() > 2 && !ring.is_empty(), "{places:?}");
    assert!(places.iter().all(|pose| !ring.contains(pose.cell)), "{places:?}");
    // A wall 30 cells long is between the robot and the other side.
    let row = format!("{}a", ".".repeat(15));
    let hall = [format!("S{}", ".".repeat(15)), row, "#".repeat(16), ".".repeat(16)];
    let mut run = waits(&hall.each_ref().map(String::as_str), Rules::default());
    for _ in 0..6 {
        look_again(&mut run);
    }
    assert!(piece(&mut run).seen_from.iter().all(|pose| pose.cell.y < 2));
}

/// A robot that was carried away during a view's photo drives back, and a photo taken again starts no other view.
#[test]
fn a_robot_that_is_carried_away_during_a_view_goes_on_with_the_views() {
    let mut bare = Bare::at_a_bag();
    let to_the_photo = |bare: &mut Bare| {
        while !matches!(bare.order(), Some(Action::Photograph(_))) {
            bare.done();
        }
    };
    bare.give(unsure()).unwrap();
    to_the_photo(&mut bare);
    bare.robot(RobotEvent::Stands(Whereabouts { pose: Pose::START, off_centre: false }));
    bare.photo();
    let take = |bare: &mut Bare| bare.state().luggage[0].take().unwrap();
    assert_eq!(take(&mut bare), 1, "it shows another place");
    to_the_photo(&mut bare);
    bare.robot(RobotEvent::Stands(Whereabouts { pose: Pose::START, off_centre: false }));
    bare.photo();
    while bare.order().is_some() {
        bare.done();
    }
    assert_eq!(take(&mut bare), 1, "the last view is given up, and the robot comes back");
    assert!(bare.state().mission.refusals.retake.is_none(), "the piece is asked again");
    bare.give(Command::RetakePhoto(LuggageId(1))).unwrap();
    bare.photo();
    assert_eq!((take(&mut bare), bare.order()), (2, None), "nothing moves for a photo that is taken again");
}

fn by(who: &str, command: Command) -> Request {
    Request::new(command, Issuer { door: Door("http"), who: who.into(), from: "192.0.2.7".into() })
}

fn safe() -> Command {
    Command::Verdict { luggage: LuggageRef::Id(LuggageId(1)), verdict: Verdict::Safe, note: None, hot: Hot::NONE }
}

/// A judge who presses twice says nothing new, and without a place for another photo nothing grows.
#[test]
fn a_second_press_is_not_recorded_again() {
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules::default());
    for _ in 0..50 {
        run.give(unsure()).unwrap();
    }
    assert_eq!(piece(&mut run).unsure.len(), 1);
}

/// In a pocket, the robot looks for another side, finds none, and comes back to where the photo was taken.
#[test]
fn a_robot_that_finds_no_other_side_comes_back_and_photographs_the_piece_there() {
    let mut run = waits(&["S#..", "....", "#a#."], Rules::default());
    for n in 0..4 {
        let note = Note::new(&format!("look {n}"));
        run.give(Command::Unsure { luggage: LuggageRef::Pending, note, hot: Hot::NONE }).unwrap();
        run.until("the question", |state| state.mission.refusals.retake.is_none());
        let state = run.state();
        assert!(faces(state.robot.pose, piece(&mut run).cell), "{:?}", state.robot.pose);
        assert_eq!(state.robot.pose, piece(&mut run).pose);
    }
    let taken = piece(&mut run).take().unwrap();
    run.give(Command::RetakePhoto(LuggageId(1))).expect("the robot stands before the piece");
    run.until("the photo", |state| state.mission.refusals.retake.is_none());
    assert_eq!(piece(&mut run).take(), Ok(taken + 1));
}

/// A bump on the way plans the way anew, and all moves count.
#[test]
fn a_way_with_detours_ends_after_as_many_moves_as_a_straight_one() {
    for seed in 0..60 {
        let mut dice = RandomStream::new(seed, "detours");
        let mut rows = vec![vec!['.'; 14]; 14];
        for _ in 0..60 {
            rows[dice.below(14) as usize][dice.below(14) as usize] = '#';
        }
        rows[0][0] = 'S';
        (rows[0][1], rows[1][0], rows[1][1], rows[2][1]) = ('.', '.', '.', 'a');
        let rows: Vec<String> = rows.into_iter().map(|row| row.into_iter().collect()).collect();
        let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
        let mut run = waits(&rows, Rules { unsure_views: 1, ..Rules::default() });
        run.give(unsure()).unwrap();
        let (mut moves, mut pose) = (0, run.state().robot.pose);
        let has_given_up = |state: &Snapshot| state.log.iter().any(|line| matches!(line.said, Said::NoOtherView(_)));
        while run.state().mission.refusals.retake.is_some() && run.state().robot.state != RobotState::TakingPhoto {
            run.advance();
            let state = run.state();
            if has_given_up(&state) {
                break;
            }
            moves += usize::from(state.robot.pose != pose);
            pose = state.robot.pose;
        }
        assert!(moves <= 24, "seed {seed}: {moves} moves");
    }
}

/// A sonar shows a piece from afar. Another side is another side all the same.
#[test]
fn a_piece_that_was_photographed_from_afar_is_photographed_from_another_side() {
    let hall = Arc::new(Hall::from_rows("drawn", &["S...a.", "......", "......"]).unwrap());
    let sim = SimSettings { sonar_cells: 4, ..SimSettings::new(1, Camera::Stub) };
    let settings = Settings { sonar_cells: 4, ..Settings::default() };
    let mut run = Run::new(hall, sim, settings, Strategy::Columns);
    run.give(Command::Start).unwrap();
    run.until_pending();
    let first = piece(&mut run);
    assert!(steps_off(first.pose, first.cell) > 1, "{:?}", first.pose);
    let poses = look_again(&mut run);
    assert_ne!(poses[0].heading, first.pose.heading, "{poses:?}");
}

/// Unsure counts as no answer, and an answer about an earlier photo does not count.
#[test]
fn of_two_judges_an_unsure_one_has_not_answered_and_nobody_has_judged_the_new_photos() {
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules { safe_by: SafeBy::Two, ..Rules::default() });
    assert!(run.ask(by("anna", safe())).unwrap().is_kept_back);
    assert!(!run.ask(by("ben", unsure())).unwrap().is_kept_back);
    run.until("the question", |state| state.mission.refusals.retake.is_none());
    assert!(run.ask(by("ben", safe())).unwrap().is_kept_back, "anna has not seen these photos");
    assert!(!run.ask(by("anna", safe())).unwrap().is_kept_back);
}

/// The second judge is unsure while the robot goes round the piece for the first one.
#[test]
fn an_unsure_during_the_views_is_recorded_and_takes_an_answer_back() {
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], Rules { safe_by: SafeBy::Two, ..Rules::default() });
    run.ask(by("ben", safe())).unwrap();
    run.ask(by("anna", unsure())).unwrap();
    run.ask(by("ben", unsure())).unwrap();
    assert_eq!(piece(&mut run).unsure.iter().map(|doubt| &*doubt.who).collect::<Vec<_>>(), ["anna", "ben"]);
    assert!(run.ask(by("anna", safe())).unwrap().is_kept_back, "ben has no answer any more");
    run.until("the question", |state| state.mission.refusals.retake.is_none());
    assert!(matches!(piece(&mut run).photo, PhotoState::Taken { take: 3, .. }), "one round is enough");
}

/// A safe that its judge has taken back counts neither after a restart nor after a kill that the file of answers missed.
#[test]
fn a_safe_that_was_taken_back_does_not_return_after_a_kill() {
    for (restarts_before, is_file_stale) in [(false, false), (true, false), (true, true), (false, true)] {
        let hall = Arc::new(Hall::from_rows("drawn", &["S...", "..a.", "...."]).unwrap());
        let settings =
            Settings { rules: Rules { safe_by: SafeBy::Two, unsure_views: 0, ..Rules::default() }, ..Settings::default() };
        let mut mortal = Mortal::searching_by(Strategy::Auto, settings, hall, SimSettings::new(1, Camera::Stub));
        mortal.give(Command::Start).unwrap();
        while mortal.state().mission.refusals.retake.is_some() {
            mortal.keep_all();
            mortal.advance();
        }
        mortal.ask(by("anna", unsure())).unwrap();
        mortal.keep_all();
        mortal.wait_a_minute();
        mortal.ask(by("anna", safe())).unwrap();
        mortal.keep_all();
        if restarts_before {
            mortal = mortal.killed(0);
        }
        let file = mortal.kept_back.clone();
        assert_eq!(file.len(), 1);
        mortal.ask(by("anna (Anna)", unsure())).unwrap();
        mortal.keep_all();
        assert!(mortal.kept_back.is_empty());
        if is_file_stale {
            mortal.kept_back = file;
        }
        let mut mortal = mortal.killed(0);
        mortal.ask(by("ben", safe())).unwrap();
        mortal.keep_all();
        assert!(mortal.state().luggage(LuggageId(1)).unwrap().is_pending(), "{restarts_before} {is_file_stale}");
    }
}

#[test]
fn a_judge_who_is_unsure_takes_an_earlier_safe_back() {
    let rules = Rules { safe_by: SafeBy::Two, unsure_views: 0, ..Rules::default() };
    let mut run = waits(&["S....", ".....", "..a..", ".....", "....."], rules);
    assert!(run.ask(by("anna", safe())).unwrap().is_kept_back);
    run.ask(by("anna (Anna)", unsure())).unwrap();
    assert!(run.ask(by("ben", safe())).unwrap().is_kept_back, "anna is unsure");
    assert!(!run.ask(by("anna", safe())).unwrap().is_kept_back);
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
