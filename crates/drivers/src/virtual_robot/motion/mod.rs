//! How the virtual robot's motions begin and end, and how it goes back to the centre of its cell. After a lost link
//! or a restart, the end of a motion was not observed. This file then finds the position. Contacts are handled in
//! `contacts`.

use std::time::Duration;

use super::{Aim, Command, Dialect, Leg, LegStage, TURN, Then, VirtualRobot, Way};
use crate::Output;
use hallsweep_core::effect::Action;
use hallsweep_core::event::{RobotEvent, Whereabouts};
use hallsweep_core::units::{Heading, Pose};

mod contacts;

/// Assumed delay of the message about a contact, until it is measured. It covers a frame of the page and the
/// transport of the message to this program.
const LATENCY: Duration = Duration::from_millis(30);

/// The robot counts as centred within this distance of the centre of its cell, in cells. It moves further in one
/// frame of the page.
const CENTRED: f64 = 0.04;

/// How far the robot drives ahead to feel whether its last step is complete, in cells.
const FEELS: f64 = 0.3;

/// Upper limit of the measured latency. A longer delay means that the page did not respond for a while.
pub(super) const SLOWEST: Duration = Duration::from_millis(500);

const LATE_WORD: &str = "its message about a contact came too late";

/// Shortest and longest accepted time of a step, when it is measured.
pub(super) const STEPS: [Duration; 2] = [Duration::from_millis(20), Duration::from_secs(10)];

/// Wait after the end of a move, in addition to twice the latency. A contact at the very end of the move is reported
/// within this time.
const MARGIN: Duration = Duration::from_millis(60);

/// Additional wait after a turn, in case the page is busy. A command that arrives before the end of a turn is lost.
pub(super) const TURNS_LATE: Duration = Duration::from_millis(120);

/// Wait after the end of a move before the latency is measured. The message about the first contact may take this
/// long.
const FIRST_MARGIN: Duration = Duration::from_millis(400);

/// Longest duration of one leg (a motion by one command). So the robot stops within half a second if the program has
/// died (safety S5). A longer way is divided into several legs.
const LONGEST: Duration = Duration::from_millis(450);

/// Longest distance that the robot drives for one purpose, in cells. It may need several legs.
const FURTHEST: f64 = 1.5;

/// Delay before a refused motion is tried again. The server refuses a motion while another one is running.
const AGAIN: Duration = Duration::from_millis(100);

/// Time after the first refusal after which no motion of this program can be running any more. An alarm is then sent,
/// to end the motion that the server believes to be running.
const FREED: Duration = Duration::from_millis(700);

/// How long the server may refuse a move before the order fails. The time after the alarm is included.
const REFUSED: Duration = Duration::from_millis(1500);

/// For this time, one alarm counts for every STOP, unless something was sent after it.
const ALARM_SERVES: Duration = Duration::from_millis(100);

/// An acknowledgement must arrive within this time after the end of a move. Without the acknowledgement, the move
/// counts as never made.
const UNACKNOWLEDGED: Duration = Duration::from_millis(1500);

/// Largest sideways distance from the centre of the cell that is not corrected, in cells. At this distance, the robot
/// does not touch things beside its way.
const BESIDE: f64 = 0.15;

/// If the link is lost within this time after sending a move, the robot may not have received the move. The time that
/// the server took for its greeting is added.
const BEGUN: Duration = Duration::from_millis(10);

/// Advice to the user when only the position is lost, and the map is right.
const PUT_HOME: &str = "Reload its page, so that the robot is at its start, and press START";

/// Advice to the user when the map may be wrong too.
const BEGIN_ANEW: &str =
    "The map may be wrong. Reload its page, so that the robot is at its start; RESET begins with an empty map";

/// Additional advice if there is no scene file.
const WITH_SCENE: &str = ". With its scene file (robot.scene) the program corrects a drift";

/// A step whose end was not observed: its direction and its length in cells. `felt` is how far the robot has driven
/// ahead since then, to find out whether the step is complete, in cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unheard {
    pub(super) towards: Heading,
    pub(super) cells: f64,
    pub(super) felt: f64,
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "no way takes longer than some seconds")]
pub(super) fn legs(lasts: Duration) -> u32 {
    lasts.div_duration_f64(LONGEST).ceil().max(1.0) as u32
}

impl VirtualRobot {
    pub(super) fn margin(&self) -> Duration {
        self.latency.map_or(FIRST_MARGIN, |latency| MARGIN + latency * 2)
    }

