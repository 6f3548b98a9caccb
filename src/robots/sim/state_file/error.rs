//! Why the stored memory of a simulated robot cannot be used. Each message names the file and says what to do.
//! Nothing is repaired: a file that cannot be read stays as it is.

use std::path::PathBuf;

#[derive(Debug, thiserror::Error)]
pub(crate) enum StateFileError {
    #[error(
        "cannot read the file {} ({error}): let the user who runs hallsweep read the file, or move it away, then start hallsweep \
         again: without the file the simulation begins where a mission begins",
        .path.display()
    )]
    Unreadable { path: PathBuf, error: std::io::Error },
    #[error(
        "the file {} is damaged: {fault}; move it away and start hallsweep again: the simulation then begins where a mission \
         begins, and the journal stays",
        .path.display()
    )]
    Damaged { path: PathBuf, fault: String },
    #[error(
        "the file {} has version {found} of its format, but this hallsweep knows version 1: start the hallsweep that wrote the \
         file, or move the file away, and the simulation begins where a mission begins",
        .path.display()
    )]
    OtherVersion { path: PathBuf, found: String },
    /// The memory belongs to another hall, or to this hall before its hall file was changed.
    #[error("{} {}", .path.display(), other_hall(.remembered, .given))]
    OtherHall { path: PathBuf, remembered: String, given: String },
}

fn other_hall(remembered: &str, given: &str) -> String {
    if remembered == given {
        return format!(
            "belongs to the hall {given} before its file was changed: undo the change, or choose another folder for the changed \
             hall with --data DIR"
        );
    }
    format!(
        "belongs to the hall {remembered}, not to {given}: start with --hall {remembered}, or choose another folder for {given} \
         with --data DIR"
    )
}
