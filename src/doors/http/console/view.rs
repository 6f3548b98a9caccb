//! The data that the console's parts show: the snapshot in an operator's words. The templates have the markup.

mod announced;
mod progress;
mod temperature;

use std::borrow::Cow;
use std::sync::Arc;

use askama::Template;
use serde::Serialize;

use super::retrieval::{stage, stages, wanted_of_the_operator};
use super::timeline::Timeline;
use crate::access::{Need, Role};
use crate::api::time::Zone;
use crate::doors::http::HttpDoor;
use crate::phrases::{Language, Phrase};
use hallsweep_core::hold::Hold;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::refused::Refused;
use hallsweep_core::robot::RobotState;
use hallsweep_core::settings::{AfterDanger, HotRule, Rules, SafeBy};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::snapshot::robot::RobotView;
use hallsweep_core::state::{Conditions, Participant, Venue};
use hallsweep_core::units::{Cell, LuggageId, WallTime};
use hallsweep_core::world::luggage::{Luggage, PhotoState};
use hallsweep_core::world::temperature::SourceReading;

pub(super) struct View<'a> {
    pub(super) snapshot: &'a Snapshot,
    pub(super) hall: HallInfo,
    pub(super) began: Option<WallTime>,
    /// Who reads the page. `None` if the program requires no keys.
    pub(super) who: Option<Who>,
    pub(super) language: Language,
    pub(super) why: Option<Why>,
    pub(super) now: WallTime,
    pub(super) line: Option<&'a Timeline>,
    /// The moment of the past that is shown, or `None` for the present.
    pub(super) then: Option<Then>,
}

#[derive(Clone, Copy, Debug, Serialize)]
pub(super) struct Then {
    pub(super) mission: u64,
    /// The shown state is the state after the entry `seq`, at the time `time` in milliseconds since 1970.
    /// `earlier` and `later` are the neighbouring entries.
    pub(super) seq: u64,
    pub(super) time: i64,
    pub(super) earlier: Option<u64>,
    pub(super) later: Option<u64>,
}

#[derive(Clone, Debug)]
pub(super) struct HallInfo {
    pub(super) name: Arc<str>,
    /// Side length of a cell in metres, if it is known.
    pub(super) cell_m: Option<f64>,
    /// Whether the positions on the map come from driving times alone, without measured distances.
    pub(super) is_reckoned: bool,
    /// Distance that people must keep from a bomb, in metres.
    pub(super) evacuation_m: f64,
    pub(super) is_paused: bool,
    pub(super) robot: Option<Participant>,
    /// The rules of the team.
    pub(super) rules: Rules,
}

impl HallInfo {
    pub(super) fn of(door: &HttpDoor) -> HallInfo {
        let (name, cell_m) = door.hall.place();
        let is_paused = door.hall.simulator.as_ref().is_some_and(|simulator| simulator.watch().borrow().is_paused);
        let (is_reckoned, evacuation_m) = (door.hall.is_reckoned, door.hall.evacuation_m);
        HallInfo {
            name,
            cell_m,
            is_reckoned,
            evacuation_m,
            is_paused,
            robot: door.hall.robots.first().cloned(),
            rules: door.hall.settings.rules,
        }
    }