    pub(super) fn latency(&self) -> Duration {
        self.latency.unwrap_or(LATENCY)
    }

    pub(super) fn drive(&mut self, towards: Heading, cells: f64, backward: bool) {
        self.drive_on(towards, cells, backward, Duration::ZERO);
    }

    fn drive_on(&mut self, towards: Heading, cells: f64, backward: bool, before: Duration) {
        let all = cells.clamp(0.0, FURTHEST);
        let cells = all / f64::from(legs(self.step.mul_f64(all)));
        let way = Way::Straight { towards, cells, backward, lasts: self.step.mul_f64(cells), rest: all - cells, before };
        self.set_out(way);
    }

    pub(super) fn set_out(&mut self, way: Way) {
        let leg = Leg::new(way, LegStage::Fresh);
        if let Some(task) = &mut self.task {
            task.leg = Some(leg);
        }
        match self.dialect {
            Dialect::Semicolons => self.reconnect(),
            Dialect::Messages => self.queue(),
        }
    }

    pub(super) fn queue(&mut self) {
        let Some(leg) = self.leg_mut() else { return };
        leg.stage = LegStage::Queued;
        let command = leg.command();
        self.send(command);
        self.is_changed = true;
    }

    /// When the leg ends or needs its next action, if nothing is received before.
    pub(super) fn leg_due(&self) -> Option<Duration> {
        let leg = self.leg()?;
        match leg.stage {
            LegStage::Refused(until) | LegStage::Halting { until, .. } => Some(until),
            LegStage::Fresh | LegStage::Queued => None,
            LegStage::Sent(sent) if self.owes_alarm => Some(self.end_of(leg, sent)),
            LegStage::Sent(sent) if self.awaits_word(leg) => Some(self.end_of(leg, sent) + UNACKNOWLEDGED),
            LegStage::Sent(sent) => Some(self.end_of(leg, sent)),
        }
    }

    fn end_of(&self, leg: &Leg, sent: Duration) -> Duration {
        let late = if matches!(leg.way, Way::Turn { .. }) { TURNS_LATE } else { Duration::ZERO };
        sent + leg.lasts() + self.margin() + late
    }

    fn awaits_word(&self, leg: &Leg) -> bool {
        self.dialect == Dialect::Messages && !leg.is_acknowledged
    }

    pub(super) fn pass(&mut self) {
        if self.task.as_ref().is_some_and(|task| task.deadline <= self.now) {
            return self.give_up();
        }
        if self.owes_alarm && self.is_connected && self.leg_due().is_some_and(|due| due <= self.now) {
            self.alarm();
        }
        if self.leg_due().is_none_or(|due| due > self.now) {
            return;
        }
        let Some(leg) = self.leg().copied() else { return };
        match leg.stage {
            LegStage::Refused(_) => self.queue(),
            LegStage::Halting { lasted, .. } => {
                self.moved_for(leg, lasted);
                (self.off_centre, self.met) = (true, None);
                self.answer(|order| RobotEvent::Halted(order, true));
            }
            LegStage::Sent(_) if self.awaits_word(&leg) => {
                self.alarm();
                self.lose_sight("it did not report the end of a move: maybe its page was closed");
            }
            LegStage::Sent(_) => self.ended(leg),
            LegStage::Fresh | LegStage::Queued => {}
        }
    }

    fn give_up(&mut self) {
        self.forget_unsent();
        self.alarm();
        match self.leg().copied().filter(Leg::is_sent) {
            Some(Leg { way: Way::Turn { .. }, .. }) => self.lose_sight("it did not turn in time"),
            Some(leg) => {
                self.cut_short(leg);
                self.off_centre = true;
                self.fail("it did not finish in time and was halted");
            }
            None => self.fail("it did not happen in time"),
        }
    }

    fn forget_unsent(&mut self) {
        let alarm = self.written(Command::Alarm);
        self.outputs.retain(|output| !matches!(output, Output::Send(bytes) if *bytes != alarm));
    }

    /// Whether the leg was handed over for sending, but is not confirmed as sent yet.
    fn is_on_its_way(&self) -> bool {
        let is_queued = self.leg().is_some_and(|leg| leg.stage == LegStage::Queued);
        is_queued && !self.outputs.iter().any(|output| matches!(output, Output::Send(_)))
    }

