//! Tests of a simulated robot as the core's loop sees it: its time is stopped, its faults change, and it is moved to
//! another hall.

use std::collections::BTreeSet;
use std::time::Duration;

use tokio::sync::{mpsc, oneshot, watch};

use super::super::remote::Move as Moving;
use super::*;
use crate::runtime::halt::Halter;
use crate::runtime::link::{REPORTS, RobotLink, link};
use crate::runtime::tests::within::within;
use hallsweep_core::command::Move;
use hallsweep_core::effect::Action;
use hallsweep_core::event::{Obstacle, Whereabouts};
use hallsweep_core::robot::Part;
use hallsweep_core::units::{Epoch, Pose};
use hallsweep_sim::Camera;

struct Controlled {
    link: RobotLink,
    halter: Halter,
    controls: watch::Sender<Controls>,
    moves: mpsc::Sender<Moving>,
    given: u64,
}

const FORWARD: Action = Action::Move(Move::Forward);

impl Controlled {
    async fn begin(rows: &[&str]) -> Controlled {
        let hall = Arc::new(Hall::from_rows("test", rows).expect("a good hall"));
        let settings = SimSettings { sonar_noise_cm: 0.0, ..SimSettings::new(1, Camera::Stub) };
        let (controls, obeyed) = watch::channel(Controls::default());
        let (remote, moves) = Remote::new(obeyed);
        let halter = Halter::new(Epoch(0));
        let (robot, side) = link(halter.watch());
        let begin = Begin {
            sim: Sim::new(Arc::clone(&hall), settings),
            settings,
            speed: Speed::Times(1.0),
            state_file: None,
            floor: Floor::new(hall, watch::channel(Moved::new()).1),
            remote,
            has_faults: true,
        };
        tokio::spawn(run(begin, side, Clock::default()));
        let mut controlled = Controlled { link: robot, halter, controls, moves, given: 0 };
        assert!(matches!(controlled.next().await, RobotEvent::Stands(_)));
        assert!(matches!(controlled.next().await, RobotEvent::LinkUp(_)));
        controlled
    }

    async fn next(&mut self) -> RobotEvent {
        loop {
            let event = within("a report", self.link.reports.recv()).await.expect("the robot is running");
            if !matches!(event, RobotEvent::Sonar(_)) {
                return event;
            }
        }
    }

    async fn give(&mut self, action: Action) -> OrderId {
        self.given += 1;
        let (id, halts) = (OrderId(self.given), self.link.halts.now().count);
        let order = Order { id, action, epoch: Epoch(0), deadline: Duration::from_secs(9) };
        self.link.orders.send(Stamped { order, halts }).await.expect("the robot is running");
        id
    }

    fn say(&self, change: impl FnOnce(&mut Controls)) {
        self.controls.send_modify(change);
    }

    /// Whether no report comes in a time that is longer than any order takes. A report that comes is dropped.
    async fn is_silent(&mut self) -> bool {
        tokio::time::timeout(Duration::from_secs(60), self.next()).await.is_err()
    }
}

#[tokio::test(start_paused = true)]
async fn while_time_stands_nothing_is_done_and_afterwards_it_goes_on() {
    let mut robot = Controlled::begin(&["S", ".", "."]).await;
    let id = robot.give(FORWARD).await;
    robot.say(|controls| controls.is_paused = true);
    assert_eq!(robot.next().await, RobotEvent::Paused);
    assert!(robot.is_silent().await, "it does not get on");
    robot.say(|controls| controls.is_paused = false);
    assert!(matches!(robot.next().await, RobotEvent::LinkUp(_)), "its time goes on");
    assert_eq!(robot.next().await, RobotEvent::Done(id));
}

#[tokio::test(start_paused = true)]
async fn of_controls_that_change_while_nobody_takes_reports_the_last_are_obeyed_and_reported() {
    let mut robot = Controlled::begin(&["S", "."]).await;
    for number in 0..=2000 {
        robot.say(|controls| controls.is_paused = number % 2 == 0);
        tokio::task::yield_now().await;
    }
    let mut reports = Vec::new();
    while let Ok(report) = tokio::time::timeout(Duration::from_secs(1), robot.next()).await {
        reports.push(report);
    }
    assert!(reports.len() <= REPORTS + 2, "{} reports", reports.len());
    assert_eq!(reports.last(), Some(&RobotEvent::Paused));
}

/// Safety S1, S8.
#[tokio::test(start_paused = true)]
async fn a_halt_is_obeyed_and_answered_while_time_stands() {
    let mut robot = Controlled::begin(&["S", ".", "."]).await;
    let id = robot.give(FORWARD).await;
    tokio::time::sleep(Duration::from_millis(100)).await;
    robot.say(|controls| controls.is_paused = true);
    assert_eq!(robot.next().await, RobotEvent::Paused);
    robot.halter.stop();
    assert_eq!(robot.next().await, RobotEvent::Halted(id, true));
}

