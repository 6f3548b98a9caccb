//! Mission §4 rule 4 and §7: verdicts, failing photos, pieces of several cells, and obstacles that the camera cannot
//! identify.

use std::sync::Arc;

use hallsweep_core::bomb_size::BombSize;
use hallsweep_core::command::{Command, Hot, LuggageRef, Strategy, Verdict};
use hallsweep_core::event::{RobotEvent, Whereabouts};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::settings::Settings;
use hallsweep_core::units::{Cell, Heading, LuggageId, Pose};
use hallsweep_core::world::hall_map::Mark;
use hallsweep_core::world::luggage::PhotoState;
use hallsweep_sim::headless::{Run, Verdicts, explore};
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::bare::Bare;
use crate::operator::{Operator, drawn_with, in_drawn};

fn at_the_bag() -> Run {
    let mut run = in_drawn(&["S...", ".a..", "....", "...."]);
    run.give(Command::Start).unwrap();
    run.until_pending();
    run
}

#[test]
fn an_equal_repeat_is_answered_and_another_verdict_is_refused() {
    let mut run = at_the_bag();
    run.verdict(1, Verdict::Safe).unwrap();
    assert_eq!(run.verdict(1, Verdict::Safe).map(|accepted| accepted.luggage), Ok(Some(LuggageId(1))));
    let refused = Refused::Decided { luggage: LuggageId(1), verdict: Verdict::Safe };
    assert_eq!(run.verdict(1, Verdict::Danger), Err(refused));
    assert_eq!(run.verdict(7, Verdict::Safe), Err(Refused::UnknownLuggage(LuggageId(7))));
    assert_eq!(run.phase(), PhaseName::Exploring);
}

/// With a sonar that sees three cells, the robot photographs a piece from where the sonar saw it, without a bump.
#[test]
fn a_piece_is_photographed_from_where_the_sonar_sees_it() {
    let hall = Arc::new(Hall::from_rows("drawn", &["S..a", "#...", "...."]).unwrap());
    let sim = SimSettings { sonar_cells: 3, ..SimSettings::new(1, Camera::Stub) };
    let settings = Settings { sonar_cells: 3, ..Settings::default() };
    let mut run = Run::new(hall, sim, settings, Strategy::Columns);
    run.give(Command::Start).unwrap();
    run.until_pending();
    let state = run.state();
    let piece = &state.luggage[0];
    assert_eq!((piece.cell, piece.pose), (Cell::new(3, 0), Pose { cell: Cell::new(0, 0), heading: Heading::East }));
    assert_eq!(state.map.at(Cell::new(2, 0)), Mark::Seen);
    run.until_explored();
    assert_eq!(run.state().luggage.iter().count(), 1, "it is not asked about again from nearby");
    assert_eq!(run.state().map.at(Cell::new(2, 0)), Mark::Visited);
}

#[test]
fn a_bare_word_means_the_one_pending_piece_and_is_refused_when_there_is_none() {
    let mut run = at_the_bag();
    let safe = Command::Verdict { luggage: LuggageRef::Pending, verdict: Verdict::Safe, note: None, hot: Default::default() };
    run.give(safe.clone()).unwrap();
    assert_eq!(run.give(safe), Err(Refused::NothingPending));
}

#[test]
fn under_a_failed_store_a_verdict_is_refused_but_danger_still_alarms() {
    use hallsweep_core::event::Event;
    let mut run = at_the_bag();
    let now = run.now();
    run.engine.handle_event(Event::StoreFailed("disk full".to_owned()), now);
    assert_eq!(run.verdict(1, Verdict::Safe), Err(Refused::StoreDown));
    assert!(run.state().alarms.is_empty());
    assert_eq!(run.verdict(1, Verdict::Danger), Err(Refused::StoreDown));
    assert_eq!(run.state().alarms.len(), 1);
    assert!(run.state().luggage[0].is_pending());
}

/// Safety V2.
#[test]
fn without_a_photo_there_is_no_safe_and_it_can_be_taken_again() {
    let settings = SimSettings { photo_failure_rate: 0.5, ..SimSettings::new(3, Camera::Stub) };
    let (mut failed, mut took) = (0, 0);
    for seed in 0..16 {
        let mut run = drawn_with(&["S...", ".a..", "....", "...."], SimSettings { seed, ..settings });
        run.give(Command::Start).unwrap();
        run.until_pending();
        while !run.state().luggage[0].has_photo() {
            failed += 1;
            assert_eq!(run.verdict(1, Verdict::Safe), Err(Refused::NoPhoto(LuggageId(1))));
            run.give(Command::RetakePhoto(LuggageId(1))).unwrap();
            assert_eq!(run.give(Command::RetakePhoto(LuggageId(1))), Err(Refused::PhotoUnderWay));
            run.wait(1.0);
        }
        took += 1;
        run.verdict(1, Verdict::Safe).unwrap();
    }
    assert!(failed > 0 && took == 16, "the seeds must show both");
}

/// Rule 10: the robot drives back to a piece that it left without a photo.
#[test]
fn a_piece_left_without_a_photo_is_photographed_again_after_the_next_start() {
    let settings = SimSettings { photo_failure_rate: 0.5, ..SimSettings::new(0, Camera::Stub) };
    let seed =
        (0..64).find(|seed| first_photo_fails(SimSettings { seed: *seed, ..settings })).expect("one of 64 first photos fails");
    let mut run = drawn_with(&["S...", ".a..", "....", "...."], SimSettings { seed, ..settings });
    run.give(Command::Start).unwrap();
    run.until_pending();
    let pose = run.state().luggage[0].pose;
    run.give(Command::BackHome).unwrap();
    run.until_phase(PhaseName::AtHome);
    run.give(Command::Start).unwrap();
    run.until("back at the piece", |state| state.mission.inspected == Some(LuggageId(1)));
    assert_eq!(run.state().robot.pose, pose);
    run.until("its photo, or another failure", |state| state.robot.state == hallsweep_core::robot::RobotState::Stopped);
    assert_eq!(run.state().luggage.len(), 1, "it stays one record");
}

