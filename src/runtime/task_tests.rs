//! Tests of the loop, mostly in paused time. The test itself gives the answers of the robot and of the store.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::*;
use crate::runtime::handle::CommandOutcome;
use crate::runtime::link::{RobotSide, Stamped, link};
use crate::runtime::tests::within::within;
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, Door, Issuer, Request, TemperatureReport};
use hallsweep_core::effect::{Action, Page};
use hallsweep_core::event::Capabilities;
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::robot::{Parts, RobotId, RobotState};
use hallsweep_core::settings::Settings;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{Epoch, Seq};

#[path = "task_figures_tests.rs"]
mod figures;

/// A store that stores nothing, but reports its pages as stored. It reports at once, or when the test says so.
struct Forgetful {
    word: watch::Sender<StoreStatus>,
    at_once: Arc<AtomicBool>,
}

impl Store for Forgetful {
    fn record(&mut self, page: Page, _losses: u64) {
        if self.at_once.load(Ordering::SeqCst) {
            self.word.send_modify(|word| word.kept = page.last());
        }
    }

    fn word(&self) -> watch::Receiver<StoreStatus> {
        self.word.subscribe()
    }
}

fn request(command: Command) -> Request {
    Request::new(command, Issuer::operator(Door::LOCAL))
}

/// Sends a command immediately, and returns its answer as a future.
fn give(handle: &Handle, command: Command) -> impl Future<Output = CommandOutcome> + use<> {
    let answer = handle.give(request(command.clone()));
    async move { within(&format!("the answer to {command:?}"), answer).await }
}

fn giving(handle: &Handle, command: Command) -> tokio::task::JoinHandle<CommandOutcome> {
    let handle = handle.clone();
    tokio::spawn(async move { give(&handle, command).await })
}

async fn ordered(robot: &mut RobotSide) -> Stamped {
    within("an order", robot.orders.recv()).await.expect("the loop runs")
}

async fn seen(handle: &Handle, what: &str, is_so: impl FnMut(&Arc<Snapshot>) -> bool) -> Arc<Snapshot> {
    Arc::clone(&*within(what, handle.watch().wait_for(is_so)).await.expect("the loop runs"))
}

fn says(words: &str) -> impl Fn(&Arc<Snapshot>) -> bool {
    move |state| state.log.iter().any(|line| line.said.to_string().contains(words))
}

fn task() -> (Handle, Task, RobotSide) {
    let (handle, task, robot, _) = task_with(true);
    (handle, task, robot)
}

fn task_with(at_once: bool) -> (Handle, Task, RobotSide, watch::Sender<StoreStatus>) {
    task_keeping(&Arc::new(AtomicBool::new(at_once)))
}

fn task_keeping(at_once: &Arc<AtomicBool>) -> (Handle, Task, RobotSide, watch::Sender<StoreStatus>) {
    let word = watch::Sender::new(StoreStatus::default());
    let store = Forgetful { word: word.clone(), at_once: Arc::clone(at_once) };
    let halter = Halter::new(Epoch(0));
    let (loop_side, robot_side) = link(halter.watch());
    let engine = Engine::new(Settings::default(), Default::default(), "test".into());
    let (handle, task) = Task::new(engine, [(RobotId::discovery(), loop_side)], Box::new(store), Clock::default(), halter);
    (handle, task, robot_side, word)
}

async fn running() -> (Handle, RobotSide, watch::Sender<Course>) {
    let (handle, task, robot) = task();
    start(handle, task, robot).await
}

async fn start(handle: Handle, task: Task, robot: RobotSide) -> (Handle, RobotSide, watch::Sender<Course>) {
    let (course, coursed) = watch::channel(Course::default());
    tokio::spawn(task.run(coursed));
    let second = Duration::from_secs(1);
    let can =
        Capabilities { step: second, turn: second, photo: second, arm: Duration::ZERO, nudges: false, parts: Parts::ROUND_ROBOT };
    robot.reports.send(RobotEvent::LinkUp(can)).await.unwrap();
    (handle, robot, course)
}

