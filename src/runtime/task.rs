//! The only loop. It passes halts, reports, commands and time to the core, and the core's effects to robots,
//! store and doors. The loop itself decides nothing.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{mpsc, oneshot, watch};

use super::clock::Clock;
use super::figures::{Figures, HandedPages};
use super::halt::{HaltWatch, Halter};
use super::handle::{COMMANDS, Envelope, Handle};
use super::link::RobotLink;
use super::links::Links;
use super::overflow::{Counted, Decision, Overflow, OverflowOut};
use super::store::{Store, StoreStatus};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, Issuer};
use hallsweep_core::effect::{Effect, Order};
use hallsweep_core::engine::Engine;
use hallsweep_core::event::{Event, RobotEvent};
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::RobotId;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{Epoch, Now, Seq, Ticket};

/// Time without events after which the clock is checked.
const GLANCE: Duration = Duration::from_secs(1);

pub struct Task {
    engine: Engine,
    links: Links,
    store: Box<dyn Store>,
    word: watch::Receiver<StoreStatus>,
    clock: Clock,
    halts: HaltWatch,
    heard: Epoch,
    commands: mpsc::Receiver<Envelope>,
    /// STOPs and refusals that found the command queue full.
    overflow: OverflowOut,
    snapshots: watch::Sender<Arc<Snapshot>>,
    answers: BTreeMap<Ticket, Vec<WaitingSender>>,
    /// Refusals in the order of their entries. Each is answered once it is on record (safety A6).
    refusals: VecDeque<(Seq, WaitingSender, Refused)>,
    /// Whether the store's last report was a failure to write.
    store_failed: bool,
    /// Number of the store's losses that were reported to the core.
    losses: u64,
    /// Number of the last list of answers that was reported to the core as stored.
    kept_back: u64,
    is_ending: bool,
    figures: Figures,
    handed: HandedPages,
}

struct WaitingSender {
    answer: oneshot::Sender<Decision>,
    /// When the command came; `None` if it is not counted.
    since: Option<Duration>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Course {
    /// Reason why the loop shall end; `None` until the end is requested. After the request, the robot is halted, and
    /// pending commands are still answered.
    pub ended_by: Option<&'static str>,
    pub is_over: bool,
}

impl Task {
    pub fn new(
        mut engine: Engine,
        links: impl IntoIterator<Item = (RobotId, RobotLink)>,
        store: Box<dyn Store>,
        clock: Clock,
        halter: Halter,
    ) -> (Handle, Task) {
        let (commands_out, commands) = mpsc::channel(COMMANDS);
        let snapshots = watch::Sender::new(engine.snapshot());
        let (halts, figures) = (halter.watch(), halter.figures().clone());
        let handed = HandedPages::new(figures.clone(), &snapshots.borrow());
        let (handle, overflow) = Handle::with_overflow(commands_out, snapshots.subscribe(), halter);
        let word = store.word();
        let task = Task {
            engine,
            links: Links::new(links),
            store,
            word,
            clock,
            halts,
            heard: Epoch(0),
            commands,
            overflow,
            snapshots,
            answers: BTreeMap::new(),
            refusals: VecDeque::new(),
            store_failed: false,
            losses: 0,
            kept_back: 0,
            is_ending: false,
            figures,
            handed,
        };
        (handle, task)
    }

    /// Runs until `course` is over, or until every handle was dropped.
    pub async fn run(mut self, mut course: watch::Receiver<Course>) {
        self.hear_store();
        self.settle();
        loop {
            let due = self.engine.poll_timeout();
            tokio::select! {
                biased;
                changed = course.changed() => {
                    let Course { ended_by, is_over } = *course.borrow_and_update();
                    if let Some(by) = ended_by.filter(|_| !std::mem::replace(&mut self.is_ending, true)) {
                        let now = self.now();
                        self.engine.handle_end(by, now);
                    }
                    if is_over || changed.is_err() {
                        break;
                    }
                }
                Ok(()) = self.word.changed() => self.hear_store(),
                // Timers come before reports and commands. So a silent sensor is noticed even if reports and commands
                // never stop.
                () = self.clock.reach(due) => {
                    let now = self.now();
                    self.engine.handle_timeout(now);
                }
                (robot, report) = self.links.report() => {
                    let now = self.now();
                    self.engine.handle_event(Event::Robot(robot, report), now);
                }
                envelope = self.commands.recv() => match envelope {
                    Some(envelope) => self.take(envelope),
                    None => break,
                },
                // Halts come after reports and commands, so that endless stops do not block these. Nevertheless,
                // `take` handles all stops before a command.
                _ = self.halts.raised() => {}
                () = self.overflow.news() => {}
                // Without any event, `now` still checks whether the clock was set, because pages show the age of
                // values.
                () = self.clock.reach(Some(self.clock.since_start() + GLANCE)) => {
                    self.now();
                }
            }
            self.hear_halts();
            self.settle();
        }
        self.take_rest();
        let now = self.now();
        self.engine.record_rest(now);
        self.settle();
    }

