//! THE TABLE of resources. Every door derives its addresses from this table: HTTP its routes, CoAP its paths and
//! discovery, MQTT its state topics. The lists of resources in `docs/` are derived from it, too.
//! `docs/architecture.md`, *How to add*, lists what a new resource needs beside its row. Resources that only one door
//! has (the past, the list of links, the items of old clients) are in that door.

use serde::Serialize;
use serde_json::Value;

use super::coverage::CoverageJson;
use super::luggage::LuggageJson;
use super::map::{MapJson, map_revision};
use super::mission::StrategyJson;
use super::state::{self, StateJson};
use super::{cbor, coverage, map_text, old_items, senml, text};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::{LuggageId, Revision};
use hallsweep_core::world::luggage::Luggage;
use hallsweep_core::world::resource::Resource;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ResourceKind {
    State,
    Strategy,
    Of(Resource),
    Piece,
    /// Photo of a piece. Snapshots do not contain photos.
    Photo,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    Json,
    Cbor,
    Text,
    /// Sensor measurements in JSON (SenML, RFC 8428).
    Senml,
    Picture,
}

#[derive(Clone, Copy, Debug)]
pub struct ResourceRow {
    pub kind: ResourceKind,
    /// Resource type in discovery. For parts of the state, also the last part of the MQTT topic.
    pub name: &'static str,
    /// Path under `/api/v1` and at the CoAP door; `{id}` stands for a number.
    pub path: &'static str,
    pub title: &'static str,
    /// The first form is the default.
    pub forms: &'static [Form],
    pub is_observable: bool,
}

const SHAPES: &[Form] = &[Form::Json, Form::Cbor];
const WITH_TEXT: &[Form] = &[Form::Json, Form::Cbor, Form::Text];
const MEASURED: &[Form] = &[Form::Json, Form::Cbor, Form::Text, Form::Senml];

/// The doors and `docs/` list the resources in this order.
#[rustfmt::skip]
pub const RESOURCES: [ResourceRow; 13] = [
    row(ResourceKind::State, "state", "/state", "The whole state at one revision", SHAPES),
    row(ResourceKind::Strategy, "strategy", "/strategy", "The search strategy", WITH_TEXT),
    of(Resource::Mission, "/mission", "Phase, holds, goal and progress", WITH_TEXT),
    of(Resource::Robot, "/robot", "Activity and place of the robot", MEASURED),
    of(Resource::Map, "/map", "The known part of the hall", WITH_TEXT),
    of(Resource::Coverage, "/coverage", "How far the hall and its areas are searched", WITH_TEXT),
    of(Resource::Luggage, "/luggage", "The luggage of this mission", SHAPES),
    of(Resource::Temperature, "/temperature", "The temperature and its effect", MEASURED),
    of(Resource::Alarms, "/alarms", "The alarms", SHAPES),
    of(Resource::Retrieval, "/retrieval", "The retrieval and its behaviour trees", WITH_TEXT),
    of(Resource::Log, "/log", "The latest lines of the log", SHAPES),
    row(ResourceKind::Piece, "piece", "/luggage/{id}", "A piece of luggage", SHAPES),
    ResourceRow { is_observable: false,
        ..row(ResourceKind::Photo, "photo", "/luggage/{id}/photo", "Photo of a piece of luggage", &[Form::Picture]) },
];

const fn of(resource: Resource, path: &'static str, title: &'static str, forms: &'static [Form]) -> ResourceRow {
    row(ResourceKind::Of(resource), resource.name(), path, title, forms)
}

const fn row(
    kind: ResourceKind,
    name: &'static str,
    path: &'static str,
    title: &'static str,
    forms: &'static [Form],
) -> ResourceRow {
    ResourceRow { kind, name, path, title, forms, is_observable: true }
}

