//! Where, and under which threshold, something happened, in the journal and over the interface.

use std::ops::RangeInclusive;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{Unparsed, names};
use hallsweep_core::state::{Conditions, Venue};

/// No hall has smaller cells, or larger ones, and none a longer name.
const SIDES_M: RangeInclusive<f64> = 0.01..=100.0;
const NAME_BYTES: usize = 4096;

/// `{"hall":"airport","cellM":0.5,"threshold":25.0}`; metres and °C. `cellM` is null where the side of a cell is not known.
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
}

impl From<&Conditions> for ConditionsShape {
    fn from(Conditions { venue, threshold }: &Conditions) -> ConditionsShape {
        let Venue { name, cell_m, is_reckoned } = venue;
        ConditionsShape { hall: name.to_string(), cell_m: *cell_m, threshold: threshold.degrees(), reckoned: *is_reckoned }
    }
}

impl ConditionsShape {
    pub(super) fn conditions(self) -> Result<Conditions, Unparsed> {
        let ConditionsShape { hall, cell_m, threshold, reckoned } = self;
        if cell_m.is_some_and(|side| !SIDES_M.contains(&side)) {
            return Err(Unparsed("the side of a cell is none".to_owned()));
        }
        if hall.len() > NAME_BYTES {
            return Err(Unparsed("the name of the hall is too long".to_owned()));
        }
        Ok(Conditions {
            venue: Venue { name: hall.into(), cell_m, is_reckoned: reckoned },
            threshold: names::celsius(threshold)?,
        })
    }
}
