//! The part `incident` of the page. It is shown while a piece in the hall is judged dangerous. It contains each
//! bomb with photo and place, the evacuation distance, the next step, the alarm, and the buttons.

use askama::Template;

use super::carriers::held_at;
use super::evacuation::{distances, from_home, takes_in_all};
use super::retrieval::wanted_of_the_operator;
use super::view::{View, failure};
use crate::api::luggage::photo_url;
use crate::phrases::Phrase;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::units::LuggageId;
use hallsweep_core::world::alarm::AlarmView;
use hallsweep_core::world::luggage::Luggage;

/// Maximum number of bombs shown with photos. If there are more bombs, the incident says how many more.
const BOMBS: usize = 8;

/// The part `incident` of the page. It is empty while there is no bomb in the hall.
#[derive(Template)]
#[template(path = "console/incident.html")]
pub(super) struct Incident<'a> {
    pub(super) v: &'a View<'a>,
}

/// Whether an alarm is about a bomb in the hall. Such an alarm is shown in the incident.
pub(super) fn is_of_incident(v: &View<'_>, alarm: &AlarmView) -> bool {
    let is_left = |id: LuggageId| v.snapshot.luggage(id).is_some_and(|piece| piece.is_bomb_left());
    alarm.luggage.is_some_and(is_left)
}

/// Whether somebody can and should acknowledge an alarm. An alarm that is not recorded yet cannot be acknowledged.
fn is_unseen(alarm: &AlarmView) -> bool {
    alarm.id.is_some() && alarm.acknowledged.is_none()
}

