//! The answer to an accepted command, with the same shape at every door. The answer has the revision that contains
//! the command's effect, and the epoch (number of stops) for the next movement command.

use schemars::JsonSchema;
use serde::Serialize;

use super::luggage::LuggageJson;
use hallsweep_core::command::Accepted;
use hallsweep_core::snapshot::Snapshot;

/// Answer to an accepted command, as `{"accepted":true,"revision":812,"epoch":4}`. If the command concerned a piece,
/// the answer also has its record.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(rename_all = "camelCase")]
pub struct AnswerJson {
    /// Always true; a refused command is answered with a `Problem`.
    pub accepted: bool,
    /// Revision of the state that contains the command's effect.
    pub revision: u64,
    /// Present epoch (number of stops so far), to be sent with the next movement command.
    pub epoch: u64,
    /// Record of the piece that the command concerned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub luggage: Option<LuggageJson>,
    /// Whether the command was a *safe* that is kept back until another judge has answered; absent otherwise.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub kept_back: bool,
}

impl AnswerJson {
    /// Makes the answer, and reads the record of the piece from `snapshot`. `snapshot` must already contain the
    /// command's effect.
    pub fn new(accepted: Accepted, snapshot: &Snapshot) -> AnswerJson {
        let luggage = accepted.luggage.and_then(|id| snapshot.luggage(id));
        AnswerJson {
            accepted: true,
            revision: accepted.revision.0,
            epoch: accepted.epoch.0,
            luggage: luggage.map(|luggage| LuggageJson::new(luggage, snapshot.hall.as_ref())),
            kept_back: accepted.is_kept_back,
        }
    }
}
