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

use super::driver::{ALL_COUNTED, HELLO, LineDriver, Link, Robot};
use super::from_robot::Hello;
use super::numbers::Seq;
use super::to_robot::ToRobot;
use hallsweep_core::event::{Capabilities, RobotEvent};
use hallsweep_core::robots::Part;
use hallsweep_core::units::Now;
use hallsweep_core::world::hall_map::REACH;

/// A robot that takes longer for a cell or a turn stands still.
const SLOWEST: Duration = Duration::from_secs(60);

impl LineDriver {
    /// Asks the robot who it is, or tells it once more from where orders begin.
    pub(super) fn greet(&mut self, now: Now) {
        self.hello_at = now.since_start + HELLO;
        let words = if let Link::Greeting(Some(from)) = self.link { ToRobot::From(from) } else { ToRobot::Hello };
        self.say(words);
        // The LED is told as often, as nothing answers that.
        self.say_led();
    }

    pub(super) fn greeted(&mut self, hello: Hello, now: Now) {
        match &self.link {
            Link::Down => {}
            Link::Greeting(Some(from)) if hello.last == Some(*from) => self.rise(hello, *from, now),
            Link::Greeting(Some(from)) if hello.last < Some(*from) => {}
            Link::Greeting(_) => self.begin_above(hello.last, now),
            Link::Up(robot) if robot.name != hello.name => {
                let words = format!("{} has taken the place of {}: look where it stands", hello.name, robot.name);
                self.begin_anew(&words, hello.last, now);
            }
            Link::Up(robot) if hello.last < Some(robot.from) => {
                let words = format!("{} was switched off and on: look whether it stands where it says", robot.name);
                self.begin_anew(&words, hello.last, now);
            }
            Link::Up(_) if hello.last > Some(self.seq) => {
                self.begin_anew("another program has given the robot orders: let one drive it", hello.last, now);
            }
            Link::Up(_) => {}
        }
    }

    /// Tells it once that there is no link, and once more for each other reason.
    pub(super) fn tell_lost(&mut self, words: &str) {
        if self.told.as_deref() != Some(words) {
            self.told = Some(words.to_owned());
            self.events.push_back(RobotEvent::LinkLost(words.to_owned()));
        }
    }

    fn begin_anew(&mut self, words: &str, last: Option<Seq>, now: Now) {
        self.drop_order();
        self.tell_lost(words);
        self.begin_above(last, now);
    }

    /// One that has heard of the last number there is must be switched off and on; until then it is asked again.
    fn begin_above(&mut self, last: Option<Seq>, now: Now) {
        let from = last.map_or(Some(Seq::FIRST), Seq::next);
        self.link = Link::Greeting(from);
        match from {
            Some(_) => self.greet(now),
            None => self.tell_lost(ALL_COUNTED),
        }
    }

    fn rise(&mut self, hello: Hello, from: Seq, now: Now) {
        let Hello { name, parts, step, turn, photo, stands, .. } = hello;
        let cell = stands.pose.cell;
        if cell.x.abs().max(cell.y.abs()) > REACH {
            return self
                .tell_lost(&format!("{name} says that it stands at {cell}, further from the entrance than any hall reaches"));
        }
        if let Some(before) = self.name.replace(name.clone()).filter(|before| *before != name) {
            self.tell_lost(&format!("{name} has taken the place of {before}: look where it stands"));
        }
        let [step, turn] = [step, turn].map(|time| time.min(SLOWEST));
        // Whoever speaks this protocol answers each move.
        let acknowledging = parts.with(Part::AcknowledgedMoves);
        let can = Capabilities { step, turn, photo, arm: Duration::ZERO, nudges: false, parts: acknowledging };
        self.link = Link::Up(Robot { name, parts, from });
        (self.seq, self.off_centre, self.told) = (from, stands.off_centre, None);
        self.hello_at = now.since_start + HELLO;
        self.events.extend([RobotEvent::Stands(stands), RobotEvent::LinkUp(can)]);
        self.say_led();
    }
}
