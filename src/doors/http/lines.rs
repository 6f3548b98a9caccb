//! Limits the number of log lines about strangers. A sender without a key must not be able to fill the log. The
//! caller decides what a line says.

use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// Maximum number of lines in one `SPAN`. It is enough to see who tries what.
const MOST: u32 = 20;

const SPAN: Duration = Duration::from_secs(60);

#[derive(Debug, Default)]
pub(super) struct Lines(Mutex<Late>);

#[derive(Debug, Default)]
struct Late {
    since: Duration,
    written: u32,
    left_out: u64,
}

impl Lines {
    /// Writes a line, unless `MOST` lines were already written in the present `SPAN`. `now` is the time since this
    /// door was created. If lines were omitted, their number is logged before the next line.
    pub(super) fn write(&self, now: Duration, write: impl FnOnce()) {
        let left_out = {
            let mut late = self.0.lock().unwrap_or_else(PoisonError::into_inner);
            if now.saturating_sub(late.since) >= SPAN {
                *late = Late { since: now, written: 0, left_out: late.left_out };
            }
            if late.written == MOST {
                late.left_out += 1;
                return;
            }
            late.written += 1;
            std::mem::take(&mut late.left_out)
        };
        if left_out > 0 {
            tracing::warn!(left_out, "further refused requests are not in the log");
        }
        write();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety A5: the number of log lines about strangers is limited.
    #[test]
    fn a_flood_of_strangers_writes_so_many_lines_a_minute() {
        let (lines, mut written) = (Lines::default(), 0);
        for ms in 0..180_000 {
            lines.write(Duration::from_millis(ms), || written += 1);
        }
        assert_eq!(written, 3 * MOST);
        let late = lines.0.lock().unwrap();
        assert_eq!(late.left_out, 60_000 - u64::from(MOST), "those of the last minute are still to be told");
    }
}
