//! The file `journal.head`: up to which entry the journal was kept, and the digest of its page. It is written behind each commit, into the
//! hands of the system, without a flush: so that entries that were cut off at the end are missed (safety R5). It may be behind the
//! journal, after a kill or a power cut, and is never before it.

use rusqlite::Connection;

use super::fault::Fault;
use super::folder::Folder;
use super::{chain, connect, rows, schema};
use crate::runtime::archive::Head;
use crate::storage::small_file::SmallFile;
use hallsweep_core::units::Seq;

/// So many bytes has the file: always as many, so that each writing covers the one before.
const LENGTH: usize = "entry ".len() + 20 + " sha256 ".len() + 64 + 1;

/// Writes it.
#[derive(Debug)]
pub(super) struct HeadFile(SmallFile);

impl HeadFile {
    pub(super) fn of(folder: &Folder) -> HeadFile {
        HeadFile(folder.head())
    }

    /// Says that the journal is kept up to here. Where this fails the file stays behind, which weakens what it is good for and nothing else.
    pub(super) fn put(&mut self, head: &Head) {
        let written = self.0.write_over(text(head).as_bytes()).map(drop);
        self.0.say(&written, "cannot be written: entries that are cut off behind it would not be missed", "is written again");
    }
}

/// Fails when the journal does not hold what the file says that was kept.
pub(super) fn check(folder: &Folder) -> Result<(), Fault> {
    let Some(head) = read(folder)? else { return Ok(()) };
    let Some(connect::Reader { connection, .. }) = connect::reader_of_entries(folder)? else {
        return Err(if folder.has_photos() { Fault::OnlyPhotos } else { Fault::CutOff(head.seq) });
    };
    is_held(&connection, &head)
}

/// Fails when the journal does not hold this page.
pub(super) fn is_held(connection: &Connection, head: &Head) -> Result<(), Fault> {
    if rows::last_up_to(connection, None)? < head.seq {
        return Err(Fault::CutOff(head.seq));
    }
    // One that was never chained is not the one that the file belongs to.
    let is_chained = schema::format(connection)? == schema::Format::Current;
    let there = if is_chained { chain::page_of(connection, head.seq)? } else { None };
    if there == Some(*head) { Ok(()) } else { Err(Fault::Another(head.seq)) }
}

/// Up to where the journal was kept; nothing where there is no such file, or one that a power cut left empty.
pub(super) fn read(folder: &Folder) -> Result<Option<Head>, Fault> {
    let bytes = folder.head().read(LENGTH)?.unwrap_or_default();
    if bytes.iter().all(|byte| *byte == 0) {
        return Ok(None);
    }
    let damaged = || Fault::Unusable("journal.head", "it is damaged".to_owned());
    understood(&bytes).map(Some).ok_or_else(damaged)
}

fn text(head: &Head) -> String {
    format!("entry {:020} sha256 {}\n", head.seq.0, head.hex())
}

fn understood(bytes: &[u8]) -> Option<Head> {
    let (seq, digest) = std::str::from_utf8(bytes).ok()?.strip_prefix("entry ")?.split_once(" sha256 ")?;
    let head = Head { seq: Seq(seq.parse().ok()?), digest: Head::read_digest(digest.strip_suffix('\n')?)? };
    (text(&head).as_bytes() == bytes).then_some(head)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_is_read_and_nothing_else_is() {
        for seq in [Seq(0), Seq(42), Seq(u64::MAX)] {
            let head = Head { seq, digest: [0xa5; 32] };
            let text = text(&head);
            assert_eq!((understood(text.as_bytes()), text.len()), (Some(head), LENGTH));
            for place in 0..text.len() {
                let mut changed = text.clone().into_bytes();
                changed[place] ^= 1;
                assert_ne!(understood(&changed), understood(text.as_bytes()), "{place}");
            }
        }
        assert_eq!(understood(b"entry 1 sha256 \n"), None);
    }
}
