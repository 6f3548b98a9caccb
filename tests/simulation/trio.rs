//! The whole program with discovery and the pair, in simulated time. The store confirms late. Each robot has a
//! separate link that delays orders and reports by random times but keeps their order; a halt passes at once. The
//! program can be killed at any moment.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use hallsweep_core::command::{Command, Door, Issuer, Request};
use hallsweep_core::effect::{Action, Effect, Order, Page};
use hallsweep_core::engine::{Engine, Recalled};
use hallsweep_core::event::{Event, RobotEvent, Whereabouts};
use hallsweep_core::pair::Which;
use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::refused::Refused;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::robot::RobotId;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::Entry;
use hallsweep_core::units::{Cell, Now, Piece, Pose, Seq, Ticket, WallTime};
use hallsweep_sim::pair::{Pair, PairMemory, PairSettings};
use hallsweep_sim::{BodyPose, Hall, Sim, SimMemory, SimSettings, Truth};

/// Maximum delays in milliseconds: reports of each robot, orders to each robot, and a page to the disk.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Delays {
    pub(crate) reports_ms: [u64; 3],
    pub(crate) orders_ms: u64,
    pub(crate) disk_ms: u64,
}

/// False behaviour of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Spoiled {
    /// The robot reports a failure.
    Fails,
    /// The robot reports success without doing anything.
    Pretends,
}

/// Function that selects the false behaviour of a robot for an action; `None` means correct behaviour.
pub(crate) type Spoils = fn(usize, Action) -> Option<Spoiled>;

/// Places of everything movable: the robots, and the parcel in the grippers.
pub(crate) type Bodies = ([BodyPose; 3], Option<(f64, f64, f64)>);

pub(crate) struct Trio {
    pub(crate) engine: Engine,
    pub(crate) sim: Sim,
    pub(crate) pair: Pair,
    /// Entries on the disk.
    pub(crate) disk: Vec<Entry>,
    /// Pages that the disk has not stored yet, with the time of storing.
    pages: Line<Page>,
    /// Links of discovery, SRM1 and SRM2.
    links: [Link; 3],
    memory: Option<SimMemory>,
    pair_memory: Option<PairMemory>,
    hall: Arc<Hall>,
    /// Cells of the pieces that were lifted, as discovery finds them; `None` for a piece that is in no cell.
    moved: BTreeMap<Piece, Option<Cell>>,
    /// Settings that the next start reads.
    pub(crate) rules: Settings,
    pub(crate) spoils: Spoils,
    settings: (SimSettings, PairSettings, Delays),
    dice: RandomStream,
    now: Now,
}

/// Queue of messages in transit, with the time of arrival.
struct Line<T>(VecDeque<(Duration, T)>);

impl<T> Line<T> {
    fn send(&mut self, what: T, at: Duration) {
        let behind = self.0.back().map_or(at, |(last, _)| at.max(*last));
        self.0.push_back((behind, what));
    }

    fn due(&self) -> Option<Duration> {
        self.0.front().map(|(due, _)| *due)
    }

    fn arrived(&mut self, now: Duration) -> Option<T> {
        self.due().filter(|due| *due <= now)?;
        self.0.pop_front().map(|(_, what)| what)
    }
}

impl<T> Default for Line<T> {
    fn default() -> Line<T> {
        Line(VecDeque::new())
    }
}

/// Link of one robot.
#[derive(Default)]
struct Link {
    reports: Line<RobotEvent>,
    /// Orders in transit, each with the number of halts before it was sent.
    orders: Line<(Order, u64)>,
    halts: u64,
    /// Number of halts before the last order that was begun.
    obeyed: u64,
    /// Whether the link is down; then it passes only this fact.
    is_down: bool,
}

fn ids() -> [RobotId; 3] {
    [RobotId::discovery(), Which::Srm1.robot(), Which::Srm2.robot()]
}

fn member(index: usize) -> Option<Which> {
    index.checked_sub(1).map(|index| Which::ALL[index])
}

