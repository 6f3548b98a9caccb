//! One simulated robot before it is started: the place where it was left, and what to do if this place is in another
//! hall or unknown.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use tokio::sync::watch;

use super::link::{self, Begin, Floor};
use super::pair_link::Moved;
use super::remote::Remote;
use super::settings::sim_settings;
use super::state_file::{SimStateFile, StateFileError};
use crate::config::RobotSettings;
use crate::robots::Adapter;
use crate::runtime::clock::Clock;
use hallsweep_core::robot::RobotId;
use hallsweep_core::speed::Speed;
use hallsweep_sim::{Camera, Hall, Sim, SimMemory, SimSettings};

pub(in crate::robots) struct SimRobot {
    id: RobotId,
    hall: Arc<Hall>,
    settings: SimSettings,
    speed: Speed,
    remembered: SimRecollection,
}

enum SimRecollection {
    /// There is no stored position, and no position will be stored.
    Nothing,
    /// The contents of the state file, if there was one.
    Here(Box<SimStateFile>, Option<Box<SimMemory>>),
    /// The robot was left in another hall, as the state file in this folder says.
    Elsewhere(PathBuf, String),
    /// The robot was left in another hall and is put into this hall. A new state file replaces the old one.
    PutDown(Box<SimStateFile>),
    /// The position of the robot is unknown, for this reason.
    Lost(String),
}

impl SimRobot {
    /// Makes a robot. A robot that fetches pieces by itself has a hook.
    pub(in crate::robots) fn new(id: RobotId, hall: Arc<Hall>, robot: &RobotSettings, has_hook: bool) -> SimRobot {
        let settings = SimSettings { has_hook, ..sim_settings(robot, Camera::Rendered) };
        SimRobot { id, hall, settings, speed: robot.speed, remembered: SimRecollection::Nothing }
    }

    /// Reads what is stored about the robot. `floor` is the hall as other robots have left it.
    pub(in crate::robots) fn recall(&mut self, folder: &Path, floor: &Hall) {
        self.remembered = match SimStateFile::open(folder, &self.id, &self.hall, floor) {
            Ok((state_file, memory)) => SimRecollection::Here(Box::new(state_file), memory.map(Box::new)),
            Err(StateFileError::OtherHall { remembered, .. }) => SimRecollection::Elsewhere(folder.to_owned(), remembered),
            Err(lost) => SimRecollection::Lost(lost.to_string()),
        };
    }

    pub(in crate::robots) fn lost(&self) -> Option<&str> {
        if let SimRecollection::Lost(lost) = &self.remembered { Some(lost) } else { None }
    }

    pub(in crate::robots) fn lose(&mut self, why: &str) {
        self.remembered = SimRecollection::Lost(why.to_owned());
    }

    pub(in crate::robots) fn other_hall(&self) -> Option<&str> {
        if let SimRecollection::Elsewhere(_, hall) = &self.remembered { Some(hall) } else { None }
    }

    pub(in crate::robots) fn put_down(&mut self) {
        if let SimRecollection::Elsewhere(folder, _) = &self.remembered {
            self.remembered = SimRecollection::PutDown(Box::new(SimStateFile::begin_anew(folder, &self.id, &self.hall)));
        }
    }

    pub(in crate::robots) fn keep_other_hall(&mut self) {
        if matches!(self.remembered, SimRecollection::PutDown(_)) {
            self.remembered = SimRecollection::Nothing;
        }
    }

