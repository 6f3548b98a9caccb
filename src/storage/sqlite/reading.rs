//! The journal for whoever only looks at it, as the command `hallsweep journal` does, beside a running program or without one.
//! What the doors ask for stands in `archive`.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rusqlite::{Connection, TransactionBehavior};

use super::archive::SqliteArchive;
use super::archive_check::{self, ArchiveCheck};
use super::check::{self, Findings};
use super::fault::{Fault, Then};
use super::folder::Folder;
use super::of_archives::Records;
use super::rows::{self, EntryFilter};
use super::{connect, project};
use crate::api::journal::Line;
use crate::runtime::archive::{Archive, Unreadable};
use hallsweep_core::units::{MissionId, Seq};

#[derive(Debug)]
pub struct ReadOnlyJournal {
    folder: Folder,
    connection: Connection,
}

impl ReadOnlyJournal {
    /// Opens the journal in the folder `path`.
    pub fn open(path: &Path) -> Result<ReadOnlyJournal, Unreadable> {
        let folder = Folder::new(path);
        let opened = connect::reader_of_entries(&folder).map_err(|fault| unreadable(&folder, &fault))?;
        let none = || Unreadable(format!("there is no journal in {}: name its folder with --data", path.display()));
        Ok(ReadOnlyJournal { connection: opened.ok_or_else(none)?.connection, folder })
    }

    /// Walks over the entries, oldest first, of one mission or of all, all of them or the `last` ones, while `visit` says to go
    /// on. Of what cannot be understood its place is given, and a sentence.
    pub fn lines(
        &self,
        mission: Option<MissionId>,
        last: Option<u64>,
        mut visit: impl FnMut(Seq, Result<Line, String>) -> bool,
    ) -> Result<(), Unreadable> {
        let words = |fault: Fault| fault.words_of_an_entry(self.folder.path());
        let mut walk = || {
            // Both looks see the same entries, though a running program writes on.
            let _unchanging = self.connection.unchecked_transaction()?;
            let after = last.map_or(Ok(None), |last| rows::before_the_last(&self.connection, mission, last))?;
            rows::each(&self.connection, EntryFilter { after, mission, ..EntryFilter::default() }, |seq, line| {
                if visit(seq, line.map_err(words)) { Ok(()) } else { Err(Fault::GivenUp) }
            })
        };
        match walk() {
            Ok(()) | Err(Fault::GivenUp) => Ok(()),
            Err(fault) => Err(unreadable(&self.folder, &fault)),
        }
    }

    /// The same journal for whoever asks about missions.
    pub fn archive(&self) -> Arc<dyn Archive> {
        Arc::new(SqliteArchive::new(self.folder.clone()))
    }

    /// Holds these archives against the journal, and one another.
    pub fn check_archives(&self, archives: &[PathBuf]) -> Result<ArchiveCheck, Unreadable> {
        archive_check::check_archives(&self.connection, &self.folder, archives)
    }

    /// The archive that holds this mission, when it was written out of the journal: its file's name and SHA-256.
    pub fn archive_with(&self, mission: MissionId) -> Result<Option<(String, String)>, Unreadable> {
        let records = Records::of(&self.connection).map_err(|fault| unreadable(&self.folder, &fault))?;
        Ok(records.with_mission(mission).map(|record| (record.file.clone(), record.digest.clone())))
    }

    pub fn check(&self) -> Result<Findings, Unreadable> {
        check::check(&self.connection, &self.folder).map_err(|fault| unreadable(&self.folder, &fault))
    }
}

/// Makes the tables that follow from the journal anew, in one transaction; how many entries they follow from.
pub fn rebuild(path: &Path) -> Result<u64, Unreadable> {
    let folder = Folder::new(path);
    // Who is not there is not created.
    drop(ReadOnlyJournal::open(path)?);
    if folder.is_archive() {
        return Err(Unreadable(format!("{} is an archive, which is only read", path.display())));
    }
    let rebuilt = || {
        let lock = folder.lock()?;
        let mut connection = connect::writer(&folder)?;
        let transaction = connection.transaction_with_behavior(TransactionBehavior::Immediate)?;
        let entries = project::rebuild(&transaction)?;
        transaction.commit()?;
        drop(lock);
        Ok(entries)
    };
    rebuilt().map_err(|fault| unreadable(&folder, &fault))
}

fn unreadable(folder: &Folder, fault: &Fault) -> Unreadable {
    Unreadable(fault.words(folder.path(), Then::StartAgain))
}
