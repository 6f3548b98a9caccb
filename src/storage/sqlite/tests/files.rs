//! Files that cannot be opened are never overwritten.

use super::super::fault::{Fault, Then};
use super::super::folder::Folder;
use super::super::{OpenError, Opened, connect, open_with};
use super::testing::*;
use crate::runtime::archive::Unreadable;
use hallsweep_core::units::{LuggageId, MissionId, Seq};

/// Opens the prepared files, hands a page over, and compares every byte with what was there before.
fn check_untouched(scratch: &Scratch, words: &[&str]) {
    let before = bytes(&scratch.data());
    let opened = scratch.open();
    let failure = opened.failure.clone().expect("it cannot be opened");
    for words in words {
        assert!(failure.contains(words), "{failure}");
    }
    assert!(failure.contains("journal.db"), "{failure}");
    let mut scribe = Scribe::new(opened);
    assert_eq!(scribe.opened.recalled, None);
    let word = scribe.until(|word| word.failure.is_some());
    assert_eq!((word.failure.as_deref(), word.kept), (Some(failure.as_str()), Seq(0)));
    for losses in [0, 1] {
        scribe.hand_knowing(begin(1), losses);
    }
    drop(scribe);
    assert_eq!(bytes(&scratch.data()), before, "not a byte has changed");
}

fn some_journal() -> Scratch {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep([begin(1), vec![found(1, Some(photo("bag")))]].concat());
    for _ in 0..20 {
        scribe.keep((0..100).map(|x| wall(x, 3)).collect());
    }
    drop(scribe);
    // After a checkpoint all entries are in this file.
    meddle(&scratch, "PRAGMA wal_checkpoint(TRUNCATE)");
    scratch
}

#[test]
fn a_damaged_journal_is_left_as_it_is() {
    let scratch = some_journal();
    let path = scratch.data().join("journal.db");
    let mut file = std::fs::read(&path).unwrap();
    assert!(file.len() > 8 * 4096, "{}", file.len());
    // Overwrites the inner pages of the tree. The header before them stays valid.
    file[4096..6 * 4096].fill(0x5a);
    std::fs::write(&path, file).unwrap();
    check_untouched(&scratch, &["is damaged", "was not changed", "backup", "start hallsweep again"]);
}

/// The damage is in a table that no start reads.
#[test]
fn a_journal_that_is_damaged_elsewhere_is_left_as_it_is() {
    let scratch = some_journal();
    let sql = "SELECT rootpage FROM sqlite_schema WHERE name = 'losses'";
    let connection = connect::writer(&Folder::new(&scratch.data())).unwrap();
    let page: u32 = connection.query_row(sql, [], |row| row.get(0)).unwrap();
    drop(connection);
    let path = scratch.data().join("journal.db");
    let mut file = std::fs::read(&path).unwrap();
    file[(page as usize - 1) * 4096..][..4096].fill(0x5a);
    std::fs::write(&path, file).unwrap();
    check_untouched(&scratch, &["is damaged", "was not changed"]);
}

/// SQLite's report has several lines, and begins with words that mean nothing to an operator.
#[test]
fn the_words_about_a_damaged_journal_are_one_line_and_name_all_files() {
    let found = "*** in database main ***\nTree 2 page 2: btreeInitPage() returns error code 11\nTree 3".to_owned();
    let words = Fault::Damaged(found).words("/data".as_ref(), Then::StartAgain);
    let expected = "the journal /data/journal.db is damaged; it was not changed: move journal.db, journal.db-wal, \
                    journal.db-shm, journal.head and the folder photos away together, or replace these files by a backup, then \
                    start hallsweep again (Tree 2 page 2: btreeInitPage() returns error code 11 Tree 3)";
    assert_eq!(words, expected);
}

