//! Exercises: test pieces stand among the ordinary ones. The engine tells nobody which these are before all verdicts are
//! given. The simulator plants the pieces.

use std::collections::{BTreeMap, BTreeSet};

use super::Engine;
use crate::snapshot::log::Tone;
use crate::snapshot::said::Said;
use crate::state::fact::Fact;
use crate::units::{LuggageId, Now, Piece};

/// The exercise of this run.
#[derive(Clone, Debug)]
pub(super) struct Exercise {
    /// All pieces that can be inspected, each with whether it is a test piece.
    truth: BTreeMap<Piece, bool>,
    pub(super) is_begun: bool,
    /// Whether the pieces were revealed. Answers after that do not count.
    is_over: bool,
}

impl Engine {
    /// Makes this run an exercise. `truth` has all pieces that can be inspected, each with whether it is a test piece. A
    /// kill may have come between the last verdict and the record of what the pieces were, so this is recorded now.
    pub fn begin_exercise(&mut self, truth: BTreeMap<Piece, bool>, now: Now) {
        self.begin(now);
        let is_over = self.state.luggage.iter().any(|luggage| luggage.truth.is_some());
        self.exercise = Some(Exercise { truth, is_begun: self.state.under_way, is_over });
        self.reveal(false);
    }

    /// Records what the judged pieces were: after the last verdict, after *close*, or when the mission ends (`ends`).
    /// It is recorded once, because whoever knows it judges the other pieces differently. A piece that the camera did
    /// not recognise stays unknown.
    pub(super) fn reveal(&mut self, ends: bool) {
        let Some(exercise) = self.exercise.as_mut().filter(|exercise| !exercise.is_over) else { return };
        let judged = self.state.luggage.iter().filter(|luggage| !luggage.is_pending());
        let judged: Vec<(LuggageId, Piece, bool)> = judged
            .filter_map(|luggage| luggage.piece.and_then(|piece| Some((luggage.id, piece, *exercise.truth.get(&piece)?))))
            .collect();
        let pieces: BTreeSet<Piece> = judged.iter().map(|(_, piece, _)| *piece).collect();
        let is_complete = pieces.len() == exercise.truth.len();
        if !(ends || is_complete || self.state.closed.is_some()) {
            return;
        }
        exercise.is_over = true;
        for (luggage, _, is_test) in judged {
            let fact = Fact::Revealed { luggage, is_test };
            self.world.write(self.now.wall, Tone::Info, Said::fact(&fact));
            self.record(fact);
        }
    }

    /// Whether a mission has begun with the pieces of this exercise. Afterwards people know them.
    pub(super) fn is_exercise_begun(&self) -> bool {
        self.exercise.as_ref().is_some_and(|exercise| exercise.is_begun)
    }

    /// Whether this is an exercise of which no piece is revealed, and which nobody has closed.
    pub(super) fn is_truth_hidden(&self) -> bool {
        let shown = &self.on_record.shown;
        self.exercise.is_some() && shown.closed.is_none() && shown.luggage.iter().all(|luggage| luggage.truth.is_none())
    }
}
