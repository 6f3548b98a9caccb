//! What the console's parts look at: the snapshot in an operator's words. Markup stands in the templates.

mod progress;

use std::sync::Arc;

use askama::Template;
use serde::Serialize;

use super::retrieval::{secured_in_words, wanted_of_the_operator};
use super::timeline::Timeline;
use crate::access::{Need, Role};
use crate::api::robot_parts::RobotBySettings;
use crate::api::time::Zone;
use crate::doors::http::HttpDoor;
use crate::phrases::{Language, Phrase};
use hallsweep_core::command::Refused;
use hallsweep_core::event::RobotId;
use hallsweep_core::mission::{Hold, PhaseName};
use hallsweep_core::units::{Cell, Celsius, WallTime};
use hallsweep_core::world::luggage::{Luggage, PhotoState};
use hallsweep_core::world::robot::{RobotState, RobotView};
use hallsweep_core::world::snapshot::Snapshot;
use hallsweep_core::world::temperature::{OPERATOR, TemperatureStatus};

/// A snapshot, and what is to be said to the one who pressed a button.
pub(super) struct View<'a> {
    pub(super) snapshot: &'a Snapshot,
    pub(super) hall: HallInfo<'a>,
    /// When the present mission began, where that is known.
    pub(super) began: Option<WallTime>,
    /// Who looks; `None` where nobody is asked who he is.
    pub(super) who: Option<Who>,
    /// The language of whoever looks.
    pub(super) language: Language,
    pub(super) why: Option<Why>,
    pub(super) now: WallTime,
    /// The line of time of the mission that is shown.
    pub(super) line: Option<&'a Timeline>,
    /// The moment of the past that is shown; `None`: now.
    pub(super) then: Option<Then>,
}

/// A moment of the past.
#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Then {
    pub(super) mission: u64,
    /// The entry after which everything stood as is shown; when it was written, in milliseconds since 1970; and those beside it.
    pub(super) seq: u64,
    pub(super) time: i64,
    pub(super) earlier: Option<u64>,
    pub(super) later: Option<u64>,
}

/// What is known beforehand of the hall, and of the robot that searches it.
#[derive(Clone, Debug)]
pub(super) struct HallInfo<'a> {
    pub(super) name: Arc<str>,
    /// The side of a cell, in metres, where it is known.
    pub(super) cell_m: Option<f64>,
    /// How far away from a bomb people must be, in metres.
    pub(super) evacuation_m: f64,
    /// What is set of the robot, where it is known.
    pub(super) robot: Option<&'a RobotBySettings>,
}

impl<'a> HallInfo<'a> {
    pub(super) fn of(door: &'a HttpDoor) -> HallInfo<'a> {
        let (name, cell_m) = door.hall();
        HallInfo { name, cell_m, evacuation_m: door.evacuation_m, robot: door.robots.of(RobotId::discovery().name()) }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Who {
    pub(super) name: Arc<str>,
    pub(super) role: Role,
}

/// Why a viewer's buttons are dead.
const VIEWER: &str = "you are signed in as a viewer";

/// Why everybody's are.
const PAST: &str = "this is the past: go back to now first";

/// The reason of a refusal, and the button it belongs to; without text it is the place where the script puts one.
#[derive(Clone, Template)]
#[template(source = r#"<p class="why" id="why-{{ button }}" role="alert">{{ text }}</p>"#, ext = "html")]
pub(super) struct Why {
    button: String,
    text: String,
}

impl Why {
    pub(super) fn new(button: &str, text: &str) -> Why {
        Why { button: button.to_owned(), text: text.to_owned() }
    }
}

/// How loud the banner is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mood {
    Calm,
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
    /// The phrase with this id, in the language of whoever looks.
    pub(super) const fn say<'p>(&self, id: &'p str) -> Phrase<'p> {
        self.language.say(id)
    }

    /// Whether the robot that searches is simulated.
    pub(super) fn is_simulated(&self) -> bool {
        self.hall.robot.is_some_and(|robot| robot.kind == "sim")
    }

    /// What was refused at this button, or the empty place for it.
    pub(super) fn why(&self, button: &str) -> Why {
        self.why.clone().filter(|why| why.button == button).unwrap_or_else(|| Why::new(button, ""))
    }

    /// Why a button is dead: its own reason, or that whoever looks may only look.
    pub(super) fn bar(&self, refusal: &Option<Refused>) -> Option<String> {
        self.looks_only().map(str::to_owned).or_else(|| refusal.as_ref().map(Refused::to_string))
    }

