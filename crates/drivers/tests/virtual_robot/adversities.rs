//! What may go wrong with a virtual robot: the map is right, or the mission is in fault; where that cannot be achieved,
//! the test states how often the map is wrong.

use std::time::Duration;

use hallsweep_core::command::{Command, LuggageRef, Strategy, Verdict};
use hallsweep_core::event::RobotEvent;
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::{FaultCause, PhaseName};
use hallsweep_core::rng::RandomStream;
use hallsweep_core::world::hall_map::Mark;

use super::page::{Frames, Page, Scene};
use super::rig::{HERE, Rig};
use super::server::{Server, Version};

fn room() -> Scene {
    Scene::empty(27.0, 31.0)
}

/// The cells of the room when nothing goes wrong.
fn whole() -> Vec<(i32, i32)> {
    (0..6).flat_map(|x| (0..7).map(move |y| (x, y))).collect()
}

fn begun(version: Version, frames: Frames, strategy: Strategy) -> Rig {
    let server = Server::new(version, Some(Page::open(room(), frames, Duration::ZERO)));
    let mut rig = Rig::new(server, strategy);
    assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
    rig.give(Command::Start).expect("an idle robot starts");
    rig
}

/// Lets the mission go on with this many disturbances and START after each hold, and returns the phase in which it
/// ended.
fn disturbed(rig: &mut Rig, stream: &mut RandomStream, times: u32, mut disturb: impl FnMut(&mut Rig, u64)) -> PhaseName {
    for _ in 0..times {
        rig.wait(Duration::from_millis(200 + stream.below(4000)));
        if matches!(rig.state().mission.phase, PhaseName::Explored | PhaseName::Fault) {
            break;
        }
        disturb(rig, stream.below(1000));
        let cleared =
            rig.until(20, |state| !state.mission.holds.contains(&Hold::RobotLink) || state.mission.phase == PhaseName::Fault);
        assert!(cleared, "{}", rig.trouble());
        // Held or not, in fault or at its end: a START that is refused changes nothing.
        let _ = rig.give(Command::Start);
    }
    rig.explore(600)
}

fn assert_right_or_fault(rig: &mut Rig, end: PhaseName, what: &str) -> bool {
    if end == PhaseName::Fault {
        return false;
    }
    assert_eq!(end, PhaseName::Explored, "{what}: {}", rig.trouble());
    assert_eq!(rig.cells(Mark::Visited), whole(), "{what}: {}", rig.trouble());
    rig.assert_agrees();
    true
}

/// Number of searches, out of `seeds`, that end with the right map although they are disturbed this often; the others
/// are in fault.
fn right_of(seeds: u64, name: &str, times: u32, mut disturb: impl FnMut(&mut Rig, u64)) -> u32 {
    let mut right = 0;
    for seed in 0..seeds {
        let version = Version::ALL[usize::try_from(seed % 5).expect("it is small")];
        let mut stream = RandomStream::new(seed, name);
        let mut rig = begun(version, Page::steady(), Strategy::Auto);
        let end = disturbed(&mut rig, &mut stream, times, &mut disturb);
        right += u32::from(assert_right_or_fault(&mut rig, end, &format!("{version:?} seed {seed}")));
    }
    right
}

#[test]
fn stops_in_mid_step_are_gone_back_from_and_the_map_is_right() {
    let right = right_of(24, "stops", 12, |rig, _| rig.stop());
    assert!(right >= 22, "{right} of 24 were explored to their end");
}

#[test]
fn a_link_that_is_cut_in_mid_step_holds_the_mission_and_start_goes_on() {
    let right = right_of(60, "cuts", 8, |rig, _| {
        rig.cut();
        assert!(rig.state().mission.holds.contains(&Hold::RobotLink));
    });
    // Eight disturbances each, some in the very moment in which it is told to move, or while it meets something for the
    // first time.
    assert!(right >= 40, "{right} of 60 were explored to their end");
}

#[test]
fn a_program_that_is_killed_leaves_what_the_next_must_know() {
    let right = right_of(16, "kills", 8, |rig, _| rig.kill_driver());
    assert!(right >= 13, "{right} of 16 were explored to their end");
}

