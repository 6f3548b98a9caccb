//! Where, and under which threshold, something happened, in the journal and over the interface.

use std::ops::RangeInclusive;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Unparsed, names};
use hallsweep_core::state::{Conditions, Reach, Venue};

/// No hall has smaller cells, or larger ones, and none a longer name.
const SIDES_M: RangeInclusive<f64> = 0.01..=100.0;
const NAME_BYTES: usize = 4096;

/// `{"hall":"airport","cellM":0.5,"threshold":25.0}`; metres and °C. `cellM` is null where the side of a cell is not known. Of a hall that
/// is known beforehand `"reach":[51,60]` says how many cells can be reached, and how many are free.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "Conditions")]
#[serde(rename_all = "camelCase")]
pub struct ConditionsShape {
    hall: String,
    cell_m: Option<f64>,
    threshold: f64,
    /// The robot counts its way by time, without a scene file: what it meets may be a cell beside where it is shown.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    reckoned: bool,
    /// Free cells that a robot can come to from its start, and all free cells, of a hall that is known beforehand.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    reach: Option<(u32, u32)>,
}

impl From<&Conditions> for ConditionsShape {
    fn from(Conditions { venue, threshold }: &Conditions) -> ConditionsShape {
        ConditionsShape {
            hall: venue.name.to_string(),
            cell_m: venue.cell_m,
            threshold: threshold.degrees(),
            reckoned: venue.is_reckoned,
            reach: venue.reach.map(|Reach { reachable, free }| (reachable, free)),
        }
    }
}

impl ConditionsShape {
    pub(super) fn conditions(self) -> Result<Conditions, Unparsed> {
        let ConditionsShape { hall, cell_m, threshold, reckoned, reach } = self;
        let reach = reach.map(|(reachable, free)| Reach { reachable, free });
        if cell_m.is_some_and(|side| !SIDES_M.contains(&side)) {
            return Err(Unparsed("the side of a cell is none".to_owned()));
        }
        if reach.is_some_and(|reach| reach.reachable > reach.free) {
            return Err(Unparsed("more cells can be reached than are free".to_owned()));
        }
        if hall.len() > NAME_BYTES {
            return Err(Unparsed("the name of the hall is too long".to_owned()));
        }
        Ok(Conditions {
            venue: Venue { name: hall.into(), cell_m, is_reckoned: reckoned, reach },
            threshold: names::celsius(threshold)?,
        })
    }
}
