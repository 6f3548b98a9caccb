//! The chain of digests. If something other than the store changes, removes, exchanges, adds or cuts off entries,
//! this is reported with the place.

use proptest::prelude::*;

use super::super::folder::Folder;
use super::super::{ReadOnlyJournal, chain, connect, project, rows, schema};
use super::testing::*;
use crate::api::journal::{self, Line};
use hallsweep_core::command::Verdict;
use hallsweep_core::units::{MissionId, Seq};

/// Pages of entries 1-4, 5-6, 7, 8-9 and 10.
fn some_journal() -> Scratch {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    scribe.keep(vec![found(1, Some(photo("bag"))), inspecting(1)]);
    scribe.keep(vec![verdict(1, Verdict::Safe)]);
    scribe.keep(vec![wall(1, 3), wall(2, 3)]);
    scribe.keep(vec![wall(3, 3)]);
    scratch
}

fn exchange(one: u64, other: u64) -> String {
    let take = |column: &str, seq: u64| format!("(SELECT {column} FROM events WHERE seq = {seq})");
    let set = |seq: u64| format!("kind = {}, body = {}", take("kind", seq), take("body", seq));
    format!(
        "CREATE TEMP TABLE kept AS SELECT * FROM events WHERE seq = {one}; UPDATE events SET {} WHERE seq = {one};
         UPDATE events SET kind = (SELECT kind FROM kept), body = (SELECT body FROM kept) WHERE seq = {other}",
        set(other)
    )
}

#[test]
fn whatever_is_done_to_entries_is_named_with_its_place() {
    let changed = |first: u64, last: u64| format!("entries {first} to {last} were changed");
    let last_is_gone = |first: u64, last: u64| format!("entries {first} to {last}: the last entry is missing");
    let missing = |first: u64, last: u64| format!("entries {first} to {last} are missing");
    for (sql, finds) in [
        // Changes a time, a mission or a coordinate. The entries and the tables stay readable.
        ("UPDATE events SET at_ms = at_ms + 1 WHERE seq = 6".to_owned(), vec![changed(5, 6)]),
        ("UPDATE events SET offset_s = 0 WHERE seq = 10".to_owned(), vec![changed(10, 10)]),
        ("UPDATE events SET mission = NULL WHERE seq = 8".to_owned(), vec![changed(8, 9)]),
        ("UPDATE events SET body = replace(body, '3', '4') WHERE seq = 8".to_owned(), vec![changed(8, 9)]),
        ("UPDATE events SET body = replace(body, ',', ', ') WHERE seq = 7".to_owned(), vec![changed(7, 7)]),
        (exchange(8, 10), vec![changed(8, 9), changed(10, 10)]),
        ("DELETE FROM events WHERE seq = 8".to_owned(), vec![missing(8, 8), changed(8, 9)]),
        ("DELETE FROM events WHERE seq = 9".to_owned(), vec![missing(9, 9), last_is_gone(8, 9)]),
        // Removes entries with their page, so that the next page does not follow.
        (
            "DELETE FROM events WHERE seq IN (8, 9); DELETE FROM pages WHERE last = 9".to_owned(),
            vec![missing(8, 9), changed(8, 10)],
        ),
        // Removes the same entries, and adds a recorded loss that would explain this.
        (
            "DELETE FROM events WHERE seq IN (8, 9); DELETE FROM pages WHERE last = 9; INSERT INTO losses VALUES (7, 1)"
                .to_owned(),
            vec![changed(8, 10)],
        ),
        // Removes entries at the end, first without their page, then with their pages.
        ("DELETE FROM events WHERE seq = 10".to_owned(), vec![last_is_gone(10, 10), "ends before entry 10".to_owned()]),
        (
            "DELETE FROM events WHERE seq >= 8; DELETE FROM pages WHERE last >= 8".to_owned(),
            vec!["ends before entry 10, which was stored".to_owned()],
        ),
        (
            "INSERT INTO events SELECT 11, mission, at_ms, offset_s, kind, body FROM events WHERE seq = 10".to_owned(),
            vec!["the entries from 11 on are in no page".to_owned()],
        ),
        ("UPDATE pages SET digest = zeroblob(32) WHERE last = 7".to_owned(), vec![changed(7, 7), changed(8, 9)]),
        (
            "UPDATE pages SET digest = x'00' WHERE last = 10".to_owned(),
            vec![changed(10, 10), "entry 10 of the journal".to_owned()],
        ),
        ("DROP INDEX milestones".to_owned(), vec!["the tables, indices or triggers differ".to_owned()]),
    ] {
        let scratch = some_journal();
        check_finds(&scratch, &[]);
        rewrite(&scratch, &sql);
        let finds: Vec<&str> = finds.iter().map(String::as_str).collect();
        check_finds(&scratch, &finds);
    }
}