#[tokio::test]
async fn whoever_was_answered_sees_what_was_done() {
    let (handle, _robot, _close) = running().await;
    let accepted = give(&handle, Command::Start).await.unwrap().unwrap();
    let state = handle.snapshot();
    assert!(state.revision >= accepted.revision);
    assert_eq!(state.mission.phase, PhaseName::Exploring);
}

/// Safety S1: a stop works even if the loop does not take commands from its queue.
#[tokio::test]
async fn a_stop_reaches_the_robot_although_the_loop_hangs_and_its_queue_is_full() {
    let (handle, _hanging, mut robot) = task();
    for _ in 0..=COMMANDS {
        giving(&handle, Command::Start);
    }
    tokio::task::yield_now().await;
    giving(&handle, Command::Stop);
    assert_eq!(within("the halt", robot.halts.raised()).await.epoch, Epoch(1));
}

/// Safety S6: no step begins after the stop was answered.
#[tokio::test(start_paused = true)]
async fn no_order_is_given_after_a_stop_was_answered() {
    let (handle, mut robot, _close) = running().await;
    for n in 1..=200 {
        give(&handle, Command::Start).await.unwrap().unwrap();
        give(&handle, Command::Stop).await.unwrap().unwrap();
        assert_eq!(robot.halts.now().epoch, Epoch(n));
        assert!(handle.snapshot().mission.holds.contains(&Hold::Operator));
        while let Ok(Stamped { order, halts }) = robot.orders.try_recv() {
            assert!(halts < robot.halts.now().count, "stop {n}: {order:?} could still begin");
            robot.reports.send(RobotEvent::Halted(order.id, false)).await.unwrap();
        }
    }
}

/// Safety S6: no step begins after a stop was answered, even if somebody else keeps sending START.
#[tokio::test(start_paused = true)]
async fn a_start_that_crosses_a_stop_begins_nothing_after_the_stop_was_answered() {
    let (handle, mut robot, _close) = running().await;
    for n in 1..=200 {
        let starting = giving(&handle, Command::Start);
        give(&handle, Command::Stop).await.unwrap().unwrap();
        let stopped_at = robot.halts.now().count;
        let held = handle.snapshot().mission.holds.contains(&Hold::Operator);
        while let Ok(Stamped { order, halts }) = robot.orders.try_recv() {
            assert!(halts < stopped_at || !held, "stop {n}: {order:?} could still begin");
            robot.reports.send(RobotEvent::Halted(order.id, false)).await.unwrap();
        }
        let _ = starting.await;
    }
}

/// A stop is raised while the loop is about to send an order. The loop ends its round, and the robot gets no order.
#[tokio::test]
async fn a_stop_between_an_order_and_its_sending_holds_the_robot() {
    let (handle, mut task, mut robot) = task();
    let second = Duration::from_secs(1);
    let can =
        Capabilities { step: second, turn: second, photo: second, arm: Duration::ZERO, nudges: false, parts: Parts::ROUND_ROBOT };
    task.engine.handle_event(Event::Robot(RobotId::discovery(), RobotEvent::LinkUp(can)), task.clock.now());
    task.settle();
    let start = task.engine.handle_command(request(Command::Start), task.clock.now());
    assert!(start.is_ok());
    handle.halter().stop();
    task.settle();
    assert!(robot.orders.try_recv().is_err());
    assert!(task.engine.snapshot().mission.holds.contains(&Hold::Operator));
}

/// Safety S2: heat halts the robot as directly as a stop does.
#[tokio::test]
async fn heat_halts_past_the_queue_of_orders() {
    let (handle, mut robot, _close) = running().await;
    give(&handle, Command::Start).await.unwrap().unwrap();
    let Stamped { halts, .. } = ordered(&mut robot).await;
    give(&handle, Command::Temperature(TemperatureReport::TooHigh)).await.unwrap().unwrap();
    assert!(robot.halts.now().count > halts);
}

