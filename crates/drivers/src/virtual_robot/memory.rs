//! The stored state of the virtual robot. The robot itself stores nothing, so the next run of the program needs this.
//! It is a line of JSON for a small file.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::motion::{SLOWEST, STEPS, Unheard};
use super::reckoning::Reckoning;
use super::{Aim, Dialect, VirtualRobot};
use hallsweep_core::units::Heading;

const VERSION: u32 = 1;

/// Maximum length of a stored text, in characters. A longer text is cut.
const MOST: usize = 300;

#[derive(Serialize, Deserialize)]
struct Remembered {
    version: u32,
    reckoning: Reckoning,
    step_s: f64,
    /// The time of a step from the settings or the scene file.
    step_set_s: f64,
    is_gauged: bool,
    latency_s: Option<f64>,
    off_centre: bool,
    led: bool,
    unheard: Option<(String, f64, f64)>,
    lost: Option<String>,
}

impl VirtualRobot {
    /// Makes the robot as the last run of the program left it. `written` is the line that the last run stored. A
    /// motion that was running then has ended by itself, without a report.
    ///
    /// # Errors
    /// When the line cannot be used. The error says why.
    pub fn remembering(dialect: Dialect, step: Duration, written: &str) -> Result<VirtualRobot, String> {
        let remembered: Remembered = serde_json::from_str(written).map_err(|error| error.to_string())?;
        if remembered.version != VERSION {
            return Err(format!("its version is {}, but only version {VERSION} is supported", remembered.version));
        }
        let heading = |name: &str| Heading::ALL.into_iter().find(|heading| heading.name() == name);
        let unheard = match remembered.unheard {
            None => None,
            Some((name, cells, felt)) => {
                let sound = [cells, felt].iter().all(|way| (0.0..=100.0).contains(way));
                let towards = heading(&name).filter(|_| sound).ok_or("its last step is not valid")?;
                Some(Unheard { towards, cells, felt })
            }
        };
        let is_measured = |seconds: f64| SLOWEST.as_secs_f64() >= seconds && seconds >= 0.0;
        let step_s = Duration::try_from_secs_f64(remembered.step_s).ok().filter(|step| (STEPS[0]..=STEPS[1]).contains(step));
        let are_times = remembered.latency_s.is_none_or(is_measured) && step_s.is_some();
        if !remembered.reckoning.is_sound() || !are_times {
            return Err("its remembered place is impossible".to_owned());
        }
        // If the setting of the step time has changed, the new setting is used instead of the measured time.
        let is_set_as_before = Duration::try_from_secs_f64(remembered.step_set_s) == Ok(step);
        Ok(VirtualRobot {
            reckoning: remembered.reckoning,
            step: if is_set_as_before { Duration::from_secs_f64(remembered.step_s) } else { step },
            is_gauged: remembered.is_gauged && is_set_as_before,
            latency: remembered.latency_s.map(Duration::from_secs_f64),
            off_centre: remembered.off_centre || unheard.is_some(),
            led: remembered.led,
            unheard,
            lost: remembered.lost.map(|words| words.chars().filter(|letter| !letter.is_control()).take(MOST).collect()),
            ..VirtualRobot::new(dialect, step)
        })
    }

    /// The line to store. A running motion is stored as a motion whose end was not observed, because the next run
    /// cannot observe it. A command that is not confirmed as sent is stored as one that may or may not have arrived.
    pub(super) fn remembered(&self) -> String {
        let mut left = VirtualRobot {
            reckoning: self.reckoning.clone(),
            step: self.step,
            off_centre: self.off_centre,
            unheard: self.unheard,
            lost: self.lost.clone(),
            // With this time, a command that was sent counts as sent long ago.
            now: Duration::MAX,
            ..VirtualRobot::new(self.dialect, self.step)
        };
        left.task = self.task.filter(|task| task.aim != Aim::Draw);
        left.leave_unheard();
        let unheard = left.unheard.map(|unheard| (unheard.towards.name().to_owned(), unheard.cells, unheard.felt));
        let remembered = Remembered {
            version: VERSION,
            reckoning: left.reckoning,
            step_s: self.step.as_secs_f64(),
            step_set_s: self.step_set.as_secs_f64(),
            is_gauged: self.is_gauged,
            latency_s: self.latency.map(|latency| latency.as_secs_f64()),
            off_centre: left.off_centre,
            led: self.led,
            unheard,
            lost: left.lost,
        };
        serde_json::to_string(&remembered).expect("numbers and texts can be written")
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn read(written: &str) -> Result<VirtualRobot, String> {
        VirtualRobot::remembering(Dialect::Semicolons, Duration::from_millis(330), written)
    }

    #[test]
    fn what_is_written_is_read_and_written_alike() {
        let written = VirtualRobot::new(Dialect::Semicolons, Duration::from_millis(330)).remembered();
        assert_eq!(read(&written).map(|robot| robot.remembered()), Ok(written.clone()));
        assert!(read(&written.replace("\"version\":1", "\"version\":2")).is_err_and(|words| words.contains("its version is 2")));
        assert!(read(&written.replace("south", "up")).is_err(), "it faces nowhere");
        assert!(read(&written.replace("\"step_s\":0.33", "\"step_s\":0.0")).is_err(), "nothing takes no time");
    }

    #[test]
    fn a_step_that_is_set_otherwise_counts_and_not_what_was_measured() {
        let robot = VirtualRobot {
            step: Duration::from_millis(300),
            ..VirtualRobot::new(Dialect::Semicolons, Duration::from_millis(330))
        };
        let written = robot.remembered();
        assert_eq!(read(&written).map(|robot| robot.step), Ok(Duration::from_millis(300)));
        let set = VirtualRobot::remembering(Dialect::Semicolons, Duration::from_millis(400), &written);
        assert_eq!(set.map(|robot| robot.step), Ok(Duration::from_millis(400)));
    }

    proptest! {
        #[test]
        fn whatever_is_read_is_an_error_or_a_robot_that_can_be_written(text: String, cut: prop::sample::Index) {
            let _ = read(&text);
            let written = VirtualRobot::new(Dialect::Messages, Duration::from_millis(330)).remembered();
            let _ = read(&written[..cut.index(written.len() + 1)]);
        }
    }
}
