//! The halls of the program. The settings of the top level, with those in `[halls.NAME]` of its name, are the default
//! hall; every other `[halls.NAME]` is a further hall, with the settings of the top level where it has none of its own.

use std::path::PathBuf;

use super::check;
use super::error::SettingsError;
use super::key::{GROUP, hall_name};
use super::layers::{AllGiven, Layers};
use super::reading::read;
use super::{HallSettings, Settings, robots};
use hallsweep_core::hall::HallId;

/// Maximum number of halls. All halls share the threads of the engines and of the robots' links, on which a STOP reaches
/// each robot before anything else (safety S7).
pub const MOST_HALLS: usize = 128;

impl Settings {
    /// All halls, the default hall first.
    pub fn halls(&self) -> impl Iterator<Item = &HallSettings> {
        std::iter::once(&self.hall).chain(&self.further_halls)
    }
}

/// The default hall and the further halls. The data of the default hall is stored in `store`, and the data of a further
/// hall in a folder within it.
pub(super) fn halls(
    all: &AllGiven,
    top: &Layers,
    store: Option<&PathBuf>,
) -> Result<(HallSettings, Vec<HallSettings>), SettingsError> {
    let mut further = all.halls();
    let default = default(top, further.iter().find(|name| **name != HallId::main()))?;
    further.remove(&default);
    if let Some(last) = further.last().filter(|_| further.len() >= MOST_HALLS) {
        let advice = format!("configure at most {MOST_HALLS} halls, and run another hallsweep for the others");
        return Err(all.first_of(last).wrong(format!("there are {} halls", further.len() + 1), &advice));
    }
    let layers = all.of_the_default(&default);
    let hall = check::hall(&layers, default, store.cloned())?;
    let mut halls = vec![(layers, hall)];
    for name in further {
        let layers = all.of_a_further(&name);
        let folder = store.map(|store| store.join(format!("hall-{name}")));
        let hall = check::hall(&layers, name, folder)?;
        halls.push((layers, hall));
    }
    robots::check_apart(&halls)?;
    let mut halls = halls.into_iter().map(|(_, hall)| hall);
    let default = halls.next().expect("the default hall is first");
    Ok((default, halls.collect()))
}

/// The name of the default hall. Beside a further hall it must be given, because addresses without the name of a hall
/// mean the default hall, and must not change when a hall is added.
fn default(top: &Layers, further: Option<&HallId>) -> Result<HallId, SettingsError> {
    let key = "halls.default";
    let name: String = read(top, key)?;
    if !name.is_empty() {
        return hall_name(&name).ok_or_else(|| top.wrong(key, "no hall can have this name"));
    }
    match further {
        Some(further) => Err(top.wrong(key, format!("there is a further hall, {further}, so the other one needs a name too"))),
        None => Ok(HallId::main()),
    }
}

pub(super) fn group(layers: &Layers) -> Result<Option<HallId>, SettingsError> {
    let Some(_) = layers.value(GROUP) else { return Ok(None) };
    let name: String = read(layers, GROUP)?;
    HallId::new(&name).map(Some).ok_or_else(|| layers.wrong(GROUP, "no group can have this name"))
}

#[cfg(test)]
#[path = "halls_tests.rs"]
mod tests;