/// Safety S2 and V3: START is answered and the robot moves only when the record is stored, however late that is. STOP
/// does not wait.
#[tokio::test]
async fn a_store_that_answers_late_delays_start_but_not_stop() {
    let (handle, task, robot, word) = task_with(false);
    let (handle, mut robot, _close) = start(handle, task, robot).await;
    let starting = giving(&handle, Command::Start);
    tokio::task::yield_now().await;
    give(&handle, Command::Stop).await.unwrap().unwrap();
    assert!(!starting.is_finished());
    assert_eq!(handle.snapshot().mission.phase, PhaseName::Idle, "what is not on record is not shown");
    word.send_modify(|word| word.kept = Seq(1000));
    starting.await.unwrap().unwrap().unwrap();
    assert!(robot.orders.try_recv().is_err(), "the stop came before the record of the start");
}

/// A moving robot and its order. The store stores at once, or hangs from now on.
async fn moving(hangs: bool) -> (Handle, RobotSide, watch::Sender<Course>, Order) {
    let at_once = Arc::new(AtomicBool::new(true));
    let (handle, task, robot, _word) = task_keeping(&at_once);
    let (handle, mut robot, close) = start(handle, task, robot).await;
    give(&handle, Command::Start).await.unwrap().unwrap();
    let Stamped { order, .. } = ordered(&mut robot).await;
    at_once.store(!hangs, Ordering::SeqCst);
    (handle, robot, close, order)
}

const TENTH: Duration = Duration::from_millis(100);

/// Safety S8: the answer to a stop waits until the robot stands, whatever the store does.
#[tokio::test(start_paused = true)]
async fn the_answer_to_a_stop_waits_until_the_robot_stands_and_its_state_says_so() {
    for hangs in [false, true] {
        let (handle, robot, _close, order) = moving(hangs).await;
        let mut stopping = Box::pin(give(&handle, Command::Stop));
        assert!(tokio::time::timeout(TENTH * 9 / 10, &mut stopping).await.is_err(), "the robot does not stand yet");
        let before = handle.snapshot();
        assert!(before.robot.halting && before.robot.state != RobotState::Stopped);
        robot.reports.send(RobotEvent::Halted(order.id, true)).await.unwrap();
        let stopped = tokio::time::timeout(TENTH / 100, stopping).await.expect("it is answered when it stands");
        let after = handle.snapshot();
        assert_eq!(after.revision, stopped.unwrap().unwrap().revision);
        assert!(after.revision > before.revision);
        assert_eq!((after.robot.halting, after.robot.state), (false, RobotState::Stopped));
    }
}

/// Safety S8: if the robot does not obey, the answer comes after a tenth of a second. The state shows that the robot
/// is still halting.
#[tokio::test(start_paused = true)]
async fn the_answer_to_a_stop_comes_although_the_robot_does_not_obey() {
    for hangs in [false, true] {
        let (handle, _robot, _close, _) = moving(hangs).await;
        for _ in 0..2 {
            let clock = Clock::default();
            let stopped = give(&handle, Command::Stop).await.unwrap().unwrap();
            let took = clock.now().since_start;
            assert!((TENTH..TENTH + Duration::from_millis(5)).contains(&took), "{took:?}");
            let state = handle.snapshot();
            assert!(state.robot.halting && state.revision >= stopped.revision);
        }
    }
}

