//! The engine: world and mission together, with the methods of the core. Commands and events go in, and effects come
//! out. A snapshot can be taken at any time. The engine has no clock and no I/O. `now` is an argument, and the caller
//! that polls the effects carries them out.
//!
//! ```text
//!   handle_command ─┐                      ┌─ acts ── world, holds, records
//!   handle_event  ──┼─► decide (the table) ┤
//!   handle_timeout ─┘                      └─ phase ─► motion: the next order, if the gate lets it through
//! ```

mod acts;
mod arms;
mod coalesced_entries;
mod decide;
mod exercise;
mod facts;
mod fetch_alone;
mod judges;
mod mission;
mod model;
mod motion;
mod obstacles;
mod on_record;
mod outbox;
mod past;
mod phases;
mod recall;
mod records;
mod refusals;
mod repeats;
mod reports;
mod retrieval;
mod robots;
mod simulated;
mod stops;
mod team;
mod view;
mod views;
mod watchdog;

#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::time::Duration;

use self::decide::Step;
pub use self::judges::tells_of_verdict;
pub use self::motion::Barred;
pub use self::past::{Past, way_behind};
pub use self::recall::{Recalled, RememberedLine};
pub use self::repeats::IDS;

use self::coalesced_entries::CoalescedEntries;
use self::exercise::Exercise;
use self::judges::Judges;
use self::mission::Mission;
use self::on_record::OnRecord;
use self::outbox::{Outbox, WaitingAnswer};
use self::refusals::Note;
use self::repeats::{Content, IdUse, Outcome, Repeats};
use self::stops::Stops;
use self::team::Ticked;
use self::view::Shown;
use self::watchdog::SensorWatchdog;
use super::command::{Accepted, Command, Request};
use super::effect::Effect;
use super::event::Event;
use super::mission::{Act, Input, InputContext};
use super::refused::Refused;
use super::robot::RobotId;
use super::search::plan::Planner;
use super::settings::Settings;
use super::state::PersistentState;
use super::state::fact::Fact;
use super::units::{Cell, Epoch, LuggageId, Now, Revision, Seq, Ticket};
use super::world::hall_map::HallMap;
use super::world::resource::Resource;
use crate::arm::Parcel;
use crate::command::Strategy;
use crate::engine::model::World;
use crate::engine::robots::Robots;
use crate::hall::HallId;
use crate::hold::{Hold, HoldReason};
use crate::snapshot::Snapshot;
use crate::snapshot::log::Tone;
use crate::snapshot::retrieval::TreesView;
use crate::snapshot::said::Said;

#[derive(Clone, Debug)]
pub struct Engine {
    settings: Settings,
    now: Now,
    state: PersistentState,
    world: World,
    mission: Mission,
    robots: Robots,
    planner: Planner,
    outbox: Outbox,
    watchdog: SensorWatchdog,
    repeats: Repeats,
    refusals: CoalescedEntries<Note>,
    stops: Stops,
    judges: Judges,
    exercise: Option<Exercise>,
    /// The epoch of the command that last released the robot.
    released: Option<Epoch>,
    on_record: OnRecord,
    /// The camera's latest answer to a search for a parcel. The answer stays here until the behaviour trees have read
    /// it.
    seen: Option<Option<Parcel>>,
    /// The behaviour trees of the pair, while the pair fetches.
    team: Option<Ticked>,
    /// The state of the trees after their last tick, for snapshots.
    trees: Arc<TreesView>,
    is_ending: bool,
    /// Total of all recorded clock changes since the program started, in milliseconds.
    clock_set_ms: i64,
    taken: Option<Arc<Snapshot>>,
}

impl Engine {
    /// Sets the name of this hall in its addresses, which the snapshots show.
    pub fn name_hall(&mut self, hall: HallId) {
        self.world.hall = Some(hall);
    }

