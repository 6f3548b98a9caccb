//! Shared by the tests of the store: a temporary folder, pages of a small mission, and waiting for a status.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use super::super::writer::Patience;
use super::super::{OpenError, Opened, ReadOnlyJournal, connect, folder::Folder, open_with};
use crate::runtime::store::StoreStatus;
use crate::runtime::tests::within::within;
use crate::storage::tests::scratch;
use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Command, CommandId, Door, Issuer, Strategy, Verdict};
use hallsweep_core::effect::Page;
use hallsweep_core::event::Photo;
use hallsweep_core::state::fact::{Entry, Fact};
use hallsweep_core::state::{Inspection, PersistentState, Phase, Stage};
use hallsweep_core::units::{Cell, LuggageId, MissionId, Pose, Seq, WallTime};
use hallsweep_core::world::hall_map::Mark;
use hallsweep_core::world::luggage::{Luggage, PhotoState};

/// Retries after 1 ms, never declares a batch lost, and waits long for the last pages.
pub(super) const HASTE: Patience =
    Patience { retry: Duration::from_millis(1), looks: u32::MAX, look: Duration::from_millis(1), end: Duration::from_secs(600) };

pub(super) struct Scratch(scratch::Scratch);

/// Number of attempts to open a folder in use. With the pauses between them, they take a minute.
const LOOKS: u32 = 12_000;
const GLANCE: std::time::Duration = std::time::Duration::from_millis(5);

impl Scratch {
    pub(super) fn new() -> Scratch {
        Scratch(scratch::Scratch::new())
    }

    /// Path of the store; not created yet.
    pub(super) fn data(&self) -> PathBuf {
        self.0.0.join("data")
    }

    /// Opens the store, and retries while it is locked. Another test may be starting a child process at the same
    /// moment. The child holds every open file of this process until it runs its own program. So it also holds the
    /// lock of a store that was just closed.
    pub(super) fn open(&self) -> Opened {
        self.open_with(HASTE)
    }

    pub(super) fn open_with(&self, patience: Patience) -> Opened {
        for _ in 0..LOOKS {
            match open_with(&self.data(), None, patience) {
                Err(OpenError::InUse(_)) => std::thread::sleep(GLANCE),
                opened => return opened.expect("the system lets it start"),
            }
        }
        panic!("somebody else uses {}", self.data().display())
    }
}

pub(super) struct Scribe {
    pub(super) opened: Opened,
    written: Seq,
    word: tokio::sync::watch::Receiver<StoreStatus>,
}

impl Scribe {
    pub(super) fn new(opened: Opened) -> Scribe {
        let written = opened.recalled.as_ref().map_or(Seq(0), |recalled| recalled.written);
        let word = opened.store.word();
        Scribe { opened, written, word }
    }

    /// Hands a page over, as a sender who knows all losses.
    pub(super) fn hand(&mut self, facts: Vec<Fact>) -> Seq {
        let losses = self.word.borrow().losses;
        self.hand_knowing(facts, losses)
    }

    pub(super) fn hand_knowing(&mut self, facts: Vec<Fact>, losses: u64) -> Seq {
        self.hand_entries(facts.into_iter().map(at_noon).collect(), losses)
    }

    fn hand_entries(&mut self, entries: Vec<Entry>, losses: u64) -> Seq {
        let page = Page { first: self.written.next(), entries, kept_back: None };
        self.written = page.last();
        self.opened.store.record(page, losses);
        self.written
    }

    /// Waits until the status is as `wanted` says.
    pub(super) fn until(&mut self, wanted: impl FnMut(&StoreStatus) -> bool) -> StoreStatus {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a small runtime");
        let heard = self.word.clone();
        let waited = runtime.block_on(async { tokio::time::timeout(Duration::from_secs(60), self.word.wait_for(wanted)).await });
        let word = waited.unwrap_or_else(|_| panic!("it does not come to be within a minute: {:?}", *heard.borrow()));
        word.expect("the store lives").clone()
    }

    /// Like `keep`, for entries with times of their own.
    pub(super) fn keep_entries(&mut self, entries: Vec<Entry>) {
        let losses = self.word.borrow().losses;
        let last = self.hand_entries(entries, losses);
        self.until(|word| word.kept >= last);
    }

    /// Hands a page over and waits until it is stored.
    pub(super) fn keep(&mut self, facts: Vec<Fact>) -> Seq {
        let last = self.hand(facts);
        self.until(|word| word.kept >= last);
        last
    }
}

/// Waits until `is_so` returns true. `what` is the end of the error message when that takes too long.
pub(super) fn eventually(what: &str, is_so: impl Fn() -> bool) {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_time().build().expect("a small runtime");
    runtime.block_on(within(what, async {
        while !is_so() {
            tokio::time::sleep(Duration::from_millis(1)).await;
        }
    }));
}

pub(super) fn at_noon(fact: Fact) -> Entry {
    Entry { wall: WallTime { unix_ms: 1_770_000_000_000, offset_s: 3600 }, fact }
}

