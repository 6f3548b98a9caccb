//! Tests of archives: what is archived is complete, what stays is unchanged, nothing is deleted that was not
//! archived, and each change is detected.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use proptest::prelude::*;

use super::super::cut::cuts;
use super::super::folder::Folder;
use super::super::{ArchiveCheck, Archived, ReadOnlyJournal, archive_file, connect, schema, write_out};
use super::testing::*;
use crate::api::journal;
use crate::runtime::archive::{At, PastMoment, Span, Unreadable};
use hallsweep_core::command::{Strategy as Order, Verdict};
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{LuggageId, MissionId, Seq, WallTime};

const NOON: WallTime = at_noon_exactly();
pub(super) const LATER: WallTime = WallTime { unix_ms: NOON.unix_ms + 1, ..NOON };

const fn at_noon_exactly() -> WallTime {
    WallTime { unix_ms: 1_770_000_000_000, offset_s: 3600 }
}

/// The page that ends a mission. As in the core, it has a state snapshot.
pub(super) fn end(mission: u64) -> Vec<Fact> {
    let mut state = PersistentState::first(Order::Snail);
    state.mission = MissionId(mission);
    state.last_luggage = LuggageId(mission);
    [archive(mission), vec![Fact::State(Box::new(state))]].concat()
}

pub(super) fn play(scribe: &mut Scribe, mission: u64, picture: &str) {
    scribe.keep(begin(mission));
    scribe.keep(vec![found(mission, Some(photo(picture))), inspecting(mission)]);
    scribe.keep(vec![verdict(mission, Verdict::Safe), wall(2, 3)]);
}

/// Three missions that have ended and a fourth that is under way. The first and the last have the same photo.
pub(super) fn some_missions() -> Scratch {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    for (mission, picture) in [(1, "bag"), (2, "box"), (3, "crate")] {
        play(&mut scribe, mission, picture);
        scribe.keep(end(mission));
    }
    play(&mut scribe, 4, "bag");
    scratch
}

pub(super) fn file(scratch: &Scratch, name: &str) -> PathBuf {
    scratch.data().with_file_name(name)
}

fn write(scratch: &Scratch, before: WallTime, name: &str) -> Result<Option<Archived>, Unreadable> {
    write_out(&scratch.data(), before, LATER, &file(scratch, name))
}

/// The last page of mission 1 has no state snapshot. So mission 1 is archived only together with the next mission
/// whose last page has a state snapshot. Otherwise the state would not follow from the entries that stay.
#[test]
fn a_mission_behind_which_it_was_not_said_what_stands_goes_with_the_next_that_has_it() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    play(&mut scribe, 1, "bag");
    scribe.keep(archive(1));
    play(&mut scribe, 2, "box");
    drop(scribe);
    let before = bytes(&scratch.data());
    assert_eq!(write(&scratch, LATER, "old").unwrap(), None);
    assert_eq!(bytes(&scratch.data()), before);
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(end(2));
    drop(scribe);
    let archived = write(&scratch, LATER, "old").unwrap().expect("now it is said");
    assert_eq!(archived.what.missions, (MissionId(1), MissionId(2)));
    check_finds(&scratch, &[]);
}

/// A sound archive must also match the journal.
#[test]
fn an_archive_of_something_else_is_not_taken_for_one_of_this_journal() {
    let (one, other) = (Scratch::new(), Scratch::new());
    for (scratch, picture) in [(&one, "bag"), (&other, "box")] {
        let mut scribe = Scribe::new(scratch.open());
        play(&mut scribe, 1, picture);
        scribe.keep(end(1));
    }
    let journal = connect::writer(&Folder::new(&one.data())).unwrap();
    let cut = cuts(&journal, LATER).unwrap().pop().expect("one is over");
    write(&other, LATER, "old").unwrap().expect("one is over");
    let Err(Unreadable(words)) = archive_file::checked(&journal, &cut, &file(&other, "old")) else { panic!("it is another") };
    assert!(words.contains("differs from the journal"), "{words}");
}

pub(super) fn lines(path: &Path) -> Vec<String> {
    let mut lines = Vec::new();
    ReadOnlyJournal::open(path)
        .unwrap()
        .lines(None, None, |_, line| {
            lines.push(journal::line(&line.unwrap()));
            true
        })
        .unwrap();
    lines
}

pub(super) fn shown(
    archive: &dyn crate::runtime::archive::Archive,
    mission: u64,
) -> (Option<PersistentState>, Vec<Vec<PastMoment>>, Vec<bool>) {
    let id = MissionId(mission);
    let entries = archive.entries(id, Span::after(Seq(0)), 1000).unwrap();
    let mut moments: Vec<Vec<PastMoment>> =
        entries.iter().map(|(seq, _)| archive.moments(id, &[At::Entry(*seq)]).unwrap()).collect();
    // The log of a moment also has entries from before the mission, if they exist.
    moments.iter_mut().flatten().for_each(|moment| moment.past.of.latest.clear());
    let photos = vec![archive.photo(LuggageId(mission)).unwrap().is_some()];
    (archive.state(id).unwrap().map(|sound| sound.of), moments, photos)
}

