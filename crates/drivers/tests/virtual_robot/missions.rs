//! Outcomes of missions with a robot that reports little, that drifts, and that other clients use as well.

use std::time::Duration;

use hallsweep_core::command::{Command, LuggageRef, Strategy, Verdict};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::units::Cell;
use hallsweep_core::world::hall_map::Mark;

use super::page::{Page, Scene};
use super::rig::Rig;
use super::server::{Server, Version};

fn room(scene: Scene, version: Version) -> Server {
    Server::new(version, Some(Page::open(scene, Page::steady(), Duration::ZERO)))
}

fn eight_by_eight() -> Vec<(i32, i32)> {
    (0..8).flat_map(|x| (0..8).map(move |y| (x, y))).collect()
}

/// The known answer of the original's room.
#[test]
fn an_empty_room_of_35_is_eight_by_eight_cells_and_goto_ends_at_its_last_row() {
    for version in Version::ALL {
        for strategy in Strategy::ALL {
            let mut rig = Rig::new(room(Scene::empty(35.0, 35.0), version), strategy);
            assert!(rig.until(5, |state| state.mission.holds.is_empty()), "{version:?}: the link is up");
            rig.give(Command::Start).expect("an idle robot starts");
            assert_eq!(rig.explore(1200), PhaseName::Explored, "{version:?} {strategy:?}: {}", rig.trouble());
            assert_eq!(rig.cells(Mark::Visited), eight_by_eight(), "{version:?} {strategy:?}");
            rig.assert_agrees();
            if strategy == Strategy::Snail {
                rig.give(Command::Reset).expect("at home");
                rig.give(Command::Goto(Cell::new(0, 8))).expect("an idle robot drives");
                assert!(
                    rig.until(60, |state| state.mission.phase == PhaseName::Idle && state.robot.pose.cell == Cell::new(0, 7))
                );
                rig.assert_agrees();
            }
        }
    }
}

/// When the page draws more frames a second, or fewer, the robot is quicker or slower: with the scene file its driver
/// finds out.
#[test]
fn with_the_scene_file_the_map_does_not_depend_on_how_fast_the_page_is() {
    for version in Version::ALL {
        for frames_per_s in [24_u32, 30, 48, 60, 75, 144] {
            let frames = Box::new(move || Duration::from_secs(1) / frames_per_s);
            let server = Server::new(version, Some(Page::open(Scene::empty(35.0, 35.0), frames, Duration::ZERO)));
            let mut rig = Rig::with_scene(server, Strategy::Auto);
            assert!(rig.until(5, |state| state.mission.holds.is_empty()), "{version:?}: the link is up");
            rig.give(Command::Start).expect("an idle robot starts");
            let what = format!("{version:?} {frames_per_s} frames a second");
            assert_eq!(rig.explore(1200), PhaseName::Explored, "{what}: {}", rig.trouble());
            assert_eq!(rig.cells(Mark::Visited), eight_by_eight(), "{what}");
            rig.assert_agrees();
        }
    }
}

#[test]
fn a_stop_while_it_gauges_its_step_is_gone_back_from() {
    for after_ms in (100..6000).step_by(370) {
        let server = room(Scene::empty(35.0, 35.0), Version::First);
        let mut rig = Rig::with_scene(server, Strategy::Auto);
        assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
        rig.give(Command::Start).expect("an idle robot starts");
        rig.wait(Duration::from_millis(after_ms));
        rig.stop();
        rig.wait(Duration::from_secs(3));
        let stands = rig.server.page.as_ref().map(|page| page.at);
        rig.wait(Duration::from_secs(3));
        assert_eq!(rig.server.page.as_ref().map(|page| page.at), stands, "a halted robot stands");
        rig.give(Command::Start).expect("it goes on");
        assert_eq!(rig.explore(600), PhaseName::Explored, "after {after_ms} ms: {}", rig.trouble());
        assert_eq!(rig.cells(Mark::Visited), eight_by_eight(), "after {after_ms} ms");
        rig.assert_agrees();
    }
}

/// Every thing with a name needs one verdict; walls need none.
#[test]
fn bags_are_known_by_their_names_and_walls_are_not_asked_about() {
    for version in Version::NAMING {
        for with_scene in [false, true] {
            let mut scene = Scene::empty(35.0, 35.0);
            scene.put_in_cell("table", 3, 3);
            scene.put_in_cell("bottle1", 5, 1);
            scene.put_in_cell("plasticBox", 1, 6);
            let server = room(scene, version);
            let mut rig = if with_scene { Rig::with_scene(server, Strategy::Auto) } else { Rig::new(server, Strategy::Auto) };
            assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
            rig.give(Command::Start).expect("an idle robot starts");
            let what = format!("{version:?} {with_scene}");
            assert_eq!(rig.explore(1200), PhaseName::Explored, "{what}: {}", rig.trouble());
            rig.assert_agrees();
            let state = rig.state();
            let mut cells: Vec<(i32, i32)> = state.luggage.iter().map(|luggage| (luggage.cell.x, luggage.cell.y)).collect();
            cells.sort_unstable();
            assert_eq!(cells, [(1, 6), (3, 3), (5, 1)], "{what}");
            rig.drawn.sort_unstable();
            assert_eq!(rig.drawn, ["bottle1", "plasticBox", "table"], "{what}");
            let visited: Vec<(i32, i32)> = eight_by_eight().into_iter().filter(|cell| !cells.contains(cell)).collect();
            assert_eq!(rig.cells(Mark::Visited), visited, "{what}");
        }
    }
}

#[test]
fn on_danger_it_comes_home_and_the_bomb_is_located() {
    let mut scene = Scene::empty(35.0, 35.0);
    scene.put_in_cell("suitcase", 2, 2);
    let mut rig = Rig::new(room(scene, Version::First), Strategy::Auto);
    assert!(rig.until(5, |state| state.mission.holds.is_empty()), "the link is up");
    rig.give(Command::Start).expect("an idle robot starts");
    assert!(rig.until(300, |state| state.pending().is_some()));
    let luggage = LuggageRef::Id(rig.state().pending().expect("one is pending").id);
    rig.give(Command::Verdict { luggage, verdict: Verdict::Danger, note: None, hot: Default::default() })
        .expect("it can be judged");
    assert!(rig.until(60, |state| state.mission.phase == PhaseName::BombLocated), "{}", rig.trouble());
    rig.assert_agrees();
    assert_eq!(rig.state().robot.pose.cell, Cell::HOME);
}
