//! How the files of the data folder are created and opened, for every module that stores something there. A file is
//! private to its owner, or shared with the group if the folder belongs to the group. Only plain files are opened:
//! opening a pipe would block for ever, and a dangling link would look like a missing file.

use std::fs::{self, DirBuilder, File, OpenOptions};
use std::io::{self, Read};
use std::path::Path;

const SPECIAL: &str = "it is a pipe or a device, not a plain file";

/// Fails with a short reason when `path` is not a plain file, or when this user may not read it. A missing file is no
/// error.
pub(crate) fn check_plain(path: &Path) -> io::Result<()> {
    check(path, |there| (!there.is_file()).then(|| if there.is_dir() { "it is a folder" } else { SPECIAL }))
}

pub(crate) fn check_folder(path: &Path) -> io::Result<()> {
    check(path, |there| (!there.is_dir()).then_some("it is not a folder"))
}

fn check(path: &Path, wrong: impl Fn(&fs::Metadata) -> Option<&'static str>) -> io::Result<()> {
    match fs::metadata(path) {
        Ok(there) => wrong(&there).map_or_else(|| check_rights(path, there.is_dir()), |wrong| Err(io::Error::other(wrong))),
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let is_link = fs::symlink_metadata(path).is_ok_and(|there| there.is_symlink());
            if is_link { Err(io::Error::other("it is a link without a target")) } else { Ok(()) }
        }
        Err(error) => Err(error),
    }
}

/// Checks rights without opening the file. Opening is avoided because a program that closes a file of an SQLite
/// database loses its locks on this database.
#[cfg(unix)]
fn check_rights(path: &Path, is_folder: bool) -> io::Result<()> {
    use rustix::fs::Access;
    let rights = if is_folder { Access::READ_OK | Access::EXEC_OK } else { Access::READ_OK };
    Ok(rustix::fs::access(path, rights)?)
}

#[cfg(not(unix))]
fn check_rights(_: &Path, _: bool) -> io::Result<()> {
    Ok(())
}

/// Reads a plain file, at most `most` + 1 bytes, so that the caller can detect a file that is too large.
pub(crate) fn read(path: &Path, most: usize) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    open(path, File::options().read(true))?.take(most as u64 + 1).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Like `read`; `None` when there is no such file.
pub(crate) fn read_if_there(path: &Path, most: usize) -> io::Result<Option<Vec<u8>>> {
    match read(path, most) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        read => read.map(Some),
    }
}

/// Opens a plain file with `options`. If this call creates the file, the file is private, or shared with the group to
/// which the folder belongs.
pub(crate) fn open(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    check_plain(path)?;
    open_at_once(path, options)
}

/// Opens a file without checking it first. With `NONBLOCK` this does not block if a pipe has replaced the file since
/// the check.
fn open_at_once(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(options, rustix::fs::OFlags::NONBLOCK.bits().cast_signed());
    let file = open_unchecked(path, options)?;
    if file.metadata()?.is_file() { Ok(file) } else { Err(io::Error::other(SPECIAL)) }
}

/// Creates a file under its temporary name. An existing file of this name was left by a killed program. The old file
/// is removed first, so that no pipe blocks and no link is followed. A folder of this name stays, and is an error.
pub(crate) fn create(path: &Path) -> io::Result<File> {
    let _ = fs::remove_file(path);
    check_no_folder(path)?;
    open_unchecked(path, File::options().write(true).create_new(true)).map_err(naming(path))
}

pub(crate) fn check_no_folder(path: &Path) -> io::Result<()> {
    let is_folder = fs::symlink_metadata(path).is_ok_and(|there| there.is_dir());
    if is_folder { Err(naming(path)(io::Error::other("it is a folder"))) } else { Ok(()) }
}

/// Adds the path to an error, because the operator may see only the error.
pub(crate) fn naming(path: &Path) -> impl Fn(io::Error) -> io::Error {
    move |error| io::Error::new(error.kind(), format!("{}: {error}", path.display()))
}

fn open_unchecked(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    let is_new = !path.exists();
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(options, 0o600);
    let file = options.open(path)?;
    if is_new {
        share(path, &file)?;
    }
    Ok(file)
}

/// Creates a folder and its parents, for the owner only.
pub(crate) fn make_folder(path: &Path) -> io::Result<()> {
    let mut builder = DirBuilder::new();
    #[cfg(unix)]
    std::os::unix::fs::DirBuilderExt::mode(&mut builder, 0o700);
    builder.recursive(true).create(path)
}

/// Creates a folder inside an existing folder. It is shared with the group if the parent folder belongs to the group.
pub(crate) fn make_folder_within(path: &Path) -> io::Result<()> {
    if path.is_dir() {
        return Ok(());
    }
    let made = check_folder(path).and_then(|()| make_folder(path));
    made.and_then(|()| share(path, &File::open(path)?)).map_err(naming(path))
}

/// Flushes the names in a folder to disk.
pub(crate) fn sync_folder(path: &Path) -> io::Result<()> {
    let path = if path.as_os_str().is_empty() { Path::new(".") } else { path };
    // Other systems cannot open a folder as a file, and store the names durably without this call.
    if cfg!(unix) { File::open(path)?.sync_all() } else { Ok(()) }
}

