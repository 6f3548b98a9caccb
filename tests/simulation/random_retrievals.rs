//! Retrieval in hundreds of random halls with the dangerous bag anywhere: discovery searches until a verdict is
//! danger, then the pair is sent. The pair secures the bag wherever an independent search finds a way, and reports a
//! fault in the other halls. Meanwhile there may be STOPs, heat, kills, lost parcels, parcels that no camera
//! recognises, commands at wrong times, and late, interleaved reports. A failure prints its seed.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use std::time::Duration;

use hallsweep_core::arm::{Gripper, Parcel};
use hallsweep_core::command::{Command, LuggageRef, Move, TemperatureReport, Verdict};
use hallsweep_core::hold::Hold;
use hallsweep_core::pair::{RetrievalFault, Saying, Which};
use hallsweep_core::phase::PhaseName;
use hallsweep_core::place::Place;
use hallsweep_core::rng::RandomStream;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{Cell, LuggageId, Piece};
use hallsweep_core::world::alarm::AlarmCause;
use hallsweep_core::world::hall_map::Mark;
use hallsweep_sim::pair::{AstrayMemory, Mishaps, PairSettings, RobotMemory, Slip};
use hallsweep_sim::{Camera, Hall, SimSettings, Truth};

use crate::every_way::can_be_fetched;
use crate::halls;
use crate::trio::{Bodies, Delays, Trio};

/// Number of retrievals.
const HALLS: usize = 500;

/// Time after which the disk has stored everything, longer than any delay of the disk.
const MOST_DISK_MS: u64 = 100;

/// Number of steps that exceeds any mission of these halls, including the time under holds.
const MOST_STEPS: u64 = 400_000;

/// Faults of one run.
#[derive(Clone, Debug)]
struct Trouble {
    delays: Delays,
    mishaps: Mishaps,
    /// Probability of an operator's action at each moment of the retrieval, and maximum number of actions.
    interrupts: f64,
    most: u32,
    unknown_rate: f64,
}

/// A third of the runs has late links only. In those, only a hall without a way may cause a fault or an alarm.
fn trouble(seed: u64) -> Trouble {
    let mut dice = RandomStream::new(seed, "trouble");
    let late = |dice: &mut RandomStream| [0, 30, 300][dice.below(3) as usize];
    let delays = Delays {
        reports_ms: [late(&mut dice), late(&mut dice), late(&mut dice)],
        orders_ms: late(&mut dice) / 3,
        disk_ms: late(&mut dice) / 10,
    };
    let calm = Trouble { delays, mishaps: Mishaps::default(), interrupts: 0.0, most: 0, unknown_rate: 0.0 };
    if seed.is_multiple_of(3) {
        return calm;
    }
    let slips = (0..dice.below(4)).map(|_| Slip { parcel: 1, after_steps: dice.below(7) as u32 }).collect();
    let unrecognised = (0..dice.below(3)).map(|_| 1).collect();
    let mishaps = Mishaps { slips, unrecognised, ..Mishaps::default() };
    let unknown_rate = if dice.below(4) == 0 { 0.1 } else { 0.0 };
    Trouble { mishaps, interrupts: 0.02 * dice.fraction(), most: 1 + dice.below(8) as u32, unknown_rate, ..calm }
}

/// Totals of all runs.
#[derive(Debug, Default)]
struct Tally {
    secured: usize,
    faults: BTreeMap<&'static str, usize>,
    stops: usize,
    heats: usize,
    kills: usize,
    links: usize,
    losses: usize,
    calls: usize,
    refused: usize,
    steps: u64,
}