pub(super) fn archive_of(path: &Path) -> Arc<dyn crate::runtime::archive::Archive> {
    ReadOnlyJournal::open(path).unwrap().archive()
}

pub(super) fn faults(path: &Path) -> Vec<String> {
    ReadOnlyJournal::open(path)
        .and_then(|reading| reading.check())
        .map_or_else(|unreadable| vec![unreadable.0], |found| found.faults)
}

#[test]
fn what_is_written_out_is_all_there_and_what_stays_is_as_it_was() {
    let scratch = some_missions();
    let before = lines(&scratch.data());
    let (journal, recalled) = (archive_of(&scratch.data()), scratch.open().recalled.unwrap());
    let seen: Vec<_> = (1..=4).map(|mission| shown(&*journal, mission)).collect();
    let head = journal.head(MissionId(2), Seq(u64::MAX)).unwrap();

    let archived = write(&scratch, LATER, "old").unwrap().expect("three are over");
    assert_eq!((archived.what.missions, archived.photos), ((MissionId(1), MissionId(3)), 3));
    let old = file(&scratch, "old");
    assert_eq!(faults(&old), Vec::<String>::new());
    assert_eq!(lines(&old), before[..usize::try_from(archived.last.seq.0).unwrap()]);
    let in_it = archive_of(&old);
    for mission in 1..=3 {
        assert!(shown(&*in_it, mission) == seen[mission as usize - 1], "mission {mission} in the archive");
    }
    assert_eq!(in_it.head(MissionId(2), Seq(u64::MAX)).unwrap(), head, "a report of it names the same head");

    check_finds(&scratch, &[]);
    let after = lines(&scratch.data());
    let gone = usize::try_from(archived.what.until.0).unwrap();
    assert_eq!(after[..after.len() - 1], before[gone..]);
    assert!(after.last().is_some_and(|last| last.contains("\"kind\":\"writtenOut\"") && last.contains(&archived.what.digest)));
    assert!(shown(&*archive_of(&scratch.data()), 4) == seen[3], "the one that goes on");
    let again = scratch.open().recalled.unwrap();
    assert_eq!((again.state, again.written), (recalled.state, recalled.written.next()));
    let ids: Vec<u64> = journal.missions(None, 9).unwrap().iter().map(|record| record.id.0).collect();
    assert_eq!(ids, [4]);
    let photos = bytes(&scratch.data().join("photos"));
    assert_eq!(photos.iter().map(|(_, bytes)| bytes.clone()).collect::<Vec<_>>(), [b"bag".to_vec()], "which mission 4 has too");

    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(end(4));
    play(&mut scribe, 5, "trunk");
    drop(scribe);
    check_finds(&scratch, &[]);
}

#[test]
fn nothing_is_changed_where_nothing_is_old_or_the_file_cannot_be_written_or_the_journal_is_not_sound() {
    let scratch = some_missions();
    let before = bytes(&scratch.data());
    assert_eq!(write(&scratch, NOON, "old").unwrap(), None);
    std::fs::write(file(&scratch, "there"), "somebody's").unwrap();
    let Err(Unreadable(words)) = write(&scratch, LATER, "there") else { panic!("it was written over") };
    assert!(words.contains("there exists with other contents"), "{words}");
    assert!(write(&scratch, LATER, "nowhere/old").is_err());
    let Err(Unreadable(words)) = write_out(&file(&scratch, "there"), LATER, LATER, &file(&scratch, "old")) else {
        panic!("it is no folder")
    };
    assert!(words.contains("there is an archive already: name the folder of a journal with --data"), "{words}");
    assert_eq!(bytes(&scratch.data()), before);

    let photo = before.iter().find(|(path, _)| path.extension().is_some_and(|end| end == "png")).unwrap();
    std::fs::write(&photo.0, "another").unwrap();
    let Err(Unreadable(words)) = write(&scratch, LATER, "old") else { panic!("a photo is not what it was") };
    assert!(words.contains("nothing was archived: the photo "), "{words}");
    assert!(words.contains(&format!("{} was changed", photo.0.display())), "{words}");
    std::fs::write(&photo.0, &photo.1).unwrap();
    assert_eq!(bytes(&scratch.data()), before);
    assert!(!file(&scratch, "old").exists(), "what was begun of it is gone");

    let Err(Unreadable(words)) = ({
        let _open = scratch.open();
        write(&scratch, LATER, "old")
    }) else {
        panic!("a program was at it")
    };
    assert!(words.contains("another hallsweep uses the folder"), "{words}");
    let log = scratch.data().join("journal.db-wal");
    std::fs::write(&log, [0x5a; 64]).unwrap();
    let Err(Unreadable(words)) = write(&scratch, LATER, "old") else { panic!("its log is not what it should be") };
    assert!(words.contains("journal.db-wal cannot be used"), "{words}");
    assert_eq!(std::fs::read(&log).unwrap(), [0x5a; 64]);
    std::fs::remove_file(&log).unwrap();
    rewrite(&scratch, "UPDATE events SET at_ms = at_ms - 1 WHERE seq = 8");
    let Err(Unreadable(words)) = write(&scratch, LATER, "old") else { panic!("an entry is not what it was") };
    assert!(words.contains("entries 7 to 8 were changed"), "{words}");
}