/// Safety S4: if a stop can be written in time, it is on disk before it is answered, so that it survives the end of
/// the program.
#[tokio::test(start_paused = true)]
async fn the_answer_to_a_stop_waits_until_it_is_noted() {
    let (handle, task, robot) = task();
    let halter = handle.halter().clone();
    halter.note(Some(Epoch(0)));
    let (handle, _robot, _close) = start(handle, task, robot).await;
    let mut stopping = Box::pin(give(&handle, Command::Stop));
    assert!(tokio::time::timeout(TENTH / 2, &mut stopping).await.is_err(), "it is not noted yet");
    halter.note(Some(Epoch(1)));
    tokio::time::timeout(TENTH / 100, stopping).await.expect("it is noted").unwrap().unwrap();
}

/// Safety S8: the two waits of a stop's answer run at the same time.
#[tokio::test(start_paused = true)]
async fn a_robot_and_a_disk_that_do_not_obey_cost_the_answer_a_tenth_of_a_second_together() {
    let (handle, mut task, mut robot) = task();
    handle.halter().note(Some(Epoch(0)));
    let second = Duration::from_secs(1);
    let up = RobotEvent::LinkUp(Capabilities {
        step: second,
        turn: second,
        photo: second,
        arm: Duration::ZERO,
        nudges: false,
        parts: Parts::ROUND_ROBOT,
    });
    task.engine.handle_event(Event::Robot(RobotId::discovery(), up), task.clock.now());
    let (handle, _close) = {
        let (course, coursed) = watch::channel(Course::default());
        tokio::spawn(task.run(coursed));
        (handle, course)
    };
    give(&handle, Command::Start).await.unwrap().unwrap();
    ordered(&mut robot).await;
    let clock = Clock::default();
    give(&handle, Command::Stop).await.unwrap().unwrap();
    let took = clock.now().since_start;
    assert!((TENTH..TENTH + Duration::from_millis(5)).contains(&took), "{took:?}");
}

/// Safety A6: stops sent before the end are recorded. Nobody waits for their answers any more.
#[tokio::test]
async fn stops_that_were_given_before_the_end_are_on_record() {
    struct Listing(watch::Sender<StoreStatus>, Arc<std::sync::Mutex<Vec<String>>>);
    impl Store for Listing {
        fn record(&mut self, page: Page, _losses: u64) {
            let mut listed = self.1.lock().unwrap();
            for entry in page.entries {
                if let Fact::Command { asked, .. } = entry.fact {
                    listed.push(asked.to_string());
                }
            }
        }

        fn word(&self) -> watch::Receiver<StoreStatus> {
            self.0.subscribe()
        }
    }
    let listed = Arc::default();
    let store = Box::new(Listing(watch::Sender::default(), Arc::clone(&listed)));
    let halter = Halter::new(Epoch(0));
    let (loop_side, _robot) = link(halter.watch());
    let engine = Engine::new(Settings::default(), Default::default(), "test".into());
    let (handle, task) = Task::new(engine, [(RobotId::discovery(), loop_side)], store, Clock::default(), halter);
    (0..100).for_each(|_| drop(handle.give(request(Command::Stop))));
    drop(handle.give(request(Command::Start)));
    let (course, coursed) = watch::channel(Course::default());
    course.send_modify(|course| course.is_over = true);
    within("the end", task.run(coursed)).await;
    let listed = listed.lock().unwrap();
    let (shared, alone) = listed.split_last().expect("there are some");
    assert!(shared.starts_with(&format!("STOP, {} times", 100 - alone.len())), "{listed:?}");
    assert!(alone.iter().all(|command| command == "STOP"), "who gave another command hears that it was too late: {listed:?}");
}

