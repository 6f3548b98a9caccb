//! The end of the program, and the engine after a restart. After a restart, the engine has its earlier state, and
//! nothing moves before START. The engine completes everything that a kill of the program has interrupted (safety R1,
//! R2). `crate::state` derives the state from the journal.

use std::sync::Arc;

use super::Engine;
use super::on_record::OnRecord;
use super::outbox::Outbox;
use crate::effect::Effect;
use crate::mission::{Input, InputContext};
use crate::settings::Settings;
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::fact::{Entry, Fact};
use crate::state::{Conditions, PersistentState, Phase, Venue};
use crate::units::{LuggageId, Now, Pose, Seq, WallTime};
use crate::world::alarm::{Alarm, AlarmCause};
use crate::world::hall_map::Mark;
use crate::world::luggage::{Judgement, Luggage};
use crate::world::resource::Resource;

/// Smallest change of the wall clock that is recorded, in milliseconds. A leap second and the machine's continuous
/// corrections are smaller.
const CLOCK_SET_MS: i64 = 2000;

#[derive(Clone, Debug, PartialEq)]
pub struct Recalled {
    pub state: PersistentState,
    pub written: Seq,
    /// The latest commands that carried an id, oldest first.
    pub commands: Vec<Entry>,
    /// The answers of judges that were kept back.
    pub kept_back: Vec<Judgement>,
    /// The latest actions of people and the latest pieces found, oldest first.
    pub latest: Vec<RememberedLine>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RememberedLine {
    pub wall: WallTime,
    pub tone: Tone,
    pub said: Said,
}

impl Engine {
    /// Returns the engine after a restart. Nothing moves until a START (safety R1).
    #[must_use]
    pub fn recall(settings: Settings, run: Arc<str>, recalled: Recalled, now: Now) -> Engine {
        let Recalled { state, written, commands, kept_back, latest } = recalled;
        let told = latest.last().map_or(i64::MIN, |line| line.wall.unix_ms);
        let mut engine = Engine::new(settings, state.strategy, run);
        engine.outbox = Outbox::after(written);
        engine.repeats.recall(&commands);
        kept_back.iter().for_each(|judgement| engine.repeats.recall_judgement(judgement));
        engine.begin(now);
        for RememberedLine { wall, tone, said } in latest {
            engine.world.log.put(wall, tone, said);
        }
        engine.take_up(state);
        engine.on_record = OnRecord::of(engine.mission_as_it_is());
        // This notices a clock that was set back while the program was off. It cannot notice a clock that was set
        // forward.
        let back_ms = now.wall.unix_ms.saturating_sub(told);
        if back_ms <= -CLOCK_SET_MS {
            engine.record(Fact::ClockSet(back_ms));
        }
        engine.note_start();
        engine.recall_judgements(kept_back);
        engine.world.write(now.wall, Tone::Info, Said::StartedAgain);
        engine.feed(Input::Restarted, &InputContext::default());
        engine.finish();
        engine.outbox.sum_up();
        engine.pump();
        engine
    }

    /// Takes the total of all changes of the machine's clock since the start of the program, in milliseconds. A
    /// change is recorded before anything that happened at the new time.
    pub fn note_clock(&mut self, set_ms: i64, now: Now) {
        let by_ms = set_ms.saturating_sub(self.clock_set_ms);
        if by_ms.saturating_abs() < CLOCK_SET_MS {
            return;
        }
        self.clock_set_ms = set_ms;
        self.begin(now);
        // Shown times are shifted, so that their age stays the same.
        self.world.thermometer.set_clock(by_ms);
        for id in self.robots.ids() {
            let Some(robot) = self.robots.get_mut(&id) else { continue };
            robot.unreached_since = robot.unreached_since.map(|since| since.set_by(by_ms));
        }
        self.world.touch(Resource::Temperature);
        self.world.touch(Resource::Robot);
        let fact = Fact::ClockSet(by_ms);
        self.world.write(now.wall, Tone::Warning, Said::fact(&fact));
        self.record(fact);
    }

    /// Handles the end of the program. `by` names the signal. The robot halts and gets no further order. The mission
    /// stays as it is. After the next start, it waits for START (safety R1).
    pub fn handle_end(&mut self, by: &str, now: Now) {
        self.begin(now);
        self.is_ending = true;
        self.send_halt();
        self.world.write(now.wall, Tone::Warning, Said::Ended(by.to_owned()));
        self.record(Fact::ProgramEnded(by.to_owned()));
    }

