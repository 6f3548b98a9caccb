//! What earlier runs left behind, and where this one is kept: the journal, and the memory of the simulated robot beside it.
//! What is done with what was recalled is the core's business.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::AppError;
use crate::config::Settings;
use crate::robots::sim::{SimStateFile, StateFileError};
use crate::runtime::archive::Archive;
use crate::runtime::store::Store;
use crate::storage::sqlite::{self, MemoryStore};
use crate::storage::stops::Stops;
use hallsweep_core::engine::Recalled;
use hallsweep_core::units::Epoch;
use hallsweep_core::world::luggage::{Luggage, PhotoState};
use hallsweep_sim::{Hall, Sim, SimMemory, SimSettings};

/// What became of looking for the robot's state file.
type Found = Result<(SimStateFile, Option<SimMemory>), StateFileError>;

/// Where everything is kept, and what was there.
pub(super) struct DataFolder {
    pub(super) store: Box<dyn Store>,
    pub(super) archive: Arc<dyn Archive>,
    pub(super) recalled: Option<Recalled>,
    /// Whether the robot was put down at home in another hall than before.
    pub(super) elsewhere: bool,
    /// What remembers a STOP also when the journal cannot be written.
    pub(super) stops: Option<Stops>,
    /// Whether there may be a record that could not be read.
    is_unread: bool,
    /// Why nobody knows where the robot is.
    lost: Option<String>,
    state_file: Option<SimStateFile>,
    memory: Option<SimMemory>,
}

impl DataFolder {
    /// Opens the folder of the settings. A file of it that cannot be read or written is no error: the store says so, and the robot
    /// is held (safety R5): so also when the keys cannot be had, which is said by `keys`. A folder in use, or a mission in another
    /// hall, is one.
    pub(super) fn open(settings: &Settings, hall: &Hall, keys: Option<String>) -> Result<DataFolder, AppError> {
        let Some(folder) = &settings.store else { return Ok(DataFolder::nowhere()) };
        let found = SimStateFile::open(folder, hall);
        let lost =
            found.as_ref().err().filter(|error| !matches!(error, StateFileError::OtherHall { .. })).map(ToString::to_string);
        let beside: Vec<String> = [lost.clone(), Stops::unusable(folder), keys].into_iter().flatten().collect();
        let beside = (!beside.is_empty()).then(|| beside.join("; and "));
        let sqlite::Opened { store, archive, recalled, failure } = sqlite::open(folder, beside)?;
        let is_unread = failure.is_some() && recalled.is_none();
        let recalled = recalled.map(|recalled| without_lost_photos(recalled, &*archive));
        let mut kept = DataFolder {
            store,
            archive,
            recalled,
            elsewhere: false,
            stops: None,
            is_unread,
            lost,
            state_file: None,
            memory: None,
        };
        kept.find_robot(found, folder, hall)?;
        kept.stops = Some(Stops::open(folder));
        Ok(kept)
    }

    /// The epoch that holds: that of the last stop, whether or not the journal came to know of it (safety S4).
    pub(super) fn epoch(&self) -> Epoch {
        let recorded = self.recalled.as_ref().map_or(Epoch::default(), |recalled| recalled.standing.epoch);
        let stopped = self.stops.as_ref().map_or(Epoch::default(), Stops::epoch);
        if self.stop_in_doubt().is_some() {
            return recorded.next();
        }
        if stopped > recorded {
            tracing::warn!(epoch = stopped.0, "the last STOP did not get into the journal: it holds the robot still");
        }
        stopped.max(recorded)
    }

    /// What is said when nobody knows whether the last STOP is on record: then the robot is held as by one.
    pub(super) fn stop_in_doubt(&self) -> Option<String> {
        let damaged = self.stops.as_ref().and_then(Stops::damaged)?;
        Some(format!(
            "{} was damaged and is begun anew: whether STOP was pressed last is not known, so the robot is held as by a STOP",
            damaged.display()
        ))
    }

    /// The robot where it was left, and the state file in which it goes on writing.
    ///
    /// # Errors
    /// Why nobody knows where it is.
    pub(super) fn robot(&mut self, hall: Arc<Hall>, sim: SimSettings) -> Result<(Sim, Option<SimStateFile>), String> {
        if let Some(lost) = self.lost.take() {
            return Err(lost);
        }
        let robot = match self.memory.take() {
            Some(memory) => Sim::remembering(hall, sim, memory),
            None => Sim::new(hall, sim),
        };
        Ok((robot, self.state_file.take()))
    }

    fn nowhere() -> DataFolder {
        let store = MemoryStore::new();
        DataFolder {
            archive: store.archive(),
            store: Box::new(store),
            recalled: None,
            elsewhere: false,
            stops: None,
            is_unread: false,
            lost: None,
            state_file: None,
            memory: None,
        }
    }

    fn find_robot(&mut self, found: Found, folder: &Path, hall: &Hall) -> Result<(), AppError> {
        let (state_file, memory) = match found {
            Ok(opened) => opened,
            // What nobody could read may be a mission in that hall: its robot is not forgotten.
            Err(StateFileError::OtherHall { .. }) if self.is_unread => return Ok(()),
            Err(StateFileError::OtherHall { .. }) if !self.is_on_a_mission() => {
                self.elsewhere = true;
                (SimStateFile::begin_anew(folder, hall), None)
            }
            Err(StateFileError::OtherHall { remembered, .. }) => {
                return Err(AppError::OtherHall { folder: PathBuf::from(folder), remembered, given: hall.name().to_owned() });
            }
            // It is `lost`.
            Err(_) => return Ok(()),
        };
        (self.state_file, self.memory) = (Some(state_file), memory);
        Ok(())
    }

    fn is_on_a_mission(&self) -> bool {
        self.recalled.as_ref().is_some_and(|recalled| recalled.standing.phase.is_mission())
    }
}

/// A pending piece whose picture is gone cannot be judged by it: it counts as one whose photo failed (safety V2).
fn without_lost_photos(mut recalled: Recalled, archive: &dyn Archive) -> Recalled {
    for luggage in recalled.standing.luggage.values_mut().filter(|luggage| luggage.is_pending() && luggage.has_photo()) {
        let words = match archive.photo(luggage.id) {
            Ok(Some(_)) => continue,
            Ok(None) => "the photo is gone from the record".to_owned(),
            Err(unreadable) => unreadable.to_string(),
        };
        tracing::error!(luggage = luggage.id.0, words, "a photo is lost: take it again");
        *luggage = Arc::new(Luggage { photo: PhotoState::Failed(words), ..Luggage::clone(luggage) });
    }
    recalled
}