/// Two workers, each with every other seed; `HALLSWEEP_SEED` repeats one seed.
#[test]
fn a_bag_is_secured_wherever_there_is_a_way_and_a_fault_is_named_elsewhere() {
    if let Ok(seed) = std::env::var("HALLSWEEP_SEED") {
        let mut tally = Tally::default();
        Mission::begun(seed.parse().expect("a seed is a number")).play(&mut tally);
        eprintln!("{tally:?}");
        return;
    }
    let work = |first: u64| {
        let mut tally = Tally::default();
        let seeds = (first..).step_by(2).filter(|seed| Mission::begun(*seed).play(&mut tally));
        assert_eq!(seeds.take(HALLS / 2).count(), HALLS / 2);
        tally
    };
    let [one, two] = std::thread::scope(|scope| {
        let workers = [0, 1].map(|first| scope.spawn(move || work(first)));
        workers.map(|worker| worker.join().expect("it has said which seed fails"))
    });
    eprintln!("{one:?}\n{two:?}");
    let all = |of: fn(&Tally) -> usize| of(&one) + of(&two);
    assert_eq!(all(|tally| tally.secured + tally.faults.values().sum::<usize>()), HALLS);
    assert!(all(|tally| tally.secured) > HALLS / 3 && all(|tally| tally.faults.values().sum()) > HALLS / 10);
    assert!(all(|tally| tally.stops) > 100 && all(|tally| tally.heats) > 50 && all(|tally| tally.kills) > 100);
    assert!(all(|tally| tally.losses) > 100 && all(|tally| tally.calls) > 100 && all(|tally| tally.links) > 50);
}

struct Mission {
    trio: Option<Trio>,
    hall: Arc<Hall>,
    trouble: Trouble,
    seed: u64,
    dice: RandomStream,
    /// Places of all robots when a hold was first seen; `None` while there is no hold.
    held_at: Option<Bodies>,
    steps: u64,
    /// Whether messages were in transit when the program was killed, or a link was lost.
    is_cut: bool,
}

impl Mission {
    fn begun(seed: u64) -> Mission {
        let (hall, trouble) = (halls::random(seed, [4, 7, 12][(seed % 3) as usize]), trouble(seed));
        let sim = SimSettings { unknown_rate: trouble.unknown_rate, sonar_noise_cm: 0.0, ..SimSettings::new(seed, Camera::Stub) };
        let pair = PairSettings { way_out: true, mishaps: trouble.mishaps.clone(), ..PairSettings::new(seed, Place::ENTRANCE) };
        let trio = Some(Trio::born(Arc::clone(&hall), sim, pair, trouble.delays));
        Mission { trio, hall, trouble, seed, dice: RandomStream::new(seed, "operator"), held_at: None, steps: 0, is_cut: false }
    }

    fn trio(&mut self) -> &mut Trio {
        self.trio.as_mut().expect("it is away only while it is killed")
    }

    fn state(&mut self) -> Arc<Snapshot> {
        self.trio().state()
    }

    fn advance(&mut self) -> bool {
        let advances = self.trio().advance();
        self.check();
        advances
    }

    fn wait(&mut self, ms: u64) {
        let end = self.trio().now() + Duration::from_millis(ms);
        while self.trio().advance_to(end) {
            self.check();
        }
        self.check();
    }

    fn must(&mut self, command: Command) {
        let given = self.trio().give(command.clone());
        let (seed, state) = (self.seed, self.state());
        assert!(given.is_ok(), "seed {seed}: {command:?} {given:?}: {:?}", state.mission);
        self.check();
    }

    fn must_not(&mut self, command: Command) {
        let before = (self.trio().bodies(), self.state().mission.epoch);
        let given = self.trio().give(command.clone());
        let (seed, state) = (self.seed, self.state());
        assert!(given.is_err(), "seed {seed}: {command:?} was accepted: {:?}", state.mission);
        assert_eq!((self.trio().bodies(), state.mission.epoch), before, "seed {seed}: {command:?}");
        self.check();
    }

    /// Plays the whole mission; false if no piece can be judged dangerous.
    fn play(mut self, tally: &mut Tally) -> bool {
        let bomb = self.locate();
        if let Some(bomb) = bomb {
            self.fetch(bomb, tally);
        }
        bomb.is_some()
    }

