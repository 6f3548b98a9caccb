//! Archiving at a start: as much as a start can wait for, and only once, even after an interruption between writing
//! the file and changing the journal.

use std::path::{Path, PathBuf};

use super::super::archive_file::write_out_within;
use super::super::connect;
use super::super::cut::{Bound, Cut};
use super::super::folder::Folder;
use super::super::{Archived, write_out_at_start};
use super::archives::{LATER, end, file, held, play, some_missions};
use super::testing::*;
use crate::api::journal::Picture;
use crate::runtime::archive::Unreadable;
use hallsweep_core::units::MissionId;

fn start(scratch: &Scratch) -> Result<Option<Archived>, Unreadable> {
    write_out_at_start(&scratch.data(), LATER, LATER)
}

fn refused(archived: Result<Option<Archived>, Unreadable>) -> String {
    let Err(Unreadable(words)) = archived else { panic!("it was written out: {archived:?}") };
    words
}

fn archives(scratch: &Scratch) -> Vec<PathBuf> {
    bytes(&scratch.data().join("archives")).into_iter().map(|(path, _)| path).collect()
}

fn missions(archived: Option<Archived>) -> (MissionId, MissionId) {
    archived.expect("one is over").what.missions
}

/// Mission 1 has ended and its archive is written. Then another program locks the journal, which has the same effect
/// as a kill at this point.
fn one_written_and_not_on_record() -> Scratch {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    play(&mut scribe, 1, "bag");
    scribe.keep(end(1));
    play(&mut scribe, 2, "box");
    drop(scribe);
    let other = rusqlite::Connection::open(scratch.data().join("journal.db")).unwrap();
    other.execute_batch("BEGIN IMMEDIATE").unwrap();
    let words = refused(start(&scratch));
    assert!(words.contains("keeps the journal in") && words.contains("locked"), "{words}");
    assert_eq!(archives(&scratch).len(), 1);
    scratch
}

#[test]
fn a_whole_file_that_the_journal_does_not_name_is_found_again_and_not_written_a_second_time() {
    let scratch = one_written_and_not_on_record();
    let written = archives(&scratch);
    // Meanwhile one more mission is old enough.
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(end(2));
    drop(scribe);
    let archived = start(&scratch).unwrap().expect("two are over");
    assert_eq!((archived.what.missions, archived.left), ((MissionId(1), MissionId(1)), 1));
    assert_eq!(archives(&scratch), written);
    assert_eq!(missions(start(&scratch).unwrap()), (MissionId(2), MissionId(2)));
    assert_eq!(start(&scratch), Ok(None));
    assert_eq!(archives(&scratch).len(), 2);
    check_finds(&scratch, &[]);
    assert_eq!(held(&scratch, &archives(&scratch)), Vec::<String>::new());
}

/// A start waits for what leaves the journal, but not for the photos that stay in it.
#[test]
fn photos_that_stay_are_not_looked_at_when_others_leave() {
    let scratch = some_missions();
    let folder = Folder::new(&scratch.data());
    let journal = connect::writer(&folder).unwrap();
    let newest = "SELECT digest, media_type FROM photos JOIN takes ON takes.photo = digest
                  GROUP BY digest ORDER BY min(luggage) DESC LIMIT 1";
    let (digest, media_type) = journal.query_row(newest, [], |row| Ok((row.get(0)?, row.get(1)?))).unwrap();
    drop(journal);
    std::fs::remove_file(folder.photo(&Picture { digest, media_type })).unwrap();
    let bound = Bound { entries: 16, ..Bound::NONE };
    let archived = write_out_within(&scratch.data(), LATER, LATER, bound, |_| file(&scratch, "first"));
    assert_eq!(missions(archived.unwrap()), (MissionId(1), MissionId(1)));
}

#[test]
fn half_a_file_is_written_anew() {
    let scratch = some_missions();
    let half = scratch.data().join("archives/missions-1-to-2-0123456789abcdef.hallsweep.unfinished");
    std::fs::create_dir(half.parent().unwrap()).unwrap();
    std::fs::write(&half, "SQLite format 3").unwrap();
    assert_eq!(missions(start(&scratch).unwrap()), (MissionId(1), MissionId(3)));
    assert_eq!((archives(&scratch).len(), half.exists()), (1, false));
    assert_eq!(held(&scratch, &archives(&scratch)), Vec::<String>::new());
}

