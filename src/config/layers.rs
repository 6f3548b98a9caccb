//! Merges the layers of settings, and remembers the origin of each value. `check` decides whether a value is usable.
//!
//! ```text
//!   flags                    --speed max
//!   environment              HALLSWEEP__ROBOT__SPEED=max
//!   the file of --config     [robot] speed = "max"
//!   config/default.toml      [robot] speed = 1            always complete
//! ```
//! `[robots.discovery]` is another name of `[robot]`, and is renamed to `[robot]` first. Every other `[robots.NAME]` is a
//! further robot, merged with the defaults of `[robot]`. Settings in `[halls.NAME]` of all layers are merged over all
//! others, for this hall alone.

use std::collections::{BTreeMap, BTreeSet};
use std::rc::Rc;

use figment::value::Value;

use super::environment::{Flag, Sources};
use super::error::SettingsError;
use super::given::{Given, Place, written};
use super::key::{HALLS, Key, ROBOT, ROBOTS, of_a_hall};
use super::{file, quick_start};
use hallsweep_core::hall::HallId;

impl Flag {
    pub(crate) fn given(flag: &'static str, value: String) -> Flag {
        let key = Key::of_flag(flag).expect("every flag of a setting is in the table, as a test of each command shows");
        Flag { flag, key: key.name, value }
    }

    /// The two settings that `--robot KIND[=ADDRESS]` sets. Without an address, the default address of this kind is
    /// used, even if a settings file has another one.
    pub(crate) fn robot(value: &str) -> [Flag; 2] {
        let (kind, address) = value.split_once('=').unwrap_or((value, ""));
        [("robot.kind", kind), ("robot.address", address)].map(|(key, value)| Flag {
            flag: "--robot",
            key,
            value: value.to_owned(),
        })
    }
}

/// All settings that were given, the lowest layer first.
pub(super) struct AllGiven(Vec<Rc<Given>>);

/// The settings that apply to the whole program or to one hall, after merging.
pub(super) struct Layers {
    merged: BTreeMap<String, Rc<Given>>,
    /// The first setting of each further robot.
    further: BTreeMap<String, Rc<Given>>,
    /// A further hall, whose own settings are in `[halls.NAME]`.
    hall: Option<HallId>,
}

impl AllGiven {
    pub(super) fn gather(sources: &Sources) -> Result<AllGiven, SettingsError> {
        let mut all = Given::defaults();
        if let Some(path) = &sources.file {
            all.extend(file::read(path)?);
        }
        for (name, value) in &sources.environment {
            all.extend(Given::variable(name, value)?);
        }
        let flags = quick_start::given(&sources.flags, &all)?;
        all.extend(flags);
        check_said_once(&all)?;
        Ok(AllGiven(all.into_iter().map(Rc::new).collect()))
    }

    /// The halls that have settings of their own.
    pub(super) fn halls(&self) -> BTreeSet<HallId> {
        self.0.iter().filter_map(|given| given.hall.clone()).collect()
    }

    /// The first setting of a hall that has settings of its own.
    pub(super) fn first_of(&self, hall: &HallId) -> &Given {
        self.0.iter().find(|given| given.hall.as_ref() == Some(hall)).expect("it is one of `halls`")
    }

    /// The settings of the whole program.
    pub(super) fn of_the_program(&self) -> Layers {
        self.merged(None, None)
    }

    /// The settings of the default hall: those of the top level, and over them its own.
    pub(super) fn of_the_default(&self, hall: &HallId) -> Layers {
        self.merged(Some(hall), None)
    }

    pub(super) fn of_a_further(&self, hall: &HallId) -> Layers {
        self.merged(Some(hall), Some(hall.clone()))
    }

    fn merged(&self, own: Option<&HallId>, hall: Option<HallId>) -> Layers {
        let top = self.0.iter().filter(|given| given.hall.is_none());
        let own = self.0.iter().filter(|given| given.hall.is_some() && given.hall.as_ref() == own);
        let (mut merged, mut further) = (BTreeMap::new(), BTreeMap::new());
        for given in top.chain(own) {
            if let Some(robot) = given.key.strip_prefix(ROBOTS).and_then(|rest| rest.strip_prefix('.')) {
                let name = robot.split('.').next().unwrap_or_default();
                further.entry(name.to_owned()).or_insert_with(|| given.clone());
            }
            merged.insert(given.key.clone(), given.clone());
        }
        for given in self.0.iter().take_while(|given| given.place == Place::Defaults) {
            // A further robot has no default kind: the user must give it, so that a mistyped name does not create a robot.
            let Some(own) = given.key.strip_prefix(ROBOT).filter(|own| own.starts_with('.') && *own != ".kind") else { continue };
            for robot in further.keys() {
                merged.entry(format!("{ROBOTS}.{robot}{own}")).or_insert_with(|| given.clone());
            }
        }
        Layers { merged, further, hall }
    }
}

