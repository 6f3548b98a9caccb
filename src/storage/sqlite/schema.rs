//! The tables of the journal, and the migrations of older files. A file of a newer version or of another program is
//! refused.

use rusqlite::Connection;

use super::chain;
use super::fault::Fault;

/// Application id in the file's header: the letters HSWP.
const APPLICATION: i64 = 0x4853_5750;

/// Migrations from each format to the next; an empty file has format 0.
const MIGRATIONS: [&str; 6] = [
    include_str!("schema.sql"),
    include_str!("schema_2.sql"),
    include_str!("schema_3.sql"),
    include_str!("schema_4.sql"),
    include_str!("schema_5.sql"),
    include_str!("schema_6.sql"),
];

pub(super) const FORMAT: i64 = MIGRATIONS.len() as i64;

/// Oldest format of which all entries can be read.
pub(super) const ENTRIES_SINCE: i64 = 2;

/// Oldest format in which the tables and the chain of digests are as they are now.
const TABLES_SINCE: i64 = 4;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Empty,
    /// Some tables are missing.
    Older(i64),
    /// All tables are there, and can be compared with the entries.
    Current,
}

pub(super) fn format(connection: &Connection) -> Result<Format, Fault> {
    let number = |sql: &str| connection.query_row(sql, [], |row| row.get::<_, i64>(0));
    let (application, version) = (number("PRAGMA application_id")?, number("PRAGMA user_version")?);
    let tables = number("SELECT count(*) FROM sqlite_schema")?;
    match (application, version) {
        (0, 0) if tables == 0 => Ok(Format::Empty),
        (APPLICATION, version) if version > FORMAT => Err(Fault::Newer(version)),
        (APPLICATION, TABLES_SINCE..) => Ok(Format::Current),
        (APPLICATION, version) if version > 0 => Ok(Format::Older(version)),
        _ => Err(Fault::Foreign),
    }
}

/// Migrates a file in one transaction, so that a kill leaves the file in its old format.
pub(super) fn bring_up_to_date(connection: &mut Connection) -> Result<(), Fault> {
    // A file of another program is refused; an empty file is of format 0.
    format(connection)?;
    let from: i64 = connection.query_row("PRAGMA user_version", [], |row| row.get(0))?;
    if from == FORMAT {
        return Ok(());
    }
    let transaction = connection.transaction()?;
    for migration in MIGRATIONS.iter().skip(usize::try_from(from).unwrap_or(0)) {
        transaction.execute_batch(migration)?;
    }
    if from < TABLES_SINCE {
        chain::close_old_pages(&transaction)?;
    }
    transaction.pragma_update(None, "application_id", APPLICATION)?;
    transaction.pragma_update(None, "user_version", FORMAT)?;
    Ok(transaction.commit()?)
}

#[cfg(test)]
pub(super) fn of_format(connection: &mut Connection, format: u8) {
    let transaction = connection.transaction().unwrap();
    MIGRATIONS.iter().take(format.into()).for_each(|migration| transaction.execute_batch(migration).unwrap());
    transaction.pragma_update(None, "application_id", APPLICATION).unwrap();
    transaction.pragma_update(None, "user_version", format).unwrap();
    transaction.commit().unwrap();
}
