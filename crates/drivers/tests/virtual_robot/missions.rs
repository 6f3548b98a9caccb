//! What a mission comes to with a robot that says little, that drifts, and that others talk to as well.

use std::time::Duration;

use hallsweep_core::command::Command;
use hallsweep_core::mission::PhaseName;
use hallsweep_core::search::Strategy;
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
    for version in [Version::First, Version::Year2021, Version::Early2021, Version::Year2022] {
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
