//! What each resource shows in each of its formats, and when that last changed. The shapes stand in `crate::api`; which resource
//! has which formats, in `table`.

use serde::Serialize;

use super::discovery;
use super::table::Show;
use crate::api::luggage::LuggageJson;
use crate::api::map::{MapJson, map_revision};
use crate::api::mission::StrategyJson;
use crate::api::state::{self, StateJson};
use crate::api::{cbor, map_text, old_items, senml, text};
use coap_endpoint::Format;
use hallsweep_core::units::{LuggageId, Revision};
use hallsweep_core::world::luggage::Luggage;
use hallsweep_core::world::resource::Resource;
use hallsweep_core::world::snapshot::Snapshot;

/// The numbers of the old model's items, in the order in which observers get them.
pub(super) const ROBOT: u64 = 0;
/// The second.
pub(super) const MAP: u64 = 1;
/// The third.
pub(super) const LUGGAGE: u64 = 2;

/// When what is shown last changed.
pub(super) fn revision(show: Show, number: u64, snapshot: &Snapshot) -> Revision {
    let of = |resource| snapshot.revision_of(resource);
    match show {
        Show::State => snapshot.revision,
        Show::Links => of(Resource::Luggage).max(of(Resource::Alarms)),
        Show::OldItems => match number {
            ROBOT => of(Resource::Robot),
            MAP => map_revision(snapshot),
            // Which piece is shown follows from the mission, too.
            _ => of(Resource::Luggage).max(of(Resource::Mission)),
        },
        Show::Of(Resource::Map) => map_revision(snapshot),
        Show::Of(resource) => of(resource),
        Show::Piece | Show::Photo => of(Resource::Luggage),
        Show::Strategy => of(Resource::Mission),
    }
}

/// What is shown in this format; `number` says which where there are several. Nothing where nothing is to be shown.
pub(super) fn body(show: Show, number: u64, format: Format, snapshot: &Snapshot) -> Vec<u8> {
    match show {
        Show::State => whole(format, snapshot),
        Show::Of(resource) => one(resource, format, snapshot),
        Show::Piece => snapshot.luggage(LuggageId(number)).map(|found| written(format, &piece(found))).unwrap_or_default(),
        Show::Strategy if format == Format::TEXT => snapshot.mission.strategy.name().into(),
        Show::Strategy => written(format, &StrategyJson::from(snapshot.mission.strategy)),
        Show::OldItems => old_item(number, snapshot).into(),
        Show::Links => discovery::listing(snapshot, &[]),
        // This is not made of a snapshot alone.
        Show::Photo => Vec::new(),
    }
}

/// A piece of a mission that is over.
pub(super) fn past_piece(found: &Luggage, format: Format) -> Vec<u8> {
    written(format, &piece(found))
}

/// A record, as this door shows it.
pub(super) fn piece(luggage: &Luggage) -> LuggageJson {
    at_this_door(LuggageJson::from(luggage))
}

/// The shape of a record says where its photo is; at this door it is here.
pub(super) fn at_this_door(mut piece: LuggageJson) -> LuggageJson {
    piece.photo.url = piece.photo.url.map(|_| format!("/luggage/{}/photo", piece.id));
    piece
}

/// A shape in CBOR when that is the format, else in JSON.
pub(super) fn written(format: Format, shape: &impl Serialize) -> Vec<u8> {
    if format == Format::CBOR {
        return cbor::written(shape);
    }
    serde_json::to_vec(shape).expect("the shapes of the wire are texts, numbers, lists and maps, which JSON can hold")
}

fn whole(format: Format, snapshot: &Snapshot) -> Vec<u8> {
    let mut state = StateJson::from(snapshot);
    state.luggage = state.luggage.into_iter().map(at_this_door).collect();
    written(format, &state)
}

fn one(resource: Resource, format: Format, snapshot: &Snapshot) -> Vec<u8> {
    match (resource, format) {
        (Resource::Mission, Format::TEXT) => text::mission(&snapshot.mission).into(),
        (Resource::Mission, _) => written(format, &state::mission(snapshot)),
        (Resource::Robot, Format::TEXT) => old_items::robot(&snapshot.robot).into(),
        (Resource::Robot, Format::SENML_JSON) => senml::robot(&snapshot.robot).into(),
        (Resource::Robot, _) => written(format, &state::robot(snapshot)),
        (Resource::Map, Format::TEXT) => map_text::lines(snapshot).into(),
        (Resource::Map, _) => written(format, &MapJson::from(snapshot)),
        (Resource::Luggage, _) => written(format, &snapshot.luggage.iter().map(|found| piece(found)).collect::<Vec<_>>()),
        (Resource::Temperature, Format::TEXT) => text::temperature(&snapshot.temperature).into(),
        (Resource::Temperature, Format::SENML_JSON) => senml::temperature(&snapshot.temperature).into(),
        (Resource::Temperature, _) => written(format, &state::temperature(snapshot)),
        (Resource::Alarms, _) => written(format, &state::alarms(snapshot)),
        (Resource::Log, _) => written(format, &state::log_after(snapshot, 0)),
    }
}

fn old_item(number: u64, snapshot: &Snapshot) -> String {
    match number {
        ROBOT => old_items::robot(&snapshot.robot),
        MAP => old_items::room_map(snapshot),
        _ => old_items::luggage(snapshot).unwrap_or_default(),
    }
}
