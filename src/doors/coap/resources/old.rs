//! `/resourcemodel`, as old clients know it (mission §8): three items, of which a GET shows the one that changed last and an
//! observer gets the newest of each; and the bare words by which these clients command. How an item is written stands in
//! `crate::api::old_items`.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::cache::{Copies, RepresentationCache};
use super::problem::Problem;
use super::shows::{LUGGAGE, MAP, ROBOT, revision};
use super::table::Show;
use crate::api::halt::is_halt;
use crate::api::old_clients;
use coap_endpoint::{Answer, Format, Request};
use hallsweep_core::command::Command;
use hallsweep_core::mission::in_words;
use hallsweep_core::units::Revision;
use hallsweep_core::world::resource::Resource;
use hallsweep_core::world::snapshot::Snapshot;

/// Which of the items changed last. It is looked at each newer state, so that what follows a change without changing an item does
/// not hide which it was.
pub(super) struct OldModel(Mutex<Seen>);

struct Seen {
    items: Vec<Copies>,
    latest: usize,
}

impl OldModel {
    /// Nothing has changed yet.
    pub(super) fn new(snapshot: &Snapshot, cache: &RepresentationCache) -> OldModel {
        let items = items(snapshot, cache).into_iter().map(|(_, item)| item).collect();
        OldModel(Mutex::new(Seen { items, latest: 0 }))
    }

    /// Sees what has changed since the last look.
    pub(super) fn look(&self, snapshot: &Snapshot, cache: &RepresentationCache) {
        drop(self.seen(snapshot, cache));
    }

    /// The item that changed last, and all of them for observers, in the order robot, map, luggage.
    pub(super) fn answer(&self, snapshot: &Snapshot, cache: &RepresentationCache) -> Answer {
        let seen = self.seen(snapshot, cache);
        let shown = seen.items.get(seen.latest).unwrap_or(&seen.items[0]).plain.clone();
        let observed = seen.items.iter().map(|item| item.watched.clone()).collect();
        Answer { response: shown, observed }
    }

    /// Of several items that changed since the last look it is the one whose own part of the state changed last; of those that
    /// changed at once, the last in this order, as observers are told of them.
    fn seen(&self, snapshot: &Snapshot, cache: &RepresentationCache) -> MutexGuard<'_, Seen> {
        let now = items(snapshot, cache);
        let mut seen = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let before = &seen.items;
        let is_new = |at: usize, item: &Copies| before.get(at).is_none_or(|old| old.watched.body != item.watched.body);
        let changed = now.iter().enumerate().filter(|(at, (_, item))| is_new(*at, item));
        let latest = changed.max_by_key(|(at, (revision, _))| (*revision, *at)).map_or(seen.latest, |(at, _)| at);
        *seen = Seen { items: now.into_iter().map(|(_, item)| item).collect(), latest };
        seen
    }
}

/// The items there are, each with the revision at which its own part of the state last changed; never none.
fn items(snapshot: &Snapshot, cache: &RepresentationCache) -> Vec<(Revision, Copies)> {
    let there = if snapshot.luggage.is_empty() { &[ROBOT, MAP][..] } else { &[ROBOT, MAP, LUGGAGE] };
    let show = Show::OldItems;
    // The mission says which piece is shown, and changes for many other reasons.
    let own = |number| if number == LUGGAGE { snapshot.revision_of(Resource::Luggage) } else { revision(show, number, snapshot) };
    let item = |number| (own(number), cache.copies(show, number, Format::TEXT, snapshot));
    there.iter().copied().map(item).collect()
}

/// The command behind a bare word, bare or in the quotes of JSON, whatever it is labelled as: `h` and `stop` are STOP, and nothing that is
/// wrong with its request keeps it from halting. An old console sends a stray `w` when it starts, so the other moves are only
/// taken when old clients may drive.
pub(super) fn command(request: &Request, manual_driving: bool) -> Result<Command, Problem> {
    let text = String::from_utf8_lossy(&request.payload);
    let word = bare(&text);
    if is_halt(word) {
        return Ok(Command::Stop);
    }
    let command = old_clients::bare_word(word)?;
    if let Some(other) = request.format.filter(|format| ![Format::TEXT, Format::JSON].contains(format)) {
        return Err(Problem::wrong_format(format!("the word is in {other}: send it as {}", Format::TEXT)));
    }
    let may_drive = old_clients::may_drive(&command, manual_driving);
    may_drive.map_err(|refused| Problem::refused(&refused).of(in_words(&command)))?;
    Ok(command)
}

/// A word without the blanks round it and the quotes of JSON.
fn bare(text: &str) -> &str {
    let text = text.trim();
    text.strip_prefix('"').and_then(|text| text.strip_suffix('"')).unwrap_or(text)
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
            let safe = Command::Verdict { luggage: LuggageRef::Pending, verdict: Verdict::Safe };
            assert_eq!(word("safe", format).unwrap(), safe);
        }
        assert_eq!(word("w", Some(Format::CBOR)).unwrap_err().refusal().code, "unsupportedMediaType");
        for wrong in ["", "W", "w w", "\"w", "{\"move\":\"w\"}", "wwwwwwww"] {
            assert_eq!(word(wrong, None).unwrap_err().refusal().code, "unusable", "{wrong}");
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
            assert_eq!((refused.refusal().code, refused.is_for_record()), ("notAllowed", true), "{word}");
        }
        assert!(command(&put("/resourcemodel", "danger"), false).is_ok());
    }
}