fn standing(outside: u8, pose: Pose, off_centre: bool) -> RobotEvent {
    match outside {
        0 => RobotEvent::Stands(Whereabouts { pose, off_centre }),
        steps => RobotEvent::StandsOutside(steps, pose.heading, off_centre),
    }
}

fn introduction_of(pair: &Pair, which: Which) -> Vec<RobotEvent> {
    let (BasePose { place, heading }, off_centre) = pair.stands(which);
    let stands = match place {
        Place::Cell(cell) => standing(0, Pose { cell, heading }, off_centre),
        Place::Outside(steps) => standing(steps, Pose { cell: Cell::HOME, heading }, off_centre),
    };
    vec![stands, RobotEvent::Arm(pair.arm(which)), RobotEvent::LinkUp(pair.capabilities())]
}

impl Trio {
    pub(crate) fn born(hall: Arc<Hall>, sim: SimSettings, pair: PairSettings, delays: Delays) -> Trio {
        Trio::ruled(Settings::default(), hall, sim, pair, delays)
    }

    pub(crate) fn ruled(rules: Settings, hall: Arc<Hall>, sim: SimSettings, pair: PairSettings, delays: Delays) -> Trio {
        let engine = Engine::new(rules, Default::default(), "trio".into());
        let outside = BasePose { place: Place::ENTRANCE, heading: Pose::START.heading };
        let mut trio = Trio {
            engine,
            sim: Sim::new(Arc::clone(&hall), sim),
            pair: Pair::new(Arc::clone(&hall), pair.clone(), [outside; 2]),
            disk: Vec::new(),
            pages: Line::default(),
            links: Default::default(),
            memory: None,
            pair_memory: None,
            hall,
            moved: BTreeMap::new(),
            rules,
            spoils: |_, _| None,
            dice: RandomStream::new(sim.seed, "links"),
            settings: (sim, pair, delays),
            now: Now::default(),
        };
        trio.begin();
        trio
    }

    fn begin(&mut self) {
        for which in Which::ALL {
            self.engine.add_robot(which.robot(), self.now);
        }
        self.settle();
    }

    /// Kills the program like `kill -9` and starts it again. The first `durable` pages on their way are already on
    /// the disk, although nobody was told.
    pub(crate) fn killed(mut self, durable: usize) -> Trio {
        let durable = durable.min(self.pages.0.len());
        self.disk.extend(self.pages.0.drain(..durable).flat_map(|(_, page)| page.entries));
        let now = Now { since_start: Duration::ZERO, wall: self.now.wall };
        let (sim, pair, _) = self.settings.clone();
        let memory = self.memory.expect("a robot is written down as soon as it is put down");
        let pair_memory = self.pair_memory.take().expect("a pair is written down as soon as it is put down");
        let mut trio = Trio {
            engine: Engine::recall(self.rules, "again".into(), self.recalled(), now),
            sim: Sim::remembering(Arc::clone(&self.hall), sim, memory),
            pair: Pair::remembering(Arc::clone(&self.hall), pair, pair_memory, now),
            pages: Line::default(),
            links: Default::default(),
            moved: BTreeMap::new(),
            now,
            ..self
        };
        trio.begin();
        trio
    }

    /// Deletes the memory of the robots, as a person could: the robots are at their first places, and the hall is as
    /// at the beginning.
    pub(crate) fn forget(&mut self) {
        let outside = BasePose { place: Place::ENTRANCE, heading: Pose::START.heading };
        (self.memory, self.pair_memory) = (Some(SimMemory::NEW), Some(PairMemory::new([outside; 2])));
    }

    /// Disconnects a robot, which then halts by itself; the orders in transit are lost.
    pub(crate) fn lose_link(&mut self, index: usize) {
        match member(index) {
            Some(which) => self.pair.handle_halt(which, self.now),
            None => self.sim.handle_halt(self.now),
        }
        while self.takes_report() {}
        self.report(index, RobotEvent::LinkLost("it is out of reach".to_owned()));
        (self.links[index].orders, self.links[index].is_down) = (Line::default(), true);
        self.settle();
    }

