//! Programs that others wrote and the tests use as they are installed: where they are, how they are run, and what is said where one
//! is absent. Which they are, and what they are asked, is not here.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::program::Deadline;

/// A client waits for minutes for a server that is gone; a test does not.
pub(crate) const PATIENCE_S: &str = "120";

/// Who does not end when it is asked to is killed after so many seconds more.
const GRACE_S: &str = "10";

/// How long a client may take to end when it was told to, and how often that is looked at.
const PATIENCE: Duration = Duration::from_secs(60);
const GLANCE: Duration = Duration::from_millis(5);

/// Says that a test of a door is left out, and why; fails instead when everything must be there.
pub(crate) fn left_out(door: &str, missing: &str) -> bool {
    let required = std::env::var("HALLSWEEP_REQUIRE_CLIENTS").is_ok_and(|value| value == "1");
    assert!(!required, "the tests of the {door} door need {missing}");
    // Written past the test harness, which would keep it to itself.
    writeln!(std::io::stderr(), "a test of the {door} door is left out: it needs {missing}").expect("standard error is open");
    false
}

/// Whether this can be run, and ends well.
pub(crate) fn runs(command: &mut Command) -> bool {
    let run = patiently(command).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    run.is_ok_and(|status| status.success())
}

/// The same command, ended after a while.
pub(crate) fn patiently(command: &Command) -> Command {
    within(PATIENCE_S, command)
}

/// The same command, ended after so many seconds.
pub(crate) fn within(seconds: &str, command: &Command) -> Command {
    let mut timeout = Command::new("timeout");
    timeout.args(["-k", GRACE_S, seconds]).arg(command.get_program()).args(command.get_args());
    timeout.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
    timeout
}

/// Whether a command was ended because its time was over.
pub(crate) fn was_ended(status: ExitStatus) -> bool {
    // By `timeout` itself, or with it by a signal that nobody can ignore.
    matches!(status.code(), Some(124 | 137) | None)
}

/// Waits until a client that was told to end has ended; `None` when it does not, and it is killed.
pub(crate) fn ended(child: &mut Child) -> Option<ExitStatus> {
    let deadline = Deadline::within(PATIENCE);
    loop {
        if let Some(status) = child.try_wait().expect("the child is ours") {
            return Some(status);
        }
        if deadline.has_passed() {
            child.kill().expect("it runs");
            child.wait().expect("nobody outlives that");
            return None;
        }
        sleep(GLANCE);
    }
}

/// Where the lists of clients are, what they name, and the scripts that speak with their libraries.
pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/clients")
}

/// Python with the libraries of the list.
pub(crate) fn python() -> Command {
    let mut python = Command::new("python3");
    // A library warns about itself otherwise; and what is printed is read while it runs.
    python.args(["-W", "ignore"]).env("PYTHONPATH", folder().join("python_modules")).env("PYTHONUNBUFFERED", "1");
    python
}
