//! Carries out the acts of the transition table. Each act is a small change of world, mission and outbox. `records`
//! handles luggage and verdicts.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::Engine;
use crate::closing::{AreaClosing, Closed};
use crate::effect::Effect;
use crate::hand_over::HandOver;
use crate::hold::{Hold, HoldReason, Holds};
use crate::mission::{Act, Input, InputContext};
use crate::robot::RobotId;
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::Stage;
use crate::state::fact::Fact;
use crate::units::{Cell, Celsius, LuggageId};
use crate::world::alarm::{Alarm, AlarmCause};
use crate::world::hall_map::Mark;
use crate::world::resource::Resource;

impl Engine {
    pub(super) fn perform_all(&mut self, acts: &[Act], context: &InputContext) {
        for act in acts {
            self.perform(*act, context);
        }
    }

    fn perform(&mut self, act: Act, context: &InputContext) {
        match act {
            Act::Release => self.release(context),
            Act::Begin => self.begin_mission(),
            Act::EmptyMap => self.empty_map(),
            Act::Stop => self.stop(context),
            Act::Raise(hold) => self.raise(hold, context.why.clone()),
            Act::Clear(hold) => self.clear(hold),
            Act::LedOff => self.led(false),
            Act::LedOn => self.led(true),
            Act::EndSearch if self.goes_on() => {}
            Act::EndSearch => self.led(false),
            Act::AlarmDanger => {
                self.alarm_about(context.luggage, AlarmCause::Dangerous);
                self.end_alarm_hold();
            }
            Act::AlarmUnrecorded => context.luggage.map_or((), |id| self.alarm_unrecorded(id)),
            Act::FacePiece => self.set_stage(Stage::TakingPhoto),
            Act::Retake => self.retake(context),
            Act::RecordPiece => self.record_piece(context),
            Act::RecordRetake => self.record_retake(context),
            Act::AskOperator => self.ask_operator(context),
            Act::RecordUnsure => self.record_unsure(context),
            Act::RecordVerdict => self.record_verdict(context),
            Act::KeepBack => self.keep_back(context),
            Act::NoteReading => self.note_reading(context),
            Act::HearSensor => self.hear_sensor(context),
            Act::Acknowledge => self.acknowledge(context),
            Act::ChooseStrategy => self.choose_strategy(context),
            Act::Archive => self.archive(),
            Act::Close => self.close_mission(context),
            Act::HandOver => self.hand_over(context),
            Act::SearchAgain => {
                if let Some(again) = &context.again {
                    self.record_areas(Fact::SearchAgain(again.clone()));
                }
            }
            Act::OrderAreas => self.record_areas(Fact::AreasOrdered(Arc::clone(&context.areas))),
            Act::CloseArea => self.close_area(context),
            Act::RetryBlocked => self.retry_blocked(),
            Act::BeginRetrieval => self.begin_retrieval(context.luggage),
            Act::EndRetrieval => self.end_retrieval(),
        }
    }

    fn release(&mut self, context: &InputContext) {
        self.released = context.epoch.or(Some(self.state.epoch));
        if self.robots.release() {
            self.world.touch(Resource::Robot);
        }
        let mut holds = self.state.holds.clone();
        if holds.release() {
            self.note_holds(&holds);
        }
    }

    fn begin_mission(&mut self) {
        self.mission.forget_way();
        self.world.touch(Resource::Mission);
        if let Some(exercise) = &mut self.exercise {
            exercise.is_begun = true;
        }
        self.record(Fact::MissionBegan(self.state.mission.next(), self.state.strategy));
        // The record of an exercise says so itself, also where it is read without the entries before it.
        if let Some(conditions) = self.state.conditions.clone().filter(|conditions| conditions.venue.is_exercise) {
            self.record(Fact::Conditions(conditions));
        }
        // Readings are recorded only when they change. Without this loop, a mission with a constant temperature would
        // have no recorded reading. The operator's reading is not repeated, because it may be old.
        for (source, celsius) in self.world.thermometer.readings() {
            self.record(Fact::Temperature(source, celsius));
        }
        self.led(true);
    }

    pub(super) fn empty_map(&mut self) {
        self.keep_map_shown();
        self.world.touch(Resource::Mission);
        self.mission.forget_way();
        self.record(Fact::MapEmptied(self.state.pose.heading));
        self.outbox.sum_up();
    }

    /// Stops the robots first, and records the stop afterwards.
    fn stop(&mut self, context: &InputContext) {
        let next = self.state.epoch.next();
        let before = self.state.epoch;
        let epoch = context.epoch.map_or(next, |raised| raised.max(before));
        if epoch != before {
            self.record_soon(Fact::Epoch(epoch));
        }
        self.send_halt();
        self.world.touch(Resource::Mission);
        self.raise(Hold::Operator, None);
    }

