//! A file for what takes long to come about: opened before that, so that one that cannot be written shows at once, and left as it is until the
//! result is there. One that was made for a result that never came is removed.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use super::Failure;

/// Where a result will be written.
pub(super) struct OutputFile {
    path: PathBuf,
    file: File,
    /// Whether it was not there before, and nothing is written yet.
    is_bare: bool,
}

impl OutputFile {
    /// The file of this name, which is made if it is not there.
    pub(super) fn open(path: &Path) -> Result<OutputFile, Failure> {
        let is_bare = !path.exists();
        let opened = OpenOptions::new().create(true).append(true).open(path);
        opened.map(|file| OutputFile { path: path.to_owned(), file, is_bare }).map_err(|error| unwritable(path, &error))
    }

    /// Writes the result in the place of what is there.
    pub(super) fn write(self, text: &str) -> Result<(), Failure> {
        let path = self.path.clone();
        self.fill(|file| file.write_all(text.as_bytes()).map_err(|error| unwritable(&path, &error)))
    }

    /// The same of what is written a part at a time.
    pub(super) fn fill(mut self, write: impl FnOnce(&mut File) -> Result<(), Failure>) -> Result<(), Failure> {
        self.is_bare = false;
        // A pipe or a terminal has nothing to be replaced.
        let emptied = self.file.metadata().and_then(|about| if about.is_file() { self.file.set_len(0) } else { Ok(()) });
        emptied.map_err(|error| unwritable(&self.path, &error))?;
        write(&mut self.file)
    }
}

/// Refuses to write into a file that is read, or written twice.
pub(super) fn distinct<'a>(
    read: impl IntoIterator<Item = &'a Path>,
    written: impl IntoIterator<Item = &'a Path>,
) -> Result<(), Failure> {
    let place = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let mut taken: Vec<PathBuf> = read.into_iter().map(place).collect();
    for path in written {
        let place = place(path);
        // Pipes and terminals may be named twice.
        if taken.contains(&place) && (place.is_file() || !place.exists()) {
            return Err(Failure::Usage(format!("{} is named for something else already: name another file", path.display())));
        }
        taken.push(place);
    }
    Ok(())
}

impl Drop for OutputFile {
    fn drop(&mut self) {
        if self.is_bare {
            // Nobody is left to be told.
            let _removed = std::fs::remove_file(&self.path);
        }
    }
}

/// What is said of a place that cannot be written.
pub(super) fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Run(format!("{} cannot be written: {error}", path.display()))
}
