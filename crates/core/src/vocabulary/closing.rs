//! The end of a search as the person in charge states it, and what is left open then. Nobody can say that there is no
//! bomb, so a mission ends with a signed statement.

use std::fmt;
use std::sync::Arc;

use crate::command::Note;
use crate::units::{MissionId, WallTime};

/// The command *close*.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Closing {
    /// The person in charge.
    pub name: Note,
    pub note: Option<Note>,
    /// The mission and its open points as the sender has seen them (`OpenPoints::code`). Empty if nothing was open.
    pub seen: Arc<str>,
}

/// A mission or an area that was closed. The search leaves out the rest of a closed area.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Closed<Open = OpenPoints> {
    pub who: Arc<str>,
    pub name: Note,
    pub note: Option<Note>,
    pub open: Open,
    pub wall: WallTime,
}

/// The command *close an area*.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AreaClosing {
    pub area: Arc<str>,
    /// The person in charge.
    pub name: Note,
    pub note: Option<Note>,
    /// The mission that the sender means. The command is refused if another one is under way.
    pub mission: Option<MissionId>,
}

/// Numbers of what is left open in an area.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OpenInArea {
    /// Cells about which nothing is known, obstacles that are not inspected, and cells to be searched again.
    pub cells: usize,
    /// Pieces without a verdict.
    pub pending: usize,
}

/// Numbers of what is left open in a mission.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OpenPoints {
    pub pending: usize,
    pub bombs: usize,
    /// Known places that were not searched: unknown cells beside visited ones, and obstacles that are not inspected.
    pub places: usize,
    /// Such places inside keep-out rings.
    pub kept_out: usize,
    /// Cells that were to be searched again and were not reached.
    pub again: usize,
    /// Cells that can be reached but were not visited, `places` included, if the hall is known beforehand.
    pub unvisited: usize,
    /// Free cells that cannot be reached from the start, if the hall is known beforehand.
    pub unreachable: usize,
}

impl OpenPoints {
    /// Returns the numbers by kind, each with its name and its English words.
    #[must_use]
    pub const fn parts(self) -> [(&'static str, &'static str, usize); 7] {
        [
            ("pending", "pieces without a verdict", self.pending),
            ("bombs", "bombs in the hall", self.bombs),
            ("places", "known places not searched", self.places),
            ("keptOut", "places inside keep-out rings", self.kept_out),
            ("again", "cells not searched again", self.again),
            ("unvisited", "cells never visited", self.unvisited),
            ("unreachable", "cells that cannot be reached", self.unreachable),
        ]
    }

    #[must_use]
    pub fn is_empty(self) -> bool {
        self == OpenPoints::default()
    }

    /// Returns a text that names the mission and all numbers, such as `7:1,0,21,0,0,111,0`.
    #[must_use]
    pub fn code(self, mission: MissionId) -> String {
        format!("{mission}:{}", self.parts().map(|(.., count)| count.to_string()).join(","))
    }
}

impl fmt::Display for OpenInArea {
    /// Example: `cells not searched: 12, pieces without a verdict: 1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "cells not searched: {}, pieces without a verdict: {}", self.cells, self.pending)
    }
}

impl fmt::Display for OpenPoints {
    /// Example: `pieces without a verdict: 1, cells never visited: 12`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let left = self.parts().into_iter().filter(|(.., count)| *count > 0);
        let left: Vec<String> = left.map(|(_, words, count)| format!("{words}: {count}")).collect();
        f.write_str(if left.is_empty() { "none".to_owned() } else { left.join(", ") }.as_str())
    }
}
