//! The only loop: takes halts, reports, commands and time to the core, and its effects to robots, store, doors.
//! It decides nothing.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use tokio::sync::{mpsc, oneshot, watch};

use super::clock::Clock;
use super::halt::{HaltWatch, Halter};
use super::handle::{COMMANDS, Envelope, Handle};
use super::link::{RobotLink, Stamped};
use super::store::{Store, StoreWord};
use crate::core::command::{Accepted, Refused, Request};
use crate::core::effect::{Effect, Order};
use crate::core::event::{Event, RobotEvent, RobotId};
use crate::core::sweep::Sweep;
use crate::core::units::{Seq, Ticket};
use crate::core::world::snapshot::Snapshot;

/// The loop, not yet running.
pub struct Task {
    sweep: Sweep,
    link: RobotLink,
    store: Box<dyn Store>,
    /// What the store says of the entries it was given.
    word: watch::Receiver<StoreWord>,
    clock: Clock,
    halter: Halter,
    halts: HaltWatch,
    commands: mpsc::Receiver<Envelope>,
    snapshots: watch::Sender<Arc<Snapshot>>,
    answers: BTreeMap<Ticket, oneshot::Sender<Answer>>,
    /// The refusals that wait until they are on record (safety A6), in the order of their entries.
    refusals: VecDeque<(Seq, oneshot::Sender<Answer>, Refused)>,
    /// Whether the store's last word was that it cannot write.
    store_failed: bool,
    /// How often the store has lost something, as far as the core was told.
    losses: u64,
    /// Whether the robot's end of the link is gone for good.
    link_gone: bool,
}

type Answer = Result<Accepted, Refused>;

impl Task {
    /// A loop round a sweep, and the handle by which doors reach it.
    #[must_use]
    pub fn new(mut sweep: Sweep, link: RobotLink, store: Box<dyn Store>, clock: Clock, halter: Halter) -> (Handle, Task) {
        let (commands_out, commands) = mpsc::channel(COMMANDS);
        let snapshots = watch::Sender::new(sweep.snapshot());
        let halts = halter.watch();
        let handle = Handle::new(commands_out, snapshots.subscribe(), halter.clone());
        let answers = BTreeMap::new();
        let word = store.word();
        let task = Task {
            sweep,
            link,
            store,
            word,
            clock,
            halter,
            halts,
            commands,
            snapshots,
            answers,
            refusals: VecDeque::new(),
            store_failed: false,
            losses: 0,
            link_gone: false,
        };
        (handle, task)
    }

    /// Runs until `closing` says so or every handle is gone.
    pub async fn run(mut self, mut closing: watch::Receiver<bool>) {
        self.hear_store();
        self.settle();
        loop {
            let due = self.sweep.poll_timeout();
            tokio::select! {
                biased;
                _ = closing.wait_for(|closing| *closing) => break,
                halts = self.halts.raised() => self.sweep.handle_halt(halts.epoch, self.clock.now()),
                Ok(()) = self.word.changed() => self.hear_store(),
                // Before commands and reports: a steady flow of these must not keep a silent sensor from being noticed.
                () = self.clock.reach(due) => self.sweep.handle_timeout(self.clock.now()),
                report = self.link.reports.recv(), if !self.link_gone => self.take_report(report),
                envelope = self.commands.recv() => match envelope {
                    Some(envelope) => self.take(envelope),
                    None => break,
                },
            }
            self.settle();
        }
    }

    fn take_report(&mut self, report: Option<RobotEvent>) {
        let report = report.unwrap_or_else(|| {
            self.link_gone = true;
            RobotEvent::LinkLost("the robot's adapter has ended".to_owned())
        });
        self.sweep.handle_event(Event::Robot(RobotId::Discovery, report), self.clock.now());
    }

    fn take(&mut self, envelope: Envelope) {
        match envelope {
            Envelope::Command(request, answer) => self.take_command(request, answer),
            Envelope::Refused(issuer, asked, refused) => self.sweep.note_refused(issuer, asked, &refused, self.clock.now()),
        }
    }

    fn take_command(&mut self, request: Request, answer: oneshot::Sender<Answer>) {
        match self.sweep.handle_command(request, self.clock.now()) {
            Ok(ticket) => {
                self.answers.insert(ticket, answer);
            }
            Err(refused) => self.refusals.push_back((self.sweep.written(), answer, refused)),
        }
    }

