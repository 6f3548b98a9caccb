//! The progress of the search and its remaining time, in words.

use std::time::Duration;

use super::View;
use crate::phrases::Phrase;
use hallsweep_core::phase::PhaseName;
use hallsweep_core::snapshot::TimeLeft;
use hallsweep_core::state::Reach;
use hallsweep_core::units::WallTime;

impl View<'_> {
    pub(in super::super) fn is_begun(&self) -> bool {
        self.snapshot.mission.phase != PhaseName::Idle || self.snapshot.mission.progress.visited > 1
    }

    /// Returns the size of the searched area, such as `41 cells, 25.6 m²`.
    pub(in super::super) fn searched(&self) -> String {
        let visited = self.snapshot.mission.progress.visited;
        let cells = self.say("cells").with("count", visited);
        let Some(side) = self.hall.cell_m else { return cells.to_string() };
        let visited = u32::try_from(visited).unwrap_or(u32::MAX);
        let area = self.language.number(&format!("{:.1}", f64::from(visited) * side * side));
        self.say("cells-and-area").with("cells", cells).with("area", area).to_string()
    }

    /// Returns the number of known places that are still to be searched, in words. Nobody knows how large the area
    /// beyond these places is.
    pub(in super::super) fn open(&self) -> Phrase<'static> {
        self.say("open-places").with("count", self.snapshot.mission.progress.unknown)
    }

    /// Returns the number of places that are not searched because they are inside keep-out rings, in words.
    pub(in super::super) fn kept_out(&self) -> Option<Phrase<'static>> {
        let count = Some(self.snapshot.mission.progress.kept_out).filter(|count| *count > 0)?;
        Some(self.say("kept-out-places").with("count", count))
    }

    /// Returns the number of cells that are to be searched again, in words.
    pub(in super::super) fn again(&self) -> Option<Phrase<'static>> {
        let count = Some(self.snapshot.mission.again.len()).filter(|count| *count > 0)?;
        Some(self.say("again-cells").with("count", count))
    }

    /// Returns what was not searched, in words, if the phase reads like the end of the search. The page shows this
    /// text as large as the phase. Nobody knows how large the area beyond the known places is.
    pub(in super::super) fn unsearched(&self) -> Option<Phrase<'static>> {
        let mission = &self.snapshot.mission;
        let is_an_end =
            matches!(mission.phase, PhaseName::AtHome | PhaseName::BombLocated | PhaseName::BagSecured | PhaseName::Explored);
        let (count, inside) = (mission.progress.unknown + mission.progress.kept_out, mission.progress.kept_out);
        if is_an_end && inside > 0 {
            return Some(self.say("unsearched-kept-out").with("count", count).with("inside", inside));
        }
        if is_an_end && count > 0 {
            return Some(self.say("unsearched").with("count", count));
        }
        if is_an_end && !mission.again.is_empty() {
            return self.again();
        }
        let is_partial = |reach: &Reach| mission.phase == PhaseName::Explored && reach.reachable < reach.free;
        let Reach { reachable, free } = mission.progress.reach.filter(is_partial)?;
        Some(self.say("searched-of").with("reachable", reachable).with("free", free))
    }

    /// Returns the phase and what was not searched, as one line.
    pub(in super::super) fn phase_in_full(&self) -> String {
        self.unsearched().map_or_else(|| self.phase(), |left| format!("{} · {left}", self.phase()))
    }

    pub(in super::super) fn reach(&self) -> Option<Phrase<'static>> {
        let Reach { reachable, free } = self.snapshot.mission.progress.reach?;
        Some(self.say("progress-reach").with("reachable", reachable).with("free", free))
    }

    /// Returns the remaining driving time, such as `4 min to 11 min of driving left`.
    pub(in super::super) fn left(&self) -> Option<Phrase<'static>> {
        let TimeLeft { least, most } = self.snapshot.mission.progress.left?;
        if most.is_none() && least < ROUGHLY {
            return None; // "at least 0 s" would say nothing
        }
        let least = roughly(least, |seconds, unit| seconds / unit);
        Some(match most {
            None => self.say("left-least").with("least", least),
            Some(most) => self.say("left-range").with("least", least).with("most", roughly(most, u64::div_ceil)),
        })
    }

    /// Returns when the mission began, so that the page can show the elapsed time. `None` when the mission is over.
    pub(in super::super) fn counts_since(&self) -> Option<WallTime> {
        let is_over = matches!(
            self.snapshot.mission.phase,
            PhaseName::Idle | PhaseName::BombLocated | PhaseName::BagSecured | PhaseName::Explored
        );
        self.began.filter(|_| !is_over).map(|began| began.set_by(self.snapshot.mission.clock_set_ms))
    }
}

/// Times below two minutes are rounded to a multiple of this time.
const ROUGHLY: Duration = Duration::from_secs(10);

fn roughly(time: Duration, round: fn(u64, u64) -> u64) -> String {
    let seconds = time.as_secs();
    if seconds < 120 { format!("{} s", round(seconds, 10) * 10) } else { format!("{} min", round(seconds, 60)) }
}