    /// Searches until a piece is judged dangerous and discovery is home; `None` if no recognised piece was found.
    fn locate(&mut self) -> Option<Piece> {
        let keen = [1.0, 0.4, 0.15][self.dice.below(3) as usize];
        let mut bomb = None;
        for _ in 0..MOST_STEPS {
            let state = self.state();
            let asked = state.pending().filter(|luggage| luggage.has_photo()).map(|luggage| (luggage.id, luggage.piece));
            match (asked, state.mission.phase) {
                (Some((id, piece)), _) if bomb.is_none() => {
                    let danger = piece.is_some() && self.dice.happens(keen);
                    bomb = piece.filter(|_| danger);
                    let verdict = if danger { Verdict::Danger } else { Verdict::Safe };
                    self.must(Command::Verdict { luggage: LuggageRef::Id(id), verdict, note: None, hot: Default::default() });
                    self.wait(MOST_DISK_MS);
                }
                (_, PhaseName::BombLocated | PhaseName::Explored) if self.trio().is_quiet() => return bomb,
                (_, PhaseName::Idle) if state.mission.refusals.start.is_none() => {
                    self.must(Command::Start);
                    self.wait(MOST_DISK_MS);
                }
                (_, _) => assert!(self.advance(), "seed {}: nothing happens in {:?}", self.seed, state.mission),
            }
        }
        let state = self.state();
        panic!("seed {}: the search has no end: {:?} {:?}", self.seed, state.mission, state.luggage);
    }

    fn fetch(&mut self, bomb: Piece, tally: &mut Tally) {
        let expected = can_be_fetched(&self.hall, bomb);
        let before = self.state().alarms.len();
        if !self.state().mission.holds.is_empty() {
            self.release(tally);
        }
        self.must(Command::Retrieve(None));
        let mut left = self.trouble.most;
        self.steps = 0;
        let mut gripped = self.grip();
        loop {
            let state = self.state();
            // A kill right after the grip changed, before the change is reported.
            let is_news = std::mem::replace(&mut gripped, self.grip()) != gripped;
            if is_news && self.trouble.most > 0 && self.dice.happens(0.1) {
                self.kill(tally);
                continue;
            }
            match state.mission.phase {
                PhaseName::BagSecured | PhaseName::Fault if self.trio().is_quiet() => break,
                PhaseName::Retrieving if !state.mission.holds.is_empty() => self.release(tally),
                PhaseName::Retrieving if left > 0 && self.dice.happens(self.trouble.interrupts) => {
                    left -= 1;
                    self.interrupt(tally);
                }
                _ => assert!(self.advance(), "seed {}: nothing happens in {:?}", self.seed, state.mission),
            }
            assert!(self.steps < MOST_STEPS, "seed {}: no end: {:?} {:?}", self.seed, state.mission, state.retrieval);
        }
        tally.steps += self.steps;
        self.check_end(bomb, expected, before, tally);
    }

    /// State of the grippers, arms and load of the pair.
    fn grip(&mut self) -> (Option<Parcel>, [bool; 4], usize) {
        let pair = &self.trio().pair;
        let [one, two] = Which::ALL.map(|which| pair.arm(which));
        let closed = [one, two].map(|arm| arm.gripper == Gripper::Closed);
        (pair.load(), [one.on_floor, one.lifted, closed[0], closed[1]], pair.taken_in().len())
    }

    /// One action of an operator or external event during the retrieval.
    fn interrupt(&mut self, tally: &mut Tally) {
        match self.dice.below(9) {
            0 | 1 => {
                tally.stops += 1;
                self.must(Command::Stop);
            }
            2 => {
                tally.heats += 1;
                self.must(Command::Temperature(TemperatureReport::TooHigh));
            }
            3 | 4 => {
                self.kill(tally);
            }
            5 => self.must(Command::Start),
            6 => {
                tally.links += 1;
                self.is_cut = true;
                let robot = self.dice.below(3) as usize;
                self.trio().lose_link(robot);
                // The search for the parcel continues without a link and ends within this time.
                let wait = 900 + self.dice.below(2000);
                self.wait(wait);
                assert!(self.state().mission.holds.contains(&Hold::RobotLink), "seed {}: a link is lost", self.seed);
                self.must_not(Command::Start);
                self.trio().find_link(robot);
            }
            _ => self.wrong_command(tally),
        }
    }