    /// Why every button but STOP is dead: in the past, and for whoever may only look.
    pub(super) fn looks_only(&self) -> Option<&'static str> {
        if self.then.is_some() {
            return Some(PAST);
        }
        self.who.as_ref().filter(|who| !who.role.may(Need::Act)).map(|_| VIEWER)
    }

    pub(super) fn phase(&self) -> String {
        let mission = &self.snapshot.mission;
        let waits = self.snapshot.pending().filter(|_| mission.phase == PhaseName::Inspecting);
        match (waits, mission.interrupted) {
            (Some(luggage), _) => format!("luggage #{} waits for your verdict", luggage.id),
            (None, Some(interrupted)) => format!("{} (was {})", mission.phase.in_words(), interrupted.in_words()),
            (None, None) => mission.phase.in_words().to_owned(),
        }
    }

    /// What lets a retrieval go on that stands still.
    pub(super) fn wanted(&self) -> Option<&'static str> {
        let mission = &self.snapshot.mission;
        if mission.phase == PhaseName::Retrieving { wanted_of_the_operator(&mission.holds) } else { None }
    }

    /// Whether there are robots that fetch.
    pub(super) fn has_carriers(&self) -> bool {
        self.snapshot.robots.len() > 1
    }

    /// Whether the mission would go on, were it not held.
    pub(super) fn is_halted(&self) -> bool {
        !self.snapshot.mission.holds.is_empty() && self.mood() != Mood::Calm && self.waiting().is_none()
    }

    /// Whether all robots stand, those that fetch too.
    pub(super) fn is_still(&self) -> bool {
        let stands = |view: &RobotView| view.state == RobotState::Stopped && !view.halting;
        stands(&self.snapshot.robot) && self.snapshot.robots.iter().all(|robot| stands(&robot.view))
    }

    /// When the moment of the past was that is shown.
    pub(super) fn then_at(&self) -> Option<String> {
        self.then.map(|_| self.zone().clock_time(self.now))
    }

    /// The zone of every time on the page.
    pub(super) const fn zone(&self) -> Zone {
        Zone::of(self.now)
    }

    /// What holds the robot, in words, each with what to do about it.
    pub(super) fn holds(&self) -> Vec<String> {
        let heat = self.hot();
        let words = |hold: &Hold| match (hold, self.snapshot.mission.phase) {
            (Hold::Alarm, PhaseName::Retrieving) => "the robots that fetch have called: acknowledge their alarm first".to_owned(),
            // There it is RETRIEVE, or RESET, and not START.
            (Hold::RobotLink, _) if let Some(why) = self.unreached() => format!("{}: {why}", hold.in_words()),
            (Hold::AwaitingStart, PhaseName::BombLocated) => "waiting for the operator".to_owned(),
            (Hold::Temperature, _) if !heat.is_empty() => {
                let hot: Vec<String> = heat.iter().map(|(source, reading)| format!("{source} {reading}")).collect();
                format!("too hot: {}; {} or less is wanted", hot.join(", "), self.snapshot.temperature.cool)
            }
            (hold, _) => hold.in_words().to_owned(),
        };
        self.snapshot.mission.holds.iter().map(words).collect()
    }

    /// Why nothing can be recorded, while that is so; without a full stop.
    pub(super) fn unrecorded(&self) -> Option<&str> {
        self.snapshot.mission.store_failure.as_deref().map(|words| words.trim_end_matches('.'))
    }

    /// What is to be done next, in the phases in which the robot waits for it and no button by itself says so.
    pub(super) fn next_step(&self) -> Option<String> {
        match self.snapshot.mission.phase {
            PhaseName::BombLocated => {
                let bomb = self.snapshot.luggage.bombs_left().next();
                let at =
                    bomb.map_or_else(String::new, |bomb| format!("Luggage #{} at {} is dangerous. ", bomb.id, place(bomb.cell)));
                let next = if self.unseen_alarms() > 0 { "acknowledge the alarm, then press RESET" } else { "press RESET" };
                let fetch = if self.may_retrieve() { "RETRIEVE has it brought into the container. " } else { "" };
                Some(format!("{at}{fetch}When the hall is safe again, {next} to put this mission away."))
            }
            PhaseName::BagSecured => {
                let secured = secured_in_words(self.snapshot.luggage.secured().map(|luggage| &**luggage))?;
                Some(format!("{}. START begins a new search, RESET puts this mission away.", capital(&secured)))
            }
            PhaseName::Explored => {
                Some("The whole hall has been searched. START searches it anew, RESET puts this mission away.".into())
            }
            PhaseName::Idle
            | PhaseName::Exploring
            | PhaseName::Inspecting
            | PhaseName::Driving
            | PhaseName::ReturningHome
            | PhaseName::AtHome
            | PhaseName::ReturningWithAlarm
            | PhaseName::Retrieving
            | PhaseName::Fault => None,
        }
    }

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
        words.extend(self.holds().first().map(|hold| sentence(hold)));
        words.extend(self.next_step());
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

    /// Whether START is what an operator would press next: it is possible, and the robot is not on its way already.
    pub(super) fn start_is_next(&self) -> bool {
        let mission = &self.snapshot.mission;
        let on_its_way = match mission.phase {
            PhaseName::Exploring
            | PhaseName::Inspecting
            | PhaseName::ReturningHome
            | PhaseName::ReturningWithAlarm
            | PhaseName::Retrieving => mission.holds.is_empty(),
            PhaseName::Driving => !self.is_still(),
            PhaseName::Idle
            | PhaseName::AtHome
            | PhaseName::BombLocated
            | PhaseName::BagSecured
            | PhaseName::Explored
            | PhaseName::Fault => false,
        };
        self.bar(&mission.refusals.start).is_none() && !on_its_way
    }

    pub(super) fn shows_retrieve(&self) -> bool {
        self.snapshot.mission.phase == PhaseName::BombLocated && self.looks_only().is_none()
    }

    fn may_retrieve(&self) -> bool {
        self.shows_retrieve() && self.snapshot.mission.refusals.retrieve.is_none()
    }

    /// The reading that matters: the hottest of those that are too hot, else the last; or that there is none.
    pub(super) fn celsius(&self) -> String {
        let hottest = self.hot().iter().map(|(_, reading)| *reading).max_by(|a, b| a.degrees().total_cmp(&b.degrees()));
        hottest.or(self.snapshot.temperature.celsius).map_or_else(|| "no reading".to_owned(), |celsius| celsius.to_string())
    }

    pub(super) fn temperature_words(&self) -> &'static str {
        match self.snapshot.temperature.status {
            TemperatureStatus::Ok if self.snapshot.temperature.celsius.is_none() => {
                "no thermometer was read: nobody says how warm it is"
            }
            TemperatureStatus::Ok => "ok",
            TemperatureStatus::TooHigh if self.declared_too_high() => "too high by an operator's word: press OK to take it back",
            TemperatureStatus::TooHigh => "too high: nothing moves",
            TemperatureStatus::Stale => "sensor silent: nothing moves",
        }
    }

    /// Every reading that keeps the hall too hot, and what ends it.
    pub(super) fn heat(&self) -> Vec<String> {
        let cool = self.snapshot.temperature.cool;
        let words = |source: &str, reading: Celsius| match source {
            OPERATOR => format!("An operator reported {reading}. It counts until a reading of {cool} or less is reported."),
            sensor => format!("{} reads {reading}. It must fall to {cool} or less.", capital(sensor)),
        };
        self.hot().iter().map(|(source, reading)| words(source, *reading)).collect()
    }

    fn hot(&self) -> &[(Arc<str>, Celsius)] {
        &self.snapshot.temperature.hot
    }

    pub(super) fn declared_too_high(&self) -> bool {
        self.snapshot.mission.holds.contains(&Hold::TooHigh)
    }

    /// Whether a reading, and no button, says that it is not too hot.
    pub(super) fn reads_ok(&self) -> bool {
        self.snapshot.temperature.status == TemperatureStatus::Ok && self.snapshot.temperature.celsius.is_some()
    }

    /// How long ago a moment was, as `0:14`.
    pub(super) fn gone(&self, since: &WallTime) -> String {
        let seconds = self.now.unix_ms.saturating_sub(since.unix_ms).max(0) / 1000;
        format!("{}:{:02}", seconds / 60, seconds % 60)
    }

    pub(super) fn unseen_alarms(&self) -> usize {
        self.snapshot.alarms.iter().filter(|alarm| alarm.acknowledged.is_none()).count()
    }
}

/// A cell in words: `column 3, row 4`.
pub(super) fn place(cell: Cell) -> String {
    format!("column {}, row {}", cell.x, cell.y)
}

/// Why there is no photo, where there is none.
pub(super) fn failure(luggage: &Luggage) -> &str {
    match &luggage.photo {
        PhotoState::Taken { .. } => "",
        PhotoState::Failed(reason) => reason,
    }
}

fn sentence(words: &str) -> String {
    format!("{}.", capital(words.trim_end_matches('.')))
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    let first: String = letters.next().map(|letter| letter.to_uppercase().collect()).unwrap_or_default();
    format!("{first}{}", letters.as_str())
}

#[cfg(test)]
#[path = "view_tests.rs"]
mod tests;
