//! Tests with full disks and with folders that cannot be written. The tests mount small disks in memory, for which
//! they must run as root. Permissions would not be enough, since root may ignore them.

use std::path::Path;
use std::process::Command;

use super::super::{ReadOnlyJournal, connect, folder::Folder, open_with};
use super::testing::*;
use hallsweep_core::command::Verdict;
use hallsweep_core::units::{LuggageId, Seq};

/// A disk in memory; unmounted when the test ends.
struct Disk<'a>(&'a Path);

impl Disk<'_> {
    /// Mounts a disk of `kib` KiB. Prints a line and returns `None` where mounting is not allowed.
    fn mount(path: &Path, kib: u32) -> Option<Disk<'_>> {
        std::fs::create_dir_all(path).expect("a folder to mount at");
        if mount(&["-t", "tmpfs", "-o", &format!("size={kib}k,mode=700"), "tmpfs"], path) {
            return Some(Disk(path));
        }
        let required = std::env::var_os("HALLSWEEP_REQUIRE_CLIENTS").is_some();
        assert!(!required, "nothing can be mounted, and HALLSWEEP_REQUIRE_CLIENTS says that it must");
        eprintln!("left out: this test mounts a disk in memory, for which it must be root");
        None
    }

    fn become_read_only(&self) {
        assert!(mount(&["-o", "remount,ro"], self.0));
    }

    fn become_writable(&self) {
        assert!(mount(&["-o", "remount,rw"], self.0));
    }
}

impl Drop for Disk<'_> {
    fn drop(&mut self) {
        let _ = Command::new("umount").arg("--lazy").arg(self.0).status();
    }
}

fn mount(arguments: &[&str], path: &Path) -> bool {
    let run = Command::new("mount").args(arguments).arg(path).stderr(std::process::Stdio::null()).status();
    run.is_ok_and(|status| status.success())
}

fn faults(scratch: &Scratch) -> Vec<String> {
    ReadOnlyJournal::open(&scratch.data()).unwrap().check().unwrap().faults
}

/// Safety R3.
#[test]
fn a_full_disk_is_said_and_work_resumes_when_there_is_room() {
    let scratch = Scratch::new();
    let data = scratch.data();
    let Some(_disk) = Disk::mount(&data, 1024) else { return };
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep([begin(1), vec![found(1, Some(photo("bag"))), verdict(1, Verdict::Danger)]].concat());
    let filler = data.join("filler");
    // This write fails on purpose when the disk is full.
    let _ = std::fs::write(&filler, vec![0; 2 * 1024 * 1024]);
    scribe.hand(vec![found(2, Some(photo(&"another bag".repeat(20_000))))]);
    let failed = scribe.until(|word| word.failure.is_some());
    assert!(failed.failure.as_deref().is_some_and(|words| words.starts_with("the disk is full: free some space")), "{failed:?}");
    assert_eq!((failed.kept, failed.losses), (Seq(6), 1));
    let record = scribe.opened.archive.luggage(LuggageId(1)).unwrap().expect("reading goes on");
    assert!(record.is_dangerous());
    assert_eq!(scribe.opened.archive.photo(LuggageId(1)), Ok(Some(photo("bag"))));
    std::fs::remove_file(filler).unwrap();
    scribe.until(|word| word.failure.is_none());
    scribe.keep(vec![found(2, Some(photo("another bag")))]);
    drop(scribe);
    assert_eq!(faults(&scratch), Vec::<String>::new());
}

/// Safety R3: writing starts later if there is no room at the start.
#[test]
fn a_disk_that_is_full_at_the_start_is_gone_on_with_later() {
    let scratch = Scratch::new();
    let data = scratch.data();
    let Some(_disk) = Disk::mount(&data, 1024) else { return };
    let filler = data.join("filler");
    let _ = std::fs::write(&filler, vec![0; 2 * 1024 * 1024]);
    let mut scribe = Scribe::new(scratch.open());
    let failed = scribe.until(|word| word.failure.is_some());
    assert_eq!((failed.kept, failed.losses), (Seq(0), 1));
    std::fs::remove_file(filler).unwrap();
    scribe.until(|word| word.failure.is_none());
    scribe.keep(begin(1));
    drop(scribe);
    assert_eq!(faults(&scratch), Vec::<String>::new());
}

/// Safety R3: writing also resumes where the write-ahead log itself takes most of the room.
#[test]
fn a_tiny_disk_that_the_log_has_filled_is_gone_on_with_when_there_is_room() {
    let scratch = Scratch::new();
    let data = scratch.data();
    let Some(_disk) = Disk::mount(&data, 900) else { return };
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    let filler = data.join("filler");
    std::fs::write(&filler, vec![0; 200 * 1024]).unwrap();
    let is_full = (0..10_000).any(|_| {
        let last = scribe.hand(vec![wall(1, 1)]);
        scribe.until(|word| word.failure.is_some() || word.kept >= last).failure.is_some()
    });
    assert!(is_full, "more is kept than there is room for");
    std::fs::remove_file(filler).unwrap();
    scribe.until(|word| word.failure.is_none());
    scribe.keep(vec![found(1, Some(photo("bag")))]);
    drop(scribe);
    assert_eq!(faults(&scratch), Vec::<String>::new());
}

