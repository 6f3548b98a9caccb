//! Messages about a wrong setting: which one, its value, where it came from, and what to do. One line for each problem.

use std::path::PathBuf;

/// A setting with which the program does not start. `Display` is the message for whoever starts the program.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingsError {
    #[error("there is no setting `{key}` (from {origin}): {advice}")]
    Unknown {
        /// The wrong name, such as `http.bnid`.
        key: String,
        origin: String,
        advice: String,
    },
    #[error("setting {key} = {value} (from {origin}): {problem}; {advice}")]
    Wrong {
        key: String,
        /// Value of the setting, as written in a settings file.
        value: String,
        origin: String,
        problem: String,
        advice: String,
    },
    #[error("settings file {} (from --config): {problem}; correct the file, or start without --config", .path.display())]
    File { path: PathBuf, problem: String },
}