impl Layers {
    pub(super) fn further_robots(&self) -> impl ExactSizeIterator<Item = &str> {
        self.further.keys().map(String::as_str)
    }

    pub(super) fn value(&self, key: &str) -> Option<&Value> {
        self.merged.get(key).map(|given| &given.value)
    }

    pub(super) fn wrong(&self, key: &str, problem: impl Into<String>) -> SettingsError {
        let advice = Key::named(&self.as_written(key)).map_or("see config/default.toml", |key| key.advice);
        self.wrong_with_advice(key, problem, advice)
    }

    pub(super) fn wrong_with_advice(&self, key: &str, problem: impl Into<String>, advice: &str) -> SettingsError {
        let (name, mut problem, mut advice) = (self.as_written(key), problem.into(), advice.to_owned());
        if let Some(hall) = self.hall.as_ref().filter(|_| of_a_hall(&name).is_none()) {
            // The value may be right for other halls.
            problem = format!("for the hall {hall}, {problem}");
            advice = format!("{advice}; {HALLS}.{hall}.{key} sets it for this hall alone");
        }
        let value = self.value(key).map_or_else(|| "nothing".to_owned(), written);
        SettingsError::Wrong { key: name, value, origin: self.origin(key), problem, advice }
    }

    /// Like `wrong`, but does not show the value, because it may contain a password.
    pub(super) fn wrong_unseen(&self, key: &str, problem: impl Into<String>) -> SettingsError {
        let mut error = self.wrong(key, problem);
        if let SettingsError::Wrong { value, .. } = &mut error {
            *value = "(not shown)".to_owned();
        }
        error
    }

    pub(super) fn is_chosen(&self, key: &str) -> bool {
        self.merged.get(key).is_none_or(|given| given.place != Place::Defaults)
    }

    pub(super) fn origin(&self, key: &str) -> String {
        let given = self.merged.get(key).or_else(|| self.robot(key));
        given.map_or_else(|| "an unknown place".to_owned(), |given| given.origin.clone())
    }

    /// The origin of a setting in words: a flag, an environment variable, or a setting in a file. Only for a file the
    /// name of the setting is added.
    pub(super) fn as_given(&self, key: &str) -> String {
        let origin = self.origin(key);
        if origin.starts_with("file ") { format!("{} in {origin}", self.as_written(key)) } else { origin }
    }

    /// The first setting of the further robot whose setting `key` is.
    fn robot(&self, key: &str) -> Option<&Rc<Given>> {
        self.further.get(key.strip_prefix(ROBOTS)?.strip_prefix('.')?.split('.').next()?)
    }

    /// The full name of a setting: as it was written, or as it can be written.
    fn as_written(&self, key: &str) -> String {
        if let Some(given) = self.merged.get(key).filter(|given| given.place != Place::Defaults) {
            return given.written.clone();
        }
        let of_its_robot = self.robot(key).and_then(|given| given.hall.as_ref());
        self.hall.as_ref().or(of_its_robot).map_or_else(|| key.to_owned(), |hall| format!("{HALLS}.{hall}.{key}"))
    }
}

/// Refuses a setting of the searching robot that one layer has twice: in `[robot]` and in `[robots.discovery]`.
fn check_said_once(all: &[Given]) -> Result<(), SettingsError> {
    for given in all.iter().filter(|given| given.is_by_name()) {
        let same = |other: &&Given| {
            let is_same = other.place == given.place && other.hall == given.hall && other.key == given.key;
            is_same && other.key != ROBOT && !other.is_by_name()
        };
        if let Some(other) = all.iter().find(same) {
            let problem = format!("{} means the same setting, and is set too (from {})", other.written, other.origin);
            return Err(given.wrong(problem, "set only one of the two"));
        }
    }
    Ok(())
}
