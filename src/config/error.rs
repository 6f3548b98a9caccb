//! Messages about a wrong setting. Each is one line with the name of the setting, its value, the origin of the
//! value, and what to do.

use std::path::PathBuf;

/// A wrong setting, with which the program does not start. `Display` is the message for the person who starts the
/// program.
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
