//! After a failure, exactly the entries are lost that were declared lost, and writing continues (safety R3, V3). Real
//! faults of real disks are in `mounts`.

use std::sync::Arc;
use std::sync::mpsc;
use std::thread;

use rusqlite::TransactionBehavior;

use super::super::archive::SqliteArchive;
use super::super::fault::Fault;
use super::super::folder::Folder;
use super::super::head::HeadFile;
use super::super::marker::Marker;
use super::super::pages::Pages;
use super::super::writer::{Hand, Patience, Writer, watch};
use super::super::writer_status::WriterStatus;
use super::super::{Opened, QUEUE, ReadOnlyJournal, SqliteStore, connect, look, marker, recall, rows};
use super::testing::*;
use crate::runtime::store::Store;
use hallsweep_core::command::Verdict;
use hallsweep_core::effect::Page;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{LuggageId, Seq};

fn recalled(path: &std::path::Path) -> Result<Option<hallsweep_core::engine::Recalled>, Fault> {
    let folder = Folder::new(path);
    recall::recall(&folder, marker::read(&folder)?)
}

fn notes(scratch: &Scratch) -> Vec<String> {
    let findings = ReadOnlyJournal::open(&scratch.data()).unwrap().check().unwrap();
    assert_eq!(findings.faults, Vec::<String>::new());
    findings.notes
}

/// Safety D2: a page is stored completely or not at all. Pages after the failure are stored again.
#[test]
fn a_page_of_which_one_entry_cannot_be_written_leaves_nothing() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    scribe.hand(vec![wall(1, 1), found(u64::MAX, None), wall(2, 2)]);
    let failed = scribe.until(|word| word.losses == 1);
    assert_eq!(failed.kept, Seq(4));
    scribe.until(|word| word.failure.is_none());
    assert_eq!(scribe.keep(vec![wall(3, 3)]), Seq(8));
    drop(scribe);
    assert_eq!(notes(&scratch), ["entries 5 to 7 were lost while the store could not write, and the loss was reported"]);
}

#[test]
fn a_page_whose_sender_does_not_know_of_a_loss_is_dropped() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    scribe.hand(vec![found(u64::MAX, None)]);
    scribe.until(|word| word.losses == 1 && word.failure.is_none());
    scribe.hand_knowing(vec![verdict(1, Verdict::Safe)], 0);
    scribe.keep(vec![wall(3, 3)]);
    assert_eq!(scribe.opened.archive.missions(None, 9).unwrap().len(), 1);
    drop(scribe);
    let recalled = scratch.open().recalled.unwrap();
    assert_eq!(recalled.written, Seq(7));
    assert_eq!(notes(&scratch).len(), 1);
}

/// Hands over pages while nobody takes them: the store never blocks, and reports that the disk is too slow.
#[test]
fn a_full_queue_is_a_failure_and_not_a_wait() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    let mut other = connect::writer(&Folder::new(&scratch.data())).unwrap();
    let hanging = other.transaction_with_behavior(TransactionBehavior::Immediate).unwrap();
    for _ in 0..QUEUE + 600 {
        scribe.hand(vec![wall(1, 1)]);
    }
    let failed = scribe.until(|word| word.failure.is_some());
    assert_eq!((failed.kept, failed.losses), (Seq(4), 1));
    drop(hanging);
    // The queue may still be full of lost pages. Then this page is declared lost too.
    let is_kept = (0..QUEUE).any(|_| {
        let before = scribe.until(|word| word.failure.is_none()).losses;
        let last = scribe.hand(vec![wall(3, 3)]);
        scribe.until(|word| word.kept >= last || word.losses > before).kept >= last
    });
    assert!(is_kept, "everything is lost for ever");
    drop(scribe);
    assert_eq!(notes(&scratch).len(), 1);
}

/// Safety R3: a page that finds no room in the queue is declared lost at once, whatever the writer is doing.
#[test]
fn what_finds_no_place_in_the_queue_is_lost() {
    let scratch = Scratch::new();
    let folder = Folder::new(&scratch.data());
    let status = Arc::new(WriterStatus::new(Marker::new(&folder), Seq(0), None));
    let ((pages, _untaken), done) = (mpsc::sync_channel(1), mpsc::channel().1);
    let mut store =
        SqliteStore { folder, status: Arc::clone(&status), pages: Some(pages), ends: Vec::new(), done, patience: HASTE };
    store.record(page(1, begin(1)), 0);
    assert!(!status.is_failing());
    store.record(page(5, vec![wall(1, 1)]), 0);
    assert!(status.is_failing());
}

