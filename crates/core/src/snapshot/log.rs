//! The latest numbered lines about what happened. The log keeps a limited number of lines; the journal stores
//! everything.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::snapshot::said::Said;
use crate::units::{Seq, WallTime};

/// Maximum number of lines in the log. Older lines are in the journal.
pub const LOG_LINES: usize = 256;

#[derive(Clone, Debug, PartialEq)]
pub struct LogLine {
    /// The number of the line, counted from 1 without gaps.
    pub number: u64,
    pub wall: WallTime,
    pub tone: Tone,
    pub said: Said,
}

named! {
    ALL by name;
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum Tone {
        /// The line is shown only after it is recorded. Lines of the other tones are shown at once (safety R4).
        Info = "info",
        /// Something was refused or is held.
        Warning = "warning",
        Alarm = "alarm",
    }
}

/// The latest lines, oldest first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Log {
    lines: VecDeque<Arc<LogLine>>,
    written: u64,
    /// Lines that wait until their journal entry is stored, oldest first. Each has the number of that entry, if it is
    /// known.
    waiting: VecDeque<WaitingLine>,
}

#[derive(Clone, Debug)]
struct WaitingLine {
    seq: Option<Seq>,
    wall: WallTime,
    said: Said,
}

impl Log {
    /// Adds a line. A line of tone `Info` waits for its record; any other line is shown at once. Returns whether the
    /// line is shown. When too many lines wait, the oldest one is dropped; the journal still has it.
    pub(crate) fn write(&mut self, wall: WallTime, tone: Tone, said: Said) -> bool {
        if tone != Tone::Info {
            self.put(wall, tone, said);
            return true;
        }
        if self.waiting.len() == LOG_LINES {
            self.waiting.pop_front();
        }
        self.waiting.push_back(WaitingLine { seq: None, wall, said });
        false
    }

    /// Shows the lines whose entry is stored. Returns true if there are any. Lines added since the last call wait for
    /// the entry `written`.
    pub(crate) fn show(&mut self, written: Seq, kept: Seq) -> bool {
        for line in self.waiting.iter_mut().rev().take_while(|line| line.seq.is_none()) {
            line.seq = Some(written);
        }
        let due = self.waiting.iter().take_while(|line| line.seq.is_some_and(|seq| seq <= kept)).count();
        for WaitingLine { wall, said, .. } in self.waiting.drain(..due).collect::<Vec<_>>() {
            self.put(wall, Tone::Info, said);
        }
        due > 0
    }

    /// Handles the loss of entries. Lines that waited for a lost entry now wait for the next entry.
    pub(crate) fn lose(&mut self) {
        self.waiting.iter_mut().for_each(|line| line.seq = None);
    }

    /// Shows a line at once, without waiting for its record.
    pub(crate) fn put(&mut self, wall: WallTime, tone: Tone, said: Said) {
        self.written += 1;
        if self.lines.len() == LOG_LINES {
            self.lines.pop_front();
        }
        self.lines.push_back(Arc::new(LogLine { number: self.written, wall, tone, said }));
    }

    pub(crate) fn lines(&self) -> Arc<[Arc<LogLine>]> {
        self.lines.iter().cloned().collect()
    }
}
