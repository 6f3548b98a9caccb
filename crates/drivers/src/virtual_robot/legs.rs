//! How the virtual robot's motions begin and end: what is heard while one is under way, what is not heard, and what follows for where it
//! stands.

use std::time::Duration;

use super::measures::{CENTRED, FEELS, LATE_WORD, LATENCY};
use super::{Aim, Command, Dialect, Leg, Stage, Then, VirtualRobot, Way};
use crate::Output;
use hallsweep_core::event::RobotEvent;
use hallsweep_core::units::{Heading, Pose};

/// Behind the end of a move so long is waited for the word of a contact at its very end, beside the latency to and fro.
const MARGIN: Duration = Duration::from_millis(60);

/// A turn that is not over swallows what is told next, so that a page that is busy has so much longer for it.
pub(super) const TURNS_LATE: Duration = Duration::from_millis(120);

/// The same before the latency was measured: the first contact may come as late as this.
const FIRST_MARGIN: Duration = Duration::from_millis(400);

/// No leg lasts longer, so that a robot whose program has died stops within half a second (safety S5). What is longer is driven in several.
const LONGEST: Duration = Duration::from_millis(450);

/// An order moves it no further than that at once, in cells.
const FURTHEST: f64 = 1.5;

/// What was not begun because another motion was under way is tried again so much later.
const AGAIN: Duration = Duration::from_millis(100);

/// Nothing that was begun here is still under way so long after the first refusal: an alarm ends what the server believes in.
const FREED: Duration = Duration::from_millis(700);

/// Longest wait for a server that refuses a move, the alarm included.
const REFUSED: Duration = Duration::from_millis(1500);

/// An alarm serves every STOP of so long a time, unless something was sent behind it.
const ALARM_SERVES: Duration = Duration::from_millis(100);

/// A move that is not acknowledged so long after its end was never made.
const UNACKNOWLEDGED: Duration = Duration::from_millis(1500);

