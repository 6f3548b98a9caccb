//! Tests of the simulated robot's link: orders, halts, photos, and what the next program knows. The simulator's
//! controls are tested in `controlled_tests`.

use std::path::Path;
use std::sync::Arc;

use super::*;
use crate::runtime::halt::Halter;
use crate::runtime::link::{REPORTS, RobotLink, link};
use crate::runtime::tests::within::within;
use crate::storage::tests::scratch::Scratch;
use hallsweep_core::command::Move;
use hallsweep_core::effect::{Action, Stamp};
use hallsweep_core::event::Whereabouts;
use hallsweep_core::robot::RobotId;
use hallsweep_core::units::{Epoch, Pose, WallTime};
use hallsweep_sim::{Camera, Hall, SimMemory, SimSettings};

struct Test {
    link: RobotLink,
    halter: Halter,
    task: JoinHandle<()>,
    capabilities: Capabilities,
}

impl Test {
    async fn begin(rows: &[&str], speed: Speed) -> Test {
        let settings = SimSettings { sonar_noise_cm: 0.0, ..SimSettings::new(1, Camera::Rendered) };
        let sim = Sim::new(Arc::new(Hall::from_rows("test", rows).unwrap()), settings);
        Test::with(sim, speed, None).await.0
    }

    async fn with(sim: Sim, speed: Speed, state_file: Option<SimStateFile>) -> (Test, Whereabouts) {
        let halter = Halter::new(Epoch(0));
        let (mut link, side) = link(halter.watch());
        let begin = Begin {
            sim,
            settings: SimSettings::new(1, Camera::Rendered),
            speed,
            state_file,
            floor: still_floor(),
            remote: Remote::untouched(),
            has_faults: true,
        };
        let task = tokio::spawn(run(begin, side, Clock::default()));
        let Some(RobotEvent::Stands(whereabouts)) = within("where it is", link.reports.recv()).await else {
            panic!("first it says where it is")
        };
        let Some(RobotEvent::LinkUp(capabilities)) = within("the link", link.reports.recv()).await else {
            panic!("then the link comes up")
        };
        (Test { link, halter, task, capabilities }, whereabouts)
    }

    async fn give(&mut self, id: u64, action: Action, halts: u64) {
        let order = Order { id: OrderId(id), action, epoch: Epoch(0), deadline: Duration::from_secs(5) };
        self.link.orders.send(Stamped { order, halts }).await.unwrap();
    }

    async fn answer(&mut self) -> RobotEvent {
        loop {
            let event = within("the robot's answer", self.link.reports.recv()).await.expect("the robot is running");
            if !matches!(event, RobotEvent::Sonar(_)) {
                return event;
            }
        }
    }
}

fn still_floor() -> Floor {
    let hall = Arc::new(Hall::from_rows("test", &["S.", ".."]).unwrap());
    Floor::new(hall, watch::channel(Moved::new()).1)
}

const FORWARD: Action = Action::Move(Move::Forward);
const LEFT: Action = Action::Move(Move::TurnLeft);

fn photograph() -> Action {
    Action::Photograph(Stamp { pose: Pose::START, wall: WallTime::default() })
}

#[tokio::test]
async fn at_full_speed_a_thousand_steps_are_all_answered() {
    let mut test = Test::begin(&["S", "."], Speed::Max).await;
    for id in 0..1000 {
        test.give(id, Action::Move(if id % 2 == 0 { Move::Forward } else { Move::Backward }), 0).await;
        assert_eq!(test.answer().await, RobotEvent::Done(OrderId(id)));
    }
}

#[tokio::test]
async fn durations_are_told_and_kept_in_real_time() {
    let mut test = Test::begin(&["S", "."], Speed::Times(10.0)).await;
    assert_eq!(test.capabilities.step, Duration::from_millis(33));
    let clock = Clock::default();
    test.give(1, FORWARD, 0).await;
    assert_eq!(test.answer().await, RobotEvent::Done(OrderId(1)));
    assert!(clock.now().since_start >= Duration::from_millis(32));
}