/// SQLite ignores a log with a wrong header, and would overwrite the entries in it.
#[test]
fn a_log_that_does_not_begin_like_one_is_left_as_it_is() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    // The files are copied while they are open, as a kill would leave them.
    let [journal, mut log] = ["journal.db", "journal.db-wal"].map(|name| std::fs::read(scratch.data().join(name)).unwrap());
    drop(scribe);
    log[..4].fill(0x5a);
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.data()).unwrap();
    std::fs::write(scratch.data().join("journal.db"), journal).unwrap();
    std::fs::write(scratch.data().join("journal.db-wal"), &log).unwrap();
    check_untouched(&scratch, &["journal.db-wal cannot be used", "its first bytes are wrong"]);
    assert_eq!(std::fs::read(scratch.data().join("journal.db-wal")).unwrap(), log, "not a byte has changed");
}

/// Somebody moved journal.db away after a kill, but left the log, which has the latest entries.
#[test]
fn a_log_without_its_journal_is_left_as_it_is() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    // The log is copied while it is open, as a kill would leave it.
    let log = std::fs::read(scratch.data().join("journal.db-wal")).unwrap();
    drop(scribe);
    for empty in [false, true] {
        let scratch = Scratch::new();
        std::fs::create_dir(scratch.data()).unwrap();
        std::fs::write(scratch.data().join("journal.db-wal"), &log).unwrap();
        if empty {
            std::fs::write(scratch.data().join("journal.db"), "").unwrap();
        }
        check_untouched(&scratch, &["is missing or empty", "journal.db-wal beside it has entries", "start hallsweep again"]);
        assert_eq!(std::fs::read(scratch.data().join("journal.db-wal")).unwrap(), log, "not a byte has changed");
    }
}

/// If the journal is missing, no new journal is silently begun beside the photos that belong to the old one.
#[test]
fn photos_without_a_journal_are_left_as_they_are() {
    let scratch = some_journal();
    std::fs::remove_file(scratch.data().join("journal.db")).unwrap();
    check_untouched(&scratch, &["has no entry, but", "start hallsweep again"]);
    assert!(!scratch.data().join("journal.db").exists());
}

/// Data written to a removed file is lost; without the lock file two programs could write.
#[cfg(unix)]
#[test]
fn a_file_that_is_taken_away_while_it_is_used_is_noticed() {
    for name in ["journal.db", "journal.lock"] {
        for replaced in [false, true] {
            let scratch = Scratch::new();
            let mut scribe = Scribe::new(scratch.open());
            scribe.keep(begin(1));
            std::fs::rename(scratch.data().join(name), scratch.data().join("elsewhere")).unwrap();
            if replaced {
                std::fs::copy(scratch.data().join("elsewhere"), scratch.data().join(name)).unwrap();
            }
            scribe.hand(vec![wall(1, 1)]);
            let failed = scribe.until(|word| word.failure.is_some());
            let words = failed.failure.as_deref().unwrap_or_default();
            assert!(words.starts_with(name) && words.contains("deleted or replaced"), "{words}");
            assert_eq!((failed.kept, failed.losses), (Seq(4), 1));
        }
    }
}

/// An operator moves the folder of a running program away and begins a new folder. The losses of the old program must
/// not appear in the new folder.
#[cfg(unix)]
#[test]
fn a_folder_put_in_the_place_of_the_one_in_use_is_not_written_to() {
    let scratch = Scratch::new();
    let mut old = Scribe::new(scratch.open());
    old.keep(begin(1));
    std::fs::rename(scratch.data(), scratch.data().with_extension("old")).unwrap();
    let mut new = Scribe::new(scratch.open());
    new.keep([begin(1), vec![found(1, None)]].concat());
    drop(new);
    let before = bytes(&scratch.data());
    old.hand(vec![wall(1, 1)]);
    old.until(|word| word.failure.is_some());
    drop(old);
    assert_eq!(bytes(&scratch.data()), before);
    assert_eq!(scratch.open().recalled.map(|recalled| recalled.written), Some(Seq(5)));
}

#[test]
fn a_journal_cut_short_is_left_as_it_is() {
    let scratch = some_journal();
    let path = scratch.data().join("journal.db");
    let file = std::fs::read(&path).unwrap();
    std::fs::write(&path, &file[..file.len() / 2]).unwrap();
    check_untouched(&scratch, &["is damaged"]);
}