#[tokio::test(start_paused = true)]
async fn a_step_is_one_order_and_a_step_without_a_pause_is_none() {
    let mut robot = Controlled::begin(&["S", ".", ".", "."]).await;
    robot.say(|controls| (controls.steps, controls.speed) = (1, Some(Speed::Times(2.0))));
    assert!(matches!(robot.next().await, RobotEvent::LinkUp(_)), "it has heard of the step");
    robot.say(|controls| controls.is_paused = true);
    assert_eq!(robot.next().await, RobotEvent::Paused);
    for _ in 0..3 {
        let id = robot.give(FORWARD).await;
        assert!(robot.is_silent().await, "time stands still");
        robot.say(|controls| controls.steps += 1);
        assert_eq!(robot.next().await, RobotEvent::Done(id));
    }
}

#[tokio::test(start_paused = true)]
async fn another_speed_is_told_and_kept() {
    let mut robot = Controlled::begin(&["S", "."]).await;
    robot.say(|controls| controls.speed = Some(Speed::Times(10.0)));
    let RobotEvent::LinkUp(can) = robot.next().await else { panic!("what takes how long now") };
    assert_eq!(can.step, Duration::from_millis(33));
}

#[tokio::test(start_paused = true)]
async fn a_lost_link_is_said_once_and_when_it_is_back_the_robot_says_where_it_stands() {
    let mut robot = Controlled::begin(&["S", "."]).await;
    robot.give(FORWARD).await;
    tokio::time::sleep(Duration::from_millis(100)).await;
    robot.say(|controls| controls.is_link_lost = true);
    assert!(matches!(robot.next().await, RobotEvent::LinkLost(_)));
    assert!(robot.is_silent().await, "nobody hears what it says");
    robot.say(|controls| controls.is_link_lost = false);
    assert_eq!(robot.next().await, RobotEvent::Stands(Whereabouts { pose: Pose::START, off_centre: true }));
    assert!(matches!(robot.next().await, RobotEvent::LinkUp(_)));
    let id = robot.give(Action::Recentre).await;
    assert_eq!(robot.next().await, RobotEvent::Done(id));
}

#[tokio::test(start_paused = true)]
async fn what_it_can_do_while_its_time_stands_does_not_let_it_go_on() {
    let mut robot = Controlled::begin(&["S", "."]).await;
    robot.say(|controls| controls.is_paused = true);
    assert_eq!(robot.next().await, RobotEvent::Paused);
    robot.say(|controls| controls.faults.no_thermometer = true);
    let RobotEvent::LinkUp(can) = robot.next().await else { panic!("it says that it has none") };
    assert!(!can.parts.has(Part::Thermometer));
    assert_eq!(robot.next().await, RobotEvent::Paused, "the core is told that time stands still");
}

#[tokio::test(start_paused = true)]
async fn an_obstacle_is_met_and_none_is_put_where_the_robot_is_before_it_has_left() {
    let mut robot = Controlled::begin(&["S", ".", "."]).await;
    let ahead = Cell::new(0, 1);
    robot.say(|controls| controls.blocked = Arc::new(BTreeSet::from([ahead, Cell::HOME])));
    let id = robot.give(FORWARD).await;
    assert!(matches!(robot.next().await, RobotEvent::Blocked(blocked, Obstacle::Wall { .. }) if blocked == id));
    robot.say(|controls| controls.blocked = Arc::new(BTreeSet::from([Cell::HOME])));
    let id = robot.give(Action::Recentre).await;
    assert_eq!(robot.next().await, RobotEvent::Done(id));
    let id = robot.give(FORWARD).await;
    assert_eq!(robot.next().await, RobotEvent::Done(id));
    let id = robot.give(Action::Move(Move::Backward)).await;
    assert!(matches!(robot.next().await, RobotEvent::Blocked(blocked, _) if blocked == id), "it has left home");
}

#[tokio::test(start_paused = true)]
async fn it_is_put_down_in_another_hall_when_that_is_decided_and_goes_on_when_it_is_not() {
    let mut robot = Controlled::begin(&["S", ".", "."]).await;
    let id = robot.give(FORWARD).await;
    assert_eq!(robot.next().await, RobotEvent::Done(id));
    for comes in [false, true] {
        let ((ready, is_ready), (decide, decided), (put_down, is_put_down)) =
            (oneshot::channel(), oneshot::channel(), oneshot::channel());
        let asked = Moving { ready: Some(ready), decided, put_down };
        robot.moves.send(asked).await.expect("the robot is running");
        within("that it is ready", is_ready).await.expect("it says so");
        if comes {
            let hall = Arc::new(Hall::from_rows("other", &["S."]).expect("a good hall"));
            decide.send(SimulatedHall { hall, seed: 3 }).expect("it waits");
            within("that it is put down", is_put_down).await.expect("it says so");
        }
    }
    assert_eq!(robot.next().await, RobotEvent::Stands(Whereabouts { pose: Pose::START, off_centre: false }));
    assert!(matches!(robot.next().await, RobotEvent::LinkUp(_)));
    let id = robot.give(FORWARD).await;
    assert!(matches!(robot.next().await, RobotEvent::Blocked(blocked, _) if blocked == id), "this hall has one row");
}