/// Safety R3: the last page that found no room is declared lost after everything before it was written.
#[test]
fn a_loss_that_is_said_when_nothing_is_left_to_write_is_gone_on_from() {
    let scratch = Scratch::new();
    let (opened, status) = store_at(&Folder::new(&scratch.data()));
    let mut scribe = Scribe::new(opened);
    scribe.keep(begin(1));
    // In most rounds the writer is waiting at this moment.
    for losses in 1..=20 {
        status.overflow("the disk is too slow".to_owned());
        scribe.until(|word| word.losses == losses && word.failure.is_none());
        scribe.keep(vec![wall(3, 3)]);
    }
}

/// Safety R3: pages sent during a failure are lost, and their sender is told this once, when the failure ends.
#[test]
fn pages_that_are_dropped_during_a_failure_are_one_more_loss() {
    let scratch = Scratch::new();
    drop(scratch.open());
    let status = Arc::new(WriterStatus::new(Marker::new(&Folder::new(&scratch.data())), Seq(0), None));
    let heard = || {
        let word = status.word().borrow().clone();
        (word.losses, word.failure.is_some())
    };
    status.fail(status.begin(), "the disk is full");
    assert_eq!(heard(), (1, true));
    for _ in 0..3 {
        status.overflow("the disk is too slow".to_owned());
    }
    assert_eq!(heard(), (1, true), "the failure that stands is one loss");
    status.recover();
    assert_eq!(heard(), (2, false));
    status.fail(status.begin(), "the disk is full");
    status.recover();
    assert_eq!(heard(), (3, false), "nothing was dropped this time");
}

/// For a watchman that declares any batch lost at once. It may run only while the disk hangs: on a busy disk even an
/// ordinary page takes longer, and would be declared lost.
const HURRY: Patience = Patience { looks: 3, ..HASTE };

/// Safety R3: the failure is reported before the disk has answered, and ends without help.
#[test]
fn a_disk_that_hangs_is_not_waited_for() {
    let scratch = Scratch::new();
    Scribe::new(scratch.open()).keep(begin(1));
    let mut scribe = Scribe::new(scratch.open_with(HURRY));
    let mut other = connect::writer(&Folder::new(&scratch.data())).unwrap();
    let hanging = other.transaction_with_behavior(TransactionBehavior::Immediate).unwrap();
    scribe.hand(vec![found(1, None), verdict(1, Verdict::Safe)]);
    let failed = scribe.until(|word| word.losses == 1);
    assert!(failed.failure.as_deref().is_some_and(|words| words.contains("does not answer")), "{failed:?}");
    drop(hanging);
    let ended = scribe.until(|word| word.failure.is_none());
    assert_eq!((ended.kept, ended.losses), (Seq(4), 1));
    assert_eq!(scribe.opened.archive.luggage(LuggageId(1)), Ok(None), "it was said to be lost");
    drop(scribe);
    assert_eq!(notes(&scratch), Vec::<String>::new());
    assert_eq!(scratch.open().recalled.map(|recalled| recalled.written), Some(Seq(4)));
}

/// Safety R3: the store declares one batch lost, and stores the next batch.
#[test]
fn what_is_handed_over_after_a_disk_hung_is_kept() {
    let scratch = Scratch::new();
    let folder = Folder::new(&scratch.data());
    let (opened, status) = store_at(&folder);
    let mut scribe = Scribe::new(opened);
    scribe.keep(begin(1));
    let mut other = connect::writer(&folder).unwrap();
    let hanging = other.transaction_with_behavior(TransactionBehavior::Immediate).unwrap();
    scribe.hand(vec![found(1, None), verdict(1, Verdict::Safe)]);
    let (end, ended) = mpsc::channel();
    let failed = thread::scope(|scope| {
        let (status, folder) = (&status, &folder);
        scope.spawn(move || watch(status, folder, &ended, HURRY));
        let failed = scribe.until(|word| word.losses == 1);
        drop(end);
        failed
    });
    assert!(failed.failure.as_deref().is_some_and(|words| words.contains("does not answer")), "{failed:?}");
    drop(hanging);
    scribe.until(|word| word.failure.is_none());
    assert_eq!(scribe.opened.archive.luggage(LuggageId(1)), Ok(None), "it was said to be lost");
    assert_eq!(scribe.keep(vec![found(1, None)]), Seq(7));
    drop(scribe);
    assert_eq!(notes(&scratch), ["entries 5 to 6 were lost while the store could not write, and the loss was reported"]);
}

/// Safety R3: the lock is reported before anything is to be written.
#[test]
fn a_journal_that_another_program_keeps_locked_is_said_at_the_start() {
    let scratch = Scratch::new();
    Scribe::new(scratch.open()).keep(begin(1));
    let mut other = connect::writer(&Folder::new(&scratch.data())).unwrap();
    let _locked = other.transaction_with_behavior(TransactionBehavior::Immediate).unwrap();
    let failure = scratch.open().failure;
    assert!(failure.as_ref().is_some_and(|words| words.contains("another program keeps the journal")), "{failure:?}");
}