    /// Returns an engine in which nothing has happened yet. The robot is at home, faces south and is idle. `run`
    /// names this run of the program.
    #[must_use]
    pub fn new(settings: Settings, strategy: Strategy, run: Arc<str>) -> Engine {
        Engine {
            settings,
            now: Now::default(),
            state: PersistentState::first(strategy).after_restart(),
            world: World::new(run, &settings),
            mission: Mission::default(),
            robots: Robots::of(RobotId::discovery()),
            planner: Planner::of(&HallMap::new(Cell::HOME, Revision(1))),
            outbox: Outbox::default(),
            watchdog: SensorWatchdog::default(),
            repeats: Repeats::default(),
            refusals: CoalescedEntries::new(refusals::LIMITS),
            stops: Stops::default(),
            judges: Judges::default(),
            exercise: None,
            released: None,
            on_record: OnRecord::first(strategy),
            seen: None,
            team: None,
            trees: Arc::default(),
            is_ending: false,
            clock_set_ms: 0,
            taken: None,
        }
    }

    /// Handles a command. The answer to an accepted command is an `Effect::Answer` with the returned ticket. It is
    /// sent once everything that must be recorded first is stored.
    ///
    /// # Errors
    /// The refusal and its reason. A refused command is written to the log and the journal, and changes nothing else.
    /// There are exceptions: a danger, a reading or TOO HIGH takes effect even if the store cannot record it.
    pub fn handle_command(&mut self, request: Request, now: Now) -> Result<Ticket, Refused> {
        self.handle_many(request, 1, now)
    }

    /// Handles `count` stops of one sender at once. `last` is the last one of these stops. All of them get one
    /// answer.
    ///
    /// # Errors
    /// The same type as for any command, but a stop is never refused.
    pub fn handle_stops(&mut self, last: Request, count: u64, now: Now) -> Result<Ticket, Refused> {
        self.handle_many(last, count, now)
    }

    fn handle_many(&mut self, request: Request, count: u64, now: Now) -> Result<Ticket, Refused> {
        self.begin(now);
        if let Some(repeated) = self.repeated(&request) {
            return repeated;
        }
        let (input, mut context) = InputContext::of(&request.command, &request.issuer, self.pending());
        // A sender may name an epoch that is higher than the present one. The epoch at the command's arrival is then
        // used, so that a later stop still makes the command outdated.
        context.epoch = [request.epoch, request.arrived].into_iter().flatten().min();
        context.id.clone_from(&request.id);
        let outcome = match self.refuse_outdated(input, &request, context.epoch) {
            Ok(()) => self.decide(input, &context),
            Err(outdated) => Err((outdated, &[][..])),
        };
        let is_kept_back = outcome.as_ref().is_ok_and(|step| step.acts == [Act::KeepBack]);
        if !self.is_secret(&context, is_kept_back, outcome.is_err()) {
            self.write_command(&request, &context, outcome.as_ref().err().map(|(refused, _)| refused));
        }
        let answer = match outcome {
            Ok(step) => Ok(self.carry_out(&request, count, input, step, &context)),
            Err((refused, acts)) => {
                self.perform_all(acts, &context);
                self.remember(&request, Outcome::Answered(Err(refused.clone())));
                Err(refused)
            }
        };
        self.go_on();
        answer
    }

    /// Begins the journal, when the program starts for the first time.
    pub fn open_journal(&mut self, now: Now) {
        self.begin(now);
        self.note_start();
        self.record(Fact::Strategy(self.state.strategy));
    }

    /// Writes a warning about this start into the log, such as a damaged file (safety R5) or a setting without
    /// effect.
    pub fn note(&mut self, words: &str, now: Now) {
        self.begin(now);
        self.world.write(now.wall, Tone::Warning, Said::Words(words.to_owned()));
    }

    /// Begins to watch a sensor. The sensor must report at least once every `patience`. Until its first report, it
    /// counts as silent.
    pub fn watch_sensor(&mut self, sensor: Arc<str>, patience: Duration, now: Now) {
        self.begin(now);
        self.watchdog.begin(Arc::clone(&sensor), patience);
        self.feed(Input::SensorSilent, &InputContext { why: Some(HoldReason::Unheard(sensor)), ..InputContext::default() });
    }

    /// Adds a robot that does not search. The new robot counts as standing at home until it reports another place.
    pub fn add_robot(&mut self, robot: RobotId, now: Now) {
        self.begin(now);
        self.robots.add(robot, self.state.holds.contains(Hold::AwaitingStart));
        self.world.touch(Resource::Robot);
    }

