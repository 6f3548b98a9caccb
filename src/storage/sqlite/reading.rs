//! The journal for commands such as `hallsweep journal`, whether or not hallsweep runs. It is only read, but
//! `rebuild` also writes its tables. Queries of the doors are in `archive`.

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
    pub fn open(path: &Path) -> Result<ReadOnlyJournal, Unreadable> {
        let folder = Folder::new(path);
        let opened = connect::reader_of_entries(&folder).map_err(|fault| unreadable(&folder, &fault))?;
        let none = || Unreadable(format!("there is no journal in {}: name its folder with --data", path.display()));
        Ok(ReadOnlyJournal { connection: opened.ok_or_else(none)?.connection, folder })
    }

    /// Visits the entries of one mission or of all missions, oldest first. With `last`, only this number of last
    /// entries is visited. Ends when `visit` returns false. For an entry that cannot be read, `visit` gets its
    /// place and a sentence.
    pub fn lines(
        &self,
        mission: Option<MissionId>,
        last: Option<u64>,
        mut visit: impl FnMut(Seq, Result<Line, String>) -> bool,
    ) -> Result<(), Unreadable> {
        let words = |fault: Fault| fault.words_of_an_entry(self.folder.path());
        let mut walk = || {
            // One transaction, so that both queries see the same entries while a program writes.
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

    pub fn archive(&self) -> Arc<dyn Archive> {
        Arc::new(SqliteArchive::new(self.folder.clone()))
    }

    pub fn check_archives(&self, archives: &[PathBuf]) -> Result<ArchiveCheck, Unreadable> {
        archive_check::check_archives(&self.connection, &self.folder, archives)
    }

    /// File name and SHA-256 of the archive that holds this mission.
    pub fn archive_with(&self, mission: MissionId) -> Result<Option<(String, String)>, Unreadable> {
        let records = Records::of(&self.connection).map_err(|fault| unreadable(&self.folder, &fault))?;
        Ok(records.with_mission(mission).map(|record| (record.file.clone(), record.digest.clone())))
    }

    pub fn check(&self) -> Result<Findings, Unreadable> {
        check::check(&self.connection, &self.folder).map_err(|fault| unreadable(&self.folder, &fault))
    }
}

/// Rebuilds the tables that follow from the journal, in one transaction; returns the number of entries read.
pub fn rebuild(path: &Path) -> Result<u64, Unreadable> {
    let folder = Folder::new(path);
    // Fails when there is no journal, so that rebuilding does not create a journal.
    drop(ReadOnlyJournal::open(path)?);
    if folder.is_archive() {
        return Err(Unreadable(format!("{} is an archive, and archives are never changed", path.display())));
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
