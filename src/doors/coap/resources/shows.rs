//! Makes the representation of each path, and tells when it last changed.

use super::discovery;
use super::table::Show;
use crate::api::luggage::LuggageJson;
use crate::api::map::map_revision;
use crate::api::old_items;
use crate::api::resources::{self, Form};
use coap_endpoint::Format;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::units::Revision;
use hallsweep_core::world::luggage::Luggage;
use hallsweep_core::world::resource::Resource;

/// Numbers of the items for old clients, in the order in which observers get them.
pub(super) const ROBOT: u64 = 0;
pub(super) const MAP: u64 = 1;
pub(super) const LUGGAGE: u64 = 2;

pub(super) fn revision(show: Show, number: u64, snapshot: &Snapshot) -> Revision {
    let of = |resource| snapshot.revision_of(resource);
    match show {
        Show::Resource(shown) => shown.revision(snapshot),
        Show::Links => of(Resource::Luggage).max(of(Resource::Alarms)),
        Show::OldItems => match number {
            ROBOT => of(Resource::Robot),
            MAP => map_revision(snapshot),
            // The shown piece depends on the mission too.
            _ => of(Resource::Luggage).max(of(Resource::Mission)),
        },
    }
}

/// Returns the body of a representation. The body is empty if there is nothing to show. `number` is the number in the
/// path, or the number of an item for old clients.
pub(super) fn body(show: Show, number: u64, format: Format, snapshot: &Snapshot) -> Vec<u8> {
    match show {
        Show::Resource(shown) => shown.written(number, form_of(format), snapshot, at_this_door),
        Show::OldItems => old_item(number, snapshot).into(),
        Show::Links => discovery::listing(snapshot, &[]),
    }
}

pub(super) fn past_piece(found: &Luggage, format: Format) -> Vec<u8> {
    resources::shape(form_of(format), &at_this_door(LuggageJson::new(found, None)))
}

/// Replaces the path of the photo, because `LuggageJson` contains its path at the HTTP door.
pub(super) fn at_this_door(mut piece: LuggageJson) -> LuggageJson {
    piece.photo.url = piece.photo.url.map(|_| format!("/luggage/{}/photo", piece.id));
    piece
}

pub(super) fn form_of(format: Format) -> Form {
    match format {
        Format::CBOR => Form::Cbor,
        Format::TEXT => Form::Text,
        Format::SENML_JSON => Form::Senml,
        _ => Form::Json,
    }
}

fn old_item(number: u64, snapshot: &Snapshot) -> String {
    match number {
        ROBOT => old_items::robot(&snapshot.robot),
        MAP => old_items::room_map(snapshot),
        _ => old_items::luggage(snapshot).unwrap_or_default(),
    }
}
