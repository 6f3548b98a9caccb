//! The hand-over of a mission and its record to another person or office.

use crate::command::Note;
use crate::units::MissionId;

/// The command *hand over*.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct HandOver {
    /// The mission that the sender means; the one under way if the sender names none.
    pub mission: Option<MissionId>,
    /// The person or office that takes over.
    pub to: Note,
    pub note: Option<Note>,
}
