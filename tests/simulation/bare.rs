//! An engine without a simulator: the test plays the robot and the store, and decides when and how they answer.

use std::sync::Arc;
use std::time::Duration;

use hallsweep_core::command::{Accepted, Command, Door, Issuer, LuggageRef, Move, Request, Strategy, Verdict};
use hallsweep_core::effect::{Action, Effect, Order};
use hallsweep_core::engine::Engine;
use hallsweep_core::event::{Capabilities, Event, Obstacle, Photo, RobotEvent};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::{Parts, RobotId};
use hallsweep_core::settings::Settings;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{Cell, Epoch, LuggageId, Now, Piece, Seq, Ticket, WallTime};

use crate::shown::Record;

/// The core and its output.
pub(crate) struct Bare {
    pub(crate) engine: Engine,
    pub(crate) seconds: u64,
    /// Effects in order, since the test last took them.
    pub(crate) effects: Vec<Effect>,
    pub(crate) answers: Vec<(Ticket, Result<Accepted, Refused>)>,
    order: Option<Order>,
    /// Stored entries since the last start.
    pub(crate) record: Record,
    on_the_way: Vec<Entry>,
    pub(crate) written: Seq,
    /// Whether records are stored at once.
    pub(crate) keeps: bool,
}

impl Bare {
    /// Robot whose link is not up yet.
    pub(crate) fn unlinked() -> Bare {
        // The tests expect the cells and moves of `Snail`, whose way does not depend on settings.
        Bare::searching_by(Strategy::Snail, Settings::default())
    }

    /// Robot with this strategy whose link is not up yet.
    pub(crate) fn searching_by(strategy: Strategy, settings: Settings) -> Bare {
        Bare {
            engine: Engine::new(settings, strategy, "bare".into()),
            seconds: 0,
            effects: Vec::new(),
            answers: Vec::new(),
            order: None,
            record: Record::of(strategy),
            on_the_way: Vec::new(),
            written: Seq(0),
            keeps: true,
        }
    }

    /// Linked robot at home.
    pub(crate) fn linked() -> Bare {
        let mut bare = Bare::unlinked();
        bare.link_up();
        bare
    }

    /// Robot at (0, 1) before a bag at (1, 1) whose verdict is pending.
    pub(crate) fn at_a_bag() -> Bare {
        let mut bare = Bare::in_front_of(Obstacle::Luggage(Piece(1)));
        bare.photo();
        assert_eq!(bare.state().mission.inspected, Some(LuggageId(1)));
        bare
    }

    /// Robot at (0, 1) that is about to photograph the obstacle at (1, 1).
    pub(crate) fn in_front_of(obstacle: Obstacle) -> Bare {
        let mut bare = Bare::linked();
        bare.give(Command::Start).expect("an idle robot starts");
        bare.done();
        bare.until_forward();
        bare.meets(obstacle);
        bare.done();
        bare
    }

    /// Robot at home again after `at_a_bag`, with the verdict still pending.
    pub(crate) fn at_home_with_a_pending_bag() -> Bare {
        let mut bare = Bare::at_a_bag();
        bare.give(Command::BackHome).expect("an inspecting robot goes home");
        bare.drive_on();
        assert_eq!(bare.phase(), PhaseName::AtHome);
        bare
    }

    pub(crate) fn link_up(&mut self) {
        let second = Duration::from_secs(1);
        let can = Capabilities {
            step: second,
            turn: second,
            photo: second,
            arm: Duration::ZERO,
            nudges: false,
            parts: Parts::ROUND_ROBOT,
        };
        self.robot(RobotEvent::LinkUp(can));
    }

    pub(crate) fn event(&mut self, event: Event) {
        match event {
            Event::StoreFailed(_) => {
                self.on_the_way.clear();
                self.record.is_whole = false;
            }
            Event::Recorded(_) => self.record.keep(&std::mem::take(&mut self.on_the_way)),
            _ => {}
        }
        self.engine.handle_event(event, self.now());
        self.drain();
    }

    /// Configures a sensor that sends nothing.
    pub(crate) fn watch_silent(&mut self, sensor: &str) {
        self.engine.watch_sensor(sensor.into(), Duration::from_secs(3600), self.now());
        self.drain();
    }

    /// Raises a STOP: the halt arrives before the queue of commands, and the sender's command follows. Returns the
    /// epoch of the stop.
    pub(crate) fn raise(&mut self) -> Epoch {
        let raised = self.state().mission.epoch.next();
        self.engine.handle_halt(raised, self.now());
        self.drain();
        raised
    }

    pub(crate) fn robot(&mut self, report: RobotEvent) {
        self.event(Event::Robot(RobotId::discovery(), report));
    }

    pub(crate) fn give(&mut self, command: Command) -> Result<Ticket, Refused> {
        self.ask(Request::new(command, Issuer::operator(Door::LOCAL)))
    }