    /// Performs every effect; publishes the state before it answers, so that whoever was answered sees what was done.
    fn settle(&mut self) {
        let mut answers = Vec::new();
        loop {
            while let Some(effect) = self.sweep.poll_effect() {
                match effect {
                    Effect::Order(RobotId::Discovery, order) => self.send(order),
                    Effect::Halt(RobotId::Discovery) => self.halter.halt(),
                    Effect::Led(RobotId::Discovery, blinks) => drop(self.link.led.send_replace(blinks)),
                    Effect::Record(page) => {
                        self.store.record(page, self.losses);
                        self.hear_store_at_once();
                    }
                    Effect::Answer(ticket, answer) => answers.push((ticket, answer)),
                }
            }
            self.publish();
            if answers.is_empty() {
                break;
            }
            self.deliver(&mut answers);
        }
        self.refuse();
    }

    /// Answers the refusals that are on record. While nothing can be recorded none waits: what was refused then is on record when
    /// the store writes again.
    fn refuse(&mut self) {
        let kept = self.word.borrow().kept;
        let due = self.refusals.iter().take_while(|(seq, ..)| *seq <= kept || self.store_failed).count();
        for (_, answer, refused) in self.refusals.drain(..due) {
            // Whoever asked may have gone away.
            let _ = answer.send(Err(refused));
        }
    }

    fn deliver(&mut self, answers: &mut Vec<(Ticket, Answer)>) {
        for (ticket, answer) in answers.drain(..) {
            if let Some(waiting) = self.answers.remove(&ticket) {
                // Whoever asked may have gone away; the command was carried out all the same.
                let _ = waiting.send(answer);
            }
        }
    }

    /// A store that has said its word already need not wait for the next round.
    fn hear_store_at_once(&mut self) {
        if self.word.has_changed().unwrap_or(false) {
            self.hear_store();
        }
    }

    fn hear_store(&mut self) {
        let now = self.clock.now();
        let StoreWord { kept, failure, losses } = self.word.borrow_and_update().clone();
        self.sweep.handle_event(Event::Recorded(kept), now);
        if losses > self.losses || (failure.is_some() && !self.store_failed) {
            (self.losses, self.store_failed) = (losses, true);
            let words = failure.as_deref().unwrap_or("writing failed for a moment").to_owned();
            tracing::error!(words, "the record cannot be written");
            self.sweep.handle_event(Event::StoreFailed(words), now);
        } else if let Some(words) = failure.as_deref() {
            self.sweep.handle_event(Event::StoreReason(words.to_owned()), now);
        }
        if failure.is_none() && std::mem::take(&mut self.store_failed) {
            tracing::info!("the record is written again");
            self.sweep.handle_event(Event::StoreRestored, now);
        }
    }

    /// Sends an order with the halts so far, unless a stop has been raised since it was given: then the core
    /// hears of the stop first, so that it does not give the order again.
    fn send(&mut self, order: Order) {
        let halts = self.halts.now();
        let answer = if order.epoch < halts.epoch && order.action.is_motion() {
            self.sweep.handle_halt(halts.epoch, self.clock.now());
            RobotEvent::Halted(order.id, false)
        } else {
            let Err(error) = self.link.orders.try_send(Stamped { order, halts: halts.count }) else { return };
            tracing::warn!(%error, "the robot's adapter does not take its orders");
            RobotEvent::Failed(order.id, "its adapter does not take orders".to_owned())
        };
        self.sweep.handle_event(Event::Robot(RobotId::Discovery, answer), self.clock.now());
    }