fn first_photo_fails(settings: SimSettings) -> bool {
    let mut run = drawn_with(&["S...", ".a..", "....", "...."], settings);
    run.give(Command::Start).unwrap();
    run.until_pending();
    matches!(run.state().luggage[0].photo, PhotoState::Failed(_))
}

#[test]
fn a_retaken_photo_replaces_the_first_and_stays_one_record() {
    let mut run = at_the_bag();
    run.give(Command::RetakePhoto(LuggageId(1))).unwrap();
    run.wait(2.0);
    assert!(matches!(run.state().luggage[0].photo, PhotoState::Taken { take: 2, .. }));
    assert_eq!(run.state().luggage.len(), 1);
    assert_eq!(run.give(Command::RetakePhoto(LuggageId(2))), Err(Refused::UnknownLuggage(LuggageId(2))));
}

/// Mission §7: a piece may cover several cells.
#[test]
fn a_piece_of_several_cells_is_asked_about_once() {
    let mut run = in_drawn(&["S....", ".aaa.", ".....", "....."]);
    run.give(Command::Start).unwrap();
    run.until_explored();
    let state = run.state();
    assert_eq!(state.luggage.len(), 1);
    assert!((1..=3).all(|x| state.map.at(Cell::new(x, 1)) == Mark::Luggage));
}

/// Rule 3, `backHome`: a piece stays a target until its record exists.
#[test]
fn back_home_before_the_record_exists_leaves_the_piece_to_be_inspected_later() {
    let mut run = in_drawn(&["S...", ".a..", "....", "...."]);
    run.give(Command::Start).unwrap();
    run.until("backing up", |state| state.mission.phase == PhaseName::Inspecting);
    run.give(Command::BackHome).unwrap();
    assert_eq!(run.state().map.at(Cell::new(1, 1)), Mark::NotInspected);
    run.until_phase(PhaseName::AtHome);
    run.give(Command::Start).unwrap();
    run.until_explored();
    assert_eq!(run.state().luggage.len(), 1);
}

#[test]
fn stopped_while_backing_up_the_inspection_goes_on_after_start() {
    let mut run = in_drawn(&["S...", ".a..", "....", "...."]);
    run.give(Command::Start).unwrap();
    run.until("backing up", |state| state.mission.phase == PhaseName::Inspecting);
    run.give(Command::Stop).unwrap();
    run.stands_still();
    run.give(Command::Start).unwrap();
    run.until_pending();
    run.verdict(1, Verdict::Safe).unwrap();
    run.until_explored();
}

/// Mission §3: a camera that cannot identify an obstacle, and the behaviour of the original.
#[test]
fn what_cannot_be_told_is_inspected_and_so_is_everything_when_asked_for() {
    let hall = std::sync::Arc::new(Hall::from_rows("small", &["S...", ".a..", "...."]).unwrap());
    let run = |sim, settings| explore(&hall, sim, settings, Default::default(), Verdicts::AllSafe, |_| {});
    let usual = run(SimSettings::new(1, Camera::Stub), Settings::default());
    assert_eq!(usual.luggage.len(), 1);
    let blind = run(SimSettings { unknown_rate: 1.0, ..SimSettings::new(1, Camera::Stub) }, Settings::default());
    let original = run(SimSettings::new(1, Camera::Stub), Settings { inspect_everything: true, ..Settings::default() });
    assert!(blind.complete && blind.luggage.len() == 15, "{} pieces", blind.luggage.len());
    assert!(original.complete && original.luggage.len() == 15, "{} pieces", original.luggage.len());
}

/// Another robot has replaced the one that found the piece, and stands at the entrance. Its photo would show
/// something else as the piece.
#[test]
fn a_robot_that_stands_elsewhere_takes_no_photo_of_the_piece() {
    let mut bare = Bare::at_a_bag();
    bare.robot(RobotEvent::LinkLost("bert has taken the place of ada".to_owned()));
    bare.robot(RobotEvent::Stands(Whereabouts { pose: Pose::START, off_centre: false }));
    bare.link_up();
    assert_eq!(bare.give(Command::RetakePhoto(LuggageId(1))), Err(Refused::NotInspected(LuggageId(1))));
    assert!(bare.verdict(Verdict::Safe).is_ok(), "the first photo shows the piece");
}

/// Safety V1: the size of a bomb is a part of the verdict, so it is final, too.
#[test]
fn the_size_of_a_bomb_is_final() {
    let mut run = in_drawn(&["S...", ".a..", "...."]);
    run.give(Command::Start).unwrap();
    let id = run.until_pending();
    let danger = |size| Command::Verdict {
        luggage: LuggageRef::Id(id),
        verdict: Verdict::Danger,
        note: None,
        hot: Hot { size, ..Hot::NONE },
    };
    run.give(danger(Some(BombSize::Vest))).unwrap();
    run.give(danger(Some(BombSize::Vest))).expect("a repeat");
    run.give(danger(None)).expect("a repeat");
    let refused = Refused::Decided { luggage: id, verdict: Verdict::Danger };
    for other in [BombSize::Car, BombSize::Radius(34)] {
        assert_eq!(run.give(danger(Some(other))), Err(refused.clone()));
    }
    let state = run.state();
    let kept = state.luggage(id).and_then(|piece| piece.verdict.as_ref()).map(|decision| decision.hot.size);
    assert_eq!(kept, Some(Some(BombSize::Vest)));
}
