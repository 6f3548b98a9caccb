//! A virtual robot whose place nobody knows any more, or which is only thought to be lost: how it is found again, and
//! that no map is wrong by it.

use std::time::Duration;

use hallsweep_core::command::{Command, Move, Strategy};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::units::Heading;
use hallsweep_core::world::hall_map::Mark;

use super::page::{Page, Scene};
use super::rig::Rig;
use super::server::{Server, Version};

fn room() -> Scene {
    Scene::empty(27.0, 31.0)
}

/// The cells of the room when nothing goes wrong.
fn whole() -> Vec<(i32, i32)> {
    (0..6).flat_map(|x| (0..7).map(move |y| (x, y))).collect()
}

fn idle(scene: Scene, version: Version, with_scene: bool) -> Rig {
    let server = Server::new(version, Some(Page::open(scene, Page::steady(), Duration::ZERO)));
    let mut rig = if with_scene { Rig::with_scene(server, Strategy::Auto) } else { Rig::new(server, Strategy::Auto) };
    assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
    rig
}

fn is_told(rig: &Rig) -> bool {
    rig.server.page.as_ref().is_some_and(Page::is_moving)
}

/// Somebody closes the page, and opens it anew.
fn open_anew(rig: &mut Rig, scene: Scene) {
    rig.server.close();
    rig.wait(Duration::from_secs(5));
    rig.server.open(Page::open(scene, Page::steady(), rig.now));
    assert!(rig.until(5, |state| !state.mission.holds.contains(&Hold::RobotLink)));
}

fn explores_the_rest(rig: &mut Rig, what: &str) {
    rig.give(Command::Start).unwrap_or_else(|refused| panic!("{what}: {refused:?}"));
    assert_eq!(rig.explore(300), PhaseName::Explored, "{what}: {}", rig.trouble());
    assert_eq!(rig.cells(Mark::Visited), whole(), "{what}: {}", rig.trouble());
    rig.assert_agrees();
}

/// Cut off in the very moment in which it was told to move, it may have moved or not. Its page is opened anew, and
/// START goes on with the map.
#[test]
fn a_robot_that_is_lost_is_put_at_its_start_and_the_mission_goes_on() {
    for version in Version::ALL {
        for is_killed in [false, true] {
            let mut rig = idle(room(), version, false);
            rig.give(Command::Start).expect("an idle robot starts");
            assert!(rig.until(30, |state| state.robot.pose.cell.y > 3));
            while is_told(&rig) {
                rig.wait(Duration::from_millis(1));
            }
            while !is_told(&rig) {
                rig.wait(Duration::from_millis(1));
            }
            rig.cut();
            assert!(rig.until(5, |state| !state.mission.holds.contains(&Hold::RobotLink)));
            rig.give(Command::Start).expect("the link stands again");
            assert!(rig.until(5, |state| state.mission.phase == PhaseName::Fault), "{}", rig.trouble());
            let fault = rig.state().mission.fault.clone();
            assert!(fault.as_ref().is_some_and(|words| words.to_string().contains("press START")), "{fault:?}");
            if is_killed {
                rig.kill_driver();
                assert!(rig.until(5, |state| !state.mission.holds.contains(&Hold::RobotLink)));
            }
            open_anew(&mut rig, room());
            if is_killed && version != Version::First {
                // The next program asks for it once more: nobody sees whether the page was opened anew.
                rig.give(Command::Start).expect("the cause is gone");
                assert!(rig.until(5, |state| state.mission.phase == PhaseName::Fault), "{}", rig.trouble());
            }
            explores_the_rest(&mut rig, &format!("{version:?} {is_killed}"));
        }
    }
}

/// Somebody closes the page in mid-step: over WebSocket only the missing end of the move tells it, and the server of
/// early 2021 reports even that.
#[test]
fn a_page_that_is_closed_in_mid_step_and_opened_anew_has_its_robot_at_its_start() {
    for version in Version::NAMING {
        let mut rig = idle(room(), version, false);
        rig.give(Command::Start).expect("an idle robot starts");
        assert!(rig.until(30, |state| state.robot.pose.cell.y > 3));
        rig.server.close();
        let is_told =
            |rig: &mut Rig| rig.until(9, |state| state.mission.phase == PhaseName::Fault || !state.mission.holds.is_empty());
        assert!(is_told(&mut rig), "{version:?}");
        open_anew(&mut rig, room());
        explores_the_rest(&mut rig, &format!("{version:?}"));
    }
}