pub(super) fn held(scratch: &Scratch, archives: &[PathBuf]) -> Vec<String> {
    ReadOnlyJournal::open(&scratch.data()).unwrap().check_archives(archives).unwrap().faults
}

#[test]
fn archives_follow_on_one_another_and_what_is_changed_or_left_out_is_named() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    play(&mut scribe, 1, "bag");
    scribe.keep(end(1));
    play(&mut scribe, 2, "box");
    drop(scribe);
    write(&scratch, LATER, "first").unwrap().expect("one is over");
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(end(2));
    drop(scribe);
    write(&scratch, LATER, "second").unwrap().expect("one more is over");
    let [first, second] = ["first", "second"].map(|name| file(&scratch, name));
    assert_eq!((faults(&first), faults(&second)), (Vec::new(), Vec::new()));
    let copy = file(&scratch, "copy");
    std::fs::copy(&second, &copy).unwrap();
    for archives in [vec![&first, &second], vec![&second, &first], vec![&first, &second, &first, &copy]] {
        let archives: Vec<PathBuf> = archives.into_iter().cloned().collect();
        let found = ReadOnlyJournal::open(&scratch.data()).unwrap().check_archives(&archives).unwrap();
        assert_eq!(found, ArchiveCheck { archives: 2, faults: Vec::new() }, "{archives:?}");
    }
    check_finds(&scratch, &[]);
    for (named, words) in [
        (&first, "the journal does not continue"),
        (&second, "entries 1 to 8 are in archives that were not checked; the last archive is first (SHA-256 "),
    ] {
        let left_out = held(&scratch, std::slice::from_ref(named));
        assert!(left_out.len() == 1 && left_out[0].contains(words), "{left_out:?}");
    }

    let sound = std::fs::read(&second).unwrap();
    for place in [0, 100, 4096, sound.len() / 2, sound.len() - 1] {
        let mut changed = sound.clone();
        changed[place] ^= 1;
        std::fs::write(&second, changed).unwrap();
        let found = held(&scratch, &[first.clone(), second.clone()]);
        assert!(found.iter().any(|fault| fault.contains("second")), "{place}: {found:?}");
    }
    std::fs::write(&second, &sound).unwrap();
    let connection = rusqlite::Connection::open(&second).unwrap();
    connection.execute_batch("DROP TRIGGER events_stay_as_they_are; UPDATE events SET at_ms = 0 WHERE seq = 13").unwrap();
    drop(connection);
    let found = held(&scratch, &[first, second]);
    assert!(found.iter().any(|fault| fault.contains("were changed")), "with the place: {found:?}");
}

/// A version without archives wrote the journal.
#[test]
fn archives_are_not_held_against_a_journal_of_an_older_format() {
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.data()).unwrap();
    let mut journal = rusqlite::Connection::open(scratch.data().join("journal.db")).unwrap();
    schema::of_format(&mut journal, 3);
    drop(journal);
    let checked = ReadOnlyJournal::open(&scratch.data()).unwrap().check_archives(&[file(&scratch, "old")]);
    let Err(Unreadable(words)) = checked else { panic!("there is nothing to hold it against") };
    let journal = scratch.data().join("journal.db");
    assert!(
        words.starts_with(&format!("the journal {} was written by an older hallsweep (format 3)", journal.display())),
        "{words}"
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, ..ProptestConfig::default() })]

    /// The journal has the digest of the archive.
    #[test]
    fn any_byte_of_an_archive_that_is_changed_is_named(place in any::<prop::sample::Index>(), change in 1_u8..) {
        static KEPT: std::sync::LazyLock<(Scratch, Vec<u8>)> = std::sync::LazyLock::new(|| {
            let scratch = some_missions();
            write(&scratch, LATER, "old").unwrap().expect("three are over");
            let bytes = std::fs::read(file(&scratch, "old")).unwrap();
            (scratch, bytes)
        });
        let (scratch, bytes) = &*KEPT;
        let (mut changed, place) = (bytes.clone(), place.index(bytes.len()));
        changed[place] ^= change;
        let path = file(scratch, &format!("changed-{place}-{change}"));
        std::fs::write(&path, changed).unwrap();
        let found = ReadOnlyJournal::open(&scratch.data()).unwrap().check_archives(std::slice::from_ref(&path));
        prop_assert!(found.as_ref().map_or(true, |found| !found.faults.is_empty()), "{place}: {found:?}");
    }
}
