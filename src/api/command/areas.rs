//! The bodies of commands about areas: which come first, which one is closed, and what is searched again.

use std::borrow::Cow;
use std::sync::Arc;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde_json::json;

use super::{NAME, Unusable, VISIBLE, cell, note, person};
use crate::api::fields::{Body, BodyFields, in_short, needed};
use hallsweep_core::closing::AreaClosing;
use hallsweep_core::command::{Again, Command, Note};
use hallsweep_core::units::{Epoch, MissionId};
use hallsweep_core::world::areas::Area;
use hallsweep_core::world::hall_map::{Bounds, REACH};

/// Area that was searched, by two opposite corners, as `{"x":1,"y":1,"toX":4,"toY":3}`, or by its name, as
/// `{"area":"gate 1"}`.
#[derive(Clone, Debug)]
pub struct AreaBody {
    command: Command,
    epoch: Option<u64>,
}

/// Names of the areas that are to be searched first, as `{"areas":["gate 1","gate 2"]}`. An empty list leaves the
/// order to the search.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct OrderAreasBody {
    /// Names of areas of the hall, each at most once. Areas without a place come after these.
    #[schemars(length(max = Area::MOST), inner(length(min = 1, max = Area::NAME), regex(pattern = AREA_NAME)), extend("uniqueItems" = true))]
    areas: Vec<String>,
}

/// Statement of the person in charge about an area, as `{"area":"gate 1","name":"Anna Rossi"}`.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct CloseAreaBody {
    /// Name of an area of the hall.
    #[schemars(length(min = 1, max = Area::NAME), regex(pattern = AREA_NAME))]
    area: String,
    /// Name of the person in charge, in one line of visible characters.
    #[schemars(length(min = 1, max = Note::MOST), regex(pattern = NAME))]
    name: String,
    /// Remark, in one line of visible characters.
    #[schemars(length(max = Note::MOST), regex(pattern = VISIBLE))]
    note: Option<String>,
    /// Number of the mission that the sender means. The command is refused if another mission is under way.
    #[schemars(range(max = u64::MAX))]
    mission: Option<u64>,
}

/// The names that `Area::is_name` accepts: like `VISIBLE`, without blanks at both ends.
const AREA_NAME: &str = concat!(
    r"^[^\s\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]",
    r"([^\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]*",
    r"[^\s\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff])?$"
);

impl JsonSchema for AreaBody {
    fn schema_name() -> Cow<'static, str> {
        "AreaBody".into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        let side = |what| json!({"description": what, "type": "integer", "minimum": -REACH, "maximum": REACH});
        let epoch = json!({
            "description": "Epoch that the sender saw last. The command is refused if a stop has happened since then.",
            "type": ["integer", "null"], "minimum": 0, "maximum": u64::MAX,
        });
        let name = json!({"description": "Name of an area of the hall. If the area was closed, it is open again.",
            "type": "string", "minLength": 1, "maxLength": Area::NAME, "pattern": AREA_NAME});
        let corners = json!({
            "x": side("Column of a corner, growing to the east."),
            "y": side("Row of this corner, growing to the south."),
            "toX": side("Column of the opposite corner."),
            "toY": side("Row of the opposite corner."),
            "epoch": epoch,
        });
        let object = |properties, required| json!({"type": "object", "properties": properties, "required": required, "additionalProperties": false});
        json_schema!({
            "description": "Area that was searched, by two opposite corners or by its name.",
            "oneOf": [
                object(corners, json!(["x", "y", "toX", "toY"])),
                object(json!({"area": name, "epoch": epoch}), json!(["area"])),
            ],
        })
    }
}

impl Body for AreaBody {
    const FIELDS: &'static [&'static str] = &["x", "y", "toX", "toY", "area", "epoch"];

    fn taken(fields: &BodyFields) -> Result<AreaBody, Unusable> {
        let example = "{\"x\":1,\"y\":1,\"toX\":4,\"toY\":3} or {\"area\":\"gate 1\"}";
        let side = |name| needed(fields.whole(name)?, name, example);
        let command = match fields.text("area")? {
            Some(_) if ["x", "y", "toX", "toY"].into_iter().any(|name| fields.has(name)) => {
                return Err(Unusable(format!("give either two corners or the name of an area: send {example}")));
            }
            Some(name) => search_area_again(&name)?,
            None => search_again((side("x")?, side("y")?), (side("toX")?, side("toY")?))?,
        };
        Ok(AreaBody { command, epoch: fields.count("epoch")? })
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
    pub fn command(self) -> (Command, Option<Epoch>) {
        (self.command, self.epoch.map(Epoch))
    }
}

impl OrderAreasBody {
    pub fn command(&self) -> Result<Command, Unusable> {
        order_areas(self.areas.iter().map(String::as_str))
    }
}

impl CloseAreaBody {
    pub fn command(&self) -> Result<Command, Unusable> {
        close_area(&self.area, &self.name, self.note.as_deref(), self.mission)
    }
}

/// Reads the statement of the person in charge about an area.
pub fn close_area(area: &str, name: &str, note_of: Option<&str>, mission: Option<u64>) -> Result<Command, Unusable> {
    let (area, name, note) = (area_name(area)?, person(name)?, note_of.map(note).transpose()?.flatten());
    Ok(Command::CloseArea(AreaClosing { area, name, note, mission: mission.map(MissionId) }))
}

/// Reads the names of the areas that are to be searched first.
pub fn order_areas<'a>(names: impl ExactSizeIterator<Item = &'a str>) -> Result<Command, Unusable> {
    let (count, most) = (names.len(), Area::MOST);
    if count > most {
        return Err(Unusable(format!("areas has {count} names: a hall has at most {most} areas")));
    }
    let names = names.map(area_name).collect::<Result<Vec<Arc<str>>, Unusable>>()?;
    let twice = names.iter().enumerate().find(|(n, name)| names[..*n].contains(name));
    match twice {
        Some((_, name)) => Err(Unusable(format!("areas has the name {:?} twice: send it once", in_short(name)))),
        None => Ok(Command::OrderAreas(names.into())),
    }
}

fn area_name(text: &str) -> Result<Arc<str>, Unusable> {
    let wrong = || {
        let most = Area::NAME;
        Unusable(format!("{:?} is no name of an area: send one line of 1 to {most} visible characters", in_short(text)))
    };
    Area::is_name(text).then(|| Arc::from(text)).ok_or_else(wrong)
}

/// Reads an area from two opposite corners, in any order.
pub fn search_again(one: (i64, i64), other: (i64, i64)) -> Result<Command, Unusable> {
    let bounds = Bounds::of(cell(one.0, one.1)?).including(cell(other.0, other.1)?);
    Ok(Command::SearchAgain(Again::Within(bounds)))
}

pub fn search_area_again(name: &str) -> Result<Command, Unusable> {
    Ok(Command::SearchAgain(Again::Area(area_name(name)?)))
}
