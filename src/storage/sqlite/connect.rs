//! Connections to the journal: one connection that writes durably, and any number of connections that only read.

use std::path::Path;
use std::time::Duration;

use rusqlite::{Connection, ErrorCode, OpenFlags};

use super::fault::Fault;
use super::folder::Folder;
use super::schema::{self, Format};

/// Maximum time to wait for a lock of another program. It is longer than any reader of this program holds a lock.
const PATIENCE: Duration = Duration::from_secs(2);

/// Size in bytes to which a checkpoint cuts the write-ahead log, so that one large mission does not leave a large file.
const LOG_LIMIT: i64 = 16 * 1024 * 1024;

/// Capacity of the cache of prepared statements. It exceeds the number of statements.
pub(super) const STATEMENTS: usize = 32;

/// Opens the connection that writes. Each commit is on disk when it returns (safety D1).
pub(super) fn writer(folder: &Folder) -> Result<Connection, Fault> {
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = Connection::open_with_flags(folder.journal(), flags)?;
    if connection.is_readonly("main")? {
        return Err(Fault::Unwritable);
    }
    connection.busy_timeout(PATIENCE)?;
    connection.set_prepared_statement_cache_capacity(STATEMENTS);
    // A file of another program is rejected before its journal mode is changed.
    schema::format(&connection)?;
    let mode: String = connection.query_row("PRAGMA journal_mode = WAL", [], |row| row.get(0))?;
    if mode != "wal" {
        return Err(Fault::Unwritable);
    }
    connection.pragma_update(None, "synchronous", "FULL")?;
    connection.pragma_update(None, "foreign_keys", true)?;
    connection.query_row("PRAGMA mmap_size = 0", [], |_| Ok(())).or_else(no_row)?;
    connection.query_row(&format!("PRAGMA journal_size_limit = {LOG_LIMIT}"), [], |_| Ok(())).or_else(no_row)?;
    Ok(connection)
}

#[derive(Debug)]
pub(super) struct JournalReader {
    pub(super) connection: Connection,
    /// Whether the file was opened as immutable. Such a connection does not see later writes.
    pub(super) is_still: bool,
}

/// Opens a read-only connection; `None` when there is no journal yet.
pub(super) fn reader(folder: &Folder) -> Result<Option<JournalReader>, Fault> {
    reader_from(folder, schema::FORMAT)
}

/// Like `reader`, but only for entries. It also opens files of some older formats, whose entries can be read although
/// other tables are missing.
pub(super) fn reader_of_entries(folder: &Folder) -> Result<Option<JournalReader>, Fault> {
    reader_from(folder, schema::ENTRIES_SINCE)
}

fn reader_from(folder: &Folder, oldest: i64) -> Result<Option<JournalReader>, Fault> {
    if !folder.has_journal()? {
        return Ok(None);
    }
    match open_reader(&folder.journal(), OpenFlags::empty(), oldest) {
        // On a read-only disk SQLite cannot create the files through which readers and writers coordinate. No program
        // can write there, so the file may be opened as immutable.
        Err(Fault::Sql(error))
            if matches!(error.sqlite_error_code(), Some(ErrorCode::CannotOpen | ErrorCode::ReadOnly)) && !folder.has_log() =>
        {
            let is_plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte);
            let mut address = "file:".to_owned();
            for byte in folder.journal().as_os_str().as_encoded_bytes() {
                address += &if is_plain(*byte) { char::from(*byte).to_string() } else { format!("%{byte:02X}") };
            }
            address += "?immutable=1";
            let connection = open_reader(Path::new(&address), OpenFlags::SQLITE_OPEN_URI, oldest)?;
            Ok(connection.map(|connection| JournalReader { connection, is_still: true }))
        }
        connection => Ok(connection?.map(|connection| JournalReader { connection, is_still: false })),
    }
}

fn open_reader(path: &Path, flags: OpenFlags, oldest: i64) -> Result<Option<Connection>, Fault> {
    let flags = flags | OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = Connection::open_with_flags(path, flags)?;
    connection.busy_timeout(PATIENCE)?;
    connection.set_prepared_statement_cache_capacity(STATEMENTS);
    connection.query_row("PRAGMA mmap_size = 0", [], |_| Ok(())).or_else(no_row)?;
    match schema::format(&connection)? {
        Format::Empty => Ok(None),
        Format::Older(version) if version < oldest => Err(Fault::Older(version)),
        Format::Older(_) | Format::Current => Ok(Some(connection)),
    }
}

/// A pragma may return its value or nothing. Both count as success.
fn no_row(error: rusqlite::Error) -> Result<(), rusqlite::Error> {
    if matches!(error, rusqlite::Error::QueryReturnedNoRows) { Ok(()) } else { Err(error) }
}