/// It is halted, and before the alarm takes effect, or just after, only the stored memory knows of it.
#[test]
fn a_program_that_is_killed_right_after_a_stop_knows_how_far_the_step_had_come() {
    let mut right = 0;
    for seed in 0..24_u64 {
        let version = Version::ALL[usize::try_from(seed % 5).unwrap()];
        let mut stream = RandomStream::new(seed, "stopped and killed");
        let server = Server::new(version, Some(Page::open(room(), Page::steady(), Duration::ZERO)));
        let mut rig = if seed % 8 < 4 { Rig::with_scene(server, Strategy::Auto) } else { Rig::new(server, Strategy::Auto) };
        assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
        rig.give(Command::Start).expect("an idle robot starts");
        let end = disturbed(&mut rig, &mut stream, 8, |rig, chance| {
            rig.halt();
            rig.wait(Duration::from_millis(chance % 50));
            rig.kill_driver();
        });
        right += u32::from(assert_right_or_fault(&mut rig, end, &format!("{version:?} seed {seed}")));
    }
    assert!(right >= 16, "{right} of 24 were explored to their end");
}

#[test]
fn a_server_that_dies_is_found_again() {
    let mut right = 0;
    for seed in 0..8 {
        let mut stream = RandomStream::new(seed, "deaths");
        let mut rig = begun(Version::First, Page::steady(), Strategy::Auto);
        let end = disturbed(&mut rig, &mut stream, 4, |rig, _| {
            rig.server.receive(b";{\"type\":\"moveFor");
            assert!(rig.server.is_dead, "half a message ends it");
            rig.wait(Duration::from_millis(800));
            rig.server.restart();
        });
        right += u32::from(assert_right_or_fault(&mut rig, end, &format!("seed {seed}")));
    }
    assert!(right >= 4, "{right} of 8 were explored to their end");
}

/// Safety S1, S3, S8: during every part of an order (feeling, measuring, touching, the way back, a turn), and however
/// late the server's messages come.
#[test]
fn after_a_stop_it_stands_whatever_it_was_doing() {
    for seed in 0..60_u64 {
        let version = Version::ALL[usize::try_from(seed % 5).unwrap()];
        let mut stream = RandomStream::new(seed, "stands");
        let server = Server::new(version, Some(Page::open(room(), Page::steady(), Duration::ZERO)));
        let mut rig = if seed % 3 == 0 { Rig::with_scene(server, Strategy::Auto) } else { Rig::new(server, Strategy::Auto) };
        rig.server.lag = Duration::from_millis(stream.below(60));
        assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
        for _ in 0..12 {
            let _ = rig.give(Command::Start);
            rig.wait(Duration::from_millis(stream.below(2500)));
            if stream.below(3) == 0 {
                rig.cut();
                rig.until(5, |state| !state.mission.holds.contains(&Hold::RobotLink));
                let _ = rig.give(Command::Start);
                rig.wait(Duration::from_millis(stream.below(700)));
            }
            let pressed = rig.now;
            rig.stop();
            rig.wait(Duration::from_millis(1200));
            assert!(rig.has_alarm_since(pressed), "{version:?} seed {seed}: {}", rig.trouble());
            let place = |rig: &Rig| rig.server.page.as_ref().map(|page| (page.at, page.angle, page.is_moving()));
            let stands = place(&rig);
            rig.wait(Duration::from_secs(2));
            assert_eq!(place(&rig), stands, "{version:?} seed {seed}: {}", rig.trouble());
            if let Some(luggage) = rig.state().pending().map(|luggage| LuggageRef::Id(luggage.id)) {
                rig.give(Command::Verdict { luggage, verdict: Verdict::Safe, note: None, hot: Default::default() })
                    .expect("a pending piece can be judged");
            }
        }
    }
}

/// The server stops doing one thing in mid-mission.
#[test]
fn every_wait_for_a_server_ends_in_words_and_a_stop_sends_its_alarm() {
    type Fails = fn(&mut Server);
    let failing: [(&str, Fails); 4] = [
        ("it believes for ever that an old move is under way", |server| {
            (server.running, server.is_stuck) = (Some("moveForward"), true);
        }),
        ("it says nothing any more", |server| server.is_mute = true),
        ("its page is closed", Server::close),
        ("it takes what is sent and does nothing", |server| (server.is_stalled, server.is_mute) = (true, true)),
    ];
    for (what, fail) in failing {
        for (version, seed) in Version::ALL.into_iter().zip(0..).cycle().take(20) {
            // The first version never refuses a move, nor does that of early 2021, which does not know whether there is
            // a page.
            if version == Version::First && what.contains("believes")
                || version == Version::Early2021 && !what.contains("nothing")
            {
                continue;
            }
            let mut stream = RandomStream::new(seed, what);
            let server = Server::new(version, Some(Page::open(room(), Page::steady(), Duration::ZERO)));
            let mut rig = if seed % 2 == 0 { Rig::with_scene(server, Strategy::Auto) } else { Rig::new(server, Strategy::Auto) };
            assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
            rig.give(Command::Start).expect("an idle robot starts");
            rig.wait(Duration::from_millis(stream.below(9000)));
            fail(&mut rig.server);
            let is_over = |rig: &mut Rig| {
                rig.until(8, |state| state.mission.phase == PhaseName::Fault || state.mission.holds.contains(&Hold::RobotLink))
            };
            assert!(is_over(&mut rig), "{what}, {version:?}: {}", rig.trouble());
            let (fault, trouble) = (rig.state().mission.fault.clone(), rig.trouble());
            let is_said = !trouble.starts_with("None") && fault != Some(FaultCause::Unanswered);
            assert!(is_said, "{what}, {version:?}: {fault:?} {trouble}");
            let pressed = rig.now;
            rig.stop();
            rig.wait(Duration::from_secs(4));
            assert!(rig.has_alarm_since(pressed), "{what}, {version:?}: {trouble}");
        }
    }
}

