//! Tests of the Roomba from the test plan of the original specification. They check order and duration of phases in
//! hundreds of runs, and compare machine and tree.

use std::collections::BTreeSet;
use std::f64::consts::{PI, TAU};

use super::compare::parting;
use super::driver::Driver;
use super::machine::Machine;
use super::room::{Body, RADIUS_M, ROOM_LENGTH_M, ROOM_WIDTH_M};
use super::run::driven_by;
use super::tree::Tree;
use super::*;
use hallsweep_core::rng::RandomStream;
use hallsweep_sim::BodyPose;

const SEEDS: u64 = 300;

fn minutes(count: f64) -> RunLength {
    RunLength::from_seconds(count * 60.0).unwrap()
}

fn machine(seed: u64) -> Run {
    Run::new(Controller::Machine, seed, minutes(2.0))
}

/// The completed phases of a run. Each has its phase, duration in ticks, angle, and the next phase.
fn ended(run: &Run) -> impl Iterator<Item = (Phase, u32, Option<f64>, Phase)> {
    let before = std::iter::once((0, None)).chain(run.transitions.iter().map(|change| (change.tick, change.angle)));
    before.zip(&run.transitions).map(|((began, angle), change)| (change.from, change.tick - began, angle, change.to))
}

#[test]
fn every_phase_lasts_and_ends_as_the_seed_says() {
    let mut met = BTreeSet::new();
    for seed in 0..SEEDS {
        let run = machine(seed);
        for (phase, ticks, angle, next) in ended(&run) {
            met.insert((phase.name(), next.name()));
            match (phase, next) {
                (Phase::MoveForward, Phase::MoveInSpiral) => assert_eq!(ticks, 180),
                (Phase::MoveInSpiral, Phase::MoveForward) => assert_eq!(ticks, 1200),
                (Phase::MoveForward, Phase::GoBack) => assert!((1..=180).contains(&ticks), "{ticks}"),
                (Phase::MoveInSpiral, Phase::GoBack) => assert!((1..=1200).contains(&ticks), "{ticks}"),
                (Phase::GoBack, Phase::Rotate) => assert_eq!(ticks, 30),
                (Phase::Rotate, Phase::MoveForward) => {
                    let exact = angle.unwrap().abs() / 0.5 * 60.0;
                    assert!((0.0..1.0 + 1e-6).contains(&(f64::from(ticks) - exact)), "{ticks} ticks for {exact}");
                }
                other @ (Phase::MoveForward | Phase::MoveInSpiral | Phase::GoBack | Phase::Rotate, _) => panic!("{other:?}"),
            }
        }
    }
    assert_eq!(met.len(), 6, "{met:?}");
}

#[test]
fn a_wall_that_is_met_ends_the_phase_in_the_next_tick_and_nothing_else_leads_back() {
    for seed in 0..SEEDS {
        let run = machine(seed);
        for frame in run.frames.iter().filter(|frame| frame.bumper && frame.phase.heeds_bumper()) {
            let next = run.transitions.iter().find(|change| change.tick >= frame.tick);
            let at_the_end = frame.tick == 7200;
            assert!(at_the_end || next.is_some_and(|next| next.tick == frame.tick && next.to == Phase::GoBack), "{frame:?}");
        }
        for change in run.transitions.iter().filter(|change| change.to == Phase::GoBack) {
            assert!(run.frames[change.tick as usize].bumper, "{change:?}");
        }
    }
}

#[test]
fn a_turn_ends_at_its_angle_from_where_it_began() {
    let run = machine(5);
    let turns: Vec<_> = run.transitions.windows(2).filter(|pair| pair[0].to == Phase::Rotate).collect();
    assert!(turns.len() > 3);
    for pair in turns {
        let heading = |tick: u32| run.frames[tick as usize].pose;
        let (before, after) = (heading(pair[0].tick), heading(pair[1].tick));
        assert!(hallsweep_sim::normal(after.theta - before.theta - pair[0].angle.unwrap()).abs() < 1e-9, "{pair:?}");
        assert_eq!((before.x_m, before.y_m), (after.x_m, after.y_m), "a turn stays where it is");
    }
}

#[test]
fn the_robot_never_leaves_the_room_nor_goes_faster_than_it_can() {
    for seed in 0..SEEDS {
        let run = machine(seed);
        for pair in run.frames.windows(2) {
            let BodyPose { x_m, y_m, theta } = pair[1].pose;
            assert!((RADIUS_M..=ROOM_LENGTH_M - RADIUS_M).contains(&x_m) && (RADIUS_M..=ROOM_WIDTH_M - RADIUS_M).contains(&y_m));
            let before = pair[0].pose;
            assert!((x_m - before.x_m).hypot(y_m - before.y_m) <= 0.5 / 60.0 + 1e-9);
            assert!(hallsweep_sim::normal(theta - before.theta).abs() <= 2.0 / 60.0 + 1e-9);
        }
    }
}

