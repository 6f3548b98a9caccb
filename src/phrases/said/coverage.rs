//! How far a hall and its areas have been searched, as a table and as a sentence.

use super::Language;
use crate::phrases::Phrase;
use hallsweep_core::snapshot::searched::{Searched, SearchedHall};
use hallsweep_core::state::PersistentState;
use hallsweep_core::units::WallTime;
use hallsweep_core::world::areas::Area;

const COLUMNS: [&str; 7] = ["area", "probability", "driven", "seen-only", "never-seen", "unreachable", "detection"];

impl Language {
    pub fn coverage_columns(self) -> [Phrase<'static>; 7] {
        COLUMNS.map(|column| self.say_of("coverage", column))
    }

    /// Returns the rows of each area and of the whole hall.
    pub fn coverage_rows(self, all: &SearchedHall) -> Vec<[String; 7]> {
        let row = |(area, searched): &(Area, Searched)| self.coverage_row(&area.name, Some(area.probability), searched);
        let whole = self.coverage_row(&self.say("coverage-whole").to_string(), None, &all.hall);
        all.areas.iter().map(row).chain([whole]).collect()
    }

    /// Returns the figures of a part of the hall, in the order of the columns.
    pub fn coverage_row(self, name: &str, probability: Option<f64>, searched: &Searched) -> [String; 7] {
        let percent = |share| self.say("coverage-percent").with("share", self.percent(share));
        let detection = searched.detection.map_or_else(|| self.say("coverage-unknown"), percent).to_string();
        let [driven, seen_only, never_seen, unreachable] = searched.parts().map(|(_, cells)| cells.to_string());
        let probability = probability.map_or_else(|| "–".to_owned(), |share| self.probability(share).to_string());
        [name.to_owned(), probability, driven, seen_only, never_seen, unreachable, detection]
    }

    /// Writes the probability of an area, with at most one decimal.
    pub fn probability(self, share: f64) -> Phrase<'static> {
        self.say("coverage-percent").with("share", self.number(&format!("{}", (share * 1000.0).round() / 10.0)))
    }

    /// Says by whom each closed area was closed, and what was open, with the time.
    pub fn closed_areas(self, state: &PersistentState) -> Vec<(WallTime, String)> {
        state.closed_areas.iter().map(|(area, closed)| (closed.wall, self.closed_area(area, closed))).collect()
    }

    /// Writes a probability in whole per cent. It is rounded down, so that nothing is said to be certain.
    fn percent(self, share: f64) -> String {
        self.number(&format!("{:.0}", (share * 100.0).floor()))
    }

    /// Says the probability of detection and the number of places that were not searched.
    pub fn coverage(self, all: &SearchedHall) -> Phrase<'static> {
        let left = all.hall.never_seen + all.hall.unreachable;
        match (all.success(), all.hall.detection) {
            (Some(success), Some(detection)) => {
                let said = self.say("coverage-success").with("share", self.percent(detection)).with("left", left);
                said.with("success", self.percent(success))
            }
            (None, Some(detection)) => self.say("coverage-known").with("share", self.percent(detection)).with("left", left),
            (_, None) => self.say("coverage-not-calibrated").with("left", left),
        }
    }
}
