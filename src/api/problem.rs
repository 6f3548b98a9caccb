//! What a refusal or an error looks like: RFC 9457 problem details with a fixed code beside the sentence, and the status that each
//! family of refusals has in them. Which code of its own protocol a door answers with is the door's table.

use serde::Serialize;

use super::luggage::LuggageJson;
use hallsweep_core::command::RefusalKind;

/// One problem.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProblemJson {
    /// A URI that names the kind of problem and never changes: `urn:hallsweep:problem:` and the code.
    #[serde(rename = "type")]
    pub kind: String,
    /// The status in words.
    pub title: String,
    /// The status.
    pub status: u16,
    /// What was wrong, with what value, and what to do.
    pub detail: String,
    /// A short fixed word for programs.
    pub code: &'static str,
    /// Always false, so that whoever looks at the body alone does not take it for a success.
    pub accepted: bool,
    /// The record a refused verdict was about.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub luggage: Option<LuggageJson>,
}

/// The status of each family of refusals, as HTTP has it.
#[must_use]
pub const fn status_of(kind: RefusalKind) -> u16 {
    match kind {
        RefusalKind::Conflict => 409,
        RefusalKind::Unknown => 404,
        RefusalKind::Unavailable => 503,
        RefusalKind::Mismatch => 422,
        RefusalKind::Forbidden => 403,
    }
}

impl ProblemJson {
    /// A problem of this status and code.
    #[must_use]
    pub fn new(status: u16, title: &str, code: &'static str, detail: String) -> ProblemJson {
        let kind = format!("urn:hallsweep:problem:{code}");
        ProblemJson { kind, title: title.to_owned(), status, detail, code, accepted: false, luggage: None }
    }
}