    pub(crate) fn ask(&mut self, request: Request) -> Result<Ticket, Refused> {
        let result = self.engine.handle_command(request, self.now());
        self.drain();
        result
    }

    pub(crate) fn verdict(&mut self, verdict: Verdict) -> Result<Ticket, Refused> {
        self.give(Command::Verdict { luggage: LuggageRef::Id(LuggageId(1)), verdict, note: None, hot: Default::default() })
    }

    /// Answer to an accepted command, if there is one yet.
    pub(crate) fn answer(&self, ticket: Ticket) -> Option<Result<Accepted, Refused>> {
        self.answers.iter().find(|(to, _)| *to == ticket).map(|(_, answer)| answer.clone())
    }

    pub(crate) fn order(&self) -> Option<Action> {
        self.order.map(|order| order.action)
    }

    /// Completes the current order.
    pub(crate) fn done(&mut self) {
        let order = self.order.take().expect("an order is under way");
        self.robot(RobotEvent::Done(order.id));
    }

    /// Completes orders until the next one is a step forward.
    pub(crate) fn until_forward(&mut self) {
        while self.order() != Some(Action::Move(Move::Forward)) {
            self.done();
        }
    }

    /// Blocks the current order with an obstacle.
    pub(crate) fn meets(&mut self, obstacle: Obstacle) {
        let order = self.order.take().expect("an order is under way");
        self.robot(RobotEvent::Blocked(order.id, obstacle));
    }

    /// Halts in the middle of the current order.
    pub(crate) fn halted(&mut self) {
        let order = self.order.take().expect("an order is under way");
        self.robot(RobotEvent::Halted(order.id, true));
    }

    /// Completes the current photo.
    pub(crate) fn photo(&mut self) {
        let order = self.order.take().expect("a photo is under way");
        self.robot(RobotEvent::Photo(order.id, Photo { bytes: Arc::from([1]), media_type: "image/png" }));
    }

    /// Makes the current photo fail.
    pub(crate) fn photo_fails(&mut self) {
        let order = self.order.take().expect("a photo is under way");
        self.robot(RobotEvent::PhotoFailed(order.id, "dark".to_owned()));
    }

    /// Completes every order until no more are given.
    pub(crate) fn drive_on(&mut self) {
        for _ in 0..1000 {
            if self.order.is_none() {
                return;
            }
            self.done();
        }
        panic!("it drives for ever; the phase is {:?}", self.phase());
    }

    /// Confirms everything that was written.
    pub(crate) fn keep(&mut self) {
        self.event(Event::Recorded(self.written));
    }

    /// Confirms everything, including what is written because of the confirmation.
    pub(crate) fn keep_all(&mut self) {
        for _ in 0..3 {
            self.keep();
        }
    }

    /// Advances the time until a stop need not wait longer for the robot, or the current order counts as unanswered.
    pub(crate) fn wait_in_vain(&mut self) {
        let due = self.engine.poll_timeout().expect("something is due");
        self.seconds = due.as_secs() + 1;
        self.engine.handle_timeout(self.now());
        self.drain();
    }

    pub(crate) fn state(&mut self) -> Arc<Snapshot> {
        self.engine.snapshot()
    }

    pub(crate) fn phase(&mut self) -> PhaseName {
        self.state().mission.phase
    }

    pub(crate) fn holds(&mut self) -> Vec<Hold> {
        self.state().mission.holds.clone()
    }

    pub(crate) fn cell(&mut self) -> Cell {
        self.state().robot.pose.cell
    }

    pub(crate) fn takes_back(&mut self) -> Option<Order> {
        self.order.take()
    }

    fn now(&self) -> Now {
        Now { since_start: Duration::from_secs(self.seconds), wall: WallTime::default() }
    }

    fn drain(&mut self) {
        while let Some(effect) = self.engine.poll_effect() {
            match &effect {
                Effect::Order(_, order) => self.order = Some(*order),
                Effect::Record(page) => {
                    self.written = page.last();
                    self.on_the_way.extend(page.entries.iter().cloned());
                    if self.keeps {
                        self.record.keep(&std::mem::take(&mut self.on_the_way));
                        self.engine.handle_event(Event::Recorded(page.last()), self.now());
                    }
                }
                Effect::Answer(ticket, answer) => self.answers.push((*ticket, answer.clone())),
                Effect::Halt(_) | Effect::Led(..) => {}
            }
            self.effects.push(effect);
        }
    }
}

/// Whether an effect records such a fact.
pub(crate) fn records(effect: &Effect, fact: impl Fn(&Fact) -> bool) -> bool {
    matches!(effect, Effect::Record(page) if page.entries.iter().any(|entry| fact(&entry.fact)))
}
