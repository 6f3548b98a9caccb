//! Log lines on standard error, as many as the setting `log.filter` asks for.
//! What an operator must see is not here: that is the log of the state, which the console shows.

use std::fmt;
use std::io::IsTerminal;
use std::panic;

use tracing_subscriber::EnvFilter;
use tracing_subscriber::fmt::format::Writer;
use tracing_subscriber::fmt::time::FormatTime;

use crate::api::time::rfc3339;
use crate::runtime::clock::Clock;

const RUMQTTD: &str = "rumqttd";

/// How the thread of the MQTT router is called, before its number.
const ROUTER: &str = "router-";

/// Starts writing log lines that pass `filter`, which `crate::config` has checked. A second call changes nothing.
pub fn start(filter: &str) {
    let filter = EnvFilter::builder().parse_lossy(without_router(filter));
    let coloured = std::io::stderr().is_terminal();
    let lines = tracing_subscriber::fmt().compact().with_env_filter(filter).with_ansi(coloured).with_writer(std::io::stderr);
    let lines = lines.with_timer(WallClock(Clock::default()));
    if lines.try_init().is_err() {
        tracing::debug!("log lines were being written already");
        return;
    }
    note_panics_of_router();
}

/// The time of day as everything else of this program writes it: in the zone of this machine, or that of `TZ`.
struct WallClock(Clock);

impl FormatTime for WallClock {
    fn format_time(&self, line: &mut Writer<'_>) -> fmt::Result {
        line.write_str(&rfc3339(self.0.now().wall))
    }
}

/// The thread of the MQTT router ends in a panic, and in no other way, whenever it ends: that is a line of the log, as its restart is. Every
/// other panic is told as ever.
fn note_panics_of_router() {
    let told = panic::take_hook();
    panic::set_hook(Box::new(move |panicked| {
        if std::thread::current().name().is_some_and(|name| name.starts_with(ROUTER)) {
            tracing::debug!(%panicked, "the thread of the MQTT router has ended");
        } else {
            told(panicked);
        }
    }));
}

/// The filter without the lines of the MQTT router, unless it asks for them by name: they speak of connections by numbers of its
/// own, and cost time with every message. What of it matters is said by the gate.
fn without_router(filter: &str) -> String {
    if filter.contains(RUMQTTD) { filter.to_owned() } else { format!("{filter},{RUMQTTD}=off") }
}

/// Warns of environment variables that look like settings and are none.
pub fn warn_of_ignored(variables: &[&str]) {
    for variable in variables {
        tracing::warn!(variable, "this environment variable is no setting: settings are written HALLSWEEP__SECTION__KEY");
    }
}

/// Warns of settings that mean nothing for the robots that there are.
pub fn warn_of_idle(settings: &str) {
    tracing::warn!(settings, "these do nothing with the robots of these settings");
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
}
