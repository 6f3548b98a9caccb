//! What the console's parts look at: the snapshot in an operator's words. Markup stands in the templates.

use askama::Template;

use crate::core::mission::{Hold, PhaseName};
use crate::core::units::Cell;
use crate::core::world::luggage::Luggage;
use crate::core::world::robot::RobotState;
use crate::core::world::snapshot::Snapshot;
use crate::core::world::temperature::TemperatureStatus;

/// A snapshot, and what is to be said to the one who pressed a button.
pub(super) struct View<'a> {
    pub(super) snapshot: &'a Snapshot,
    pub(super) hall: &'a str,
    pub(super) why: Option<Why>,
}

/// The reason of a refusal, and the button it belongs to; without text it is the place where the script puts one.
#[derive(Clone, Template)]
#[template(source = r#"<p class="why" id="why-{{ button }}" role="alert">{{ text }}</p>"#, ext = "html")]
pub(super) struct Why {
    button: String,
    text: String,
}

impl Why {
    /// This text, beside this button.
    pub(super) fn new(button: &str, text: &str) -> Why {
        Why { button: button.to_owned(), text: text.to_owned() }
    }
}

/// How loud the banner is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mood {
    /// Nothing goes on.
    Calm,
    /// The robot is at work.
    Working,
    /// It stands, or waits for somebody.
    Held,
    /// A bomb, or a fault.
    Alarm,
}

impl Mood {
    /// The class of the banner.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Mood::Calm => "calm",
            Mood::Working => "working",
            Mood::Held => "held",
            Mood::Alarm => "alarm",
        }
    }
}

