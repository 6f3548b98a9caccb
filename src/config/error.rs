//! What is said about a wrong setting: which, what it was, where it came from, and what to do. Always one line a problem.

use std::path::PathBuf;

/// A setting with which the program does not start. `Display` is the message for whoever starts it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingsError {
    /// No setting has this name.
    #[error("there is no setting `{key}` (from {origin}): {advice}")]
    Unknown {
        /// The name that was given, as `http.bnid`.
        key: String,
        /// The file, environment variable or flag it came from.
        origin: String,
        /// What to do.
        advice: String,
    },
    /// The value cannot be used.
    #[error("setting {key} = {value} (from {origin}): {problem}; {advice}")]
    Wrong {
        /// The setting, as `http.bind`.
        key: String,
        /// Its value, as it would be written in a settings file.
        value: String,
        /// The file, environment variable or flag it came from.
        origin: String,
        /// What is wrong with it.
        problem: String,
        /// What to do.
        advice: String,
    },
    /// The settings file cannot be read.
    #[error("settings file {} (from --config): {problem}; mend it, or start without --config", .path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        problem: String,
    },
}