pub(super) fn above(path: &Path) -> &Path {
    path.parent().filter(|above| !above.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Whether the group may replace files of this folder, as the owner may. Returns false for a folder with an access
/// list (ACL), since then the mode does not tell what the group may do.
#[cfg(unix)]
pub(super) fn is_the_groups(folder: &Path) -> io::Result<bool> {
    use std::os::unix::fs::PermissionsExt;
    const GROUP_WRITES: u32 = 0o020;
    const OWN_FILES_ONLY: u32 = 0o1000;
    let mode = fs::metadata(folder)?.permissions().mode();
    Ok(mode & (GROUP_WRITES | OWN_FILES_ONLY) == GROUP_WRITES && !has_access_list(folder))
}

/// Whether a path has an access list that names other users, or a folder has a default list for new files.
#[cfg(target_os = "linux")]
pub(super) fn has_access_list(path: &Path) -> bool {
    let lists = ["system.posix_acl_access", "system.posix_acl_default"];
    let mut room = [0; 256];
    lists.into_iter().any(|list| match rustix::fs::getxattr(path, list, &mut room[..]) {
        Ok(bytes) => bytes > 0,
        // The list does not fit into the buffer, so a list exists.
        Err(error) => error == rustix::io::Errno::RANGE,
    })
}

#[cfg(all(unix, not(target_os = "linux")))]
pub(super) fn has_access_list(_: &Path) -> bool {
    false
}

/// Gives the group the owner's rights if the folder belongs to the group, regardless of the umask of the process.
#[cfg(unix)]
pub(super) fn share(path: &Path, made: &File) -> io::Result<()> {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    let (folder, there) = (above(path), made.metadata()?);
    let shared = there.mode() | (there.mode() & 0o700) >> 3;
    // A new file has the group of its creator, unless the folder passes on its own group.
    if shared == there.mode() || fs::metadata(folder)?.gid() != there.gid() || !is_the_groups(folder)? {
        return Ok(());
    }
    match made.set_permissions(fs::Permissions::from_mode(shared)) {
        // The volume does not allow programs to set modes, so the file keeps the mode that the volume chose.
        Err(error) if error.kind() == io::ErrorKind::PermissionDenied => Ok(()),
        set => set,
    }
}

/// On other systems a file has the rights of its folder.
#[cfg(not(unix))]
#[expect(clippy::unnecessary_wraps, reason = "it has the shape of the one that shares")]
pub(super) fn share(_: &Path, _: &File) -> io::Result<()> {
    Ok(())
}

#[cfg(all(test, unix))]
mod tests {
    use std::os::unix::fs::PermissionsExt;

    use super::*;
    use crate::storage::tests::scratch::Scratch;

    fn mode(path: &Path) -> u32 {
        fs::metadata(path).expect("it is there").permissions().mode() & 0o7777
    }

    /// Safety R5.
    #[test]
    fn what_is_no_plain_file_is_said_to_be_none_and_not_waited_for() {
        let scratch = Scratch::new();
        let at = |name: &str| scratch.0.join(name);
        assert!(std::process::Command::new("mkfifo").arg(at("pipe")).status().unwrap().success());
        std::os::unix::fs::symlink("/nowhere/at/all", at("link")).unwrap();
        fs::write(at("file"), "four").unwrap();
        std::os::unix::fs::symlink(at("file"), at("good-link")).unwrap();
        for (name, words) in [("", "it is a folder"), ("pipe", "a pipe or a device"), ("link", "a link without a target")] {
            let said = read(&at(name), 9).unwrap_err();
            assert!(said.to_string().contains(words), "{name}: {said}");
            assert!(open(&at(name), OpenOptions::new().write(true)).is_err(), "{name}");
        }
        // Simulates a pipe that replaced the file just after the check.
        for mut options in [File::options().read(true).clone(), File::options().write(true).clone()] {
            assert!(open_at_once(&at("pipe"), &mut options).is_err());
        }
        assert_eq!(read(&at("none"), 9).unwrap_err().kind(), io::ErrorKind::NotFound);
        let said = create(&at("")).unwrap_err().to_string();
        assert!(said.contains("it is a folder") && said.contains(scratch.0.to_str().unwrap()), "{said}");
        for leftover in ["pipe", "link", "good-link"] {
            create(&at(leftover)).unwrap();
            assert!(fs::symlink_metadata(at(leftover)).unwrap().is_file(), "{leftover} has given way");
        }
        std::os::unix::fs::symlink(at("file"), at("good-link-2")).unwrap();
        assert_eq!((read(&at("file"), 9).unwrap(), read(&at("good-link-2"), 2).unwrap()), (b"four".to_vec(), b"fou".to_vec()));
        assert!(check_folder(&at("file")).is_err() && check_folder(&at("link")).is_err() && check_folder(&at("none")).is_ok());
    }

    #[test]
    fn what_is_made_is_private_or_the_groups_where_the_folder_is() {
        let scratch = Scratch::new();
        let (own, shared) = ((0o600, 0o700), (0o660, 0o770));
        for (folder, (file, inner)) in
            [(0o755, own), (0o700, own), (0o1770, own), (0o770, shared), (0o2775, (0o660, 0o2770)), (0o2770, (0o660, 0o2770))]
        {
            let above = scratch.0.join(format!("{folder:o}"));
            fs::create_dir(&above).unwrap();
            fs::set_permissions(&above, fs::Permissions::from_mode(folder)).unwrap();
            open(&above.join("file"), OpenOptions::new().write(true).create(true)).unwrap();
            make_folder_within(&above.join("inner")).unwrap();
            assert_eq!((mode(&above.join("file")), mode(&above.join("inner"))), (file, inner), "in {folder:o}");
            fs::set_permissions(above.join("file"), fs::Permissions::from_mode(0o640)).unwrap();
            open(&above.join("file"), OpenOptions::new().write(true)).unwrap();
            assert_eq!(mode(&above.join("file")), 0o640, "what is there is left as somebody wanted it");
        }
    }
}
