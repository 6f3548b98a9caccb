//! The incident, once a piece in the hall was found dangerous: its alarm first, then what happens next, how far away people must be, and
//! the bombs with photo and place.

use std::borrow::Cow;

use askama::Template;

use super::evacuation::{from_home, takes_in_all};
use super::view::{View, failure};
use crate::api::luggage::photo_url;
use crate::phrases::Phrase;
use hallsweep_core::mission::PhaseName;
use hallsweep_core::units::{LuggageId, WallTime};
use hallsweep_core::world::alarm::AlarmView;
use hallsweep_core::world::luggage::Luggage;

/// So many bombs are shown with their photos; of more their number is said, and the gallery has them.
const BOMBS: usize = 8;

/// The part `incident`; without a bomb in the hall it is empty.
#[derive(Template)]
#[template(path = "console/incident.html")]
pub(super) struct Incident<'a> {
    pub(super) v: &'a View<'a>,
}

/// Whether an alarm is about a bomb in the hall, and so belongs to the incident.
pub(super) fn is_of_incident(v: &View<'_>, alarm: &AlarmView) -> bool {
    let is_left = |id: LuggageId| v.snapshot.luggage(id).is_some_and(|piece| piece.is_bomb_left());
    alarm.luggage.is_some_and(is_left)
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

    /// The newest first, as the other alarms.
    fn alarms(&self) -> Vec<&AlarmView> {
        self.v.snapshot.alarms.iter().rev().filter(|alarm| is_of_incident(self.v, alarm)).collect()
    }

    fn photo(&self, bomb: &Luggage) -> Option<String> {
        photo_url(bomb)
    }

    fn failure<'l>(&self, bomb: &'l Luggage) -> Cow<'l, str> {
        failure(self.v.language, bomb)
    }

    fn place(&self, bomb: &Luggage) -> String {
        self.v.place(bomb.cell)
    }

    fn seen_from_home(&self, bomb: &Luggage) -> String {
        from_home(self.v.language, bomb.cell, self.v.hall.cell_m)
    }

    /// How far away people must be, and what of it is drawn.
    fn evacuation(&self) -> Phrase<'static> {
        let metres = self.v.language.number(&self.v.hall.evacuation_m.to_string());
        if self.v.hall.cell_m.is_none() {
            return self.v.say("evacuate-no-circle").with("metres", metres);
        }
        if self.bombs().iter().any(|bomb| takes_in_all(self.v, bomb.cell)) {
            return self.v.say("evacuate-all").with("metres", metres);
        }
        self.v.say("evacuate-circle").with("metres", metres)
    }

    /// What happens now, and what an operator does next.
    fn next(&self) -> String {
        let next = match self.v.snapshot.mission.phase {
            PhaseName::ReturningWithAlarm => Some("incident-next-home"),
            PhaseName::Retrieving => Some("incident-next-fetched"),
            PhaseName::Fault => Some("incident-next-fault"),
            PhaseName::Idle
            | PhaseName::Exploring
            | PhaseName::Inspecting
            | PhaseName::Driving
            | PhaseName::ReturningHome
            | PhaseName::AtHome
            | PhaseName::BombLocated
            | PhaseName::BagSecured
            | PhaseName::Explored => None,
        };
        let next = next.map(|id| self.v.say(id).to_string()).or_else(|| self.v.next_step());
        next.unwrap_or_else(|| self.v.say("incident-next-phase").with("phase", self.v.phase()).to_string())
    }

    fn time(&self, wall: &WallTime) -> String {
        self.v.zone().clock_time(*wall)
    }
}