impl View<'_> {
    /// What was refused at this button, or the empty place for it.
    pub(super) fn why(&self, button: &str) -> Why {
        self.why.clone().filter(|why| why.button == button).unwrap_or_else(|| Why::new(button, ""))
    }

    /// What the mission does, in words.
    pub(super) fn phase(&self) -> String {
        let mission = &self.snapshot.mission;
        let waits = self.snapshot.pending().filter(|_| mission.phase == PhaseName::Inspecting);
        match (waits, mission.interrupted) {
            (Some(luggage), _) => format!("luggage #{} waits for your verdict", luggage.id),
            (None, Some(interrupted)) => format!("{} (was {})", mission.phase.in_words(), interrupted.in_words()),
            (None, None) => mission.phase.in_words().to_owned(),
        }
    }

    /// Whether the mission would go on, were it not held.
    pub(super) fn is_halted(&self) -> bool {
        !self.snapshot.mission.holds.is_empty() && self.mood() != Mood::Calm && self.waiting().is_none()
    }

    /// Whether the robot stands.
    pub(super) fn is_still(&self) -> bool {
        self.snapshot.robot.state == RobotState::Stopped
    }

    /// Whether anything has been searched yet.
    pub(super) fn is_begun(&self) -> bool {
        self.snapshot.mission.phase != PhaseName::Idle || self.snapshot.mission.progress.visited > 1
    }

    /// What holds the robot, in words, each with what to do about it.
    pub(super) fn holds(&self) -> Vec<&'static str> {
        self.snapshot.mission.holds.iter().map(|hold| hold.in_words()).collect()
    }

    /// How loud the banner is to be.
    pub(super) fn mood(&self) -> Mood {
        let mission = &self.snapshot.mission;
        let mood = match mission.phase {
            PhaseName::Fault | PhaseName::ReturningWithAlarm | PhaseName::BombLocated => Mood::Alarm,
            PhaseName::Idle | PhaseName::AtHome | PhaseName::BagSecured | PhaseName::Explored => Mood::Calm,
            PhaseName::Exploring
            | PhaseName::Inspecting
            | PhaseName::Driving
            | PhaseName::ReturningHome
            | PhaseName::Retrieving => Mood::Working,
        };
        let is_held = !mission.holds.is_empty() || self.waiting().is_some();
        if is_held && mood != Mood::Alarm { Mood::Held } else { mood }
    }

    /// The sentence for those who listen instead of looking.
    pub(super) fn announcement(&self) -> String {
        let mut words = vec![sentence(&self.phase())];
        let mission = &self.snapshot.mission;
        words.extend(mission.fault.iter().map(|fault| sentence(fault)));
        if mission.phase != PhaseName::Inspecting {
            words.extend(self.waiting().map(|luggage| format!("Luggage #{} waits for your verdict.", luggage.id)));
        }
        words.extend(mission.holds.first().map(|hold| sentence(hold.in_words())));
        words.extend(self.snapshot.alarms.iter().filter(|alarm| alarm.acknowledged.is_none()).map(|alarm| sentence(&alarm.text)));
        words.join(" ")
    }

    /// The title of the window, so that another window does not hide what matters.
    pub(super) fn title(&self) -> String {
        let sign = match self.mood() {
            Mood::Alarm => "⚠ ",
            Mood::Held => "‖ ",
            Mood::Working => "▶ ",
            Mood::Calm => "",
        };
        format!("{sign}{} · hallsweep", self.phase())
    }

    /// The piece that waits for its verdict.
    pub(super) fn waiting(&self) -> Option<&Luggage> {
        self.snapshot.pending().map(|luggage| &**luggage)
    }

    /// What START is called just now.
    pub(super) fn start_label(&self) -> &'static str {
        let mission = &self.snapshot.mission;
        match mission.phase {
            PhaseName::Explored | PhaseName::BagSecured => "START anew",
            PhaseName::AtHome | PhaseName::Fault => "CONTINUE",
            PhaseName::Idle => "START",
            PhaseName::Exploring
            | PhaseName::Inspecting
            | PhaseName::Driving
            | PhaseName::ReturningHome
            | PhaseName::ReturningWithAlarm
            | PhaseName::BombLocated
            | PhaseName::Retrieving => {
                if mission.holds.is_empty() {
                    "START"
                } else {
                    "CONTINUE"
                }
            }
        }
    }

    /// Whether RETRIEVE has a meaning now.
    pub(super) fn shows_retrieve(&self) -> bool {
        matches!(self.snapshot.mission.phase, PhaseName::BombLocated | PhaseName::Retrieving)
    }

    /// The robot's state in words.
    pub(super) const fn robot_state(&self) -> &'static str {
        match self.snapshot.robot.state {
            RobotState::Stopped => "stands still",
            RobotState::MovingForward => "moves forward",
            RobotState::MovingBackward => "moves backward",
            RobotState::RotateLeft => "turns left",
            RobotState::RotateRight => "turns right",
            RobotState::TakingPhoto => "takes a photo",
            RobotState::SendingPhoto => "sends the photo",
        }
    }

    /// The last reading, or a dash of the same width.
    pub(super) fn celsius(&self) -> String {
        self.snapshot.temperature.celsius.map_or_else(|| "– °C".to_owned(), |celsius| celsius.to_string())
    }

    /// What the temperature means, in words.
    pub(super) fn temperature_words(&self) -> &'static str {
        let view = &self.snapshot.temperature;
        match view.status {
            TemperatureStatus::Ok => "ok",
            TemperatureStatus::TooHigh if self.declared_too_high() => "too high by an operator's word: press OK to take it back",
            TemperatureStatus::TooHigh if view.celsius.is_some_and(|celsius| celsius <= view.threshold) => {
                "too high: not every reading has fallen far enough"
            }
            TemperatureStatus::TooHigh => "too high: nothing moves",
            TemperatureStatus::Stale => "sensor silent: nothing moves",
        }
    }

    /// Whether the button TOO HIGH stands.
    pub(super) fn declared_too_high(&self) -> bool {
        self.snapshot.mission.holds.contains(&Hold::TooHigh)
    }

    /// How many alarms nobody has seen yet.
    pub(super) fn unseen_alarms(&self) -> usize {
        self.snapshot.alarms.iter().filter(|alarm| alarm.acknowledged.is_none()).count()
    }

    /// Cells known to be there: visited ones and those still to be visited.
    pub(super) const fn cells(&self) -> usize {
        let progress = self.snapshot.mission.progress;
        progress.visited + progress.unknown
    }
}

/// A cell in words: `column 3, row 4`.
pub(super) fn place(cell: Cell) -> String {
    format!("column {}, row {}", cell.x, cell.y)
}

fn sentence(words: &str) -> String {
    let mut letters = words.chars();
    let first: String = letters.next().map(|letter| letter.to_uppercase().collect()).unwrap_or_default();
    format!("{first}{}.", letters.as_str().trim_end_matches('.'))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::fixture::{idle, searching};

    #[test]
    fn a_waiting_piece_is_what_is_said_first() {
        let snapshot = searching();
        let view = View { snapshot: &snapshot, hall: "airport", why: None };
        assert_eq!(view.mood(), Mood::Held);
        assert_eq!(view.announcement(), "Luggage #3 waits for your verdict. Luggage #2 is dangerous.");
        assert_eq!(view.title(), "‖ luggage #3 waits for your verdict · hallsweep");
    }

    #[test]
    fn a_refusal_is_shown_at_its_own_button_only_and_escaped() {
        let snapshot = idle();
        let view = View { snapshot: &snapshot, hall: "airport", why: Some(Why::new("start", "a < b")) };
        assert!(view.why("start").to_string().contains("a &#60; b"));
        assert_eq!(view.why("reset").text, "");
    }
}