    fn publish(&mut self) {
        let snapshot = self.sweep.snapshot();
        self.snapshots.send_if_modified(|current| {
            let newer = current.revision != snapshot.revision;
            if newer {
                *current = Arc::clone(&snapshot);
            }
            newer
        });
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use crate::core::command::{Command, Door, Issuer, TemperatureReport};
    use crate::core::effect::Page;
    use crate::core::event::Capabilities;
    use crate::core::mission::{Hold, PhaseName};
    use crate::core::settings::Settings;
    use crate::core::units::{Epoch, Seq};
    use crate::runtime::link::{RobotSide, link};

    /// Keeps nothing, but says that it did: at once, or when the test lets it.
    struct Forgetful {
        word: watch::Sender<StoreWord>,
        at_once: bool,
    }

    impl Store for Forgetful {
        fn record(&mut self, page: Page, _losses: u64) {
            if self.at_once {
                self.word.send_modify(|word| word.kept = page.last());
            }
        }

        fn word(&self) -> watch::Receiver<StoreWord> {
            self.word.subscribe()
        }
    }

    fn request(command: Command) -> Request {
        Request::new(command, Issuer::operator(Door::Local))
    }

    fn house() -> (Handle, Task, RobotSide) {
        let (handle, task, robot, _) = house_with(true);
        (handle, task, robot)
    }

    fn house_with(at_once: bool) -> (Handle, Task, RobotSide, watch::Sender<StoreWord>) {
        let word = watch::Sender::new(StoreWord::default());
        let store = Forgetful { word: word.clone(), at_once };
        let halter = Halter::new(Epoch(0));
        let (loop_side, robot_side) = link(halter.watch());
        let sweep = Sweep::new(Settings::default(), Default::default(), "test".into());
        let (handle, task) = Task::new(sweep, loop_side, Box::new(store), Clock::default(), halter);
        (handle, task, robot_side, word)
    }

    async fn running() -> (Handle, RobotSide, watch::Sender<bool>) {
        start(house()).await
    }

    async fn start((handle, task, robot): (Handle, Task, RobotSide)) -> (Handle, RobotSide, watch::Sender<bool>) {
        let (close, closing) = watch::channel(false);
        tokio::spawn(task.run(closing));
        let second = Duration::from_secs(1);
        let can = Capabilities { step: second, turn: second, photo: second, nudges: false };
        robot.reports.send(RobotEvent::LinkUp(can)).await.unwrap();
        (handle, robot, close)
    }

    #[tokio::test]
    async fn whoever_was_answered_sees_what_was_done() {
        let (handle, _robot, _close) = running().await;
        let accepted = handle.give(request(Command::Start)).await.unwrap().unwrap();
        let state = handle.snapshot();
        assert!(state.revision >= accepted.revision);
        assert_eq!(state.mission.phase, PhaseName::Exploring);
    }

    /// Safety S1: it works while the loop does not come round to its commands.
    #[tokio::test]
    async fn a_stop_reaches_the_robot_although_the_loop_hangs_and_its_queue_is_full() {
        let (handle, _hanging, mut robot) = house();
        for _ in 0..=COMMANDS {
            let handle = handle.clone();
            tokio::spawn(async move { handle.give(request(Command::Start)).await });
        }
        tokio::task::yield_now().await;
        let stopping = handle.clone();
        tokio::spawn(async move { stopping.give(request(Command::Stop)).await });
        assert_eq!(robot.halts.raised().await.epoch, Epoch(1));
    }

    /// Safety S6: no step begins after the stop was answered.
    #[tokio::test]
    async fn no_order_is_given_after_a_stop_was_answered() {
        let (handle, mut robot, _close) = running().await;
        for n in 1..=200 {
            handle.give(request(Command::Start)).await.unwrap().unwrap();
            handle.give(request(Command::Stop)).await.unwrap().unwrap();
            assert_eq!(robot.halts.now().epoch, Epoch(n));
            assert!(handle.snapshot().mission.holds.contains(&Hold::Operator));
            while let Ok(Stamped { order, halts }) = robot.orders.try_recv() {
                assert!(halts < robot.halts.now().count, "stop {n}: {order:?} could still begin");
                robot.reports.send(RobotEvent::Halted(order.id, false)).await.unwrap();
            }
        }
    }

    /// Safety S6, with somebody else pressing START all the while.
    #[tokio::test]
    async fn a_start_that_crosses_a_stop_begins_nothing_after_the_stop_was_answered() {
        let (handle, mut robot, _close) = running().await;
        for n in 1..=200 {
            let starting = tokio::spawn({
                let handle = handle.clone();
                async move { handle.give(request(Command::Start)).await }
            });
            handle.give(request(Command::Stop)).await.unwrap().unwrap();
            let stopped_at = robot.halts.now().count;
            let held = handle.snapshot().mission.holds.contains(&Hold::Operator);
            while let Ok(Stamped { order, halts }) = robot.orders.try_recv() {
                assert!(halts < stopped_at || !held, "stop {n}: {order:?} could still begin");
                robot.reports.send(RobotEvent::Halted(order.id, false)).await.unwrap();
            }
            let _ = starting.await;
        }
    }

    /// A stop that is raised while the loop is about to send an order: the loop comes to rest, and the robot gets nothing.
    #[tokio::test]
    async fn a_stop_between_an_order_and_its_sending_holds_the_robot() {
        let (_handle, mut task, mut robot) = house();
        let second = Duration::from_secs(1);
        let can = Capabilities { step: second, turn: second, photo: second, nudges: false };
        task.take_report(Some(RobotEvent::LinkUp(can)));
        task.settle();
        let start = task.sweep.handle_command(request(Command::Start), task.clock.now());
        assert!(start.is_ok());
        task.halter.stop();
        task.settle();
        assert!(robot.orders.try_recv().is_err());
        assert!(task.sweep.snapshot().mission.holds.contains(&Hold::Operator));
    }

    /// Safety S2: heat halts as directly as a stop does.
    #[tokio::test]
    async fn heat_halts_past_the_queue_of_orders() {
        let (handle, mut robot, _close) = running().await;
        handle.give(request(Command::Start)).await.unwrap().unwrap();
        let Stamped { halts, .. } = robot.orders.recv().await.expect("a start gives an order");
        handle.give(request(Command::Temperature(TemperatureReport::TooHigh))).await.unwrap().unwrap();
        assert!(robot.halts.now().count > halts);
    }

    /// Safety S2 and V3: the answer waits for the record, however late it comes, and so does the robot.
    #[tokio::test]
    async fn a_store_that_answers_late_delays_start_but_not_stop() {
        let (handle, task, robot, word) = house_with(false);
        let (handle, mut robot, _close) = start((handle, task, robot)).await;
        let starting = tokio::spawn({
            let handle = handle.clone();
            async move { handle.give(request(Command::Start)).await }
        });
        handle.watch().wait_for(|state| state.mission.phase == PhaseName::Exploring).await.unwrap();
        handle.give(request(Command::Stop)).await.unwrap().unwrap();
        assert!(!starting.is_finished());
        word.send_modify(|word| word.kept = Seq(1000));
        starting.await.unwrap().unwrap().unwrap();
        assert!(robot.orders.try_recv().is_err(), "the stop came before the record of the start");
    }

    /// Safety A6: whoever hears of a refusal finds it in the journal, whenever the program dies; a store that fails makes nobody
    /// wait.
    #[tokio::test]
    async fn a_refusal_is_answered_when_it_is_on_record_or_nothing_can_be() {
        let (handle, task, robot, word) = house_with(false);
        let (handle, _robot, _close) = start((handle, task, robot)).await;
        let refused = || {
            let handle = handle.clone();
            tokio::spawn(async move { handle.give(request(Command::Retrieve)).await })
        };
        let first = refused();
        handle.watch().wait_for(|state| state.log.iter().any(|line| line.text.contains("refused"))).await.unwrap();
        handle.give(request(Command::Stop)).await.unwrap().unwrap();
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

    /// Safety V3: whoever waits for a record that was lost is told so, although the store writes again before the loop hears of it.
    #[tokio::test]
    async fn a_loss_that_is_over_already_is_told_all_the_same() {
        let (handle, task, robot, word) = house_with(false);
        let (handle, _robot, _close) = start((handle, task, robot)).await;
        let waiting = tokio::spawn({
            let handle = handle.clone();
            async move { handle.give(request(Command::Temperature(TemperatureReport::Ok))).await }
        });
        handle.watch().wait_for(|state| state.log.iter().any(|line| line.text.contains("temperature OK"))).await.unwrap();
        assert!(!waiting.is_finished());
        word.send_modify(|word| word.losses = 1);
        assert_eq!(waiting.await.unwrap().unwrap(), Err(Refused::NotKept));
        assert!(handle.snapshot().log.iter().any(|line| line.text == Hold::Store.over_in_words()), "and it is over");
    }

    #[tokio::test]
    async fn a_robot_whose_adapter_ends_is_a_lost_link() {
        let (handle, robot, _close) = running().await;
        drop(robot);
        let mut states = handle.watch();
        states.wait_for(|state| state.mission.holds.contains(&Hold::RobotLink)).await.unwrap();
    }
}