#[test]
fn a_file_that_is_no_database_is_left_as_it_is() {
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.data()).unwrap();
    std::fs::write(scratch.data().join("journal.db"), "Dear diary, today I have searched a hall. ".repeat(500)).unwrap();
    check_untouched(&scratch, &["is damaged", "was not changed"]);
    let asked = scratch.open().archive.photo(LuggageId(1));
    assert!(matches!(&asked, Err(Unreadable(words)) if words.contains("is damaged")), "{asked:?}");
}

#[test]
fn the_database_of_another_program_is_left_as_it_is() {
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.data()).unwrap();
    let other = rusqlite::Connection::open(scratch.data().join("journal.db")).unwrap();
    other.execute_batch("CREATE TABLE songs (title TEXT)").unwrap();
    drop(other);
    check_untouched(&scratch, &["is not a journal of hallsweep", "--data"]);
}

#[test]
fn the_journal_of_a_newer_version_is_left_as_it_is() {
    let scratch = some_journal();
    meddle(&scratch, "PRAGMA user_version = 7");
    check_untouched(&scratch, &["newer hallsweep (format 7)", "--data"]);
}

#[test]
fn after_an_entry_that_says_nothing_nothing_is_written() {
    let scratch = some_journal();
    meddle(&scratch, "INSERT INTO events VALUES (3000, 1, 0, 0, 'danced', '{\"kind\":\"danced\"}')");
    check_untouched(&scratch, &["entry 3000 of the journal", "danced", "start hallsweep again"]);
    let archive = scratch.open().archive;
    assert_eq!(archive.photo(LuggageId(1)), Ok(Some(photo("bag"))), "reading goes on");
    assert!(archive.mission(MissionId(1)).unwrap().is_some());
}

/// A kill just after the journal was created leaves an empty file, or a file without tables.
#[test]
fn a_journal_that_had_only_just_begun_is_begun_again() {
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.data()).unwrap();
    std::fs::write(scratch.data().join("journal.db"), "").unwrap();
    let mut scribe = Scribe::new(scratch.open());
    assert_eq!((&scribe.opened.recalled, &scribe.opened.failure), (&None, &None));
    scribe.keep(begin(1));

    let scratch = Scratch::new();
    std::fs::create_dir(scratch.data()).unwrap();
    let begun = rusqlite::Connection::open(scratch.data().join("journal.db")).unwrap();
    begun.query_row("PRAGMA journal_mode = WAL", [], |_| Ok(())).unwrap();
    drop(begun);
    Scribe::new(scratch.open()).keep(begin(1));
}

#[test]
fn two_hallsweeps_never_share_a_folder() {
    let scratch = Scratch::new();
    let first = scratch.open();
    let second = open_with(&scratch.data(), None, HASTE);
    let Err(OpenError::InUse(words)) = second.map(drop) else { panic!("both have it") };
    assert!(words.contains(&scratch.data().display().to_string()) && words.contains("--data"), "{words}");
    drop(first);
    drop(scratch.open());
}

#[cfg(unix)]
#[test]
fn only_the_owner_reads_what_is_kept() {
    use std::os::unix::fs::PermissionsExt;
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(vec![found(1, Some(photo("bag")))]);
    let mode = |path: &std::path::Path| std::fs::metadata(path).unwrap().permissions().mode() & 0o777;
    assert_eq!(mode(&scratch.data()), 0o700);
    for name in ["journal.db", "journal.db-wal", "journal.db-shm", "journal.lock"] {
        assert_eq!(mode(&scratch.data().join(name)), 0o600, "{name}");
    }
    for (path, _) in bytes(&scratch.data()) {
        assert_eq!(mode(&path), 0o600, "{}", path.display());
    }
}

/// Another program writes to the journal after it was read and before it is opened for writing.
#[test]
fn a_journal_that_changed_after_it_was_read_is_not_written_to() {
    use super::super::pages::Pages;
    let scratch = some_journal();
    let opened = Pages::open(&Folder::new(&scratch.data()), None, Seq(3), None);
    assert!(matches!(opened, Err(Fault::Changed)));
}

#[test]
fn an_absent_folder_has_nothing_to_read() {
    let scratch = Scratch::new();
    let Opened { archive, .. } = scratch.open();
    assert_eq!((archive.photo(LuggageId(1)), archive.missions(None, 5)), (Ok(None), Ok(Vec::new())));
}
