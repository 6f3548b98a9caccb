//! What the virtual robot meets: how far it had driven until then, what that says of where it stands, and what the core is told.

use std::time::Duration;

use super::super::reckoning::{DRIFT, Drift};
use super::super::room::{BORDER, REACHED};
use super::super::{Aim, Leg, LegStage, Then, VirtualRobot, Way};
use super::{LATE_WORD, LATENCY, SLOWEST, STEPS, Unheard};
use hallsweep_core::event::{Obstacle, RobotEvent, Whereabouts};
use hallsweep_core::units::{Cell, Heading, Piece, Pose};

/// Up to here what it meets while it feels is what it touched already.
const TOUCHED: f64 = 0.12;

/// A contact that is heard so long after the end of a step, with nothing met since, was one of that step.
const LATE: Duration = Duration::from_secs(3);

/// So often something may be met on the way back to the centre.
const HINDERED: u8 = 2;

/// So often it may be found to stand elsewhere, of which each completed step or turn makes good a third: else its room is another one.
const ASTRAY: u8 = 4 * FOUND;
const FOUND: u8 = 3;

/// Corrections of position allowed before the robot enters a new cell, so that it does not wander between two places for ever.
const WANDERED: u8 = 12;

/// A measurement changes the time of a step by no more than this, at once.
const STEP_CHANGE: f64 = 0.2;

/// How much further than the way to what it met it goes to meet it again, in cells.
const FURTHER: f64 = 0.4;

impl VirtualRobot {
    /// Something was met.
    pub(in super::super) fn contact(&mut self, name: Option<String>) {
        let Some(leg) = self.leg().copied().filter(Leg::is_sent) else { return self.contact_at_rest() };
        let (Way::Straight { towards, cells, before, .. }, Some(aim)) = (leg.way, self.task.as_ref().map(|task| task.aim)) else {
            // In a turn nothing is met.
            return self.contact_at_rest();
        };
        let since_sent = match leg.stage {
            LegStage::Sent(sent) => self.now.saturating_sub(sent),
            LegStage::Halting { lasted, .. } => lasted.min(leg.lasts()) + self.latency(),
            LegStage::Fresh | LegStage::Refused(_) | LegStage::Queued => return,
        };
        let driven = since_sent.saturating_sub(self.latency()).min(leg.lasts());
        let way = driven.div_duration_f64(self.step).min(cells);
        let name = name.or_else(|| self.met_by_room(towards, way));
        (self.met, self.is_changed, self.stepped) = (name.clone(), true, None);
        if matches!(leg.stage, LegStage::Halting { .. }) {
            return self.contact_while_halting(name.as_deref(), towards, way);
        }
        if aim == Aim::Feel {
            return self.felt_contact(name.as_deref(), towards, way);
        }
        if let Aim::Measure(then) = aim {
            return self.measured(before, since_sent, towards, then);
        }
        let is_known = self.reckoning.knows(name.as_deref(), towards);
        self.reckoning.advance(towards, way);
        self.off_centre = true;
        if aim == Aim::Gauge {
            return self.gauge_ends(driven);
        }
        if aim == Aim::Gauged && is_known {
            // On the way back to its start it has gone further than was counted.
            let _ = self.reckoning.meet(name.as_deref(), towards);
        }
        if !self.is_gauging() && !self.set_right(name.as_deref(), towards) {
            return;
        }
        match aim {
            Aim::Step(to) if self.latency.is_none() && !driven.is_zero() => self.retreat(before + driven, Then::Met(to)),
            Aim::Step(to) if !is_known && self.has_drifted_into(to, towards) => self.complete(to),
            Aim::Step(to) => self.met(to, towards),
            Aim::Touch { .. } if self.has_passed_what_bars(towards) => self.stand_beside(towards),
            Aim::Touch { .. } => {
                self.aim(Aim::Return);
                self.go_back();
            }
            Aim::Turn(_) | Aim::Back | Aim::Aside(_) | Aim::Return | Aim::Retreat(_) | Aim::Gauge | Aim::Gauged => {
                self.hindered(name.as_deref());
            }
            // They end above, or nothing moves.
            Aim::Measure(_) | Aim::Feel | Aim::Draw => {}
        }
    }

