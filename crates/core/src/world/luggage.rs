//! Luggage records: what was met, where it was photographed from, and what the operator said of it (mission §7).

use std::sync::Arc;

use crate::command::{Note, Verdict};
use crate::event::Photo;
use crate::units::{Cell, LuggageId, Piece, Pose, WallTime};

/// The record of one piece.
#[derive(Clone, Debug, PartialEq)]
pub struct Luggage {
    /// Its number, never used for another piece.
    pub id: LuggageId,
    /// The cell of the bag, where it was met.
    pub cell: Cell,
    /// Where the robot stood when it took the photo, and which way it faced.
    pub pose: Pose,
    /// When the photo was taken (or failed).
    pub taken: WallTime,
    /// When the first photo of it was: from then on it waits for its verdict.
    pub first_taken: WallTime,
    /// What became of the photo.
    pub photo: PhotoState,
    /// What was decided.
    pub verdict: Option<Decision>,
    /// Which piece the camera takes it for, if it can tell.
    pub piece: Option<Piece>,
    /// When it was put into the container.
    pub secured: Option<WallTime>,
    /// By how many milliseconds the clock was set between the first photo and the verdict, or until now.
    pub clock_set_ms: i64,
}

/// What became of a photo.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum PhotoState {
    /// It is kept; how many bytes, and how often it was taken (so that a retaken one is not taken for the first).
    Taken {
        /// Size in bytes.
        bytes: usize,
        /// 1 for the first photo, more after a retake.
        take: u32,
    },
    /// There is none, and why.
    Failed(String),
}

impl PhotoState {
    /// What becomes of it when a photo is taken (again), or fails: an older one stays good.
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

/// Why there is no photo of a piece to look at. `Display` is the sentence a person reads.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoPhoto {
    /// The camera failed, and how.
    #[error("there is no photo of luggage #{0}: {1}; take it again")]
    Failed(LuggageId, String),
    /// It was not taken so often; how often it was.
    #[error("there is no photo {1} of luggage #{0}: there are 1 to {2}")]
    NotTaken(LuggageId, u64, u32),
    /// It was taken, and the record has it no more.
    #[error("the photo of luggage #{0} is not kept")]
    NotKept(LuggageId),
}

/// A verdict that stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Decision {
    /// What it is.
    pub verdict: Verdict,
    /// Who said so.
    pub who: Arc<str>,
    /// When.
    pub wall: WallTime,
    /// What else was said of it.
    pub note: Option<Note>,
}

impl Luggage {
    /// When it began to wait for its verdict, by the clock as it was at the verdict, or is now.
    #[must_use]
    pub const fn waits_since(&self) -> WallTime {
        self.first_taken.set_by(self.clock_set_ms)
    }

    /// Whether its verdict is still to be given.
    #[must_use]
    pub const fn is_pending(&self) -> bool {
        self.verdict.is_none()
    }

    /// Whether there is a photo to judge by.
    #[must_use]
    pub const fn has_photo(&self) -> bool {
        matches!(self.photo, PhotoState::Taken { .. })
    }

    /// How often its photo was taken.
    ///
    /// # Errors
    /// `Failed` when there is none.
    pub fn take(&self) -> Result<u32, NoPhoto> {
        match &self.photo {
            PhotoState::Taken { take, .. } => Ok(*take),
            PhotoState::Failed(reason) => Err(NoPhoto::Failed(self.id, reason.clone())),
        }
    }

    /// Whether it was found dangerous.
    #[must_use]
    pub fn is_dangerous(&self) -> bool {
        self.verdict.as_ref().is_some_and(|decision| decision.verdict == Verdict::Danger)
    }

    /// Whether it was found dangerous and is still in the hall.
    #[must_use]
    pub fn is_bomb_left(&self) -> bool {
        self.is_dangerous() && self.secured.is_none()
    }

    /// The word of the doors: `pending`, `safe` or `danger`.
    #[must_use]
    pub fn verdict_name(&self) -> &'static str {
        self.verdict.as_ref().map_or("pending", |decision| decision.verdict.name())
    }
}