#[tokio::test]
async fn a_halt_stops_the_order_under_way_at_once() {
    let mut test = Test::begin(&["S", "."], Speed::Times(0.1)).await;
    test.give(1, FORWARD, 0).await;
    tokio::time::sleep(Duration::from_millis(50)).await;
    test.halter.halt();
    assert_eq!(test.answer().await, RobotEvent::Halted(OrderId(1), true));
    test.give(2, Action::Recentre, 1).await;
    assert_eq!(test.answer().await, RobotEvent::Done(OrderId(2)));
}

#[tokio::test]
async fn an_order_from_before_a_halt_is_not_begun_and_one_from_after_it_is() {
    let mut test = Test::begin(&["S", "."], Speed::Max).await;
    test.halter.halt();
    test.give(1, FORWARD, 0).await;
    assert_eq!(test.answer().await, RobotEvent::Halted(OrderId(1), false));
    test.halter.halt();
    test.give(2, FORWARD, 2).await;
    assert_eq!(test.answer().await, RobotEvent::Done(OrderId(2)));
}

#[tokio::test]
async fn a_halt_gets_through_while_nobody_takes_the_reports() {
    let mut test = Test::begin(&["S", "."], Speed::Max).await;
    // Each turn produces at most one answer and one sonar reading. This number of turns fills the channel, and the
    // robot has to wait with its next report.
    let orders = REPORTS as u64 + 8;
    let mut given = 0;
    while given < orders && tokio::time::timeout(Duration::from_millis(200), test.give(given, LEFT, 0)).await.is_ok() {
        given += 1;
    }
    assert!(given < orders, "the robot never had to wait");
    test.halter.halt();
    let mut last = RobotEvent::Sonar(None);
    for _ in 0..given {
        last = test.answer().await;
    }
    assert!(
        matches!(last, RobotEvent::Halted(id, _) if id == OrderId(given - 1)),
        "what was still queued did not begin: {last:?}"
    );
}

#[tokio::test]
async fn a_photo_is_drawn_beside_the_loop_and_no_halt_cuts_it_short() {
    let mut test = Test::begin(&["S", "a"], Speed::Times(2.0)).await;
    test.give(1, photograph(), 0).await;
    tokio::time::sleep(Duration::from_millis(50)).await;
    test.halter.halt();
    let RobotEvent::Photo(OrderId(1), photo) = test.answer().await else { panic!("a photo was ordered") };
    assert_eq!(photo.media_type, "image/png");
}

fn hall() -> Arc<Hall> {
    Arc::new(Hall::from_rows("test", &["S", "."]).unwrap())
}

async fn begin_in(folder: &Path, speed: Speed) -> (Test, Whereabouts) {
    let (state_file, memory) = SimStateFile::open(folder, &RobotId::discovery(), &hall(), &hall()).unwrap();
    let settings = SimSettings::new(1, Camera::Stub);
    let sim = match memory {
        Some(memory) => Sim::remembering(hall(), settings, memory),
        None => Sim::new(hall(), settings),
    };
    Test::with(sim, speed, Some(state_file)).await
}

