//! The body of the command that says which areas come first.

use std::sync::Arc;

use schemars::JsonSchema;

use super::Unusable;
use crate::api::fields::{Body, BodyFields, in_short, needed};
use hallsweep_core::command::Command;
use hallsweep_core::world::areas::Area;

/// Names of the areas that are to be searched first, as `{"areas":["gate 1","gate 2"]}`. An empty list leaves the
/// order to the search.
#[derive(Clone, Debug, JsonSchema)]
#[schemars(deny_unknown_fields)]
pub struct OrderAreasBody {
    /// Names of areas of the hall, each at most once. Areas without a place come after these.
    #[schemars(length(max = Area::MOST), inner(length(min = 1, max = Area::NAME), regex(pattern = AREA_NAME)), extend("uniqueItems" = true))]
    areas: Vec<String>,
}

/// The names that `Area::is_name` accepts: like `VISIBLE`, without blanks at both ends.
const AREA_NAME: &str = concat!(
    r"^[^\s\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]",
    r"([^\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff]*",
    r"[^\s\u0000-\u001f\u007f-\u009f\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff])?$"
);

impl Body for OrderAreasBody {
    const FIELDS: &'static [&'static str] = &["areas"];

    fn taken(fields: &BodyFields) -> Result<OrderAreasBody, Unusable> {
        Ok(OrderAreasBody { areas: needed(fields.texts("areas")?, "areas", "{\"areas\":[\"gate 1\",\"gate 2\"]}")? })
    }
}

impl OrderAreasBody {
    pub fn command(&self) -> Result<Command, Unusable> {
        order_areas(self.areas.iter().map(String::as_str))
    }
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
