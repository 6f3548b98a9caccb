//! Publishes each line of the log once, in order. The snapshot holds only the latest lines. If a line leaves the
//! snapshot before it is published, subscribers see a gap in the line numbers.

use std::time::Duration;

use crate::api::log::LogLineJson;
use crate::api::resources::{Form, shape};
use hallsweep_core::snapshot::Snapshot;
use hallsweep_core::snapshot::log::LogLine;

#[derive(Default)]
pub(super) struct Events {
    said: u64,
}

impl Events {
    pub(super) fn due(&self, snapshot: &Snapshot) -> Option<Duration> {
        self.next(snapshot).map(|_| Duration::ZERO)
    }

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
