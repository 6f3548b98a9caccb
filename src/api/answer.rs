//! The answer to an accepted command, in the same shape at every door: the revision that contains its effect, and the
//! epoch for the next movement command.

use schemars::JsonSchema;
use serde::Serialize;

use super::luggage::LuggageJson;
use hallsweep_core::command::Accepted;
use hallsweep_core::snapshot::Snapshot;

/// `{"accepted":true,"revision":812,"epoch":4}`, with the record where the command concerned one.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct AnswerJson {
    /// Always true: refusals are problems.
    pub accepted: bool,
    /// The revision of the state that contains the command's effect.
    pub revision: u64,
    /// The epoch that holds: what a movement command may carry next.
    pub epoch: u64,
    /// The piece it concerned.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub luggage: Option<LuggageJson>,
}

impl AnswerJson {
    /// `snapshot` must contain the command's effect already: the record of the piece is read from it.
    pub fn new(accepted: Accepted, snapshot: &Snapshot) -> AnswerJson {
        let luggage = accepted.luggage.and_then(|id| snapshot.luggage(id));
        AnswerJson {
            accepted: true,
            revision: accepted.revision.0,
            epoch: accepted.epoch.0,
            luggage: luggage.map(|luggage| LuggageJson::from(&**luggage)),
        }
    }
}