/// Reads the folder until the stored memory is as expected.
async fn until_remembered(folder: &Path, expect: impl Fn(SimMemory) -> bool) {
    let seen = async {
        while !SimStateFile::open(folder, &RobotId::discovery(), &hall(), &hall()).unwrap().1.is_some_and(&expect) {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    };
    within("what is to be remembered", seen).await;
}

/// Safety R2.
#[tokio::test]
async fn whatever_was_reported_before_the_program_died_is_known_to_the_next() {
    let folder = Scratch::new();
    let mut pose = Pose::START;
    for id in 0..20 {
        let (mut test, whereabouts) = begin_in(&folder.0, Speed::Max).await;
        assert_eq!(whereabouts, Whereabouts { pose, off_centre: false });
        let step = if pose.cell.y == 0 { Move::Forward } else { Move::Backward };
        test.give(id, Action::Move(step), 0).await;
        assert_eq!(test.answer().await, RobotEvent::Done(OrderId(id)));
        pose.cell.y = 1 - pose.cell.y;
        test.task.abort();
    }
}

/// Safety R2.
#[tokio::test]
async fn a_step_under_way_when_the_program_dies_leaves_it_off_centre() {
    let folder = Scratch::new();
    let (mut test, _) = begin_in(&folder.0, Speed::Times(0.1)).await;
    test.give(1, FORWARD, 0).await;
    until_remembered(&folder.0, |memory| memory.motion.is_some()).await;
    test.task.abort();
    let (mut test, whereabouts) = begin_in(&folder.0, Speed::Max).await;
    assert_eq!(whereabouts, Whereabouts { pose: Pose::START, off_centre: true });
    test.give(1, Action::Recentre, 0).await;
    assert_eq!(test.answer().await, RobotEvent::Done(OrderId(1)));
}

#[tokio::test]
async fn without_a_folder_to_write_in_it_goes_on_and_writes_as_soon_as_there_is_one() {
    let folder = Scratch::new();
    let late = folder.0.join("late");
    let (mut test, _) = begin_in(&late, Speed::Max).await;
    test.give(1, FORWARD, 0).await;
    assert_eq!(test.answer().await, RobotEvent::Done(OrderId(1)));
    std::fs::create_dir(&late).unwrap();
    until_remembered(&late, |memory| memory.pose != Pose::START).await;
}

/// Safety S1.
#[test]
fn a_disk_that_hangs_delays_no_halt() {
    // The only thread that may wait for a disk is kept busy, so the write of the state file has to wait.
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().max_blocking_threads(1).build().unwrap();
    runtime.block_on(async {
        let folder = Scratch::new();
        let (mut test, _) = begin_in(&folder.0, Speed::Times(0.5)).await;
        let (disk, hangs) = std::sync::mpsc::channel::<()>();
        let hanging = tokio::task::spawn_blocking(move || hangs.recv());
        test.give(1, FORWARD, 0).await;
        tokio::time::sleep(Duration::from_millis(200)).await;
        test.halter.halt();
        // The step would have ended by now.
        tokio::time::sleep(Duration::from_millis(800)).await;
        assert!(test.link.reports.try_recv().is_err(), "nothing is told that is not written");
        drop(disk);
        hanging.await.unwrap().unwrap_err();
        assert_eq!(test.answer().await, RobotEvent::Halted(OrderId(1), true));
    });
}

#[tokio::test]
async fn it_ends_when_the_loop_is_gone() {
    let Test { link, task, .. } = Test::begin(&["S"], Speed::Times(1.0)).await;
    drop(link);
    within("its end", task).await.unwrap();
}

/// Without repeated readings, a missing thermometer would look like a constant temperature.
#[tokio::test(start_paused = true)]
async fn a_thermometer_says_again_what_it_reads_while_that_stays_the_same() {
    let hall = Hall::parse("test.toml", "drawing = \"\"\"\nS.\n..\n\"\"\"\n[[temperature]]\nat_s = 0\ncelsius = 20\n").unwrap();
    let sim = Sim::new(Arc::new(hall), SimSettings::new(1, Camera::Stub));
    let mut test = Test::with(sim, Speed::Times(1.0), None).await.0;
    let reading = RobotEvent::Temperature(Celsius::new(20.0).unwrap());
    assert_eq!(test.answer().await, reading);
    for _ in 0..2 {
        let clock = Clock::default();
        let again = tokio::time::timeout(2 * READ_AGAIN, test.link.reports.recv()).await.expect("it reads again");
        assert_eq!(again, Some(reading.clone()));
        assert!(clock.now().since_start >= READ_AGAIN / 2);
    }
}
