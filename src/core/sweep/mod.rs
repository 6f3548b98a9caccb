//! The sweep: world and mission together, behind the verbs of the core. Commands and events go in, effects come out, and a
//! snapshot can be taken at any time. No clock, no I/O: `now` is an argument, and whoever polls the effects performs them.
//!
//! ```text
//!   handle_command ─┐                      ┌─ acts ── world, holds, records
//!   handle_event  ──┼─► decide (the table) ┤
//!   handle_timeout ─┘                      └─ phase ─► motion: the next order, if the gate lets it through
//! ```

mod acts;
mod decide;
mod helm;
mod motion;
mod outbox;
mod phases;
mod records;
mod reports;
mod view;

#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::time::Duration;

use self::decide::Step;
use self::helm::Helm;
use self::outbox::{Outbox, Waiting};
use self::view::Shown;
use super::command::{Accepted, Refused, Request};
use super::effect::{Effect, Fact};
use super::event::{Event, RobotId};
use super::explore::Strategy;
use super::explore::plan::Planner;
use super::mission::{Input, Matter, Mission};
use super::settings::Settings;
use super::units::{Epoch, LuggageId, Now, Ticket};
use super::world::log::Tone;
use super::world::model::World;
use super::world::resource::Resource;
use super::world::snapshot::Snapshot;

/// The whole core.
#[derive(Clone, Debug)]
pub struct Sweep {
    settings: Settings,
    now: Now,
    world: World,
    mission: Mission,
    helm: Helm,
    planner: Planner,
    outbox: Outbox,
    taken: Option<Arc<Snapshot>>,
}

impl Sweep {
    /// A sweep in which nothing has happened yet: the robot at home, facing south, idle. `run` names this run of the program.
    #[must_use]
    pub fn new(settings: Settings, strategy: Strategy, run: Arc<str>) -> Sweep {
        Sweep {
            settings,
            now: Now::default(),
            world: World::new(run, &settings),
            mission: Mission::new(strategy),
            helm: Helm::default(),
            planner: Planner::default(),
            outbox: Outbox::default(),
            taken: None,
        }
    }

    /// Takes a command. An accepted one is answered by `Effect::Answer` with this ticket, as soon as what must be on record first
    /// is there.
    ///
    /// # Errors
    /// The refusal and its reason; then nothing has changed but the log.
    pub fn handle_command(&mut self, request: Request, now: Now) -> Result<Ticket, Refused> {
        self.begin(now);
        let (input, mut matter) = Matter::of(&request.command, &request.issuer, self.pending());
        matter.epoch = request.epoch;
        let outcome = match self.refuse_outdated(input, request.epoch) {
            Ok(()) => self.decide(input, &matter),
            Err(outdated) => Err((outdated, &[][..])),
        };
        self.write_command(input, &matter, outcome.as_ref().err().map(|(refused, _)| refused));
        let answer = match outcome {
            Ok(step) => Ok(self.carry_out(input, step, &matter)),
            Err((refused, acts)) => {
                self.perform_all(acts, &matter);
                Err(refused)
            }
        };
        self.pump();
        answer
    }

    /// A halt was raised outside the queue of commands (safety S1): hold at once; the command with its sender's name follows.
    pub fn handle_halt(&mut self, epoch: Epoch, now: Now) {
        self.begin(now);
        if epoch > self.mission.epoch {
            self.feed(Input::Stop, &Matter { epoch: Some(epoch), ..Matter::default() });
        }
    }

    /// Takes an event.
    pub fn handle_event(&mut self, event: Event, now: Now) {
        self.begin(now);
        match event {
            Event::Robot(RobotId::Discovery, report) => self.report(report),
            Event::Sensor(source, celsius) => {
                if self.world.thermometer.hear(&source) {
                    self.feed(Input::SensorBack, &Matter::default());
                }
                self.read_temperature(&source, celsius);
            }
            Event::SensorSilent(source) => {
                self.world.thermometer.miss(&source);
                self.feed(Input::SensorSilent, &Matter { words: Some(source.to_string()), ..Matter::default() });
            }
            Event::Recorded(seq) => self.kept(seq),
            Event::StoreFailed(words) => {
                self.feed(Input::StoreFailed, &Matter { words: Some(words), ..Matter::default() });
                self.withdraw_unkept();
            }
            Event::StoreRestored => {
                self.feed(Input::StoreRestored, &Matter::default());
                self.record_anew();
            }
        }
        self.pump();
    }

