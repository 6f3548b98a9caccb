//! Installed programs by other authors: their location, how they run, and the message if one is missing. The choice
//! of the programs and their requests are elsewhere.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::thread::sleep;
use std::time::Duration;

use crate::program::Deadline;

/// Time limit of a client, in seconds. Without it a client may wait for minutes for a server that is gone.
pub(crate) const PATIENCE_S: &str = "120";

/// Time after which a client that ignores the request to end is killed, in seconds.
const GRACE_S: &str = "10";

/// Longest time for the end of a client that was told to end, and the interval between two checks.
const PATIENCE: Duration = Duration::from_secs(60);
const GLANCE: Duration = Duration::from_millis(5);

/// Reports that a test of an interface is skipped and why. Fails instead if `HALLSWEEP_REQUIRE_CLIENTS=1`.
pub(crate) fn left_out(door: &str, missing: &str) -> bool {
    let required = std::env::var("HALLSWEEP_REQUIRE_CLIENTS").is_ok_and(|value| value == "1");
    assert!(!required, "the tests of the {door} door need {missing}");
    // Written to standard error directly, because the test harness would capture a print.
    writeln!(std::io::stderr(), "a test of the {door} door is left out: it needs {missing}").expect("standard error is open");
    false
}

/// Whether the command can be run and succeeds.
pub(crate) fn runs(command: &mut Command) -> bool {
    let run = patiently(command).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status();
    run.is_ok_and(|status| status.success())
}

/// The same command with a time limit of `PATIENCE_S`.
pub(crate) fn patiently(command: &Command) -> Command {
    within(PATIENCE_S, command)
}

/// The same command with this time limit, in seconds.
pub(crate) fn within(seconds: &str, command: &Command) -> Command {
    let mut timeout = Command::new("timeout");
    timeout.args(["-k", GRACE_S, seconds]).arg(command.get_program()).args(command.get_args());
    timeout.envs(command.get_envs().filter_map(|(name, value)| Some((name, value?))));
    timeout
}

/// Whether the time limit ended the command.
pub(crate) fn was_ended(status: ExitStatus) -> bool {
    // 124 is from `timeout` itself. After SIGKILL the status is 137, or there is no code.
    matches!(status.code(), Some(124 | 137) | None)
}

/// Waits until a client that was told to end has ended. Otherwise kills it and returns `None`.
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

/// Folder with the lists of clients, the installed clients, and the scripts that use their libraries.
pub(crate) fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/clients")
}

/// Python with the libraries of the list.
pub(crate) fn python() -> Command {
    let mut python = Command::new("python3");
    // `-W ignore` hides the warnings of a library. `PYTHONUNBUFFERED` makes the output readable while the script
    // runs.
    python.args(["-W", "ignore"]).env("PYTHONPATH", folder().join("python_modules")).env("PYTHONUNBUFFERED", "1");
    python
}