#[test]
fn a_link_that_is_cut_or_a_program_that_is_killed_while_it_gauges_its_step_does_not_make_the_step_shorter() {
    for version in Version::ALL {
        for is_killed in [false, true] {
            for after_ms in (100..6000).step_by(470) {
                let what = format!("{version:?} {is_killed} after {after_ms} ms");
                let mut rig = idle(room(), version, true);
                rig.give(Command::Start).expect("an idle robot starts");
                rig.wait(Duration::from_millis(after_ms));
                if is_killed {
                    rig.kill_driver()
                } else {
                    rig.cut()
                }
                assert!(rig.until(20, |state| !state.mission.holds.contains(&Hold::RobotLink)), "{what}");
                let _ = rig.give(Command::Start);
                let end = rig.explore(300);
                // The link may have been cut in the moment in which it was told to move.
                if end != PhaseName::Fault {
                    assert_eq!((end, rig.cells(Mark::Visited)), (PhaseName::Explored, whole()), "{what}: {}", rig.trouble());
                    rig.assert_agrees();
                }
            }
        }
    }
}

#[test]
fn with_the_scene_file_a_turn_may_be_the_first_motion() {
    for version in Version::ALL {
        let mut rig = idle(Scene::empty(35.0, 35.0), version, true);
        rig.give(Command::Move(Move::TurnLeft)).expect("an idle robot turns");
        let is_done = |rig: &mut Rig| rig.until(60, |state| state.robot.pose.heading == Heading::East);
        assert!(is_done(&mut rig), "{version:?}: {}", rig.trouble());
        rig.assert_agrees();
    }
}

/// The system accepts connections in the server's place, and nobody greets them.
#[test]
fn a_server_that_hangs_for_a_while_has_not_closed_its_page() {
    let mut rig = idle(room(), Version::First, false);
    rig.give(Command::Start).expect("an idle robot starts");
    assert!(rig.until(30, |state| state.robot.pose.cell.y > 3));
    rig.stop();
    rig.wait(Duration::from_secs(1));
    let stands = rig.server.page.as_ref().map(|page| page.at);
    rig.server.is_stalled = true;
    assert!(rig.until(30, |state| state.mission.holds.contains(&Hold::RobotLink)));
    rig.wait(Duration::from_secs(20));
    rig.server.is_stalled = false;
    assert!(rig.until(5, |state| !state.mission.holds.contains(&Hold::RobotLink)));
    assert_eq!(rig.server.page.as_ref().map(|page| page.at), stands, "it still stands there");
    assert!(rig.state().robot.pose.cell.y > 3);
    explores_the_rest(&mut rig, "after the server hung");
}

/// The driver knows where the thing stood before; meeting it elsewhere counts as drift, once.
#[test]
fn a_thing_that_was_moved_is_a_fault_until_the_next_reset_and_no_longer() {
    let with_table = |column, row| {
        let mut scene = room();
        scene.put_in_cell("table", column, row);
        scene
    };
    let mut rig = idle(with_table(2, 4), Version::First, false);
    rig.give(Command::Start).expect("an idle robot starts");
    assert_eq!(rig.explore(300), PhaseName::Explored, "{}", rig.trouble());
    rig.give(Command::Reset).expect("at home");
    open_anew(&mut rig, with_table(2, 2));
    let mut faults = 0;
    loop {
        rig.give(Command::Start).expect("nothing holds it");
        let end = rig.explore(300);
        if end == PhaseName::Explored {
            break;
        }
        assert_eq!((end, faults), (PhaseName::Fault, 0), "{}", rig.trouble());
        faults += 1;
        rig.give(Command::Reset).expect("a fault can be reset");
        open_anew(&mut rig, with_table(2, 2));
    }
    assert_eq!(faults, 1, "it has been met elsewhere");
    assert!(!rig.cells(Mark::Visited).contains(&(2, 2)));
    rig.assert_agrees();
}

/// Somebody has left something in the room since its scene file was written, and the server reports its name.
#[test]
fn what_the_scene_file_lacks_is_found_all_the_same() {
    for version in Version::NAMING {
        for (column, row) in [(0, 4), (2, 2), (3, 5), (5, 1)] {
            let mut rig = idle(room(), version, true);
            rig.server.page.as_mut().expect("a page").scene.put_in_cell("suitcase", column, row);
            rig.give(Command::Start).expect("an idle robot starts");
            let what = format!("{version:?} ({column}, {row})");
            assert_eq!(rig.explore(600), PhaseName::Explored, "{what}: {}", rig.trouble());
            let rest: Vec<(i32, i32)> = whole().into_iter().filter(|cell| *cell != (column, row)).collect();
            assert_eq!(rig.cells(Mark::Visited), rest, "{what}: {}", rig.trouble());
            rig.assert_agrees();
        }
    }
}
