//! The data of earlier runs, with which this run continues: the journal, and what is stored about the robots. The
//! core decides what to do with the recalled state.

use std::fs;
use std::io::ErrorKind;
use std::path::Path;
use std::sync::Arc;

use super::AppError;
use crate::config::HallSettings;
use crate::robots::Robots;
use crate::runtime::archive::Archive;
use crate::runtime::clock::Clock;
use crate::runtime::store::Store;
use crate::storage::names;
use crate::storage::sqlite::{self, Archived, MemoryStore};
use crate::storage::stops::Stops;
use hallsweep_core::engine::Recalled;
use hallsweep_core::units::{Epoch, WallTime};
use hallsweep_core::world::luggage::{Luggage, PhotoState};

pub(super) struct DataFolder {
    pub(super) store: Box<dyn Store>,
    pub(super) archive: Arc<dyn Archive>,
    pub(super) recalled: Option<Recalled>,
    pub(super) elsewhere: bool,
    /// Whether there is a journal that could not be read.
    pub(super) is_unread: bool,
    /// Whether the test pieces of the exercise are known; also true outside exercises.
    pub(super) are_tests_known: bool,
    /// Remembers a STOP even when the journal cannot be written.
    pub(super) stops: Option<Stops>,
    /// Messages to an operator about faults that do not keep the program from running. Each message says what to do.
    pub(super) notes: Vec<String>,
}

impl DataFolder {
    /// Opens the data folder of the settings, and reads the stored positions of the robots. A file that cannot be
    /// read or written is no error: the store reports the fault, and the robots are held (safety R5). The robots are
    /// also held in two other cases: the keys cannot be read, for the reason in `keys`, or a mission is under way in
    /// another hall. Only two things are errors: the folder is in use, or this user may not enter it.
    pub(super) fn open(
        settings: &HallSettings,
        robots: &mut Robots,
        keys: Option<String>,
        mut notes: Vec<String>,
    ) -> Result<DataFolder, AppError> {
        let Some(folder) = &settings.folder else {
            let store = MemoryStore::new();
            let archive = store.archive();
            return Ok(DataFolder {
                archive,
                store: Box::new(store),
                recalled: None,
                elsewhere: false,
                is_unread: false,
                are_tests_known: true,
                stops: None,
                notes,
            });
        };
        if fs::metadata(folder.join(".")).is_err_and(|error| error.kind() == ErrorKind::PermissionDenied) {
            return Err(AppError::ClosedFolder(folder.clone()));
        }
        robots.recall(folder);
        notes.extend(robots.note(folder));
        let opened = |robots: &Robots| {
            let beside: Vec<String> = robots.lost().into_iter().chain(Stops::unusable(folder)).chain(keys.clone()).collect();
            sqlite::open(folder, (!beside.is_empty()).then(|| beside.join("; and ")))
        };
        let mut kept = opened(robots)?;
        let is_on_a_mission = kept.recalled.as_ref().is_some_and(|recalled| recalled.state.phase.is_mission());
        if let (Some(remembered), true) = (robots.other_hall(), is_on_a_mission) {
            let words = in_another_hall(folder, remembered, &robots.hall_name());
            robots.lose(&words);
            // Only one store may use the folder at a time, so the first store is closed before the second one opens.
            drop(kept);
            kept = opened(robots)?;
        }
        let sqlite::Opened { store, archive, recalled, failure } = kept;
        let is_unread = failure.is_some() && recalled.is_none();
        let recalled = recalled.map(|recalled| without_lost_photos(recalled, &*archive));
        let mut elsewhere = false;
        match robots.other_hall() {
            // The unreadable record may be of a mission in the other hall. So the stored positions of the robots in
            // that hall are kept.
            _ if is_unread => {}
            // The position of some robots is unknown. The searching robot may be on a mission in the hall where the
            // other robots were left.
            None if !robots.lost().is_empty() => {}
            // The record belongs to the hall of the searching robot. For the other robots, only the positions are
            // stored.
            other_hall => {
                elsewhere = other_hall.is_some();
                robots.put_down();
            }
        }
        Ok(DataFolder {
            store,
            archive,
            recalled,
            elsewhere,
            is_unread,
            are_tests_known: true,
            stops: Some(Stops::open(folder)),
            notes,
        })
    }

