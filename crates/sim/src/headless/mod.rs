//! Runs a mission in simulated time, without network, threads or waiting. Core and simulator are driven by the same
//! calls as in the real program, in a plain loop. It is used by `hallsweep explore`, the simulation tests and the
//! benchmarks. The same seed gives the same run, byte for byte.

mod explore;
pub use explore::{Figures, Verdicts, explore, explore_and_tell};

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use crate::pair::{Pair, PairSettings};
use crate::{Hall, Sim, SimSettings};
use hallsweep_core::command::{Accepted, Command, Door, Issuer, Move, Request, Strategy};
use hallsweep_core::effect::{Action, Effect};
use hallsweep_core::engine::Engine;
use hallsweep_core::event::{Event, RobotEvent};
use hallsweep_core::pair::Which;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::place::{BasePose, Place};
use hallsweep_core::refused::Refused;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::robot::RobotId;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::Venue;
use hallsweep_core::state::fact::Entry;
use hallsweep_core::units::{Cell, Now, Piece, Pose, Ticket, WallTime};
use hallsweep_core::world::coverage::{Sensor, SensorModel};

/// 2026-01-01T08:00:00Z. A simulated run begins up to twelve hours later, at a second that is drawn from its seed.
const FIRST_DAY_MS: i64 = 1_767_254_400_000;

#[derive(Debug)]
pub struct Run {
    pub engine: Engine,
    pub sim: Sim,
    /// The pair of robots that fetches dangerous pieces, if there is one.
    pub pair: Option<Pair>,
    /// All recorded entries, in the order of recording.
    pub journal: Vec<Entry>,
    pub moves: Moves,
    /// The hall before any piece was lifted.
    hall: Arc<Hall>,
    /// Every piece that was ever lifted, and the cell where it lies now. `None` if it lies in no cell.
    moved: BTreeMap<Piece, Option<Cell>>,
    began_ms: i64,
    now: Now,
    open: Option<Action>,
    answers: BTreeMap<Ticket, Result<Accepted, Refused>>,
}

/// Number of moves of each kind. Each counts as one move in the total.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Moves {
    pub steps: u64,
    pub turns: u64,
    /// Steps that met an obstacle. The way back to the cell's centre is not counted separately.
    pub bumps: u64,
}

impl Moves {
    #[must_use]
    pub const fn total(self) -> u64 {
        self.steps + self.turns + self.bumps
    }
}

impl Run {
    /// Starts a run with a robot at home in `hall`. Everything random follows from `sim.seed`, including the clock.
    #[must_use]
    pub fn new(hall: Arc<Hall>, sim: SimSettings, settings: Settings, strategy: Strategy) -> Run {
        let mut run = Run::begin(hall, sim, settings, strategy);
        run.settle();
        run
    }

    /// Like `new`, but with a pair of robots that waits outside the entrance.
    #[must_use]
    pub fn with_pair(hall: Arc<Hall>, sim: SimSettings, settings: Settings, strategy: Strategy, pair: PairSettings) -> Run {
        let mut run = Run::begin(Arc::clone(&hall), sim, settings, strategy);
        for which in Which::ALL {
            run.engine.add_robot(which.robot(), run.now);
        }
        let outside = BasePose { place: Place::ENTRANCE, heading: Pose::START.heading };
        run.pair = Some(Pair::new(hall, pair, [outside; 2]));
        run.settle();
        run
    }

    fn begin(hall: Arc<Hall>, sim: SimSettings, settings: Settings, strategy: Strategy) -> Run {
        let seed = sim.seed;
        let second = RandomStream::new(seed, "clock").below(12 * 3600);
        let began_ms = FIRST_DAY_MS + i64::try_from(second).unwrap_or(0) * 1000;
        let now = Now { since_start: Duration::ZERO, wall: WallTime { unix_ms: began_ms, offset_s: 0 } };
        let mut engine = Engine::new(settings, strategy, Arc::from(format!("seed-{seed}")));
        if sim.camera_misses {
            let sensor = Sensor { cells: settings.sonar_cells, model: Some(SensorModel::SimCamera) };
            engine.note_venue(Venue { name: hall.name().into(), cell_m: Some(hall.cell_m()), sensor, ..Venue::default() }, now);
        }
        Run {
            engine,
            sim: Sim::new(Arc::clone(&hall), sim),
            pair: None,
            hall,
            moved: BTreeMap::new(),
            journal: Vec::new(),
            moves: Moves::default(),
            now,
            began_ms,
            open: None,
            answers: BTreeMap::new(),
        }
    }

    /// Sends a command as the local operator, and handles its immediate consequences.
    ///
    /// # Errors
    /// When the core refuses the command.
    pub fn give(&mut self, command: Command) -> Result<Accepted, Refused> {
        self.ask(Request::new(command, Issuer::operator(Door::LOCAL)))
    }

    /// Like `give`, but for a request of any sender.
    ///
    /// # Errors
    /// When the core refuses the request.
    pub fn ask(&mut self, request: Request) -> Result<Accepted, Refused> {
        let ticket = self.engine.handle_command(request, self.now);
        self.settle();
        let ticket = ticket?;
        self.answers.remove(&ticket).expect("a store in memory keeps every record at once, so every answer is given at once")
    }

