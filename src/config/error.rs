//! What is said about a wrong setting: which, what it was, where it came from, and what to do. Always one line a problem.

use std::path::PathBuf;

/// A setting with which the program does not start. `Display` is the message for whoever starts it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingsError {
    #[error("there is no setting `{key}` (from {origin}): {advice}")]
    Unknown {
        /// The name that was given, as `http.bnid`.
        key: String,
        origin: String,
        advice: String,
    },
    #[error("setting {key} = {value} (from {origin}): {problem}; {advice}")]
    Wrong {
        /// The setting, as `http.bind`.
        key: String,
        /// Its value, as it would be written in a settings file.
        value: String,
        /// The file, environment variable or flag it came from.
        origin: String,
        problem: String,
        advice: String,
    },
    #[error("settings file {} (from --config): {problem}; mend it, or start without --config", .path.display())]
    File { path: PathBuf, problem: String },
}