    /// The present epoch: the epoch of the last STOP, even if this STOP did not reach the journal (safety S4).
    pub(super) fn epoch(&self) -> Epoch {
        let recorded = self.recalled.as_ref().map_or(Epoch::default(), |recalled| recalled.state.epoch);
        let stopped = self.stops.as_ref().map_or(Epoch::default(), Stops::epoch);
        if self.stop_in_doubt().is_some() {
            return stopped.max(recorded).next();
        }
        if stopped > recorded {
            tracing::warn!(
                epoch = stopped.0,
                "the last STOP is not in the journal, but it still counts: the robot stays halted until START"
            );
        }
        stopped.max(recorded)
    }

    /// Returns a message if the last STOP may be missing from the records. The robot is then held as after a STOP.
    pub(super) fn stop_in_doubt(&self) -> Option<String> {
        let (file, was_set_aside) = self.stops.as_ref().and_then(Stops::damaged)?;
        let aside = format!("; the damaged content is now in {} in the same folder", names::STOPS_DAMAGED.written());
        Some(format!(
            "{} was damaged, and hallsweep begins a new file{}. The robot is halted as if by STOP, because the last STOP may be \
             missing: press START to continue",
            file.display(),
            if was_set_aside { &aside } else { "" }
        ))
    }
}

/// Archives old missions if the settings limit the number of days that missions stay. This happens before any door is
/// open, because no answer of a door may wait for archiving. A bounded number is archived at once. After a failure
/// the missions stay, and the reason is returned.
pub(super) fn write_out_old(settings: &HallSettings) -> Option<String> {
    const DAY_MS: i64 = 24 * 60 * 60 * 1000;
    let folder = settings.folder.as_deref().filter(|folder| folder.is_dir() && settings.keep_days > 0)?;
    let now = Clock::default().now().wall;
    let before = WallTime { unix_ms: now.unix_ms - i64::from(settings.keep_days) * DAY_MS, ..now };
    match sqlite::write_out_at_start(folder, before, now) {
        Ok(None) => None,
        Ok(Some(Archived { what, left, .. })) => {
            let (first, last) = what.missions;
            let file = what.file;
            tracing::info!(%first, %last, file, left, "old missions were moved to an archive; the next starts move those that \
                                                       are left");
            None
        }
        Err(error) => Some(format!("old missions stay in the journal, because they could not be archived: {error}")),
    }
}

fn in_another_hall(folder: &Path, remembered: &str, given: &str) -> String {
    let robot = names::SIMULATED.within(folder);
    format!(
        "a mission is under way in another hall: the record in {} is for the hall {remembered}, not for {given}; start hallsweep \
         again with --hall {remembered}, or choose another folder for {given} with --data DIR; if the hall {remembered} does not \
         exist any more, move {} away, start hallsweep again, and press RESET",
        folder.display(),
        robot.display()
    )
}

/// Marks lost photos as failed: a pending piece of luggage cannot be judged by a photo that is lost (safety V2).
fn without_lost_photos(mut recalled: Recalled, archive: &dyn Archive) -> Recalled {
    let pending: Vec<Arc<Luggage>> = recalled.state.luggage.pending().filter(|luggage| luggage.has_photo()).cloned().collect();
    for luggage in pending {
        let words = match archive.photo(luggage.id) {
            Ok(Some(_)) => continue,
            Ok(None) => "the photo is missing from the record".to_owned(),
            Err(unreadable) => unreadable.to_string(),
        };
        tracing::error!(luggage = luggage.id.0, words, "a photo is lost: take it again");
        recalled.state.luggage.change(luggage.id, |luggage| luggage.photo = PhotoState::Failed(words));
    }
    recalled
}
