//! Joins the simulated robot to the core's loop. This file has the channels, the timers, the speed of time and the
//! simulator's controls. It also has the threads that draw photos and write the state file. `hallsweep_sim` decides
//! what the robot does. No other file of the simulated robot waits for anything.

use std::collections::{BTreeSet, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::{oneshot, watch};
use tokio::task::JoinHandle;
use tokio::time::Instant;

use super::pair_link::Moved;
use super::remote::{Controls, News, Remote, SimulatedHall};
use super::sim_time::SimTime;
use super::state_file::SimStateFile;
use crate::robots::waits::{done, done_for, hand_over};
use crate::runtime::clock::Clock;
use crate::runtime::link::{RobotSide, Stamped};
use hallsweep_core::effect::Order;
use hallsweep_core::event::{Capabilities, Photo, RobotEvent};
use hallsweep_core::speed::Speed;
use hallsweep_core::units::{Cell, Celsius, Now, OrderId};
use hallsweep_sim::{Faults, Hall, Sim, SimSettings};

/// Maximum real time for drawing a photo, at any speed of simulated time; the core knows this maximum. Drawing takes
/// some hundredths of a second, but the machine may be busy. A late photo counts as a failed photo.
const DEVELOPING: Duration = Duration::from_secs(3);

/// A failed write of the state file is retried after this time, or earlier if there is something new to write.
const WRITTEN_AGAIN: Duration = Duration::from_secs(1);

/// Maximum time between two readings of the thermometer. Without this limit, a missing thermometer would look like a
/// constant temperature.
const READ_AGAIN: Duration = Duration::from_secs(10);

pub(super) struct Begin {
    pub(super) sim: Sim,
    /// The settings of the robot, for a new simulation in another hall.
    pub(super) settings: SimSettings,
    pub(super) speed: Speed,
    /// Everything that must not be forgotten is written to this file before the core gets a report of it.
    pub(super) state_file: Option<SimStateFile>,
    pub(super) floor: Floor,
    pub(super) remote: Remote,
    /// Whether the simulator's faults apply: only the searching robot has them.
    pub(super) has_faults: bool,
}

/// Runs a simulated robot until the core's loop has dropped its end of the channels.
pub(super) async fn run(begin: Begin, side: RobotSide, clock: Clock) {
    let Begin { sim, settings, speed, state_file, floor, remote, has_faults } = begin;
    let link = SimLink {
        sim,
        settings,
        side,
        clock,
        time: SimTime::begin(speed, clock.now().since_start),
        report: None,
        said: VecDeque::new(),
        developing: None,
        obeyed: 0,
        state_file,
        writing: None,
        write_again: None,
        reading: None,
        floor,
        remote,
        has_faults,
        controls: Controls::default(),
    };
    link.run().await;
}

/// The hall as it was loaded, with two changes: other robots have lifted pieces, and obstacles were added.
#[derive(Clone, Debug)]
pub(super) struct Floor {
    pub(super) hall: Arc<Hall>,
    pub(super) moved: watch::Receiver<Moved>,
    /// Cells with an obstacle that the hall does not have.
    pub(super) blocked: BTreeSet<Cell>,
}

impl Floor {
    pub(super) const fn new(hall: Arc<Hall>, moved: watch::Receiver<Moved>) -> Floor {
        Floor { hall, moved, blocked: BTreeSet::new() }
    }
}

struct SimLink {
    sim: Sim,
    settings: SimSettings,
    side: RobotSide,
    clock: Clock,
    time: SimTime,
    /// A report that the core's loop has not taken yet. While it waits, no orders are received, so that reports
    /// cannot pile up.
    report: Option<RobotEvent>,
    /// Reports of the link itself, sent before the robot's next report.
    said: VecDeque<RobotEvent>,
    developing: Option<(OrderId, JoinHandle<Photo>)>,
    /// Number of halts that the core knew of when it sent the latest order that this link began.
    obeyed: u64,
    /// The state file, while it is not being written.
    state_file: Option<SimStateFile>,
    /// The write in progress. It runs on a separate thread, so that a disk that hangs does not delay a halt. No order
    /// is taken until the write is done.
    writing: Option<JoinHandle<SimStateFile>>,
    /// Time of the real clock at which a failed write is retried.
    write_again: Option<Duration>,
    /// The last reading of the thermometer, and the time of the real clock at which it is repeated.
    reading: Option<(Celsius, Duration)>,
    floor: Floor,
    remote: Remote,
    has_faults: bool,
    /// The controls that are applied now. `remote` has the controls that were requested.
    controls: Controls,
}

impl SimLink {
    async fn run(mut self) {
        self.floor.moved.mark_changed();
        self.remote.controls.mark_changed();
        loop {
            self.write();
            self.put_obstacles();
            self.next_report();
            let settled = self.report.is_none() && self.writing.is_none();
            if settled {
                self.remote.say_ready();
            }
            let free = settled && !self.remote.is_moving();
            let jumps = free && self.jumps();
            let wake = self.wake();
            tokio::select! {
                biased;
                halts = self.side.halts.raised() => self.halt(halts.count),
                sent = hand_over(&self.side.reports, &mut self.report), if self.report.is_some() => if !sent { return },
                state_file = done(&mut self.writing) => {
                    let owes = state_file.as_ref().is_some_and(|state_file| state_file.owed().is_some());
                    self.write_again = owes.then(|| self.clock.now().since_start + WRITTEN_AGAIN);
                    self.state_file = state_file;
                }
                news = self.remote.news(settled) => self.hear(news),
                Ok(()) = self.floor.moved.changed() => self.look_at_floor(),
                Ok(()) = self.side.led.changed() => self.led(),
                given = self.side.orders.recv(), if free => match given {
                    Some(stamped) => self.order(stamped),
                    None => return,
                },
                // If no photo comes, the order fails at its deadline.
                (order, developed) = done_for(&mut self.developing), if free => if let Some(photo) = developed {
                    self.sim.handle_photo(order, photo, self.now());
                },
                () = std::future::ready(()), if jumps => self.jump(),
                () = tokio::time::sleep_until(wake), if free => self.sim.handle_timeout(self.now()),
            }
        }
    }

    fn now(&self) -> Now {
        let Now { since_start, wall } = self.clock.now();
        Now { since_start: self.time.at(since_start), wall }
    }

    /// The real time at which the link must wake next, at any speed of simulated time.
    fn wake(&self) -> Instant {
        let at = self.time.comes(self.sim.poll_timeout(), self.clock.now().since_start);
        let again = [self.write_again, self.reading.map(|(_, again)| again)];
        self.clock.instant(again.into_iter().flatten().fold(at, Duration::min))
    }

    /// Whether simulated time jumps. It jumps at speed `max` and in a single step, but not while a photo is drawn,
    /// which takes real time.
    fn jumps(&self) -> bool {
        self.time.jumps() && self.sim.is_busy() && !self.sim.is_developing()
    }

    fn write(&mut self) {
        let Some(mut state_file) = self.state_file.take() else { return };
        let again = self.write_again.is_some_and(|at| at <= self.clock.now().since_start);
        let Some(memory) = self.sim.poll_memory().or_else(|| state_file.owed().filter(|_| again)) else {
            self.state_file = Some(state_file);
            return;
        };
        self.writing = Some(tokio::task::spawn_blocking(move || {
            state_file.keep(memory);
            state_file
        }));
    }

    /// Takes the robot's next report. Does nothing while another report waits, or while the memory from which the
    /// report follows is not written yet. No report of the robot is taken while its link is lost.
    fn next_report(&mut self) {
        if self.report.is_some() || self.writing.is_some() {
            return;
        }
        self.report = self.said.pop_front();
        if self.report.is_none() && !self.controls.is_link_lost {
            self.report = self.sim.poll_event();
        }
        self.read_again();
        if let Some(RobotEvent::LinkUp(simulated)) = self.report {
            let Capabilities { step, turn, photo, arm, .. } = simulated;
            let real = |time| self.time.speed().to_real(time);
            let (step, turn, photo, arm) = (real(step), real(turn), real(photo) + DEVELOPING, real(arm));
            self.report = Some(RobotEvent::LinkUp(Capabilities { step, turn, photo, arm, ..simulated }));
            self.said.extend(self.time.is_paused().then_some(RobotEvent::Paused));
        }
    }

    fn read_again(&mut self) {
        let now = self.clock.now().since_start;
        if let Some(RobotEvent::Temperature(celsius)) = self.report {
            self.reading = Some((celsius, now + READ_AGAIN));
        } else if let Some((celsius, _)) = self.reading.filter(|(_, again)| *again <= now && self.report.is_none()) {
            self.reading = Some((celsius, now + READ_AGAIN));
            let is_heard = !self.controls.is_link_lost && !self.controls.faults.no_thermometer;
            self.report = is_heard.then_some(RobotEvent::Temperature(celsius));
        }
    }

    fn hear(&mut self, news: News) {
        match news {
            News::Controls => self.obey_controls(),
            News::Asked => {}
            News::Decided(decided) => self.move_to(decided),
        }
    }

    fn obey_controls(&mut self) {
        let wanted = self.remote.controls.borrow_and_update().clone();
        let wanted = if self.has_faults { wanted } else { Controls { is_link_lost: false, faults: Faults::default(), ..wanted } };
        let before = std::mem::replace(&mut self.controls, wanted);
        let runs_otherwise = self.time.obey(&self.controls, &before, self.clock.now().since_start);
        let Controls { is_paused, is_link_lost, faults, .. } = self.controls;
        self.sim.handle_faults(faults, self.now());
        match (before.is_link_lost, is_link_lost) {
            (false, true) => {
                self.sim.handle_link_lost(self.now());
                self.developing = None;
                self.said.push_back(RobotEvent::LinkLost("the simulator keeps it lost".to_owned()));
            }
            (true, false) => self.sim.handle_link_back(self.now()),
            (false, false) if runs_otherwise && is_paused => self.said.push_back(RobotEvent::Paused),
            (false, false) if runs_otherwise => self.sim.tell_capabilities(),
            (true, true) | (false, false) => {}
        }
    }

    fn look_at_floor(&mut self) {
        let moved = self.floor.moved.borrow_and_update().clone();
        let hall = self.floor.hall.rearranged(&moved);
        let hall = if self.floor.blocked.is_empty() { hall } else { hall.blocked(&self.floor.blocked) };
        self.sim.handle_hall(Arc::new(hall));
    }

    /// Places the requested obstacles. In the robot's own cell an obstacle appears only after the robot has left.
    fn put_obstacles(&mut self) {
        let wanted = &self.controls.blocked;
        if wanted.is_empty() && self.floor.blocked.is_empty() {
            return;
        }
        let free: BTreeSet<Cell> = wanted.iter().filter(|cell| !self.sim.is_in_or_enters(**cell)).copied().collect();
        if free != self.floor.blocked {
            self.floor.blocked = free;
            self.look_at_floor();
        }
    }

    fn move_to(&mut self, decided: Option<(SimulatedHall, oneshot::Sender<()>)>) {
        let Some((SimulatedHall { hall, seed }, put_down)) = decided else { return };
        self.settings.seed = seed;
        self.sim = Sim::new(Arc::clone(&hall), self.settings);
        self.sim.handle_faults(self.controls.faults, Now::default());
        self.sim.handle_led(*self.side.led.borrow());
        self.time.begin_again(self.clock.now().since_start);
        (self.developing, self.write_again, self.reading) = (None, None, None);
        if let Some(state_file) = &mut self.state_file {
            state_file.move_to(&hall);
        }
        if self.floor.moved.has_changed().is_err() {
            // The lifted pieces belong to the previous hall. Their sender has ended, so no more pieces will be
            // lifted.
            self.floor.moved = watch::channel(Moved::new()).1;
        }
        self.floor = Floor::new(hall, self.floor.moved.clone());
        self.look_at_floor();
        // The requester may be gone.
        let _ = put_down.send(());
    }

    fn led(&mut self) {
        let blinks = *self.side.led.borrow_and_update();
        self.sim.handle_led(blinks);
    }

    /// Halts the robot. Does nothing if the latest order was sent after the halt. Such an order may arrive here
    /// before the halt does.
    fn halt(&mut self, count: u64) {
        if self.obeyed < count {
            self.sim.handle_halt(self.now());
        }
        self.time.end_step();
    }

    fn order(&mut self, stamped: Stamped) {
        let Stamped { order, halts } = stamped;
        if stamped.is_void(self.side.halts.now().count) {
            self.report = Some(RobotEvent::Halted(order.id, self.sim.is_off_centre()));
            return;
        }
        if self.controls.is_link_lost {
            // The order is lost with the link, and the core learns of the lost link before it waits for an answer.
            return;
        }
        self.obeyed = halts;
        let deadline = self.time.speed().to_simulated(order.deadline);
        self.sim.handle_order(Order { deadline, ..order }, self.now());
        if let Some((id, exposure)) = self.sim.take_exposure() {
            self.developing = Some((id, tokio::task::spawn_blocking(move || exposure.develop())));
        }
    }

    fn jump(&mut self) {
        if let Some(at) = self.sim.poll_timeout() {
            self.time.jump_to(at, self.clock.now().since_start);
        }
        self.sim.handle_timeout(self.now());
        if !self.sim.is_busy() {
            self.time.end_step();
        }
    }
}

#[cfg(test)]
#[path = "controlled_tests.rs"]
mod controlled_tests;

#[cfg(test)]
#[path = "link_tests.rs"]
mod tests;
