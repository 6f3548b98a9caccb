//! Contacts of the virtual robot: how far it had driven before a contact, what the contact shows about its position,
//! what is reported to the core.

use std::time::Duration;

use super::super::reckoning::{DRIFT, Drift};
use super::super::room::{BORDER, REACHED};
use super::super::{Aim, Leg, LegStage, Then, VirtualRobot, Way};
use super::{LATE_WORD, LATENCY, SLOWEST, STEPS, Unheard};
use hallsweep_core::event::{Obstacle, RobotEvent, Whereabouts};
use hallsweep_core::units::{Cell, Heading, Piece, Pose};

/// If the robot feels ahead and the contact comes within this distance, in cells, the robot was already touching the
/// thing.
const TOUCHED: f64 = 0.12;

/// A contact counts as part of the last step if it is reported within this time after the step. No other contact may
/// have come since.
const LATE: Duration = Duration::from_secs(3);

/// Maximum number of contacts on the way back to the centre.
const HINDERED: u8 = 2;

/// Limit of the counter of corrections. After more than four corrections in a row, the scene file counts as that of
/// another room. Each completed step or turn makes up for a third of a correction.
const ASTRAY: u8 = 4 * FOUND;
/// One correction of the position adds this number to the counter. Each completed step or turn subtracts 1.
const FOUND: u8 = 3;

/// Maximum number of corrections before the robot enters a new cell. Without this limit, the robot could wander
/// between two places forever.
const WANDERED: u8 = 12;

/// Largest change of the step's time that a single contact may suggest, as a share. Half of the suggested change is
/// applied.
const STEP_CHANGE: f64 = 0.2;

/// How far the robot drives beyond the known place of a thing to meet the thing again, in cells.
const FURTHER: f64 = 0.4;

impl VirtualRobot {
    pub(in super::super) fn contact(&mut self, name: Option<String>) {
        let Some(leg) = self.leg().copied().filter(Leg::is_sent) else { return self.contact_at_rest() };
        let (Way::Straight { towards, cells, before, .. }, Some(aim)) = (leg.way, self.task.as_ref().map(|task| task.aim)) else {
            // Contacts do not happen in a turn.
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
            // The robot met a known thing, so the way back to the start was longer than counted.
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
            // For `Measure` and `Feel`, the contact was handled above. For `Draw`, the robot does not move.
            Aim::Measure(_) | Aim::Feel | Aim::Draw => {}
        }
    }

    fn contact_while_halting(&mut self, name: Option<&str>, towards: Heading, way: f64) {
        let is_known_where = self.unheard.is_none() && !self.is_gauging();
        self.moved(towards, way);
        self.off_centre = true;
        if !is_known_where || self.set_right(name, towards) {
            self.answer(|order| RobotEvent::Halted(order, true));
        }
    }

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

    /// Whether the robot has come further in this step than counted: it was stopped near the centre of a cell where
    /// it has stood before, so that cell is free. If so, the position is set to that centre.
    fn has_drifted_into(&mut self, to: Pose, towards: Heading) -> bool {
        let left = self.reckoning.way_to(to.cell, towards);
        let has = self.reckoning.has_stood_in(to.cell) && left <= DRIFT;
        if has {
            // If the thing was met for the first time just now, its place is corrected by the same distance.
            let name = self.met.clone();
            self.reckoning.correct(name.as_deref(), towards, left);
            self.off_centre = false;
        }
        has
    }

    /// Begins the measurement of the latency, at the first contact only. The robot drives back for as long as it
    /// drove before, and then to the same thing again.
    pub(in super::super) fn retreat(&mut self, driven: Duration, then: Then) {
        self.first_contact = Some(driven);
        self.aim(Aim::Retreat(then));
        let towards = self.moves_towards();
        self.drive(towards.opposite(), driven.div_duration_f64(self.step), !self.moves_backward());
    }

    pub(super) fn measure(&mut self, then: Then) {
        let Some(driven) = self.first_contact else { return self.go_back() };
        self.aim(Aim::Measure(then));
        // The leg that just ended was the way back.
        let (towards, backward) = (self.moves_towards().opposite(), !self.moves_backward());
        self.drive(towards, driven.div_duration_f64(self.step) + FURTHER, backward);
    }