    /// Reconnects a robot, which then reports its state.
    pub(crate) fn find_link(&mut self, index: usize) {
        let introduction = match member(index) {
            Some(which) => introduction_of(&self.pair, which),
            None => {
                let SimMemory { pose, outside, .. } = self.sim.memory();
                let stands = standing(outside, pose, self.sim.is_off_centre());
                vec![stands, RobotEvent::Arm(self.sim.hook()), RobotEvent::LinkUp(self.sim.capabilities())]
            }
        };
        self.links[index].is_down = false;
        introduction.into_iter().for_each(|report| self.report(index, report));
        self.settle();
    }

    fn recalled(&self) -> Recalled {
        let mut state = PersistentState::first(Default::default());
        self.disk.iter().for_each(|entry| state.apply(entry));
        Recalled { state, written: Seq(self.disk.len() as u64), commands: Vec::new(), kept_back: Vec::new(), latest: Vec::new() }
    }

    pub(crate) fn give(&mut self, command: Command) -> Result<Ticket, Refused> {
        let given = self.engine.handle_command(Request::new(command, Issuer::operator(Door::LOCAL)), self.now);
        self.settle();
        given
    }

    /// Advances to the next timed event; false when there is none.
    pub(crate) fn advance(&mut self) -> bool {
        let Some(next) = self.next() else { return false };
        self.wait_until(next);
        true
    }

    /// Advances to the next timed event or to `end`; false when `end` comes first.
    pub(crate) fn advance_to(&mut self, end: Duration) -> bool {
        let next = self.next().filter(|next| *next < end);
        self.wait_until(next.unwrap_or(end));
        next.is_some()
    }

    pub(crate) fn state(&mut self) -> Arc<Snapshot> {
        self.engine.snapshot()
    }

    pub(crate) fn now(&self) -> Duration {
        self.now.since_start
    }

    pub(crate) fn bodies(&self) -> Bodies {
        let [one, two] = Which::ALL.map(|which| self.pair.body(which));
        ([self.sim.pose_at(self.now), one, two], self.pair.load_m())
    }

    /// Current contents of a cell.
    pub(crate) fn truth(&self, cell: Cell) -> Truth {
        let lies = self.moved.iter().find(|(_, lies)| **lies == Some(cell)).map(|(piece, _)| Truth::Luggage(*piece));
        let stood = match self.hall.truth(cell) {
            Truth::Luggage(piece) if self.moved.contains_key(&piece) => Truth::Free,
            truth => truth,
        };
        lies.unwrap_or(stood)
    }

    /// Whether no message is in transit and no robot works.
    pub(crate) fn is_quiet(&self) -> bool {
        let told = self.links.iter().all(|link| link.reports.0.is_empty() && link.orders.0.is_empty());
        told && !self.sim.is_busy() && !Which::ALL.into_iter().any(|which| self.pair.is_busy(which))
    }

    fn next(&self) -> Option<Duration> {
        let lines = self.links.iter().flat_map(|link| [link.reports.due(), link.orders.due()]);
        let by_themselves = [self.sim.poll_timeout(), self.pair.poll_timeout(), self.engine.poll_timeout(), self.pages.due()];
        by_themselves.into_iter().chain(lines).flatten().min()
    }

    fn wait_until(&mut self, since_start: Duration) {
        self.now = Now { since_start: since_start.max(self.now.since_start), wall: WallTime::default() };
        self.sim.handle_timeout(self.now);
        self.pair.handle_timeout(self.now);
        self.engine.handle_timeout(self.now);
        self.settle();
    }

    /// Handles everything that takes no further time.
    fn settle(&mut self) {
        loop {
            self.keep_memories();
            if let Some(effect) = self.engine.poll_effect() {
                self.perform(effect);
            } else if let Some((order, exposure)) = self.sim.take_exposure() {
                self.sim.handle_photo(order, exposure.develop(), self.now);
            } else if !self.takes_report() && !self.arrives() {
                return;
            }
        }
    }

    /// Puts a robot's next report into transit; false when there is none.
    fn takes_report(&mut self) -> bool {
        if let Some(report) = self.sim.poll_event() {
            self.report(0, report);
        } else if let Some((which, report)) = self.pair.poll_event() {
            self.report(1 + which.index(), report);
        } else {
            return false;
        }
        true
    }

