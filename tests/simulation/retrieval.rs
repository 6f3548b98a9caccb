//! From the verdict danger to the bag in the container: the pair, controlled by its trees, in the halls that come
//! with the program and in random ones.

use std::sync::Arc;

use hallsweep_core::command::{Command, LuggageRef, Strategy, Verdict};
use hallsweep_core::pair::Which;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::place::Place;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{LuggageId, Piece};
use hallsweep_sim::headless::Run;
use hallsweep_sim::pair::PairSettings;
use hallsweep_sim::{Camera, Hall, SimSettings};

/// Number of events that exceeds any retrieval in these halls.
const LONG: usize = 2_000_000;

fn pair(seed: u64) -> PairSettings {
    PairSettings { way_out: true, ..PairSettings::new(seed, Place::ENTRANCE) }
}

/// Mission with a pair outside, after START.
fn begun(hall: Hall, settings: Settings, pair: PairSettings) -> Run {
    let sim = SimSettings { sonar_noise_cm: 0.0, ..SimSettings::new(pair.seed, Camera::Stub) };
    let mut run = Run::with_pair(Arc::new(hall), sim, settings, Strategy::Snail, pair);
    run.give(Command::Start).expect("nothing holds it");
    run
}

fn asked(state: &Snapshot) -> Option<(LuggageId, Piece)> {
    let luggage = state.mission.inspected.and_then(|id| state.luggage(id)).filter(|luggage| luggage.is_pending())?;
    Some((luggage.id, luggage.piece?))
}

/// Searches until this piece is found and judged dangerous and discovery is home; all other pieces are judged safe.
/// False when the piece is never found.
fn locate(run: &mut Run, bomb: Piece) -> bool {
    let mut found = false;
    for _ in 0..LONG {
        let state = run.state();
        match (asked(&state), state.mission.phase) {
            (Some((id, piece)), _) => {
                found |= piece == bomb;
                let verdict = if piece == bomb { Verdict::Danger } else { Verdict::Safe };
                run.give(Command::Verdict { luggage: LuggageRef::Id(id), verdict, note: None, hot: Default::default() })
                    .expect("it is asked about");
            }
            (None, PhaseName::BombLocated | PhaseName::Explored) => return found,
            (None, _) => assert!(run.advance(), "nothing happens any more in {:?}", state.mission),
        }
    }
    panic!("the search has no end");
}

fn is_over(state: &Snapshot) -> bool {
    matches!(state.mission.phase, PhaseName::BagSecured | PhaseName::Fault) || !state.mission.holds.is_empty()
}

/// Continues until the retrieval ends or is held.
fn go_on(run: &mut Run) -> Arc<Snapshot> {
    assert!(run.run_until(LONG, is_over), "the retrieval has no end: {:?}", run.state().mission);
    run.state()
}

fn check_secured(run: &mut Run, bomb: Piece) {
    let state = run.state();
    let why = || (state.mission.fault.clone(), state.log.iter().map(|line| line.said.to_string()).collect::<Vec<_>>());
    assert_eq!(state.mission.phase, PhaseName::BagSecured, "{bomb:?}: {:#?}", why());
    assert_eq!(run.pair.as_ref().expect("there is a pair").taken_in(), [bomb], "the container holds that very bag");
    assert!(state.luggage.iter().any(|luggage| luggage.piece == Some(bomb) && luggage.secured.is_some()));
    assert!(
        state.robots.iter().all(|robot| (robot.view.outside > 0) == (robot.id.name() != "discovery")),
        "all are where they began"
    );
    assert_eq!(state.retrieval, None);
}

fn ticks(run: &mut Run) -> u64 {
    run.state().retrieval.as_ref().map_or(0, |retrieval| retrieval.trees.ticks)
}

fn built_in(name: &str) -> Hall {
    Hall::named_or_file(name).expect("it comes with the program")
}

#[test]
fn every_bag_of_the_built_in_halls_can_be_secured() {
    for name in ["airport", "seed"] {
        let pieces = built_in(name).pieces().to_vec();
        for bag in pieces {
            let mut run = begun(built_in(name), Settings::default(), pair(1));
            assert!(locate(&mut run, bag.piece), "{name}: {bag:?}");
            run.give(Command::Retrieve(None)).expect("discovery is home");
            go_on(&mut run);
            check_secured(&mut run, bag.piece);
        }
    }
}

#[test]
fn after_a_retrieval_a_new_mission_begins_and_the_bag_is_not_met_again() {
    let mut run = begun(built_in("seed"), Settings::default(), pair(1));
    assert!(locate(&mut run, Piece(1)));
    run.give(Command::Retrieve(None)).expect("discovery is home");
    go_on(&mut run);
    run.give(Command::Start).expect("the bag is in the container");
    assert!(!locate(&mut run, Piece(1)), "it is in the container");
    assert_eq!(run.phase(), PhaseName::Explored);
    assert_eq!(run.state().luggage.len(), 2);
}

#[test]
fn stop_halts_the_retrieval_where_it_stands_and_start_goes_on() {
    let mut run = begun(built_in("seed"), Settings::default(), pair(1));
    assert!(locate(&mut run, Piece(1)));
    run.give(Command::Retrieve(None)).expect("discovery is home");
    for _ in 0..40 {
        run.wait(1.7);
        if run.phase() != PhaseName::Retrieving {
            break;
        }
        run.give(Command::Stop).expect("a stop is never refused");
        let places = |run: &Run| Which::ALL.map(|which| run.pair.as_ref().expect("a pair").body(which));
        let before = (places(&run), ticks(&mut run));
        run.wait(5.0);
        assert_eq!((places(&run), ticks(&mut run)), before, "nothing moves, and no tree is ticked");
        run.give(Command::Start).expect("nothing holds it but the stop");
    }
    go_on(&mut run);
    check_secured(&mut run, Piece(1));
}
