//! The end of the program, and after a restart: the engine as it was, held, and what a kill cut short brought to its end (safety R1, R2).
//! How what stands follows from the journal is said by `crate::state`.

use std::sync::Arc;

use super::Engine;
use super::on_record::OnRecord;
use super::outbox::Outbox;
use crate::effect::{Effect, Entry, Fact};
use crate::event::RobotId;
use crate::mission::{Hold, Holds, Input, InputContext, Mission, Phase, PhaseName, Stage};
use crate::settings::Settings;
use crate::state::PersistentState;
use crate::units::{LuggageId, Now, Pose, Seq, WallTime};
use crate::world::hall_map::Mark;
use crate::world::log::Tone;
use crate::world::luggage::Luggage;
use crate::world::temperature::OPERATOR;

/// What was read back from the store.
#[derive(Clone, Debug, PartialEq)]
pub struct Recalled {
    /// What stands.
    pub standing: PersistentState,
    /// The last entry of the journal.
    pub written: Seq,
    /// The latest commands that carried an id, oldest first.
    pub commands: Vec<Entry>,
    /// The latest of what people did and what was found, oldest first.
    pub latest: Vec<Remembered>,
}

/// A line of the log as it was before a restart.
#[derive(Clone, Debug, PartialEq)]
pub struct Remembered {
    /// When it was.
    pub wall: WallTime,
    /// How loud.
    pub tone: Tone,
    /// What happened, as a sentence.
    pub text: String,
}

impl Engine {
    /// An engine that goes on from what was recalled. Nothing moves until a START.
    #[must_use]
    pub fn recall(settings: Settings, run: Arc<str>, recalled: Recalled, now: Now) -> Engine {
        let Recalled { standing, written, commands, latest } = recalled;
        let mut engine = Engine::new(settings, standing.strategy, run);
        engine.outbox = Outbox::after(written);
        engine.repeats.recall(&commands);
        engine.begin(now);
        for Remembered { wall, tone, text } in latest {
            engine.world.log.put(wall, tone, text);
        }
        engine.take_up(standing);
        engine.on_record = OnRecord::of(engine.mission_as_it_is());
        engine.note_start();
        engine.world.write(now.wall, Tone::Info, "the program was started again; everything is as it was".to_owned());
        engine.feed(Input::Restarted, &InputContext::default());
        engine.finish();
        engine.outbox.sum_up();
        engine.pump();
        engine
    }

    /// The program was asked to end, by this: the robot halts and gets no order any more. What it was about stays as it is, and a
    /// start of the program holds it (safety R1).
    pub fn handle_end(&mut self, by: &str, now: Now) {
        self.begin(now);
        self.is_ending = true;
        self.send_halt();
        self.world.write(now.wall, Tone::Warning, format!("the program was ended by {by}: the robot halts"));
        self.outbox.record(now.wall, Fact::ProgramEnded(by.to_owned()));
    }

    /// The last of all: what has waited for more of its kind goes on record.
    pub fn record_rest(&mut self, now: Now) {
        self.begin(now);
        self.record_all_refusals();
        self.record_all_stops();
    }

    pub(super) fn note_start(&mut self) {
        self.outbox.record(self.now.wall, Fact::ProgramStarted(env!("CARGO_PKG_VERSION").to_owned()));
    }

    /// The robot was put down at home in another hall: what was recalled of the old one is put away. Only while no mission is
    /// under way in the old one.
    pub fn put_down_elsewhere(&mut self, now: Now) {
        self.begin(now);
        let before = self.phase_name();
        self.archive();
        self.world.robot.pose = Pose::START;
        self.world.robot.off_centre = false;
        self.outbox.record(now.wall, Fact::Pose(Pose::START));
        self.empty_map();
        self.mission.phase = Phase::Idle;
        self.note_phase(before);
        self.world.write(now.wall, Tone::Info, "the robot was put down in another hall".to_owned());
    }

