//! The latest lines of what happened, numbered, for whoever watches. The journal keeps everything; this keeps what fits a page.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::core::units::Wall;

/// How many lines are at hand: as many as a person scrolls through; older ones are the journal's.
pub const LOG_LINES: usize = 256;

/// One line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LogLine {
    /// Its number, from 1 without gaps.
    pub number: u64,
    /// When.
    pub wall: Wall,
    /// How loud.
    pub tone: Tone,
    /// What happened, as a sentence.
    pub text: String,
}

/// How loud a line is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tone {
    /// For the record.
    Info,
    /// Something was refused or is held.
    Warning,
    /// An alarm.
    Alarm,
}

impl Tone {
    /// The word of the doors.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Tone::Info => "info",
            Tone::Warning => "warning",
            Tone::Alarm => "alarm",
        }
    }
}

/// The latest lines, oldest first.
#[derive(Clone, Debug, Default)]
pub struct Log {
    lines: VecDeque<Arc<LogLine>>,
    written: u64,
}

impl Log {
    /// Writes a line; the oldest gives way when there are too many.
    pub fn write(&mut self, wall: Wall, tone: Tone, text: String) {
        self.written += 1;
        if self.lines.len() == LOG_LINES {
            self.lines.pop_front();
        }
        self.lines.push_back(Arc::new(LogLine { number: self.written, wall, tone, text }));
    }

    /// The lines at hand, oldest first.
    #[must_use]
    pub fn lines(&self) -> Arc<[Arc<LogLine>]> {
        self.lines.iter().cloned().collect()
    }
}
