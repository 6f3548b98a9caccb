//! Halls that users have stored under names, to choose or edit them again. Each hall is a file in a folder of the
//! data folder, and the file is named after the hall. A file can also be added by hand before the start.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use super::chosen_hall::file_of;
use crate::runtime::simulator::{NotSimulated, is_hall_name};
use crate::storage::small_file::SmallFile;
use crate::storage::{files, names};
use hallsweep_sim::Hall;

/// Maximum number of stored halls. Further files are not offered.
const MOST: usize = 100;

/// Maximum size of a file in bytes. Halls that are stored here are far smaller.
const MOST_BYTES: usize = 1 << 20;

#[derive(Debug)]
pub(super) struct KeptHalls {
    data: Option<PathBuf>,
    names: Mutex<BTreeSet<String>>,
}

impl KeptHalls {
    /// Finds the existing files. The log names the files that exceed the maximum number. A file that cannot be used
    /// is listed too, so that a request for it is answered with the reason.
    pub(super) fn within(data: Option<&Path>) -> KeptHalls {
        let names = data.map(|data| found(&names::HALLS.within(data))).unwrap_or_default();
        KeptHalls { data: data.map(Path::to_owned), names: Mutex::new(names) }
    }

    pub(super) fn names(&self) -> Vec<String> {
        self.lock().iter().cloned().collect()
    }

    /// Reads a stored hall; returns `None` when no hall has this name.
    pub(super) fn read(&self, name: &str) -> Option<Result<Hall, NotSimulated>> {
        let file = file(self.data.as_deref().filter(|_| self.lock().contains(name))?, name);
        let unusable = |words: String| {
            let path = file.path().display();
            NotSimulated::Hall(format!(
                "the stored hall {name} cannot be used: {words}; correct the file {path}, or move it away"
            ))
        };
        let text = match file.read(MOST_BYTES) {
            Ok(Some(bytes)) if bytes.len() > MOST_BYTES => Err(unusable(format!("it is larger than {MOST_BYTES} bytes"))),
            Ok(Some(bytes)) => Ok(String::from_utf8_lossy(&bytes).into_owned()),
            Ok(None) => Err(unusable("its file is missing".to_owned())),
            Err(error) => Err(unusable(error.to_string())),
        };
        Some(
            text.and_then(|text| Hall::parse(&format!("{name}.toml"), &text).map_err(|error| unusable(error.to_string())))
                .and_then(fitting),
        )
    }

    /// Stores a hall completely, or not at all. Replaces a hall of the same name only if `may_replace` is set. A lock
    /// keeps storing and deleting from running at the same time.
    pub(super) fn keep(&self, name: &str, hall: &Hall, may_replace: bool) -> Result<(), NotSimulated> {
        let data = self.data.as_deref().ok_or(NotSimulated::NoDataFolder)?;
        // A file may have been added by hand since the start.
        if file(data, name).path().symlink_metadata().is_ok() {
            self.lock().insert(name.to_owned());
        }
        let kept = self.names();
        let is_there = kept.iter().any(|kept| kept == name);
        match (is_there, may_replace) {
            (true, false) => return Err(NotSimulated::AnotherKept(name.to_owned())),
            (false, _) if kept.len() >= MOST => return Err(NotSimulated::TooManyKept(kept.len())),
            (true, true) | (false, _) => {}
        }
        write(data, name, hall).map_err(|error| NotSimulated::CannotChangeKept(error.to_string()))?;
        self.lock().insert(name.to_owned());
        Ok(())
    }

    pub(super) fn discard(&self, name: &str) -> Result<(), NotSimulated> {
        let Some(data) = self.data.as_deref().filter(|_| self.lock().contains(name)) else {
            return Err(NotSimulated::NotThere(name.to_owned()));
        };
        match fs::remove_file(file(data, name).path()).and_then(|()| files::sync_folder(&names::HALLS.within(data))) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(NotSimulated::CannotChangeKept(error.to_string()));
            }
            Ok(()) | Err(_) => {}
        }
        self.lock().remove(name);
        Ok(())
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, BTreeSet<String>> {
        self.names.lock().expect("no code panics while it holds the names")
    }
}