pub(super) fn command(id: Option<&str>) -> Fact {
    let id = id.and_then(CommandId::new);
    Fact::Command {
        issuer: Issuer::operator(Door("http")),
        id,
        asked: Asked::Command(Command::Start),
        epoch: None,
        luggage: None,
        refused: None,
    }
}

/// The page that begins a mission. As in the core, the phase is recorded before the beginning.
pub(super) fn begin(mission: u64) -> Vec<Fact> {
    vec![command(None), Fact::Phase(Phase::Exploring), Fact::MissionBegan(MissionId(mission), Strategy::Snail), Fact::Led(true)]
}

/// The page that ends a mission. As in the core, the phase is recorded before the end.
pub(super) fn archive(mission: u64) -> Vec<Fact> {
    vec![command(None), Fact::Phase(Phase::Idle), Fact::MissionArchived(MissionId(mission), vec![LuggageId(9)])]
}

pub(super) fn photo(text: &str) -> Photo {
    Photo { bytes: text.as_bytes().into(), media_type: "image/png" }
}

pub(super) fn inspecting(id: u64) -> Fact {
    let stage = Stage::AwaitingVerdict(LuggageId(id));
    Fact::Phase(Phase::Inspecting(Inspection { cell: Cell::new(0, 1), piece: None, pose: Pose::START, stage, views: 0 }))
}

pub(super) fn found(id: u64, photo: Option<Photo>) -> Fact {
    let taken = photo.as_ref().map(|photo| PhotoState::Taken { bytes: photo.bytes.len(), take: 1 });
    let record = Luggage {
        id: LuggageId(id),
        cell: Cell::new(0, 1),
        pose: Pose::START,
        taken: WallTime::default(),
        first_taken: WallTime::default(),
        photo: taken.unwrap_or(PhotoState::Failed("dark".to_owned())),
        verdict: None,
        seen_from: Vec::new(),
        unsure: Vec::new(),
        judged: Vec::new(),
        truth: None,
        piece: None,
        secured: None,
        clock_set_ms: 0,
    };
    Fact::Luggage { record: Arc::new(record), photo }
}

pub(super) fn taken(id: u64, take: u32, photo: Photo) -> Fact {
    let Fact::Luggage { record, photo } = found(id, Some(photo)) else { panic!("it is a piece of luggage") };
    let state = PhotoState::Taken { bytes: 1, take };
    Fact::Luggage { record: Arc::new(Luggage { photo: state, ..Luggage::clone(&record) }), photo }
}

pub(super) fn verdict(id: u64, verdict: Verdict) -> Fact {
    Fact::Verdict { luggage: LuggageId(id), verdict, who: "anna".into(), note: None, hot: Default::default() }
}

pub(super) fn wall(x: i32, y: i32) -> Fact {
    Fact::Mark(Cell::new(x, y), Mark::Wall)
}

/// Every file below a folder, with its bytes, except for the files that SQLite keeps beside an open journal.
pub(super) fn bytes(folder: &Path) -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).expect("the folder is there").map(|entry| entry.expect("it can be read").path()) {
        if entry.is_dir() {
            files.extend(bytes(&entry));
        } else if !["db-wal", "db-shm", "lock"].iter().any(|end| entry.extension().is_some_and(|extension| extension == *end)) {
            files.push((entry.clone(), std::fs::read(&entry).expect("it can be read")));
        }
    }
    files.sort();
    files
}

pub(super) fn fold<'a>(entries: impl IntoIterator<Item = &'a Entry>) -> PersistentState {
    let mut state = PersistentState::first(Strategy::default());
    entries.into_iter().for_each(|entry| state.apply(entry));
    state
}

pub(super) fn check_finds(scratch: &Scratch, words: &[&str]) {
    let findings = ReadOnlyJournal::open(&scratch.data()).unwrap().check().unwrap();
    assert_eq!(findings.faults.len(), words.len(), "{:?}", findings.faults);
    for (fault, words) in findings.faults.iter().zip(words) {
        assert!(fault.contains(words), "{fault}");
    }
}

/// Changes an entry in spite of the triggers that forbid this, and leaves no other trace.
pub(super) fn rewrite(scratch: &Scratch, sql: &str) {
    let connection = connect::writer(&Folder::new(&scratch.data())).unwrap();
    let mut triggers = connection.prepare("SELECT name, sql FROM sqlite_schema WHERE type = 'trigger'").unwrap();
    let triggers = triggers.query_map([], |row| Ok((row.get(0)?, row.get(1)?))).unwrap();
    let triggers: Vec<(String, String)> = triggers.map(Result::unwrap).collect();
    let dropped: String = triggers.iter().map(|(name, _)| format!("DROP TRIGGER {name};")).collect();
    let made: String = triggers.iter().map(|(_, sql)| format!("{sql};")).collect();
    connection.execute_batch(&format!("{dropped}{sql};{made}")).unwrap();
}

/// Changes the file without using the store.
pub(super) fn meddle(scratch: &Scratch, sql: &str) {
    connect::writer(&Folder::new(&scratch.data())).unwrap().execute_batch(sql).unwrap();
}