/// Safety R1: after the request to end, no order is sent, even if somebody still sends START. The end sets no hold.
#[tokio::test(start_paused = true)]
async fn a_program_that_is_asked_to_end_halts_the_robot_and_gives_no_order_any_more() {
    let (handle, mut robot, course, order) = moving(false).await;
    let halts = robot.halts.now();
    course.send_modify(|course| course.ended_by = Some("SIGTERM"));
    let raised = within("the halt", robot.halts.raised()).await;
    assert!(raised.count > halts.count && raised.epoch == halts.epoch, "it is nobody's STOP");
    robot.reports.send(RobotEvent::Halted(order.id, true)).await.unwrap();
    give(&handle, Command::Start).await.unwrap().unwrap();
    let state = seen(&handle, "it is said", says("the program was ended by SIGTERM")).await;
    assert_eq!((state.mission.holds.len(), state.mission.phase), (0, PhaseName::Exploring));
    course.send_modify(|course| course.is_over = true);
    assert!(within("the end of orders", robot.orders.recv()).await.is_none());
}

/// Safety S8: no order is sent before the robot stands. The answer to the stop has the revision at which the robot
/// stood.
#[tokio::test(start_paused = true)]
async fn a_start_while_the_robot_halts_begins_when_it_stands() {
    let (handle, mut robot, _close, order) = moving(false).await;
    let stopping = tokio::spawn(give(&handle, Command::Stop));
    within("the halt", robot.halts.raised()).await;
    give(&handle, Command::Start).await.unwrap().unwrap();
    assert!(robot.orders.try_recv().is_err(), "the robot does not stand yet");
    let before = handle.snapshot().revision;
    robot.reports.send(RobotEvent::Halted(order.id, true)).await.unwrap();
    let stopped = stopping.await.unwrap().unwrap().unwrap().revision;
    ordered(&mut robot).await;
    assert!(before < stopped && stopped < handle.snapshot().revision, "the state in between is the one in which it stands");
}

/// A photo is not a motion. So a photo that was ordered before a stop is still taken.
#[tokio::test]
async fn a_photo_that_was_ordered_before_a_stop_goes_out_and_a_step_does_not() {
    let (handle, mut task, mut robot) = task();
    let stamp = hallsweep_core::effect::Stamp { pose: hallsweep_core::units::Pose::START, wall: Default::default() };
    let order = |action| Order { id: Default::default(), action, epoch: Epoch(0), deadline: TENTH };
    handle.halter().stop();
    task.send(RobotId::discovery(), order(Action::Photograph(stamp)));
    let Stamped { order: photo, halts } = robot.orders.try_recv().expect("the photo");
    assert_eq!((photo.action, halts), (Action::Photograph(stamp), robot.halts.now().count));
    task.send(RobotId::discovery(), order(Action::Recentre));
    assert!(robot.orders.try_recv().is_err());
}

/// Safety A6: a refusal is answered when it is in the journal, so it survives the end of the program. If the store
/// fails, refusals are answered at once.
#[tokio::test]
async fn a_refusal_is_answered_when_it_is_on_record_or_nothing_can_be() {
    let (handle, task, robot, word) = task_with(false);
    let (handle, _robot, _close) = start(handle, task, robot).await;
    let refused = || giving(&handle, Command::Retrieve(None));
    let first = refused();
    seen(&handle, "the refusal", says("refused")).await;
    give(&handle, Command::Stop).await.unwrap().unwrap();
    assert!(!first.is_finished(), "the stop does not wait, and the refusal does");
    word.send_modify(|word| word.kept = Seq(1000));
    assert!(first.await.unwrap().unwrap().is_err());

    word.send_modify(|word| word.kept = Seq(0));
    let second = refused();
    tokio::task::yield_now().await;
    word.send_modify(|word| (word.losses, word.failure) = (1, Some("the disk is full".into())));
    assert!(second.await.unwrap().unwrap().is_err());
    assert!(refused().await.unwrap().unwrap().is_err());
}

