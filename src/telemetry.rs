//! Log lines on standard error, filtered by the setting `log.filter`. Messages that an operator must see are in
//! another log instead: it is part of the state, and the console shows it.

use std::backtrace::{Backtrace, BacktraceStatus};
use std::fmt;
use std::io::{self, IsTerminal, Write};
use std::panic;
use std::sync::{Arc, OnceLock};
use std::time::Duration;

use nix::sys::signal::{SigSet, Signal};
use tracing_subscriber::EnvFilter;
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::time::FormatTime;

use crate::api::time::rfc3339;
use crate::runtime::clock::Clock;
use queue::Queue;

mod queue;

const RUMQTTD: &str = "rumqttd";

/// Prefix of the names of the MQTT router's threads; a number follows.
const ROUTER: &str = "router-";

/// Maximum wait at the end of the program for lines that are not written yet.
const LAST_LINES: Duration = Duration::from_secs(1);

/// The queue for standard error, in a program that must not wait for standard error. Without a queue, lines are
/// written at once.
static QUEUE: OnceLock<Arc<Queue>> = OnceLock::new();

/// Queues lines from now on. So no thread waits for standard error or panics because a write fails, and no write
/// stops or ends the program (safety S11). For programs that run until they are ended.
pub fn queue_lines() {
    // Two signals could stop or end the program. The system sends SIGTTOU to a background program that writes to a
    // terminal under `tostop`, and SIGXFSZ to a program that exceeds the limit for the size of a file. Both signals
    // are blocked in all threads that start from here on. In these threads the write succeeds or fails instead.
    let _ = SigSet::from_iter([Signal::SIGTTOU, Signal::SIGXFSZ]).thread_block();
    // If the system cannot start this thread, it cannot start the threads of the doors either, and the start fails
    // there.
    let Ok(queue) = Queue::start(io::stderr()) else { return };
    if QUEUE.set(queue).is_ok() {
        panic::set_hook(Box::new(note_panic));
    }
}

/// Writes a line to standard error, after the waiting lines of the log.
pub fn say(line: impl fmt::Display) {
    put(format!("{line}\n").as_bytes());
}

pub fn end() {
    if let Some(queue) = QUEUE.get() {
        queue.end(LAST_LINES);
    }
}

fn put(text: &[u8]) {
    match QUEUE.get() {
        Some(queue) => queue.put(text),
        // A failure cannot be reported any more.
        None => drop(io::stderr().write_all(text)),
    }
}

/// The writer for the lines of the log. It never returns an error. The formatter would report an error on standard
/// error itself, and panic.
struct Lines;

impl Write for Lines {
    fn write(&mut self, text: &[u8]) -> io::Result<usize> {
        put(text);
        Ok(text.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// Starts writing log lines that pass `filter`, which `crate::config` has checked. A second call changes nothing.
pub fn start(filter: &str) {
    let filter = EnvFilter::builder().parse_lossy(without_router(filter));
    let coloured = io::stderr().is_terminal();
    let lines = tracing_subscriber::fmt().compact().with_env_filter(filter).with_ansi(coloured).with_writer(|| Lines);
    let lines = lines.with_timer(WallClock(Clock::default()));
    if lines.try_init().is_err() {
        tracing::debug!("log lines were being written already");
    }
}

/// The time of day, in the same format as in the rest of the program. The zone is that of this machine, or the zone
/// that `TZ` sets.
struct WallClock(Clock);

impl FormatTime for WallClock {
    fn format_time(&self, line: &mut Writer<'_>) -> fmt::Result {
        line.write_str(&rfc3339(self.0.now().wall))
    }
}

/// Logs a panic of a thread. The standard library's hook is not used: it writes to standard error directly, and may
/// block there. The thread of the MQTT router always ends in a panic, which becomes a line of the log, like its
/// restart.
fn note_panic(panicked: &panic::PanicHookInfo<'_>) {
    let thread = std::thread::current();
    let name = thread.name().unwrap_or("<unnamed>");
    if name.starts_with(ROUTER) {
        tracing::debug!(%panicked, "the thread of the MQTT router has ended");
        return;
    }
    say(format_args!("thread '{name}' {panicked}"));
    // The backtrace is captured only if `RUST_BACKTRACE` is set.
    let backtrace = Backtrace::capture();
    if backtrace.status() == BacktraceStatus::Captured {
        say(backtrace);
    }
}

/// The filter without the lines of the MQTT router, unless the filter names them. These lines name connections by the
/// router's own numbers, and cost time with every message. The gate of our own broker logs the important events.
fn without_router(filter: &str) -> String {
    if filter.contains(RUMQTTD) { filter.to_owned() } else { format!("{filter},{RUMQTTD}=off") }
}

/// Warns of unknown variables. It is only a warning, since other software sets such variables too: see
/// `Sources::ignored`.
pub fn warn_of_ignored(variables: &[&str]) {
    for variable in variables {
        tracing::warn!(variable, "this environment variable is not a setting: write settings as HALLSWEEP__SECTION__KEY");
    }
}

/// Warns that standard output did not accept the announcement. The text is not repeated, because it may contain a key.
pub fn warn_of_unannounced(error: &dyn fmt::Display) {
    tracing::warn!(%error, "the addresses and the sign-in link could not be printed; `hallsweep token` shows the stored keys");
}

pub fn warn_of_idle(settings: &str) {
    tracing::warn!(settings, "these settings have no effect on the configured robots");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mqtt_router_is_silent_unless_it_is_asked_for() {
        assert_eq!(without_router("info"), "info,rumqttd=off");
        assert_eq!(without_router("info,rumqttd=warn"), "info,rumqttd=warn");
        assert!(EnvFilter::builder().parse(without_router("warn,hallsweep=debug")).is_ok());
    }

    /// Environment variable that is set only for the child process of the test.
    const CHILD: &str = "HALLSWEEP_PANICKING_CHILD";

    #[test]
    fn panics_and_ends() {
        if std::env::var_os(CHILD).is_none() {
            return;
        }
        queue_lines();
        let panicking = std::thread::Builder::new().name("unlucky".to_owned()).spawn(|| panic!("the roof is on fire"));
        assert!(panicking.unwrap().join().is_err());
        end();
    }

    /// Safety S11. The hook belongs to a whole process, so this test starts its own program as a child process.
    #[cfg(unix)]
    #[test]
    fn a_panic_is_said_without_waiting_for_whoever_reads() {
        use rustix::fs::{OFlags, fcntl_setfl};
        use std::io::Read;
        use std::process::{Command, Stdio};
        for is_full in [false, true] {
            let (mut reader, mut writer) = io::pipe().unwrap();
            if is_full {
                fcntl_setfl(&writer, OFlags::NONBLOCK).unwrap();
                while writer.write(b".").is_ok() {}
                fcntl_setfl(&writer, OFlags::empty()).unwrap();
            }
            let ended = Command::new(std::env::current_exe().unwrap())
                .args(["--exact", "telemetry::tests::panics_and_ends", "--nocapture"])
                .env(CHILD, "1")
                .env_remove("RUST_BACKTRACE")
                .stdout(Stdio::null())
                .stderr(writer)
                .status();
            assert!(ended.unwrap().success());
            let mut said = String::new();
            reader.read_to_string(&mut said).unwrap();
            let told = said.trim_start_matches('.');
            let expect = "thread 'unlucky' panicked at src/telemetry.rs:";
            assert!(is_full || (told.starts_with(expect) && told.ends_with(":\nthe roof is on fire\n")), "{told}");
        }
    }
}
