//! The usual data folder on this system for the user who runs the program. Does not touch the disk.

use std::ffi::OsString;
use std::path::{Path, PathBuf};

const NAME: &str = "hallsweep";

/// The usual folder according to the environment; `None` when the environment names no home directory.
pub(super) fn usual(environment: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
    let absolute = |name: &str| environment(name).map(PathBuf::from).filter(|path| path.is_absolute());
    let within_home = |folder: &str| absolute("HOME").map(|home| home.join(Path::new(folder)));
    let data = if cfg!(windows) {
        absolute("APPDATA")
    } else if cfg!(target_os = "macos") {
        within_home("Library/Application Support")
    } else {
        absolute("XDG_DATA_HOME").or_else(|| within_home(".local/share"))
    };
    data.map(|data| data.join(NAME))
}

#[cfg(all(test, not(windows), not(target_os = "macos")))]
mod tests {
    use super::*;

    fn check(environment: &[(&str, &str)], expect: Option<&str>) {
        let value = |name: &str| environment.iter().find(|(known, _)| *known == name).map(|(_, value)| OsString::from(value));
        assert_eq!(usual(value), expect.map(PathBuf::from), "{environment:?}");
    }

    #[test]
    fn the_usual_folder_is_where_the_system_wants_it() {
        check(&[("HOME", "/h/ann")], Some("/h/ann/.local/share/hallsweep"));
        check(&[("HOME", "/h/ann"), ("XDG_DATA_HOME", "/data")], Some("/data/hallsweep"));
    }

    #[test]
    fn what_is_no_absolute_path_does_not_count() {
        check(&[("HOME", "/h/ann"), ("XDG_DATA_HOME", "data")], Some("/h/ann/.local/share/hallsweep"));
        check(&[("HOME", "")], None);
        check(&[], None);
    }
}
