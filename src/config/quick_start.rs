//! The quick start with several halls, `--hall a.toml --hall b.yaml`: the first is the default hall, and each has the name
//! of its file.

use std::path::Path;

use super::environment::Flag;
use super::error::SettingsError;
use super::given::{Given, Place};
use super::key::{HALLS, hall_name};
use hallsweep_core::hall::HallId;

const HALL: &str = "--hall";

/// Flags that are refused beside several halls: a start cell and test pieces are chosen for one hall.
const OF_ONE_HALL: [&str; 2] = ["--start", "--exercise"];

const IN_A_FILE: &str = "name the halls in a settings file, with [halls.NAME] for each further hall, and start with --config";

/// The settings that the flags mean. `others` are the settings of the lower layers.
pub(super) fn given(flags: &[Flag], others: &[Given]) -> Result<Vec<Given>, SettingsError> {
    let are_several = flags.iter().filter(|flag| flag.flag == HALL).count() > 1;
    let names_halls = |given: &&Given| given.place != Place::Defaults && given.written.split('.').next() == Some(HALLS);
    if let Some(other) = others.iter().find(names_halls).filter(|_| are_several) {
        let problem = format!("{HALL} is given several times, and names the halls too");
        return Err(other.wrong(problem, "name the halls in one of the two places"));
    }
    let (mut all, mut names) = (Vec::new(), Vec::new());
    for flag in flags {
        let given = |key: String, value: &str| Given::text(Place::Flags, format!("flag {}", flag.flag), key, value);
        let as_usual = given(flag.key.to_owned(), &flag.value)?;
        if are_several && OF_ONE_HALL.contains(&flag.flag) {
            return Err(as_usual.wrong(format!("{HALL} is given several times, and this flag is for one hall"), IN_A_FILE));
        }
        if !are_several || flag.flag != HALL {
            all.push(as_usual);
            continue;
        }
        let Some(name) = name(&flag.value) else {
            let problem = "its name has no small letter at the beginning, or is too long to be the name of a hall";
            return Err(as_usual.wrong(problem.to_owned(), IN_A_FILE));
        };
        if names.contains(&name) {
            return Err(as_usual.wrong(format!("another hall has the name {name} already"), IN_A_FILE));
        }
        if names.is_empty() {
            all.extend([as_usual, given(format!("{HALLS}.default"), name.name())?]);
        } else {
            all.push(given(format!("{HALLS}.{name}.hall.file"), &flag.value)?);
        }
        names.push(name);
    }
    Ok(all)
}

/// The name for the hall of this file, or for this built-in hall: `Gate 3.toml` becomes `gate-3`.
fn name(file: &str) -> Option<HallId> {
    let stem = Path::new(file).file_stem()?.to_str()?.to_lowercase();
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '-' };
    hall_name(stem.chars().map(plain).collect::<String>().trim_matches('-'))
}
