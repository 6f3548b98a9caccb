//! How the virtual robot's motions begin and end: what is heard while one is under way, what is not heard, and what follows for where it
//! stands.

use std::time::Duration;

use super::memory::Unheard;
use super::reckoning::Drift;
use super::{Aim, Command, Dialect, GREETING, Leg, Stage, VirtualRobot, Way, obstacle};
use crate::Output;
use hallsweep_core::event::RobotEvent;
use hallsweep_core::units::{Heading, Pose};

/// What the word of a contact takes, before it was measured: a frame of the page, and the way.
const LATENCY: Duration = Duration::from_millis(30);

/// Behind the end of a move so long is waited for the word of a contact at its very end, beside the latency to and fro.
const MARGIN: Duration = Duration::from_millis(60);

/// Nearer to the centre than a frame of the page brings it, it is centred.
const CENTRED: f64 = 0.04;

/// No leg is longer than that, in cells, so that a robot whose program has died stops within half a second (safety S5).
const LONGEST: f64 = 1.25;

/// How far ahead it feels whether a step is complete, and up to where what it meets there is what it touched already.
const FEELS: f64 = 0.3;
const TOUCHED: f64 = 0.12;

/// A latency beyond this is none: the page has hung.
const SLOWEST: Duration = Duration::from_millis(500);

/// What was not begun because another motion was under way is tried again so much later.
const AGAIN: Duration = Duration::from_millis(100);

/// A move that is not acknowledged so long after its end was never made.
const UNACKNOWLEDGED: Duration = Duration::from_millis(1500);

/// A contact that is heard so long after the end of a step, with nothing begun since, was one of that step.
const LATE: Duration = Duration::from_millis(400);

/// So often something may be met on the way back to the centre.
const HINDERED: u8 = 2;

/// A measurement changes the time of a step by no more than this, at once.
const STEP_CHANGE: f64 = 0.2;

impl VirtualRobot {
    pub(super) fn margin(&self) -> Duration {
        MARGIN + self.latency() * 2
    }

    fn latency(&self) -> Duration {
        self.latency.unwrap_or(LATENCY)
    }

    pub(super) fn drive(&mut self, towards: Heading, cells: f64, backward: bool) {
        let cells = cells.clamp(0.0, 1.5);
        let way = Way::Straight { towards, cells, backward, lasts: self.step.mul_f64(cells) };
        self.set_out(way);
    }

    pub(super) fn set_out(&mut self, way: Way) {
        self.stepped = None;
        let leg = Leg::new(way, Stage::Fresh(self.now + GREETING));
        if let Some(task) = &mut self.task {
            task.leg = Some(leg);
        }
        match self.dialect {
            Dialect::Semicolons => self.outputs.push_back(Output::Reconnect),
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
            Stage::Fresh(until) | Stage::Refused(until) | Stage::Halting { until, .. } => Some(until),
            Stage::Queued => None,
            Stage::Sent(sent) if self.awaits_word(leg) => Some(self.end_of(leg, sent) + UNACKNOWLEDGED),
            Stage::Sent(sent) => Some(self.end_of(leg, sent)),
        }
    }

    fn end_of(&self, leg: &Leg, sent: Duration) -> Duration {
        sent + leg.lasts() + self.margin()
    }

    fn awaits_word(&self, leg: &Leg) -> bool {
        self.dialect == Dialect::Messages && !leg.is_acknowledged
    }

    /// What is due by now happens.
    pub(super) fn pass(&mut self) {
        if self.task.as_ref().is_some_and(|task| task.deadline <= self.now) {
            return self.give_up();
        }
        if self.leg_due().is_none_or(|due| due > self.now) {
            return;
        }
        let Some(leg) = self.leg().copied() else { return };
        match leg.stage {
            Stage::Fresh(_) => self.go_down("the virtual robot does not greet: its page was closed, or its server hangs"),
            Stage::Refused(_) => self.queue(),
            Stage::Halting { lasted, .. } => self.halted(leg, lasted),
            Stage::Sent(_) if self.awaits_word(&leg) => self.fail("it did not say that the move has ended: is its page open?"),
            Stage::Sent(_) => self.ended(leg),
            Stage::Queued => {}
        }
    }

    fn give_up(&mut self) {
        if let Some(leg) = self.leg().copied().filter(Leg::is_sent) {
            self.cut_short(leg);
            self.send(Command::Alarm);
            self.off_centre = true;
        }
        self.fail("it did not finish in time and was halted");
    }

    /// A leg came to its end, and nothing was met.
    fn ended(&mut self, leg: Leg) {
        let Some(task) = &mut self.task else { return };
        task.leg = None;
        let aim = task.aim;
        self.is_changed = true;
        if let Way::Straight { towards, cells, .. } = leg.way {
            if aim != Aim::Feel {
                self.reckoning.advance(towards, cells);
            }
            self.touches = None;
        }
        match aim {
            Aim::Step(to) => {
                self.stepped = Some(self.now);
                self.complete(to);
            }
            Aim::Turn(to) => self.complete(to),
            Aim::Feel => {
                self.felt(FEELS);
                self.go_back();
            }
            Aim::Back | Aim::Measure => self.go_back(),
            Aim::Draw => {}
        }
    }