impl ResourceKind {
    pub fn row(self) -> &'static ResourceRow {
        const { &RESOURCES }.iter().find(|row| row.kind == self).expect("every resource has its row, as a test shows")
    }

    /// The revision at which the resource last changed. The map counts as changed whenever the robot changes, because
    /// the map shows the robot.
    pub fn revision(self, snapshot: &Snapshot) -> Revision {
        match self {
            ResourceKind::State => snapshot.revision,
            ResourceKind::Strategy => snapshot.revision_of(Resource::Mission),
            ResourceKind::Of(Resource::Map) => map_revision(snapshot),
            ResourceKind::Of(Resource::Coverage) => map_revision(snapshot).max(snapshot.revision_of(Resource::Mission)),
            ResourceKind::Of(resource) => snapshot.revision_of(resource),
            ResourceKind::Piece | ResourceKind::Photo => snapshot.revision_of(Resource::Luggage),
        }
    }

    /// Writes the resource in this form. `number` selects the piece of luggage. `located` adapts the photo's address
    /// to the door. The result is empty if there is nothing to show, or nothing in this form.
    pub fn written(self, number: u64, form: Form, snapshot: &Snapshot, located: fn(LuggageJson) -> LuggageJson) -> Vec<u8> {
        match form {
            Form::Json | Form::Cbor => self.shaped(number, form, snapshot, located),
            Form::Text => self.text(snapshot).into(),
            Form::Senml => self.senml(snapshot).into(),
            Form::Picture => Vec::new(),
        }
    }

    fn text(self, snapshot: &Snapshot) -> String {
        match self {
            ResourceKind::Strategy => snapshot.mission.strategy.name().to_owned(),
            ResourceKind::Of(Resource::Mission) => text::mission(&snapshot.mission),
            ResourceKind::Of(Resource::Robot) => old_items::robot(&snapshot.robot),
            ResourceKind::Of(Resource::Map) => map_text::lines(snapshot),
            ResourceKind::Of(Resource::Coverage) => coverage::lines(&snapshot.searched()),
            ResourceKind::Of(Resource::Temperature) => text::temperature(&snapshot.temperature),
            ResourceKind::Of(Resource::Retrieval) => text::retrieval(snapshot),
            ResourceKind::Of(Resource::Luggage | Resource::Alarms | Resource::Log)
            | ResourceKind::State
            | ResourceKind::Piece
            | ResourceKind::Photo => String::new(),
        }
    }

    fn senml(self, snapshot: &Snapshot) -> String {
        match self {
            ResourceKind::Of(Resource::Robot) => senml::robot(&snapshot.robot),
            ResourceKind::Of(Resource::Temperature) => senml::temperature(&snapshot.temperature),
            ResourceKind::Of(
                Resource::Mission
                | Resource::Map
                | Resource::Coverage
                | Resource::Luggage
                | Resource::Alarms
                | Resource::Retrieval
                | Resource::Log,
            )
            | ResourceKind::State
            | ResourceKind::Strategy
            | ResourceKind::Piece
            | ResourceKind::Photo => String::new(),
        }
    }

    fn shaped(self, number: u64, form: Form, snapshot: &Snapshot, located: fn(LuggageJson) -> LuggageJson) -> Vec<u8> {
        let piece = |found: &Luggage| located(LuggageJson::new(found, snapshot.hall.as_ref()));
        let pieces = || snapshot.luggage.iter().map(|found| piece(found)).collect::<Vec<_>>();
        match self {
            ResourceKind::State => marked(snapshot, form, &StateJson::new(snapshot, pieces())),
            ResourceKind::Strategy => marked(snapshot, form, &StrategyJson::from(snapshot.mission.strategy)),
            ResourceKind::Of(Resource::Mission) => marked(snapshot, form, &state::mission(snapshot)),
            ResourceKind::Of(Resource::Robot) => marked(snapshot, form, &state::robot(snapshot)),
            ResourceKind::Of(Resource::Map) => marked(snapshot, form, &MapJson::from(snapshot)),
            ResourceKind::Of(Resource::Coverage) => marked(snapshot, form, &CoverageJson::new(snapshot, self.revision(snapshot))),
            ResourceKind::Of(Resource::Luggage) => marked(snapshot, form, &pieces()),
            ResourceKind::Of(Resource::Temperature) => marked(snapshot, form, &state::temperature(snapshot)),
            ResourceKind::Of(Resource::Alarms) => marked(snapshot, form, &state::alarms(snapshot)),
            ResourceKind::Of(Resource::Retrieval) => marked(snapshot, form, &state::retrieval(snapshot)),
            ResourceKind::Of(Resource::Log) => marked(snapshot, form, &state::log_after(snapshot, 0)),
            ResourceKind::Piece => {
                snapshot.luggage(LuggageId(number)).map(|found| marked(snapshot, form, &piece(found))).unwrap_or_default()
            }
            ResourceKind::Photo => Vec::new(),
        }
    }
}