    /// Returns the hall as described by the recorded conditions. Without recorded conditions it returns the present
    /// hall without a robot.
    pub(super) fn under(door: &HttpDoor, conditions: Option<&Conditions>) -> HallInfo {
        let now = HallInfo { is_paused: false, robot: None, ..HallInfo::of(door) };
        match conditions {
            Some(Conditions { venue: Venue { name, cell_m, is_reckoned, robots, .. }, rules, .. }) => {
                let robot = robots.first().cloned();
                HallInfo { name: Arc::clone(name), cell_m: *cell_m, is_reckoned: *is_reckoned, robot, rules: *rules, ..now }
            }
            None => now,
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Who {
    pub(super) name: Arc<str>,
    pub(super) role: Role,
}

/// The reason for a refusal, shown beside the pressed button. If `text` is empty, the element only marks the place
/// where the script writes a reason.
#[derive(Clone, Template)]
#[template(source = r#"<p class="why" id="why-{{ button }}" role="alert">{{ text }}</p>"#, ext = "html")]
pub(super) struct Why {
    pub(super) button: String,
    text: String,
}

impl Why {
    pub(super) fn new(button: &str, text: &str) -> Why {
        Why { button: button.to_owned(), text: text.to_owned() }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mood {
    Calm,
    Working,
    /// A hold stops the robot, or a piece of luggage waits for a verdict.
    Held,
    /// There is a bomb or a fault.
    Alarm,
}

impl Mood {
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
    pub(super) const fn say<'p>(&self, id: &'p str) -> Phrase<'p> {
        self.language.say(id)
    }

    pub(super) const fn say_of<'p>(&self, family: &'p str, member: &'p str) -> Phrase<'p> {
        self.language.say_of(family, member)
    }

    pub(super) fn place(&self, cell: Cell) -> String {
        self.language.place(cell)
    }

    /// Returns which pieces are in the container, such as `luggage #1 is in the container`.
    fn secured(&self) -> Option<String> {
        let ids: Vec<LuggageId> = self.snapshot.luggage.secured().map(|piece| piece.id).collect();
        match ids.as_slice() {
            [] => None,
            [only] => Some(self.say("secured-one").with("id", only).to_string()),
            ids => {
                let named: Vec<String> = ids.iter().map(|id| format!("#{id}")).collect();
                Some(self.say("secured-many").with("ids", self.language.list(&named)).to_string())
            }
        }
    }

    pub(super) fn is_simulated(&self) -> bool {
        self.hall.robot.as_ref().is_some_and(|robot| &*robot.kind == "sim")
    }

    /// Returns the kind of the searching robot. For the past, the text may say that the kind was not recorded.
    pub(super) fn engine(&self) -> Option<Phrase<'_>> {
        let is_known = self.hall.robot.is_some() || self.then.is_some();
        is_known.then(|| self.language.engine(self.hall.robot.as_ref()))
    }

    pub(super) fn why(&self, button: &str) -> Why {
        self.why.clone().filter(|why| why.button == button).unwrap_or_else(|| Why::new(button, ""))
    }

    /// Returns why a button is disabled: its command would be refused, or the reader may only look.
    pub(super) fn bar(&self, refusal: &Option<Refused>) -> Option<String> {
        self.looks_only().or_else(|| refusal.as_ref().map(|refused| self.language.refused(refused)))
    }

    /// Returns why every button except STOP is disabled: the page shows the past, or the reader is a viewer.
    pub(super) fn looks_only(&self) -> Option<String> {
        if self.then.is_some() {
            return Some(self.say("dead-past").to_string());
        }
        self.is_viewer().then(|| self.say("dead-viewer").to_string())
    }

    pub(super) fn is_viewer(&self) -> bool {
        self.who.as_ref().is_some_and(|who| !who.role.may(Need::Act))
    }

    pub(super) fn phase(&self) -> String {
        let mission = &self.snapshot.mission;
        let waits = self.snapshot.pending().filter(|_| mission.phase == PhaseName::Inspecting);
        match (waits, mission.interrupted) {
            (Some(luggage), _) => {
                let said = if self.then.is_none() { self.say("piece-waits") } else { self.say("piece-waited") };
                said.with("id", luggage.id).to_string()
            }
            (None, interrupted) => self.language.phase_and_before(mission.phase, interrupted),
        }
    }

    /// Returns the stage of a retrieval that is under way. A robot that fetches alone makes no room, so there is no name for
    /// the stage before it sets out.
    pub(super) fn stage(&self) -> Option<Phrase<'_>> {
        let retrieval = self.snapshot.retrieval.as_ref().filter(|_| self.snapshot.mission.phase == PhaseName::Retrieving)?;
        stages(retrieval.fetcher).contains(&retrieval.stage).then(|| stage(self.language, retrieval.fetcher, retrieval.stage))
    }

    pub(super) fn wanted(&self) -> Option<Phrase<'static>> {
        let goes_on = self.snapshot.mission.phase == PhaseName::Retrieving && self.then.is_none();
        goes_on.then(|| wanted_of_the_operator(&self.snapshot.mission.holds)).flatten().map(|id| self.say_of("wanted", id))
    }

    pub(super) fn is_fetching(&self) -> bool {
        self.snapshot.retrieval.is_some()
    }

    pub(super) fn has_carriers(&self) -> bool {
        self.snapshot.robots.len() > 1
    }

