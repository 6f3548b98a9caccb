//! An output file for a result that takes long to compute. The file is opened before the work, so that a path that
//! cannot be written is reported at once. When the result is complete and flushed to disk, it replaces an older file.
//! If anything fails before that, the older file is unchanged.

use std::fs::{self, File, OpenOptions, Permissions};
use std::io::{self, Write};
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

use super::Failure;

pub(crate) struct OutputFile {
    path: PathBuf,
    to: To,
}

enum To {
    StandardOutput,
    /// A pipe or a terminal, to which the text is written directly.
    Through(File),
    /// A temporary file in the folder of the result. At the end, it is renamed to the result's name.
    Beside(NamedTempFile),
}

impl OutputFile {
    /// Checks that the path can be written. An older file stays unchanged until `write`.
    pub(crate) fn open(path: &Path) -> Result<OutputFile, Failure> {
        // If the path is a link, the file that it leads to is replaced, not the link.
        let place = path.canonicalize().unwrap_or_else(|_| path.to_owned());
        let to = if is_standard_output(path) { Ok(To::StandardOutput) } else { open(&place) };
        to.map(|to| OutputFile { path: place, to }).map_err(|error| unwritable(path, &error))
    }

    /// Writes the text. File and folder are also flushed to disk, so that the result survives a crash.
    pub(crate) fn write(self, text: &str) -> Result<(), Failure> {
        let written = match self.to {
            To::StandardOutput => io::stdout().write_all(text.as_bytes()),
            To::Through(mut file) => file.write_all(text.as_bytes()),
            To::Beside(file) => replace(file, &self.path, text),
        };
        written.map_err(|error| unwritable(&self.path, &error))
    }
}

fn open(place: &Path) -> io::Result<To> {
    let there = fs::metadata(place).ok();
    if there.is_some() {
        // A file without write permission is not replaced, although renaming could do it.
        let through = OpenOptions::new().append(true).open(place)?;
        if !place.is_file() {
            return Ok(To::Through(through));
        }
    }
    let usual = Permissions::from_mode(0o666);
    let file = tempfile::Builder::new().permissions(usual).tempfile_in(folder(place))?;
    if let Some(there) = there {
        file.as_file().set_permissions(there.permissions())?;
    }
    Ok(To::Beside(file))
}

fn replace(mut file: NamedTempFile, place: &Path, text: &str) -> io::Result<()> {
    file.write_all(text.as_bytes())?;
    file.as_file().sync_all()?;
    file.persist(place)?;
    File::open(folder(place))?.sync_all()
}

fn folder(place: &Path) -> &Path {
    place.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."))
}

pub(crate) fn is_standard_output(path: &Path) -> bool {
    path.as_os_str() == "-"
}

/// Checks that no file is written twice, and that no file is both read and written.
pub(crate) fn distinct<'a>(
    read: impl IntoIterator<Item = &'a Path>,
    written: impl IntoIterator<Item = &'a Path>,
) -> Result<(), Failure> {
    let place = |path: &Path| path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let mut taken: Vec<PathBuf> = read.into_iter().map(place).collect();
    for path in written {
        let place = place(path);
        // Pipes and terminals may be given twice.
        if taken.contains(&place) && (place.is_file() || !place.exists()) {
            return Err(Failure::Usage(format!("the file {} is given twice: give another file", path.display())));
        }
        taken.push(place);
    }
    Ok(())
}

pub(crate) fn unwritable(path: &Path, error: &io::Error) -> Failure {
    Failure::Run(format!("{} cannot be written: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::os::unix::fs::symlink;

    #[test]
    fn a_result_that_does_not_come_leaves_the_older_file_and_nothing_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let older = folder.path().join("older");
        fs::write(&older, "of yesterday").unwrap();
        for name in ["older", "fresh"] {
            drop(OutputFile::open(&folder.path().join(name)).unwrap());
        }
        let left: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        assert_eq!((left, fs::read_to_string(&older).unwrap()), (vec!["older".into()], "of yesterday".to_owned()));
    }

    #[test]
    fn a_link_stays_one_and_its_file_as_private_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let (file, link) = (folder.path().join("file"), folder.path().join("link"));
        fs::write(&file, "of yesterday").unwrap();
        fs::set_permissions(&file, Permissions::from_mode(0o600)).unwrap();
        symlink(&file, &link).unwrap();
        OutputFile::open(&link).unwrap().write("of today").unwrap();
        assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&file).unwrap(), "of today");
        assert_eq!(fs::metadata(&file).unwrap().permissions().mode() & 0o777, 0o600);
    }
}