fn found(folder: &Path) -> BTreeSet<String> {
    // `unreadable` reports a folder that cannot be read.
    let files: Vec<PathBuf> = fs::read_dir(folder).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
    let stems = files.iter().filter_map(|file| file.file_name()?.to_str()?.strip_suffix(".toml"));
    let names: BTreeSet<&str> = stems.filter(|name| is_hall_name(name)).collect();
    let offered: BTreeSet<String> = names.into_iter().take(MOST).map(str::to_owned).collect();
    if offered.len() < files.len() {
        let (files, offered) = (files.len(), offered.len());
        tracing::warn!(folder = %folder.display(), files, offered, "the simulator offers at most 100 files of this folder, with \
                                                                    names such as hall-1.toml");
    }
    offered
}

/// Why the folder of stored halls cannot be read, and what to do; `None` when it can be read or does not exist.
pub(in crate::robots) fn unreadable(data: &Path) -> Option<String> {
    let folder = names::HALLS.within(data);
    let error = files::check_folder(&folder).err()?;
    let what = "the simulator offers no stored halls: move it away, then start hallsweep again";
    Some(format!("{} cannot be used ({error}), so {what}", folder.display()))
}

/// Writes the file. When this returns, the file and its name are on disk.
fn write(data: &Path, name: &str, hall: &Hall) -> io::Result<()> {
    let folder = names::HALLS.within(data);
    files::make_folder_within(&folder)?;
    let mut file = file(data, name);
    file.make(file_of(hall).as_bytes()).inspect_err(|_| drop(fs::remove_file(file.unfinished())))?;
    files::sync_folder(&folder)?;
    files::sync_folder(data)
}

fn file(data: &Path, name: &str) -> SmallFile {
    SmallFile::of(data, names::HALL, name)
}

/// Rejects a hall that is too large for a page to draw.
pub(super) fn fitting(hall: Hall) -> Result<Hall, NotSimulated> {
    let (width, height) = size(&hall);
    NotSimulated::too_large(width, height).map_or(Ok(hall), Err)
}