    /// Right before a halt it has met something: it stands there, and nothing else follows.
    fn contact_while_halting(&mut self, name: Option<&str>, towards: Heading, way: f64) {
        let is_known_where = self.unheard.is_none() && !self.is_gauging();
        self.moved(towards, way);
        self.off_centre = true;
        if !is_known_where || self.set_right(name, towards) {
            self.answer(|order| RobotEvent::Halted(order, true));
        }
    }

    /// What a step has come to that was stopped here: it may have been stopped where it was to end.
    fn met(&mut self, to: Pose, towards: Heading) {
        if self.reckoning.way_to(to.cell, towards) <= REACHED {
            self.off_centre = false;
            return self.complete(to);
        }
        if self.is_contradicted(to.cell, towards) {
            return self.stand_where_room_says(towards);
        }
        let obstacle = obstacle(self.met.as_deref());
        self.answer(|order| RobotEvent::Blocked(order, obstacle));
    }

    /// Whether a step into a cell where it has stood before was stopped near its centre, by something of which nobody knows where it stands:
    /// not that has come, but the robot is further than was counted. Then it is taken to be in the centre.
    fn has_drifted_into(&mut self, to: Pose, towards: Heading) -> bool {
        let left = self.reckoning.way_to(to.cell, towards);
        let has = self.reckoning.has_stood_in(to.cell) && left <= DRIFT;
        if has {
            // What it has met just now for the first time stands so much further.
            let name = self.met.clone();
            self.reckoning.correct(name.as_deref(), towards, left);
            self.off_centre = false;
        }
        has
    }

    /// Once, at the first contact: back for as long as it drove, and forward against it again.
    pub(in super::super) fn retreat(&mut self, driven: Duration, then: Then) {
        self.first_contact = Some(driven);
        self.aim(Aim::Retreat(then));
        let towards = self.moves_towards();
        self.drive(towards.opposite(), driven.div_duration_f64(self.step), !self.moves_backward());
    }

    pub(super) fn measure(&mut self, then: Then) {
        let Some(driven) = self.first_contact else { return self.go_back() };
        self.aim(Aim::Measure(then));
        // The leg that has ended was the way back.
        let (towards, backward) = (self.moves_towards().opposite(), !self.moves_backward());
        self.drive(towards, driven.div_duration_f64(self.step) + FURTHER, backward);
    }

    /// Against what it had met it went once more: by so much longer than the way takes the word of it came.
    fn measured(&mut self, before: Duration, since_sent: Duration, towards: Heading, then: Then) {
        let Some(driven) = self.first_contact.take() else { return self.go_back() };
        let latency = (before + since_sent).saturating_sub(driven).min(SLOWEST);
        self.latency = Some(latency);
        self.reckoning.advance(towards, driven.saturating_sub(before).div_duration_f64(self.step));
        // When it was met first, it had driven less than was counted, or more, by the same.
        let by = (LATENCY.as_secs_f64() - latency.as_secs_f64()) / self.step.as_secs_f64();
        match then {
            Then::Met(to) => {
                let name = self.met.clone();
                self.reckoning.correct(name.as_deref(), towards, by);
                self.events.push_back(RobotEvent::LinkUp(self.can()));
                self.met(to, towards);
            }
            Then::Gauged => {
                self.reckoning.advance(towards, by);
                self.gauged = (self.gauged + LATENCY).saturating_sub(latency);
                self.aim(Aim::Gauged);
                self.go_back();
            }
        }
    }

    /// On the way back to the centre. Who is stopped right before it is there.
    fn hindered(&mut self, name: Option<&str>) {
        let towards = self.moves_towards();
        if self.reckoning.way_to(self.reckoning.pose().cell, towards).abs() <= REACHED {
            return self.came_back();
        }
        let Some(task) = &mut self.task else { return };
        (task.leg, task.hindered) = (None, task.hindered + 1);
        if task.hindered > HINDERED {
            let what = name.unwrap_or("something");
            return self.lose(&format!("{what} is in its way back to the centre of its cell, so it has drifted"));
        }
        self.go_back();
    }