    /// Handles the messages that are still queued at the end. Stops, refusals and changes of the simulator are
    /// recorded. Senders of other commands are told that the program is shutting down.
    fn take_rest(&mut self) {
        self.hear_halts();
        while let Ok(envelope) = self.commands.try_recv() {
            let is_late = match &envelope {
                Envelope::Command(request, _) => request.command != Command::Stop,
                Envelope::PutDown(..) => true,
                Envelope::Refused(..) | Envelope::Simulated(..) => false,
            };
            if !is_late {
                self.take(envelope);
            }
        }
    }

    /// Tells the core of new stops, before the core gets anything that was sent after these stops. Also tells the
    /// core of stops and refusals that found the queue full.
    fn hear_halts(&mut self) {
        let epoch = self.halts.now().epoch;
        if epoch > self.heard {
            self.heard = epoch;
            let now = self.now();
            self.engine.handle_halt(epoch, now);
            self.figures.hear_stops();
        }
        let Overflow { stops, refusals } = self.overflow.take();
        for Counted { last, count, answers, .. } in stops.into_values() {
            let now = self.now();
            let given = self.engine.handle_stops(last, count, now);
            self.await_answer(given, answers, Some(now.since_start));
        }
        for Counted { last: (issuer, asked, refused), count, .. } in refusals.into_values() {
            let now = self.now();
            self.engine.note_refused(issuer, asked, &refused, count, now);
        }
    }

    fn take(&mut self, envelope: Envelope) {
        self.hear_halts();
        match envelope {
            Envelope::Command(request, answer) => {
                let now = self.now();
                let since = self.engine.is_counted(&request.command).then_some(now.since_start);
                let given = self.engine.handle_command(request, now);
                self.await_answer(given, vec![answer], since);
            }
            Envelope::Refused(issuer, asked, refused, answer) => self.note_refused(issuer, asked, refused, answer),
            Envelope::Simulated(issuer, simulated) => {
                let now = self.now();
                self.engine.note_simulated(issuer, simulated, now);
            }
            Envelope::PutDown(issuer, venue, robots, answer) => {
                let now = self.now();
                let given = self.engine.put_down_in(venue, &robots, issuer, now);
                self.await_answer(given, vec![answer], Some(now.since_start));
            }
        }
    }

    fn note_refused(&mut self, issuer: Issuer, asked: Asked, refused: Refused, answer: Option<oneshot::Sender<Decision>>) {
        let now = self.now();
        let since = (!self.engine.may_be_answer(&asked, &refused)).then_some(now.since_start);
        let noted = self.engine.note_refused(issuer, asked, &refused, 1, now);
        let Some(answer) = answer else { return };
        let sender = WaitingSender { answer, since };
        if let Some(seq) = noted {
            self.refusals.push_back((seq, sender, refused));
        } else {
            self.answer(sender, Err(refused));
        }
    }

    fn await_answer(&mut self, given: Result<Ticket, Refused>, answers: Vec<oneshot::Sender<Decision>>, since: Option<Duration>) {
        let waiting = answers.into_iter().map(|answer| WaitingSender { answer, since });
        match given {
            Ok(ticket) => drop(self.answers.insert(ticket, waiting.collect())),
            Err(refused) => {
                let seq = self.engine.written();
                self.refusals.extend(waiting.map(|sender| (seq, sender, refused.clone())));
            }
        }
    }

