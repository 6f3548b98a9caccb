//! What can be wrong with keys, their names and their file. `Display` is the sentence for whoever runs the program.

use std::path::PathBuf;

/// Why keys cannot be had, kept or changed.
#[derive(Debug, thiserror::Error)]
pub enum AccessError {
    /// The system gives no random numbers.
    #[error("the system gives no random numbers, so no key can be made: {0}")]
    Chance(String),
    /// The file cannot be read.
    #[error("the keys cannot be read from {}: {error}; make it a file that the user who runs hallsweep can read", .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// Others than its owner can read or write the file, and may know the keys.
    #[error(
        "the keys in {} can be read or written by others (mode {mode:03o}): make it private with `chmod 600`, \
         then replace each key with `hallsweep token rotate NAME`", .path.display()
    )]
    Exposed {
        /// The file.
        path: PathBuf,
        /// Its mode, as in `chmod`.
        mode: u32,
    },
    /// The file holds something else than keys.
    #[error("{} does not hold keys: {problem}; mend it, or move it away and let hallsweep make a new one", .path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What is wrong, with the line where there is one.
        problem: String,
    },
    /// The file cannot be written.
    #[error("the keys cannot be kept in {}: {error}; name a folder that can be written with --data DIR", .path.display())]
    Unwritable {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// A name that no key can have.
    #[error("{0:?} cannot be the name of a key: take 1 to 32 letters, digits, - and _")]
    Name(String),
    /// There is a key of this name already.
    #[error("there is a key `{0}` already: `hallsweep token rotate {0}` gives it a new token")]
    Taken(String),
    /// No key has this name.
    #[error("there is no key `{name}`: there are {}", .there.join(", "))]
    Unknown {
        /// The name that was given.
        name: String,
        /// The names there are.
        there: Vec<String>,
    },
    /// Without it nobody could command the robot.
    #[error("`{0}` is the last operator's key: add another with `hallsweep token add NAME --role operator` first")]
    LastOperator(String),
    /// As many keys as there may be.
    #[error("there are {0} keys, and more are not kept: remove one first")]
    TooMany(usize),
}
