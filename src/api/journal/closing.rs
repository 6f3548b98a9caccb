//! The statement of the person in charge in the journal. What was left open has the same shape in the interface.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::places::Moment;
use super::{Unparsed, names};
use hallsweep_core::closing::{Closed, OpenInArea, OpenPoints};

#[derive(Serialize, Deserialize)]
pub(super) struct ClosedShape<Open = OpenShape> {
    who: String,
    name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    note: Option<String>,
    open: Open,
    when: Moment,
}

/// Numbers of what is open in an area.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "OpenInArea")]
pub struct OpenInAreaShape {
    /// Number of cells that were not searched, or were to be searched again.
    cells: usize,
    /// Number of pieces without a verdict.
    pending: usize,
}

/// Numbers of open points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "OpenPoints")]
#[serde(rename_all = "camelCase")]
pub struct OpenShape {
    /// Number of pieces without a verdict.
    pending: usize,
    /// Number of dangerous pieces in the hall.
    bombs: usize,
    /// Number of known places that were not searched.
    places: usize,
    /// Number of such places inside keep-out rings, which are not in `places`.
    kept_out: usize,
    /// Number of cells that were to be searched again and were not reached.
    #[serde(default)]
    again: usize,
    /// Number of cells that can be reached but were not visited; 0 if the hall is not known beforehand.
    unvisited: usize,
    /// Number of free cells that cannot be reached from the start; 0 if the hall is not known beforehand.
    unreachable: usize,
}

impl<Open: Copy, Shape: From<Open>> From<&Closed<Open>> for ClosedShape<Shape> {
    fn from(Closed { who, name, note, open, wall }: &Closed<Open>) -> ClosedShape<Shape> {
        let note = note.as_ref().map(|note| note.text().to_owned());
        ClosedShape { who: who.to_string(), name: name.text().to_owned(), note, open: (*open).into(), when: (*wall).into() }
    }
}

impl<Shape> ClosedShape<Shape> {
    pub(super) fn closed<Open: From<Shape>>(self) -> Result<Closed<Open>, Unparsed> {
        let (name, note, open) = (names::name(self.name)?, names::note(self.note)?, self.open.into());
        Ok(Closed { who: self.who.into(), name, note, open, wall: self.when.into() })
    }
}

impl From<OpenInArea> for OpenInAreaShape {
    fn from(OpenInArea { cells, pending }: OpenInArea) -> OpenInAreaShape {
        OpenInAreaShape { cells, pending }
    }
}

impl From<OpenInAreaShape> for OpenInArea {
    fn from(OpenInAreaShape { cells, pending }: OpenInAreaShape) -> OpenInArea {
        OpenInArea { cells, pending }
    }
}

impl From<OpenPoints> for OpenShape {
    fn from(OpenPoints { pending, bombs, places, kept_out, again, unvisited, unreachable }: OpenPoints) -> OpenShape {
        OpenShape { pending, bombs, places, kept_out, again, unvisited, unreachable }
    }
}

impl From<OpenShape> for OpenPoints {
    fn from(OpenShape { pending, bombs, places, kept_out, again, unvisited, unreachable }: OpenShape) -> OpenPoints {
        OpenPoints { pending, bombs, places, kept_out, again, unvisited, unreachable }
    }
}