    /// Holds the robots at once, because a halt was raised outside the queue of commands (safety S1). The command
    /// with the name of its sender follows later.
    pub fn handle_halt(&mut self, epoch: Epoch, now: Now) {
        self.begin(now);
        if epoch > self.state.epoch {
            self.feed(Input::Stop, &InputContext { epoch: Some(epoch), ..InputContext::default() });
        }
    }

    pub fn handle_event(&mut self, event: Event, now: Now) {
        self.begin(now);
        match event {
            Event::Robot(robot, report) => self.report(&robot, report),
            Event::Recorded(seq) => {
                self.wake_team();
                self.kept(seq);
            }
            Event::StoreFailed(words) => {
                self.world.store_failure = Some(words.clone());
                self.show_nothing_lost();
                self.feed(Input::StoreFailed, &InputContext { why: Some(HoldReason::Words(words)), ..InputContext::default() });
                self.withdraw_unkept();
            }
            Event::KeptBack(number) => self.judgements_kept(number),
            Event::StoreReason(words) => {
                self.world.store_failure = Some(words);
                self.world.touch(Resource::Mission);
            }
            Event::StoreRestored => {
                self.world.store_failure = None;
                self.feed(Input::StoreRestored, &InputContext::default());
                self.record_anew();
            }
        }
        self.go_on();
    }

    /// Handles everything that is due. Must be called at the time that `poll_timeout` returns.
    pub fn handle_timeout(&mut self, now: Now) {
        self.begin(now);
        let (refusals, stops) = (self.refusals.fall_due(now.since_start), self.stops.records.fall_due(now.since_start));
        self.write_refusals(refusals);
        self.write_stops(stops);
        self.outbox.record_overdue(now);
        while let Some((_, source)) = self.world.thermometer.due().filter(|(due, _)| *due <= now.since_start) {
            self.fall_silent(&source);
        }
        while let Some(sensor) = self.watchdog.falls_silent(now.since_start) {
            self.fall_silent(&sensor);
            self.feed(Input::SensorSilent, &InputContext { why: Some(HoldReason::Silent(sensor)), ..InputContext::default() });
        }
        while let Some(robot) = self.robots.overdue(now.since_start) {
            self.order_unanswered(&robot);
        }
        self.answer_overdue_stops();
        self.go_on();
    }

    /// Returns the next effect: first the halts, then the pages for the store, then all others, oldest first.
    pub fn poll_effect(&mut self) -> Option<Effect> {
        // Luggage and verdicts that are not stored yet are not in the state. A record of the state must wait for
        // them: after a restart from this record they would be missing.
        let in_flight = !self.mission.recording.is_empty() || !self.mission.deciding.is_empty();
        if self.outbox.is_to_sum_up(self.state.size_in_entries()) && !in_flight {
            self.record_state();
        }
        self.outbox.poll()
    }

    /// Returns the number of the last entry that was sent to the store. Once this entry is stored, a refusal that was
    /// just returned is stored too.
    #[must_use]
    pub fn written(&self) -> Seq {
        self.outbox.written()
    }

    /// Returns when `handle_timeout` must be called, as time since the start of the program.
    #[must_use]
    pub fn poll_timeout(&self) -> Option<Duration> {
        let records = [self.stops.due(), self.refusals.due(), self.outbox.due_record()];
        let silence = self.world.thermometer.due().map(|(due, _)| due);
        [self.robots.due(), self.watchdog.due(), silence, self.tick_due()].into_iter().chain(records).flatten().min()
    }

    /// Returns everything that can be shown at this moment. The returned `Arc` stays the same until something
    /// changes.
    pub fn snapshot(&mut self) -> Arc<Snapshot> {
        self.look();
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

    /// Marks a resource as changed if its view depends on another resource that has changed. For example, a refusal
    /// depends on an alarm, and the progress depends on the map.
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
        self.look();
    }