    fn complete(&mut self, pose: Pose) {
        self.reckoning.complete(pose);
        if !self.off_centre {
            self.touches = None;
        }
        self.answer(RobotEvent::Done);
    }

    /// Senses, as far as that is needed, and goes back to the centre of its cell.
    pub(super) fn begin_recentring(&mut self) {
        if self.unheard.is_some() {
            self.aim(Aim::Feel);
            return self.drive(self.reckoning.pose().heading, FEELS, false);
        }
        self.go_back();
    }

    /// One leg further towards the centre of its cell, or the end of the order when it is there.
    fn go_back(&mut self) {
        let Pose { cell, heading } = self.reckoning.pose();
        let ahead = self.reckoning.way_to(cell, heading);
        if ahead.abs() <= CENTRED {
            return self.came_back();
        }
        self.aim(Aim::Back);
        let cells = ahead.abs().min(LONGEST);
        if ahead > 0.0 { self.drive(heading, cells, false) } else { self.drive(heading.opposite(), cells, true) }
    }

    fn came_back(&mut self) {
        // Once, after the first contact: forward against it again, which takes as long as the way back and the latency.
        if let Some(driven) = self.first_contact.filter(|driven| self.latency.is_none() && !driven.is_zero()) {
            self.aim(Aim::Measure);
            let cells = driven.div_duration_f64(self.step) + 0.4;
            return self.drive(self.reckoning.pose().heading, cells, false);
        }
        self.off_centre = false;
        self.answer(RobotEvent::Done);
    }

    /// Something was met.
    pub(super) fn contact(&mut self, name: Option<String>) {
        let Some(leg) = self.leg().copied().filter(Leg::is_sent) else { return self.contact_at_rest() };
        let (Way::Straight { towards, cells, .. }, Some(aim)) = (leg.way, self.task.as_ref().map(|task| task.aim)) else {
            return;
        };
        let since_sent = match leg.stage {
            Stage::Sent(sent) => self.now.saturating_sub(sent),
            Stage::Halting { lasted, .. } => lasted.min(leg.lasts()) + self.latency(),
            Stage::Fresh(_) | Stage::Refused(_) | Stage::Queued => return,
        };
        let driven = since_sent.saturating_sub(self.latency()).min(leg.lasts());
        let way = driven.div_duration_f64(self.step).min(cells);
        (self.touches, self.is_changed) = (name.clone(), true);
        if aim == Aim::Feel {
            return self.felt_contact(name.as_deref(), towards, way);
        }
        if aim == Aim::Measure {
            return self.measured(since_sent, towards);
        }
        self.reckoning.advance(towards, way);
        self.off_centre = true;
        if !self.set_right(name.as_deref(), towards) {
            return;
        }
        if matches!(leg.stage, Stage::Halting { .. }) {
            return self.answer(|order| RobotEvent::Halted(order, true));
        }
        if let Aim::Step(_) = aim {
            self.first_contact = self.first_contact.or(Some(driven)).filter(|_| self.latency.is_none());
            let obstacle = obstacle(name.as_deref());
            return self.answer(|order| RobotEvent::Blocked(order, obstacle));
        }
        self.hindered(name.as_deref());
    }