/// In how many legs a way is driven that takes so long.
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
        let leg = Leg::new(way, Stage::Fresh);
        if let Some(task) = &mut self.task {
            task.leg = Some(leg);
        }
        match self.dialect {
            Dialect::Semicolons => self.reconnect(),
            Dialect::Messages => self.queue(),
        }
    }

    /// Gives the leg to the robot.
    pub(super) fn queue(&mut self) {
        let Some(leg) = self.leg_mut() else { return };
        leg.stage = Stage::Queued;
        let command = leg.command();
        self.send(command);
        self.is_changed = true;
    }

    /// When something follows from silence.
    pub(super) fn leg_due(&self) -> Option<Duration> {
        let leg = self.leg()?;
        match leg.stage {
            Stage::Refused(until) | Stage::Halting { until, .. } => Some(until),
            Stage::Fresh | Stage::Queued => None,
            Stage::Sent(sent) if self.owes_alarm => Some(self.end_of(leg, sent)),
            Stage::Sent(sent) if self.awaits_word(leg) => Some(self.end_of(leg, sent) + UNACKNOWLEDGED),
            Stage::Sent(sent) => Some(self.end_of(leg, sent)),
        }
    }

    fn end_of(&self, leg: &Leg, sent: Duration) -> Duration {
        let late = if matches!(leg.way, Way::Turn { .. }) { TURNS_LATE } else { Duration::ZERO };
        sent + leg.lasts() + self.margin() + late
    }

    fn awaits_word(&self, leg: &Leg) -> bool {
        self.dialect == Dialect::Messages && !leg.is_acknowledged
    }

    /// What is due by now happens.
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
            Stage::Refused(_) => self.queue(),
            Stage::Halting { lasted, .. } => self.halted(leg, lasted),
            Stage::Sent(_) if self.awaits_word(&leg) => {
                self.alarm();
                self.lose_sight("it did not say that the move has ended, so maybe its page was closed");
            }
            Stage::Sent(_) => self.ended(leg),
            Stage::Fresh | Stage::Queued => {}
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

    /// What has not gone out by now does not go out any more, but an alarm.
    pub(super) fn forget_unsent(&mut self) {
        let alarm = self.written(Command::Alarm);
        self.outputs.retain(|output| !matches!(output, Output::Send(bytes) if *bytes != alarm));
    }

    /// Whether the leg was handed over to be sent, and nobody has said that it was.
    pub(super) fn is_on_its_way(&self) -> bool {
        let is_queued = self.leg().is_some_and(|leg| leg.stage == Stage::Queued);
        is_queued && !self.outputs.iter().any(|output| matches!(output, Output::Send(_)))
    }

    /// A leg came to its end, and nothing was met.
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
            // What it met from here before it does not meet again: it stands elsewhere, or that was not met here.
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
        // An old one, of what was cut short by a contact, comes late and under its own name.
        leg.is_acknowledged |= name.is_none_or(|name| name == word);
    }

    /// What was refused may have been another program's: it is ours when it is called like ours, which was sent just now. The move that
    /// the server believes in ends soon, or by an alarm, or the order fails.
    pub(super) fn refused(&mut self, name: Option<&str>) {
        let (now, soon, off_centre) = (self.now, self.margin(), self.off_centre);
        let Some(leg) = self.leg_mut() else { return };
        let Stage::Sent(sent) = leg.stage else { return };
        if name.is_some_and(|name| name != leg.command().word()) || now.saturating_sub(sent) > soon {
            return;
        }
        let (since, is_alarmed) = leg.refused.unwrap_or((now, false));
        let waited = now.saturating_sub(since);
        let is_halted = leg.is_halted;
        leg.stage = Stage::Refused(now + AGAIN);
        leg.refused = Some((since, is_alarmed || waited >= FREED));
        self.is_changed = true;
        if is_halted || (waited >= FREED && !is_alarmed) {
            self.alarm();
        }
        if is_halted {
            self.answer(|order| RobotEvent::Halted(order, off_centre));
        } else if waited >= REFUSED {
            self.fail("its server says that another move is still under way, and an alarm does not end that. Start the server again and open its page anew, so that the robot stands at its start");
        }
    }

    /// Sends an alarm, or owes it until a connection stands.
    pub(super) fn alarm(&mut self) {
        self.owes_alarm = !self.is_connected;
        let is_served = self.alarmed.is_some_and(|at| self.now.saturating_sub(at) < ALARM_SERVES);
        if self.is_connected && !is_served {
            self.send(Command::Alarm);
        }
    }

    /// The alarm goes out whatever the robot is taken to do, but in a turn, which no alarm halts in some versions and which it leaves
    /// askew in others: then it goes out when the turn is over. A drawing is no motion.
    pub(super) fn halt(&mut self) {
        self.forget_unsent();
        let Some(leg) = self.leg().copied() else { return self.alarm() };
        match (leg.stage, leg.way) {
            (Stage::Sent(sent), Way::Straight { .. }) => {
                let (lasted, until) = (self.now.saturating_sub(sent), self.now + self.margin());
                self.alarm();
                // What the next program must know changes by it.
                self.is_changed = true;
                if let Some(leg) = self.leg_mut() {
                    leg.stage = Stage::Halting { lasted, until };
                }
            }
            (Stage::Sent(_), Way::Turn { .. }) => {
                self.owes_alarm = true;
                if let Some(leg) = self.leg_mut() {
                    leg.is_halted = true;
                }
            }
            (Stage::Halting { .. }, _) => self.alarm(),
            (Stage::Fresh | Stage::Refused(_) | Stage::Queued, _) => {
                self.alarm();
                let off_centre = self.off_centre;
                self.answer(|order| RobotEvent::Halted(order, off_centre));
            }
        }
    }

    fn halted(&mut self, leg: Leg, lasted: Duration) {
        self.moved_for(leg, lasted);
        (self.off_centre, self.met) = (true, None);
        self.answer(|order| RobotEvent::Halted(order, true));
    }

    fn cut_short(&mut self, leg: Leg) {
        match leg.stage {
            Stage::Sent(sent) => self.moved_for(leg, self.now.saturating_sub(sent)),
            Stage::Halting { lasted, .. } => self.moved_for(leg, lasted),
            Stage::Fresh | Stage::Refused(_) | Stage::Queued => {}
        }
    }

    pub(super) fn moved_for(&mut self, leg: Leg, lasted: Duration) {
        if let Way::Straight { towards, lasts, .. } = leg.way {
            self.moved(towards, lasted.min(lasts).div_duration_f64(self.step));
        }
    }

    /// It has moved so far, from where it is taken to stand or, when it only feels, from where it stands in truth.
    pub(super) fn moved(&mut self, towards: Heading, cells: f64) {
        self.first_contact = None;
        match &mut self.unheard {
            Some(unheard) => unheard.felt += cells,
            None => self.reckoning.advance(towards, cells),
        }
    }
}

#[cfg(test)]
mod tests;
