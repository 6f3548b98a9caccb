//! The bodies of commands about areas: which come first, which one is closed, and what is searched again.

use std::sync::Arc;

use schemars::JsonSchema;

use super::{NAME, Unusable, VISIBLE, cell, note, person};
use crate::api::fields::{Body, BodyFields, in_short, needed};
use hallsweep_core::closing::AreaClosing;
use hallsweep_core::command::{Again, Command, Note};
use hallsweep_core::units::{Epoch, MissionId};
use hallsweep_core::world::areas::Area;
use hallsweep_core::world::hall_map::{Bounds, REACH};

/// Area that was searched, by two opposite corners or by its name.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(untagged, deny_unknown_fields, rename_all_fields = "camelCase")]
pub enum AreaBody {
    /// As `{"x":1,"y":1,"toX":4,"toY":3}`.
    Corners {
        /// Column of a corner, growing to the east.
        #[schemars(range(min = -REACH, max = REACH))]
        x: i64,
        /// Row of this corner, growing to the south.
        #[schemars(range(min = -REACH, max = REACH))]
        y: i64,
        /// Column of the opposite corner.
        #[schemars(range(min = -REACH, max = REACH))]
        to_x: i64,
        /// Row of the opposite corner.
        #[schemars(range(min = -REACH, max = REACH))]
        to_y: i64,
        /// Epoch that the sender saw last. The command is refused if a stop has happened since then.
        #[schemars(range(max = u64::MAX))]
        epoch: Option<u64>,
    },
    /// As `{"area":"gate 1"}`.
    Named {
        /// Name of an area of the hall. If the area was closed, it is open again.
        #[schemars(length(min = 1, max = Area::NAME), regex(pattern = AREA_NAME))]
        area: String,
        /// Epoch that the sender saw last. The command is refused if a stop has happened since then.
        #[schemars(range(max = u64::MAX))]
        epoch: Option<u64>,
    },
}

/// Names of the areas that are to be searched first, as `{"areas":["gate 1","gate 2"]}`. An empty list leaves the
/// order to the search.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct OrderAreasBody {
    /// Names of areas of the hall, each at most once. Areas without a place come after these.
    #[schemars(length(max = Area::MOST), inner(length(min = 1, max = Area::NAME), regex(pattern = AREA_NAME)), extend("uniqueItems" = true))]
    pub areas: Vec<String>,
}

/// Statement of the person in charge about an area, as `{"area":"gate 1","name":"Anna Rossi"}`.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct CloseAreaBody {
    /// Name of an area of the hall.
    #[schemars(length(min = 1, max = Area::NAME), regex(pattern = AREA_NAME))]
    pub area: String,
    /// Name of the person in charge, in one line of visible characters.
    #[schemars(length(min = 1, max = Note::MOST), regex(pattern = NAME))]
    pub name: String,
    /// Remark, in one line of visible characters.
    #[schemars(length(max = Note::MOST), regex(pattern = VISIBLE))]
    pub note: Option<String>,
    /// Number of the mission that the sender means. The command is refused if another mission is under way.
    #[schemars(range(max = u64::MAX))]
    pub mission: Option<u64>,
}

/// The names that `Area::is_name` accepts: like `VISIBLE`, without blanks at both ends.
const AREA_NAME: &str = concat!(
    r"^[^\s\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]",
    r"([^\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]*",
    r"[^\s\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff])?$"
);

impl Body for AreaBody {
    const FIELDS: &'static [&'static str] = &["x", "y", "toX", "toY", "area", "epoch"];

    fn taken(fields: &BodyFields) -> Result<AreaBody, Unusable> {
        let [x, y, to_x, to_y] = ["x", "y", "toX", "toY"].map(|name| fields.whole(name));
        let epoch = fields.count("epoch")?;
        match (fields.text("area")?, x?, y?, to_x?, to_y?) {
            (None, Some(x), Some(y), Some(to_x), Some(to_y)) => Ok(AreaBody::Corners { x, y, to_x, to_y, epoch }),
            (Some(area), None, None, None, None) => Ok(AreaBody::Named { area, epoch }),
            _ => Err(Unusable(
                "give either two corners, as {\"x\":1,\"y\":1,\"toX\":4,\"toY\":3}, or a name, as {\"area\":\"gate 1\"}"
                    .to_owned(),
            )),
        }
    }
}

impl Body for OrderAreasBody {
    const FIELDS: &'static [&'static str] = &["areas"];

    fn taken(fields: &BodyFields) -> Result<OrderAreasBody, Unusable> {
        Ok(OrderAreasBody { areas: needed(fields.texts("areas")?, "areas", "{\"areas\":[\"gate 1\",\"gate 2\"]}")? })
    }
}

impl Body for CloseAreaBody {
    const FIELDS: &'static [&'static str] = &["area", "name", "note", "mission"];

    fn taken(fields: &BodyFields) -> Result<CloseAreaBody, Unusable> {
        let text = |name| needed(fields.text(name)?, name, "{\"area\":\"gate 1\",\"name\":\"Anna Rossi\"}");
        let (area, name) = (text("area")?, text("name")?);
        Ok(CloseAreaBody { area, name, note: fields.text("note")?, mission: fields.count("mission")? })
    }
}

impl AreaBody {
    pub fn command(self) -> Result<(Command, Option<Epoch>), Unusable> {
        let (again, epoch) = match self {
            AreaBody::Corners { x, y, to_x, to_y, epoch } => {
                (Again::Within(Bounds::of(cell(x, y)?).including(cell(to_x, to_y)?)), epoch)
            }
            AreaBody::Named { area, epoch } => (Again::Area(area_name(&area)?), epoch),
        };
        Ok((Command::SearchAgain(again), epoch.map(Epoch)))
    }
}

impl OrderAreasBody {
    pub fn command(&self) -> Result<Command, Unusable> {
        let (count, most) = (self.areas.len(), Area::MOST);
        if count > most {
            return Err(Unusable(format!("areas has {count} names: a hall has at most {most} areas")));
        }
        let twice = self.areas.iter().enumerate().find(|(n, name)| self.areas[..*n].contains(name));
        if let Some((_, name)) = twice {
            return Err(Unusable(format!("areas has the name {:?} twice: send it once", in_short(name))));
        }
        self.areas.iter().map(|name| area_name(name)).collect::<Result<_, _>>().map(Command::OrderAreas)
    }
}

impl CloseAreaBody {
    pub fn command(&self) -> Result<Command, Unusable> {
        let (area, name, note) = (area_name(&self.area)?, person(&self.name)?, note(self.note.as_deref())?);
        Ok(Command::CloseArea(AreaClosing { area, name, note, mission: self.mission.map(MissionId) }))
    }
}

fn area_name(text: &str) -> Result<Arc<str>, Unusable> {
    let (short, most) = (in_short(text), Area::NAME);
    let wrong = || Unusable(format!("{short:?} is no name of an area: send one line of 1 to {most} visible characters"));
    Area::is_name(text).then(|| text.into()).ok_or_else(wrong)
}