    fn keep_memories(&mut self) {
        if let Some(memory) = self.sim.poll_memory() {
            let floor = self.hall.rearranged(&self.moved);
            assert!(memory.fits(&floor), "the next start would take it for damaged: {memory:?}");
            self.memory = Some(memory);
        }
        if let Some(memory) = self.pair.poll_memory() {
            assert!(memory.fits(&self.hall), "the next start would take it for damaged: {memory:?}");
            self.pair_memory = Some(memory);
            let moved = self.pair.moved();
            if moved != self.moved {
                self.sim.handle_hall(Arc::new(self.hall.rearranged(&moved)));
                self.moved = moved;
            }
        }
    }

    fn report(&mut self, index: usize, report: RobotEvent) {
        let at = self.after(self.settings.2.reports_ms[index]);
        if !self.links[index].is_down {
            self.links[index].reports.send(report, at);
        }
    }

    fn after(&mut self, most_ms: u64) -> Duration {
        self.now.since_start + Duration::from_millis(self.dice.below(most_ms + 1))
    }

    fn perform(&mut self, effect: Effect) {
        let index_of = |robot: &RobotId| ids().iter().position(|id| id == robot).expect("it is one of the three");
        match effect {
            Effect::Order(robot, order) => {
                let at = self.after(self.settings.2.orders_ms);
                let link = &mut self.links[index_of(&robot)];
                if !link.is_down {
                    link.orders.send((order, link.halts), at);
                }
            }
            Effect::Halt(robot) => {
                let index = index_of(&robot);
                self.links[index].halts += 1;
                self.halt(index);
            }
            Effect::Led(_, blinks) => self.sim.handle_led(blinks),
            Effect::Record(page) => {
                let at = self.after(self.settings.2.disk_ms);
                self.pages.send(page, at);
            }
            Effect::Answer(..) => {}
        }
    }

    fn halt(&mut self, index: usize) {
        if self.links[index].obeyed < self.links[index].halts {
            match member(index) {
                Some(which) => self.pair.handle_halt(which, self.now),
                None => self.sim.handle_halt(self.now),
            }
        }
    }

    /// Delivers the next message that has arrived; false when there is none.
    fn arrives(&mut self) -> bool {
        let now = self.now.since_start;
        if let Some(page) = self.pages.arrived(now) {
            let last = page.last();
            self.disk.extend(page.entries);
            assert_eq!(last, Seq(self.disk.len() as u64), "the journal has no gaps");
            self.engine.handle_event(Event::Recorded(last), self.now);
            return true;
        }
        let first = (0..3).filter_map(|index| Some((self.links[index].reports.due()?, index))).min();
        if let Some((_, index)) = first
            && let Some(report) = self.links[index].reports.arrived(now)
        {
            self.engine.handle_event(Event::Robot(ids()[index].clone(), report), self.now);
            return true;
        }
        (0..3).any(|index| {
            let arrived = self.links[index].orders.arrived(now);
            arrived.is_some_and(|(order, halts)| {
                self.obey(index, order, halts);
                true
            })
        })
    }

    /// Executes an order, unless it is a motion and a halt came after it was sent.
    fn obey(&mut self, index: usize, order: Order, halts: u64) {
        if halts < self.links[index].halts && order.action.is_motion() {
            let off_centre = match member(index) {
                Some(which) => self.pair.stands(which).1,
                None => self.sim.is_off_centre(),
            };
            return self.report(index, RobotEvent::Halted(order.id, off_centre));
        }
        self.links[index].obeyed = halts;
        match (self.spoils)(index, order.action) {
            Some(Spoiled::Fails) => return self.report(index, RobotEvent::Failed(order.id, "it cannot".to_owned())),
            Some(Spoiled::Pretends) => return self.report(index, RobotEvent::Done(order.id)),
            None => {}
        }
        match member(index) {
            Some(which) => self.pair.handle_order(which, order, self.now),
            None => self.sim.handle_order(order, self.now),
        }
    }
}
