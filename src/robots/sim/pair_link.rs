//! Joins the simulated pair to the core's loop. This file has the links of both robots, the timers, the speed of
//! time, and the thread that writes the state file. One file has both links, because the robots carry a parcel
//! together. `hallsweep_sim::pair` decides what the pair does. No other file of the pair waits for anything.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{mpsc, oneshot, watch};
use tokio::task::JoinHandle;
use tokio::time::Instant;

use super::pair_state_file::PairStateFile;
use super::remote::{Controls, News, Remote, SimulatedHall};
use super::sim_time::SimTime;
use crate::robots::Adapter;
use crate::robots::waits::done;
use crate::runtime::clock::Clock;
use crate::runtime::link::{RobotSide, Stamped};
use hallsweep_core::effect::Order;
use hallsweep_core::event::{Capabilities, RobotEvent};
use hallsweep_core::pair::Which;
use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::speed::Speed;
use hallsweep_core::units::{Cell, Now, Piece, Pose};
use hallsweep_sim::pair::{Pair, PairSettings};

/// A failed write of the state file is retried after this time, or earlier if there is something new to write.
const WRITTEN_AGAIN: Duration = Duration::from_secs(1);

/// Every piece that was lifted, and where it is now.
pub(in crate::robots) type Moved = BTreeMap<Piece, Option<Cell>>;

pub(super) struct Begin<P> {
    pub(super) pair: P,
    /// The settings of the pair, for a new pair in another hall.
    pub(super) settings: PairSettings,
    pub(super) speed: Speed,
    pub(super) state_file: Option<PairStateFile>,
    pub(super) moved: watch::Sender<Moved>,
    pub(super) remote: Remote,
}

/// The adapters of the two robots SRM1 and SRM2. The adapter of SRM2 passes its link to the adapter of SRM1, which
/// drives both robots.
pub(super) fn adapters(begin: Begin<impl FnOnce(Now) -> Pair + Send + 'static>, clock: Clock) -> [Adapter; 2] {
    let Begin { pair, settings, speed, state_file, moved, remote } = begin;
    let (hand_over, other) = oneshot::channel::<RobotSide>();
    let first: Adapter = Box::new(move |side| {
        Box::pin(async move {
            let Ok(other) = other.await else { return };
            let began = clock.now();
            let pair = pair(Now { since_start: Duration::ZERO, ..began });
            let link = PairLink {
                pair,
                settings,
                sides: [side, other],
                clock,
                time: SimTime::begin(speed, began.since_start),
                report: None,
                said: VecDeque::new(),
                obeyed: [0; 2],
                state_file,
                writing: None,
                write_again: None,
                moved,
                remote,
                controls: Controls::default(),
                is_all_blocked: true,
            };
            link.run().await;
        })
    });
    let second: Adapter = Box::new(move |side| {
        Box::pin(async move {
            let reports = side.reports.clone();
            if hand_over.send(side).is_ok() {
                reports.closed().await;
            }
        })
    });
    [first, second]
}

struct PairLink {
    pair: Pair,
    settings: PairSettings,
    sides: [RobotSide; 2],
    clock: Clock,
    time: SimTime,
    /// A report that the core's loop has not taken yet, and the robot that it is about. While it waits, no orders are
    /// received.
    report: Option<(Which, RobotEvent)>,
    /// Reports of the link itself, sent before the pair's next report.
    said: VecDeque<(Which, RobotEvent)>,
    /// For each robot: the number of halts that the core knew of when it sent the latest order that this link began.
    obeyed: [u64; 2],
    /// The state file, while it is not being written.
    state_file: Option<PairStateFile>,
    /// The write in progress. No order is taken until it is done.
    writing: Option<JoinHandle<PairStateFile>>,
    /// Time of the real clock at which a failed write is retried.
    write_again: Option<Duration>,
    /// Pieces that the searching robot no longer meets.
    moved: watch::Sender<Moved>,
    remote: Remote,
    /// The controls that are applied now. `remote` has the controls that were requested.
    controls: Controls,
    is_all_blocked: bool,
}

impl PairLink {
    async fn run(mut self) {
        self.remote.controls.mark_changed();
        loop {
            self.tell_moved();
            self.write();
            if !self.is_all_blocked {
                self.put_obstacles();
            }
            self.next_report();
            let settled = self.report.is_none() && self.writing.is_none();
            if settled {
                self.remote.say_ready();
            }
            let free = settled && !self.remote.is_moving();
            let jumps = free && self.jumps();
            let wake = self.wake();
            let [one, two] = &mut self.sides;
            tokio::select! {
                biased;
                halts = one.halts.raised() => self.halt(Which::Srm1, halts.count),
                halts = two.halts.raised() => self.halt(Which::Srm2, halts.count),
                sent = hand_over([&one.reports, &two.reports], &mut self.report), if self.report.is_some() => if !sent { return },
                state_file = done(&mut self.writing) => {
                    let owes = state_file.as_ref().is_some_and(|state_file| state_file.owed().is_some());
                    self.write_again = owes.then(|| self.clock.now().since_start + WRITTEN_AGAIN);
                    self.state_file = state_file;
                }
                news = self.remote.news(settled) => self.hear(news),
                given = one.orders.recv(), if free => match given {
                    Some(stamped) => self.order(Which::Srm1, stamped),
                    None => return,
                },
                given = two.orders.recv(), if free => match given {
                    Some(stamped) => self.order(Which::Srm2, stamped),
                    None => return,
                },
                () = std::future::ready(()), if jumps => self.jump(),
                () = tokio::time::sleep_until(wake), if free => {
                    let now = self.now();
                    self.pair.handle_timeout(now);
                }
            }
        }
    }

