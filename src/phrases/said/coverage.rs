//! How far a hall and its areas have been searched, as a table and as a sentence.

use super::Language;
use crate::phrases::Phrase;
use hallsweep_core::snapshot::searched::{Searched, SearchedHall};

const COLUMNS: [&str; 7] = ["area", "probability", "driven", "seen-only", "never-seen", "unreachable", "detection"];

impl Language {
    pub fn coverage_columns(self) -> [Phrase<'static>; 7] {
        COLUMNS.map(|column| self.say_of("coverage", column))
    }

    /// Returns the cells of each area and of the whole hall, in the order of the columns.
    pub fn coverage_rows(self, all: &SearchedHall) -> Vec<[String; 7]> {
        let percent = |share: String| self.say("coverage-percent").with("share", share).to_string();
        let row = |name: String, probability: Option<f64>, searched: &Searched| {
            let unknown = || self.say("coverage-unknown").to_string();
            let detection = searched.detection.map_or_else(unknown, |share| percent(self.percent(share)));
            let [driven, seen_only, never_seen, unreachable] = searched.parts().map(|(_, cells)| cells.to_string());
            let given = |share: f64| self.number(&format!("{}", (share * 1000.0).round() / 10.0));
            let probability = probability.map_or_else(|| "–".to_owned(), |share| percent(given(share)));
            [name, probability, driven, seen_only, never_seen, unreachable, detection]
        };
        let areas = all.areas.iter().map(|(area, searched)| row(area.name.to_string(), Some(area.probability), searched));
        areas.chain([row(self.say("coverage-whole").to_string(), None, &all.hall)]).collect()
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
