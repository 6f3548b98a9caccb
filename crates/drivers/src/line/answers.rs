//! What the driver makes of each line of the robot: reports for the core, and photos out of the bytes that follow one. What is said
//! to the robot stands in `driver`.

use std::time::Duration;

use super::driver::{LineDriver, Link, Open};
use super::from_robot::FromRobot;
use super::numbers::Seq;
use super::picture::{MOST_BYTES, Picture};
use hallsweep_core::event::{OffCentre, RobotEvent};
use hallsweep_core::units::{Now, OrderId};

/// So long a photo is passed over that nobody waits for any more.
const UNWANTED: Duration = Duration::from_secs(30);

impl LineDriver {
    pub(super) fn line(&mut self, text: &str, now: Now) {
        self.heard = now.since_start;
        let Some(said) = FromRobot::parse(text) else {
            self.not_understood = Some(text.chars().take(60).collect());
            return;
        };
        match (said, &self.link) {
            (FromRobot::Hello(hello), _) => self.greeted(hello, now),
            (FromRobot::Photo(seq, length, crc), _) => self.expose(seq, length, crc, now),
            (_, Link::Down | Link::Greeting(_)) => {}
            (FromRobot::Sonar(cm), Link::Up(_)) => self.events.push_back(RobotEvent::Sonar(cm)),
            (FromRobot::Temperature(celsius), Link::Up(_)) => self.events.push_back(RobotEvent::Temperature(celsius)),
            (said, Link::Up(_)) => self.answered(said),
        }
    }

    /// An answer to the open order; one to any other is out of date.
    fn answered(&mut self, said: FromRobot) {
        match said {
            FromRobot::Done(seq, ahead) => {
                if let Some(id) = self.close_motion(seq, false) {
                    self.events.extend(ahead.map(RobotEvent::Ahead));
                    self.events.push_back(RobotEvent::Done(id));
                }
            }
            FromRobot::Blocked(seq, cm, obstacle) => {
                if let Some(id) = self.close_motion(seq, true) {
                    self.events.extend(cm.map(|cm| RobotEvent::Sonar(Some(cm))));
                    self.events.push_back(RobotEvent::Blocked(id, obstacle));
                }
            }
            FromRobot::Halted(seq, off_centre) => {
                if let Some(id) = self.close_motion(seq, off_centre) {
                    self.events.push_back(RobotEvent::Halted(id, off_centre));
                }
            }
            FromRobot::Failed(seq, why) | FromRobot::NoPhoto(seq, why) => {
                if let Some(open) = self.close(seq) {
                    self.off_centre |= open.task.is_motion();
                    let fails = if open.task.is_motion() { RobotEvent::Failed } else { RobotEvent::PhotoFailed };
                    self.events.push_back(fails(open.order.id, why.to_string()));
                }
            }
            FromRobot::Hello(_) | FromRobot::Photo(..) | FromRobot::Sonar(_) | FromRobot::Temperature(_) => {}
        }
    }

    fn close(&mut self, seq: Seq) -> Option<Open> {
        self.open.take_if(|_| seq == self.seq)
    }

    /// Closes the open order, if it is this one and a motion.
    fn close_motion(&mut self, seq: Seq, off_centre: OffCentre) -> Option<OrderId> {
        let open = self.open.take_if(|open| seq == self.seq && open.task.is_motion())?;
        self.off_centre = off_centre;
        Some(open.order.id)
    }

    /// The bytes of a photo follow. Those that nobody wants are passed over, so that nothing in them is taken for a line.
    fn expose(&mut self, seq: Seq, length: u32, crc: u32, now: Now) {
        let wanted = self.open.as_ref().filter(|open| seq == self.seq && !open.task.is_motion());
        let until = wanted.map_or(now.since_start + UNWANTED, |open| open.until);
        let is_wanted = wanted.is_some();
        if (1..=MOST_BYTES).contains(&length) {
            self.picture = Some(Picture::new(length, crc, is_wanted, until));
        } else if is_wanted && let Some(open) = self.close(seq) {
            let why = format!("its photo has {length} bytes: from 1 to {MOST_BYTES} are taken");
            self.events.push_back(RobotEvent::PhotoFailed(open.order.id, why));
        }
    }

    /// The photo is whole, or given up.
    pub(super) fn develop(&mut self, now: Now) {
        let Some(picture) = self.picture.take() else { return };
        self.heard = now.since_start;
        self.hello_at = now.since_start;
        if !picture.is_wanted {
            return;
        }
        let Some(open) = self.open.take() else { return };
        let id = open.order.id;
        self.events.push_back(match picture.developed() {
            Ok(photo) => RobotEvent::Photo(id, photo),
            Err(why) => RobotEvent::PhotoFailed(id, why),
        });
    }
}