    /// Everything that stands, as it would be read back.
    #[must_use]
    pub fn standing(&self) -> PersistentState {
        let (mission, world) = (&self.mission, &self.world);
        PersistentState {
            mission: mission.id,
            under_way: mission.under_way,
            phase: mission.phase.clone(),
            holds: mission.holds.to_vec().into_iter().collect(),
            epoch: mission.epoch,
            strategy: mission.strategy,
            search: mission.search.clone(),
            goal: mission.goal,
            blocked: mission.blocked.clone(),
            pose: world.robot.pose,
            led_blinking: world.robot.led_blinking,
            map: world.map.clone(),
            pieces: world.pieces.clone(),
            luggage: world.luggage.clone(),
            last_luggage: mission.last_luggage,
            alarms: world.alarms.clone(),
            last_alarm: world.last_alarm(),
            reading: world.thermometer.reading_of(OPERATOR),
        }
    }

    fn take_up(&mut self, standing: PersistentState) {
        let PersistentState { pose, led_blinking, map, pieces, luggage, alarms, last_alarm, reading, .. } = standing.clone();
        (self.world.map, self.world.pieces, self.world.luggage) = (map, pieces, luggage);
        self.world.take_up_alarms(alarms, last_alarm);
        self.world.robot.pose = pose;
        // Where exactly a robot stands that was on its way is not known until it says so, or senses.
        self.world.robot.off_centre = was_moving(&standing.phase);
        self.world.robot.led_blinking = led_blinking;
        if led_blinking {
            self.outbox.send(Effect::Led(RobotId::Discovery, true));
        }
        self.mission = mission_of(standing);
        if self.world.map.at(pose.cell) != Mark::Visited {
            self.mark(pose.cell, Mark::Visited);
        }
        if let Some(celsius) = reading {
            self.read_temperature(&Arc::from(OPERATOR), celsius);
        }
    }

    /// A kill may fall between a record and what follows from it: then it follows now.
    fn finish(&mut self) {
        let about = |luggage: &Luggage| InputContext { luggage: Some(luggage.id), ..InputContext::default() };
        for luggage in self.world.luggage.values().map(Arc::clone).collect::<Vec<_>>() {
            if self.world.map.at(luggage.cell) == Mark::NotInspected {
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

    fn is_alarmed_about(&self, luggage: LuggageId) -> bool {
        let searches = matches!(
            self.mission.phase.underlying().name(),
            PhaseName::Exploring | PhaseName::Inspecting | PhaseName::ReturningHome | PhaseName::AtHome
        );
        !searches && self.world.alarms.iter().any(|alarm| alarm.luggage == Some(luggage))
    }
}

/// The mission that stands. What holds it because of something outside is not known before that says so again.
fn mission_of(standing: PersistentState) -> Mission {
    let mut holds = Holds::default();
    holds.raise(Hold::RobotLink);
    for hold in standing.holds {
        match hold {
            Hold::Operator | Hold::TooHigh | Hold::Restart | Hold::Alarm | Hold::AwaitingStart => drop(holds.raise(hold)),
            Hold::Temperature | Hold::TemperatureStale | Hold::RobotLink | Hold::Store => {}
        }
    }
    Mission {
        id: standing.mission,
        under_way: standing.under_way,
        phase: standing.phase,
        holds,
        epoch: standing.epoch,
        search: standing.search,
        goal: standing.goal,
        blocked: standing.blocked,
        last_luggage: standing.last_luggage,
        ..Mission::new(standing.strategy)
    }
}

/// Whether the robot may have been between two cells when the program ended.
fn was_moving(phase: &Phase) -> bool {
    match phase {
        Phase::Driving { .. } => true,
        Phase::Fault { interrupted, .. } => was_moving(interrupted),
        Phase::Exploring | Phase::ReturningHome | Phase::ReturningWithAlarm | Phase::Retrieving => true,
        Phase::Inspecting(inspection) => inspection.stage == Stage::BackingUp,
        Phase::Idle | Phase::AtHome | Phase::BombLocated | Phase::BagSecured | Phase::Explored => false,
    }
}