    pub(super) fn raise(&mut self, hold: Hold, why: Option<HoldReason>) {
        // As a hold of the mission, `RobotLink` concerns the searching robot. During a retrieval, it concerns every
        // robot that the retrieval needs. Every other robot has its own hold for its link.
        if hold == Hold::RobotLink && self.state.retrieval.is_none() {
            self.halt_searching();
        } else {
            for robot in self.robots.moving() {
                self.send_halt_to(&robot);
            }
        }
        self.stop_trees_clock();
        let mut holds = self.state.holds.clone();
        let fresh = holds.raise(hold);
        let waits = self.state.phase.is_mission() && holds.raise(Hold::AwaitingStart);
        if hold != Hold::RobotLink && self.state.phase.is_mission() && self.robots.others_wait() {
            self.world.touch(Resource::Robot);
        }
        if fresh {
            self.world.write(self.now.wall, Tone::Warning, Said::Held(hold, why));
        }
        if fresh || waits {
            self.note_holds(&holds);
        }
    }

    fn clear(&mut self, hold: Hold) {
        let mut holds = self.state.holds.clone();
        if holds.clear(hold) {
            self.world.write(self.now.wall, Tone::Info, Said::Over(hold));
            self.note_holds(&holds);
        }
    }

    fn note_holds(&mut self, holds: &Holds) {
        self.world.touch(Resource::Mission);
        self.world.touch(Resource::Temperature);
        self.record(Fact::Holds(holds.to_vec()));
    }

    pub(super) fn halt_searching(&mut self) {
        if self.robots.searching().controller.is_moving() {
            self.send_halt_to(&self.robots.searching_id().clone());
        }
    }

    pub(super) fn send_halt(&mut self) {
        for robot in self.robots.ids() {
            self.send_halt_to(&robot);
        }
    }

    /// Sends a halt to a robot, ahead of every other effect that is still waiting (safety S2). An order that has not
    /// been sent is withdrawn.
    pub(super) fn send_halt_to(&mut self, robot: &RobotId) {
        let taken_back = self.outbox.halt(robot);
        let Some(robot) = self.robots.get_mut(robot) else { return };
        if let Some(order) = taken_back {
            robot.controller.close(order.id);
        }
        robot.controller.halt();
        self.world.touch(Resource::Robot);
    }

    fn led(&mut self, blinks: bool) {
        if self.state.led_blinking != blinks {
            self.world.touch(Resource::Robot);
            self.record(Fact::Led(blinks));
            // A blinking LED shows that a mission has begun, so the LED begins to blink only after the beginning is
            // recorded.
            if !blinks {
                self.on_record.lit = false;
                self.outbox.send(Effect::Led(self.robots.searching_id().clone(), false));
            }
        }
    }

    fn alarm_about(&mut self, luggage: Option<LuggageId>, cause: fn(LuggageId, Cell) -> AlarmCause) {
        let Some(record) = luggage.and_then(|id| self.state.luggage.get(id)) else { return };
        let cause = cause(record.id, record.cell);
        let is_same = |alarm: &Alarm| alarm.acknowledged.is_none() && alarm.luggage == luggage && alarm.cause == cause;
        if !self.state.alarms.iter().any(|alarm| is_same(alarm)) {
            self.world.touch(Resource::Alarms);
            self.world.write(self.now.wall, Tone::Alarm, Said::Alarm(cause.clone()));
            self.record(Fact::AlarmRaised(self.state.last_alarm.next(), luggage, cause));
        }
    }

    /// Raises an alarm for a danger that could not be recorded. Neither SAFE nor START releases the robot until
    /// somebody acknowledges the alarm or the danger is recorded.
    pub(super) fn alarm_unrecorded(&mut self, luggage: LuggageId) {
        self.alarm_about(Some(luggage), AlarmCause::Unrecorded);
        self.raise(Hold::Alarm, None);
    }

    /// Ends the hold `alarm` when no reason for it is left. A reason is an unacknowledged call to the operator, or an
    /// unacknowledged alarm about a piece whose danger is not recorded.
    pub(super) fn end_alarm_hold(&mut self) {
        let dangerous = |id: LuggageId| self.state.luggage.get(id).is_some_and(|luggage| luggage.is_dangerous());
        let unseen = self.state.alarms.iter().filter(|alarm| alarm.acknowledged.is_none());
        if unseen.filter_map(|alarm| alarm.luggage).all(dangerous) && !self.is_calling() {
            self.clear(Hold::Alarm);
        }
    }

    fn acknowledge(&mut self, context: &InputContext) {
        let (Some(id), Some(issuer)) = (context.alarm, &context.issuer) else { return };
        if !self.state.alarms.iter().any(|alarm| alarm.id == id && alarm.acknowledged.is_none()) {
            return;
        }
        self.world.touch(Resource::Mission);
        self.record(Fact::AlarmAcknowledged(id, Arc::clone(&issuer.who)));
        self.end_alarm_hold();
    }

    fn note_reading(&mut self, context: &InputContext) {
        if let Some((source, celsius)) = &context.reading {
            self.read_temperature(source, *celsius);
        }
    }

