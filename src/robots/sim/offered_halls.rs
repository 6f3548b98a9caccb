//! The halls that are offered by name. The robots can be moved into these halls, and the editor can start from them.

use std::path::Path;

use super::kept_halls::{KeptHalls, fitting};
use crate::runtime::simulator::{NotSimulated, is_hall_name};
use hallsweep_sim::Hall;

/// The halls that can be chosen by name: the built-in halls, the file in the settings under its own name, and the stored halls.
#[derive(Debug)]
pub(super) struct Offered {
    always: Vec<Always>,
    kept: KeptHalls,
}

#[derive(Debug)]
struct Always {
    name: String,
    /// A built-in name, or a path.
    hall: String,
    start: Option<(u32, u32)>,
}

impl Offered {
    pub(super) fn with(usual: &str, start: Option<(u32, u32)>, data: Option<&Path>) -> Offered {
        let built_in = |name: &str| {
            let start = start.filter(|_| name == usual);
            Always { name: name.to_owned(), hall: name.to_owned(), start }
        };
        let mut halls: Vec<_> = Hall::builtin_names().map(built_in).collect();
        let stem = Path::new(usual).file_stem().map(|stem| stem.to_string_lossy().into_owned());
        // The name is part of web addresses.
        let is_plain = |name: &String| name.chars().all(|letter| letter.is_ascii_alphanumeric() || "-_.".contains(letter));
        let is_known = |name: &str| halls.iter().any(|known| known.name == name);
        if !is_known(usual) {
            let name = stem.filter(|name| is_plain(name) && !is_known(name)).unwrap_or_else(|| "hall-of-the-settings".to_owned());
            halls.push(Always { name, hall: usual.to_owned(), start });
        }
        Offered { always: halls, kept: KeptHalls::within(data) }
    }

    pub(super) fn names(&self) -> Vec<String> {
        self.always.iter().map(|always| always.name.clone()).chain(self.kept()).collect()
    }

    pub(super) fn kept(&self) -> Vec<String> {
        self.kept.names().into_iter().filter(|name| !self.is_always(name)).collect()
    }

    fn is_always(&self, name: &str) -> bool {
        self.always.iter().any(|known| known.name == name)
    }

    pub(super) fn named(&self, name: &str) -> Result<Hall, NotSimulated> {
        if let Some(Always { hall, start, .. }) = self.always.iter().find(|known| known.name == name) {
            let hall = Hall::named_or_file(hall).map_err(|error| NotSimulated::Hall(error.to_string()))?;
            let started = start.map_or_else(|| Ok(hall.clone()), |start| hall.clone().starting_at(start));
            return started.map_err(|fault| NotSimulated::Hall(fault.to_string())).and_then(fitting);
        }
        self.kept.read(name).unwrap_or_else(|| {
            let known = self.names().join(", ");
            Err(NotSimulated::Hall(format!("the simulator has no hall {name:?}; it has {known}")))
        })
    }

    pub(super) fn keep(&self, name: &str, hall: &Hall, may_replace: bool) -> Result<(), NotSimulated> {
        if !is_hall_name(name) {
            Err(NotSimulated::NotAName(name.chars().take(80).collect()))
        } else if self.is_always(name) {
            Err(NotSimulated::NameTaken(name.to_owned()))
        } else {
            self.kept.keep(name, hall, may_replace)
        }
    }

    pub(super) fn discard(&self, name: &str) -> Result<(), NotSimulated> {
        // If another hall has the same name, the stored hall is hidden and is not deleted.
        if self.is_always(name) {
            return Err(NotSimulated::NotThere(name.to_owned()));
        }
        self.kept.discard(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::storage::tests::scratch::Scratch;

    #[test]
    fn the_hall_of_the_settings_is_offered_by_a_name_of_its_own() {
        let last = |usual: &str| Offered::with(usual, None, None).names().pop();
        assert_eq!(Offered::with("airport", None, None).names().len(), Hall::builtin_names().count());
        assert_eq!(last("halls/depot.yaml").as_deref(), Some("depot"));
        for other in ["my/airport.toml", "halls/a b.toml", ".."] {
            assert_eq!(last(other).as_deref(), Some("hall-of-the-settings"), "{other}");
        }
        let gone = Offered::with("halls/depot.yaml", None, None).named("depot").expect_err("it is not there").to_string();
        assert!(gone.contains("halls/depot.yaml"), "{gone}");
    }

    #[test]
    fn a_hall_is_kept_under_a_name_that_no_other_has() {
        let folder = Scratch::new();
        let hall = Hall::named_or_file("seed").expect("it is built in");
        let halls = Offered::with("halls/depot.yaml", None, Some(&folder.0));
        for taken in ["airport", "depot"] {
            assert_eq!(halls.keep(taken, &hall, true), Err(NotSimulated::NameTaken(taken.to_owned())));
        }
        let long = "a".repeat(41);
        for name in ["", "-a", "a b", "A", "../a", "a/b", "a.b", "è", &long] {
            assert_eq!(halls.keep(name, &hall, true), Err(NotSimulated::NotAName(name.to_owned())), "{name}");
        }
        halls.keep("mine-2", &hall, false).expect("it is a name");
        assert_eq!(halls.keep("mine-2", &hall, false), Err(NotSimulated::AnotherKept("mine-2".to_owned())));
        assert_eq!((halls.names().pop().as_deref(), halls.kept()), (Some("mine-2"), vec!["mine-2".to_owned()]));
        assert_eq!(halls.named("mine-2"), Ok(hall));
        let later = Offered::with("halls/mine-2.toml", None, Some(&folder.0));
        assert!(later.kept().is_empty() && later.named("mine-2").is_err(), "the settings' own has the name now");
        assert_eq!(later.discard("mine-2"), Err(NotSimulated::NotThere("mine-2".to_owned())));
        assert_eq!(Offered::with("seed", None, Some(&folder.0)).kept(), ["mine-2"], "it is there still");
    }
}