/// The situation after a page was closed in mid-move: the server waits for its end for ever, and an alarm frees it.
#[test]
fn a_server_that_waits_for_the_end_of_an_old_move_is_freed_by_an_alarm() {
    for version in [Version::Year2021, Version::Year2022, Version::Year2023] {
        let server = Server::new(version, Some(Page::open(room(), Page::steady(), Duration::ZERO)));
        let mut rig = Rig::new(server, Strategy::Auto);
        rig.server.running = Some("turnLeft");
        assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
        rig.give(Command::Start).expect("an idle robot starts");
        let end = rig.explore(300);
        assert!(assert_right_or_fault(&mut rig, end, &format!("{version:?}")), "{version:?}: {}", rig.trouble());
    }
}

/// A client that connects from this machine takes over the server's messages, until the next motion, which begins with
/// a new connection.
#[test]
fn another_client_that_steals_what_the_server_says_between_two_motions_disturbs_nothing() {
    for seed in 0..24 {
        let mut stream = RandomStream::new(seed, "thieves");
        let mut rig = begun(Version::First, Page::steady(), Strategy::Auto);
        let mut thief = None;
        let end = disturbed(&mut rig, &mut stream, 30, |rig, chance| {
            while rig.server.page.as_ref().is_some_and(Page::is_moving) || rig.is_awaiting() {
                rig.wait(Duration::from_millis(7));
            }
            match thief.take() {
                Some(client) if chance < 500 => rig.server.end(HERE, client),
                _ => thief = rig.server.connect(HERE),
            }
        });
        assert!(assert_right_or_fault(&mut rig, end, &format!("seed {seed}")), "seed {seed}: {}", rig.trouble());
    }
}

/// A client that connects in mid-step may take the very report of a contact: that is found out where the next known
/// thing is met.
#[test]
fn what_another_client_steals_in_mid_step_is_found_out_in_nearly_all_cases() {
    let mut wrong = Vec::new();
    for seed in 0..48 {
        let mut stream = RandomStream::new(seed, "thieves");
        let mut rig = begun(Version::First, Page::steady(), Strategy::Auto);
        let mut thief = None;
        let end = disturbed(&mut rig, &mut stream, 20, |rig, chance| match thief.take() {
            Some(client) if chance < 500 => rig.server.end(HERE, client),
            _ => thief = rig.server.connect(HERE),
        });
        if end == PhaseName::Explored && rig.cells(Mark::Visited) != whole() {
            wrong.push(seed);
        }
    }
    assert!(wrong.len() <= 3, "{wrong:?} of 48 have a wrong map");
}

#[test]
fn words_that_come_late_are_waited_for_or_said() {
    for version in Version::ALL {
        for lag in [5, 20, 50, 120, 300, 700] {
            let server = Server::new(version, Some(Page::open(room(), Page::steady(), Duration::ZERO)));
            let mut rig = Rig::new(server, Strategy::Auto);
            rig.server.lag = Duration::from_millis(lag);
            assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
            rig.give(Command::Start).expect("an idle robot starts");
            let end = rig.explore(900);
            let is_right = assert_right_or_fault(&mut rig, end, &format!("{version:?} {lag} ms"));
            assert!(is_right || lag > 20, "{version:?} {lag} ms: {}", rig.trouble());
        }
    }
}

/// Sixty frames a second, of which some are left out: during every second run of `over` frames, or always when `over`
/// is 0.
fn loaded(seed: u64, rate: f64, over: u64) -> Frames {
    let mut stream = RandomStream::new(seed, "frames");
    let mut count = 0_u64;
    Box::new(move || {
        count += 1;
        let left_out = (over == 0 || (count / over) % 2 == 1) && stream.happens(rate);
        Duration::from_micros(if left_out { 33_333 } else { 16_667 })
    })
}

