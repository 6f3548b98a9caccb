//! Luggage records: what the robot met, where it took the photo, and the operator's verdict (mission §7).

use std::sync::Arc;

use crate::command::{Command, CommandId, Hot, Issuer, LuggageRef, Note, Verdict};
use crate::event::Photo;
use crate::units::{Cell, LuggageId, Piece, Pose, WallTime};

#[derive(Clone, Debug, PartialEq)]
pub struct Luggage {
    /// The number of the piece, never used for another piece.
    pub id: LuggageId,
    pub cell: Cell,
    /// Where the robot stood when it took the latest photo.
    pub pose: Pose,
    /// Where it stood when it took the photos before, as far as the places differ.
    pub seen_from: Vec<Pose>,
    /// When the latest photo was taken (or failed).
    pub taken: WallTime,
    /// When the first photo was taken. Since then the piece waits for its verdict.
    pub first_taken: WallTime,
    pub photo: PhotoState,
    pub verdict: Option<Decision>,
    /// The latest answers of judges who were unsure, the oldest first.
    pub unsure: Vec<Doubt>,
    /// The answers of other judges, which were kept back until the verdict.
    pub judged: Vec<Judgement>,
    /// Whether this is a test piece of an exercise; `None` until the exercise is over, and outside exercises.
    pub truth: Option<bool>,
    /// The number that the camera recognised, if it recognised one.
    pub piece: Option<Piece>,
    pub secured: Option<WallTime>,
    /// Total of all clock changes from the first photo until the verdict, or until now, in milliseconds.
    pub clock_set_ms: i64,
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PhotoState {
    Taken {
        bytes: usize,
        /// 1 for the first photo, and one more for each new photo, so that they can be told apart.
        take: u32,
    },
    Failed(String),
}

impl PhotoState {
    /// Returns the state after another photo was taken or failed. If it failed, an older photo stays valid.
    #[must_use]
    pub fn after(before: Option<&PhotoState>, photo: &Result<Photo, String>) -> PhotoState {
        let take = match before {
            Some(PhotoState::Taken { take, .. }) => take + 1,
            Some(PhotoState::Failed(_)) | None => 1,
        };
        match (photo, before) {
            (Ok(photo), _) => PhotoState::Taken { bytes: photo.bytes.len(), take },
            (Err(_), Some(taken @ PhotoState::Taken { .. })) => taken.clone(),
            (Err(words), _) => PhotoState::Failed(words.clone()),
        }
    }
}

/// Why there is no photo of a piece. `Display` gives the sentence for a person.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoPhoto {
    #[error("there is no photo of luggage #{0}: {1}; take the photo again")]
    Failed(LuggageId, String),
    /// The values are the piece, the requested photo number, and the number of photos.
    #[error("there is no photo {1} of luggage #{0}: the photos have the numbers 1 to {2}")]
    NotTaken(LuggageId, u64, u32),
    #[error("the photo of luggage #{0} is not stored")]
    NotKept(LuggageId),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    pub verdict: Verdict,
    pub who: Arc<str>,
    pub wall: WallTime,
    pub note: Option<Note>,
    pub hot: Hot,
}

/// The answer of a judge who could not tell from the photo.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doubt {
    pub who: Arc<str>,
    pub wall: WallTime,
    pub note: Option<Note>,
    pub hot: Hot,
}

/// The answer of one judge, while a verdict of safe needs two. Nobody but the judge sees it before the verdict.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Judgement {
    pub luggage: LuggageId,
    pub verdict: Verdict,
    pub issuer: Issuer,
    pub note: Option<Note>,
    pub hot: Hot,
    /// When the judge answered.
    pub wall: WallTime,
    /// When the photo was taken that the judge saw.
    pub taken: WallTime,
    /// The judge's id for the command, and whether the command named no piece. A repeat of the command is known by them.
    pub id: Option<CommandId>,
    pub is_bare: bool,
}

impl Judgement {
    /// Returns the command with which the judge has answered.
    #[must_use]
    pub fn command(&self) -> Command {
        let luggage = if self.is_bare { LuggageRef::Pending } else { LuggageRef::Id(self.luggage) };
        Command::Verdict { luggage, verdict: self.verdict, note: self.note.clone(), hot: self.hot }
    }
}

impl Luggage {
    /// Maximum number of unsure answers, and of earlier places, that a record keeps. The journal keeps all of them.
    pub const MOST_REMEMBERED: usize = 16;

    /// Returns the record with the photo of `later`.
    pub(crate) fn photographed_again(&self, later: &Luggage) -> Luggage {
        let mut seen_from = self.seen_from.clone();
        if self.has_photo() && self.pose != later.pose && !seen_from.contains(&self.pose) {
            seen_from.push(self.pose);
            seen_from.drain(..seen_from.len().saturating_sub(Luggage::MOST_REMEMBERED));
        }
        let Luggage { pose, taken, photo, .. } = later.clone();
        Luggage { pose, seen_from, taken, photo, ..self.clone() }
    }

    pub(crate) fn doubt(&mut self, doubt: Doubt) {
        self.unsure.push(doubt);
        self.unsure.drain(..self.unsure.len().saturating_sub(Luggage::MOST_REMEMBERED));
    }

    /// When the piece began to wait for its verdict. The time is corrected for later changes of the clock.
    #[must_use]
    pub const fn waits_since(&self) -> WallTime {
        self.first_taken.set_by(self.clock_set_ms)
    }

    #[must_use]
    pub const fn is_pending(&self) -> bool {
        self.verdict.is_none()
    }

    #[must_use]
    pub const fn has_photo(&self) -> bool {
        matches!(self.photo, PhotoState::Taken { .. })
    }

    /// Returns the number of the latest photo.
    ///
    /// # Errors
    /// `Failed` if there is no photo.
    pub fn take(&self) -> Result<u32, NoPhoto> {
        match &self.photo {
            PhotoState::Taken { take, .. } => Ok(*take),
            PhotoState::Failed(reason) => Err(NoPhoto::Failed(self.id, reason.clone())),
        }
    }

    #[must_use]
    pub fn is_dangerous(&self) -> bool {
        self.verdict.as_ref().is_some_and(|decision| decision.verdict == Verdict::Danger)
    }

    #[must_use]
    pub fn is_bomb_left(&self) -> bool {
        self.is_dangerous() && self.secured.is_none()
    }

    /// Returns `pending`, `safe` or `danger`, as the interfaces show it.
    #[must_use]
    pub fn verdict_name(&self) -> &'static str {
        self.verdict.as_ref().map_or("pending", |decision| decision.verdict.name())
    }
}
