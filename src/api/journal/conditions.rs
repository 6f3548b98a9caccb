//! In which hall and under which limit something happened, in the journal and over the interface.

use serde::{Deserialize, Serialize};

use super::{Unparsed, names};
use hallsweep_core::state::Conditions;

/// `{"hall":"airport","cellM":0.5,"threshold":25.0}`; metres and °C. `cellM` is null where the side of a cell is not known.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct ConditionsShape {
    hall: String,
    cell_m: Option<f64>,
    threshold: f64,
}

impl From<&Conditions> for ConditionsShape {
    fn from(Conditions { hall, cell_m, threshold }: &Conditions) -> ConditionsShape {
        ConditionsShape { hall: hall.to_string(), cell_m: *cell_m, threshold: threshold.degrees() }
    }
}

impl ConditionsShape {
    pub(super) fn conditions(self) -> Result<Conditions, Unparsed> {
        let ConditionsShape { hall, cell_m, threshold } = self;
        if cell_m.is_some_and(|side| !side.is_finite() || side <= 0.0) {
            return Err(Unparsed("the side of a cell is none".to_owned()));
        }
        Ok(Conditions { hall: hall.into(), cell_m, threshold: names::celsius(threshold)? })
    }
}