    /// Whether the mission is halted by holds and would continue without them.
    pub(super) fn is_halted(&self) -> bool {
        !self.snapshot.mission.holds.is_empty() && self.mood() != Mood::Calm && self.waiting().is_none()
    }

    pub(super) fn is_still(&self) -> bool {
        let stands = |view: &RobotView| view.state == RobotState::Stopped && !view.halting;
        stands(&self.snapshot.robot) && self.snapshot.robots.iter().all(|robot| stands(&robot.view))
    }

    pub(super) fn then_at(&self) -> Option<String> {
        self.then.map(|_| self.zone().clock_time(self.now))
    }

    pub(super) fn date(&self, wall: WallTime) -> String {
        self.language.date(&self.zone().date_and_time(wall))
    }

    pub(super) const fn zone(&self) -> Zone {
        Zone::of(self.now)
    }

    pub(super) fn holds(&self) -> Vec<String> {
        let heat = self.hot();
        let words = |hold: &Hold| match (hold, self.snapshot.mission.phase) {
            (Hold::Alarm, PhaseName::Retrieving) => self.say("hold-fetchers-called").to_string(),
            (Hold::RobotLink, _) if let Some(why) = self.unreached() => {
                self.say("hold-with-why").with("hold", self.language.hold(*hold)).with("why", why).to_string()
            }
            (Hold::TooHigh, _) => self.say("hold-declared").to_string(),
            // In this phase the robot waits for RETRIEVE or RESET, and not for START.
            (Hold::AwaitingStart, PhaseName::BombLocated) => self.say("hold-waits-for-operator").to_string(),
            (Hold::Temperature, _) if !heat.is_empty() => {
                let read = |(source, last): &(Arc<str>, SourceReading)| {
                    self.say("reading-of")
                        .with("source", self.source(source))
                        .with("reading", self.degrees(&last.celsius))
                        .to_string()
                };
                let readings = heat.iter().map(read).collect::<Vec<_>>().join(", ");
                let cool = self.degrees(&self.snapshot.temperature.cool);
                self.say("hold-too-hot").with("readings", readings).with("cool", cool).to_string()
            }
            (hold, _) => self.language.hold(*hold).to_string(),
        };
        self.snapshot.mission.holds.iter().map(words).collect()
    }

    /// Returns why the program cannot record entries, without a full stop. `None` while it can record.
    pub(super) fn unrecorded(&self) -> Option<&str> {
        self.snapshot.mission.store_failure.as_deref().map(|words| words.trim_end_matches('.'))
    }

