//! A core and a simulated robot with a store that confirms late, in a program that can be killed at any moment. As
//! after a start of the real program, the stored entries are folded and the robot keeps its memory.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;
use std::time::Duration;

use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Accepted, Command, Door, Issuer, Request, Strategy};
use hallsweep_core::effect::{Effect, KeptBack, Page};
use hallsweep_core::engine::{Engine, Recalled};
use hallsweep_core::event::Event;
use hallsweep_core::not_fetched::Fetcher;
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::RobotId;
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{Now, Seq, Ticket, WallTime};
use hallsweep_core::world::luggage::Judgement;
use hallsweep_sim::{BodyPose, Hall, Sim, SimMemory, SimSettings};

pub(crate) struct Mortal {
    pub(crate) engine: Engine,
    pub(crate) sim: Sim,
    /// Entries on the disk.
    pub(crate) disk: Vec<Entry>,
    /// Pages that the disk has not stored yet.
    on_the_way: VecDeque<Page>,
    pub(crate) answers: BTreeMap<Ticket, Result<Accepted, Refused>>,
    memory: Option<SimMemory>,
    hall: Arc<Hall>,
    strategy: Strategy,
    /// Answers of judges on the disk, apart from the journal.
    pub(crate) kept_back: Vec<Judgement>,
    /// Settings that the next start reads.
    rules: Settings,
    settings: SimSettings,
    now: Now,
}

impl Mortal {
    /// Starts a program; a robot with a hook fetches by itself.
    pub(crate) fn born(hall: Arc<Hall>, settings: SimSettings) -> Mortal {
        let usual = Settings::default();
        let fetcher = if settings.has_hook { Fetcher::Discovery } else { usual.fetcher };
        Mortal::searching_by(Strategy::default(), Settings { fetcher, ..usual }, hall, settings)
    }

    pub(crate) fn searching_by(strategy: Strategy, rules: Settings, hall: Arc<Hall>, settings: SimSettings) -> Mortal {
        let mut mortal = Mortal {
            engine: Engine::new(rules, strategy, "mortal".into()),
            sim: Sim::new(Arc::clone(&hall), settings),
            disk: Vec::new(),
            kept_back: Vec::new(),
            on_the_way: VecDeque::new(),
            answers: BTreeMap::new(),
            memory: None,
            hall,
            strategy,
            rules,
            settings,
            now: Now::default(),
        };
        mortal.settle();
        mortal
    }

    /// Kills the program like `kill -9` and starts it again. The first `durable` pages on their way are already on
    /// the disk, although nobody was told.
    pub(crate) fn killed(mut self, durable: usize) -> Mortal {
        let durable = durable.min(self.on_the_way.len());
        for page in self.on_the_way.drain(..durable) {
            self.disk.extend(page.entries);
            self.kept_back = page.kept_back.map_or(self.kept_back, |kept_back| kept_back.answers);
        }
        let now = Now { since_start: Duration::ZERO, wall: self.now.wall };
        let sim = match self.memory {
            Some(memory) => Sim::remembering(Arc::clone(&self.hall), self.settings, memory),
            None => Sim::new(Arc::clone(&self.hall), self.settings),
        };
        let engine = Engine::recall(self.rules, "reborn".into(), self.recalled(), now);
        let mut reborn = Mortal { engine, sim, on_the_way: VecDeque::new(), answers: BTreeMap::new(), now, ..self };
        reborn.settle();
        reborn
    }

    /// Contents of the disk as a new start reads them.
    pub(crate) fn recalled(&self) -> Recalled {
        let mut state = PersistentState::first(self.strategy);
        self.disk.iter().for_each(|entry| state.apply(entry));
        let named = |entry: &&Entry| matches!(entry.fact, Fact::Command { id: Some(_), .. });
        let commands = self.disk.iter().filter(named).cloned().collect();
        Recalled { state, written: Seq(self.disk.len() as u64), commands, kept_back: self.kept_back.clone(), latest: Vec::new() }
    }