    /// Measures the latency at the second contact with the same thing. The latency is the time from the end of the
    /// driving to the message about the contact.
    fn measured(&mut self, before: Duration, since_sent: Duration, towards: Heading, then: Then) {
        let Some(driven) = self.first_contact.take() else { return self.go_back() };
        let latency = (before + since_sent).saturating_sub(driven).min(SLOWEST);
        self.latency = Some(latency);
        self.reckoning.advance(towards, driven.saturating_sub(before).div_duration_f64(self.step));
        // At the first contact, the position was computed with the assumed latency. It was wrong by this distance.
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

    /// Corrects the position after a contact. Returns `false` if the error was so great that the order has ended.
    fn set_right(&mut self, name: Option<&str>, towards: Heading) -> bool {
        match self.reckoning.meet(name, towards) {
            Ok(ratio) => {
                if let Some(ratio) = ratio {
                    // Only half of the change is applied, since the page may have been busy during this one drive.
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
                self.lose(&format!("it met {what} {:.1} cells from the expected place, so it has drifted", cells.abs()));
                false
            }
        }
    }

    /// Finds the robot's real cell by the scene file, after a drift that caused no wrong report.
    fn stand_where_room_says(&mut self, towards: Heading) {
        let met = self.met.clone();
        match self.truly_in(met.as_deref(), towards) {
            Some(cell) => self.stand_elsewhere(cell),
            None => self.lose("it met an obstacle that is elsewhere in its scene file"),
        }
    }

    /// Sets the position to a neighbouring column. The robot has passed a thing that blocks the column where it was
    /// believed to be.
    fn stand_beside(&mut self, towards: Heading) {
        match self.column_beside(towards) {
            Some(cell) => self.stand_elsewhere(cell),
            None => self.lose("it has passed an obstacle that blocks its way in its scene file"),
        }
    }

    /// Sets the position to this cell after a large drift. The map is kept, because nothing wrong was reported. If
    /// this happens too often, the position counts as lost and the map as doubtful.
    pub(in super::super) fn stand_elsewhere(&mut self, cell: Cell) {
        (self.astray, self.wandered) = (self.astray + FOUND, self.wandered + 1);
        if self.astray > ASTRAY || self.wandered > WANDERED {
            (self.astray, self.wandered) = (0, 0);
            return self.lose("its place was wrong again and again: its scene file is of another room, or its page is too busy");
        }
        let pose = Pose { cell, ..self.reckoning.pose() };
        self.reckoning.complete(pose);
        self.off_centre = true;
        self.events.push_back(RobotEvent::Stands(Whereabouts { pose, off_centre: true }));
        self.answer(|order| RobotEvent::Halted(order, true));
    }

    /// Handles a contact while the robot feels ahead. If the robot moved before this contact, its last step was
    /// complete. Otherwise, the last step was stopped by the thing that the robot touches.
    fn felt_contact(&mut self, name: Option<&str>, towards: Heading, way: f64) {
        let has_moved = self.unheard.as_ref().is_some_and(|unheard| unheard.felt > 0.0);
        if way > TOUCHED || has_moved {
            self.felt(way);
        } else if self.reckoning.knows(name, towards) {
            // The robot was already touching this thing, wherever it was believed to stand.
            self.unheard = None;
            // Corrects the position, even if it was very wrong.
            let _ = self.reckoning.meet(name, towards);
        } else {
            let what = name.unwrap_or("something");
            return self.lose_sight(&format!("it may have met {what} while the connection was lost"));
        }
        if self.set_right(name, towards) {
            self.go_back();
        }
    }

    /// Counts the step with the unobserved end as complete, and adds `way` cells beyond it.
    pub(super) fn felt(&mut self, way: f64) {
        if let Some(Unheard { towards, cells, felt }) = self.unheard.take() {
            self.reckoning.advance(towards, cells);
            self.reckoning.advance(self.reckoning.pose().heading, felt + way);
        }
    }

    /// Handles a contact when the robot is not moving. A moving thing has touched the robot, or the message came
    /// after the step had been counted as complete.
    fn contact_at_rest(&mut self) {
        if self.stepped.take().is_some_and(|stepped| self.now.saturating_sub(stepped) < LATE) {
            self.lose(LATE_WORD);
        }
    }
}

fn obstacle(name: Option<&str>) -> Obstacle {
    match name {
        None => Obstacle::Unknown,
        Some(name) if name.starts_with("wall") || name == BORDER => Obstacle::Wall { left: 0, right: 0 },
        Some(name) => {
            // The FNV-1a hash is used because it is the same in every run.
            let number = name.bytes().fold(0x811c_9dc5_u32, |hash, byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193));
            Obstacle::Luggage(Piece(number))
        }
    }
}
