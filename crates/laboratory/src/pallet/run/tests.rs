//! Tests of the pallet scenario. All parcels arrive, and every branch of the three trees is reached. No failed run is
//! reported as a success. No STOP and no kill changes the result.

mod halls;

use std::collections::{BTreeMap, BTreeSet};

use super::super::yard::MOST_PARCELS;
use super::*;
use behaviour_trees::Status;
use hallsweep_core::pair::Saying;
use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::rng::RandomStream;
use hallsweep_sim::Hall;
use hallsweep_sim::pair::Slip;

fn run(parcels: u32, seed: u64, asked: Asked) -> PalletRun {
    PalletRun::new(parcels, seed, asked).unwrap()
}

fn mishaps(mishaps: Mishaps) -> Asked {
    Asked { mishaps, ..Asked::default() }
}

fn slips(slips: &[(u32, u32)]) -> Asked {
    let slips = slips.iter().map(|(parcel, after_steps)| Slip { parcel: *parcel, after_steps: *after_steps }).collect();
    mishaps(Mishaps { slips, ..Mishaps::default() })
}

fn unrecognised(parcel: u32) -> Asked {
    mishaps(Mishaps { unrecognised: vec![parcel], ..Mishaps::default() })
}

fn jammed(parcel: u32) -> Asked {
    mishaps(Mishaps { jams: vec![parcel], ..Mishaps::default() })
}

fn phases(run: &PalletRun, parcel: u32) -> Vec<usize> {
    let of = |entry: &Entry| {
        if let News::Began(phase) = entry.news { Some(phase.number()).filter(|_| entry.parcel == parcel) } else { None }
    };
    run.entries().iter().filter_map(of).collect()
}

fn said(run: &PalletRun) -> Vec<Saying> {
    run.entries().iter().filter_map(|entry| if let News::Said(saying) = entry.news { Some(saying) } else { None }).collect()
}

