//! The incident, once a piece in the hall was found dangerous: its alarm first, then the bombs with photo and place, how far away people
//! must be, and what happens next.

use askama::Template;

use super::evacuation::{from_home, takes_in_all};
use super::view::{View, failure, place};
use crate::api::luggage::photo_url;
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

    fn failure<'l>(&self, bomb: &'l Luggage) -> &'l str {
        failure(bomb)
    }

    fn place(&self, bomb: &Luggage) -> String {
        place(bomb.cell)
    }

    fn seen_from_home(&self, bomb: &Luggage) -> String {
        from_home(bomb.cell, self.v.hall.cell_m)
    }

    /// How far away people must be, and what of it is drawn.
    fn evacuation(&self) -> String {
        let metres = self.v.hall.evacuation_m;
        if self.v.hall.cell_m.is_none() {
            return format!("Keep {metres} m away. No circle is drawn: the side of a cell is not known.");
        }
        if self.bombs().iter().any(|bomb| takes_in_all(self.v, bomb.cell)) {
            return format!("Keep {metres} m away: all of the hall that is known lies within.");
        }
        format!("Keep {metres} m away: the red circle in the hall.")
    }

    /// What happens now, and what an operator does next.
    fn next(&self) -> String {
        let next = match self.v.snapshot.mission.phase {
            PhaseName::ReturningWithAlarm => {
                Some("The search has ended, the robot comes home. Then the piece can be fetched, or the hall be made safe.")
            }
            PhaseName::Retrieving => Some("The piece is being fetched and brought into the container."),
            PhaseName::Fault => Some("The robot is in fault, and nothing moves by itself."),
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
        next.map(str::to_owned).or_else(|| self.v.next_step()).unwrap_or_else(|| format!("The robot: {}.", self.v.phase()))
    }

    fn time(&self, wall: &WallTime) -> String {
        self.v.zone().clock_time(*wall)
    }
}
