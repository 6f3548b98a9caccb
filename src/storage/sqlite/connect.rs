//! Connections to the journal: one that writes, durably, and any number that only read.

use std::path::Path;
use std::time::Duration;

use rusqlite::{Connection, ErrorCode, OpenFlags};

use super::fault::Fault;
use super::folder::Folder;
use super::schema::{self, Format};

/// How long a lock of another program is waited for: more than any reader of this program holds one.
const PATIENCE: Duration = Duration::from_secs(2);

/// After a checkpoint the write-ahead log is cut to this many bytes, so that one large mission does not leave a large file.
const LOG_LIMIT: i64 = 16 * 1024 * 1024;

/// So many prepared statements are kept: more than there are.
pub(super) const STATEMENTS: usize = 32;

/// The connection that writes. Each commit has reached the disk when it returns (safety D1).
pub(super) fn writer(folder: &Folder) -> Result<Connection, Fault> {
    let flags = OpenFlags::SQLITE_OPEN_READ_WRITE | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let connection = Connection::open_with_flags(folder.journal(), flags)?;
    if connection.is_readonly("main")? {
        return Err(Fault::Unwritable);
    }
    connection.busy_timeout(PATIENCE)?;
    connection.set_prepared_statement_cache_capacity(STATEMENTS);
    // What is not ours is not even switched to another mode of writing.
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
    /// Whether it takes it that nobody writes: it would not see when somebody did.
    pub(super) is_still: bool,
}

/// A connection that only reads; `None` when there is no journal yet.
pub(super) fn reader(folder: &Folder) -> Result<Option<JournalReader>, Fault> {
    reader_from(folder, schema::FORMAT)
}

/// The same for whoever only reads entries, which were written alike before other tables were added.
pub(super) fn reader_of_entries(folder: &Folder) -> Result<Option<JournalReader>, Fault> {
    reader_from(folder, schema::ENTRIES_SINCE)
}

fn reader_from(folder: &Folder, oldest: i64) -> Result<Option<JournalReader>, Fault> {
    if !folder.has_journal()? {
        return Ok(None);
    }
    match open_reader(&folder.journal(), OpenFlags::empty(), oldest) {
        // Where nothing can be written SQLite cannot even make the files by which readers and writers agree. Nobody else writes
        // there either, so that it can be told that the file stands still.
        Err(Fault::Sql(error)) if needs_no_log(&error) && !folder.has_log() => {
            let address = format!("file:{}?immutable=1", escaped(&folder.journal()));
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

fn needs_no_log(error: &rusqlite::Error) -> bool {
    matches!(error.sqlite_error_code(), Some(ErrorCode::CannotOpen | ErrorCode::ReadOnly))
}

/// A path as part of a URI.
fn escaped(path: &Path) -> String {
    let plain = |byte: u8| byte.is_ascii_alphanumeric() || b"/-._~".contains(&byte);
    let bytes = path.as_os_str().as_encoded_bytes();
    bytes.iter().map(|byte| if plain(*byte) { char::from(*byte).to_string() } else { format!("%{byte:02X}") }).collect()
}

/// Some settings answer with their value, some with nothing.
fn no_row(error: rusqlite::Error) -> Result<(), rusqlite::Error> {
    if matches!(error, rusqlite::Error::QueryReturnedNoRows) { Ok(()) } else { Err(error) }
}
