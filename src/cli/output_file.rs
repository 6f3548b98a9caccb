//! A file for a result that takes long to compute. The file is first opened under a temporary name, so that an
//! unwritable place fails at once. When the result is complete, the file is flushed and renamed. Until then the old
//! file stays, whatever happens.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::Failure;
use super::map_file::{begin, unfinished, unwritable};
use crate::storage::files;

pub(super) const STANDARD_OUTPUT: &str = "-";

pub(super) struct OutputFile {
    path: PathBuf,
    to: To,
}

enum To {
    StandardOutput,
    /// Written to directly and never replaced: a pipe or a terminal, for example.
    Through(File),
    /// The file under its temporary name, until it is renamed.
    Beside(File, Option<PathBuf>),
}

impl OutputFile {
    pub(super) fn open(path: &Path) -> Result<OutputFile, Failure> {
        // A symbolic link stays, and its target is replaced.
        let place = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let to = if is_standard_output(path) { Ok(To::StandardOutput) } else { open(&place) };
        to.map(|to| OutputFile { path: place, to }).map_err(|error| unwritable(path, &error))
    }

    pub(super) fn fill(mut self, write: impl FnOnce(&mut dyn Write) -> Result<(), Failure>) -> Result<(), Failure> {
        match &mut self.to {
            To::StandardOutput => write(&mut io::stdout().lock()),
            To::Through(file) => write(file),
            To::Beside(file, beside) => {
                write(file)?;
                let flushed = file.sync_all();
                flushed.and_then(|()| place(beside, &self.path)).map_err(|error| unwritable(&self.path, &error))
            }
        }
    }
}

impl Drop for OutputFile {
    fn drop(&mut self) {
        if let To::Beside(_, Some(beside)) = &self.to {
            // A failure cannot be reported any more.
            let _removed = fs::remove_file(beside);
        }
    }
}

pub(super) fn is_standard_output(path: &Path) -> bool {
    path.as_os_str() == STANDARD_OUTPUT
}

fn open(place: &Path) -> io::Result<To> {
    let there = fs::metadata(place).ok();
    if there.is_some() {
        // If the existing file may not be written, it may not be replaced either.
        let through = OpenOptions::new().append(true).open(place)?;
        if !place.is_file() {
            return Ok(To::Through(through));
        }
    }
    let beside = unfinished(place);
    let file = begin(&beside)?;
    if let Some(there) = there {
        file.set_permissions(there.permissions()).inspect_err(|_| drop(fs::remove_file(&beside)))?;
    }
    Ok(To::Beside(file, Some(beside)))
}

fn place(beside: &mut Option<PathBuf>, place: &Path) -> io::Result<()> {
    if let Some(whole) = beside {
        fs::rename(whole, place)?;
        *beside = None;
    }
    files::sync_folder(place.parent().unwrap_or(Path::new(".")))
}

/// Refuses a file that is given twice: as input and as output, or twice as output.
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
            return Err(Failure::Usage(format!("the file {} is given twice: give another file", path.display())));
        }
        taken.push(place);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::storage::tests::scratch::Scratch;

    fn of_today(out: &mut dyn Write) -> Result<(), Failure> {
        out.write_all(b"of today").map_err(|error| Failure::Run(error.to_string()))
    }

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn what_stands_there_stays_until_the_result_is_whole_and_nothing_else_is_left() {
        let scratch = Scratch::new();
        let (older, fresh) = (scratch.0.join("older"), scratch.0.join("fresh"));
        fs::write(&older, "of yesterday").unwrap();
        for path in [&older, &fresh] {
            let failed = OutputFile::open(path).unwrap().fill(|out| {
                out.write_all(b"half").unwrap();
                Err(Failure::Run("a mouse was at it".to_owned()))
            });
            assert_eq!(failed.unwrap_err().to_string(), "a mouse was at it");
        }
        drop(OutputFile::open(&fresh).unwrap());
        assert_eq!(
            (names(&scratch.0), fs::read_to_string(&older).unwrap()),
            (vec!["older".to_owned()], "of yesterday".to_owned())
        );
        for path in [&older, &fresh] {
            OutputFile::open(path).unwrap().fill(of_today).unwrap();
            assert_eq!(fs::read_to_string(path).unwrap(), "of today");
        }
        assert_eq!(names(&scratch.0), ["fresh", "older"]);
    }

    #[test]
    #[cfg(unix)]
    fn a_link_stays_one_and_its_file_as_private_as_it_was() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let scratch = Scratch::new();
        let (file, link) = (scratch.0.join("file"), scratch.0.join("link"));
        fs::write(&file, "of yesterday").unwrap();
        fs::set_permissions(&file, fs::Permissions::from_mode(0o600)).unwrap();
        symlink(&file, &link).unwrap();
        OutputFile::open(&link).unwrap().fill(of_today).unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), "of today");
        assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o600);
    }
}
