//! The seed of an exercise, which says where its test pieces stand. It is kept in the data folder, so that a restart
//! continues the same exercise. A mission never changes between exercise and reality, so some starts are refused.

use std::path::Path;

use super::AppError;
use super::data_folder::DataFolder;
use crate::access;
use crate::config::{Exercise, HallSettings};
use crate::storage::names;
use crate::storage::small_file::SmallFile;
use crate::storage::sqlite::ReadOnlyJournal;
use hallsweep_core::state::PersistentState;

/// Maximum size of the file in bytes: two numbers with their names.
const MOST: usize = 256;

/// Returns the settings with the seed of the exercise: the kept one while the exercise may be under way, otherwise the
/// given one, or one that nobody can guess.
pub(super) fn settled(settings: &HallSettings) -> Result<HallSettings, AppError> {
    let mut settled = settings.clone();
    let Some(exercise) = &settings.exercise else { return Ok(settled) };
    let folder = settings.folder.as_deref().unwrap_or(Path::new(""));
    let is_same = |kept: &Exercise| kept.pieces == exercise.pieces && (exercise.seed.is_none() || exercise.seed == kept.seed);
    let kept = kept(folder).filter(|kept| is_same(kept) && !is_idle(folder));
    settled.robot.seed = kept.map_or(exercise.seed, |kept| kept.seed).map_or_else(drawn, Ok)?;
    Ok(settled)
}

/// Whether the journal says that no mission is under way. A journal that cannot be read now may be put back, so its
/// exercise must not change.
fn is_idle(folder: &Path) -> bool {
    let missions = ReadOnlyJournal::open(folder).and_then(|journal| journal.archive().missions(None, 1));
    missions.is_ok_and(|missions| missions.iter().all(|mission| mission.archived.is_some()))
}

/// Refuses to mix exercise and reality, now that the journal was recalled, and keeps the settled seed. Returns whether
/// the test pieces are known.
pub(super) fn check(settings: &HallSettings, data: &DataFolder) -> Result<bool, AppError> {
    let Some(folder) = &settings.folder else { return Ok(true) };
    let state = data.recalled.as_ref().map(|recalled| &recalled.state).filter(|state| state.under_way);
    let is_exercise = |state: &PersistentState| state.conditions.as_ref().is_some_and(|conditions| conditions.venue.is_exercise);
    let present = state.map(|state| (state.mission, is_exercise(state)));
    let kept = kept(folder);
    let is_kept = |given: &Exercise, kept: &Exercise| given.pieces == kept.pieces && kept.seed == Some(settings.robot.seed);
    match (present, &settings.exercise, &kept) {
        (None | Some((_, false)), None, _) => return Ok(true),
        (Some((mission, false)), Some(_), _) => return Err(AppError::MissionNoExercise(mission, folder.clone())),
        (Some((mission, true)), Some(given), None) => {
            return given.seed.map(|_| false).ok_or_else(|| AppError::ExerciseLost(mission, folder.clone()));
        }
        (Some((_, true)), Some(given), Some(kept)) if is_kept(given, kept) => {}
        (Some((mission, true)), _, _) => {
            let pieces = kept.map_or_else(|| "NUMBER".to_owned(), |kept| kept.pieces.to_string());
            return Err(AppError::MissionExercise(mission, folder.clone(), pieces));
        }
        (None, Some(_), _) if data.is_unread => {}
        (None, Some(given), _) => {
            let text = format!("pieces {}\nseed {}\n", given.pieces, settings.robot.seed);
            SmallFile::within(folder, names::EXERCISE).make(text.as_bytes()).map_err(AppError::System)?;
        }
    }
    Ok(true)
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