    /// Makes the adapter. If the position of the robot is unknown, the link stays down, but the adapter counts as
    /// running. `moved` has the pieces that other robots have lifted.
    pub(in crate::robots) fn adapter(self, clock: Clock, moved: watch::Receiver<Moved>, remote: Remote) -> Adapter {
        let SimRobot { id, hall, settings, speed, remembered } = self;
        let (memory, state_file) = match remembered {
            SimRecollection::Lost(lost) => {
                tracing::error!(robot = %id, lost, "the position of the simulated robot is unknown: hallsweep does not start \
                                                    this robot");
                return Box::new(|side| Box::pin(async move { side.reports.closed().await }));
            }
            SimRecollection::Here(state_file, memory) => (memory.map(|memory| *memory), Some(*state_file)),
            SimRecollection::PutDown(state_file) => (None, Some(*state_file)),
            SimRecollection::Nothing | SimRecollection::Elsewhere(..) => (None, None),
        };
        let floor = Floor::new(Arc::clone(&hall), moved);
        let has_faults = id == RobotId::discovery();
        let sim = match memory {
            Some(memory) => Sim::remembering(hall, settings, memory),
            None => Sim::new(hall, settings),
        };
        let begin = Begin { sim, settings, speed, state_file, floor, remote, has_faults };
        Box::new(move |side| Box::pin(link::run(begin, side, clock)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::halt::Halter;
    use crate::runtime::link::{RobotLink, link};
    use crate::runtime::tests::within::within;
    use crate::storage::tests::scratch::Scratch;
    use hallsweep_core::event::RobotEvent;
    use hallsweep_core::units::{Cell, Epoch, Pose};

    fn hall(name: &str, rows: &[&str]) -> Arc<Hall> {
        Arc::new(Hall::from_rows(name, rows).expect("a good hall"))
    }

    fn robot(id: &str, hall: &Arc<Hall>) -> SimRobot {
        let settings = crate::config::load(&crate::config::Sources::default()).expect("the defaults are good").hall.robot;
        SimRobot::new(RobotId::new(id).expect("a name"), Arc::clone(hall), &settings, false)
    }

    fn left_at(folder: &Scratch, id: &str, hall: &Hall, x: i32) {
        let memory = SimMemory { pose: Pose { cell: Cell::new(x, 0), ..Pose::START }, ..SimMemory::NEW };
        SimStateFile::begin_anew(&folder.0, &RobotId::new(id).expect("a name"), hall).keep(memory);
    }

    /// Starts the robot; returns the column that it reports, or `None` when it reports nothing.
    async fn stands(robot: SimRobot) -> Option<i32> {
        let (mut link, side): (RobotLink, _) = link(Halter::new(Epoch(0)).watch());
        tokio::spawn(robot.adapter(Clock::default(), watch::channel(Moved::new()).1, Remote::untouched())(side));
        match tokio::time::timeout(std::time::Duration::from_millis(300), link.reports.recv()).await {
            Ok(Some(RobotEvent::Stands(whereabouts))) => Some(whereabouts.pose.cell.x),
            Ok(other) => panic!("first it says where it is: {other:?}"),
            Err(_) => None,
        }
    }

    #[tokio::test]
    async fn each_robot_stands_where_it_was_left_itself() {
        let (folder, hall) = (Scratch::new(), hall("first", &["S..."]));
        left_at(&folder, "discovery", &hall, 1);
        left_at(&folder, "porter", &hall, 2);
        for (id, x) in [("discovery", 1), ("porter", 2), ("arm", 0)] {
            let mut robot = robot(id, &hall);
            robot.recall(&folder.0, &hall);
            assert_eq!((robot.lost(), robot.other_hall()), (None, None));
            assert_eq!(within("where it is", stands(robot)).await, Some(x), "{id}");
        }
    }

    #[tokio::test]
    async fn it_may_have_been_left_where_others_have_taken_a_piece_away() {
        let (folder, hall, floor) = (Scratch::new(), hall("first", &["Sa.."]), hall("first", &["S..."]));
        left_at(&folder, "discovery", &hall, 1);
        let mut robot = robot("discovery", &hall);
        robot.recall(&folder.0, &hall);
        assert!(robot.lost().is_some(), "it stands where a piece stands");
        robot.recall(&folder.0, &floor);
        assert_eq!(robot.lost(), None);
    }

    #[tokio::test]
    async fn one_that_may_be_anywhere_says_nothing() {
        let (folder, hall) = (Scratch::new(), hall("first", &["S..."]));
        std::fs::write(folder.0.join("simulated-robot-porter.txt"), "not ours").expect("the folder can be written");
        let mut robot = robot("porter", &hall);
        robot.recall(&folder.0, &hall);
        assert!(robot.lost().is_some_and(|lost| lost.contains("simulated-robot-porter.txt")), "{:?}", robot.lost());
        assert_eq!(stands(robot).await, None);
    }

    #[tokio::test]
    async fn one_of_another_hall_is_put_down_and_its_file_is_begun_anew_or_kept() {
        let (folder, first, second) = (Scratch::new(), hall("first", &["S..."]), hall("second", &["S....."]));
        for keeps in [true, false] {
            left_at(&folder, "porter", &first, 2);
            let mut there = robot("porter", &second);
            there.recall(&folder.0, &second);
            assert_eq!(there.other_hall(), Some("first"));
            there.put_down();
            if keeps {
                there.keep_other_hall();
            }
            assert_eq!(stands(there).await, Some(0));
            let mut again = robot("porter", &first);
            again.recall(&folder.0, &first);
            assert_eq!(again.other_hall(), if keeps { None } else { Some("second") });
        }
    }
}
