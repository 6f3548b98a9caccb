//! The robot in the words of Home Assistant: what it is told of it (`discovery`), and the state of a vacuum cleaner, which is how it
//! shows a robot that drives through a hall. When it is told stands in `change_feed`.

pub mod discovery;
#[cfg(test)]
mod tests;

use serde_json::{Value, json};

use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::Cell;

/// What Home Assistant says when it has started.
pub const BIRTH: &[u8] = b"online";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    pub activity: Activity,
    /// Whether an alarm stands that nobody has acknowledged, or a dangerous piece that is not secured.
    pub alarm: bool,
}

/// What a vacuum cleaner can do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Activity {
    Cleaning,
    Docked,
    Paused,
    Idle,
    Returning,
    Error,
}

impl State {
    /// `{"state":"cleaning","alarm":false}`.
    pub fn json(self) -> Value {
        json!({"state": self.activity.name(), "alarm": self.alarm})
    }
}

impl Activity {
    pub const fn name(self) -> &'static str {
        match self {
            Activity::Cleaning => "cleaning",
            Activity::Docked => "docked",
            Activity::Paused => "paused",
            Activity::Idle => "idle",
            Activity::Returning => "returning",
            Activity::Error => "error",
        }
    }
}

/// What Home Assistant is shown of this state.
pub fn state(snapshot: &Snapshot) -> State {
    State { activity: activity(snapshot), alarm: is_alarmed(snapshot) }
}

/// The phase first. A mission that is held is paused, unless START cannot help before something is mended.
fn activity(snapshot: &Snapshot) -> Activity {
    let under_way = match snapshot.mission.phase {
        PhaseName::Exploring | PhaseName::Inspecting | PhaseName::Driving | PhaseName::Retrieving => Activity::Cleaning,
        PhaseName::ReturningHome | PhaseName::ReturningWithAlarm => Activity::Returning,
        PhaseName::AtHome | PhaseName::BombLocated | PhaseName::BagSecured | PhaseName::Explored => Activity::Docked,
        PhaseName::Idle if snapshot.robot.pose.cell == Cell::HOME => Activity::Docked,
        PhaseName::Idle => Activity::Idle,
        PhaseName::Fault => Activity::Error,
    };
    if snapshot.mission.holds.iter().any(|hold| must_be_mended(*hold)) {
        return Activity::Error;
    }
    let is_held = !snapshot.mission.holds.is_empty() && matches!(under_way, Activity::Cleaning | Activity::Returning);
    if is_held { Activity::Paused } else { under_way }
}

/// Whether a hold ends only when somebody mends something.
const fn must_be_mended(hold: Hold) -> bool {
    match hold {
        Hold::TemperatureStale | Hold::RobotLink | Hold::Store => true,
        Hold::Operator | Hold::TooHigh | Hold::Temperature | Hold::Restart | Hold::Alarm | Hold::AwaitingStart => false,
    }
}

fn is_alarmed(snapshot: &Snapshot) -> bool {
    let is_unseen = snapshot.alarms.iter().any(|alarm| alarm.acknowledged.is_none());
    let is_secured = snapshot.mission.phase == PhaseName::BagSecured;
    // Of all luggage, only what is at hand: this is asked at every change.
    let mut grave = snapshot.luggage.bombs_left().chain(snapshot.luggage.secured());
    is_unseen || (!is_secured && grave.any(|piece| piece.is_dangerous()))
}