    fn answer(&self, WaitingSender { answer, since }: WaitingSender, given: Decision) {
        if let Some(since) = since {
            self.figures.answered(self.clock.since_start().saturating_sub(since));
        }
        // The sender may have gone away. The command was carried out or refused all the same.
        let _ = answer.send(given);
    }

    /// Performs every effect. The state is published before the answer is sent, so that the receiver of the answer
    /// sees the effect.
    fn settle(&mut self) {
        let mut answers = Vec::new();
        loop {
            while let Some(effect) = self.engine.poll_effect() {
                match effect {
                    Effect::Order(robot, order) => self.send(robot, order),
                    Effect::Halt(robot) => self.links.halt(&robot),
                    Effect::Led(robot, blinks) => self.links.light(&robot, blinks),
                    Effect::Record(page) => {
                        self.handed.hand(&page, self.clock.since_start());
                        self.store.record(page, self.losses);
                        // If the store has reported already, its report is handled now and not in the next round.
                        if self.word.has_changed().unwrap_or(false) {
                            self.hear_store();
                        }
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

    /// Answers the refusals that are on record. While nothing can be recorded, refusals are answered at once. They
    /// are recorded when the store writes again.
    fn refuse(&mut self) {
        let kept = self.word.borrow().kept;
        let due = self.refusals.iter().take_while(|(seq, ..)| *seq <= kept || self.store_failed).count();
        for (_, sender, refused) in self.refusals.drain(..due).collect::<Vec<_>>() {
            self.answer(sender, Err(refused));
        }
    }

    fn deliver(&mut self, answers: &mut Vec<(Ticket, Decision)>) {
        for (ticket, answer) in answers.drain(..) {
            for sender in self.answers.remove(&ticket).into_iter().flatten() {
                self.answer(sender, answer.clone());
            }
        }
    }

    fn hear_store(&mut self) {
        let now = self.now();
        let word = self.word.borrow_and_update().clone();
        self.count_kept(&word, now.since_start);
        let StoreStatus { kept, failure, losses, kept_back } = word;
        self.engine.handle_event(Event::Recorded(kept), now);
        if kept_back > self.kept_back {
            self.kept_back = kept_back;
            self.engine.handle_event(Event::KeptBack(kept_back), now);
        }
        if losses > self.losses || (failure.is_some() && !self.store_failed) {
            (self.losses, self.store_failed) = (losses, true);
            let words = failure.as_deref().unwrap_or("writing failed for a moment").to_owned();
            tracing::error!(words, "the record cannot be written");
            self.engine.handle_event(Event::StoreFailed(words), now);
        } else if let Some(words) = failure.as_deref() {
            self.engine.handle_event(Event::StoreReason(words.to_owned()), now);
        }
        if failure.is_none() && std::mem::take(&mut self.store_failed) {
            tracing::info!("the record can be written again");
            self.engine.handle_event(Event::StoreRestored, now);
        }
    }

    fn count_kept(&mut self, word: &StoreStatus, now: Duration) {
        self.handed.keep(word.kept, now);
        let lost = word.losses.saturating_sub(self.losses);
        if lost > 0 {
            self.handed.lose();
        }
        self.figures.hear_store(word, lost);
    }

    /// Sends an order with the number of halts so far. A motion is not sent if a stop was raised after the core
    /// ordered it. The core is then told of the stop first, so that it does not repeat the order.
    fn send(&mut self, robot: RobotId, order: Order) {
        // Count and epoch are read together. Otherwise a stop between two reads would let an older order begin.
        let halts = self.links.halts(&robot);
        let answer = if order.epoch < halts.epoch && order.action.is_motion() {
            let now = self.now();
            self.engine.handle_halt(halts.epoch, now);
            RobotEvent::Halted(order.id, false)
        } else if self.links.send(&robot, order, halts) {
            return;
        } else {
            RobotEvent::Failed(order.id, "the robot's adapter does not accept orders".to_owned())
        };
        let now = self.now();
        self.engine.handle_event(Event::Robot(robot, answer), now);
    }

    /// Returns the time for the next input of the core. If the clock was set, the core is told of this change first.
    fn now(&mut self) -> Now {
        let now = self.clock.now();
        self.engine.note_clock(self.clock.set_ms(now), now);
        now
    }

    fn publish(&mut self) {
        let snapshot = self.engine.snapshot();
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
#[path = "task_tests.rs"]
mod tests;
