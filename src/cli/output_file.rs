//! A file for what takes long to come about: opened before that, so that one that cannot be written shows at once, and left as it is until the
//! result is there.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use super::Failure;

/// Where a result will be written.
pub(super) struct OutputFile {
    path: PathBuf,
    file: File,
}

impl OutputFile {
    /// The file of this name, which is made if it is not there.
    pub(super) fn open(path: &Path) -> Result<OutputFile, Failure> {
        let opened = OpenOptions::new().create(true).append(true).open(path);
        opened.map(|file| OutputFile { path: path.to_owned(), file }).map_err(|error| unwritable(path, &error))
    }

    /// Writes the result in the place of what is there.
    pub(super) fn write(mut self, text: &str) -> Result<(), Failure> {
        // A pipe or a terminal has nothing to be replaced.
        let emptied = self.file.metadata().and_then(|about| if about.is_file() { self.file.set_len(0) } else { Ok(()) });
        emptied.and_then(|()| self.file.write_all(text.as_bytes())).map_err(|error| unwritable(&self.path, &error))
    }
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Run(format!("{} cannot be written: {error}", path.display()))
}