    /// Carries out an accepted command, and answers it once all its consequences are stored. The answer to a stop
    /// waits for no record. While the store cannot write, every answer is sent at once. The table then accepts only
    /// commands that are recorded already, or need no record.
    fn carry_out(&mut self, request: &Request, count: u64, input: Input, step: Step, context: &InputContext) -> Ticket {
        // The stop already took effect when it was raised, ahead of the queue. If a command has released the robot
        // since then, this stop must not halt it again.
        let is_over = |raised: Epoch| raised <= self.state.epoch && self.released.is_some_and(|released| released >= raised);
        if input != Input::Stop || !context.epoch.is_some_and(is_over) {
            self.apply(step, context);
        }
        if input == Input::Stop {
            self.record_stop(request, count);
        }
        let ticket = self.outbox.next_ticket();
        self.remember(request, Outcome::Open(ticket));
        if step.acts == [Act::KeepBack] {
            self.answer_when_kept_back(ticket, context);
            return ticket;
        }
        let waits = !self.state.holds.contains(Hold::Store) && !self.outbox.is_kept();
        if input == Input::Stop {
            self.answer_when_standing(ticket);
        } else if waits {
            let seq = self.outbox.written();
            self.outbox.wait(WaitingAnswer { ticket, seq, luggage: context.luggage, verdict: context.verdict, decided: false });
        } else {
            self.answer(ticket, context.luggage);
        }
        ticket
    }

    fn answer(&mut self, ticket: Ticket, luggage: Option<LuggageId>) {
        let accepted = self.accepted(luggage);
        self.send_answer(ticket, Ok(accepted));
    }

    fn accepted(&self, luggage: Option<LuggageId>) -> Accepted {
        Accepted { revision: self.world.revision(), epoch: self.state.epoch, luggage, is_kept_back: false }
    }

    pub(super) fn send_answer(&mut self, ticket: Ticket, answer: Result<Accepted, Refused>) {
        self.repeats.answer(ticket, &answer);
        self.outbox.send(Effect::Answer(ticket, answer));
    }

    /// Returns the answer to an earlier command with the same id; `None` if there was none.
    fn repeated(&mut self, request: &Request) -> Option<Result<Ticket, Refused>> {
        let id = request.id.as_ref().filter(|_| request.command != Command::Stop)?;
        let outcome = match self.repeats.look_up(&request.issuer.key(), id, &Content::of(request)) {
            IdUse::New => return None,
            IdUse::Other => {
                let refused = Refused::OtherContent(id.clone());
                let (_, context) = InputContext::of(&request.command, &request.issuer, self.pending());
                // The earlier answer may be one that is kept back, and a refusal would tell of it.
                if !self.is_about_two(context.luggage) {
                    self.write_command(request, &context, Some(&refused));
                }
                return Some(Err(refused));
            }
            IdUse::Same(outcome) => outcome.clone(),
        };
        if let Outcome::Answered(Err(refused)) = outcome {
            return Some(Err(refused));
        }
        if let (Outcome::Before(Some(luggage)), Command::Verdict { verdict, .. }) = (&outcome, &request.command)
            && let Some(stands) = self.verdict_kept(*luggage).filter(|stands| stands != verdict)
        {
            // Another verdict replaced this verdict before this verdict was stored.
            return Some(Err(Refused::Decided { luggage: *luggage, verdict: stands }));
        }
        let ticket = self.outbox.next_ticket();
        match outcome {
            Outcome::Answered(answer) => self.outbox.send(Effect::Answer(ticket, answer)),
            Outcome::Before(luggage) => self.answer(ticket, luggage),
            Outcome::Open(open) => self.outbox.follow(open, ticket),
        }
        Some(Ok(ticket))
    }

    fn remember(&mut self, request: &Request, outcome: Outcome) {
        if let Some(id) = request.id.as_ref().filter(|_| request.command != Command::Stop) {
            self.repeats.note(&request.issuer, id, Content::of(request), outcome);
        }
    }

    /// Returns the piece that a verdict without a number means: the piece in front of the robot, otherwise the only
    /// pending piece.
    fn pending(&self) -> Option<LuggageId> {
        let mut pending = self.state.luggage.pending().map(|luggage| luggage.id);
        let first = pending.next();
        self.asked().or(first.filter(|_| pending.next().is_none()))
    }
}