    /// Returns what the operator should do next, in the phases where the buttons alone do not show this. Always
    /// `None` for the past.
    pub(super) fn next_step(&self) -> Option<String> {
        if self.then.is_some() {
            return None;
        }
        match self.snapshot.mission.phase {
            PhaseName::BombLocated => {
                let is_unseen = self.unseen_alarms() > 0;
                let may_retrieve = self.bar(&self.snapshot.mission.refusals.retrieve).is_none();
                let fetch = match (is_unseen, may_retrieve) {
                    (true, true) => Some("next-acknowledge-retrieve"),
                    (true, false) => Some("next-acknowledge"),
                    (false, true) => Some("next-retrieve"),
                    (false, false) => None,
                };
                let go_on = self.offers_go_on().then_some("next-go-on");
                let kept_out = (self.snapshot.mission.progress.kept_out > 0).then_some("next-kept-out");
                let said =
                    fetch.into_iter().chain(go_on).chain(kept_out).chain(["next-reset"]).map(|id| self.say(id).to_string());
                Some(said.collect::<Vec<_>>().join(" "))
            }
            PhaseName::BagSecured => {
                let secured = self.secured()?;
                Some(self.say("next-secured").with("what", capital(&secured)).to_string())
            }
            PhaseName::Explored => {
                let finding = self.language.finding(&self.snapshot.luggage);
                Some(format!("{finding} {}", self.say("next-explored")))
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

    /// Whether the mission can be closed now.
    pub(super) fn may_close(&self) -> bool {
        let rests = matches!(
            self.snapshot.mission.phase,
            PhaseName::AtHome | PhaseName::BombLocated | PhaseName::BagSecured | PhaseName::Explored | PhaseName::Fault
        );
        rests && self.may_hand_over()
    }

    /// Whether the mission can be handed over now.
    pub(super) fn may_hand_over(&self) -> bool {
        self.snapshot.mission.is_under_way() && self.then.is_none()
    }

    /// Returns who has closed the mission, and when.
    pub(super) fn closed(&self) -> Option<String> {
        let closed = self.snapshot.mission.closed.as_ref()?;
        let say = self.say("closed-by").with("name", &closed.name).with("time", self.zone().clock_time(closed.wall));
        Some(say.to_string())
    }

    /// Whether the search can go on from here after a find: a bomb was found, and known places are not searched.
    pub(super) fn offers_go_on(&self) -> bool {
        let mission = &self.snapshot.mission;
        let is_after_find = matches!(mission.phase, PhaseName::BombLocated | PhaseName::BagSecured);
        is_after_find && self.then.is_none() && mission.progress.unknown > 0
    }

    /// Whether a *safe* needs two judges.
    pub(super) fn asks_two(&self) -> bool {
        self.hall.rules.safe_by == SafeBy::Two
    }

    pub(super) fn is_hot_required(&self) -> bool {
        self.hall.rules.hot == HotRule::Required
    }

    /// Returns what follows from the verdict DANGER.
    pub(super) fn danger_consequence(&self) -> Phrase<'static> {
        danger_consequence(self.language, self.hall.rules)
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

    /// Returns the title of the browser window. Its sign for an alarm or a hold is visible even when another window
    /// covers this one.
    pub(super) fn title(&self) -> String {
        let sign = match self.mood() {
            _ if self.then.is_some() => "",
            Mood::Alarm => "⚠ ",
            Mood::Held => "‖ ",
            Mood::Working => "▶ ",
            Mood::Calm => "",
        };
        format!("{sign}{} · hallsweep", self.phase_in_full())
    }

    pub(super) fn waiting(&self) -> Option<&Luggage> {
        self.snapshot.pending().map(|luggage| &**luggage)
    }

    /// Returns why START is disabled: the core would refuse it, or the mission already runs.
    pub(super) fn bar_of_start(&self) -> Option<String> {
        use PhaseName::{Exploring, Inspecting, Retrieving, ReturningHome, ReturningWithAlarm};
        let mission = &self.snapshot.mission;
        let moves = matches!(mission.phase, Exploring | Inspecting | ReturningHome | ReturningWithAlarm | Retrieving);
        let goes_on = moves && mission.holds.is_empty();
        self.bar(&mission.refusals.start).or_else(|| goes_on.then(|| self.say("dead-goes-on").to_string()))
    }

    /// Returns why BACK HOME is disabled: the core would refuse it, or the robot is at home or on its way home.
    pub(super) fn bar_of_back_home(&self) -> Option<String> {
        let mission = &self.snapshot.mission;
        let is = |phase| mission.phase == phase && mission.holds.is_empty();
        let already = is(PhaseName::ReturningHome).then_some("dead-comes-home");
        let already = already.or_else(|| is(PhaseName::AtHome).then_some("dead-at-home"));
        self.bar(&mission.refusals.back_home).or_else(|| already.map(|id| self.say(id).to_string()))
    }

    /// Returns why the button OK of the temperature is disabled: OK only revokes TOO HIGH.
    pub(super) fn bar_of_ok(&self) -> Option<String> {
        let is_over = !self.declared_too_high();
        self.looks_only().or_else(|| is_over.then(|| self.say("dead-no-too-high").to_string()))
    }

    /// Returns the time since a moment, such as `0:14`.
    pub(super) fn gone(&self, since: &WallTime) -> String {
        let seconds = self.now.unix_ms.saturating_sub(since.unix_ms).max(0) / 1000;
        format!("{}:{:02}", seconds / 60, seconds % 60)
    }

    pub(super) fn unseen_alarms(&self) -> usize {
        self.snapshot.alarms.iter().filter(|alarm| alarm.acknowledged.is_none()).count()
    }
}

pub(super) fn danger_consequence(language: Language, rules: Rules) -> Phrase<'static> {
    match rules.after_danger {
        AfterDanger::Return => language.say("danger-consequence"),
        AfterDanger::GoOn => language.say("danger-consequence-goes-on"),
    }
}

pub(super) fn failure(language: Language, luggage: &Luggage) -> Cow<'_, str> {
    match &luggage.photo {
        PhotoState::Taken { .. } => Cow::Borrowed(""),
        PhotoState::Failed(reason) => language.robot_said(reason),
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
