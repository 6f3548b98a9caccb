//! The table of all files that the program keeps in the data folder, and the only place that spells their names.
//! Small files can be opened only by a `Name`, so the table is complete. The tests of damaged files and the page
//! `docs/journal.md` use `ALL` (safety R5).

use std::path::{Path, PathBuf};

/// Path of a file or folder within the data folder. If there are several files of one kind, `*` stands for the part
/// of the name that differs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Name(&'static str);

macro_rules! names {
    ($($name:ident = $written:literal;)+) => {
        $(pub(crate) const $name: Name = Name($written);)+
        pub const ALL: &[Name] = &[$($name),+];
    };
}

names! {
    ACCESS = "access.toml";
    ARCHIVE = "archives/*.hallsweep";
    ARCHIVES = "archives";
    CHOSEN_HALL = "simulated-hall.toml";
    EXERCISE = "exercise.txt";
    HALL = "halls/*.toml";
    HALLS = "halls";
    HEAD = "journal.head";
    JOURNAL = "journal.db";
    KEPT_BACK = "kept-back.json";
    LOCK = "journal.lock";
    LOG = "journal.db-wal";
    LOG_INDEX = "journal.db-shm";
    LOST = "journal.lost";
    MODE = "hallsweep-*.mode";
    PAIR = "simulated-pair.txt";
    PHOTO = "photos/*/*";
    PHOTOS = "photos";
    ROBOT = "robot-*.txt";
    ROBOT_OUT_OF_DATE = "robot-*.out-of-date";
    ROLLBACK = "journal.db-journal";
    ROOM = "room.unfinished";
    SHELF = "photos/*";
    SIMULATED = "simulated-robot.txt";
    SIMULATED_FURTHER = "simulated-robot-*.txt";
    STOPS = "stops";
    STOPS_DAMAGED = "stops.damaged";
    UNFINISHED = "*.new";
    UNFINISHED_ARCHIVE = "archives/*.unfinished";
    UNFINISHED_PHOTO = "photos/*/*.unfinished";
    UNPACK = "hallsweep-unpack";
}

impl Name {
    pub const fn written(self) -> &'static str {
        self.0
    }

    pub(crate) fn within(self, data: &Path) -> PathBuf {
        data.join(self.0)
    }

    /// Path of one file of this kind, with `part` in place of `*`.
    pub(crate) fn of(self, data: &Path, part: &str) -> PathBuf {
        data.join(self.0.replace('*', part))
    }
}
