//! JSON Schemas (2020-12) of all messages, derived from their Rust types, for a door that describes itself to
//! programs. The schema for each row of a table is chosen here. The door decides what to do with the schema.

use schemars::generate::{SchemaGenerator, SchemaSettings};
use schemars::{JsonSchema, Schema};
use serde_json::{Map, Value};

use super::alarm::AlarmJson;
use super::command::{
    AreaBody, CloseAreaBody, CloseBody, EpochBody, GotoBody, HandOverBody, MoveBody, OrderAreasBody, RetrieveBody, StrategyBody,
    TemperatureBody, VerdictBody,
};
use super::commands::CommandKind;
use super::coverage::CoverageJson;
use super::log::LogLineJson;
use super::luggage::LuggageJson;
use super::map::MapJson;
use super::mission::{MissionJson, StrategyJson};
use super::resources::ResourceKind;
use super::retrieval::RetrievalJson;
use super::robot::RobotJson;
use super::state::StateJson;
use super::temperature::TemperatureJson;
use hallsweep_core::world::resource::Resource;

const PLACE: &str = "/components/schemas";

pub struct Schemas {
    /// Makes schemas for sending: nullable fields are always present.
    sent: SchemaGenerator,
    /// Makes schemas for receiving: nullable fields may be absent.
    taken: SchemaGenerator,
}

impl Default for Schemas {
    fn default() -> Schemas {
        let settings = || SchemaSettings::draft2020_12().with(|settings| settings.definitions_path = PLACE.into());
        Schemas { sent: settings().for_serialize().into_generator(), taken: settings().into_generator() }
    }
}

impl Schemas {
    pub fn sent<T: JsonSchema>(&mut self) -> Value {
        plain(self.sent.subschema_for::<T>())
    }

    pub fn taken<T: JsonSchema>(&mut self) -> Value {
        plain(self.taken.subschema_for::<T>())
    }

    /// Returns the schema of a resource in JSON; `None` for a picture.
    pub fn resource(&mut self, kind: ResourceKind) -> Option<Value> {
        Some(match kind {
            ResourceKind::State => self.sent::<StateJson>(),
            ResourceKind::Strategy => self.sent::<StrategyJson>(),
            ResourceKind::Of(Resource::Mission) => self.sent::<MissionJson>(),
            ResourceKind::Of(Resource::Robot) => self.sent::<RobotJson>(),
            ResourceKind::Of(Resource::Map) => self.sent::<MapJson>(),
            ResourceKind::Of(Resource::Coverage) => self.sent::<CoverageJson>(),
            ResourceKind::Of(Resource::Luggage) => self.sent::<Vec<LuggageJson>>(),
            ResourceKind::Of(Resource::Temperature) => self.sent::<TemperatureJson>(),
            ResourceKind::Of(Resource::Alarms) => self.sent::<Vec<AlarmJson>>(),
            ResourceKind::Of(Resource::Retrieval) => self.sent::<RetrievalJson>(),
            ResourceKind::Of(Resource::Log) => self.sent::<Vec<LogLineJson>>(),
            ResourceKind::Piece => self.sent::<LuggageJson>(),
            ResourceKind::Photo => return None,
        })
    }

    /// Returns the schema of a command's body; `None` for STOP, because its body is not read.
    pub fn body(&mut self, kind: CommandKind) -> Option<Value> {
        Some(match kind {
            CommandKind::Stop => return None,
            CommandKind::Start
            | CommandKind::BackHome
            | CommandKind::GoOn
            | CommandKind::Reset
            | CommandKind::Retake
            | CommandKind::Acknowledge => self.taken::<EpochBody>(),
            CommandKind::Retrieve => self.taken::<RetrieveBody>(),
            CommandKind::Close => self.taken::<CloseBody>(),
            CommandKind::HandOver => self.taken::<HandOverBody>(),
            CommandKind::SearchAgain => self.taken::<AreaBody>(),
            CommandKind::OrderAreas => self.taken::<OrderAreasBody>(),
            CommandKind::CloseArea => self.taken::<CloseAreaBody>(),
            CommandKind::Move => self.taken::<MoveBody>(),
            CommandKind::Goto => self.taken::<GotoBody>(),
            CommandKind::Verdict => self.taken::<VerdictBody>(),
            CommandKind::Strategy => self.taken::<StrategyBody>(),
            CommandKind::Temperature => self.taken::<TemperatureBody>(),
        })
    }

    pub fn shapes(mut self) -> Map<String, Value> {
        let all = self.taken.take_definitions(true).into_iter().chain(self.sent.take_definitions(true));
        all.map(|(name, schema)| (public(&name).to_owned(), renamed(schema))).collect()
    }
}

