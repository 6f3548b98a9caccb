//! Errors of keys, key names and the key file. `Display` is the message for the person who runs the program.

use std::path::PathBuf;

use hallsweep_core::hall::HallId;

#[derive(Debug, thiserror::Error)]
pub enum AccessError {
    #[error("the system gives no random numbers, so no key can be made: {0}")]
    Chance(String),
    #[error("the keys cannot be read from {}: {error}; let the user who runs hallsweep read this file", .path.display())]
    Unreadable { path: PathBuf, error: std::io::Error },
    /// Users other than the owner can read or write the file, so the keys are possibly known.
    #[error(
        "other users can read or write the keys in {} (mode {mode:03o}): make the file private with `chmod 600`, then replace \
         each key with `hallsweep token rotate NAME`", .path.display()
    )]
    Exposed {
        path: PathBuf,
        /// Mode of the file, as in `chmod`.
        mode: u32,
    },
    #[error("the key file {} is not valid: {problem}; correct the file, or move it away so that hallsweep makes a new one", .path.display())]
    Malformed { path: PathBuf, problem: String },
    #[error(
        "the keys cannot be written to {}: {error}; let the user who runs hallsweep write to that folder, or name another folder \
         with --data DIR", .path.display()
    )]
    Unwritable { path: PathBuf, error: std::io::Error },
    #[error("{0:?} cannot be the name of a key: use 1 to 32 letters, digits, - and _")]
    Name(String),
    #[error("{0:?} cannot be the name of a hall: use 1 to 32 small letters, digits and -, the first a letter")]
    Hall(String),
    #[error("the hall `{0}` is named twice: name each hall once")]
    HallTwice(HallId),
    #[error("a key is limited to 1 to {0} halls: name the halls, or leave out --halls to make a key for all halls")]
    HallCount(usize),
    #[error("the key `{0}` exists already: `hallsweep token rotate {0}` gives it a new token")]
    Taken(String),
    #[error("there is no key `{name}`; the existing keys are {}", .there.join(", "))]
    Unknown { name: String, there: Vec<String> },
    /// This key cannot be removed, because without it nobody could command the robot.
    #[error("`{0}` is the last operator's key: add another with `hallsweep token add NAME --role operator` first")]
    LastOperator(String),
    /// This key cannot be removed, because without it nobody could command the robots of every hall.
    #[error(
        "`{0}` is the last operator's key for all halls: add another with `hallsweep token add NAME --role operator`, without \
         --halls, first"
    )]
    LastOfAllHalls(String),
    #[error("there are {0} keys, which is the maximum: remove a key first")]
    TooMany(usize),
}
