//! The lines of the log as they are written: each once, in order. The snapshot holds the latest only; when more were written
//! while nobody could be told, the numbers of the lines show the gap.

use std::time::Duration;

use crate::api::log::LogLineJson;
use crate::api::resources::{Form, shape};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::snapshot::log::LogLine;

/// Which lines were said.
#[derive(Default)]
pub(super) struct Events {
    /// The number of the last one.
    said: u64,
}

impl Events {
    /// At once, when there is a line that was not said.
    pub(super) fn due(&self, snapshot: &Snapshot) -> Option<Duration> {
        self.next(snapshot).map(|_| Duration::ZERO)
    }

    /// The next line, in JSON.
    pub(super) fn take(&mut self, snapshot: &Snapshot) -> Option<Vec<u8>> {
        let line = self.next(snapshot)?;
        self.said = line.number;
        Some(shape(Form::Json, &LogLineJson::from(line)))
    }

    fn next<'a>(&self, snapshot: &'a Snapshot) -> Option<&'a LogLine> {
        let first = snapshot.log.partition_point(|line| line.number <= self.said);
        snapshot.log.get(first).map(|line| &**line)
    }
}
