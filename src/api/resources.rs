//! THE TABLE of resources, from which every door makes its own: HTTP its routes, CoAP its paths and what discovery says of them, MQTT its
//! state topics, and all of them their pages. A new resource is one row here, and how it is written. What one door alone has (the past,
//! the list of links, the items of old clients) stands there.

use serde::Serialize;

use super::luggage::LuggageJson;
use super::map::{MapJson, map_revision};
use super::mission::StrategyJson;
use super::state::{self, StateJson};
use super::{cbor, map_text, old_items, senml, text};
use hallsweep_core::units::{LuggageId, Revision};
use hallsweep_core::world::resource::Resource;
use hallsweep_core::world::snapshot::Snapshot;

/// Something to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ResourceKind {
    /// Everything at one revision.
    State,
    /// The order of the search.
    Strategy,
    Of(Resource),
    /// One piece of luggage.
    Piece,
    /// Its photo, which is made of no snapshot.
    Photo,
}

/// A way to write it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    Json,
    Cbor,
    Text,
    /// Sensor measurements in JSON (RFC 8428).
    Senml,
    Picture,
}

/// One resource.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub kind: ResourceKind,
    /// The last word of its topic, and what kind of thing it is for discovery.
    pub name: &'static str,
    /// Its path under `/api/v1` and at the CoAP door; `{id}` stands for a number.
    pub path: &'static str,
    pub title: &'static str,
    /// The first is for whoever names none.
    pub forms: &'static [Form],
    pub is_observable: bool,
}

const SHAPES: &[Form] = &[Form::Json, Form::Cbor];
const WITH_TEXT: &[Form] = &[Form::Json, Form::Cbor, Form::Text];
const MEASURED: &[Form] = &[Form::Json, Form::Cbor, Form::Text, Form::Senml];

/// All of them, in the order in which they are listed.
#[rustfmt::skip]
pub const RESOURCES: [Row; 11] = [
    row(ResourceKind::State, "state", "/state", "Everything at one revision", SHAPES),
    row(ResourceKind::Strategy, "strategy", "/strategy", "The order of the search", WITH_TEXT),
    of(Resource::Mission, "/mission", "Phase, holds, goal and progress", WITH_TEXT),
    of(Resource::Robot, "/robot", "What the robot does, and where", MEASURED),
    of(Resource::Map, "/map", "The hall as far as it is known", WITH_TEXT),
    of(Resource::Luggage, "/luggage", "The luggage of this mission", SHAPES),
    of(Resource::Temperature, "/temperature", "The temperature, and what follows", MEASURED),
    of(Resource::Alarms, "/alarms", "The alarms", SHAPES),
    of(Resource::Log, "/log", "The latest lines of the log", SHAPES),
    row(ResourceKind::Piece, "piece", "/luggage/{id}", "A piece of luggage", SHAPES),
    Row { is_observable: false, ..row(ResourceKind::Photo, "photo", "/luggage/{id}/photo", "Its photo", &[Form::Picture]) },
];

const fn of(resource: Resource, path: &'static str, title: &'static str, forms: &'static [Form]) -> Row {
    row(ResourceKind::Of(resource), resource.name(), path, title, forms)
}

const fn row(kind: ResourceKind, name: &'static str, path: &'static str, title: &'static str, forms: &'static [Form]) -> Row {
    Row { kind, name, path, title, forms, is_observable: true }
}

impl ResourceKind {
    pub fn row(self) -> &'static Row {
        const { &RESOURCES }.iter().find(|row| row.kind == self).expect("everything that is shown has its row: a test holds that")
    }

    /// When it last changed. A map shows the robot, too.
    pub fn revision(self, snapshot: &Snapshot) -> Revision {
        match self {
            ResourceKind::State => snapshot.revision,
            ResourceKind::Strategy => snapshot.revision_of(Resource::Mission),
            ResourceKind::Of(Resource::Map) => map_revision(snapshot),
            ResourceKind::Of(resource) => snapshot.revision_of(resource),
            ResourceKind::Piece | ResourceKind::Photo => snapshot.revision_of(Resource::Luggage),
        }
    }

    /// It in this form; `number` says which where there are several, `located` where a photo is by the door that asks. Nothing where
    /// nothing is to be shown.
    pub fn written(self, number: u64, form: Form, snapshot: &Snapshot, located: fn(LuggageJson) -> LuggageJson) -> Vec<u8> {
        let piece = |piece| located(LuggageJson::from(piece));
        let pieces = || snapshot.luggage.iter().map(|found| piece(&**found)).collect();
        match (self, form) {
            (ResourceKind::State, _) => shape(form, &StateJson { luggage: pieces(), ..StateJson::from(snapshot) }),
            (ResourceKind::Strategy, Form::Text) => snapshot.mission.strategy.name().into(),
            (ResourceKind::Strategy, _) => shape(form, &StrategyJson::from(snapshot.mission.strategy)),
            (ResourceKind::Of(Resource::Mission), Form::Text) => text::mission(&snapshot.mission).into(),
            (ResourceKind::Of(Resource::Mission), _) => shape(form, &state::mission(snapshot)),
            (ResourceKind::Of(Resource::Robot), Form::Text) => old_items::robot(&snapshot.robot).into(),
            (ResourceKind::Of(Resource::Robot), Form::Senml) => senml::robot(&snapshot.robot).into(),
            (ResourceKind::Of(Resource::Robot), _) => shape(form, &state::robot(snapshot)),
            (ResourceKind::Of(Resource::Map), Form::Text) => map_text::lines(snapshot).into(),
            (ResourceKind::Of(Resource::Map), _) => shape(form, &MapJson::from(snapshot)),
            (ResourceKind::Of(Resource::Luggage), _) => shape::<Vec<_>>(form, &pieces()),
            (ResourceKind::Of(Resource::Temperature), Form::Text) => text::temperature(&snapshot.temperature).into(),
            (ResourceKind::Of(Resource::Temperature), Form::Senml) => senml::temperature(&snapshot.temperature).into(),
            (ResourceKind::Of(Resource::Temperature), _) => shape(form, &state::temperature(snapshot)),
            (ResourceKind::Of(Resource::Alarms), _) => shape(form, &state::alarms(snapshot)),
            (ResourceKind::Of(Resource::Log), _) => shape(form, &state::log_after(snapshot, 0)),
            (ResourceKind::Piece, _) => {
                snapshot.luggage(LuggageId(number)).map(|found| shape(form, &piece(&**found))).unwrap_or_default()
            }
            (ResourceKind::Photo, _) => Vec::new(),
        }
    }
}

/// A shape of the wire in CBOR when that is the form, else in JSON.
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
    use super::*;

    #[test]
    fn everything_that_has_a_revision_has_its_row_and_topic() {
        for resource in Resource::ALL {
            assert_eq!(ResourceKind::Of(resource).row().path, format!("/{}", ResourceKind::Of(resource).row().name));
        }
    }

    #[test]
    fn nothing_is_in_the_table_twice() {
        for said in [|row: &Row| row.path, |row: &Row| row.name, |row: &Row| row.title] {
            let mut all: Vec<&str> = RESOURCES.iter().map(said).collect();
            all.sort_unstable();
            all.dedup();
            assert_eq!(all.len(), RESOURCES.len());
        }
        assert!(RESOURCES.iter().all(|row| row.kind.row().name == row.name));
    }
}