#[test]
fn what_has_the_name_of_an_archive_and_is_another_is_neither_taken_for_it_nor_written_over() {
    let scratch = one_written_and_not_on_record();
    let [there] = archives(&scratch).try_into().unwrap();
    let (sound, journal) = (std::fs::read(&there).unwrap(), content(&scratch));
    // Changes a byte of a photo.
    let place = sound.windows(3).rposition(|window| window == b"bag").unwrap();
    for spoilt in
        [[&sound[..place], b"bog", &sound[place + 3..]].concat(), sound[..sound.len() / 2].to_vec(), b"somebody's".to_vec()]
    {
        std::fs::write(&there, &spoilt).unwrap();
        let words = refused(start(&scratch));
        assert!(words.contains("exists with other contents: move it away, or name another file"), "{words}");
        assert_eq!(std::fs::read(&there).unwrap(), spoilt);
        assert_eq!(content(&scratch), journal);
    }
    std::fs::write(&there, sound).unwrap();
    assert_eq!(missions(start(&scratch).unwrap()), (MissionId(1), MissionId(1)));
}

fn content(scratch: &Scratch) -> Vec<String> {
    super::archives::lines(&scratch.data())
}

/// A mission of these tests has 12 entries and a photo of 3 bytes. The photo of the last mission has 5 bytes.
#[test]
fn no_more_is_written_out_at_once_than_is_waited_for() {
    let some = |scratch: &Scratch, entries, photo_bytes| {
        write_out_within(&scratch.data(), LATER, LATER, Bound { entries, photo_bytes }, |cut| {
            file(scratch, &format!("{}-{}", cut.missions.0, cut.missions.1))
        })
    };
    for (entries, photo_bytes) in [(11, u64::MAX), (u64::MAX, 2)] {
        let scratch = some_missions();
        let before = content(&scratch);
        let words = refused(some(&scratch, entries, photo_bytes));
        assert!(words.contains("mission 1 is too large to be archived at a start"), "{words}");
        assert_eq!(content(&scratch), before);
    }
    for (entries, photo_bytes) in [(16, u64::MAX), (u64::MAX, 5)] {
        let scratch = some_missions();
        for (mission, left) in [(1, 2), (2, 1), (3, 0)] {
            // The photo of a mission that was archived is not counted again.
            let archived = some(&scratch, entries, photo_bytes).unwrap().expect("one is over");
            assert_eq!((archived.what.missions, archived.left), ((MissionId(mission), MissionId(mission)), left));
        }
        assert_eq!(some(&scratch, entries, photo_bytes), Ok(None));
        check_finds(&scratch, &[]);
        let archives = ["1-1", "2-2", "3-3"].map(|name| file(&scratch, name));
        assert_eq!(held(&scratch, &archives), Vec::<String>::new());
    }
}

/// An archive with more missions than are due does not match its record.
#[test]
fn an_archive_that_begins_elsewhere_is_not_taken_for_one_that_ends_alike() {
    let (one, other) = (some_missions(), some_missions());
    let both = file(&other, "both");
    let some = |scratch: &Scratch, entries, there: &Path| {
        let bound = Bound { entries, ..Bound::NONE };
        let name = |Cut { missions: (_, last), .. }: &Cut| {
            if *last == MissionId(2) { there.to_owned() } else { file(scratch, &last.to_string()) }
        };
        write_out_within(&scratch.data(), LATER, LATER, bound, name)
    };
    assert_eq!(missions(some(&other, 24, &both).unwrap()), (MissionId(1), MissionId(2)));
    assert_eq!(missions(some(&one, 16, &file(&one, "second")).unwrap()), (MissionId(1), MissionId(1)));
    let words = refused(some(&one, 16, &both));
    assert!(words.contains("differs from the journal"), "{words}");
}

/// Archiving needs a folder that is on disk. Otherwise a power cut could leave a journal that names an archive in a
/// missing folder.
#[test]
fn where_archives_cannot_be_kept_nothing_is_written_out() {
    let scratch = some_missions();
    std::fs::write(scratch.data().join("archives"), "a file").unwrap();
    let before = content(&scratch);
    assert!(refused(start(&scratch)).contains("archives cannot be used"));
    assert_eq!(content(&scratch), before);
    assert!(Path::new(&scratch.data().join("archives")).is_file());
}
