//! The statement of the person in charge in the journal, with what was left open.

use serde::{Deserialize, Serialize};

use super::places::Moment;
use super::{Unparsed, names};
use hallsweep_core::closing::{Closed, OpenPoints};

#[derive(Serialize, Deserialize)]
pub(super) struct ClosedShape {
    who: String,
    name: String,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    note: Option<String>,
    open: OpenShape,
    when: Moment,
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub(super) struct OpenShape {
    pending: usize,
    bombs: usize,
    places: usize,
    kept_out: usize,
    unvisited: usize,
    unreachable: usize,
}

impl From<&Closed> for ClosedShape {
    fn from(Closed { who, name, note, open, wall }: &Closed) -> ClosedShape {
        let note = note.as_ref().map(|note| note.text().to_owned());
        ClosedShape { who: who.to_string(), name: name.text().to_owned(), note, open: (*open).into(), when: (*wall).into() }
    }
}

impl ClosedShape {
    pub(super) fn closed(self) -> Result<Closed, Unparsed> {
        let name = names::note(Some(self.name))?.ok_or_else(|| Unparsed("there is no name".to_owned()))?;
        let (note, open) = (names::note(self.note)?, self.open.into());
        Ok(Closed { who: self.who.into(), name, note, open, wall: self.when.into() })
    }
}

impl From<OpenPoints> for OpenShape {
    fn from(OpenPoints { pending, bombs, places, kept_out, unvisited, unreachable }: OpenPoints) -> OpenShape {
        OpenShape { pending, bombs, places, kept_out, unvisited, unreachable }
    }
}

impl From<OpenShape> for OpenPoints {
    fn from(OpenShape { pending, bombs, places, kept_out, unvisited, unreachable }: OpenShape) -> OpenPoints {
        OpenPoints { pending, bombs, places, kept_out, unvisited, unreachable }
    }
}
