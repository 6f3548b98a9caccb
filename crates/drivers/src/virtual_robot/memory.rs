//! What the next program must know of the virtual robot, which itself knows nothing: as a line of JSON, for a small file.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use super::reckoning::Reckoning;
use super::{Aim, Dialect, VirtualRobot};
use hallsweep_core::units::Heading;

/// The version of what is written.
const VERSION: u32 = 1;

/// Steps quicker or slower than these are none.
const STEPS: std::ops::RangeInclusive<f64> = 0.02..=10.0;

/// A step that nobody has heard the end of: which way, how far it was to go, and how far it has felt ahead since.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unheard {
    pub(super) towards: Heading,
    pub(super) cells: f64,
    pub(super) felt: f64,
}

#[derive(Serialize, Deserialize)]
struct Remembered {
    version: u32,
    reckoning: Reckoning,
    step_s: f64,
    latency_s: Option<f64>,
    off_centre: bool,
    unheard: Option<(String, f64, f64)>,
    lost: Option<String>,
}

impl VirtualRobot {
    /// As the last program left it, which wrote this; what was under way then has ended by itself, and nobody has heard how.
    ///
    /// # Errors
    /// Why what was written cannot be used, in words.
    pub fn remembering(dialect: Dialect, step: Duration, written: &str) -> Result<VirtualRobot, String> {
        let remembered: Remembered = serde_json::from_str(written).map_err(|error| error.to_string())?;
        if remembered.version != VERSION {
            return Err(format!("it is of version {}, and {VERSION} is known", remembered.version));
        }
        let heading = |name: &str| Heading::ALL.into_iter().find(|heading| heading.name() == name);
        let unheard = match remembered.unheard {
            None => None,
            Some((name, cells, felt)) => {
                let sound = [cells, felt].iter().all(|way| (0.0..=100.0).contains(way));
                let towards = heading(&name).filter(|_| sound).ok_or("its last step is none")?;
                Some(Unheard { towards, cells, felt })
            }
        };
        let latency = remembered.latency_s.map(|seconds| Duration::try_from_secs_f64(seconds).map_err(|error| error.to_string()));
        if !remembered.reckoning.is_sound() || !STEPS.contains(&remembered.step_s) {
            return Err("it says that the robot stands where none can be".to_owned());
        }
        Ok(VirtualRobot {
            reckoning: remembered.reckoning,
            step: Duration::from_secs_f64(remembered.step_s),
            latency: latency.transpose()?,
            off_centre: remembered.off_centre || unheard.is_some(),
            unheard,
            lost: remembered.lost,
            ..VirtualRobot::new(dialect, step)
        })
    }

    /// What is to be written. What is under way is written as if its end were not heard: so it is when this is read.
    pub(super) fn remembered(&self) -> String {
        let mut left = VirtualRobot {
            reckoning: self.reckoning.clone(),
            step: self.step,
            off_centre: self.off_centre,
            unheard: self.unheard,
            now: self.now,
            ..VirtualRobot::new(self.dialect, self.step)
        };
        left.task = self.task_at_death();
        left.leave_unheard();
        let unheard = left.unheard.map(|unheard| (unheard.towards.name().to_owned(), unheard.cells, unheard.felt));
        let remembered = Remembered {
            version: VERSION,
            reckoning: left.reckoning,
            step_s: self.step.as_secs_f64(),
            latency_s: self.latency.map(|latency| latency.as_secs_f64()),
            off_centre: left.off_centre,
            unheard,
            lost: self.lost.clone(),
        };
        serde_json::to_string(&remembered).expect("numbers and texts can be written")
    }

    /// The task as it is when the program dies: what is on its way to the robot was sent.
    fn task_at_death(&self) -> Option<super::Task> {
        let task = self.task.as_ref().filter(|task| task.aim != Aim::Draw)?;
        let leg = task.leg.map(|leg| match leg.stage {
            super::Stage::Queued => super::Leg { stage: super::Stage::Sent(self.now), ..leg },
            _ => leg,
        });
        Some(super::Task { order: task.order, deadline: task.deadline, aim: task.aim, leg, hindered: 0 })
    }
}
