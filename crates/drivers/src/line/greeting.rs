//! How program and robot find each other. The robot says who it is and up to which number it has heard orders; the program tells it
//! to halt and to take orders above the next number; when the robot says that it does, the link is up.
//!
//! ```text
//!   hello ──► ◄── hello ada … last=41
//!   from 42 ──► ◄── hello ada … last=42     the link is up; the first order is 43
//! ```
//! A robot that is switched on has heard of no number and obeys no order, so that it never goes on with one that it had begun
//! before.

use std::time::Duration;

use super::driver::{ALL_COUNTED, HELLO, LineDriver, LinkStage, Robot};
use super::from_robot::Hello;
use super::numbers::Seq;
use super::to_robot::ToRobot;
use hallsweep_core::event::{Capabilities, RobotEvent};
use hallsweep_core::robot::Part;
use hallsweep_core::units::Now;

/// A robot that takes longer for a cell or a turn stands still.
const SLOWEST: Duration = Duration::from_secs(60);

/// One that has not taken the number from which orders begin in so long never will; a long photo may be under way.
const GREETED: Duration = Duration::from_secs(60);

/// No hall has more cells a side, so no robot in one stands further from its entrance.
const FURTHEST: i32 = 2048;

impl LineDriver {
    /// Asks the robot who it is, or tells it once more from where orders begin.
    pub(super) fn greet(&mut self, now: Now) {
        self.hello_at = now.since_start + HELLO;
        let words = if let LinkStage::Greeting(Some(from)) = self.link { ToRobot::From(from) } else { ToRobot::Hello };
        self.say(words);
        // The LED is told as often, as nothing answers that.
        self.say_led();
    }

    /// Up to where orders are void by a halt. A robot that is being greeted obeys none up to where they are to begin.
    pub(super) const fn voided(&self) -> Seq {
        match self.link {
            LinkStage::Greeting(Some(from)) => from,
            LinkStage::Greeting(None) => Seq::FIRST,
            LinkStage::Down | LinkStage::Up(_) => self.seq,
        }
    }

    pub(super) fn greeted(&mut self, hello: Hello, now: Now) {
        match &self.link {
            LinkStage::Down => {}
            LinkStage::Greeting(Some(from)) if hello.last == Some(*from) => self.rise(hello, *from, now),
            LinkStage::Greeting(_) if now.since_start.saturating_sub(self.connected) > GREETED => {
                self.break_link(format!("{} says who it is and takes no orders: is there another program?", hello.name));
            }
            LinkStage::Greeting(Some(from)) if hello.last < Some(*from) => {}
            LinkStage::Greeting(_) => self.begin_above(hello.last, now),
            LinkStage::Up(robot) => {
                if let Some(words) = self.mismatch(robot, &hello) {
                    self.break_link(words);
                }
            }
        }
    }

    /// Why a robot that says this is not the one to which the link stands, or not where that was left. With a new connection it begins
    /// anew, wherever it stands then.
    fn mismatch(&self, robot: &Robot, hello: &Hello) -> Option<String> {
        let Hello { name, parts, stands, last, .. } = hello;
        let (at, was_at) = (stands.pose, robot.pose);
        // What it has said before an answer came before that: it stands where its orders have brought it, or where the open one does.
        let is_there = at == was_at || self.open.as_ref().is_some_and(|open| at == open.task.after(was_at));
        if *name != robot.name {
            Some(format!("{name} has taken the place of {}: look where it stands", robot.name))
        } else if *last < Some(robot.from) {
            Some(format!("{name} was switched off and on: look whether it stands where it says"))
        } else if *last > Some(self.seq) {
            Some("another program has given the robot orders: let one drive it".to_owned())
        } else if parts.with(Part::AcknowledgedMoves) != robot.parts {
            Some(format!("{name} has other parts than it had: is it the same robot?"))
        } else if !is_there {
            let [(cell, heading), (was, headed)] = [at, was_at].map(|pose| (pose.cell, pose.heading.name()));
            Some(format!("{name} says that it stands at {cell}, {heading}, and stood at {was}, {headed}: look where it stands"))
        } else {
            None
        }
    }

    /// Tells it once that there is no link, and once more for each other reason.
    pub(super) fn tell_lost(&mut self, words: &str) {
        if self.told.as_deref() != Some(words) {
            self.told = Some(words.to_owned());
            self.events.push_back(RobotEvent::LinkLost(words.to_owned()));
        }
    }

    /// One that has heard of the last number there is must be switched off and on; until then it is asked again.
    fn begin_above(&mut self, last: Option<Seq>, now: Now) {
        let from = last.map_or(Some(Seq::FIRST), Seq::next);
        let is_first = matches!(self.link, LinkStage::Greeting(None));
        self.link = LinkStage::Greeting(from);
        match from {
            // One that always knows of more orders hears of it no more often than of anything else.
            Some(_) if is_first => self.greet(now),
            Some(_) => {}
            None => self.tell_lost(ALL_COUNTED),
        }
    }

    fn rise(&mut self, hello: Hello, from: Seq, now: Now) {
        let Hello { name, parts, step, turn, photo, stands, .. } = hello;
        let cell = stands.pose.cell;
        if cell.x.abs().max(cell.y.abs()) > FURTHEST {
            let words = format!("{name} says that it stands at {cell}, further from the entrance than any hall reaches");
            return self.break_link(words);
        }
        if let Some(before) = self.name.replace(name.clone()).filter(|before| *before != name) {
            self.tell_lost(&format!("{name} has taken the place of {before}: look where it stands"));
        }
        let [step, turn] = [step, turn].map(|time| time.min(SLOWEST));
        // Whoever speaks this protocol answers each move.
        let acknowledging = parts.with(Part::AcknowledgedMoves);
        let can = Capabilities { step, turn, photo, arm: Duration::ZERO, nudges: false, parts: acknowledging };
        self.link = LinkStage::Up(Robot { name, parts: acknowledging, from, pose: stands.pose });
        (self.seq, self.off_centre, self.told) = (from, stands.off_centre, None);
        self.hello_at = now.since_start + HELLO;
        self.events.extend([RobotEvent::Stands(stands), RobotEvent::LinkUp(can)]);
        self.say_led();
    }
}

#[cfg(test)]
mod tests;
