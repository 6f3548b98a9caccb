//! How a link begins. The robot reports its name and the last order number that it knows. The program then tells it
//! to halt and to accept only orders above the next number. When the robot confirms that number, the link is up.
//!
//! ```text
//!   hello ──► ◄── hello ada … last=41
//!   from 42 ──► ◄── hello ada … last=42     the link is up; the first order is 43
//! ```
//! A robot that was just switched on knows no number and obeys no order. So it never continues an order from before.

use std::time::Duration;

use super::driver::{ALL_COUNTED, HELLO, LineDriver, LinkStage, Robot};
use super::from_robot::Hello;
use super::numbers::Seq;
use super::to_robot::ToRobot;
use hallsweep_core::event::{Capabilities, RobotEvent};
use hallsweep_core::robot::Part;
use hallsweep_core::units::Now;

/// Longest time for a step or a turn. A longer reported time is cut to this one.
const SLOWEST: Duration = Duration::from_secs(60);

/// How long the robot may take to confirm the number above which orders begin. It may be busy with a long photo.
const GREETED: Duration = Duration::from_secs(60);

/// Largest coordinate at which a robot can be. No hall has more cells on a side.
const FURTHEST: i32 = 2048;

impl LineDriver {
    pub(super) fn greet(&mut self, now: Now) {
        self.hello_at = now.since_start + HELLO;
        let words = if let LinkStage::Greeting(Some(from)) = self.link { ToRobot::From(from) } else { ToRobot::Hello };
        self.say(words);
        // The LED is sent again each time, because the robot does not confirm it.
        self.say_led();
    }

    /// The number up to which a halt voids orders. During the greeting, it is the number above which orders begin,
    /// because the robot must not obey orders up to that number.
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
                self.break_link(format!(
                    "{} answers but accepts no orders: look whether another program drives the robot",
                    hello.name
                ));
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

    /// Why this `hello` cannot come from the robot of this link. `None` if it can. The reported place is compared
    /// with the known place only within one connection. After a new connection, the robot may stand anywhere.
    fn mismatch(&self, robot: &Robot, hello: &Hello) -> Option<String> {
        let Hello { name, parts, stands, last, .. } = hello;
        let (at, was_at) = (stands.pose, robot.pose);
        // The answer to the open order may be lost or may still come. So the robot may already stand where that order
        // ends.
        let is_there = at == was_at || self.open.as_ref().is_some_and(|open| at == open.task.after(was_at));
        if *name != robot.name {
            Some(format!("{name} answers instead of {}: check the place of the robot", robot.name))
        } else if *last < Some(robot.from) {
            Some(format!("{name} was switched off and on: check that its reported place is right"))
        } else if *last > Some(self.seq) {
            Some("another program has given the robot orders: let only one program drive the robot".to_owned())
        } else if parts.with(Part::AcknowledgedMoves) != robot.parts {
            Some(format!("{name} now reports other parts: check that it is the same robot"))
        } else if !is_there {
            let [(cell, heading), (was, headed)] = [at, was_at].map(|pose| (pose.cell, pose.heading.name()));
            Some(format!("{name} says that it is at {cell}, {heading}, but was at {was}, {headed}: check its place"))
        } else {
            None
        }
    }

    /// Reports that there is no link, but only once for the same reason.
    pub(super) fn tell_lost(&mut self, words: &str) {
        if self.told.as_deref() != Some(words) {
            self.told = Some(words.to_owned());
            self.events.push_back(RobotEvent::LinkLost(words.to_owned()));
        }
    }

    /// Sends the number above which orders begin. If the robot has received the last possible number, it must be
    /// switched off and on. Until then, the driver keeps sending `hello`.
    fn begin_above(&mut self, last: Option<Seq>, now: Now) {
        let from = last.map_or(Some(Seq::FIRST), Seq::next);
        let is_first = matches!(self.link, LinkStage::Greeting(None));
        self.link = LinkStage::Greeting(from);
        match from {
            // Only the first answer is followed by a greeting at once. Each answer of the robot leads here, so lines
            // would be exchanged without a pause otherwise.
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
            self.tell_lost(&format!("{name} answers instead of {before}: check the place of the robot"));
        }
        let [step, turn] = [step, turn].map(|time| time.min(SLOWEST));
        // Every robot of this protocol reports the end of each move.
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