    /// Handles the end of a leg without a contact.
    fn ended(&mut self, leg: Leg) {
        let Some(aim) = self.task.as_ref().map(|task| task.aim) else { return };
        self.is_changed = true;
        if let Way::Straight { towards, cells, backward, lasts, rest, before } = leg.way {
            if aim == Aim::Gauge {
                self.gauged += lasts;
            }
            if aim != Aim::Feel {
                self.reckoning.advance(towards, cells);
            }
            if rest > CENTRED / 2.0 {
                self.off_centre = true;
                return self.drive_on(towards, rest, backward, before + lasts);
            }
        }
        match aim {
            Aim::Step(to) if self.is_barred(to.cell) => {
                if let Way::Straight { towards, backward, .. } = leg.way {
                    self.go_on_until_met(towards, backward);
                }
            }
            Aim::Step(to) => {
                (self.stepped, self.off_centre) = (Some(self.now), false);
                self.complete(to);
            }
            Aim::Turn(to) => self.complete(to),
            Aim::Aside(to) => self.turned_aside(to, leg.is_halted),
            Aim::Feel => {
                self.felt(FEELS);
                self.go_back();
            }
            Aim::Back | Aim::Return | Aim::Gauged => self.go_back(),
            Aim::Gauge => {
                self.off_centre = true;
                self.gauge_on();
            }
            Aim::Retreat(then) => self.measure(then),
            Aim::Measure(Then::Gauged) => {
                self.aim(Aim::Gauged);
                self.go_back();
            }
            Aim::Measure(Then::Met(_)) if self.room.is_some() => self.stands_before_it(),
            // The robot has not met again the thing that it met from here before. So it does not stand where it was
            // believed to be.
            Aim::Measure(Then::Met(_)) => self.lose(LATE_WORD),
            Aim::Touch { is_certain, further } => self.not_touched(is_certain, further),
            Aim::Draw => {}
        }
    }

    pub(super) fn complete(&mut self, pose: Pose) {
        self.astray = self.astray.saturating_sub(1);
        if !self.reckoning.has_stood_in(pose.cell) {
            self.wandered = 0;
        }
        self.reckoning.complete(pose);
        if !self.off_centre {
            self.met = None;
        }
        self.answer(RobotEvent::Done);
    }

    pub(super) fn acknowledged(&mut self, name: Option<&str>) {
        let Some(leg) = self.leg_mut().filter(|leg| leg.is_sent()) else { return };
        let word = leg.command().word();
        // A contact may have cut an earlier move short. The acknowledgement of that move comes late and has that
        // move's name.
        leg.is_acknowledged |= name.is_none_or(|name| name == word);
    }

    /// Handles a refusal. Every client gets all refusals. A refusal concerns this program's command only if it has
    /// the command's name and comes soon after the command. The motion is then tried again. If it is still refused
    /// after an alarm, the order fails.
    pub(super) fn refused(&mut self, name: Option<&str>) {
        let (now, soon, off_centre) = (self.now, self.margin(), self.off_centre);
        let Some(leg) = self.leg_mut() else { return };
        let LegStage::Sent(sent) = leg.stage else { return };
        if name.is_some_and(|name| name != leg.command().word()) || now.saturating_sub(sent) > soon {
            return;
        }
        let (since, is_alarmed) = leg.refused.unwrap_or((now, false));
        let waited = now.saturating_sub(since);
        let is_halted = leg.is_halted;
        leg.stage = LegStage::Refused(now + AGAIN);
        leg.refused = Some((since, is_alarmed || waited >= FREED));
        self.is_changed = true;
        if is_halted || (waited >= FREED && !is_alarmed) {
            self.alarm();
        }
        if is_halted {
            self.answer(|order| RobotEvent::Halted(order, off_centre));
        } else if waited >= REFUSED {
            self.fail(
                "its server reports that another move is still under way, even after an alarm. Restart the server and reload its \
                 page, so that the robot is at its start",
            );
        }
    }

    pub(super) fn alarm(&mut self) {
        self.owes_alarm = !self.is_connected;
        let is_served = self.alarmed.is_some_and(|at| self.now.saturating_sub(at) < ALARM_SERVES);
        if self.is_connected && !is_served {
            self.send(Command::Alarm);
        }
    }