/// A disk that has room for entries, but not for the photo that failed, still counts as failing.
#[test]
fn a_disk_that_is_all_but_full_is_not_tried_over_and_over() {
    let scratch = Scratch::new();
    let data = scratch.data();
    let Some(_disk) = Disk::mount(&data, 2048) else { return };
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep(begin(1));
    let large = photo(&"a bag".repeat(200_000));
    std::fs::write(data.join("filler"), vec![0; 1200 * 1024]).unwrap();
    scribe.hand(vec![found(1, Some(large.clone()))]);
    scribe.until(|word| word.failure.is_some());
    let tries = || -> i64 {
        let reader = connect::reader(&Folder::new(&data)).unwrap().expect("there is a journal");
        reader.connection.query_row("SELECT coalesce(sum(times), 0) FROM losses", [], |row| row.get(0)).unwrap()
    };
    eventually("the disk to be tried again", || tries() >= 10);
    let failing = scribe.until(|_| true);
    assert_eq!((failing.losses, failing.failure.is_some()), (1, true), "{failing:?}");
    std::fs::remove_file(data.join("filler")).unwrap();
    scribe.until(|word| word.failure.is_none());
    scribe.keep(vec![found(1, Some(photo("a small bag")))]);
}

/// Safety R3: a folder that cannot be created now is created as soon as this is possible.
#[test]
fn a_folder_that_cannot_be_made_is_made_later() {
    let scratch = Scratch::new();
    let above = scratch.data();
    let Some(disk) = Disk::mount(&above, 4096) else { return };
    disk.become_read_only();
    let data = above.join("below").join("data");
    let opened = open_with(&data, None, HASTE).expect("nobody uses what is not there");
    assert!(opened.failure.as_deref().is_some_and(|words| words.contains("make it writable")), "{:?}", opened.failure);
    assert_eq!(opened.archive.missions(None, 5), Ok(Vec::new()));
    let mut scribe = Scribe::new(opened);
    disk.become_writable();
    scribe.until(|word| word.failure.is_none());
    scribe.keep(begin(1));
    assert_eq!(scribe.opened.archive.missions(None, 5).map(|missions| missions.len()), Ok(1));
}

/// Safety R3: everything is recalled and can be read, but nothing moves. Work resumes when the folder can be written.
#[test]
fn a_read_only_folder_is_read_and_written_to_once_it_can_be() {
    let scratch = Scratch::new();
    let data = scratch.data();
    let Some(disk) = Disk::mount(&data, 4096) else { return };
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep([begin(1), vec![found(1, Some(photo("bag")))]].concat());
    drop(scribe);
    disk.become_read_only();
    let before = bytes(&data);
    let mut scribe = Scribe::new(scratch.open());
    let words = scribe.opened.failure.clone().expect("it cannot be written to");
    assert!(words.contains("cannot be written to: make it writable; recording goes on by itself"), "{words}");
    let recalled = scribe.opened.recalled.clone().expect("it can be read");
    assert_eq!((recalled.written, recalled.state.luggage.len()), (Seq(5), 1));
    assert_eq!(scribe.opened.archive.photo(LuggageId(1)), Ok(Some(photo("bag"))));
    assert_eq!(bytes(&data), before);

    disk.become_writable();
    scribe.until(|word| word.failure.is_none());
    scribe.keep(vec![verdict(1, Verdict::Safe)]);
    let record = scribe.opened.archive.luggage(LuggageId(1)).unwrap().expect("it is on record");
    assert_eq!(record.verdict_name(), "safe", "the archive sees what was written since");
    drop(scribe);
    assert_eq!(faults(&scratch), Vec::<String>::new());
}

/// A kill leaves part of the journal in the write-ahead log. If the folder is read-only after this, this part must
/// not be hidden.
#[test]
fn a_read_only_folder_with_an_unfinished_log_is_read_whole_or_not_at_all() {
    let scratch = Scratch::new();
    let data = scratch.data();
    let Some(disk) = Disk::mount(&data, 4096) else { return };
    let mut scribe = Scribe::new(scratch.open());
    scribe.keep([begin(1), vec![found(1, None), verdict(1, Verdict::Danger)]].concat());
    // The files are copied while they are open, as a kill would leave them.
    let killed = scratch.data().join("killed");
    std::fs::create_dir(&killed).unwrap();
    for name in ["journal.db", "journal.db-wal", "journal.db-shm"] {
        std::fs::copy(data.join(name), killed.join(name)).unwrap();
    }
    drop(scribe);
    disk.become_read_only();
    let reader = connect::reader(&Folder::new(&killed)).unwrap().expect("there is a journal");
    let entries: i64 = reader.connection.query_row("SELECT count(*) FROM events", [], |row| row.get(0)).unwrap();
    assert_eq!(entries, 6);
}
