//! The remaining driving time that a search estimates, from START to the end.

use std::sync::Arc;
use std::time::Duration;

use hallsweep_core::command::{Command, Strategy, Verdict};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::{Snapshot, TimeLeft};
use hallsweep_sim::headless::Run;
use hallsweep_sim::{Camera, Hall, SimSettings};

use crate::operator::{Operator, PLENTY};

fn search(strategy: Strategy) -> Run {
    let hall = Hall::named_or_file("airport").expect("it comes with the program");
    let mut run = Run::new(Arc::new(hall), SimSettings::new(1, Camera::Stub), Settings::default(), strategy);
    run.give(Command::Start).unwrap();
    run
}

/// Answers safe for every piece until `is_so` is true.
fn until(run: &mut Run, mut is_so: impl FnMut(&Snapshot) -> bool) {
    for _ in 0..PLENTY {
        let state = run.state();
        if is_so(&state) {
            return;
        }
        match state.pending().filter(|piece| piece.has_photo()) {
            Some(piece) => drop(run.verdict(piece.id.0, Verdict::Safe).unwrap()),
            None => assert!(run.advance(), "nothing more happens"),
        }
    }
    panic!("it is never so");
}

fn left(run: &mut Run) -> Option<TimeLeft> {
    run.state().mission.progress.left
}

#[test]
fn it_is_said_as_soon_as_enough_is_known_and_no_more_once_nothing_is_open() {
    let mut run = search(Strategy::Spiral);
    assert_eq!(left(&mut run), None);
    until(&mut run, |state| state.mission.progress.left.is_some());
    assert!((8..14).contains(&run.state().mission.progress.visited));
    until(&mut run, |state| state.mission.progress.left.is_some_and(|left| left.most.is_some()));
    let TimeLeft { least, most } = left(&mut run).unwrap();
    let (begins, most) = (run.now().since_start, most.unwrap());
    assert!(!least.is_zero() && least < most, "{least:?} to {most:?}");
    run.until_explored();
    assert_eq!(left(&mut run), None);
    // The estimate does not include photos.
    let lasted = run.now().since_start - begins;
    assert!((least..=most + Duration::from_secs(60)).contains(&lasted), "{lasted:?}, said was {least:?} to {most:?}");
}

#[test]
fn it_stays_while_the_search_is_held_goes_with_it_and_a_new_one_counts_anew() {
    let mut run = search(Strategy::Spiral);
    until(&mut run, |state| state.mission.progress.left.is_some());
    run.give(Command::Stop).unwrap();
    assert!(left(&mut run).is_some());
    run.give(Command::Start).unwrap();
    run.give(Command::BackHome).unwrap();
    assert_eq!(left(&mut run), None, "it goes home, and does not search");
    run.until_phase(PhaseName::AtHome);
    run.give(Command::Start).unwrap();
    assert!(left(&mut run).is_some(), "the search goes on");
    run.until_explored();
    run.give(Command::Start).unwrap();
    assert_eq!(left(&mut run), None);
}

#[test]
fn of_a_snail_only_the_least_is_said() {
    let mut run = search(Strategy::Snail);
    until(&mut run, |state| state.mission.progress.left.is_some());
    until(&mut run, |state| {
        assert!(state.mission.progress.left.is_none_or(|left| left.most.is_none()), "{state:?}");
        state.mission.phase == PhaseName::Explored
    });
}
