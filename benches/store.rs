//! Speed of the store: durable commits, the time from sending a record to its confirmation, opening a long
//! journal, and a large map, beside what the disk achieves in the same run. `cargo bench --bench store` runs it; this
//! file contains no tests.
#![expect(clippy::disallowed_methods, clippy::print_stdout, reason = "a benchmark looks at the clock and prints")]

#[path = "common/goals.rs"]
#[expect(dead_code, reason = "its figures stand beside the disk's, without a goal")]
mod goals;

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use hallsweep::api::journal;
use hallsweep::runtime::store::StoreStatus;
use hallsweep::storage::sqlite::{self, Opened, ReadOnlyJournal};
use hallsweep_core::command::Strategy;
use hallsweep_core::effect::Page;
use hallsweep_core::state::PersistentState;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::units::{Cell, Heading, Pose, Revision, Seq, WallTime};
use hallsweep_core::world::hall_map::{HallMap, Mark};
use tokio::sync::watch;

/// Number of consecutive records.
const RECORDS: usize = 2000;

/// Entries of a long journal.
const LONG: u64 = 1_000_000;

/// Columns and rows of a large hall.
const SIDE: i32 = 512;

fn main() -> ExitCode {
    let folder = std::env::temp_dir().join(format!("hallsweep-bench-{}", std::process::id()));
    flushes(&folder);
    records(&folder);
    long_journal(&folder);
    large_map();
    let _ = std::fs::remove_dir_all(folder);
    goals::exit()
}

/// Speed of the disk: repeated small appends with a flush each.
fn flushes(folder: &Path) {
    std::fs::create_dir_all(folder).expect("a folder");
    let mut file = std::fs::File::create(folder.join("flushed")).expect("a file");
    let times = (0..RECORDS).map(|_| {
        let start = Instant::now();
        file.write_all(&[0x5a; 4096]).and_then(|()| file.sync_data()).expect("it is written");
        start.elapsed()
    });
    show("4 KiB and a flush, the disk alone", times.collect());
}

/// Consecutive records; each waits for the confirmation of the one before.
fn records(folder: &Path) {
    let Opened { mut store, .. } = sqlite::open(&folder.join("records"), None).expect("the folder is ours");
    let mut word = store.word();
    let times = (0..RECORDS as u64).map(|n| {
        let start = Instant::now();
        store.record(Page { first: Seq(3 * n + 1), entries: vec![pose(n), pose(n + 1), pose(n + 2)], kept_back: None }, 0);
        until(&mut word, Seq(3 * n + 3));
        start.elapsed()
    });
    show("a page of 3 entries, from hand to word", times.collect());
}

/// Many records, batched at the disk's pace; then the journal is opened again and checked.
fn long_journal(folder: &Path) {
    let data = folder.join("long");
    let start = Instant::now();
    let Opened { mut store, .. } = sqlite::open(&data, None).expect("the folder is ours");
    let mut word = store.word();
    for first in (1..LONG).step_by(1000) {
        store.record(Page { first: Seq(first), entries: (first..first + 1000).map(pose).collect(), kept_back: None }, 0);
        if first % 64_000 == 1 {
            until(&mut word, Seq(first));
        }
    }
    until(&mut word, Seq(LONG));
    println!("{LONG} entries written in {:.2?}", start.elapsed());
    drop(store);
    let start = Instant::now();
    let opened = sqlite::open(&data, None).expect("the folder is ours");
    println!("opened, all of them folded, in {:.2?}", start.elapsed());
    let mut store = opened.store;
    let mut word = store.word();
    let standing = Fact::State(Box::new(PersistentState::first(Strategy::Snail)));
    store.record(
        Page { first: Seq(LONG + 1), entries: vec![Entry { wall: WallTime::default(), fact: standing }], kept_back: None },
        0,
    );
    until(&mut word, Seq(LONG + 1));
    drop(store);
    let start = Instant::now();
    drop(sqlite::open(&data, None).expect("the folder is ours"));
    println!("opened, from an entry that says everything, in {:.2?}", start.elapsed());
    let start = Instant::now();
    let findings = ReadOnlyJournal::open(&data).and_then(|reading| reading.check()).expect("it can be read");
    println!("checked in {:.2?}", start.elapsed());
    goals::met(&format!("a journal without faults: {} found", findings.count), findings.count == 0);
}

/// A large hall applied cell by cell, and converted to JSON and back.
fn large_map() {
    let cells = || (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| Cell::new(x, y)));
    let mark = |cell: Cell| if (cell.x * 7 + cell.y * 13) % 11 == 0 { Mark::Wall } else { Mark::Visited };
    let mut standing = PersistentState::first(Strategy::Snail);
    let start = Instant::now();
    cells().for_each(|cell| standing.apply(&Entry { wall: WallTime::default(), fact: Fact::Mark(cell, mark(cell)) }));
    println!("{SIDE} × {SIDE} cells folded one by one in {:.2?}", start.elapsed());
    let mut map = HallMap::new(Cell::HOME, Revision(1));
    let start = Instant::now();
    let changed = cells().filter(|cell| map.mark(*cell, mark(*cell), Revision(1))).count();
    println!("{changed} of them, only marked, in {:.2?}", start.elapsed());
    let fact = Fact::State(Box::new(standing));
    let start = Instant::now();
    let text = journal::body(&fact, None);
    println!("written as JSON in {:.2?}, {} KiB", start.elapsed(), text.len() / 1024);
    let start = Instant::now();
    let read = journal::read_body(&text).expect("it was just written");
    println!("read back in {:.2?}", start.elapsed());
    assert_eq!(read.0, fact);
}

fn pose(n: u64) -> Entry {
    let cell = Cell::new((n % 500) as i32, (n / 500 % 500) as i32);
    let fact =
        if n.is_multiple_of(2) { Fact::Mark(cell, Mark::Visited) } else { Fact::Pose(Pose { cell, heading: Heading::East }) };
    Entry { wall: WallTime { unix_ms: 1_770_000_000_000, offset_s: 3600 }, fact }
}

fn until(word: &mut watch::Receiver<StoreStatus>, seq: Seq) {
    let runtime = tokio::runtime::Builder::new_current_thread().build().expect("a small runtime");
    let word = runtime.block_on(word.wait_for(|word| word.kept >= seq || word.failure.is_some())).expect("the store lives");
    assert_eq!(word.failure, None);
}

fn show(what: &str, mut times: Vec<Duration>) {
    let total: Duration = times.iter().sum();
    times.sort();
    let at = |hundredths: usize| times[(times.len() - 1) * hundredths / 100];
    let a_second = times.len() as f64 / total.as_secs_f64();
    println!("{what}: {a_second:.0} a second, p50 {:.2?}, p99 {:.2?}, worst {:.2?}", at(50), at(99), at(100));
}