/// Safety A6: a refusal by a door is answered when it is in the journal. A refusal that shares an entry with other
/// refusals is answered at once. A refusal that nobody waits for is recorded, too.
#[tokio::test]
async fn what_a_door_refuses_is_answered_when_it_is_on_record_unless_it_shares_an_entry() {
    let (handle, task, robot, word) = task_with(false);
    let (handle, _robot, _close) = start(handle, task, robot).await;
    let issuer = Issuer { who: "lobby".into(), ..Issuer::operator(Door("http")) };
    let refused = Refused::NotAllowed("lobby may only look".to_owned());
    let note = || {
        let (handle, issuer, refused) = (handle.clone(), issuer.clone(), refused.clone());
        tokio::spawn(async move { handle.note_refused(issuer, Asked::Command(Command::Start), refused).await })
    };
    handle.note_refused_at_once(issuer.clone(), Asked::Words("HELP".to_owned()), refused.clone());
    let waiting: Vec<_> = (1..60).map(|_| note()).collect();
    let all = |state: &Arc<Snapshot>| state.log.iter().filter(|line| line.said.to_string().contains("by lobby")).count() == 60;
    seen(&handle, "sixty notes", all).await;
    within("the answer to one that shares an entry", note()).await.unwrap().unwrap();
    give(&handle, Command::Stop).await.unwrap().unwrap();
    assert!(waiting.iter().all(|one| !one.is_finished()), "the stop does not wait, and they do");
    word.send_modify(|word| word.kept = Seq(1000));
    for one in waiting {
        within("the answer to one on record", one).await.unwrap().unwrap();
    }
}

/// Safety S1, A6: stops and refusals that find the queue full are recorded, and the stops are answered.
#[tokio::test(start_paused = true)]
async fn what_finds_no_room_in_the_queue_is_on_record_and_its_stops_are_answered() {
    let (handle, task, robot) = task();
    let starts: Vec<_> = (0..COMMANDS).map(|_| handle.give(request(Command::Start))).collect();
    let stops: Vec<_> = (0..1000).map(|_| handle.give(request(Command::Stop))).collect();
    for n in 0..1000 {
        let (issuer, asked) = (Issuer::operator(Door("coap")), Asked::Words(format!("RESET {n}")));
        handle.note_refused_at_once(issuer, asked, Refused::NotAllowed("no".to_owned()));
    }
    let (handle, _robot, _close) = start(handle, task, robot).await;
    for stop in stops {
        within("the answer to a stop", stop).await.unwrap().unwrap();
    }
    seen(&handle, "the stops", says("STOP, 1000 times at once")).await;
    seen(&handle, "the refusals", says("RESET 999, and 999 more that were refused")).await;
    drop(starts);
}

/// Safety V3: if the record of a command is lost, the sender is told so, even if the store writes again before the
/// loop reads the status of the store.
#[tokio::test]
async fn a_loss_that_is_over_already_is_told_all_the_same() {
    let (handle, task, robot, word) = task_with(false);
    let (handle, _robot, _close) = start(handle, task, robot).await;
    let waiting = giving(&handle, Command::Temperature(TemperatureReport::Ok));
    // The accepted command is not shown before it is on record. The later refusal is shown at once, so when it is
    // shown, the loop has taken both commands.
    giving(&handle, Command::Retrieve(None));
    seen(&handle, "the refusal", says("refused")).await;
    assert!(!waiting.is_finished());
    word.send_modify(|word| word.losses = 1);
    assert_eq!(waiting.await.unwrap().unwrap(), Err(Refused::NotKept));
    word.send_modify(|word| word.kept = Seq(1000));
    seen(&handle, "the end of it", says(Hold::Store.over_in_words())).await;
}

#[tokio::test]
async fn a_robot_whose_adapter_ends_is_a_lost_link_and_that_is_said_once() {
    let (handle, robot, _close) = running().await;
    let is_lost = |state: &Arc<Snapshot>| state.mission.holds.contains(&Hold::RobotLink);
    seen(&handle, "the link", |state| !is_lost(state)).await;
    drop(robot);
    let lost = seen(&handle, "the link's end", is_lost).await.revision;
    for _ in 0..100 {
        tokio::task::yield_now().await;
    }
    assert_eq!(handle.snapshot().revision, lost);
}