    /// Handles a STOP. An alarm is sent, whatever the robot is believed to do. Only during a turn, the alarm is
    /// delayed until the turn has ended. In some versions of the page an alarm does not halt a turn, and in others an
    /// alarm leaves the robot at a wrong angle. A drawing is not a motion and goes on.
    pub(super) fn halt(&mut self) {
        self.forget_unsent();
        let Some(leg) = self.leg().copied() else { return self.alarm() };
        match (leg.stage, leg.way) {
            (LegStage::Sent(sent), Way::Straight { .. }) => {
                let (lasted, until) = (self.now.saturating_sub(sent), self.now + self.margin());
                self.alarm();
                // The stored state for the next run of the program changes here.
                self.is_changed = true;
                if let Some(leg) = self.leg_mut() {
                    leg.stage = LegStage::Halting { lasted, until };
                }
            }
            (LegStage::Sent(_), Way::Turn { .. }) => {
                self.owes_alarm = true;
                if let Some(leg) = self.leg_mut() {
                    leg.is_halted = true;
                }
            }
            (LegStage::Halting { .. }, _) => self.alarm(),
            (LegStage::Fresh | LegStage::Refused(_) | LegStage::Queued, _) => {
                self.alarm();
                let off_centre = self.off_centre;
                self.answer(|order| RobotEvent::Halted(order, off_centre));
            }
        }
    }

    fn cut_short(&mut self, leg: Leg) {
        match leg.stage {
            LegStage::Sent(sent) => self.moved_for(leg, self.now.saturating_sub(sent)),
            LegStage::Halting { lasted, .. } => self.moved_for(leg, lasted),
            LegStage::Fresh | LegStage::Refused(_) | LegStage::Queued => {}
        }
    }

    fn moved_for(&mut self, leg: Leg, lasted: Duration) {
        if let Way::Straight { towards, lasts, .. } = leg.way {
            self.moved(towards, lasted.min(lasts).div_duration_f64(self.step));
        }
    }

    /// Adds this distance to the position, in cells. If the end of the last step was not observed, the distance is
    /// added to `felt` instead.
    pub(super) fn moved(&mut self, towards: Heading, cells: f64) {
        self.first_contact = None;
        match &mut self.unheard {
            Some(unheard) => unheard.felt += cells,
            None => self.reckoning.advance(towards, cells),
        }
    }

    pub(super) fn moves_towards(&self) -> Heading {
        match self.leg().map(|leg| leg.way) {
            Some(Way::Straight { towards, .. }) => towards,
            Some(Way::Turn { .. }) | None => self.reckoning.pose().heading,
        }
    }

    pub(super) fn moves_backward(&self) -> bool {
        matches!(self.leg().map(|leg| leg.way), Some(Way::Straight { backward: true, .. }))
    }

    pub(super) fn begin_recentring(&mut self) {
        if self.unheard.is_some() {
            self.aim(Aim::Feel);
            return self.drive(self.reckoning.pose().heading, FEELS, false);
        }
        self.go_back();
    }

    pub(super) fn go_back(&mut self) {
        let Pose { cell, heading } = self.reckoning.pose();
        let ahead = self.reckoning.way_to(cell, heading);
        if ahead.abs() <= CENTRED {
            let is_recentring = self.task.as_ref().is_some_and(|task| (task.action, task.aim) == (Action::Recentre, Aim::Back));
            return if is_recentring && self.room.is_some() { self.turn_aside() } else { self.came_back() };
        }
        if !matches!(self.task.as_ref().map(|task| task.aim), Some(Aim::Return | Aim::Gauged)) {
            self.aim(Aim::Back);
        }
        let cells = ahead.abs();
        if ahead > 0.0 { self.drive(heading, cells, false) } else { self.drive(heading.opposite(), cells, true) }
    }

    /// By the scene file, the robot may also stand to the side of its cell's centre. There it could touch things
    /// beside its way. So it turns towards the centre, and keeps the new heading.
    fn turn_aside(&mut self) {
        let Pose { cell, heading } = self.reckoning.pose();
        let right = self.reckoning.way_to(cell, heading.right());
        if right.abs() <= BESIDE {
            return self.came_back();
        }
        let (heading, left) = if right > 0.0 { (heading.right(), false) } else { (heading.left(), true) };
        self.aim(Aim::Aside(Pose { cell, heading }));
        self.set_out(Way::Turn { left, lasts: TURN });
    }

