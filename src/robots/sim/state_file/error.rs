//! Why the memory of a simulated robot cannot be used, with the file and what to do. Nothing is repaired: a file that cannot be
//! read stays as it is.

use std::path::PathBuf;

#[derive(Debug, thiserror::Error)]
pub(crate) enum StateFileError {
    #[error(
        "cannot read {} ({error}): make it a file that whoever runs hallsweep can read, or move it away, and start again: \
         without it what is simulated begins anew where a mission begins",
        .path.display()
    )]
    Unreadable { path: PathBuf, error: std::io::Error },
    #[error(
        "{} is damaged: {fault}; move it away and start again: what is simulated then begins anew where a mission begins, and \
         what is on record stays",
        .path.display()
    )]
    Damaged { path: PathBuf, fault: String },
    #[error(
        "{} was written in version {found} of its format, this hallsweep knows version 1: start the hallsweep that wrote \
         it, or move the file away and what is simulated begins anew where a mission begins",
        .path.display()
    )]
    OtherVersion { path: PathBuf, found: String },
    /// The memory is of a robot in another hall, or in the same hall before its file was changed.
    #[error("{} {}", .path.display(), other_hall(.remembered, .given))]
    OtherHall { path: PathBuf, remembered: String, given: String },
}

fn other_hall(remembered: &str, given: &str) -> String {
    if remembered == given {
        return format!(
            "is of the hall {given} as it was before its file was changed: change it back, or give the changed hall a folder \
             of its own with --data DIR"
        );
    }
    format!(
        "is of the hall {remembered}, not of {given}: start with --hall {remembered}, or give this hall a folder of its own \
         with --data DIR"
    )
}