/// If somebody also recomputes the digests, the file `journal.head` reveals the change.
#[test]
fn a_journal_that_was_chained_anew_is_not_the_one_that_was_kept() {
    let scratch = some_journal();
    rewrite(&scratch, "UPDATE events SET at_ms = at_ms + 1 WHERE seq = 1; DELETE FROM pages");
    chain::close_page(&connect::writer(&Folder::new(&scratch.data())).unwrap()).unwrap();
    check_finds(&scratch, &["entry 10 of the journal"]);
}

/// If somebody rewrites every file, no trace is left in the folder. A head that was handed out before still reveals
/// the change.
#[test]
fn who_changes_everything_cannot_change_a_head_that_somebody_else_has() {
    let scratch = some_journal();
    let head = || scratch.open().archive.head(MissionId(1), Seq(u64::MAX)).unwrap().expect("there is a chain");
    let given_away = head();
    rewrite(&scratch, "UPDATE events SET at_ms = at_ms + 1 WHERE seq = 6; DELETE FROM pages");
    chain::close_page(&connect::writer(&Folder::new(&scratch.data())).unwrap()).unwrap();
    std::fs::remove_file(scratch.data().join("journal.head")).unwrap();
    drop(scratch.open());
    check_finds(&scratch, &[]);
    let now = head();
    assert!(now.seq == given_away.seq && now.digest != given_away.digest);
}

/// Nothing is written to a journal that lost entries or has entries of another program: new entries would hide this.
#[test]
fn a_journal_that_ends_too_early_or_goes_on_without_us_is_not_written_to() {
    for (sql, words) in [
        ("DELETE FROM events WHERE seq >= 8; DELETE FROM pages WHERE last >= 8", "ends before entry 10, which was stored"),
        ("DELETE FROM events WHERE seq = 10", "ends before entry 10"),
        ("DELETE FROM pages WHERE last >= 8", "entry 10 of the journal"),
        (
            "INSERT INTO events SELECT 11, mission, at_ms, offset_s, kind, body FROM events WHERE seq = 10",
            "another program has written to the journal",
        ),
    ] {
        let scratch = some_journal();
        rewrite(&scratch, sql);
        let before = bytes(&scratch.data());
        let failure = scratch.open().failure.expect("it cannot be gone on with");
        assert!(failure.contains(words) && failure.contains("not changed"), "{failure}");
        assert_eq!(bytes(&scratch.data()), before, "not a byte has changed");
    }
    // An operator may restore a backup on purpose.
    let scratch = some_journal();
    rewrite(&scratch, "DELETE FROM events WHERE seq >= 8; DELETE FROM pages WHERE last >= 8");
    std::fs::remove_file(scratch.data().join("journal.head")).unwrap();
    let opened = scratch.open();
    assert_eq!((opened.failure.clone(), opened.recalled.as_ref().map(|recalled| recalled.written)), (None, Some(Seq(7))));
    Scribe::new(opened).keep(vec![wall(7, 7)]);
    check_finds(&scratch, &[]);
}

/// If a mark that declares stored entries lost were believed, hallsweep itself would delete these entries, and nobody
/// would notice.
#[test]
fn who_says_that_what_was_kept_was_lost_is_not_believed() {
    let scratch = some_journal();
    let said = |kept: u64| format!("everything after entry {kept:020} was said to be lost\n");
    std::fs::write(scratch.data().join("journal.lost"), said(7)).unwrap();
    check_finds(&scratch, &["it says that entries are lost, but these entries were stored, up to entry 10"]);
    let before = bytes(&scratch.data());
    let failure = scratch.open().failure.expect("it is not gone on with");
    assert!(failure.contains("journal.lost cannot be used"), "{failure}");
    assert_eq!(bytes(&scratch.data()), before);
    std::fs::write(scratch.data().join("journal.lost"), "mouse").unwrap();
    check_finds(&scratch, &["journal.lost cannot be used"]);
    std::fs::write(scratch.data().join("journal.lost"), said(10)).unwrap();
    check_finds(&scratch, &[]);
    assert_eq!(scratch.open().failure, None);
}