    fn turned_aside(&mut self, pose: Pose, is_halted: bool) {
        self.reckoning.complete(pose);
        self.off_centre = true;
        self.events.push_back(RobotEvent::Stands(Whereabouts { pose, off_centre: true }));
        if is_halted {
            return self.answer(|order| RobotEvent::Halted(order, true));
        }
        self.aim(Aim::Back);
        self.go_back();
    }

    fn came_back(&mut self) {
        match self.task.as_ref().map(|task| task.aim) {
            Some(Aim::Return) => return self.came_back_touched(),
            Some(Aim::Gauged) => return self.came_back_gauged(),
            _ => {}
        }
        self.off_centre = false;
        self.answer(RobotEvent::Done);
    }

    /// Marks the position as lost and the map as doubtful, because things may have been reported in wrong cells.
    pub(super) fn lose(&mut self, words: &str) {
        self.reckoning.doubt();
        let advice = if self.room.is_none() { WITH_SCENE } else { "" };
        self.fail_lost(format!("{words}. {BEGIN_ANEW}{advice}"));
    }

    /// Marks only the position as lost. The map is right.
    pub(super) fn lose_sight(&mut self, words: &str) {
        self.fail_lost(format!("{words}. {PUT_HOME}"));
    }

    pub(super) fn fail_lost(&mut self, words: String) {
        // Nothing more may be sent. If no order is open, the next order is answered with this failure.
        self.forget_unsent();
        (self.off_centre, self.is_told_lost, self.is_changed) = (true, self.task.is_some(), true);
        self.fail(&words);
        self.lost = Some(words);
    }

    /// Marks the position as lost, because it is unknown whether the robot received the move.
    fn left_in_doubt(&mut self) {
        self.off_centre = true;
        self.lost = Some(format!("its connection was lost just when it got a move. {PUT_HOME}"));
    }

    /// Handles a motion towards a known thing when its end was not observed. A robot that drove forward stops at that
    /// thing, so its position is known. If it drove backwards, the position is unknown.
    fn left_against_something(&mut self, backward: bool) {
        let heading = self.reckoning.pose().heading;
        match self.reckoning.contact_ahead() {
            Some((way, true)) if !backward => self.reckoning.advance(heading, way),
            Some(_) | None => self.left_in_doubt(),
        }
    }

    /// Handles a running motion when the link is lost or the program has ended. The motion ends by itself and is not
    /// observed. On the way back and in a turn, no contact is expected.
    pub(super) fn leave_unheard(&mut self) {
        let is_on_its_way = self.is_on_its_way();
        self.forget_unsent();
        let Some(task) = self.task.take() else { return };
        self.is_changed = true;
        let may_be_unheard = BEGUN + self.greeted_after;
        let Some(leg) = task.leg.filter(|leg| leg.is_sent() || is_on_its_way) else { return };
        if is_on_its_way || matches!(leg.stage, LegStage::Sent(sent) if self.now.saturating_sub(sent) < may_be_unheard) {
            return self.left_in_doubt();
        }
        self.off_centre |= matches!(leg.way, Way::Straight { .. });
        if let LegStage::Halting { lasted, .. } = leg.stage
            && !matches!(task.aim, Aim::Step(_))
        {
            return self.moved_for(leg, lasted);
        }
        match (leg.way, task.aim) {
            (Way::Turn { .. }, Aim::Turn(to) | Aim::Aside(to)) => self.reckoning.complete(to),
            (Way::Straight { towards, cells, .. }, Aim::Step(_)) => {
                let cells = match leg.stage {
                    LegStage::Halting { lasted, .. } => cells.min(lasted.div_duration_f64(self.step)),
                    LegStage::Fresh | LegStage::Refused(_) | LegStage::Queued | LegStage::Sent(_) => cells,
                };
                self.unheard = Some(Unheard { towards, cells, felt: 0.0 });
            }
            (Way::Straight { cells, .. }, Aim::Feel) => {
                if let Some(unheard) = &mut self.unheard {
                    unheard.felt += cells;
                }
            }
            (
                Way::Straight { towards, cells, .. },
                Aim::Turn(_) | Aim::Back | Aim::Aside(_) | Aim::Return | Aim::Retreat(_) | Aim::Gauge | Aim::Gauged | Aim::Draw,
            ) => {
                self.reckoning.advance(towards, cells);
            }
            (Way::Straight { backward, .. }, Aim::Measure(_) | Aim::Touch { .. }) => self.left_against_something(backward),
            (Way::Turn { .. }, _) => {}
        }
    }
}

#[cfg(test)]
mod tests;
