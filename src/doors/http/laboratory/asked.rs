//! Reads which runs an address of the laboratory requests: a run of the Roomba, or a run of the pallet scenario. The
//! address of the page has the parameters of both runs, so the parameters have different names.

use std::fmt::Write;

use super::super::problem::Problem;
use super::super::query::Query;
use crate::api::fields::in_short;
use hallsweep_laboratory::pallet::{Asked, AskedFault, BeyondError, Mishap, Pallet, asked};
use hallsweep_laboratory::roomba::Roomba;

/// Maximum length of a Roomba run in seconds. After ten minutes the room is full of lines. Computing takes a few
/// milliseconds.
pub(in crate::doors::http) const LONGEST_S: u64 = 600;

/// Default length of a Roomba run in seconds, long enough for spirals and walls.
pub(in crate::doors::http) const USUAL_S: u64 = 120;

/// Maximum number of parcels. It limits the cost of a run.
pub(in crate::doors::http) const MOST_PARCELS: u64 = 4;

pub(in crate::doors::http) const USUAL_PARCELS: u64 = 3;

/// Maximum number of mishaps in one run: twice the number of kinds of mishap.
pub(in crate::doors::http) const MOST_FAULTS: usize = 12;

pub(in crate::doors::http) const USUAL_SEED: u64 = 1;

pub(super) struct AskedRoomba {
    pub(super) seed: u64,
    pub(super) seconds: u64,
}

pub(super) struct AskedPallet {
    pub(super) seed: u64,
    pub(super) parcels: u32,
    faults: Vec<AskedFault>,
    asked: Asked,
}

pub(super) struct AskedPage {
    pub(super) roomba: AskedRoomba,
    pub(super) pallet: AskedPallet,
    pub(super) at: u64,
}

impl AskedRoomba {
    pub(super) fn of(query: &Query) -> Result<AskedRoomba, Problem> {
        query.only(&["seed", "seconds"])?;
        AskedRoomba::read(query)
    }

    fn read(query: &Query) -> Result<AskedRoomba, Problem> {
        let seed = query.count("seed", 0..=u64::MAX)?.unwrap_or(USUAL_SEED);
        let seconds = query.count("seconds", 1..=LONGEST_S)?.unwrap_or(USUAL_S);
        Ok(AskedRoomba { seed, seconds })
    }

    pub(super) fn run(&self) -> Result<Roomba, Problem> {
        let seconds = u32::try_from(self.seconds).unwrap_or(u32::MAX);
        Roomba::both(self.seed, seconds).map_err(|error| Problem::unusable(error.to_string()))
    }
}

impl AskedPallet {
    pub(super) fn of(query: &Query) -> Result<AskedPallet, Problem> {
        query.only_with_many(&["seed", "parcels"], &["fault"])?;
        let faults = faults(query, |text| text.parse().map_err(|error| wrong_fault(text, error)))?;
        AskedPallet::read(query, "seed", faults, "fault")
    }

    /// Reads a run of the pallet scenario from a query. `names_parcel` is the name of the parameter that selects the
    /// parcel of a mishap.
    fn read(query: &Query, seed: &str, faults: Vec<AskedFault>, names_parcel: &str) -> Result<AskedPallet, Problem> {
        let seed = query.count(seed, 0..=u64::MAX)?.unwrap_or(USUAL_SEED);
        let parcels = query.count("parcels", 1..=MOST_PARCELS)?.unwrap_or(USUAL_PARCELS);
        let parcels = u32::try_from(parcels).unwrap_or(u32::MAX);
        let asked = asked(parcels, &faults).map_err(|BeyondError { parcel }| {
            Problem::unusable(format!("`{names_parcel}` names parcel {parcel}, but the pallet has only {parcels}: see `parcels`"))
        })?;
        Ok(AskedPallet { seed, parcels, faults, asked })
    }

    pub(super) fn run(&self) -> Result<Pallet, Problem> {
        Pallet::new(self.parcels, self.seed, self.faults.clone(), self.asked.clone())
            .map_err(|error| Problem::unusable(error.to_string()))
    }

    pub(super) fn has(&self, mishap: Mishap) -> bool {
        self.faults.iter().any(|fault| fault.mishap == mishap)
    }

    pub(super) fn query(&self) -> String {
        let mut query = format!("parcels={}&seed={}", self.parcels, self.seed);
        for fault in &self.faults {
            write!(query, "&fault={fault}").expect("writing to a text does not fail");
        }
        query
    }
}

impl AskedPage {
    pub(super) fn of(query: &Query) -> Result<AskedPage, Problem> {
        query.only_with_many(&["seed", "seconds", "palletSeed", "parcels", "at"], &["fault"])?;
        let at = query.count("at", 1..=MOST_PARCELS)?.unwrap_or(1);
        let parcel = u32::try_from(at).unwrap_or(u32::MAX);
        let faults = faults(query, |name| {
            let mishap: Mishap = name.parse().map_err(|error| wrong_fault(name, error))?;
            // This mishap affects the whole run, so the chosen parcel does not matter.
            Ok(mishap.at(if mishap == Mishap::Absent { 1 } else { parcel }))
        })?;
        let pallet = AskedPallet::read(query, "palletSeed", faults, "at")?;
        Ok(AskedPage { roomba: AskedRoomba::read(query)?, pallet, at })
    }
}

fn faults(query: &Query, read: impl Fn(&str) -> Result<AskedFault, Problem>) -> Result<Vec<AskedFault>, Problem> {
    let texts = query.every("fault");
    if texts.len() > MOST_FAULTS {
        let words = format!("`fault` occurs {} times: a run has at most {MOST_FAULTS} faults", texts.len());
        return Err(Problem::unusable(words));
    }
    // Programs write `@` as `%40`. No other character of a fault is ever escaped.
    texts.iter().map(|text| read(&text.replace("%40", "@"))).collect()
}

fn wrong_fault(text: &str, error: impl std::fmt::Display) -> Problem {
    Problem::unusable(format!("`fault` is {:?}: {error}", in_short(text)))
}