    /// Passes an event to the core that the simulator does not cause by itself.
    pub fn happen(&mut self, event: Event) {
        self.engine.handle_event(event, self.now);
        self.settle();
    }

    /// Advances to the next event. Returns false if no event is left that happens by itself.
    pub fn advance(&mut self) -> bool {
        let Some(next) = self.next() else { return false };
        self.wait_until(next);
        true
    }

    /// Lets `seconds` of simulated time pass.
    pub fn wait(&mut self, seconds: f64) {
        let end = self.now.since_start + Duration::from_secs_f64(seconds);
        while self.next().is_some_and(|next| next <= end) {
            self.advance();
        }
        self.wait_until(end);
    }

    /// Advances until `reached` is true. Returns false if it is still false after `limit` events.
    pub fn run_until(&mut self, limit: usize, mut reached: impl FnMut(&Snapshot) -> bool) -> bool {
        for _ in 0..limit {
            if reached(&self.state()) {
                return true;
            }
            if !self.advance() {
                break;
            }
        }
        reached(&self.state())
    }

    pub fn state(&mut self) -> Arc<Snapshot> {
        self.engine.snapshot()
    }

    pub fn phase(&mut self) -> PhaseName {
        self.state().mission.phase
    }

    #[must_use]
    pub const fn now(&self) -> Now {
        self.now
    }

    fn next(&self) -> Option<Duration> {
        let pair = self.pair.as_ref().and_then(Pair::poll_timeout);
        [self.sim.poll_timeout(), pair, self.engine.poll_timeout()].into_iter().flatten().min()
    }

    fn wait_until(&mut self, since_start: Duration) {
        let passed = since_start.saturating_sub(self.now.since_start);
        self.now.since_start += passed;
        self.now.wall.unix_ms = self.began_ms + i64::try_from(self.now.since_start.as_millis()).unwrap_or(0);
        self.sim.handle_timeout(self.now);
        if let Some(pair) = &mut self.pair {
            pair.handle_timeout(self.now);
        }
        self.engine.handle_timeout(self.now);
        self.settle();
    }

    /// Passes effects to the simulators and their reports to the core, until neither has more.
    fn settle(&mut self) {
        loop {
            if let Some(effect) = self.engine.poll_effect() {
                self.perform(effect);
            } else if let Some((order, exposure)) = self.sim.take_exposure() {
                self.sim.handle_photo(order, exposure.develop(), self.now);
            } else if let Some(report) = self.sim.poll_event() {
                self.count(&report);
                self.engine.handle_event(Event::Robot(RobotId::discovery(), report), self.now);
            } else if let Some((which, report)) = self.pair.as_mut().and_then(Pair::poll_event) {
                self.follow_pair();
                self.engine.handle_event(Event::Robot(which.robot(), report), self.now);
            } else {
                break;
            }
        }
    }

    /// Removes the pieces that the pair has lifted from the hall that the searching robot sees.
    fn follow_pair(&mut self) {
        let moved = self.pair.as_ref().map(Pair::moved).unwrap_or_default();
        if moved != self.moved {
            self.sim.handle_hall(Arc::new(self.hall.rearranged(&moved)));
            self.moved = moved;
        }
    }

    fn perform(&mut self, effect: Effect) {
        match effect {
            Effect::Order(robot, order) => match (member(&robot), &mut self.pair) {
                (Some(which), Some(pair)) => pair.handle_order(which, order, self.now),
                (Some(_) | None, _) => {
                    self.open = Some(order.action);
                    self.sim.handle_order(order, self.now);
                }
            },
            Effect::Halt(robot) => match (member(&robot), &mut self.pair) {
                (Some(which), Some(pair)) => pair.handle_halt(which, self.now),
                (Some(_) | None, _) => self.sim.handle_halt(self.now),
            },
            Effect::Led(_, blinks) => self.sim.handle_led(blinks),
            Effect::Record(page) => {
                let (last, kept_back) = (page.last(), page.kept_back);
                self.journal.extend(page.entries);
                self.engine.handle_event(Event::Recorded(last), self.now);
                if let Some(kept_back) = kept_back {
                    self.engine.handle_event(Event::KeptBack(kept_back.number), self.now);
                }
            }
            Effect::Answer(ticket, answer) => drop(self.answers.insert(ticket, answer)),
        }
    }

    fn count(&mut self, report: &RobotEvent) {
        match (report, self.open) {
            (RobotEvent::Blocked(..), _) => self.moves.bumps += 1,
            (RobotEvent::Done(_), Some(Action::Move(Move::Forward | Move::Backward))) => self.moves.steps += 1,
            (RobotEvent::Done(_), Some(Action::Move(_))) => self.moves.turns += 1,
            _ => {}
        }
    }
}

fn member(robot: &RobotId) -> Option<Which> {
    Which::ALL.into_iter().find(|which| which.robot() == *robot)
}
