//! `/resourcemodel` for old clients (mission §8). It has three items: robot, map and luggage. A GET returns the item
//! that changed last. An observer gets the newest version of each item. Old clients send bare words as commands.
//! `crate::api::old_items` writes the items.

use std::sync::{Arc, Mutex, PoisonError};

use super::cache::RepresentationCache;
use super::problem::Problem;
use super::shows::{LUGGAGE, MAP, ROBOT, revision};
use super::table::Show;
use crate::api::halt::is_halt;
use crate::api::map::MapChange;
use crate::api::{old_clients, old_items};
use coap_endpoint::{Answer, Format, Request};
use hallsweep_core::asked::Asked;
use hallsweep_core::command::Command;
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::world::resource::Resource;

/// Knows the item that changed last. This is checked at every newer state, so that no change between two requests is
/// missed. Only the changed parts are compared, and no item is written for that.
pub(super) struct OldModel(Mutex<Seen>);

struct Seen {
    snapshot: Arc<Snapshot>,
    latest: u64,
}

impl OldModel {
    pub(super) fn new(snapshot: Arc<Snapshot>) -> OldModel {
        OldModel(Mutex::new(Seen { snapshot, latest: ROBOT }))
    }

    /// Updates and returns the item that changed last. If several items changed since the last call, the item with
    /// the highest revision of its own part is returned. If the revisions are equal, the later item in the order of
    /// notifications is returned.
    pub(super) fn look(&self, snapshot: &Arc<Snapshot>) -> u64 {
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let changed = there(snapshot).iter().copied().filter(|number| differs(*number, &seen.snapshot, snapshot));
        let latest = changed.max_by_key(|number| {
            // The shown piece also depends on the mission. But the mission's revision changes for many other reasons,
            // so it is not used here.
            let revision = match *number {
                LUGGAGE => snapshot.revision_of(Resource::Luggage),
                other => revision(Show::OldItems, other, snapshot),
            };
            (revision, *number)
        });
        let latest = latest.unwrap_or(seen.latest);
        *seen = Seen { snapshot: Arc::clone(snapshot), latest };
        // If the item no longer exists, the robot's item is returned, as at the beginning.
        if there(snapshot).contains(&latest) { latest } else { ROBOT }
    }

    /// Returns the item that changed last. Observers get all items, in the order robot, map, luggage.
    pub(super) fn answer(&self, snapshot: &Arc<Snapshot>, cache: &RepresentationCache) -> Answer {
        let copies = |number| cache.copies(Show::OldItems, number, Format::TEXT, snapshot);
        let response = copies(self.look(snapshot)).plain;
        Answer { response, observed: there(snapshot).iter().map(|number| copies(*number).watched).collect() }
    }
}

/// Returns the numbers of the existing items. Robot and map always exist.
fn there(snapshot: &Snapshot) -> &'static [u64] {
    if snapshot.luggage.is_empty() { &[ROBOT, MAP] } else { &[ROBOT, MAP, LUGGAGE] }
}

fn differs(number: u64, older: &Snapshot, newer: &Snapshot) -> bool {
    match number {
        ROBOT => old_items::robot(&older.robot) != old_items::robot(&newer.robot),
        MAP => changes_a_cell(older, newer),
        _ => old_items::luggage(older) != old_items::luggage(newer),
    }
}

fn changes_a_cell(older: &Snapshot, newer: &Snapshot) -> bool {
    match MapChange::between(older, newer) {
        Some(MapChange::Cells(map)) => !map.cells.is_empty(),
        Some(MapChange::Whole(_)) => true,
        None => false,
    }
}

/// Returns the command for a word, bare or in JSON quotes. `h` and `stop` mean STOP, whatever else is wrong with the
/// request. Other moves need `manual_driving`, because an old console sends a stray `w` when it starts.
pub(super) fn command(request: &Request, manual_driving: bool) -> Result<Command, Problem> {
    let text = String::from_utf8_lossy(&request.payload);
    let text = text.trim();
    let word = text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or(text);
    if is_halt(word) {
        return Ok(Command::Stop);
    }
    let command = old_clients::bare_word(word)?;
    if let Some(other) = request.format.filter(|format| ![Format::TEXT, Format::JSON].contains(format)) {
        return Err(Problem::wrong_format(format!("the word is in {other}: send it as {}", Format::TEXT)));
    }
    let may_drive = old_clients::may_drive(&command, manual_driving);
    may_drive.map_err(|refused| Problem::refused(&refused).of(Asked::Command(command.clone())))?;
    Ok(command)
}

#[cfg(test)]
mod tests {
    use super::super::testing::put;
    use super::*;
    use hallsweep_core::command::{LuggageRef, Move, Verdict};

    fn word(word: &str, format: Option<Format>) -> Result<Command, Problem> {
        command(&Request { format, ..put("/resourcemodel", word) }, true)
    }

    #[test]
    fn a_word_is_known_however_it_is_labelled_and_quoted() {
        for format in [None, Some(Format::TEXT), Some(Format::JSON)] {
            assert_eq!(word("w", format).unwrap(), Command::Move(Move::Forward));
            assert_eq!(word(" l\r\n", format).unwrap(), Command::Move(Move::TurnLeft));
            assert_eq!(word("\"x\"", format).unwrap(), Command::Move(Move::NudgeRight));
            let safe =
                Command::Verdict { luggage: LuggageRef::Pending, verdict: Verdict::Safe, note: None, hot: Default::default() };
            assert_eq!(word("safe", format).unwrap(), safe);
        }
        assert_eq!(word("w", Some(Format::CBOR)).unwrap_err().code(), "unsupportedMediaType");
        for wrong in ["", "W", "w w", "\"w", "{\"move\":\"w\"}", "wwwwwwww"] {
            assert_eq!(word(wrong, None).unwrap_err().code(), "unusable", "{wrong}");
        }
    }

    /// Safety S1.
    #[test]
    fn a_halt_is_known_whatever_is_wrong_with_its_request() {
        for format in [None, Some(Format::CBOR), Some(Format(9999))] {
            assert_eq!(command(&Request { format, ..put("/resourcemodel", "h") }, false).unwrap(), Command::Stop);
        }
    }

    #[test]
    fn a_stray_word_of_an_old_console_drives_nothing() {
        for word in ["w", "s", "a", "d", "l", "r", "z", "x"] {
            let refused = command(&put("/resourcemodel", word), false).unwrap_err();
            assert_eq!((refused.code(), refused.is_for_record()), ("notAllowed", true), "{word}");
        }
        assert!(command(&put("/resourcemodel", "danger"), false).is_ok());
    }
}
