//! The only loop: takes halts, reports, commands and time to the core, and its effects to robots, store, doors.
//! It decides nothing.

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
use super::overflow::{Answer, Counted, Overflow, OverflowOut};
use super::store::{Store, StoreStatus};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, Issuer, Refused};
use hallsweep_core::effect::{Effect, Order};
use hallsweep_core::engine::Engine;
use hallsweep_core::event::{Event, RobotEvent, RobotId};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{Epoch, Now, Seq, Ticket};

/// How long nothing may happen before the clock is looked at.
const GLANCE: Duration = Duration::from_secs(1);

pub struct Task {
    engine: Engine,
    links: Links,
    store: Box<dyn Store>,
    word: watch::Receiver<StoreStatus>,
    clock: Clock,
    halts: HaltWatch,
    /// The last stop of which the core was told.
    heard: Epoch,
    commands: mpsc::Receiver<Envelope>,
    /// What found no room in that queue.
    overflow: OverflowOut,
    snapshots: watch::Sender<Arc<Snapshot>>,
    answers: BTreeMap<Ticket, Vec<WaitingSender>>,
    /// The refusals that wait until they are on record (safety A6), in the order of their entries.
    refusals: VecDeque<(Seq, WaitingSender, Refused)>,
    /// Whether the store's last word was that it cannot write.
    store_failed: bool,
    /// How often the store has lost something, as far as the core was told.
    losses: u64,
    /// Whether the core was told that the program ends.
    is_ending: bool,
    figures: Figures,
    /// What of the record is counted when it is kept.
    handed: HandedPages,
}

/// Who waits for an answer, and since when.
struct WaitingSender {
    answer: oneshot::Sender<Answer>,
    since: Duration,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Course {
    /// What asked it to end, if something has: the robot halts then, and who has asked for something is still answered.
    pub ended_by: Option<&'static str>,
    /// Whether nobody asks for anything any more.
    pub is_over: bool,
}

impl Task {
    /// A loop round an engine, and the handle by which doors reach it.
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
            is_ending: false,
            figures,
            handed,
        };
        (handle, task)
    }

    /// Runs until `course` is over or every handle is gone.
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
                // Before commands and reports: a steady flow of these must not keep a silent sensor from being noticed.
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
                // Last, since they are heard of before any command is taken: stops without end must not keep the rest waiting.
                _ = self.halts.raised() => {}
                () = self.overflow.news() => {}
                // Nothing happens: pages that show an age still want to know that the clock was set.
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

    /// Stops and refusals that were given before the end go on record; whoever gave another command hears that it was too late.
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

    /// Tells the core of stops, before anything that was given after them, and of what else found no room in the queue.
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
            self.await_answer(given, answers, now.since_start);
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
                let given = self.engine.handle_command(request, now);
                self.await_answer(given, vec![answer], now.since_start);
            }
            Envelope::Refused(issuer, asked, refused, answer) => self.note_refused(issuer, asked, refused, answer),
            Envelope::Simulated(issuer, simulated) => {
                let now = self.now();
                self.engine.note_simulated(issuer, simulated, now);
            }
            Envelope::PutDown(issuer, venue, robots, answer) => {
                let now = self.now();
                let given = self.engine.put_down_in(venue, &robots, issuer, now);
                self.await_answer(given, vec![answer], now.since_start);
            }
        }
    }

    fn note_refused(&mut self, issuer: Issuer, asked: Asked, refused: Refused, answer: Option<oneshot::Sender<Answer>>) {
        let now = self.now();
        let noted = self.engine.note_refused(issuer, asked, &refused, 1, now);
        let Some(answer) = answer else { return };
        let sender = WaitingSender { answer, since: now.since_start };
        if let Some(seq) = noted {
            self.refusals.push_back((seq, sender, refused));
        } else {
            self.answer(sender, Err(refused));
        }
    }

    fn await_answer(&mut self, given: Result<Ticket, Refused>, answers: Vec<oneshot::Sender<Answer>>, since: Duration) {
        let waiting = answers.into_iter().map(|answer| WaitingSender { answer, since });
        match given {
            Ok(ticket) => drop(self.answers.insert(ticket, waiting.collect())),
            Err(refused) => {
                let seq = self.engine.written();
                self.refusals.extend(waiting.map(|sender| (seq, sender, refused.clone())));
            }
        }
    }

    fn answer(&self, WaitingSender { answer, since }: WaitingSender, given: Answer) {
        self.figures.answered(self.clock.since_start().saturating_sub(since));
        // Whoever asked may have gone away; what was asked was carried out, or refused, all the same.
        let _ = answer.send(given);
    }

    /// Performs every effect; publishes the state before it answers, so that whoever was answered sees what was done.
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
                        // A store that has said its word already need not wait for the next round.
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

    /// Answers the refusals that are on record. While nothing can be recorded none waits: what was refused then is on record when
    /// the store writes again.
    fn refuse(&mut self) {
        let kept = self.word.borrow().kept;
        let due = self.refusals.iter().take_while(|(seq, ..)| *seq <= kept || self.store_failed).count();
        for (_, sender, refused) in self.refusals.drain(..due).collect::<Vec<_>>() {
            self.answer(sender, Err(refused));
        }
    }

    fn deliver(&mut self, answers: &mut Vec<(Ticket, Answer)>) {
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
        let StoreStatus { kept, failure, losses } = word;
        self.engine.handle_event(Event::Recorded(kept), now);
        if losses > self.losses || (failure.is_some() && !self.store_failed) {
            (self.losses, self.store_failed) = (losses, true);
            let words = failure.as_deref().unwrap_or("writing failed for a moment").to_owned();
            tracing::error!(words, "the record cannot be written");
            self.engine.handle_event(Event::StoreFailed(words), now);
        } else if let Some(words) = failure.as_deref() {
            self.engine.handle_event(Event::StoreReason(words.to_owned()), now);
        }
        if failure.is_none() && std::mem::take(&mut self.store_failed) {
            tracing::info!("the record is written again");
            self.engine.handle_event(Event::StoreRestored, now);
        }
    }

    /// What the store says that it has kept is counted; what it has lost will not be kept.
    fn count_kept(&mut self, word: &StoreStatus, now: Duration) {
        self.handed.keep(word.kept, now);
        let lost = word.losses.saturating_sub(self.losses);
        if lost > 0 {
            self.handed.lose();
        }
        self.figures.hear_store(word, lost);
    }

    /// Sends an order with the halts so far, unless a stop has been raised since it was given: then the core
    /// hears of the stop first, so that it does not give the order again.
    fn send(&mut self, robot: RobotId, order: Order) {
        // Count and epoch are of one moment: a stop between the two would let an order begin that is from before it.
        let halts = self.links.halts(&robot);
        let answer = if order.epoch < halts.epoch && order.action.is_motion() {
            let now = self.now();
            self.engine.handle_halt(halts.epoch, now);
            RobotEvent::Halted(order.id, false)
        } else if self.links.send(&robot, order, halts) {
            return;
        } else {
            RobotEvent::Failed(order.id, "its adapter does not take orders".to_owned())
        };
        let now = self.now();
        self.engine.handle_event(Event::Robot(robot, answer), now);
    }

    /// The time for what the core is told next. It is told first if somebody has set the clock.
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
