//! The tables of the journal, and the migrations of older files.

use rusqlite::{Connection, Transaction};

use super::chain;
use super::fault::Fault;

/// Application id in the file's header: the letters HSWP.
const APPLICATION: i64 = 0x4853_5750;

/// Migrations from each format to the next; an empty file has format 0.
const MIGRATIONS: [&str; 4] =
    [include_str!("schema.sql"), include_str!("schema_2.sql"), include_str!("schema_3.sql"), include_str!("schema_4.sql")];

pub(super) const FORMAT: i64 = MIGRATIONS.len() as i64;

/// The format since which entries are unchanged.
pub(super) const ENTRIES_SINCE: i64 = 2;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Empty,
    Older(i64),
    Current,
}

pub(super) fn format(connection: &Connection) -> Result<Format, Fault> {
    let number = |sql: &str| connection.query_row(sql, [], |row| row.get::<_, i64>(0));
    let (application, version) = (number("PRAGMA application_id")?, number("PRAGMA user_version")?);
    let tables = number("SELECT count(*) FROM sqlite_schema")?;
    match (application, version) {
        (0, 0) if tables == 0 => Ok(Format::Empty),
        (APPLICATION, FORMAT) => Ok(Format::Current),
        (APPLICATION, version) if version > FORMAT => Err(Fault::Newer(version)),
        (APPLICATION, version) if version > 0 => Ok(Format::Older(version)),
        _ => Err(Fault::Foreign),
    }
}

/// Migrates a file to the present format, in one transaction.
pub(super) fn bring_up_to_date(connection: &mut Connection) -> Result<(), Fault> {
    let from = match format(connection)? {
        Format::Current => return Ok(()),
        Format::Empty => 0,
        Format::Older(version) => version,
    };
    let transaction = connection.transaction()?;
    migrate(&transaction, usize::try_from(from).unwrap_or(0))?;
    Ok(transaction.commit()?)
}

fn migrate(transaction: &Transaction<'_>, from: usize) -> Result<(), Fault> {
    for migration in MIGRATIONS.iter().skip(from) {
        transaction.execute_batch(migration)?;
    }
    chain::close_old_pages(transaction)?;
    transaction.pragma_update(None, "application_id", APPLICATION)?;
    Ok(transaction.pragma_update(None, "user_version", FORMAT)?)
}

/// Creates an empty file of an older format.
#[cfg(test)]
pub(super) fn of_format(connection: &mut Connection, format: u8) {
    let transaction = connection.transaction().unwrap();
    MIGRATIONS.iter().take(format.into()).for_each(|migration| transaction.execute_batch(migration).unwrap());
    transaction.pragma_update(None, "application_id", APPLICATION).unwrap();
    transaction.pragma_update(None, "user_version", format).unwrap();
    transaction.commit().unwrap();
}