    /// Records the stops and refusals that still wait for a shared entry. This must be the last call.
    pub fn record_rest(&mut self, now: Now) {
        self.begin(now);
        let (refusals, stops) = (self.refusals.rest(now.since_start), self.stops.records.rest(now.since_start));
        self.write_refusals(refusals);
        self.write_stops(stops);
    }

    pub(super) fn note_start(&mut self) {
        self.record(Fact::ProgramStarted(env!("CARGO_PKG_VERSION").to_owned()));
    }

    /// Sets the hall in which the robots are. A change of the hall or of the threshold is recorded.
    pub fn note_venue(&mut self, venue: Venue, now: Now) {
        self.begin(now);
        self.record_conditions(venue);
    }

    pub(super) fn record_conditions(&mut self, venue: Venue) {
        let conditions = Conditions { venue, threshold: self.settings.threshold, rules: self.settings.rules };
        if self.state.conditions.as_ref() != Some(&conditions) {
            self.record(Fact::Conditions(conditions));
            self.draw_areas();
        }
    }

    /// Archives the mission of the old hall, because the robot was put down at home in another hall. Must not be
    /// called while a mission is under way in the old hall.
    pub fn put_down_elsewhere(&mut self, now: Now) {
        self.begin(now);
        self.put_down();
    }

    pub(super) fn put_down(&mut self) {
        self.archive();
        self.robots.searching_mut().off_centre = false;
        self.record(Fact::Pose(Pose::START));
        self.empty_map();
        self.note_phase(Phase::Idle);
        self.world.write(self.now.wall, Tone::Info, Said::PutDown);
    }

    #[must_use]
    pub fn persistent_state(&self) -> PersistentState {
        self.state.clone()
    }

    fn take_up(&mut self, state: PersistentState) {
        // The exact place of a robot that was moving is unknown until it reports or senses where it stands.
        self.robots.searching_mut().off_centre = was_moving(&state.phase);
        if state.led_blinking {
            self.outbox.send(Effect::Led(self.robots.searching_id().clone(), true));
        }
        self.state = state.after_restart();
        self.draw_areas();
        self.recall_team();
        let cell = self.state.pose.cell;
        // A robot outside the entrance stands in no cell, so no cell is marked. A parcel may now lie at home.
        if self.steps_outside(self.robots.searching_id()) == 0 && self.state.map.at(cell) != Mark::Visited {
            self.mark(cell, Mark::Visited);
        }
        if let Some(celsius) = self.state.reading {
            self.world.thermometer.remember(celsius, self.now);
            self.judge_heat(celsius);
        }
    }

    /// Carries out the consequences of stored records. The program may have been killed between a record and its
    /// consequences.
    fn finish(&mut self) {
        let about = |luggage: &Luggage| InputContext { luggage: Some(luggage.id), ..InputContext::default() };
        for luggage in self.state.luggage.iter().map(Arc::clone).collect::<Vec<_>>() {
            if self.state.map.at(luggage.cell) == Mark::NotInspected {
                self.feed(Input::LuggageRecorded, &about(&luggage));
            }
            if luggage.is_dangerous() && !self.is_alarmed_about(luggage.id) {
                self.feed(Input::DangerRecorded, &about(&luggage));
            } else if !luggage.is_pending() && self.inspected() == Some(luggage.id) {
                self.feed(Input::SafeRecorded, &about(&luggage));
            }
        }
        self.end_alarm_hold();
    }

    /// Whether the consequences of a danger are on record. The alarm is recorded together with them.
    fn is_alarmed_about(&self, luggage: LuggageId) -> bool {
        let of_danger = |alarm: &Alarm| !matches!(alarm.cause, AlarmCause::Unrecorded(..) | AlarmCause::Call(..));
        self.state.alarms.iter().any(|alarm| alarm.luggage == Some(luggage) && of_danger(alarm))
    }
}

/// Whether the robot may have been between two cells when the program ended.
fn was_moving(phase: &Phase) -> bool {
    if let Phase::Fault { interrupted, .. } = phase { was_moving(interrupted) } else { phase.is_motion() }
}