impl Incident<'_> {
    fn bombs(&self) -> Vec<&Luggage> {
        self.v.snapshot.luggage.bombs_left().take(BOMBS).map(|bomb| &**bomb).collect()
    }

    fn number(&self) -> usize {
        self.v.snapshot.luggage.bombs_left().count()
    }

    fn more(&self) -> usize {
        self.number().saturating_sub(BOMBS)
    }

    /// Returns the alarms of the incident, newest first.
    fn alarms(&self) -> Vec<&AlarmView> {
        self.v.snapshot.alarms.iter().rev().filter(|alarm| is_of_incident(self.v, alarm)).collect()
    }

    /// Whether somebody has to acknowledge an alarm before the mission goes on. Otherwise the next act is `act`.
    fn asks_to_acknowledge(&self) -> bool {
        let comes_first = self.v.snapshot.mission.phase == PhaseName::BombLocated || self.act().is_none();
        comes_first && self.alarms().iter().any(|alarm| is_unseen(alarm))
    }

    /// Whether acknowledging this alarm is the next act. Only one act is shown as the next, and alarms that are not of
    /// the incident come before it.
    fn is_next(&self, alarm: &AlarmView) -> bool {
        let is_first = self.alarms().into_iter().find(|alarm| is_unseen(alarm)).is_some_and(|first| first.id == alarm.id);
        let others = self.v.snapshot.alarms.iter().any(|alarm| is_unseen(alarm) && !is_of_incident(self.v, alarm));
        is_first && !others && self.asks_to_acknowledge()
    }

    fn held(&self, bomb: &Luggage) -> Option<String> {
        let place = held_at(self.v.snapshot, bomb)?;
        Some(place.cell().map_or_else(|| self.v.say("before-entrance").to_string(), |cell| self.v.place(cell)))
    }

    /// Returns the largest distance in metres that everybody must keep, and the largest one within which people outdoors
    /// must go into a building, if it is larger.
    fn distances(&self) -> (f64, Option<f64>) {
        let all = self.v.snapshot.luggage.bombs_left().map(|bomb| distances(self.v, bomb));
        let most = |most: (f64, f64), (mandatory, preferred): (f64, Option<f64>)| {
            (most.0.max(mandatory), most.1.max(preferred.unwrap_or_default()))
        };
        let (mandatory, preferred) = all.fold((0.0, 0.0), most);
        (mandatory, Some(preferred).filter(|preferred| *preferred > mandatory))
    }

    /// Returns how far people must keep away, in words.
    fn evacuation(&self) -> Phrase<'static> {
        let (mandatory, preferred) = self.distances();
        let metres = self.v.language.number(&mandatory.to_string());
        if self.v.hall.cell_m.is_none() {
            return self.v.say("evacuate-no-circle").with("metres", metres);
        }
        if self.bombs().iter().any(|bomb| takes_in_all(self.v, bomb)) {
            return self.v.say("evacuate-all").with("metres", metres);
        }
        self.v.say(if preferred.is_some() { "evacuate-inner" } else { "evacuate-circle" }).with("metres", metres)
    }

    /// Returns within which distances people outdoors must go into a building, in words.
    fn outdoors(&self) -> Option<Phrase<'static>> {
        let (mandatory, preferred) = self.distances();
        let [from, to] = [mandatory, preferred?].map(|metres| self.v.language.number(&metres.to_string()));
        Some(self.v.say("evacuate-outdoors").with("from", from).with("to", to))
    }

    fn next(&self) -> String {
        let mission = &self.v.snapshot.mission;
        let moving = match mission.phase {
            PhaseName::ReturningWithAlarm => Some("home"),
            PhaseName::Retrieving => Some("fetched"),
            PhaseName::Fault => {
                let said = self.v.say("incident-next-fault");
                return if self.v.bar_of_start().is_none() {
                    format!("{said} {}", self.v.say("goes-on-start"))
                } else {
                    said.to_string()
                };
            }
            PhaseName::Exploring | PhaseName::Inspecting => Some("search"),
            PhaseName::ReturningHome => Some("back"),
            PhaseName::Idle
            | PhaseName::Driving
            | PhaseName::AtHome
            | PhaseName::BombLocated
            | PhaseName::BagSecured
            | PhaseName::Explored => None,
        };
        match moving {
            Some(moving) if mission.holds.is_empty() => self.v.say_of("incident-next", moving).to_string(),
            Some(moving) => {
                let halted = self.v.say_of("incident-halted", moving).with("holds", self.v.holds().join(" · "));
                format!("{halted} {}", self.v.say_of("goes-on", wanted_of_the_operator(&mission.holds).unwrap_or("later")))
            }
            None => {
                self.v.next_step().unwrap_or_else(|| self.v.say("incident-next-phase").with("phase", self.v.phase()).to_string())
            }
        }
    }

    /// Returns the command with which the mission continues. Its button is below the heading. Returns `None` if there
    /// is no such command, or if the reader may only look. An alarm has its own button.
    fn act(&self) -> Option<&'static str> {
        let mission = &self.v.snapshot.mission;
        let goes_on = matches!(mission.phase, PhaseName::ReturningWithAlarm | PhaseName::Retrieving | PhaseName::Fault);
        match wanted_of_the_operator(&mission.holds) {
            _ if self.v.looks_only().is_some() => None,
            Some("ok") => Some("temperature"),
            _ if mission.phase == PhaseName::BombLocated => Some("retrieve"),
            _ => (goes_on && self.v.bar_of_start().is_none()).then_some("start"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::view::HallInfo;
    use super::*;
    use crate::api::tests::fixture::{TEN, searching};
    use crate::phrases::Language;
    use hallsweep_core::hold::Hold;
    use hallsweep_core::refused::Refused;
    use hallsweep_core::settings::Rules;

    #[test]
    fn the_incident_says_what_is_halted_and_has_one_next_act() {
        use PhaseName::{BombLocated, Fault, Retrieving, ReturningWithAlarm};
        const START: &str = "./console/start";
        const OK: &str = "./console/temperature";
        let stopped = [Hold::Operator, Hold::AwaitingStart];
        let hot = [Hold::TooHigh, Hold::AwaitingStart];
        let read = [Hold::Temperature, Hold::AwaitingStart];
        let lost = [Hold::Alarm, Hold::AwaitingStart];
        for (phase, holds, said, act) in [
            (Retrieving, &[][..], "The piece is being fetched and brought into the container.", None),
            (
                Retrieving,
                &stopped,
                "The retrieval is halted: stopped by the operator · waiting for START. Press START to go on.",
                Some(START),
            ),
            (Retrieving, &hot, "Press TEMPERATURE OK, then START.", Some(OK)),
            (Retrieving, &read, "When this cause is over, press START to go on.", None),
            (Retrieving, &lost, "Acknowledge the alarm, then press START.", None),
            (ReturningWithAlarm, &[], "The search has ended and the robot is coming home.", None),
            (
                ReturningWithAlarm,
                &stopped,
                "way home is halted: stopped by the operator · waiting for START. Press START to go on.",
                Some(START),
            ),
            (ReturningWithAlarm, &hot, "Press TEMPERATURE OK, then START.", Some(OK)),
            (Fault, &[], "nothing moves by itself. Press START to go on.", Some(START)),
            (
                BombLocated,
                &[],
                "Acknowledge the alarm, then press RETRIEVE to bring the luggage into the container.",
                Some("./console/retrieve"),
            ),
            (BombLocated, &hot, "Acknowledge the alarm", Some(OK)),
        ] {
            let mut snapshot = searching();
            (snapshot.mission.phase, snapshot.mission.holds) = (phase, holds.to_vec());
            let is_barred = holds.iter().any(|hold| !stopped.contains(hold));
            snapshot.mission.refusals.start = is_barred.then(|| Refused::Held(holds.to_vec(), None));
            let hall = HallInfo {
                name: "airport".into(),
                cell_m: None,
                is_reckoned: false,
                evacuation_m: 100.0,
                is_paused: false,
                robot: None,
                rules: Rules::default(),
            };
            let (language, now) = (Language::English, TEN);
            let v = View { snapshot: &snapshot, hall, began: None, who: None, language, why: None, now, line: None, then: None };
            let incident = Incident { v: &v };
            assert!(incident.next().contains(said), "{phase:?} {holds:?}: {}", incident.next());
            let shown = incident.to_string();
            let (above, acts) = shown.split_once("<div class=\"acts\">").expect("the acts are there");
            let actions = acts.split("action=\"").skip(1).filter_map(|rest| rest.split('"').next());
            let goes_on = actions.filter(|action| !action.ends_with("/acknowledge") && !action.ends_with("/goOn"));
            assert_eq!(goes_on.collect::<Vec<_>>(), Vec::from_iter(act), "{phase:?} {holds:?}: {shown}");
            assert!(!above.contains("action="), "the acts stand together: {shown}");
            assert_eq!(acts.contains("action=\"./console/goOn\""), phase == BombLocated, "{shown}");
            assert_eq!(acts.matches(" loud\"").count() + acts.matches("\"loud\"").count(), 1, "one act is the next: {shown}");
            assert!(holds.is_empty() || !above.contains("is being fetched") && !above.contains("comes home"), "{shown}");
        }
    }
}