#[test]
fn a_page_under_load_drifts_and_is_set_right_or_the_mission_says_so() {
    for with_scene in [false, true] {
        let (mut right, mut wrong) = (0, 0);
        for seed in 0..40_u64 {
            let rate = [0.02, 0.05, 0.1, 0.2][usize::try_from(seed % 4).unwrap()];
            let server = Server::new(Version::First, Some(Page::open(room(), loaded(seed, rate, 600), Duration::ZERO)));
            let mut rig = if with_scene { Rig::with_scene(server, Strategy::Auto) } else { Rig::new(server, Strategy::Auto) };
            assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
            rig.give(Command::Start).expect("an idle robot starts");
            let end = rig.explore(900);
            if end != PhaseName::Fault {
                assert_eq!(end, PhaseName::Explored, "seed {seed}, {rate} of the frames are left out: {}", rig.trouble());
                right += u32::from(rig.cells(Mark::Visited) == whole());
                wrong += u32::from(rig.cells(Mark::Visited) != whole());
            }
        }
        // Only the scene file tells whether a wall that is met for the first time stands where it seems to.
        let (least, most) = if with_scene { (40, 0) } else { (24, 1) };
        assert!(right >= least && wrong <= most, "{with_scene}: {right} of 40 are right, {wrong} have a wrong map");
    }
}

/// On known ways a drift is corrected as soon as a wall is touched, however large it is: no map is wrong by it.
#[test]
fn a_drift_on_known_ways_is_set_right_at_the_next_wall() {
    let (mut far, mut right) = (0, 0);
    for seed in 0..40 {
        let server = Server::new(Version::First, Some(Page::open(room(), Page::steady(), Duration::ZERO)));
        let mut rig = Rig::with_scene(server, [Strategy::Auto, Strategy::Columns][seed % 2]);
        assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
        rig.give(Command::Start).expect("an idle robot starts");
        rig.wait(Duration::from_millis(30_000 + 700 * u64::try_from(seed).unwrap()));
        if rig.give(Command::BackHome).is_err() {
            continue;
        }
        // The page is busy on the robot's way home.
        rig.server.page.as_mut().expect("a page").draw(loaded(u64::try_from(seed).unwrap(), 0.15, 0));
        rig.until(60, |state| matches!(state.mission.phase, PhaseName::AtHome | PhaseName::Fault));
        let has_stood =
            rig.reports.iter().any(|report| matches!(report, RobotEvent::Stands(whereabouts) if whereabouts.off_centre));
        rig.server.page.as_mut().expect("a page").draw(Page::steady());
        let _ = rig.give(Command::Start);
        let end = rig.explore(300);
        let is_right = assert_right_or_fault(&mut rig, end, &format!("seed {seed}"));
        right += u32::from(is_right);
        far += u32::from(is_right && has_stood);
    }
    assert!(far >= 1 && right >= 20, "of 40 {right} ended well, {far} although it had drifted far");
}

#[test]
fn without_a_page_the_link_is_down_and_one_that_is_opened_anew_has_the_robot_at_its_start() {
    let mut rig = Rig::new(Server::new(Version::First, None), Strategy::Auto);
    rig.wait(Duration::from_secs(3));
    assert!(rig.state().mission.holds.contains(&Hold::RobotLink));
    let says_why = |report: &RobotEvent| matches!(report, RobotEvent::LinkLost(words) if words.contains("no page"));
    assert!(rig.reports.iter().any(says_why), "{:?}", rig.reports);
    rig.server.open(Page::open(room(), Page::steady(), rig.now));
    assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
    for stands in [false, true] {
        rig.give(Command::Start).expect("an idle robot starts");
        assert!(rig.until(30, |state| state.robot.pose.cell.y > 3));
        if stands {
            rig.stop();
        }
        rig.server.close();
        assert!(rig.until(30, |state| state.mission.holds.contains(&Hold::RobotLink)), "{}", rig.trouble());
        rig.wait(Duration::from_secs(2));
        rig.server.open(Page::open(room(), Page::steady(), rig.now));
        assert!(rig.until(5, |state| !state.mission.holds.contains(&Hold::RobotLink)));
        let state = rig.state();
        assert_eq!((state.robot.pose.cell.x, state.robot.pose.cell.y, state.robot.off_centre), (0, 0, false));
        assert!(state.mission.holds.contains(&Hold::AwaitingStart), "and nothing moves by itself");
    }
    rig.give(Command::Start).expect("the link stands again");
    assert_eq!(rig.explore(300), PhaseName::Explored);
    assert_eq!(rig.cells(Mark::Visited), whole());
}

