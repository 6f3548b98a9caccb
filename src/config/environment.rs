//! Decides which environment variables are settings, and what happens to variables that only look like settings.
//! `layers` reads the values.
//!
//! ```text
//!   HALLSWEEP__ROBOT__SPEED          a setting; refused if no setting has this name
//!   HALLSWEEP_ROBOT_SPEED            surely meant as a setting: refused, with the right name
//!   HALLSWEEP_SERVICE_HOST           unknown: ignored, with a line in the log
//!   HALLSWEEP_REQUIRE_CLIENTS        used by the tests
//! ```

use std::path::PathBuf;

use super::key::{KEYS, Key};

/// Prefix of environment variables that are settings; section and key follow, separated by two underscores.
pub(super) const PREFIX: &str = "HALLSWEEP__";

/// Prefix of all variables that may be meant for this program.
pub(super) const OURS: &str = "HALLSWEEP_";

/// Variables of the program's tests, which may also be set where the program runs.
const OF_THE_TESTS: [&str; 3] = ["HALLSWEEP_KILLS", "HALLSWEEP_REQUIRE_CLIENTS", "HALLSWEEP_UPDATE_DOCS"];

/// The environment variable of a setting, such as `HALLSWEEP__HTTP__BIND`.
pub(super) fn variable(key: &Key) -> String {
    format!("{PREFIX}{}", key.name.replace('.', "__").to_uppercase())
}

pub(super) fn nearly(name: &str) -> Option<&'static Key> {
    let plain = |text: &str| text.replace(['_', '.'], "").to_lowercase();
    let meant = plain(name.strip_prefix(OURS).filter(|_| !name.starts_with(PREFIX))?);
    KEYS.iter().find(|key| plain(key.name) == meant)
}

#[derive(Clone, Debug, Default)]
pub struct Sources {
    pub file: Option<PathBuf>,
    pub environment: Vec<(String, String)>,
    pub flags: Vec<Flag>,
}

#[derive(Clone, Debug)]
pub struct Flag {
    /// The flag, such as `--http`.
    pub flag: &'static str,
    pub key: &'static str,
    pub value: String,
}

impl Sources {
    /// Environment variables that look like ours but are unknown. They do not prevent a start, because other software
    /// sets such variables too. For example, a cluster with a service `hallsweep` sets HALLSWEEP_SERVICE_HOST for
    /// every program in it.
    pub fn ignored(&self) -> Vec<&str> {
        let names = self.environment.iter().map(|(name, _)| name.as_str());
        let ours = names.filter(|name| name.starts_with(OURS) && !name.starts_with(PREFIX));
        ours.filter(|name| !OF_THE_TESTS.contains(name) && nearly(name).is_none()).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_looks_like_ours_and_is_nobodys_is_ignored_aloud() {
        let names = ["HALLSWEEP_SPEED", "HALLSWEEP_REQUIRE_CLIENTS", "HALLSWEEP_UPDATE_DOCS", "HALLSWEEP__ROBOT__SPEED", "PATH"];
        let environment = names.map(|name| (name.to_owned(), "1".to_owned())).into();
        assert_eq!(Sources { environment, ..Sources::default() }.ignored(), ["HALLSWEEP_SPEED"]);
    }

    #[test]
    fn every_setting_is_known_again_with_single_underscores() {
        for key in &KEYS {
            let single = variable(key).replace("__", "_");
            assert_eq!(nearly(&single), Some(key), "{single}");
            assert_eq!(nearly(&variable(key)), None, "that is the setting itself");
        }
    }
}