/// The number of columns and the number of rows.
pub(super) fn size(hall: &Hall) -> (u32, u32) {
    (hall.bounds().width().unsigned_abs(), hall.bounds().height().unsigned_abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::storage::tests::scratch::Scratch;

    fn hall(name: &str) -> Hall {
        Hall::named_or_file(name).expect("it is built in")
    }

    #[test]
    fn what_is_kept_is_there_after_a_restart_until_it_is_discarded() {
        let folder = Scratch::new();
        let halls = KeptHalls::within(Some(&folder.0));
        assert!(halls.names().is_empty() && halls.read("mine").is_none());
        halls.keep("mine", &hall("airport"), false).expect("the folder can be written");
        assert_eq!(halls.keep("mine", &hall("seed"), false), Err(NotSimulated::AnotherKept("mine".to_owned())));
        assert_eq!(halls.read("mine"), Some(Ok(hall("airport"))));
        halls.keep("mine", &hall("seed"), true).expect("one takes the place of the other");
        let again = KeptHalls::within(Some(&folder.0));
        assert_eq!(again.names(), ["mine"]);
        assert_eq!(again.read("mine"), Some(Ok(hall("seed"))));
        again.discard("mine").expect("it is there");
        assert_eq!(again.discard("mine"), Err(NotSimulated::NotThere("mine".to_owned())));
        assert!(KeptHalls::within(Some(&folder.0)).names().is_empty());
    }

    #[test]
    fn without_a_data_folder_nothing_is_kept_and_with_one_not_without_bound() {
        assert_eq!(KeptHalls::within(None).keep("mine", &hall("seed"), true), Err(NotSimulated::NoDataFolder));
        let folder = Scratch::new();
        let halls = KeptHalls::within(Some(&folder.0));
        for n in 0..MOST {
            halls.keep(&format!("h{n}"), &hall("seed"), false).expect("there is room");
        }
        assert_eq!(halls.keep("more", &hall("seed"), true), Err(NotSimulated::TooManyKept(MOST)));
        halls.keep("h1", &hall("airport"), true).expect("the place of another is not one more");
    }

    #[test]
    fn what_was_put_there_by_hand_is_offered_and_said_to_be_unusable_when_it_is() {
        let folder = Scratch::new();
        fs::create_dir(names::HALLS.within(&folder.0)).expect("the folder can be written");
        let put = |name: &str, text: &str| fs::write(names::HALLS.within(&folder.0).join(name), text).expect("it can be written");
        put("mine.toml", "drawing = \"\"\"\nS.T\n\"\"\"\n");
        put("bad.toml", "width = 0\n");
        put("large.toml", &"#".repeat(MOST_BYTES + 1));
        put("Not a name.toml", "");
        put("other.txt", "");
        let halls = KeptHalls::within(Some(&folder.0));
        assert_eq!(halls.names(), ["bad", "large", "mine"]);
        assert!(halls.read("mine").is_some_and(|hall| hall.is_ok()));
        let why = |name: &str| halls.read(name).expect("it is there").expect_err("it is unusable").to_string();
        assert!(why("bad").contains("the stored hall bad cannot be used: bad.toml:1"), "{}", why("bad"));
        assert!(why("large").contains("larger than"), "{}", why("large"));
        fs::remove_file(names::HALLS.within(&folder.0).join("mine.toml")).expect("it is there");
        assert!(why("mine").contains("its file is missing"));
        put("late.toml", "drawing = \"\"\"\nS.T\n\"\"\"\n");
        assert_eq!(
            halls.keep("late", &hall("seed"), false),
            Err(NotSimulated::AnotherKept("late".to_owned())),
            "since the start"
        );
        assert!(halls.read("late").is_some_and(|late| late != Ok(hall("seed"))), "it is whole, and offered now");
    }

    /// Safety R5.
    #[cfg(unix)]
    #[test]
    fn what_is_no_plain_file_is_not_waited_for() {
        let folder = Scratch::new();
        fs::create_dir(names::HALLS.within(&folder.0)).expect("the folder can be written");
        let pipe = names::HALLS.within(&folder.0).join("mine.new");
        assert!(std::process::Command::new("mkfifo").arg(pipe).status().expect("mkfifo is there").success());
        let halls = KeptHalls::within(Some(&folder.0));
        halls.keep("mine", &hall("seed"), false).expect("the pipe has given way");
        let outside = folder.0.join("outside");
        fs::write(&outside, "somebody's").expect("it can be written");
        std::os::unix::fs::symlink(&outside, names::HALLS.within(&folder.0).join("mine.new")).expect("it can be linked");
        halls.keep("mine", &hall("airport"), true).expect("so has the link");
        assert_eq!(fs::read(outside).expect("it is there"), b"somebody's");
        fs::create_dir(names::HALLS.within(&folder.0).join("dir.toml")).expect("the folder can be written");
        assert!(matches!(halls.keep("dir", &hall("seed"), true), Err(NotSimulated::CannotChangeKept(_))));
        assert!(!names::HALLS.within(&folder.0).join("dir.new").exists(), "nothing is left behind");
        let halls = KeptHalls::within(Some(&folder.0));
        assert_eq!(halls.names(), ["dir", "mine"]);
        let why = halls.read("dir").expect("it is there").expect_err("it is no hall").to_string();
        assert!(why.contains("it is a folder; correct the file") && why.contains("halls/dir.toml, or move it away"), "{why}");
    }
}
