//! Announcements for screen readers: they report changes, but not every step of the robot.

use super::{View, sentence};
use hallsweep_core::phase::PhaseName;

impl View<'_> {
    pub(in super::super) fn announcement(&self) -> String {
        let mut words = vec![sentence(&self.phase_in_full())];
        let mission = &self.snapshot.mission;
        words.extend(mission.fault.iter().map(|fault| sentence(&self.language.fault(fault))));
        if mission.phase != PhaseName::Inspecting {
            words.extend(self.waiting().map(|luggage| self.say("announced-waits").with("id", luggage.id).to_string()));
        }
        words.extend(self.holds().first().map(|hold| sentence(hold)));
        if mission.phase == PhaseName::Exploring {
            let searched = round(mission.progress.visited);
            words.extend(searched.map(|count| self.say("announced-searched").with("count", count).to_string()));
        }
        words.extend(self.next_step());
        words.extend(
            self.snapshot
                .alarms
                .iter()
                .filter(|alarm| alarm.acknowledged.is_none())
                .map(|alarm| sentence(&self.language.alarm(&alarm.cause))),
        );
        words.join(" ")
    }
}

/// Returns the largest of 10, 20, 50, 100, … that `number` has reached. Progress is announced only at these numbers.
fn round(number: usize) -> Option<usize> {
    let power = 10_usize.checked_pow(number.checked_ilog10().filter(|digits| *digits > 0)?)?;
    [5, 2, 1].into_iter().map(|times| times * power).find(|round| *round <= number)
}
