//! How the virtual robot's motions begin and end, the way back to the centre of its cell, and the robot's position
//! after a motion whose end was not observed, because the link was lost or the program has ended. `contacts` handles
//! contacts.

use std::time::Duration;

use super::{Aim, Command, Dialect, Leg, LegStage, TURN, Then, VirtualRobot, Way};
use crate::Output;
use hallsweep_core::effect::Action;
use hallsweep_core::event::{RobotEvent, Whereabouts};
use hallsweep_core::units::{Heading, Pose};

mod contacts;

/// Assumed delay of the message of a contact until it is measured: a frame of the page, and the way of the message to
/// this program.
const LATENCY: Duration = Duration::from_millis(30);

/// Distance from the centre of the cell within which the robot counts as centred, in cells: less than it moves in one
/// frame of the page.
const CENTRED: f64 = 0.04;

/// Distance that the robot drives ahead to feel whether a step is complete, in cells.
const FEELS: f64 = 0.3;

/// Upper bound of the measured latency. If it is longer, the page has hung.
pub(super) const SLOWEST: Duration = Duration::from_millis(500);

const LATE_WORD: &str = "its message about a contact came too late";

/// Bounds of the measured time of a step.
pub(super) const STEPS: [Duration; 2] = [Duration::from_millis(20), Duration::from_secs(10)];

/// Wait after the end of a move for the message of a contact at its very end, in addition to twice the latency.
const MARGIN: Duration = Duration::from_millis(60);

/// Additional wait after a turn, for a page that is busy. A command that arrives before the end of a turn is lost.
pub(super) const TURNS_LATE: Duration = Duration::from_millis(120);

/// Wait after the end of a move before the latency is measured: the message of the first contact may take this long.
const FIRST_MARGIN: Duration = Duration::from_millis(400);

/// Longest leg, so that the robot stops within half a second if its program has died (safety S5). A longer way is
/// driven in several legs.
const LONGEST: Duration = Duration::from_millis(450);

/// Longest way that the robot drives at once, in cells. It may take several legs.
const FURTHEST: f64 = 1.5;

/// Delay before a motion is tried again that the server refused because another one was under way.
const AGAIN: Duration = Duration::from_millis(100);

/// Time after the first refusal, after which no motion of ours can be under way any more. Then an alarm ends the motion
/// that the server believes to be under way.
const FREED: Duration = Duration::from_millis(700);

/// Longest time in which a server may refuse a move, including the time after the alarm.
const REFUSED: Duration = Duration::from_millis(1500);

/// Time for which one alarm serves every STOP, unless something was sent after it.
const ALARM_SERVES: Duration = Duration::from_millis(100);

/// Time after the end of a move within which its acknowledgement must arrive. Without one the move was never made.
const UNACKNOWLEDGED: Duration = Duration::from_millis(1500);

/// Distance beside the centre of the cell that is not corrected, in cells. Within this distance the robot meets only
/// things that are in its way.
const BESIDE: f64 = 0.15;

/// Time after sending a move in which the link may have been lost before the robot received the move. The time is
/// longer for a slow server.
const BEGUN: Duration = Duration::from_millis(10);

/// Advice when only the position is lost, but the map is right.
const PUT_HOME: &str = "Reload its page, so that the robot is at its start, and press START";

/// Advice when the map may be wrong as well.
const BEGIN_ANEW: &str =
    "The map may be wrong. Reload its page, so that the robot is at its start; RESET begins with an empty map";

/// Advice added where a scene file would have helped.
const WITH_SCENE: &str = ". With its scene file (robot.scene) the program corrects a drift";

/// A step whose end was not observed: its direction, its length in cells, and how far the robot has felt ahead since,
/// in cells.
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

    /// When the leg ends, or its next action is due, if nothing is received before.
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

    /// Whether the leg was handed over for sending, but is not confirmed as sent.
    fn is_on_its_way(&self) -> bool {
        let is_queued = self.leg().is_some_and(|leg| leg.stage == LegStage::Queued);
        is_queued && !self.outputs.iter().any(|output| matches!(output, Output::Send(_)))
    }

    /// Handles the end of a leg during which nothing was met.
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
            // A thing that was met from here is not met again. So the robot stands elsewhere, or met the thing from
            // elsewhere.
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
        // A contact may have cut an earlier move short. The acknowledgement of that move comes late, under its own
        // name.
        leg.is_acknowledged |= name.is_none_or(|name| name == word);
    }

    /// Handles a refusal. Every client receives all refusals: this one is ours if it names our command and comes soon
    /// after the command. The move that the server believes to be under way ends soon, or by an alarm; otherwise the
    /// order fails.
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

    /// Sends an alarm whatever the robot is thought to do, except in a turn. In some versions of the page no alarm
    /// halts a turn, and in others an alarm leaves the robot askew. So the alarm is sent after the turn. A drawing is
    /// no motion.
    pub(super) fn halt(&mut self) {
        self.forget_unsent();
        let Some(leg) = self.leg().copied() else { return self.alarm() };
        match (leg.stage, leg.way) {
            (LegStage::Sent(sent), Way::Straight { .. }) => {
                let (lasted, until) = (self.now.saturating_sub(sent), self.now + self.margin());
                self.alarm();
                // This changes the memory for the next program.
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

    /// Adds this way, in cells, to the reckoning. If the end of the last step was not observed, adds it to the way that
    /// was felt ahead.
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

    /// A scene file may show that the robot also stands to the side of the centre. The robot must not meet things
    /// there, so it turns towards the centre, and keeps that heading.
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

    /// Gives up the position and the map: things may have been reported for the wrong cells.
    pub(super) fn lose(&mut self, words: &str) {
        self.reckoning.doubt();
        let advice = if self.room.is_none() { WITH_SCENE } else { "" };
        self.fail_lost(format!("{words}. {BEGIN_ANEW}{advice}"));
    }

    /// Gives up only the position: the map is right.
    pub(super) fn lose_sight(&mut self, words: &str) {
        self.fail_lost(format!("{words}. {PUT_HOME}"));
    }

    pub(super) fn fail_lost(&mut self, words: String) {
        // Nothing may be sent any more. Without an open order, the next order is answered with this failure.
        self.forget_unsent();
        (self.off_centre, self.is_told_lost, self.is_changed) = (true, self.task.is_some(), true);
        self.fail(&words);
        self.lost = Some(words);
    }

    /// Gives up the position, because it is unknown whether the robot received the move.
    fn left_in_doubt(&mut self) {
        self.off_centre = true;
        self.lost = Some(format!("its connection was lost just when it got a move. {PUT_HOME}"));
    }

    /// Handles a motion against a thing when its end was not observed. A robot that drove forward stops at that thing,
    /// whose place is known. The space behind the robot is unknown.
    fn left_against_something(&mut self, backward: bool) {
        let heading = self.reckoning.pose().heading;
        match self.reckoning.contact_ahead() {
            Some((way, true)) if !backward => self.reckoning.advance(heading, way),
            Some(_) | None => self.left_in_doubt(),
        }
    }

    /// Handles a motion under way when the link is lost or the program has ended. The motion ends by itself,
    /// unobserved. On the way back and in a turn nothing is met.
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
