//! Log lines on standard error, as many as the setting `log.filter` asks for.
//! What an operator must see is not here: that is the log of the state, which the console shows.

use std::io::IsTerminal;

use tracing_subscriber::EnvFilter;

/// Starts writing log lines that pass `filter`, which `crate::config` has checked. A second call changes nothing.
pub fn start(filter: &str) {
    let filter = EnvFilter::builder().parse_lossy(filter);
    let coloured = std::io::stderr().is_terminal();
    let lines = tracing_subscriber::fmt().compact().with_env_filter(filter).with_ansi(coloured).with_writer(std::io::stderr);
    if lines.try_init().is_err() {
        tracing::debug!("log lines were being written already");
    }
}

/// Warns of environment variables that look like settings and are none.
pub fn warn_of_ignored(variables: &[&str]) {
    for variable in variables {
        tracing::warn!(variable, "this environment variable is no setting: settings are written HALLSWEEP__SECTION__KEY");
    }
}
