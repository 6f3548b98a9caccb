//! The robot as Home Assistant shows it: a description (`discovery`), and a state. The robot appears as a vacuum
//! cleaner, because that is Home Assistant's kind of robot that drives through rooms. `change_feed` decides when both
//! are published.

pub mod discovery;
#[cfg(test)]
mod tests;

use serde_json::{Value, json};

use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::Cell;

/// Payload on `homeassistant/status` that tells that Home Assistant has started (its birth message).
pub const BIRTH: &[u8] = b"online";

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    pub activity: Activity,
    /// Whether there is an unacknowledged alarm, or a dangerous piece that is not secured.
    pub alarm: bool,
    pub is_exercise: bool,
}

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
    /// The state in JSON, such as `{"state":"cleaning","alarm":false}`.
    pub fn json(self) -> Value {
        let mut state = json!({"state": self.activity.name(), "alarm": self.alarm});
        if self.is_exercise {
            state["exercise"] = true.into();
        }
        state
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

pub fn state(snapshot: &Snapshot) -> State {
    State { activity: activity(snapshot), alarm: is_alarmed(snapshot), is_exercise: snapshot.mission.is_exercise }
}

/// Derives the activity from the phase and the holds. A robot that is under way and held is `Paused`. If START cannot
/// help before something is repaired, the activity is `Error`.
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

const fn must_be_mended(hold: Hold) -> bool {
    match hold {
        Hold::TemperatureStale | Hold::RobotLink | Hold::Store => true,
        Hold::Operator | Hold::TooHigh | Hold::Temperature | Hold::Restart | Hold::Alarm | Hold::AwaitingStart => false,
    }
}

fn is_alarmed(snapshot: &Snapshot) -> bool {
    let is_unseen = snapshot.alarms.iter().any(|alarm| alarm.acknowledged.is_none());
    let is_secured = snapshot.mission.phase == PhaseName::BagSecured;
    // Searches only the sets of dangerous pieces, because searching all luggage at every change would take too long.
    let mut grave = snapshot.luggage.bombs_left().chain(snapshot.luggage.secured());
    is_unseen || (!is_secured && grave.any(|piece| piece.is_dangerous()))
}