    pub(crate) fn give(&mut self, command: Command) -> Result<Ticket, Refused> {
        self.ask(Request::new(command, Issuer::operator(Door::LOCAL)))
    }

    pub(crate) fn ask(&mut self, request: Request) -> Result<Ticket, Refused> {
        let given = self.engine.handle_command(request, self.now);
        self.settle();
        given
    }

    /// Stores the oldest page on its way; false when there is none.
    pub(crate) fn keep_one(&mut self) -> bool {
        let Some(page) = self.on_the_way.pop_front() else { return false };
        let last = page.last();
        self.disk.extend(page.entries);
        assert_eq!(last, Seq(self.disk.len() as u64), "the journal has no gaps");
        self.engine.handle_event(Event::Recorded(last), self.now);
        if let Some(KeptBack { number, answers }) = page.kept_back {
            self.kept_back = answers;
            self.engine.handle_event(Event::KeptBack(number), self.now);
        }
        self.settle();
        true
    }

    pub(crate) fn note_refused(&mut self, issuer: Issuer, asked: Asked, refused: &Refused) {
        self.engine.note_refused(issuer, asked, refused, 1, self.now);
        self.settle();
        self.keep_all();
    }

    pub(crate) fn keep_all(&mut self) {
        while self.keep_one() {}
    }

    /// Advances to the next timed event; false when there is none.
    pub(crate) fn advance(&mut self) -> bool {
        let due = [self.sim.poll_timeout(), self.engine.poll_timeout()].into_iter().flatten().min();
        due.is_some_and(|due| {
            self.wait_until(due);
            true
        })
    }

    /// Advances the time by a minute.
    pub(crate) fn wait_a_minute(&mut self) {
        let end = self.now.since_start + Duration::from_secs(60);
        while [self.sim.poll_timeout(), self.engine.poll_timeout()].into_iter().flatten().min().is_some_and(|due| due <= end) {
            self.advance();
        }
        self.wait_until(end);
    }

    pub(crate) fn state(&mut self) -> Arc<Snapshot> {
        self.engine.snapshot()
    }

    pub(crate) fn body(&self) -> BodyPose {
        self.sim.pose_at(self.now)
    }

    fn wait_until(&mut self, since_start: Duration) {
        let since_start = since_start.max(self.now.since_start);
        let passed = i64::try_from((since_start - self.now.since_start).as_millis()).expect("a test is short");
        let wall = WallTime { unix_ms: self.now.wall.unix_ms + passed, ..self.now.wall };
        self.now = Now { since_start, wall };
        self.sim.handle_timeout(self.now);
        self.engine.handle_timeout(self.now);
        self.settle();
    }

    fn settle(&mut self) {
        loop {
            if let Some(memory) = self.sim.poll_memory() {
                assert!(memory.fits(&self.hall), "the next start would take it for damaged: {memory:?}");
                self.memory = Some(memory);
            }
            if let Some(effect) = self.engine.poll_effect() {
                self.perform(effect);
            } else if let Some((order, exposure)) = self.sim.take_exposure() {
                self.sim.handle_photo(order, exposure.develop(), self.now);
            } else if let Some(report) = self.sim.poll_event() {
                self.engine.handle_event(Event::Robot(RobotId::discovery(), report), self.now);
            } else {
                return;
            }
        }
    }

    fn perform(&mut self, effect: Effect) {
        match effect {
            Effect::Order(_, order) => self.sim.handle_order(order, self.now),
            Effect::Halt(_) => self.sim.handle_halt(self.now),
            Effect::Led(_, blinks) => self.sim.handle_led(blinks),
            Effect::Record(page) => self.on_the_way.push_back(page),
            Effect::Answer(ticket, answer) => drop(self.answers.insert(ticket, answer)),
        }
    }
}
