//! A past moment is shown as it was shown at that moment, as far as it is recorded.

use std::sync::Arc;

use hallsweep_core::command::{Command, Strategy, Verdict};
use hallsweep_core::engine::{Past, way_behind};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::place::Place;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::retrieval::RetrievalView;
use hallsweep_core::snapshot::{MissionView, Progress, Snapshot};
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::Entry;
use hallsweep_core::units::Seq;
use hallsweep_core::world::temperature::TemperatureView;
use hallsweep_sim::headless::Run;
use hallsweep_sim::pair::PairSettings;
use hallsweep_sim::{Camera, Hall, SimSettings};

use super::operator::{Operator, in_hall};

/// Past moment after these entries.
fn past(entries: &[Entry]) -> Past {
    let mut state = PersistentState::first(Strategy::Snail);
    entries.iter().for_each(|entry| state.apply(entry));
    let (seq, trail, temperatures) = (Seq(entries.len() as u64), way_behind(entries), entries.to_vec());
    Past { seq, state, trail, temperatures, latest: Vec::new() }
}

/// The mission without what is never recorded.
fn on_record(state: &Snapshot) -> MissionView {
    let mission = state.mission.clone();
    let progress = Progress { left: None, ..mission.progress };
    // A route that began before the first step ends at the robot's place.
    MissionView { route: Arc::default(), refusals: Default::default(), progress, ..mission }
}

fn check(run: &mut Run) {
    let live = run.state();
    let others = live.robots.iter().skip(1).map(|robot| robot.id.clone());
    let then = past(&run.journal).snapshot(Settings::default(), others);
    let place = run.journal.len();
    assert_eq!(on_record(&then), on_record(&live), "after entry {place}");
    assert_eq!(
        (then.robot.pose, then.robot.led_blinking, then.robot.outside),
        (live.robot.pose, live.robot.led_blinking, live.robot.outside)
    );
    let stand = |state: &Snapshot| {
        state.robots.iter().map(|robot| (robot.id.clone(), robot.view.pose, robot.view.outside)).collect::<Vec<_>>()
    };
    assert_eq!(stand(&then), stand(&live), "after entry {place}");
    assert!(then.map.known_bounds() == live.map.known_bounds() && then.map.visited() == live.map.visited());
    let cells = |state: &Snapshot| state.map.tiles().map(|(corner, _)| corner).collect::<Vec<_>>();
    assert_eq!(cells(&then), cells(&live));
    assert_eq!(then.luggage, live.luggage);
    assert_eq!(then.alarms, live.alarms);
    // A reading equal to the last one is not recorded.
    let warm = |state: &Snapshot| TemperatureView { read: None, ..state.temperature.clone() };
    assert_eq!(warm(&then), warm(&live), "after entry {place}");
    assert_eq!(fetched(&then), fetched(&live), "after entry {place}");
}

/// The retrieval without its trees, because ticks that change nothing are not recorded.
fn fetched(state: &Snapshot) -> Option<RetrievalView> {
    let view = state.retrieval.as_deref()?;
    Some(RetrievalView { trees: Arc::default(), ..view.clone() })
}

/// Advances until `reached` and checks every moment.
fn until(run: &mut Run, mut reached: impl FnMut(&Snapshot) -> bool) {
    while !reached(&run.state()) {
        check(run);
        assert!(run.advance(), "something goes on by itself");
    }
    check(run);
}

#[test]
fn every_moment_of_a_mission_is_shown_later_as_it_was_shown_then() {
    let mut run = in_hall("airport");
    run.give(Command::Start).unwrap();
    for _ in 0..3 {
        until(&mut run, |state| state.pending().is_some());
        let id = run.until_pending();
        if id.0 == 2 {
            run.reading(31.0).unwrap();
            check(&mut run);
            run.reading(20.0).unwrap();
            run.give(Command::Stop).unwrap();
        }
        run.verdict(id.0, Verdict::Safe).unwrap();
        if id.0 == 2 {
            until(&mut run, |state| state.pending().is_none());
            run.give(Command::Start).unwrap();
        }
    }
    until(&mut run, |state| state.pending().is_some());
    let id = run.until_pending();
    run.verdict(id.0, Verdict::Danger).unwrap();
    until(&mut run, |state| state.mission.phase == PhaseName::BombLocated);
}

#[test]
fn a_retrieval_by_the_pair_is_shown_later_as_it_was_shown_then() {
    let hall = Arc::new(Hall::from_rows("drawn", &["S...", "....", "..a.", "...."]).expect("it is sound"));
    let sim = SimSettings::new(1, Camera::Stub);
    let mut run = Run::with_pair(
        hall,
        sim,
        Settings::default(),
        Strategy::Snail,
        PairSettings { way_out: true, ..PairSettings::new(1, Place::ENTRANCE) },
    );
    run.give(Command::Start).unwrap();
    let id = run.until_pending();
    run.verdict(id.0, Verdict::Danger).unwrap();
    until(&mut run, |state| state.mission.phase == PhaseName::BombLocated);
    let alarms: Vec<_> = run.state().alarms.iter().filter_map(|alarm| alarm.id).collect();
    for alarm in alarms {
        run.give(Command::Acknowledge(alarm)).unwrap();
    }
    run.give(Command::Retrieve(None)).unwrap();
    until(&mut run, |state| state.mission.phase == PhaseName::BagSecured);
}