/// A new store, and its status for a second watchman. The store's own watchman never declares a batch lost.
fn store_at(folder: &Folder) -> (Opened, Arc<WriterStatus>) {
    let (hand, recalled, failure) = look(folder).unwrap();
    let status = Arc::new(WriterStatus::new(Marker::new(folder), Seq(0), None));
    let store = Box::new(SqliteStore::start(folder, Arc::clone(&status), hand, Seq(0), HASTE).unwrap());
    (Opened { store, archive: Arc::new(SqliteArchive::new(folder.clone())), recalled, failure }, status)
}

fn writer(scratch: &Scratch) -> (Writer, Arc<WriterStatus>) {
    let folder = Folder::new(&scratch.data());
    let journal = Pages::open(&folder, None, Seq(0), None).unwrap();
    let status = Arc::new(WriterStatus::new(Marker::new(&folder), Seq(0), None));
    let (pages, ended) = (mpsc::sync_channel(1).1, mpsc::channel().1);
    let (hand, head) = (Hand::Writing(journal), HeadFile::start(&folder).unwrap());
    (Writer { folder, status: Arc::clone(&status), pages, ended, hand, head, kept: Seq(0), bulk: 0, patience: HASTE }, status)
}

fn page(first: u64, facts: Vec<Fact>) -> Page {
    Page { first: Seq(first), entries: facts.into_iter().map(at_noon).collect(), kept_back: None }
}

/// Like `writer`, with five stored entries: they have a mission, and a piece that waits for its verdict.
fn asking_writer(scratch: &Scratch) -> (Writer, Arc<WriterStatus>) {
    let (mut writer, status) = writer(scratch);
    let losses = status.begin();
    writer.write(&[page(1, [begin(1), vec![found(1, Some(photo("bag")))]].concat())], losses).unwrap();
    writer.conclude(Ok(()), losses, Seq(5));
    (writer, status)
}

/// Safety V3: a verdict that was answered with "not kept" has no effect, although it was on disk before.
#[test]
fn what_was_given_up_while_the_disk_hung_is_taken_back() {
    let scratch = Scratch::new();
    let (mut writer, status) = asking_writer(&scratch);
    assert_eq!(status.word().borrow().kept, Seq(5));

    let losses = status.begin();
    let written = writer.write(&[page(6, vec![verdict(1, Verdict::Safe)])], losses);
    status.give_up(status.at_work().unwrap(), "the disk does not answer");
    let state = || recalled(&scratch.data()).unwrap().unwrap();
    let reader = connect::reader(&Folder::new(&scratch.data())).unwrap().expect("there is a journal");
    assert_eq!(rows::last_up_to(&reader.connection, None).unwrap(), Seq(6), "the disk has it");
    assert_eq!(state().written, Seq(5), "and nobody is told");
    drop(reader);
    writer.conclude(written, losses, Seq(6));
    assert_eq!(state().written, Seq(5));
    assert!(state().state.luggage[0].is_pending());
    let word = status.word().borrow().clone();
    assert_eq!((word.kept, word.losses, word.failure), (Seq(5), 1, None));
    assert_eq!(notes(&scratch), Vec::<String>::new());
}

/// Safety D2: entries after a lost beginning of a mission belong to no mission.
#[test]
fn a_mission_whose_beginning_was_lost_is_not_under_way() {
    let scratch = Scratch::new();
    let (mut writer, status) = writer(&scratch);
    let losses = status.begin();
    let written = writer.write(&[page(1, begin(1))], losses);
    status.give_up(status.at_work().unwrap(), "the disk does not answer");
    writer.conclude(written, losses, Seq(4));
    writer.write(&[page(5, vec![command(None)])], status.begin()).unwrap();
    let mut missions = Vec::new();
    let reading = ReadOnlyJournal::open(&scratch.data()).unwrap();
    reading
        .lines(None, None, |seq, line| {
            missions.push((seq, line.unwrap().mission));
            true
        })
        .unwrap();
    assert_eq!(missions, [(Seq(5), None)]);
}

/// Safety V3: after a failed commit, such as a failed flush, the entry is deleted before the loss is reported. This
/// works without the marker file, which the same disk may refuse.
#[test]
fn what_a_failed_commit_left_in_the_log_is_gone_when_the_loss_is_said() {
    let scratch = Scratch::new();
    let (mut writer, status) = asking_writer(&scratch);
    let losses = status.begin();
    writer.write(&[page(6, vec![verdict(1, Verdict::Safe)])], losses).unwrap();
    writer.conclude(Err(Fault::File(std::io::ErrorKind::Other.into())), losses, Seq(6));
    assert!(status.word().borrow().failure.is_some());
    let reader = connect::reader(&Folder::new(&scratch.data())).unwrap().expect("there is a journal");
    assert_eq!(rows::last_up_to(&reader.connection, None).unwrap(), Seq(5));
}