/// Every frame must be equal to the last bit. Transitions, angles and times are equal then too.
#[test]
fn machine_and_tree_do_the_same_with_the_same_seed() {
    let mut turns = 0;
    for seed in 0..SEEDS {
        let (machine, tree) = (machine(seed), Run::new(Controller::Tree, seed, minutes(2.0)));
        assert_eq!(parting(&machine, &tree), None, "seed {seed}");
        assert!(machine.frames == tree.frames && machine.figures == tree.figures, "seed {seed}");
        turns += machine.transitions.iter().filter(|change| change.angle.is_some()).count();
    }
    assert!(turns > SEEDS as usize, "there is something to compare: {turns} turns");
}

#[test]
fn from_the_same_place_machine_and_tree_do_the_same_wherever_it_is() {
    let mut chance = RandomStream::new(7, "places");
    for seed in 0..SEEDS {
        let x_m = RADIUS_M + chance.fraction() * (ROOM_LENGTH_M - 2.0 * RADIUS_M);
        let y_m = RADIUS_M + chance.fraction() * (ROOM_WIDTH_M - 2.0 * RADIUS_M);
        let pose = BodyPose { x_m, y_m, theta: chance.fraction() * TAU - PI };
        let start = Body { pose, bumper: chance.happens(0.2) };
        let one = driven_by(Machine::new(seed), Controller::Machine, seed, minutes(1.0), start);
        let other = driven_by(Tree::new(seed), Controller::Tree, seed, minutes(1.0), start);
        assert_eq!(parting(&one, &other), None, "seed {seed} from {start:?}");
        assert!(one.frames == other.frames, "seed {seed} from {start:?}");
    }
}

/// Presses the bumper where no room has walls: in the last tick of a phase, in several ticks in a row, and during
/// GoBack and Rotate.
#[test]
fn machine_and_tree_do_the_same_wherever_walls_are_met() {
    let mut chance = RandomStream::new(7, "walls");
    for seed in 0..SEEDS {
        let (mut machine, mut tree) = (Machine::new(seed), Tree::new(seed));
        let (seldom, at_the_end) = (chance.fraction() * 0.02, chance.happens(0.5));
        for tick in 0..5000 {
            let ends = machine.motion().is_over() && at_the_end;
            let bumper = ends || chance.happens(seldom);
            let velocities = (machine.tick(bumper), tree.tick(bumper));
            assert_eq!(velocities.0, velocities.1, "seed {seed}, tick {tick}");
            assert_eq!(machine.motion(), tree.motion(), "seed {seed}, tick {tick}");
        }
    }
}

#[test]
fn a_seed_gives_its_run_again_and_another_seed_gives_another() {
    let length = RunLength::from_seconds(300.0).unwrap();
    let of = |seed| Run::new(Controller::Machine, seed, length);
    assert_eq!(of(3), of(3));
    let angles = |run: Run| run.transitions.into_iter().filter_map(|change| change.angle).map(f64::to_bits).collect::<Vec<_>>();
    assert_ne!(angles(of(3)), angles(of(4)));
    assert_ne!(angles(of(u64::MAX)), angles(of(0)));
}

#[test]
fn the_figures_of_a_run_agree_with_its_frames() {
    let run = machine(11);
    let figures = run.figures;
    assert_eq!(run.frames.len(), 7201);
    assert_eq!(figures.seconds, 120.0);
    assert!((figures.in_phase_s.iter().sum::<f64>() - 120.0).abs() < 1e-9);
    let driving = figures.in_phase_s[0] + figures.in_phase_s[1];
    // Forward speed is 0.5 m/s and backward speed 0.1 m/s. Each wall may cut off a part of one tick.
    let most = driving * 0.5 + figures.in_phase_s[2] * 0.1;
    assert!((most - 0.01 * f64::from(figures.bumps) - 0.01..=most + 1e-9).contains(&figures.path_m), "{figures:?}");
    assert!(figures.passed <= figures.reachable && figures.share() > 0.1);
}

#[test]
fn a_longer_run_begins_as_the_shorter_one_and_has_passed_over_more() {
    let (short, long) = (machine(2), Run::new(Controller::Machine, 2, minutes(4.0)));
    assert_eq!(short.frames[..], long.frames[..short.frames.len()]);
    assert_eq!(short.transitions[..], long.transitions[..short.transitions.len()]);
    assert!(long.figures.passed > short.figures.passed);
}