/// The statuses that each node of each tree has returned.
type Coverage = BTreeSet<(usize, String, &'static str)>;

fn cover(run: &mut PalletRun, seen: &mut Coverage) {
    let mut watch = |team: &Team| {
        for (tree, nodes) in team.trees().iter().enumerate() {
            let said = nodes.nodes().filter_map(|node| Some((tree, node.name.to_owned(), node.returned?.word())));
            seen.extend(said);
        }
    };
    while run.advance(&mut watch) {}
}

#[test]
fn all_parcels_arrive_from_hundreds_of_yards() {
    for seed in 0..200 {
        let parcels = 1 + u32::try_from(seed % 3).unwrap();
        let figures = run(parcels, seed, Asked::default()).finish();
        assert_eq!((figures.fault, figures.delivered, figures.losses), (None, parcels as usize, 0), "seed {seed}");
    }
}

#[test]
fn a_full_pallet_is_emptied_in_order() {
    let mut run = run(MOST_PARCELS, 5, Asked::default());
    let figures = run.finish();
    assert_eq!((figures.fault, figures.delivered), (None, MOST_PARCELS as usize));
    assert_eq!(run.team.delivered(), run.pair.taken_in());
    assert!(run.parcels().is_empty());
}

#[test]
fn the_phases_of_the_scenario_pass_in_their_order_for_every_parcel() {
    let mut run = run(3, 11, Asked::default());
    run.finish();
    assert_eq!(phases(&run, 1), [1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(phases(&run, 2), [8, 3, 4, 5, 6, 7]);
    assert_eq!(phases(&run, 3), [8, 3, 4, 5, 6, 7]);
    assert!(run.entries().is_sorted_by_key(|entry| entry.at));
}

#[test]
fn force_angle_and_distance_stay_within_their_limits_while_parcels_are_carried() {
    for seed in 0..20 {
        let held = run(2, seed, Asked::default()).finish().holding;
        assert!(
            held.force_n.worst() < hallsweep_sim::pair::FORCE_LIMIT_N / 2.0 && held.force_n.rms() > 0.0,
            "seed {seed}: {held:?}"
        );
        assert!(held.angle_rad.worst() < hallsweep_sim::pair::ANGLE_LIMIT / 3.0, "seed {seed}: {held:?}");
        assert!(held.gap_m.worst() < hallsweep_sim::pair::GAP_LIMIT_M / 2.0, "seed {seed}: {held:?}");
    }
}

#[test]
fn a_parcel_lost_on_the_way_is_picked_up_where_it_lies_after_an_alarm_and_start() {
    let mut run = run(2, 3, slips(&[(1, 3)]));
    let figures = run.finish();
    assert_eq!((figures.fault, figures.delivered, figures.losses), (None, 2, 1));
    assert_eq!(said(&run), [Saying::PackageLost]);
    assert_eq!(phases(&run, 1), [1, 2, 3, 4, 5, 3, 4, 5, 6, 7]);
    let news: Vec<News> = run.entries().iter().map(|entry| entry.news).filter(|news| !matches!(news, News::Began(_))).collect();
    assert_eq!(news, [News::Lost, News::Said(Saying::PackageLost), News::Acknowledged, News::Started]);
}

#[test]
fn a_parcel_lost_while_it_is_lifted_calls_the_operator_once_and_is_not_carried_on_empty() {
    let mut run = run(1, 3, slips(&[(1, 0)]));
    let figures = run.finish();
    assert_eq!((figures.fault, figures.delivered, figures.losses), (None, 1, 1));
    assert_eq!(said(&run), [Saying::PackageLost], "the tree itself has said so");
}

#[test]
fn a_parcel_that_is_not_recognised_calls_the_operator_and_then_it_goes_on() {
    let mut run = run(2, 8, unrecognised(2));
    let figures = run.finish();
    assert_eq!((figures.fault, figures.delivered), (None, 2));
    assert_eq!(said(&run), [Saying::CallOperator]);
}

#[test]
fn what_cannot_be_done_ends_in_a_fault_with_a_name() {
    let absent = |asked: Asked| Asked { absent: true, ..asked };
    for (asked, delivered, name) in [
        (Asked { blocked: vec![2], ..Asked::default() }, 1, "noWayToTarget"),
        (jammed(2), 1, "robotFails"),
        (absent(unrecognised(2)), 1, "operatorAbsent"),
        (absent(slips(&[(1, 2)])), 0, "operatorAbsent"),
        (slips(&(0..20).map(|_| (1, 0)).collect::<Vec<_>>()), 0, "lostTooOften"),
    ] {
        let mut run = run(3, 4, asked);
        let figures = run.finish();
        assert_eq!((figures.fault.map(PalletFault::name), figures.delivered), (Some(name), delivered));
        assert!(!run.advance(|_| {}), "it has ended");
    }
}

/// A run that continues after it ended with a jammed gripper, which was then repaired. The trees are new, and the
/// grippers are already at the parcel.
fn mended() -> PalletRun {
    let mut run = run(1, 4, jammed(1));
    assert_eq!(run.finish().fault, Some(PalletFault::Pair(RetrievalFault::RobotFails)));
    run.settings.mishaps.jams.clear();
    run.team = Team::new();
    run.restart();
    run.ended = None;
    assert!(run.start());
    run
}

#[test]
fn trees_that_begin_anew_after_a_fault_bring_the_parcel_to_the_target_area() {
    assert_eq!(mended().finish().fault, None);
}

#[test]
fn every_branch_of_the_three_trees_is_reached() {
    let mut seen = Coverage::new();
    for asked in [Asked::default(), slips(&[(1, 2)]), slips(&[(1, 0)]), unrecognised(1), jammed(1)] {
        cover(&mut run(2, 2, asked), &mut seen);
    }
    cover(&mut run(2, 2, Asked { blocked: vec![1], ..Asked::default() }), &mut seen);
    // SRM2 stands beside the pallet already, so it does not have to come.
    let beside = BasePose { place: Place::Cell(Cell::new(1, 1)), ..Yard::new(1, 2).unwrap().starts[0] };
    let hall = Hall::from_rows("beside", &["ST...", ".....", "....."]).unwrap();
    let starts = [Yard::new(1, 2).unwrap().starts[0], beside];
    let parcels = vec![(hall.pieces()[0].piece, Cell::new(1, 0))];
    let yard = Yard { hall: Arc::new(hall), starts, target: Place::Cell(Cell::new(2, 1)), way_out: false, parcels };
    cover(&mut PalletRun::of(yard, 1, Asked::default()), &mut seen);
    cover(&mut mended(), &mut seen);
    for seed in 0..12 {
        cover(&mut run(3, seed, Asked::default()), &mut seen);
    }
    let team = Team::new();
    let mut missing = BTreeMap::new();
    for (tree, nodes) in team.trees().iter().enumerate() {
        for node in nodes.nodes() {
            let said = |word: &str| seen.contains(&(tree, node.name.to_owned(), word));
            if !said(Status::Success.word()) {
                missing.insert((tree, node.name.to_owned(), "SUCCESS"), ());
            }
        }
    }
    assert!(missing.is_empty(), "{:?}", missing.keys());
    // These nodes must have failed at least once (`supervisor_fails`) or have been running at least once
    // (`supervisor_runs`).
    let supervisor_fails = [
        "Supervisor",
        "FindParcel",
        "ARM1-ARM2",
        "EE",
        "CloseGripper",
        "Pick-UpPrepSequence",
        "LiftObj",
        "TransportSequence",
        "Transport",
        "TargetArea",
        "DropPos",
    ];
    let supervisor_runs = [
        "SRM1-SRM2",
        "IdentifySequence",
        "FindParcel",
        "CallOperator",
        "CorrectBasePos",
        "SetEE",
        "CloseGripper",
        "StartHolding",
        "LiftObj",
        "PackageLost",
        "Transport",
        "TargetArea",
        "AdjustPositioning",
        "Drop",
        "Release",
        "ReturnToPallet",
    ];
    let expected = supervisor_fails
        .map(|name| (2, name, "FAILURE"))
        .into_iter()
        .chain(supervisor_runs.map(|name| (2, name, "RUNNING")))
        .chain([(0, "NearPallet", "FAILURE"), (0, "SRM2_near_pallet", "FAILURE"), (0, "ApproachPallet", "RUNNING")])
        .chain([(0, "WaitForSRM2", "RUNNING"), (1, "PalletReceived", "FAILURE"), (1, "NearPallet", "FAILURE")])
        .chain([(1, "ApproachPallet", "RUNNING"), (1, "SRM2_to_LoadSite", "FAILURE"), (0, "SRM1-SRM2", "RUNNING")]);
    let absent: Vec<_> = expected.filter(|(tree, name, word)| !seen.contains(&(*tree, (*name).to_owned(), word))).collect();
    assert!(absent.is_empty(), "{absent:?}");
}

#[test]
fn srm2_waits_until_srm1_has_spoken_and_the_barrier_stays_open_for_every_parcel() {
    let mut run = run(3, 6, Asked::default());
    let mut heard_first = None;
    let mut barrier = Vec::new();
    let mut ticks = 0;
    let mut watch = |team: &Team| {
        ticks += 1;
        let said =
            |tree: usize, name: &str| team.trees()[tree].nodes().find(|node| node.name == name).and_then(|node| node.returned);
        let spoken = team.blackboard().get("data").is_some();
        if let Some(status) = said(1, "PalletReceived") {
            // SRM1 is ticked before SRM2. So SRM2 receives SRM1's message in the same tick.
            assert_eq!(status == Status::Success, spoken, "tick {ticks}");
            if status == Status::Success {
                heard_first.get_or_insert(ticks);
            }
        }
        barrier.extend(said(2, "SRM1-SRM2"));
    };
    while run.advance(&mut watch) {}
    assert!(heard_first.is_some_and(|tick| tick > 10), "SRM1 has to go there first: {heard_first:?}");
    let opened = barrier.iter().position(|status| *status == Status::Success).unwrap();
    assert!(opened > 0 && barrier[opened..].iter().all(|status| *status == Status::Success), "it never closes again");
    assert_eq!(barrier.len() - opened, 3, "once for each parcel");
}

#[test]
fn nothing_moves_while_somebody_has_stopped_it_and_it_goes_on_after_start() {
    let mut run = run(1, 9, Asked::default());
    run.advance_to(Duration::from_secs(20));
    run.stop();
    run.advance_to(Duration::from_secs(25));
    let (before, ticks) = (run.frame(), run.figures().ticks);
    run.advance_to(Duration::from_secs(60));
    let after = run.frame();
    assert_eq!(
        (before.bodies, before.load.map(|load| (load.0, load.1))),
        (after.bodies, after.load.map(|load| (load.0, load.1)))
    );
    assert_eq!(run.figures().ticks, ticks, "the trees' own time stands still");
    assert!(run.start());
    assert_eq!(run.finish().fault, None);
}

/// Checks that the trees count as delivered exactly the parcels that are really in the target area.
fn sound(run: &PalletRun, figures: &Figures, seed: u64) {
    assert_eq!(run.team.delivered(), run.pair.taken_in(), "seed {seed}");
    let all = figures.delivered == figures.parcels as usize;
    assert_eq!(figures.fault.is_none(), all, "seed {seed}: {figures:?}");
}

#[test]
fn stops_at_any_moment_change_nothing_but_the_time() {
    for seed in 0..25 {
        let mut random = RandomStream::new(seed, "stops");
        let mut run = run(2, seed, Asked::default());
        let mut stops = 0;
        while run.advance(|_| {}) {
            if stops < 30 && random.happens(0.05) {
                stops += 1;
                run.stop();
                run.advance_to(run.time() + Duration::from_millis(random.below(5000)));
                run.start();
            }
        }
        let figures = run.figures();
        assert_eq!((figures.fault, figures.losses), (None, 0), "seed {seed}, {stops} stops");
        sound(&run, &figures, seed);
    }
}

#[test]
fn kills_at_any_moment_change_nothing_but_the_time() {
    for seed in 0..25 {
        let mut random = RandomStream::new(seed, "kills");
        let mut run = run(2, seed, Asked::default());
        let mut kills = 0;
        while run.advance(|_| {}) {
            if kills < 20 && random.happens(0.03) {
                kills += 1;
                run.restart();
                run.advance_to(run.time() + Duration::from_millis(random.below(3000)));
                run.start();
            }
        }
        let figures = run.figures();
        assert_eq!((figures.fault, figures.losses), (None, 0), "seed {seed}, {kills} kills");
        sound(&run, &figures, seed);
    }
}

#[test]
fn with_anything_going_wrong_there_is_never_a_false_success() {
    let mut faults = BTreeSet::new();
    for seed in 0..50 {
        let mut random = RandomStream::new(seed, "asked");
        let mut number = |most: u64| u32::try_from(random.below(most)).unwrap();
        let slips = (0..number(4)).map(|_| Slip { parcel: 1 + number(3), after_steps: number(8) }).collect();
        let jams = if number(8) == 0 { vec![1 + number(3)] } else { Vec::new() };
        let unrecognised = (0..number(3)).map(|_| 1 + number(3)).collect();
        let asked = Asked {
            mishaps: Mishaps { slips, unrecognised, jams },
            blocked: if number(8) == 0 { vec![1 + number(3)] } else { Vec::new() },
            absent: number(8) == 0,
        };
        let mut run = run(3, seed, asked.clone());
        let mut left = 10;
        while run.advance(|_| {}) {
            match random.below(400) {
                0 if left > 0 && !run.is_held() => {
                    left -= 1;
                    run.stop();
                    run.start();
                }
                1 if left > 0 && !run.is_held() => {
                    left -= 1;
                    run.restart();
                    run.start();
                }
                _ => {}
            }
        }
        let figures = run.figures();
        sound(&run, &figures, seed);
        faults.insert(figures.fault.map(PalletFault::name));
        let may_fail = asked.absent || !asked.blocked.is_empty() || !asked.mishaps.jams.is_empty();
        assert!(figures.fault.is_none() || may_fail, "seed {seed}: {figures:?}, {asked:?}");
    }
    assert!(faults.len() >= 4, "{faults:?}");
}

#[test]
fn the_same_seed_gives_the_same_run() {
    let once = |seed| {
        let mut run = run(2, seed, slips(&[(1, 2)]));
        run.finish();
        (run.entries.clone(), run.frames.clone())
    };
    assert_eq!(once(4), once(4));
    assert_ne!(once(4), once(5));
}

#[test]
fn the_tick_logs_tell_again_how_every_node_stood() {
    let mut run = run(1, 7, slips(&[(1, 1)]));
    let mut stood = Vec::new();
    let mut watch = |team: &Team| {
        let nodes = team.trees()[2].nodes().map(|node| (node.after, node.returned)).collect::<Vec<_>>();
        stood.push((team.trees()[2].ticks(), nodes));
    };
    while run.advance(&mut watch) {}
    assert!(stood.len() > 100);
    for (tick, nodes) in stood {
        let moment = run.logs()[2].moment(tick).unwrap();
        assert_eq!(moment.nodes.iter().map(|node| (node.after, node.returned)).collect::<Vec<_>>(), nodes, "tick {tick}");
    }
}