/// Writes a resource. In an exercise, each object of the resource says so.
pub fn marked<T: Serialize>(snapshot: &Snapshot, form: Form, value: &T) -> Vec<u8> {
    if !snapshot.mission.is_exercise {
        return shape(form, value);
    }
    let mut value = serde_json::to_value(value).expect("the shapes of the wire are what JSON can hold");
    let objects = if let Value::Array(list) = &mut value { list.iter_mut().collect() } else { vec![&mut value] };
    for fields in objects.into_iter().filter_map(Value::as_object_mut) {
        fields.insert("exercise".to_owned(), Value::Bool(true));
    }
    shape(form, &value)
}

pub fn shape<T: Serialize>(form: Form, shape: &T) -> Vec<u8> {
    match form {
        Form::Cbor => cbor::written(shape),
        Form::Json | Form::Text | Form::Senml | Form::Picture => {
            serde_json::to_vec(shape).expect("the shapes of the wire are texts, numbers, lists and maps, which JSON can hold")
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::api::tests::fixture::{searching, touch};

    /// Returns the next kind, so that a test can list all kinds. A new kind does not compile until it is added here.
    fn next(kind: ResourceKind) -> Option<ResourceKind> {
        match kind {
            ResourceKind::State => Some(ResourceKind::Strategy),
            ResourceKind::Strategy => Some(ResourceKind::Piece),
            ResourceKind::Piece => Some(ResourceKind::Photo),
            ResourceKind::Photo => Some(ResourceKind::Of(Resource::ALL[0])),
            ResourceKind::Of(resource) => Resource::ALL.get(resource as usize + 1).copied().map(ResourceKind::Of),
        }
    }

    #[test]
    fn every_kind_has_its_row_and_a_part_of_the_state_its_name_as_path() {
        let kinds: Vec<ResourceKind> = std::iter::successors(Some(ResourceKind::State), |kind| next(*kind)).collect();
        assert_eq!(kinds.len(), RESOURCES.len());
        assert!(kinds.iter().all(|kind| kind.row().kind == *kind));
        assert!(Resource::ALL.into_iter().all(|part| ResourceKind::Of(part).row().path == format!("/{}", part.name())));
    }

    #[test]
    fn what_is_shown_is_new_when_a_part_of_it_is() {
        let new = |part: Resource| -> Vec<&str> {
            let (before, mut after) = (searching(), searching());
            touch(&mut after, 21, &[part]);
            let is_new = |row: &&ResourceRow| row.kind.revision(&before) != row.kind.revision(&after);
            RESOURCES.iter().filter(is_new).map(|row| row.name).collect()
        };
        assert_eq!(new(Resource::Mission), ["state", "strategy", "mission", "coverage"]);
        assert_eq!(new(Resource::Robot), ["state", "robot", "map", "coverage"], "the robot stands in the map");
        assert_eq!(new(Resource::Map), ["state", "map", "coverage"]);
        assert_eq!(new(Resource::Luggage), ["state", "luggage", "piece", "photo"]);
        assert_eq!(new(Resource::Alarms), ["state", "alarms"]);
    }

    #[test]
    fn every_form_of_a_row_is_there_and_another_than_the_first() {
        let state = searching();
        for row in RESOURCES.iter().filter(|row| row.kind != ResourceKind::Photo) {
            let written = |form: &Form| row.kind.written(3, *form, &state, std::convert::identity);
            let forms: BTreeSet<Vec<u8>> = row.forms.iter().map(written).collect();
            assert!(forms.len() == row.forms.len() && forms.iter().all(|body| !body.is_empty()), "{}", row.path);
        }
    }

    #[test]
    fn in_an_exercise_every_object_says_so_and_otherwise_none_does() {
        let mut state = searching();
        for is_exercise in [false, true] {
            state.mission.is_exercise = is_exercise;
            for row in RESOURCES.iter().filter(|row| row.kind != ResourceKind::Photo) {
                let json = row.kind.written(3, Form::Json, &state, std::convert::identity);
                let json: Value = serde_json::from_slice(&json).unwrap();
                let objects = json.as_array().cloned().unwrap_or_else(|| vec![json.clone()]);
                let is_marked = |object: &Value| object.get("exercise") == Some(&Value::Bool(true));
                assert!(objects.iter().all(|object| is_marked(object) == is_exercise), "{}: {json}", row.path);
            }
        }
    }

    #[test]
    fn nothing_is_in_the_table_twice() {
        for said in [|row: &ResourceRow| row.path, |row: &ResourceRow| row.name, |row: &ResourceRow| row.title] {
            let mut all: Vec<&str> = RESOURCES.iter().map(said).collect();
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), RESOURCES.len());
        }
        assert!(RESOURCES.iter().all(|row| row.kind.row().name == row.name));
    }
}