    fn kill(&mut self, tally: &mut Tally) {
        tally.kills += 1;
        self.is_cut = true;
        let durable = self.dice.below(3) as usize;
        self.trio = self.trio.take().map(|trio| trio.killed(durable));
        self.held_at = None;
        self.check();
        assert!(self.state().mission.holds.contains(&Hold::Restart), "seed {}", self.seed);
    }

    /// Gives a command that is impossible during a retrieval.
    fn wrong_command(&mut self, tally: &mut Tally) {
        tally.refused += 1;
        let command = match self.dice.below(7) {
            0 => Command::BackHome,
            1 => Command::Goto(Cell::HOME),
            2 => Command::Move(Move::Forward),
            3 => Command::Retrieve(None),
            4 => Command::RetakePhoto(LuggageId(1)),
            5 => Command::Unsure { luggage: LuggageRef::Pending, note: None, hot: Default::default() },
            _ => Command::Reset,
        };
        self.must_not(command);
    }

    /// Removes the causes of the holds one after the other, then presses START, which is refused before.
    fn release(&mut self, tally: &mut Tally) {
        let wait = self.dice.below(3000);
        self.wait(wait);
        if self.dice.below(4) == 0 && self.state().mission.phase == PhaseName::Retrieving {
            self.wrong_command(tally);
        }
        for _ in 0..100 {
            let state = self.state();
            let holds = &state.mission.holds;
            if holds.contains(&Hold::RobotLink) || holds.contains(&Hold::TemperatureStale) {
                self.must_not(Command::Start);
                self.wait(100);
            } else if holds.contains(&Hold::Alarm) {
                self.must_not(Command::Start);
                let alarm = state.alarms.iter().filter(|alarm| alarm.acknowledged.is_none()).find_map(|alarm| alarm.id);
                match alarm {
                    Some(alarm) => self.must(Command::Acknowledge(alarm)),
                    None => assert!(state.alarms.iter().any(|alarm| alarm.id.is_none()), "seed {}: no alarm", self.seed),
                }
                self.wait(MOST_DISK_MS);
            } else if holds.contains(&Hold::TooHigh) {
                self.must_not(Command::Start);
                self.must(Command::Temperature(TemperatureReport::Ok));
                self.wait(wait);
                let mission = &self.state().mission;
                let at_rest = mission.phase != PhaseName::Retrieving;
                assert!(at_rest || !mission.holds.is_empty(), "seed {}: cool again, it goes on by itself", self.seed);
            } else if holds.is_empty() || state.mission.phase == PhaseName::BagSecured {
                // A STOP that came when the bag was already home holds nothing; START would begin another mission.
                return;
            } else {
                self.must(Command::Start);
                self.wait(MOST_DISK_MS);
            }
        }
        let state = self.state();
        panic!("seed {}: still held: {:?}", self.seed, state.mission);
    }

    /// Invariants of every moment.
    fn check(&mut self) {
        self.steps += 1;
        let seed = self.seed;
        let trio = self.trio.as_mut().expect("it is away only while it is killed");
        let state = trio.state();
        let bodies = trio.bodies();
        let held_at = self.held_at.take();
        if !state.mission.holds.is_empty() {
            let before = held_at.unwrap_or(bodies);
            assert_eq!(bodies, before, "seed {seed}: something moves under {:?}", state.mission.holds);
            self.held_at = Some(before);
        }
        check_places(trio, seed);
        if trio.is_quiet() {
            check_map(&state, trio, seed);
        }
        let taken_in = trio.pair.taken_in();
        assert!(
            state.mission.phase != PhaseName::BagSecured || taken_in.len() == 1,
            "seed {seed}: secured, and not in the container"
        );
        for piece in state.luggage.iter().filter(|piece| piece.secured.is_some()) {
            assert!(piece.piece.is_some_and(|piece| taken_in == [piece]), "seed {seed}: {piece:?} is not in the container");
        }
    }