fn plain(schema: Schema) -> Value {
    renamed(schema.into())
}

fn renamed(mut schema: Value) -> Value {
    match &mut schema {
        Value::Object(fields) => {
            for (name, value) in fields.iter_mut() {
                let referred = value.as_str().filter(|_| name == "$ref").and_then(|to| to.rsplit_once('/'));
                *value = match referred {
                    Some((place, shape)) => format!("{place}/{}", public(shape)).into(),
                    None => renamed(value.take()),
                };
            }
        }
        Value::Array(values) => values.iter_mut().for_each(|value| *value = renamed(value.take())),
        Value::Null | Value::Bool(_) | Value::Number(_) | Value::String(_) => {}
    }
    schema
}

/// Removes the suffix `Json` from the name of a schema. The suffix means something only to programmers of this
/// program.
fn public(name: &str) -> &str {
    name.strip_suffix("Json").unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::api::commands::COMMANDS;
    use crate::api::fields::Body;
    use crate::api::resources::RESOURCES;
    use crate::api::simulator::{ChangeBody, HallBody};

    fn fields(schema: &Value, shapes: &Map<String, Value>) -> BTreeSet<String> {
        let mut names = BTreeSet::new();
        if let Some(name) = schema["$ref"].as_str().and_then(|to| to.rsplit('/').next()) {
            names.extend(fields(&shapes[name], shapes));
        }
        names.extend(schema["properties"].as_object().into_iter().flatten().map(|(name, _)| name.clone()));
        names.extend(
            ["oneOf", "anyOf"]
                .into_iter()
                .filter_map(|forms| schema[forms].as_array())
                .flatten()
                .flat_map(|form| fields(form, shapes)),
        );
        names
    }

    fn check<T: Body + JsonSchema>() {
        let mut schemas = Schemas::default();
        let schema = schemas.taken::<T>();
        let shown = fields(&schema, &schemas.shapes());
        assert_eq!(shown, T::FIELDS.iter().map(|name| (*name).to_owned()).collect(), "{schema}");
    }

    #[test]
    fn a_body_is_described_with_the_fields_that_are_read() {
        check::<EpochBody>();
        check::<MoveBody>();
        check::<GotoBody>();
        check::<AreaBody>();
        check::<HandOverBody>();
        check::<OrderAreasBody>();
        check::<CloseAreaBody>();
        check::<VerdictBody>();
        check::<StrategyBody>();
        check::<TemperatureBody>();
        check::<ChangeBody>();
        check::<HallBody>();
    }

    #[test]
    fn every_row_of_the_tables_is_described_and_every_reference_leads_somewhere() {
        let mut schemas = Schemas::default();
        let shown: Vec<Value> = RESOURCES.iter().filter_map(|row| schemas.resource(row.kind)).collect();
        assert_eq!(shown.len(), RESOURCES.len() - 1, "all but the picture");
        let bodies: Vec<Value> = COMMANDS.iter().filter_map(|row| schemas.body(row.kind)).collect();
        assert_eq!(bodies.len(), COMMANDS.len() - 1, "all but STOP's");
        let written: BTreeSet<&String> = schemas.sent.definitions().keys().chain(schemas.taken.definitions().keys()).collect();
        let named: BTreeSet<&str> = written.iter().map(|name| public(name)).collect();
        assert_eq!(named.len(), written.len(), "two shapes have one name: {written:?}");
        let shapes = schemas.shapes();
        let all = serde_json::to_string(&(&shown, &bodies, &shapes)).unwrap();
        for referred in all.split("\"#/components/schemas/").skip(1).filter_map(|rest| rest.split('"').next()) {
            assert!(shapes.contains_key(referred), "{referred}");
        }
        for (name, schema) in &shapes {
            assert!(!name.ends_with(|last: char| last.is_ascii_digit()), "two shapes are called {name}");
            assert!(!schema.to_string().contains("Json`"), "{name} is described to programmers of this program: {schema}");
        }
    }

    #[test]
    fn what_is_null_where_it_is_not_there_is_always_there() {
        let mut schemas = Schemas::default();
        schemas.sent::<StateJson>();
        let shapes = schemas.shapes();
        let required = shapes["Mission"]["required"].as_array().unwrap();
        assert!(required.contains(&"goal".into()) && required.contains(&"fault".into()), "{required:?}");
        assert_eq!(shapes["Phase"]["enum"].as_array().unwrap().len(), 12);
        assert_eq!(shapes["Mission"]["properties"]["phase"]["$ref"], "#/components/schemas/Phase");
    }
}
