//! The archives that a journal or archive has on record: archives written out of it, and archives from which it was unpacked.

use rusqlite::Connection;

use super::fault::Fault;
use super::rows::{self, EntryFilter};
use crate::api::journal::Line;
use crate::runtime::archive::Head;
use hallsweep_core::state::fact::{Entry, Fact, Unpacked, WrittenOut};
use hallsweep_core::units::{MissionId, Seq};

#[derive(Debug, Default)]
pub(super) struct Records {
    pub(super) written_out: Vec<WrittenOut>,
    pub(super) unpacked: Vec<Unpacked>,
}

impl Records {
    pub(super) fn of(connection: &Connection) -> Result<Records, Fault> {
        let mut records = Records::default();
        records.add(connection)?;
        Ok(records)
    }

    pub(super) fn add(&mut self, connection: &Connection) -> Result<(), Fault> {
        let of_archives = EntryFilter { kinds: rows::Kinds::OfArchives, ..EntryFilter::default() };
        rows::each(connection, of_archives, |_, line| {
            let Ok(Line { entry: Entry { fact, .. }, .. }) = line else { return Ok(()) };
            if let Fact::WrittenOut(record) = fact {
                self.written_out.push(record);
            } else if let Fact::Unpacked(record) = fact {
                self.unpacked.push(record);
            }
            Ok(())
        })
    }

    pub(super) fn written_out(&self, until: Seq) -> Option<&WrittenOut> {
        self.written_out.iter().rfind(|record| record.until == until)
    }

    pub(super) fn with_mission(&self, mission: MissionId) -> Option<&WrittenOut> {
        self.written_out.iter().find(|record| (record.missions.0..=record.missions.1).contains(&mission))
    }

    pub(super) fn unpacked(&self, begins: Head) -> Option<&Unpacked> {
        self.unpacked.iter().rfind(|record| record.behind == begins.seq && record.page == begins.hex())
    }
}