    fn check_end(&mut self, bomb: Piece, expected: bool, alarms: usize, tally: &mut Tally) {
        let seed = self.seed;
        let state = self.state();
        let trio = self.trio.as_ref().expect("it is away only while it is killed");
        let log = || state.log.iter().map(|line| line.said.to_string()).collect::<Vec<_>>();
        let secured = state.mission.phase == PhaseName::BagSecured;
        assert_eq!(secured, expected, "seed {seed}: {:?} {:?}: {:#?}", state.mission.fault, self.trouble, log());
        let expected: Vec<Piece> = secured.then_some(bomb).into_iter().collect();
        assert_eq!(trio.pair.taken_in(), expected, "seed {seed}: what is in the container");
        let recorded = state.luggage.iter().any(|piece| piece.piece == Some(bomb) && piece.secured.is_some());
        assert_eq!(recorded, secured, "seed {seed}: when it was secured");
        for robot in state.robots.iter() {
            let begins = robot.id.name() == "discovery";
            assert!((robot.view.outside == 0) == begins && !robot.view.off_centre, "seed {seed}: {robot:?}");
        }
        assert_eq!(state.robot.pose.cell, Cell::HOME, "seed {seed}");
        if !secured {
            let words = state.mission.fault.as_ref().map(ToString::to_string).unwrap_or_default();
            let fault = RetrievalFault::ALL.into_iter().find(|fault| words.contains(fault.in_words()));
            let fault = fault.unwrap_or_else(|| panic!("seed {seed}: {words}"));
            *tally.faults.entry(fault.name()).or_default() += 1;
        }
        tally.secured += usize::from(secured);
        let said = |saying: Saying| {
            state
                .alarms
                .iter()
                .skip(alarms)
                .filter(|alarm| matches!(alarm.cause, AlarmCause::Call(_, said) if said == saying))
                .count()
        };
        let memory = trio.pair.memory();
        let lost = self.trouble.mishaps.slips.len() - memory.slips.map_or(0, |left| left.len());
        let missed = self.trouble.mishaps.unrecognised.len() - memory.unrecognised.map_or(0, |left| left.len());
        assert_eq!(said(Saying::PackageLost), lost, "seed {seed}: alarms of lost parcels, {:?}: {:#?}", self.trouble, log());
        // The camera's answer may be lost with the link or the killed program; then the camera looks once more.
        let calls = said(Saying::CallOperator);
        assert!(calls == missed || calls < missed && self.is_cut, "seed {seed}: {calls} calls, {missed} not seen: {:#?}", log());
        tally.losses += lost;
        tally.calls += missed;
    }
}

/// Cells that a base occupies or is about to occupy.
fn cells_of(robot: &RobotMemory) -> BTreeSet<Cell> {
    let along = |astray: AstrayMemory| match astray {
        AstrayMemory::Along(Place::Cell(cell), _) => Some(cell),
        _ => None,
    };
    let rolls_to = robot.motion.and_then(|(to, _)| along(to));
    robot.stands.place.cell().into_iter().chain(along(robot.astray)).chain(rolls_to).collect()
}

/// Checks that no robot shares a cell with another or with an obstacle.
fn check_places(trio: &Trio, seed: u64) {
    let memory = trio.pair.memory();
    let [one, two] = memory.robots.map(|robot| cells_of(&robot));
    assert!(one.is_disjoint(&two), "seed {seed}: the bases share a cell: {one:?} {two:?}");
    let discovery = trio.sim.memory();
    if discovery.outside == 0 {
        let here = discovery.pose.cell;
        assert!(!one.contains(&here) && !two.contains(&here), "seed {seed}: a base is in discovery's cell");
    }
    for which in Which::ALL {
        let stands = trio.pair.stands(which).0.place.cell();
        assert!(
            stands.is_none_or(|cell| trio.truth(cell) == Truth::Free),
            "seed {seed}: {which:?} stands in an obstacle: {stands:?}"
        );
    }
}

/// Checks that the map never contradicts the truth.
fn check_map(state: &Snapshot, trio: &Trio, seed: u64) {
    for (cell, mark) in state.map.known() {
        let truth = trio.truth(cell);
        assert_eq!(mark == Mark::Visited, truth == Truth::Free, "seed {seed}: the map is wrong at {cell}: {mark:?}, {truth:?}");
        assert!(mark != Mark::Wall || truth == Truth::Wall, "seed {seed}: no wall at {cell}");
    }
}
