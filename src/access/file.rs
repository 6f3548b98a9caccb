//! The contents of the key file: TOML that a person can read. `storage::private_file` finds out who may read the
//! file, and replaces the file. The keys themselves are in `keys`.

use std::fs;
use std::io;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::error::AccessError;
use super::keys::{self, Key, Keys};
use super::role::Role;
use super::token::Token;
use crate::storage::names;
use crate::storage::private_file::{PrivateFile, Readers};
use hallsweep_core::hall::HallId;

/// Maximum size of the file in bytes: three times the size that the maximum number of keys needs, each limited to the
/// maximum number of halls.
const LARGEST: u64 = 1024 * 1024;

const HEADER: &str = "# hallsweep's keys. Whoever has an operator's token can command the robot: keep this file private.\n\
                      # `hallsweep token` shows, adds, replaces and removes keys, also while hallsweep runs.\n\n";

/// Advice on the format, for a file that cannot be parsed.
const SHAPE: &str = "a key is the line [[key]], then name, role (\"operator\" or \"viewer\") and token, each once and in quotes; \
                     the line halls = [\"NAME\", \"NAME\"] limits a key to these halls";

const NAME: &str = "use 1 to 32 letters, digits, - and _";

const HALL_NAMES: &str = "name 1 to 128 halls, each once, with 1 to 32 small letters, digits and -, the first a letter";

#[derive(Clone, Debug)]
pub struct KeyFile(PrivateFile);

/// Identifies a version of the file, so that a change can be noticed without reading the file.
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
    #[serde(skip_serializing_if = "Option::is_none")]
    halls: Option<Vec<String>>,
    token: String,
}

impl KeyFile {
    pub fn within(folder: &Path) -> KeyFile {
        KeyFile(PrivateFile::within(folder, names::ACCESS))
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    /// The keys in the file; `None` when there is no file yet.
    pub fn read(&self) -> Result<Option<Keys>, AccessError> {
        Ok(self.read_with_readers()?.map(|(keys, _)| keys))
    }

    pub(super) fn read_with_readers(&self) -> Result<Option<(Keys, Readers)>, AccessError> {
        let unreadable = |error| AccessError::Unreadable { path: self.path().to_owned(), error };
        let Some((bytes, readers)) = self.0.read(LARGEST).map_err(unreadable)? else { return Ok(None) };
        if let Readers::Others(mode) = readers {
            return Err(AccessError::Exposed { path: self.path().to_owned(), mode });
        }
        let garbled =
            |_| AccessError::Malformed { path: self.path().to_owned(), problem: "the file is not UTF-8 text".to_owned() };
        let keys = self.understood(std::str::from_utf8(&bytes).map_err(garbled)?)?;
        Ok(Some((keys, readers)))
    }

    /// Locks the keys, so that no other hallsweep changes them until the returned lock is dropped. Waits for the lock
    /// for two seconds at most.
    pub fn alone(&self) -> Option<fs::File> {
        self.0.alone()
    }

    /// Replaces the file, and returns when the new file is on disk. After a failure the old file is unchanged.
    /// Creates the folder if it does not exist.
    pub fn write(&self, keys: &Keys) -> Result<(), AccessError> {
        self.0.replace(written(keys).as_bytes()).map_err(|error| AccessError::Unwritable { path: self.path().to_owned(), error })
    }

    pub(super) fn stamp(&self) -> io::Result<Stamp> {
        fs::metadata(self.path()).map(|metadata| stamp(&metadata))
    }

    fn understood(&self, text: &str) -> Result<Keys, AccessError> {
        let malformed = |problem: String| AccessError::Malformed { path: self.path().to_owned(), problem };
        // TOML's error message may quote any word of the file, and any word may be a token. So the error has only the
        // line number and our own words.
        let read: Written = toml::from_str(text).map_err(|error| {
            let before = error.span().and_then(|span| text.get(..span.start)).unwrap_or_default();
            malformed(format!("line {} cannot be read: {SHAPE}", before.matches('\n').count() + 1))
        })?;
        let mut all = Vec::new();
        for (number, WrittenKey { name, role, halls, token }) in (1..).zip(read.key) {
            let token = Token::read(&token).ok_or_else(|| malformed(format!("the token of key {number} is not valid")))?;
            // The user may have written the token in place of a name, so the errors quote no name.
            let key = Key::new(&name, role, token);
            let mut key = key.map_err(|_| malformed(format!("the name of key {number} is not valid: {NAME}")))?;
            let halls = halls.map(|halls| keys::halls(halls.iter().map(String::as_str))).transpose();
            key.halls = halls.map_err(|_| malformed(format!("the halls of key {number} are not valid: {HALL_NAMES}")))?;
            all.push(key);
        }
        Keys::new(all).map_err(|error| malformed(error.to_string()))
    }
}

pub(super) fn written(keys: &Keys) -> String {
    let key = |key: &Key| WrittenKey {
        name: key.name.to_string(),
        role: key.role,
        halls: key.halls.as_deref().map(|halls| halls.iter().map(HallId::to_string).collect()),
        token: key.token.reveal().to_owned(),
    };
    let all = Written { key: keys.iter().map(key).collect() };
    format!("{HEADER}{}", toml::to_string(&all).expect("names, roles and tokens are strings, which TOML can hold"))
}

/// The change time (ctime) changes with the contents, the mode and the owner, and no program can set it. The inode
/// changes with each replacement.
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
