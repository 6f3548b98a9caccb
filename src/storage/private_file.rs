//! A small file that holds secrets. The code here finds out who may read the secrets, and replaces the file.
//!
//! ```text
//!   its owner alone                 normal, in a folder that only its owner may write to
//!   the group of its folder         accepted: the group may replace the file, so reading it reveals nothing new
//!   whoever the volume allows       accepted: some volumes give every file the same mode in any case
//!   anybody else                    the secrets may be known already
//! ```

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::files;
use super::names::{self, Name};

/// Interval and number of attempts to lock the folder: two seconds in all.
const GLANCE: Duration = Duration::from_millis(20);
const GLANCES: u32 = 100;

/// A file private to the user who runs hallsweep, replaced as a whole at each write.
#[derive(Clone, Debug)]
pub(crate) struct PrivateFile(PathBuf);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Readers {
    Owner,
    /// The owner, and the group of the folder. This group may replace the file anyway.
    Group,
    /// Everybody whom the volume allows. The volume gives every new file this mode or a wider one, so nobody opened
    /// this file on purpose.
    OfVolume,
    /// Other users can read the file too. The number is the mode as in `chmod`.
    Others(u32),
}

impl PrivateFile {
    pub(crate) fn within(data: &Path, name: Name) -> PrivateFile {
        PrivateFile(name.within(data))
    }

    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    /// Reads the first `most` bytes, and finds out who may read them; `None` when there is no such file. On systems
    /// without modes the user's own folder protects the file.
    pub(crate) fn read(&self, most: u64) -> io::Result<Option<(Vec<u8>, Readers)>> {
        let file = match files::open(&self.0, File::options().read(true)) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            opened => opened?,
        };
        let readers = readers(&self.0, &file.metadata()?, || mode_of_volume(files::above(&self.0)))?;
        let mut bytes = Vec::new();
        file.take(most).read_to_end(&mut bytes)?;
        Ok(Some((bytes, readers)))
    }

    /// Locks the folder until the returned file is dropped, so that no other caller of this function writes between
    /// the caller's read and its write. Waits for two seconds at most, because every user who can read the folder can
    /// lock it too. Does not wait if the system cannot lock the folder.
    pub(crate) fn alone(&self) -> Option<File> {
        let folder = File::open(files::above(&self.0)).ok()?;
        (0..GLANCES).find_map(|_| match folder.try_lock() {
            Err(TryLockError::WouldBlock) => {
                std::thread::sleep(GLANCE);
                None
            }
            locked => Some(locked.is_ok()),
        })?;
        Some(folder)
    }

    /// Replaces the file, and returns when the new file is on disk. Creates the folder if it does not exist.
    pub(crate) fn replace(&self, bytes: &[u8]) -> io::Result<()> {
        let folder = files::above(&self.0);
        files::make_folder(folder)?;
        // With the process id, two programs that write at the same time use different names.
        let fresh = self.0.with_extension(format!("{}.new", std::process::id()));
        // A file left by a crash may belong to another user, so it is removed and not written into.
        let _ = fs::remove_file(&fresh);
        let written = write(&fresh, bytes).and_then(|()| fs::rename(&fresh, &self.0));
        if written.is_err() {
            let _ = fs::remove_file(&fresh);
        }
        written.and_then(|()| files::sync_folder(folder))
    }
}

fn write(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = make(path)?;
    files::share(path, &file)?;
    file.write_all(bytes)?;
    file.sync_all()
}

/// Creates a private file. Fails when the name exists.
fn make(path: &Path) -> io::Result<File> {
    let mut options = OpenOptions::new();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    options.open(path)
}

#[cfg(unix)]
fn readers(path: &Path, file: &fs::Metadata, made: impl FnOnce() -> u32) -> io::Result<Readers> {
    use std::os::unix::fs::MetadataExt;
    let beside_owner = |mode: u32| mode & 0o077;
    let open = beside_owner(file.mode());
    if open == 0 {
        return Ok(Readers::Owner);
    }
    let folder = files::above(path);
    let is_its_group = fs::metadata(folder)?.gid() == file.gid() && files::is_the_groups(folder)?;
    if open & 0o007 == 0 && is_its_group && !files::has_access_list(path) {
        return Ok(Readers::Group);
    }
    Ok(if made() & open == open { Readers::OfVolume } else { Readers::Others(file.mode() & 0o777) })
}

/// The mode that the volume gives to a private file in this folder. Only creating a file shows this mode. Returns 0
/// when no file can be created.
#[cfg(unix)]
fn mode_of_volume(folder: &Path) -> u32 {
    use std::hash::{BuildHasher, Hasher, RandomState};
    use std::os::unix::fs::MetadataExt;
    // The name is random: in containers two programs may have the same process id, and a killed program leaves its
    // file behind.
    let tried = names::MODE.of(folder, &format!("{:016x}", RandomState::new().build_hasher().finish()));
    let made = make(&tried).and_then(|made| made.metadata()).map_or(0, |made| made.mode());
    let _ = fs::remove_file(&tried);
    made
}