    /// Time has passed; call it at `poll_timeout`.
    pub fn handle_timeout(&mut self, now: Now) {
        self.begin(now);
        if self.helm.due().is_some_and(|due| due <= now.since_start) {
            self.order_unanswered();
            self.pump();
        }
    }

    /// The next thing to be done outside, oldest first.
    pub fn poll_effect(&mut self) -> Option<Effect> {
        self.outbox.poll()
    }

    /// When `handle_timeout` is to be called, counted from the start.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Duration> {
        self.helm.due()
    }

    /// Everything that can be seen, at this moment; the same `Arc` until something changes.
    pub fn snapshot(&mut self) -> Arc<Snapshot> {
        let current = self.taken.as_ref().filter(|taken| taken.revision == self.world.revision());
        if let Some(taken) = current {
            return Arc::clone(taken);
        }
        let shown = self.shown();
        self.touch_derived(&shown);
        let snapshot = Arc::new(self.view(shown));
        self.taken = Some(Arc::clone(&snapshot));
        snapshot
    }

    /// What is shown of a resource may follow from another (a refusal from an alarm, the progress from the map): then it has
    /// changed as well.
    fn touch_derived(&mut self, shown: &Shown) {
        let Some(before) = self.taken.clone() else { return };
        for (resource, differs) in [
            (Resource::Mission, before.mission != shown.mission),
            (Resource::Robot, before.robot != shown.robot),
            (Resource::Temperature, before.temperature != shown.temperature),
        ] {
            if differs && before.revision_of(resource) == self.world.revisions()[resource as usize] {
                self.world.touch(resource);
            }
        }
    }

    fn begin(&mut self, now: Now) {
        self.now = now;
        self.world.turn_page();
    }

    /// Carries out an accepted command; answers at once, or once what it put on record is kept. A stop never waits.
    fn carry_out(&mut self, input: Input, step: Step, matter: &Matter) -> Ticket {
        let barrier = self.outbox.barrier();
        self.apply(step, matter);
        let ticket = self.outbox.next_ticket();
        let recorded = Some(self.outbox.barrier()).filter(|seq| *seq > barrier && input != Input::Stop);
        let in_flight = matter.luggage.filter(|_| matter.verdict.is_some()).and_then(|id| self.mission.deciding(id));
        match recorded.or(in_flight.map(|(_, seq)| seq)) {
            Some(seq) => self.outbox.wait(Waiting { ticket, seq, luggage: matter.luggage, verdict: matter.verdict }),
            None => self.answer(ticket, matter.luggage),
        }
        ticket
    }

    fn answer(&mut self, ticket: Ticket, luggage: Option<LuggageId>) {
        let revision = self.world.revision();
        self.outbox.send(Effect::Answer(ticket, Ok(Accepted { revision, luggage })));
    }

    fn write_command(&mut self, input: Input, matter: &Matter, refused: Option<&Refused>) {
        let Some(issuer) = matter.issuer.clone() else { return };
        let command = format!("{}{}", input.in_words(), matter.in_words());
        let (tone, text) = match refused {
            None => (Tone::Info, format!("{command}, by {} ({})", issuer.who, issuer.door.name())),
            Some(refused) => (Tone::Warning, format!("{command} refused ({}): {refused}", issuer.door.name())),
        };
        self.world.write(self.now.wall, tone, text);
        let fact = Fact::Command { door: issuer.door, who: issuer.who, command, refused: refused.map(Refused::code) };
        self.outbox.note(self.now.wall, fact);
    }

    /// The piece that a bare word means: the one in front of the robot, else the only one that is pending.
    fn pending(&self) -> Option<LuggageId> {
        let mut pending = self.world.luggage.values().filter(|luggage| luggage.is_pending()).map(|luggage| luggage.id);
        let first = pending.next();
        let inspected = self.inspected().filter(|id| self.world.luggage.get(id).is_some_and(|luggage| luggage.is_pending()));
        inspected.or(first.filter(|_| pending.next().is_none()))
    }
}
