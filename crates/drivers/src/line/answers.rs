//! How the driver handles lines from the robot. They become reports for the core, and the bytes after a photo line
//! become a photo. The lines to the robot are in `driver`.

use std::time::Duration;

use super::driver::{LineDriver, LinkStage, Open};
use super::from_robot::FromRobot;
use super::numbers::Seq;
use super::picture::{MOST_BYTES, Picture};
use hallsweep_core::event::{Ahead, Obstacle, OffCentre, RobotEvent};
use hallsweep_core::robot::Part;
use hallsweep_core::units::{Now, OrderId};

/// Longest time for skipping the bytes of a photo that was not ordered.
const UNWANTED: Duration = Duration::from_secs(30);

/// Shortest time between two reports of readings. Without it, a sensor that sends all the time would fill the
/// journal.
const READINGS: Duration = Duration::from_millis(500);

/// An order fails after this number of halts in a row that nobody requested.
const UNASKED: u8 = 20;

/// Maximum number of cells along a wall or ahead that is reported to the core. Greater numbers from the robot are
/// reduced to this limit.
const SEEN: u16 = 100;

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
            (_, LinkStage::Down | LinkStage::Greeting(_)) => {}
            (FromRobot::Sonar(cm), LinkStage::Up(_)) => self.sonar = self.has(Part::Sonar).then_some(cm),
            (FromRobot::Temperature(celsius), LinkStage::Up(_)) => {
                // If several temperatures come between two reports, the highest is reported.
                if self.has(Part::Thermometer) {
                    self.temperature = Some(self.temperature.filter(|hotter| *hotter > celsius).unwrap_or(celsius));
                }
            }
            (said, LinkStage::Up(_)) => self.answered(said),
        }
        if self.next_readings().is_some_and(|at| at <= now.since_start) {
            self.tell_readings(now);
        }
    }

    pub(super) fn tell_readings(&mut self, now: Now) {
        self.readings_at = now.since_start + READINGS;
        self.events.extend(self.sonar.take().map(RobotEvent::Sonar));
        self.events.extend(self.temperature.take().map(RobotEvent::Temperature));
    }

    pub(super) fn next_readings(&self) -> Option<Duration> {
        (self.sonar.is_some() || self.temperature.is_some()).then_some(self.readings_at)
    }

    /// Handles an answer to the open order. An answer to an earlier order is ignored.
    fn answered(&mut self, said: FromRobot) {
        match said {
            FromRobot::Done(seq, ahead) => {
                if let Some(id) = self.close_done(seq) {
                    self.unasked = 0;
                    let ahead =
                        ahead.map(|Ahead { free, obstacle }| Ahead { free: free.min(SEEN), obstacle: obstacle.map(seen) });
                    self.events.extend(ahead.map(RobotEvent::Ahead));
                    self.events.push_back(RobotEvent::Done(id));
                }
            }
            FromRobot::Blocked(seq, cm, obstacle) => {
                if let Some(id) = self.close_motion(seq, true) {
                    let cm = cm.filter(|_| self.has(Part::Sonar));
                    self.events.extend(cm.map(|cm| RobotEvent::Sonar(Some(cm))));
                    self.unasked = 0;
                    self.events.push_back(RobotEvent::Blocked(id, seen(obstacle)));
                }
            }
            FromRobot::Halted(seq, off_centre) => self.halted(seq, off_centre),
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

    /// Handles a halt, and counts the halts that nobody requested. A robot halts by itself if it receives no valid
    /// line for a moment. After `UNASKED` such halts in a row the order fails, since the robot would never arrive.
    fn halted(&mut self, seq: Seq, off_centre: OffCentre) {
        let Some((was_halted, is_late)) = self.open.as_ref().map(|open| (open.is_halted, open.is_late)) else { return };
        let Some(id) = self.close_motion(seq, off_centre) else { return };
        self.unasked = if was_halted { 0 } else { self.unasked + 1 };
        if is_late {
            self.events.push_back(RobotEvent::Failed(id, "it did not finish in time and was halted".to_owned()));
        } else if self.unasked >= UNASKED {
            self.unasked = 0;
            self.events.push_back(RobotEvent::Failed(id, "it halts by itself again and again".to_owned()));
        } else {
            self.events.push_back(RobotEvent::Halted(id, off_centre));
        }
    }

    fn close(&mut self, seq: Seq) -> Option<Open> {
        self.open.take_if(|_| seq == self.seq)
    }

    fn close_motion(&mut self, seq: Seq, off_centre: OffCentre) -> Option<OrderId> {
        let open = self.open.take_if(|open| seq == self.seq && open.task.is_motion())?;
        self.off_centre = off_centre;
        Some(open.order.id)
    }

    fn close_done(&mut self, seq: Seq) -> Option<OrderId> {
        let task = self.open.as_ref().map(|open| open.task)?;
        let id = self.close_motion(seq, false)?;
        if let LinkStage::Up(robot) = &mut self.link {
            robot.pose = task.after(robot.pose);
        }
        Some(id)
    }

    /// Begins to receive a photo. If the photo was not ordered, its bytes are skipped, so that they are not read as
    /// lines.
    fn expose(&mut self, seq: Seq, length: u32, crc: u32, now: Now) {
        let wanted = self.open.as_ref().filter(|open| seq == self.seq && !open.task.is_motion());
        let until = wanted.map_or(now.since_start + UNWANTED, |open| open.until);
        let is_wanted = wanted.is_some();
        if (1..=MOST_BYTES).contains(&length) {
            self.picture = Some(Picture::new(length, crc, is_wanted, until));
        } else if is_wanted && let Some(open) = self.close(seq) {
            let why = format!("its photo has {length} bytes, but must have 1 to {MOST_BYTES}");
            self.events.push_back(RobotEvent::PhotoFailed(open.order.id, why));
        }
    }

    pub(super) fn develop(&mut self, now: Now) {
        let Some(picture) = self.picture.take() else { return };
        self.heard = now.since_start;
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

fn seen(obstacle: Obstacle) -> Obstacle {
    match obstacle {
        Obstacle::Wall { left, right } => Obstacle::Wall { left: left.min(SEEN), right: right.min(SEEN) },
        Obstacle::Luggage(_) | Obstacle::Unknown => obstacle,
    }
}
