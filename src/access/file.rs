//! The file that holds the keys: TOML that a person can read, private to its owner, and replaced as a whole, so that a crash
//! leaves the old one or the new one. What keys are is said in `keys`.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::error::AccessError;
use super::keys::{Key, Keys};
use super::role::Role;
use super::token::Token;

/// The file's name inside the data folder.
pub const FILE: &str = "access.toml";

/// A larger file is none of ours: all keys there may be are a tenth of this.
const LARGEST: u64 = 128 * 1024;

/// What the file begins with.
const HEADER: &str = "# hallsweep's keys. Whoever has an operator's token can command the robot: keep this file private.\n\
                      # `hallsweep token` shows, adds, replaces and removes keys, also while hallsweep runs.\n\n";

/// What a file that cannot be read should look like.
const SHAPE: &str = "a key is the line [[key]], then name, role (\"operator\" or \"viewer\") and token, each once and in quotes";

/// What a name is.
const NAME: &str = "take 1 to 32 letters, digits, - and _";

/// Where keys are kept.
#[derive(Clone, Debug)]
pub struct KeyFile(PathBuf);

/// Tells one state of the file from another without reading it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Stamp(Vec<i64>);

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    key: Vec<WrittenKey>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WrittenKey {
    name: String,
    role: Role,
    token: String,
}

impl KeyFile {
    /// The file in this data folder.
    #[must_use]
    pub fn within(folder: &Path) -> KeyFile {
        KeyFile(folder.join(FILE))
    }

    /// Its path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// The keys in it; `None` when there is no such file yet.
    ///
    /// # Errors
    /// A file that cannot be read, that others can read, or that holds something else.
    pub fn read(&self) -> Result<Option<Keys>, AccessError> {
        let unreadable = |error| AccessError::Unreadable { path: self.0.clone(), error };
        let file = match open_plain(&self.0) {
            Ok(file) => file,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(unreadable(error)),
        };
        self.check_private(&file.metadata().map_err(unreadable)?)?;
        let mut bytes = Vec::new();
        file.take(LARGEST).read_to_end(&mut bytes).map_err(unreadable)?;
        let garbled = |_| AccessError::Malformed { path: self.0.clone(), problem: "it is no text".to_owned() };
        self.understood(std::str::from_utf8(&bytes).map_err(garbled)?).map(Some)
    }

    /// Replaces the file, and is done when that has reached the disk. The folder is made when it is not there.
    ///
    /// # Errors
    /// `AccessError::Unwritable`; the old file is then as it was.
    pub fn write(&self, keys: &Keys) -> Result<(), AccessError> {
        self.replace(&written(keys)).map_err(|error| AccessError::Unwritable { path: self.0.clone(), error })
    }

    /// What the file looks like from outside.
    pub(super) fn stamp(&self) -> io::Result<Stamp> {
        fs::metadata(&self.0).map(|metadata| stamp(&metadata))
    }

    fn understood(&self, text: &str) -> Result<Keys, AccessError> {
        let malformed = |problem: String| AccessError::Malformed { path: self.0.clone(), problem };
        // What TOML says of a mistake may quote any word of the file, and any word of it may be a token: what is passed on is
        // where it is, in words of our own.
        let read: Written = toml::from_str(text).map_err(|error| {
            let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
            malformed(format!("line {} cannot be read: {SHAPE}", before.matches('\n').count() + 1))
        })?;
        let mut keys = Vec::new();
        for (number, WrittenKey { name, role, token }) in (1..).zip(read.key) {
            let token = Token::read(&token).ok_or_else(|| malformed(format!("the token of key {number} is none")))?;
            let key = Key::new(&name, role, token);
            // Somebody may have mixed up name and token.
            keys.push(key.map_err(|_| malformed(format!("the name of key {number} is none: {NAME}")))?);
        }
        Keys::new(keys).map_err(|error| malformed(error.to_string()))
    }

    fn replace(&self, text: &str) -> io::Result<()> {
        let folder = self.0.parent().unwrap_or(Path::new("."));
        make_folder(folder)?;
        let fresh = self.0.with_extension(format!("{}.new", std::process::id()));
        // One that a crash left behind may be anybody's: it is not written into.
        let _ = fs::remove_file(&fresh);
        let written = write_private(&fresh, text).and_then(|()| fs::rename(&fresh, &self.0));
        if written.is_err() {
            let _ = fs::remove_file(&fresh);
        }
        written.and_then(|()| sync_folder(folder))
    }

    #[cfg(unix)]
    fn check_private(&self, metadata: &fs::Metadata) -> Result<(), AccessError> {
        use std::os::unix::fs::PermissionsExt;
        let mode = metadata.permissions().mode() & 0o777;
        if mode & 0o077 == 0 { Ok(()) } else { Err(AccessError::Exposed { path: self.0.clone(), mode }) }
    }

    /// Where there are no modes, the folder of the user keeps others out.
    #[cfg(not(unix))]
    #[expect(clippy::unused_self, clippy::unnecessary_wraps, reason = "it has the shape of the one that checks")]
    fn check_private(&self, _: &fs::Metadata) -> Result<(), AccessError> {
        Ok(())
    }
}

/// The text of the file that holds these keys.
pub(super) fn written(keys: &Keys) -> String {
    let key = |key: &Key| WrittenKey { name: key.name.to_string(), role: key.role, token: key.token.reveal().to_owned() };
    let all = Written { key: keys.iter().map(key).collect() };
    format!("{HEADER}{}", toml::to_string(&all).expect("names, roles and tokens are strings, which TOML can hold"))
}

/// Opens a file, and nothing else of its name: a pipe would be waited at for ever, and a link that leads nowhere looks like a file
/// that never was.
fn open_plain(path: &Path) -> io::Result<File> {
    match fs::metadata(path) {
        Ok(there) if !there.is_file() => Err(io::Error::other("it is no plain file")),
        Err(error) if error.kind() == io::ErrorKind::NotFound && fs::symlink_metadata(path).is_ok() => {
            Err(io::Error::other("it is a link that leads nowhere"))
        }
        Ok(_) | Err(_) => File::open(path),
    }
}

fn write_private(path: &Path, text: &str) -> io::Result<()> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let mut file = options.open(path)?;
    file.write_all(text.as_bytes())?;
    file.sync_all()
}

fn make_folder(folder: &Path) -> io::Result<()> {
    let mut builder = fs::DirBuilder::new();
    builder.recursive(true);
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.create(folder)
}

/// The renaming is on the disk when the folder is.
#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    File::open(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })?.sync_all()
}

#[cfg(not(unix))]
#[expect(clippy::unnecessary_wraps, reason = "it has the shape of the one that syncs")]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

/// The change time moves with contents, mode and owner, and no program can set it; the inode with each replacement.
#[cfg(unix)]
fn stamp(metadata: &fs::Metadata) -> Stamp {
    use std::os::unix::fs::MetadataExt;
    Stamp(vec![metadata.ctime(), metadata.ctime_nsec(), metadata.ino().cast_signed(), metadata.size().cast_signed()])
}

#[cfg(not(unix))]
fn stamp(metadata: &fs::Metadata) -> Stamp {
    let modified = metadata.modified().ok().and_then(|time| time.duration_since(std::time::UNIX_EPOCH).ok());
    let nanoseconds = modified.map_or(0, |since| i64::try_from(since.as_nanos()).unwrap_or(0));
    Stamp(vec![nanoseconds, metadata.len().cast_signed()])
}

#[cfg(test)]
#[path = "file_tests.rs"]
mod tests;