    fn hindered(&mut self, name: Option<&str>) {
        let Some(task) = &mut self.task else { return };
        (task.leg, task.hindered) = (None, task.hindered + 1);
        if task.hindered > HINDERED {
            let what = name.unwrap_or("something");
            return self.fail(&format!("{what} is in its way back to the centre of its cell"));
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
                    self.step = self.step.mul_f64(change);
                }
                true
            }
            Err(Drift(cells)) => {
                let what = name.unwrap_or("something");
                self.lose(format!("it met {what} {:.1} cells from where that stands, so it has drifted", cells.abs()));
                false
            }
        }
    }

    /// Against what it had met it went once more: by so much longer than the way takes the word of it came.
    fn measured(&mut self, since_sent: Duration, towards: Heading) {
        if let Some(driven) = self.first_contact.take() {
            let latency = since_sent.saturating_sub(driven).min(SLOWEST);
            // What was counted for the first time, it had driven less, or more, by the same.
            let by = LATENCY.as_secs_f64() - latency.as_secs_f64();
            let way = driven.div_duration_f64(self.step);
            self.latency = Some(latency);
            self.reckoning.advance(towards, way);
            let name = self.touches.clone();
            self.reckoning.correct(name.as_deref(), towards, by / self.step.as_secs_f64());
            self.events.push_back(RobotEvent::LinkUp(self.can()));
        }
        if let Some(task) = &mut self.task {
            task.leg = None;
        }
        self.go_back();
    }

    /// A step was not complete, or ends where it is: something was met while it felt.
    fn felt_contact(&mut self, name: Option<&str>, towards: Heading, way: f64) {
        let has_moved = self.unheard.as_ref().is_some_and(|unheard| unheard.felt > 0.0);
        if way > TOUCHED || has_moved {
            self.felt(way);
        } else if self.reckoning.knows(name, towards) {
            // It stood against it: wherever that was counted to be.
            self.unheard = None;
            let _where_it_is = self.reckoning.meet(name, towards);
        } else {
            let what = name.unwrap_or("something");
            return self.lose(format!("while it could not be heard it may have met {what}"));
        }
        if self.set_right(name, towards) {
            if let Some(task) = &mut self.task {
                task.leg = None;
            }
            self.go_back();
        }
    }

    /// The step whose end was not heard is complete, and it went so far beyond.
    fn felt(&mut self, way: f64) {
        if let Some(Unheard { towards, cells, felt }) = self.unheard.take() {
            self.reckoning.advance(towards, cells);
            self.reckoning.advance(self.reckoning.pose().heading, felt + way);
        }
    }

    /// A thing that moves has touched it, or the word of a contact came after a step was thought to be complete.
    fn contact_at_rest(&mut self) {
        if self.stepped.take().is_some_and(|stepped| self.now.saturating_sub(stepped) < LATE) {
            self.lose("the word that it had met something came too late".to_owned());
        }
    }

    pub(super) fn acknowledged(&mut self, name: Option<&str>) {
        let Some(leg) = self.leg_mut().filter(|leg| leg.is_sent()) else { return };
        let word = leg.command().word();
        // An old one, of what was cut short by a contact, comes late and under its own name.
        leg.is_acknowledged |= name.is_none_or(|name| name == word);
    }

    pub(super) fn refused(&mut self) {
        let again = self.now + AGAIN;
        if let Some(leg) = self.leg_mut().filter(|leg| matches!(leg.stage, Stage::Sent(_))) {
            leg.stage = Stage::Refused(again);
        }
    }

    /// A turn cannot be halted: it ends by itself, and is answered then. A drawing is no motion.
    pub(super) fn halt(&mut self) {
        let Some(leg) = self.leg().copied() else { return };
        match (leg.stage, leg.way) {
            (Stage::Sent(sent), Way::Straight { .. }) => {
                let (lasted, until) = (self.now.saturating_sub(sent), self.now + self.margin());
                self.send(Command::Alarm);
                if let Some(leg) = self.leg_mut() {
                    leg.stage = Stage::Halting { lasted, until };
                }
            }
            (Stage::Sent(_), Way::Turn { .. }) | (Stage::Halting { .. }, _) => {}
            (Stage::Fresh(_) | Stage::Refused(_) | Stage::Queued, _) => {
                self.outputs.clear();
                let off_centre = self.off_centre;
                self.answer(|order| RobotEvent::Halted(order, off_centre));
            }
        }
    }

    fn halted(&mut self, leg: Leg, lasted: Duration) {
        if let Way::Straight { towards, lasts, .. } = leg.way {
            let way = lasted.min(lasts).div_duration_f64(self.step);
            match &mut self.unheard {
                Some(unheard) => unheard.felt += way,
                None => self.reckoning.advance(towards, way),
            }
        }
        (self.off_centre, self.touches) = (true, None);
        self.answer(|order| RobotEvent::Halted(order, true));
    }

    fn cut_short(&mut self, leg: Leg) {
        if let (Stage::Sent(sent), Way::Straight { towards, lasts, .. }) = (leg.stage, leg.way) {
            let lasted = self.now.saturating_sub(sent).min(lasts);
            self.reckoning.advance(towards, lasted.div_duration_f64(self.step));
        }
    }

    /// The link is lost, or the program has ended: what is under way ends by itself, and nobody hears how. On the way back and in a turn
    /// nothing is to be met.
    pub(super) fn leave_unheard(&mut self) {
        let Some(task) = self.task.take() else { return };
        self.is_changed = true;
        let Some(leg) = task.leg.filter(Leg::is_sent) else { return };
        match (leg.way, task.aim) {
            (Way::Turn { .. }, Aim::Turn(to)) => self.reckoning.complete(to),
            (Way::Straight { towards, cells, .. }, Aim::Step(_)) => {
                let cells = match leg.stage {
                    Stage::Halting { lasted, .. } => cells.min(lasted.div_duration_f64(self.step)),
                    Stage::Fresh(_) | Stage::Refused(_) | Stage::Queued | Stage::Sent(_) => cells,
                };
                (self.off_centre, self.unheard) = (true, Some(Unheard { towards, cells, felt: 0.0 }));
            }
            (Way::Straight { cells, .. }, Aim::Feel) => {
                if let Some(unheard) = &mut self.unheard {
                    unheard.felt += cells;
                }
            }
            (Way::Straight { towards, cells, .. }, Aim::Turn(_) | Aim::Back | Aim::Measure | Aim::Draw) => {
                self.reckoning.advance(towards, cells);
            }
            (Way::Turn { .. }, Aim::Step(_) | Aim::Back | Aim::Measure | Aim::Feel | Aim::Draw) => {}
        }
    }
}
