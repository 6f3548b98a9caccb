//! The seed of an exercise, which says where its test pieces stand. It is kept in the data folder, so that a restart
//! continues the same exercise. A mission never changes between exercise and reality, so some starts are refused.

use std::path::Path;

use super::AppError;
use super::data_folder::DataFolder;
use crate::access;
use crate::config::{Exercise, Settings};
use crate::storage::names;
use crate::storage::small_file::SmallFile;
use crate::storage::sqlite::ReadOnlyJournal;
use hallsweep_core::state::PersistentState;
use hallsweep_core::units::MissionId;

/// Maximum size of the file in bytes: two numbers with their names.
const MOST: usize = 256;

/// Returns the settings with the seed of the exercise: the kept one while the exercise is under way, otherwise the given
/// one, or one that nobody can guess.
pub(super) fn settled(settings: &Settings) -> Result<Settings, AppError> {
    let mut settled = settings.clone();
    let folder = settings.store.as_deref().unwrap_or(Path::new(""));
    let (present, kept) = (present(folder), kept(folder));
    let is_same =
        |kept: &Exercise, given: &Exercise| kept.pieces == given.pieces && (given.seed.is_none() || given.seed == kept.seed);
    let same = kept.as_ref().zip(settings.exercise.as_ref()).filter(|(kept, given)| is_same(kept, given));
    let same = same.and_then(|(kept, _)| kept.seed);
    let given = settings.exercise.as_ref().and_then(|exercise| exercise.seed);
    settled.robot.seed = match (present, &settings.exercise) {
        (Present::Mission(mission, true), Some(_)) if kept.is_none() => {
            given.ok_or_else(|| AppError::ExerciseLost(mission, folder.to_owned()))?
        }
        (Present::Mission(mission, true), _) => {
            let pieces = kept.map_or_else(|| "NUMBER".to_owned(), |kept| kept.pieces.to_string());
            same.ok_or_else(|| AppError::MissionExercise(mission, folder.to_owned(), pieces))?
        }
        (Present::Mission(mission, false), Some(_)) => return Err(AppError::MissionNoExercise(mission, folder.to_owned())),
        // A journal that cannot be read now may be put back, so its exercise must not change.
        (Present::Unknown, Some(_)) if same.is_some() => same.unwrap_or_default(),
        (Present::Unknown | Present::Nothing, Some(_)) => given.map_or_else(drawn, Ok)?,
        (_, None) => return Ok(settled),
    };
    Ok(settled)
}

/// Refuses to mix exercise and reality, now that the journal was recalled, and keeps the settled seed. `settled`
/// may not have been able to read the journal. Returns whether the test pieces are known.
pub(super) fn check(settings: &Settings, data: &DataFolder) -> Result<bool, AppError> {
    let Some(folder) = &settings.store else { return Ok(true) };
    let state = data.recalled.as_ref().map(|recalled| &recalled.state).filter(|state| state.under_way);
    let is_exercise = |state: &PersistentState| state.conditions.as_ref().is_some_and(|conditions| conditions.venue.is_exercise);
    let present = state.map(|state| (state.mission, is_exercise(state)));
    let kept = kept(folder);
    match (present, &settings.exercise) {
        (Some((mission, false)), Some(_)) => return Err(AppError::MissionNoExercise(mission, folder.clone())),
        (Some((_, true)), Some(_)) if kept.is_none() => return Ok(false),
        (Some((mission, true)), given) => {
            let same = given
                .as_ref()
                .zip(kept.as_ref())
                .filter(|(given, kept)| given.pieces == kept.pieces && kept.seed == Some(settings.robot.seed));
            let pieces = kept.as_ref().map_or_else(|| "NUMBER".to_owned(), |kept| kept.pieces.to_string());
            same.ok_or_else(|| AppError::MissionExercise(mission, folder.clone(), pieces))?;
        }
        (_, None) => return Ok(true),
        // The journal may be put back, and its exercise goes on then.
        (None, Some(_)) if data.is_unread => return Ok(true),
        (None, Some(_)) => {}
    }
    let Some(exercise) = &settings.exercise else { return Ok(true) };
    let text = format!("pieces {}\nseed {}\n", exercise.pieces, settings.robot.seed);
    SmallFile::within(folder, names::EXERCISE).make(text.as_bytes()).map_err(AppError::System)?;
    Ok(true)
}

/// What is under way in a data folder.
enum Present {
    /// The mission, and whether it is an exercise.
    Mission(MissionId, bool),
    Nothing,
    /// There is no journal, or it cannot be read. The start then says what is wrong with it.
    Unknown,
}

fn present(folder: &Path) -> Present {
    let missions = ReadOnlyJournal::open(folder).and_then(|journal| journal.archive().missions(None, 1));
    match missions.map(|missions| missions.into_iter().find(|mission| mission.archived.is_none())) {
        Ok(Some(mission)) => Present::Mission(mission.id, mission.is_exercise),
        Ok(None) => Present::Nothing,
        Err(_) => Present::Unknown,
    }
}

fn kept(folder: &Path) -> Option<Exercise> {
    let bytes = SmallFile::within(folder, names::EXERCISE).read(MOST).ok()??;
    let text = String::from_utf8(bytes).ok()?;
    let number = |name: &str| text.lines().find_map(|line| line.strip_prefix(name)?.trim().parse::<u64>().ok());
    Some(Exercise { pieces: u32::try_from(number("pieces ")?).ok()?, seed: Some(number("seed ")?) })
}

fn drawn() -> Result<u64, AppError> {
    let [a, b, c, d, e, f, g, h, ..] = access::chance()?;
    Ok(u64::from_be_bytes([a, b, c, d, e, f, g, h]))
}