/// Safety R5: the journal is not written again, even after somebody puts the file back.
#[test]
fn a_journal_that_was_taken_away_or_is_damaged_is_not_written_to_again() {
    for fault in [Fault::TakenAway("journal.db"), Fault::Damaged("a page of it".to_owned())] {
        let scratch = Scratch::new();
        let (mut writer, status) = asking_writer(&scratch);
        writer.conclude(Err(fault), status.begin(), Seq(6));
        let again = writer.write(&[page(6, vec![wall(1, 1)])], status.begin());
        assert!(matches!(again, Err(Fault::Unwritable)), "{again:?}");
    }
}

/// Safety V3: the entries stay lost even if the program is killed before the disk has answered. Later entries are not
/// treated as lost.
#[test]
fn what_was_given_up_stays_lost_when_the_program_is_killed_then() {
    let scratch = Scratch::new();
    let (mut writer, status) = asking_writer(&scratch);
    let losses = status.begin();
    writer.write(&[page(6, vec![verdict(1, Verdict::Safe)])], losses).unwrap();
    status.give_up(status.at_work().unwrap(), "the disk does not answer");
    // The batch is not concluded, and the verdict is on disk.
    drop(writer);
    for _ in 0..2 {
        let recalled = recalled(&scratch.data()).unwrap().unwrap();
        assert_eq!(recalled.written, Seq(5));
        assert!(recalled.state.luggage[0].is_pending());
        drop(scratch.open());
    }
    let archive = scratch.open().archive;
    assert!(archive.luggage(LuggageId(1)).unwrap().expect("it is on record").is_pending());

    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(vec![verdict(1, Verdict::Danger), wall(1, 1)]);
    drop(scribe);
    let recalled = scratch.open().recalled.unwrap();
    assert_eq!(recalled.written, Seq(7));
    assert!(recalled.state.luggage[0].is_dangerous());
    assert_eq!(notes(&scratch), Vec::<String>::new());
}

/// The mark of a loss is cleared before the end of the failure is reported.
#[test]
fn what_is_kept_after_a_failure_outlives_a_kill() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    scribe.hand(vec![found(u64::MAX, None)]);
    scribe.until(|word| word.losses == 1 && word.failure.is_none());
    assert_eq!(marker::read(&Folder::new(&scratch.data())).unwrap(), None);
    let last = scribe.keep(vec![found(1, None), verdict(1, Verdict::Danger)]);
    // The store was not ended, as after a kill.
    assert_eq!(recalled(&scratch.data()).unwrap().unwrap().written, last);
}

#[test]
fn a_marker_is_put_down_and_cleared() {
    let scratch = Scratch::new();
    drop(scratch.open());
    let marker = Marker::new(&Folder::new(&scratch.data()));
    marker.put(Seq(3));
    assert_eq!(marker::read(&Folder::new(&scratch.data())).unwrap(), Some(Seq(3)));
    marker.clear().unwrap();
    assert_eq!(marker::read(&Folder::new(&scratch.data())).unwrap(), None);
    std::fs::write(Folder::new(&scratch.data()).marker().path(), "everything after entry 12").unwrap();
    let damaged = marker::read(&Folder::new(&scratch.data()));
    assert!(matches!(damaged, Err(Fault::Unusable(crate::storage::names::LOST, _))), "{damaged:?}");
}

/// The disk answers again before the commit.
#[test]
fn what_was_given_up_before_the_last_step_is_not_written() {
    let scratch = Scratch::new();
    let (mut writer, status) = writer(&scratch);
    let losses = status.begin();
    status.give_up(status.at_work().unwrap(), "the disk does not answer");
    let page = Page { first: Seq(1), entries: vec![at_noon(wall(1, 1))], kept_back: None };
    assert!(writer.write(&[page], losses).is_err());
    assert_eq!(recalled(&scratch.data()).unwrap(), None);
}

#[test]
fn what_was_handed_over_last_is_kept_when_the_program_ends() {
    let scratch = Scratch::new();
    let mut scribe = Scribe::new(scratch.open());
    let mut last = Seq(0);
    for _ in 0..300 {
        last = scribe.hand(vec![wall(1, 1)]);
    }
    drop(scribe);
    assert_eq!(scratch.open().recalled.map(|recalled| recalled.written), Some(last));
}
