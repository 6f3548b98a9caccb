//! Writes a hall or an explored map to a file. The extension of the file decides the format. The file is written
//! completely or not at all, and an existing file is replaced only if the user allows it. The formats are in
//! `hallsweep_sim`.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::Failure;
use hallsweep_sim::{Export, Format};

pub(super) struct MapFile<'a> {
    path: &'a Path,
    format: Format,
    replace: bool,
}

impl<'a> MapFile<'a> {
    /// Checks the path before there is anything to write, as far as this is possible.
    pub(super) fn at(path: &'a str, replace: bool) -> Result<MapFile<'a>, Failure> {
        let path = Path::new(path);
        let format = Format::of_file(path).ok_or_else(|| {
            let known = Format::ALL.map(|format| format!(".{}", format.extension())).join(", ");
            Failure::Usage(format!("the file name {} does not end with a known format: use one of {known}", path.display()))
        })?;
        let file = MapFile { path, format, replace };
        file.paths().iter().try_for_each(|path| file.check(path))?;
        let probe = unfinished(path);
        let probed = begin(&probe).and_then(|_| fs::remove_file(&probe));
        probed.map_err(|error| unwritable(path, &error))?;
        Ok(file)
    }

    /// Writes the file; returns a line that says what was written and what this format cannot store.
    pub(super) fn write(&self, export: &Export) -> Result<String, Failure> {
        let stem = self.path.file_stem().unwrap_or_default().to_string_lossy();
        let written = export.written(self.format, &stem).map_err(|error| Failure::Run(error.to_string()))?;
        let contents: Vec<Vec<u8>> = written.image.into_iter().chain([written.file]).collect();
        let files: Vec<(PathBuf, Vec<u8>)> = self.paths().into_iter().zip(contents).collect();
        put(&files, self.replace).map_err(|(path, error)| {
            if error.kind() == io::ErrorKind::AlreadyExists { taken(&path) } else { unwritable(&path, &error) }
        })?;
        let names: Vec<String> = files.iter().rev().map(|(path, _)| path.display().to_string()).collect();
        let lost =
            if written.lost.is_empty() { "nothing is lost".to_owned() } else { format!("lost: {}", written.lost.join("; ")) };
        Ok(format!("{}: {}; {lost}", names.join(" and "), export.in_words()))
    }

    /// All files to be written. The file of the command line comes last: if this file refers to an image, the image
    /// must exist first.
    fn paths(&self) -> Vec<PathBuf> {
        let image = (self.format == Format::Occupancy).then(|| self.path.with_extension("pgm"));
        image.into_iter().chain([self.path.to_owned()]).collect()
    }

    fn check(&self, path: &Path) -> Result<(), Failure> {
        if path.is_dir() {
            return Err(unwritable(path, &io::Error::other("it is a folder")));
        }
        // A dangling symbolic link counts as an existing file.
        if !self.replace && path.symlink_metadata().is_ok() { Err(taken(path)) } else { Ok(()) }
    }
}

/// Writes all of these files or none. Each file is first written under a temporary name in the same folder.
fn put(files: &[(PathBuf, Vec<u8>)], replace: bool) -> Result<(), (PathBuf, io::Error)> {
    let mut ours = Vec::new();
    let done =
        files.iter().try_for_each(|(path, bytes)| fill(path, bytes, &mut ours).map_err(|error| (path.clone(), error))).and_then(
            |()| files.iter().try_for_each(|(path, _)| place(path, replace, &mut ours).map_err(|error| (path.clone(), error))),
        );
    if done.is_err() {
        for path in ours {
            let _ = fs::remove_file(path);
        }
    }
    done
}

fn fill(path: &Path, bytes: &[u8], ours: &mut Vec<PathBuf>) -> io::Result<()> {
    let fresh = unfinished(path);
    let mut file = begin(&fresh)?;
    ours.push(fresh);
    file.write_all(bytes)?;
    file.sync_all()
}

/// Creates a file under a temporary name, which contains the process id. An existing file of this name was left by a
/// killed process and is removed.
pub(super) fn begin(fresh: &Path) -> io::Result<File> {
    let _ = fs::remove_file(fresh);
    File::create_new(fresh)
}

/// Renames the temporary file to `path`. Unless `replace` is set, the name is reserved first, so that no other
/// program can take it in between.
fn place(path: &Path, replace: bool, ours: &mut Vec<PathBuf>) -> io::Result<()> {
    if !replace {
        File::create_new(path)?;
        ours.push(path.to_owned());
    }
    fs::rename(unfinished(path), path)
}

/// Temporary name of a file until it is complete.
pub(super) fn unfinished(path: &Path) -> PathBuf {
    let mut name = path.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.new", std::process::id()));
    path.with_file_name(name)
}

fn taken(path: &Path) -> Failure {
    Failure::Run(format!("{} exists already: choose another name, or overwrite the file with --force", path.display()))
}

pub(super) fn unwritable(path: &Path, error: &io::Error) -> Failure {
    Failure::Run(format!("{} cannot be written: {error}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_files_come_or_neither_does() {
        let folder = std::env::temp_dir().join(format!("hallsweep-map-file-{}", std::process::id()));
        fs::create_dir_all(&folder).unwrap();
        let [image, yaml] = ["m.pgm", "m.yaml"].map(|name| folder.join(name));
        let files = [(image.clone(), b"image".to_vec()), (yaml.clone(), b"yaml".to_vec())];
        // Another program creates the second file just before ours gets this name.
        fs::write(&yaml, "theirs").unwrap();
        let (path, error) = put(&files, false).unwrap_err();
        assert_eq!((path, error.kind()), (yaml.clone(), io::ErrorKind::AlreadyExists));
        assert_eq!((fs::read(&yaml).unwrap(), fs::read_dir(&folder).unwrap().count()), (b"theirs".to_vec(), 1));
        // A leftover of a killed process with the same id does not prevent writing.
        fs::write(unfinished(&image), "half").unwrap();
        put(&files, true).unwrap();
        assert_eq!((fs::read(&image).unwrap(), fs::read(&yaml).unwrap()), (b"image".to_vec(), b"yaml".to_vec()));
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 2);
        fs::remove_dir_all(&folder).unwrap();
    }
}