/// The server greets all clients when anybody connects.
#[test]
fn clients_from_elsewhere_disturb_nothing() {
    let mut rig = begun(Version::First, Page::steady(), Strategy::Auto);
    for number in 0..40 {
        rig.wait(Duration::from_millis(700));
        rig.server.connect(&format!("10.0.0.{number}"));
    }
    assert_eq!(rig.explore(300), PhaseName::Explored);
    assert_eq!(rig.cells(Mark::Visited), whole());
}

/// Frames per second that vary between least and most for a while, and now and then drop to few.
pub(crate) fn wobbling(seed: u64, least: u32, most: u32, few: u32) -> Frames {
    let mut stream = RandomStream::new(seed, "wobbling frames");
    let (mut left, mut rate) = (0, most);
    Box::new(move || {
        if left == 0 {
            left = 20 + stream.below(200);
            let more = u32::try_from(stream.below((most - least + 1).into())).expect("it is less");
            rate = if stream.below(8) == 0 { few } else { least + more };
        }
        left -= 1;
        Duration::from_secs(1) / rate
    })
}

#[test]
fn with_the_scene_file_a_page_that_is_now_quick_and_now_slow_makes_neither_a_fault_nor_a_wrong_map() {
    // A wall begins in the first half of a cell, or in the second.
    let sizes = [(35.0, 35.0, 8, 8), (36.0, 36.2, 8, 8), (36.5, 32.2, 8, 7)];
    for rates in [(55, 60, 45), (45, 60, 33), (30, 60, 25)] {
        for seed in 0..40 {
            let version = Version::ALL[usize::try_from(seed % 5).unwrap()];
            let (width, height, columns, rows) = sizes[usize::try_from(seed / 4 % 3).unwrap()];
            let (least, most, few) = rates;
            let frames = wobbling(seed, least, most, few);
            let page = Page::open(Scene::empty(width, height), frames, Duration::ZERO);
            let whole: Vec<(i32, i32)> = (0..columns).flat_map(|x| (0..rows).map(move |y| (x, y))).collect();
            let mut rig = Rig::with_scene(Server::new(version, Some(page)), Strategy::Auto);
            assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
            rig.give(Command::Start).expect("an idle robot starts");
            let what = format!("{version:?} {rates:?} frames a second, seed {seed}");
            assert_eq!(rig.explore(900), PhaseName::Explored, "{what}: {}", rig.trouble());
            assert_eq!(rig.cells(Mark::Visited), whole, "{what}: {}", rig.trouble());
            // Nobody knows better what it has counted since it last met something.
            let ((cell, _), counted) = (rig.server.page.as_ref().expect("a page").cell(), rig.state().robot.pose.cell);
            assert!((cell.0 - counted.x).abs() + (cell.1 - counted.y).abs() <= 4, "{what}: {counted:?}, and in truth {cell:?}");
        }
    }
}

/// A drift that no wall ahead reveals: only a thing met beside the way does.
#[test]
fn with_the_scene_file_a_drift_to_the_side_is_set_right_too() {
    let mut turned = 0;
    for seed in 0..60_u64 {
        let version = Version::NAMING[usize::try_from(seed % 4).unwrap()];
        let mut stream = RandomStream::new(seed, "aside");
        let mut scene = Scene::empty(35.0, 35.0);
        for (name, column, row) in [("suitcase", 3, 3), ("box", 5, 1), ("chair", 1, 6)] {
            scene.put_in_cell(name, column, row);
        }
        let mut rig =
            Rig::with_scene(Server::new(version, Some(Page::open(scene, Page::steady(), Duration::ZERO))), Strategy::Auto);
        assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
        rig.give(Command::Start).expect("an idle robot starts");
        for _ in 0..3 {
            rig.wait(Duration::from_millis(9_000 + stream.below(15_000)));
            rig.server.page.as_mut().expect("a page").push(1.7 * [-1.0, 1.0][usize::try_from(stream.below(2)).unwrap()]);
        }
        let what = format!("{version:?}, seed {seed}");
        assert_eq!(rig.explore(900), PhaseName::Explored, "{what}: {}", rig.trouble());
        let bags = [(3, 3), (5, 1), (1, 6)];
        let rest: Vec<(i32, i32)> =
            (0..8).flat_map(|x| (0..8).map(move |y| (x, y))).filter(|cell| !bags.contains(cell)).collect();
        assert_eq!(rig.cells(Mark::Visited), rest, "{what}: {}", rig.trouble());
        turned += rig.reports.iter().filter(|report| matches!(report, RobotEvent::Stands(_))).count();
    }
    assert!(turned > 60, "{turned}");
}