    fn now(&self) -> Now {
        let Now { since_start, wall } = self.clock.now();
        Now { since_start: self.time.at(since_start), wall }
    }

    /// The real time at which the link must wake next, at any speed of simulated time.
    fn wake(&self) -> Instant {
        let at = self.time.comes(self.pair.poll_timeout(), self.clock.now().since_start);
        self.clock.instant(self.write_again.map_or(at, |again| again.min(at)))
    }

    fn is_busy(&self) -> bool {
        Which::ALL.into_iter().any(|which| self.pair.is_busy(which))
    }

    /// Whether simulated time jumps. It jumps at speed `max` and in a single step, unless one robot waits for the
    /// other.
    fn jumps(&self) -> bool {
        self.time.jumps() && self.is_busy() && !self.pair.awaits_the_other()
    }

    fn hear(&mut self, news: News) {
        match news {
            News::Controls => self.obey_controls(),
            News::Asked => {}
            News::Decided(decided) => self.move_to(decided),
        }
    }

    /// Applies the controls, except for faults, which only the searching robot has.
    fn obey_controls(&mut self) {
        let wanted = self.remote.controls.borrow_and_update().clone();
        let before = std::mem::replace(&mut self.controls, wanted);
        let runs_otherwise = self.time.obey(&self.controls, &before, self.clock.now().since_start);
        if runs_otherwise && self.time.is_paused() {
            self.said.extend(Which::ALL.map(|which| (which, RobotEvent::Paused)));
        } else if runs_otherwise {
            self.pair.tell_capabilities();
        }
        if self.controls.blocked != before.blocked {
            self.put_obstacles();
        }
    }

    fn put_obstacles(&mut self) {
        self.is_all_blocked = self.pair.handle_blocked(&self.controls.blocked);
    }

    fn move_to(&mut self, decided: Option<(SimulatedHall, oneshot::Sender<()>)>) {
        let Some((SimulatedHall { hall, seed }, put_down)) = decided else { return };
        self.settings.seed = seed;
        if let Some(state_file) = &mut self.state_file {
            state_file.move_to(&hall);
        }
        self.pair = Pair::new(Arc::clone(&hall), self.settings.clone(), outside());
        self.time.begin_again(self.clock.now().since_start);
        self.write_again = None;
        self.put_obstacles();
        self.tell_moved();
        // The requester may be gone.
        let _ = put_down.send(());
    }

    fn tell_moved(&self) {
        let now = self.pair.moved();
        self.moved.send_if_modified(|moved| {
            let is_news = *moved != now;
            *moved = now;
            is_news
        });
    }

    fn write(&mut self) {
        let Some(mut state_file) = self.state_file.take() else { return };
        let again = self.write_again.is_some_and(|at| at <= self.clock.now().since_start);
        let Some(memory) = self.pair.poll_memory().or_else(|| state_file.owed().filter(|_| again).cloned()) else {
            self.state_file = Some(state_file);
            return;
        };
        self.writing = Some(tokio::task::spawn_blocking(move || {
            state_file.keep(memory);
            state_file
        }));
    }

    /// Takes the pair's next report. Does nothing while another report waits, or while the memory from which the
    /// report follows is not written yet.
    fn next_report(&mut self) {
        if self.report.is_some() || self.writing.is_some() {
            return;
        }
        self.report = self.said.pop_front().or_else(|| self.pair.poll_event());
        if let Some((which, RobotEvent::LinkUp(simulated))) = self.report {
            let Capabilities { step, turn, photo, arm, .. } = simulated;
            let real = |time| self.time.speed().to_real(time);
            let (step, turn, photo, arm) = (real(step), real(turn), real(photo), real(arm));
            self.report = Some((which, RobotEvent::LinkUp(Capabilities { step, turn, photo, arm, ..simulated })));
            self.said.extend(self.time.is_paused().then_some((which, RobotEvent::Paused)));
        }
    }

    /// Halts the robot. Does nothing if the latest order was sent after the halt. Such an order may arrive here
    /// before the halt does.
    fn halt(&mut self, which: Which, count: u64) {
        if self.obeyed[which.index()] < count {
            let now = self.now();
            self.pair.handle_halt(which, now);
        }
        self.time.end_step();
    }

    fn order(&mut self, which: Which, stamped: Stamped) {
        let Stamped { order, halts } = stamped;
        if stamped.is_void(self.sides[which.index()].halts.now().count) {
            let (_, off_centre) = self.pair.stands(which);
            self.report = Some((which, RobotEvent::Halted(order.id, off_centre)));
            return;
        }
        self.obeyed[which.index()] = halts;
        let deadline = self.time.speed().to_simulated(order.deadline);
        let now = self.now();
        self.pair.handle_order(which, Order { deadline, ..order }, now);
    }

    fn jump(&mut self) {
        if let Some(at) = self.pair.poll_timeout() {
            self.time.jump_to(at, self.clock.now().since_start);
        }
        let now = self.now();
        self.pair.handle_timeout(now);
        if !self.is_busy() {
            self.time.end_step();
        }
    }
}

/// Where both robots wait when nothing is known about them.
pub(super) fn outside() -> [BasePose; 2] {
    [BasePose { place: Place::ENTRANCE, heading: Pose::START.heading }; 2]
}

/// Sends the report over the link of its robot as soon as there is room. Returns false when nobody receives reports
/// any more.
async fn hand_over(ends: [&mpsc::Sender<RobotEvent>; 2], report: &mut Option<(Which, RobotEvent)>) -> bool {
    let Some(which) = report.as_ref().map(|(which, _)| *which) else { return true };
    let Ok(room) = ends[which.index()].reserve().await else { return false };
    if let Some((_, report)) = report.take() {
        room.send(report);
    }
    true
}