#[cfg(not(unix))]
#[expect(clippy::unnecessary_wraps, reason = "it has the shape of the one that looks")]
fn readers(_: &Path, _: &fs::Metadata, _: impl FnOnce() -> u32) -> io::Result<Readers> {
    Ok(Readers::Owner)
}

#[cfg(not(unix))]
fn mode_of_volume(_: &Path) -> u32 {
    0
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};

    use super::*;
    use crate::storage::tests::scratch::Scratch;

    fn set(path: &Path, mode: u32) {
        fs::set_permissions(path, fs::Permissions::from_mode(mode)).expect("it is ours");
    }

    fn readers_of(file: &PrivateFile) -> Readers {
        file.read(9).expect("it can be read").expect("it is there").1
    }

    /// Safety A1. A cluster sets the group of a volume and of all files on it at each start (`fsGroup`).
    #[test]
    fn who_may_put_another_file_in_its_place_may_read_it_and_nobody_else() {
        let scratch = Scratch::new();
        let folder = scratch.0.join("shared");
        fs::create_dir_all(&folder).unwrap();
        set(&folder, 0o2770);
        let file = PrivateFile::within(&folder, names::ACCESS);
        file.replace(b"secret").unwrap();
        assert_eq!((fs::metadata(file.path()).unwrap().mode() & 0o777, readers_of(&file)), (0o660, Readers::Group));
        for (mode, expect) in [
            (0o600, Readers::Owner),
            (0o640, Readers::Group),
            (0o664, Readers::Others(0o664)),
            (0o602, Readers::Others(0o602)),
            (0o666, Readers::Others(0o666)),
        ] {
            set(file.path(), mode);
            assert_eq!(readers_of(&file), expect, "{mode:o}");
        }
        set(file.path(), 0o660);
        // In these folders the group may not write, or may not replace the files of others.
        for folder_mode in [0o700, 0o750, 0o1770] {
            set(&folder, folder_mode);
            assert_eq!(readers_of(&file), Readers::Others(0o660), "in a folder {folder_mode:o}");
        }
        set(&folder, 0o2770);
        // An access list that names a user, if the system supports it. The parts are version 2, the owner, user 1,
        // group, mask, others.
        #[cfg(target_os = "linux")]
        {
            let entry =
                |tag: u16, rights: u16, who: u32| [&tag.to_le_bytes()[..], &rights.to_le_bytes(), &who.to_le_bytes()].concat();
            let nobody = u32::MAX;
            let entries = [(1, 6, nobody), (2, 6, 1), (4, 0, nobody), (16, 6, nobody), (32, 0, nobody)];
            let list = entries.map(|(tag, rights, who)| entry(tag, rights, who)).concat();
            let list = [&2_u32.to_le_bytes()[..], &list].concat();
            let name = "system.posix_acl_access";
            if rustix::fs::setxattr(file.path(), name, &list, rustix::fs::XattrFlags::empty()).is_ok() {
                assert_eq!(readers_of(&file), Readers::Others(0o660), "with an access list");
                rustix::fs::removexattr(file.path(), name).unwrap();
                assert_eq!(readers_of(&file), Readers::Group);
                rustix::fs::setxattr(&folder, name, &list, rustix::fs::XattrFlags::empty()).unwrap();
                assert_eq!(readers_of(&file), Readers::Others(0o660), "in a folder with an access list");
                rustix::fs::removexattr(&folder, name).unwrap();
                set(&folder, 0o2770);
            }
        }
        // Only root can give a file to any group.
        let stranger = fs::metadata(&folder).unwrap().gid() + 1;
        if chown(file.path(), None, Some(stranger)).is_ok() {
            assert_eq!(readers_of(&file), Readers::Others(0o660), "of another group than the folder");
            // The folder does not pass on its group, so new files are private.
            chown(&folder, None, Some(stranger)).unwrap();
            set(&folder, 0o770);
            file.replace(b"secret").unwrap();
            assert_eq!(readers_of(&file), Readers::Owner);
        }
        assert_eq!(fs::read_dir(&folder).unwrap().count(), 1, "what was tried is gone");
    }

    #[test]
    fn what_a_volume_makes_of_every_file_is_told_from_what_somebody_did_to_one() {
        let scratch = Scratch::new();
        let file = PrivateFile::within(&scratch.0, names::ACCESS);
        file.replace(b"secret").unwrap();
        for (mode, made, expect) in [
            (0o777, 0o100_777, Readers::OfVolume),
            (0o644, 0o100_644, Readers::OfVolume),
            (0o755, 0o100_777, Readers::OfVolume),
            (0o777, 0o100_755, Readers::Others(0o777)),
            (0o644, 0o100_600, Readers::Others(0o644)),
            (0o606, 0, Readers::Others(0o606)),
        ] {
            set(file.path(), mode);
            let readers = readers(file.path(), &fs::metadata(file.path()).unwrap(), || made);
            assert_eq!(readers.unwrap(), expect, "{mode:o} where {made:o} is made");
        }
    }
}