    /// Takes a reading of a configured sensor. The reading also ends the silence of the sensor.
    fn hear_sensor(&mut self, context: &InputContext) {
        let sensor = context.reading.as_ref().map(|(sensor, _)| Arc::clone(sensor));
        if sensor.is_some_and(|sensor| self.watchdog.hear(&sensor, self.now.since_start)) {
            self.feed(Input::SensorBack, &InputContext::default());
        }
        self.note_reading(context);
    }

    pub(super) fn read_temperature(&mut self, source: &Arc<str>, celsius: Celsius) {
        let before = self.world.thermometer.last.clone();
        // A sensor that repeats a reading must not fill the journal.
        if self.world.thermometer.read(source, celsius, self.now) {
            self.record(Fact::Temperature(Arc::clone(source), celsius));
        }
        if self.world.thermometer.last != before {
            self.world.touch(Resource::Temperature);
        }
        self.judge_heat(celsius);
    }

    pub(super) fn judge_heat(&mut self, celsius: Celsius) {
        let held = self.state.holds.contains(Hold::Temperature);
        let context = InputContext { why: Some(HoldReason::Reading(celsius)), ..InputContext::default() };
        match (self.world.thermometer.is_hot(), held) {
            (true, false) => self.feed(Input::Heat, &context),
            (false, true) => self.feed(Input::Cool, &context),
            (true, true) | (false, false) => {}
        }
    }

    pub(super) fn fall_silent(&mut self, source: &str) {
        if self.world.thermometer.fall_silent(source, self.now.wall) {
            self.record(Fact::ThermometerSilent(Arc::from(source)));
            self.world.touch(Resource::Temperature);
        }
    }

    fn choose_strategy(&mut self, context: &InputContext) {
        let Some(strategy) = context.strategy else { return };
        self.mission.forget_way();
        self.world.touch(Resource::Mission);
        self.record(Fact::Strategy(strategy));
    }

    /// Archives the mission. Its records stay in the journal.
    pub(super) fn archive(&mut self) {
        self.publish_all_judgements();
        self.reveal(true);
        if self.state.under_way {
            let bombs = self.state.luggage.bombs_left().map(|luggage| luggage.id).collect();
            self.record(Fact::MissionArchived(self.state.mission, bombs));
        } else {
            // No single fact records this change. Instead, the page ends with a record of the whole state.
            self.state.put_away();
        }
        self.outbox.sum_up();
        self.draw_areas();
        self.mission.forget_way();
        self.world.touch(Resource::Mission);
    }

    /// Records the end of the search as the person in charge states it. Nothing waits for it.
    fn close_mission(&mut self, context: &InputContext) {
        let (Some(closing), Some(issuer)) = (&context.closing, &context.issuer) else { return };
        let (who, name, note) = (Arc::clone(&issuer.who), closing.name.clone(), closing.note.clone());
        let open = self.open_points(&self.state.map, &self.state.luggage, self.state.again.len());
        self.world.touch(Resource::Mission);
        self.record(Fact::Closed(Box::new(Closed { who, name, note, open, wall: self.now.wall })));
        self.reveal(false);
    }

    /// Records to whom the mission is handed over. Nothing follows from it.
    fn hand_over(&mut self, context: &InputContext) {
        let (Some(HandOver { to, note, .. }), Some(issuer)) = (&context.hand_over, &context.issuer) else { return };
        // Over CoAP, which has no keys, the name alone would say too little.
        self.record(Fact::HandedOver { who: issuer.to_string().into(), to: to.clone(), note: note.clone() });
    }

    /// Records the end of the search of an area as the person in charge states it. Nothing waits for it.
    fn close_area(&mut self, context: &InputContext) {
        let (Some(AreaClosing { area, name, note, .. }), Some(issuer)) = (&context.area_closing, &context.issuer) else { return };
        let Some(found) = self.state.area(area) else { return };
        let (who, name, note) = (Arc::clone(&issuer.who), name.clone(), note.clone());
        let open = found.open(&self.state.map, &self.state.again, &self.state.luggage);
        let closed = Closed { who, name, note, open, wall: self.now.wall };
        self.record_areas(Fact::AreaClosed(Arc::clone(area), Box::new(closed)));
    }

    /// Records what a person decides about areas and about cells to be searched again. The robot finishes its present
    /// order. The search then chooses its goal anew, unless the goal is to be searched again.
    fn record_areas(&mut self, fact: Fact) {
        self.world.touch(Resource::Mission);
        self.record(fact);
        self.draw_areas();
        self.mission.has_news = true;
        if !self.searches_again() {
            self.set_goal(None, self.state.search.clone());
        }
    }

    /// Marks cells that were free and later blocked as free again, because somebody may have cleared the way. The cells
    /// of bombs stay.
    fn retry_blocked(&mut self) {
        let bombs: BTreeSet<Cell> = self.state.luggage.bombs_left().flat_map(|bomb| self.cells_of(bomb)).collect();
        for cell in self.state.blocked.difference(&bombs).copied().collect::<Vec<_>>() {
            self.mark(cell, Mark::Visited);
        }
        self.retry_retrieval();
    }
}
