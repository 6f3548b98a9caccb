//! What earlier runs left behind, and where this one is kept: the journal, and the memory of the simulated robot beside it.
//! What is done with what was recalled is the core's business.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::AppError;
use crate::config::Settings;
use crate::core::sweep::Recalled;
use crate::core::units::Epoch;
use crate::core::world::luggage::{Luggage, PhotoState};
use crate::outbound::robot::sim::{Diary, DiaryError, Hall, Sim, SimMemory, SimSettings};
use crate::outbound::store::memory::Memory;
use crate::outbound::store::sqlite;
use crate::outbound::store::stops::Stops;
use crate::runtime::archive::Archive;
use crate::runtime::store::Store;

/// Where everything is kept, and what was there.
pub(super) struct Kept {
    pub(super) store: Box<dyn Store>,
    pub(super) archive: Arc<dyn Archive>,
    pub(super) recalled: Option<Recalled>,
    /// Whether the robot was put down at home in another hall than before.
    pub(super) elsewhere: bool,
    /// What remembers a STOP also when the journal cannot be written.
    pub(super) stops: Option<Stops>,
    /// Whether there may be a record that could not be read.
    is_unread: bool,
    diary: Option<Diary>,
    memory: Option<SimMemory>,
}

impl Kept {
    /// Opens the folder of the settings. A record that cannot be read or written is no error: the store says so, and the robot
    /// is held. A folder in use, or a robot of which nobody knows where it is, is one.
    pub(super) fn open(settings: &Settings, hall: &Hall) -> Result<Kept, AppError> {
        let Some(folder) = &settings.store else { return Ok(Kept::nowhere()) };
        let sqlite::Opened { store, archive, recalled, failure } = sqlite::open(folder)?;
        let is_unread = failure.is_some() && recalled.is_none();
        let recalled = recalled.map(|recalled| without_lost_photos(recalled, &*archive));
        let mut kept = Kept { store, archive, recalled, elsewhere: false, stops: None, is_unread, diary: None, memory: None };
        kept.find_robot(folder, hall)?;
        kept.stops = Some(Stops::open(folder));
        Ok(kept)
    }

    /// The epoch that holds: that of the last stop, whether or not the journal came to know of it (safety S4).
    pub(super) fn epoch(&self) -> Epoch {
        let recorded = self.recalled.as_ref().map_or(Epoch::default(), |recalled| recalled.standing.epoch);
        let stopped = self.stops.as_ref().map_or(Epoch::default(), Stops::epoch);
        if stopped > recorded {
            tracing::warn!(epoch = stopped.0, "the last STOP did not get into the journal: it holds the robot still");
        }
        stopped.max(recorded)
    }

    /// The robot where it was left, and the diary in which it goes on writing.
    pub(super) fn robot(&mut self, hall: Arc<Hall>, sim: SimSettings) -> (Sim, Option<Diary>) {
        let robot = match self.memory.take() {
            Some(memory) => Sim::remembering(hall, sim, memory),
            None => Sim::new(hall, sim),
        };
        (robot, self.diary.take())
    }

    fn nowhere() -> Kept {
        let memory = Memory::new();
        let archive = Arc::new(memory.clone());
        Kept {
            store: Box::new(memory),
            archive,
            recalled: None,
            elsewhere: false,
            stops: None,
            is_unread: false,
            diary: None,
            memory: None,
        }
    }

    fn find_robot(&mut self, folder: &Path, hall: &Hall) -> Result<(), AppError> {
        let (diary, memory) = match Diary::open(folder, hall) {
            Ok(opened) => opened,
            // What nobody could read may be a mission in that hall: its robot is not forgotten.
            Err(DiaryError::OtherHall { .. }) if self.is_unread => return Ok(()),
            Err(DiaryError::OtherHall { .. }) if !self.is_on_a_mission() => {
                self.elsewhere = true;
                (Diary::begin_anew(folder, hall), None)
            }
            Err(DiaryError::OtherHall { remembered, .. }) => {
                return Err(AppError::OtherHall { folder: PathBuf::from(folder), remembered, given: hall.name().to_owned() });
            }
            Err(error) => return Err(error.into()),
        };
        (self.diary, self.memory) = (Some(diary), memory);
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