    /// The reckoning is set right by what was met; false when it was so wrong that the task has failed by it.
    fn set_right(&mut self, name: Option<&str>, towards: Heading) -> bool {
        match self.reckoning.meet(name, towards) {
            Ok(ratio) => {
                if let Some(ratio) = ratio {
                    // Half of it: a single way may have been driven while the page was busy.
                    let change = 1.0 + (ratio - 1.0).clamp(-STEP_CHANGE, STEP_CHANGE) / 2.0;
                    self.step = self.step.mul_f64(change).clamp(STEPS[0], STEPS[1]);
                }
                true
            }
            Err(_) if self.room.is_some() => {
                self.stand_where_room_says(towards);
                false
            }
            Err(Drift { is_harmless: true, .. }) if self.reckoning.has_stood_in(self.reckoning.cell()) => {
                self.stand_elsewhere(self.reckoning.cell());
                false
            }
            Err(Drift { cells, .. }) => {
                let what = name.unwrap_or("something");
                self.lose(&format!("it met {what} {:.1} cells from where that stands, so it has drifted", cells.abs()));
                false
            }
        }
    }

    /// It has drifted, and nothing was told of that the room contradicts: now it is known where it is.
    fn stand_where_room_says(&mut self, towards: Heading) {
        let met = self.met.clone();
        match self.truly_in(met.as_deref(), towards) {
            Some(cell) => self.stand_elsewhere(cell),
            None => self.lose("what it has met stands elsewhere by its scene file"),
        }
    }

    /// It has come past something that bars its way, so it stands in a column beside the one in which it was counted.
    fn stand_beside(&mut self, towards: Heading) {
        match self.column_beside(towards) {
            Some(cell) => self.stand_elsewhere(cell),
            None => self.lose("it has come past something that bars its way by its scene file"),
        }
    }

    /// It has drifted far, and all the way through cells that are free: no map is wrong by that, and now it is known where it is.
    pub(in super::super) fn stand_elsewhere(&mut self, cell: Cell) {
        (self.astray, self.wandered) = (self.astray + FOUND, self.wandered + 1);
        if self.astray > ASTRAY || self.wandered > WANDERED {
            (self.astray, self.wandered) = (0, 0);
            return self.lose("again and again it stands elsewhere than was counted, so its scene file is not of this room, or its page is too busy");
        }
        let pose = Pose { cell, ..self.reckoning.pose() };
        self.reckoning.complete(pose);
        self.off_centre = true;
        self.events.push_back(RobotEvent::Stands(Whereabouts { pose, off_centre: true }));
        self.answer(|order| RobotEvent::Halted(order, true));
    }

    /// A step was not complete, or ends where it is: something was met while it felt.
    fn felt_contact(&mut self, name: Option<&str>, towards: Heading, way: f64) {
        let has_moved = self.unheard.as_ref().is_some_and(|unheard| unheard.felt > 0.0);
        if way > TOUCHED || has_moved {
            self.felt(way);
        } else if self.reckoning.knows(name, towards) {
            // It stood against it, wherever that was counted to be.
            self.unheard = None;
            // However far it was from there by the reckoning.
            let _ = self.reckoning.meet(name, towards);
        } else {
            let what = name.unwrap_or("something");
            return self.lose_sight(&format!("while it could not be heard it may have met {what}"));
        }
        if self.set_right(name, towards) {
            self.go_back();
        }
    }

    /// The step whose end was not heard is complete, and it went so far beyond.
    pub(super) fn felt(&mut self, way: f64) {
        if let Some(Unheard { towards, cells, felt }) = self.unheard.take() {
            self.reckoning.advance(towards, cells);
            self.reckoning.advance(self.reckoning.pose().heading, felt + way);
        }
    }

    /// A thing that moves has touched it, or the word of a contact came after a step was thought to be complete.
    fn contact_at_rest(&mut self) {
        if self.stepped.take().is_some_and(|stepped| self.now.saturating_sub(stepped) < LATE) {
            self.lose(LATE_WORD);
        }
    }
}

/// What the name of a thing says that it is. A piece has the same number in every run.
fn obstacle(name: Option<&str>) -> Obstacle {
    match name {
        None => Obstacle::Unknown,
        Some(name) if name.starts_with("wall") || name == BORDER => Obstacle::Wall { left: 0, right: 0 },
        Some(name) => {
            // FNV-1a.
            let number = name.bytes().fold(0x811c_9dc5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
            Obstacle::Luggage(Piece(number))
        }
    }
}