/// The chain of a migrated journal begins with all its entries, except for the entries that are deleted at this
/// start.
#[test]
fn a_journal_of_before_begins_its_chain_with_all_that_it_holds() {
    for lost_after in [None, Some(3)] {
        let scratch = Scratch::new();
        std::fs::create_dir(scratch.data()).unwrap();
        let mut old = rusqlite::Connection::open(scratch.data().join("journal.db")).unwrap();
        schema::of_format(&mut old, 3);
        for (place, fact) in (1..).zip([begin(1), vec![wall(1, 1)]].concat()) {
            let line = Line { seq: Seq(place), mission: None, entry: at_noon(fact), picture: None };
            rows::insert(&old, &line).unwrap();
            project::project(&old, &line).unwrap();
        }
        drop(old);
        if let Some(lost) = lost_after {
            let words = format!("everything after entry {lost:020} was said to be lost\n");
            std::fs::write(scratch.data().join("journal.lost"), words).unwrap();
        }
        let mut scribe = Scribe::new(scratch.open());
        assert_eq!(scribe.opened.failure, None);
        let first = scribe.opened.recalled.as_ref().map_or(Seq(0), |recalled| recalled.written);
        assert_eq!(first, Seq(lost_after.unwrap_or(5)));
        scribe.keep(vec![wall(2, 2), wall(3, 3)]);
        drop(scribe);
        check_finds(&scratch, &[]);
        rewrite(&scratch, "UPDATE events SET at_ms = at_ms + 1 WHERE seq = 2");
        check_finds(&scratch, &[&format!("entries 1 to {first} were changed")]);
    }
}

fn content(scratch: &Scratch) -> Vec<String> {
    let mut lines = Vec::new();
    let reading = ReadOnlyJournal::open(&scratch.data()).unwrap();
    let visit = |seq, line: Result<Line, String>| {
        lines.push(line.map_or_else(|why| journal::unreadable(seq, &why), |line| journal::line(&line)));
        true
    };
    reading.lines(None, None, visit).unwrap();
    lines
}

/// A journal file after a checkpoint, so that SQLite has nothing left to write into it.
fn file() -> (Vec<u8>, Vec<u8>, Vec<String>) {
    let scratch = some_journal();
    meddle(&scratch, "PRAGMA wal_checkpoint(TRUNCATE)");
    let read = |name: &str| std::fs::read(scratch.data().join(name)).unwrap();
    (read("journal.db"), read("journal.head"), content(&scratch))
}

/// Whether the change of this byte is detected, or the journal still reads exactly as before.
fn is_found_out_or_says_the_same((journal, head, said): &(Vec<u8>, Vec<u8>, Vec<String>), place: usize, byte: u8) -> bool {
    let scratch = Scratch::new();
    std::fs::create_dir(scratch.data()).unwrap();
    let mut changed = journal.clone();
    changed[place] = byte;
    std::fs::write(scratch.data().join("journal.db"), changed).unwrap();
    std::fs::write(scratch.data().join("journal.head"), head).unwrap();
    // The photos were not copied, so only missing photos are expected.
    let is_sound = |faults: &[String]| faults.iter().all(|fault| fault.starts_with("photo "));
    let checked = ReadOnlyJournal::open(&scratch.data()).and_then(|reading| reading.check());
    checked.map_or(true, |findings| !is_sound(&findings.faults) || content(&scratch) == *said)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 192, ..ProptestConfig::default() })]

    /// A byte of the file that has no meaning may change. Then everything in the journal must be unchanged.
    #[test]
    fn any_byte_of_the_journal_that_means_something_is_missed(places in prop::collection::vec((any::<prop::sample::Index>(), 1_u8..), 1..4)) {
        static FILE: std::sync::LazyLock<(Vec<u8>, Vec<u8>, Vec<String>)> = std::sync::LazyLock::new(file);
        for (place, change) in places {
            let place = place.index(FILE.0.len());
            prop_assert!(is_found_out_or_says_the_same(&FILE, place, FILE.0[place] ^ change), "{place}");
        }
    }
}

/// The head file names the first page only after its commit. A kill in between leaves the empty head, which fits
/// every journal.
#[test]
fn a_kill_before_the_first_page_is_named_leaves_a_journal_that_is_sound_and_written_to() {
    let scratch = Scratch::new();
    let kept = |facts| Scribe::new(scratch.open()).keep(facts);
    let nothing = || {
        let text = format!("entry {:020} sha256 {}\n", 0, "0".repeat(64));
        std::fs::write(scratch.data().join("journal.head"), text).unwrap();
    };
    drop(scratch.open());
    nothing();
    kept(vec![found(1, None)]);
    nothing();
    check_finds(&scratch, &[]);
    kept(vec![found(2, None)]);
    check_finds(&scratch, &[]);
}
