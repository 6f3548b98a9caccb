//! Refusals and errors as RFC 9457 problem details, with a fixed code beside the sentence. The kinds of problems that
//! the protocols' status codes distinguish are here too. The doors decide which problem applies.

use schemars::JsonSchema;
use serde::Serialize;

use super::luggage::LuggageJson;
use hallsweep_core::refused::{CODES, Refusal, RefusalKind};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProblemKind {
    Malformed,
    NotSignedIn,
    Forbidden,
    NotFound,
    NoSuchMethod,
    NotAcceptable,
    TooSlow,
    Conflict,
    ConditionFailed,
    TooLarge,
    UnsupportedFormat,
    Misdirected,
    Unusable,
    Internal,
    Unavailable,
}

#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct ProblemJson<'a> {
    /// URI of the kind of problem, which never changes. It is `urn:hallsweep:problem:` followed by the code.
    #[serde(rename = "type")]
    pub kind: String,
    /// Status in words.
    pub title: &'static str,
    pub status: u16,
    /// Sentence for people: the fault, the wrong value, and what to do.
    pub detail: &'a str,
    /// Short word for programs, which never changes.
    pub code: &'static str,
    /// Always false, for clients that look only at the body.
    pub accepted: bool,
    /// Record of the piece, if a verdict or a retake was refused.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub luggage: Option<LuggageJson>,
}

impl<'a> ProblemJson<'a> {
    pub fn new((code, kind): ProblemCode, detail: &'a str) -> ProblemJson<'a> {
        let (status, title) = kind.status();
        let kind = format!("urn:hallsweep:problem:{code}");
        ProblemJson { kind, title, status, detail, code, accepted: false, luggage: None }
    }
}

impl ProblemKind {
    pub const ALL: [ProblemKind; 15] = [
        ProblemKind::Malformed,
        ProblemKind::NotSignedIn,
        ProblemKind::Forbidden,
        ProblemKind::NotFound,
        ProblemKind::NoSuchMethod,
        ProblemKind::NotAcceptable,
        ProblemKind::TooSlow,
        ProblemKind::Conflict,
        ProblemKind::ConditionFailed,
        ProblemKind::TooLarge,
        ProblemKind::UnsupportedFormat,
        ProblemKind::Misdirected,
        ProblemKind::Unusable,
        ProblemKind::Internal,
        ProblemKind::Unavailable,
    ];

    /// HTTP status (RFC 9110, section 15) and its title, used in problem details at every door. The titles of 413 and
    /// 422 are those of earlier RFCs.
    pub const fn status(self) -> (u16, &'static str) {
        match self {
            ProblemKind::Malformed => (400, "Bad Request"),
            ProblemKind::NotSignedIn => (401, "Unauthorized"),
            ProblemKind::Forbidden => (403, "Forbidden"),
            ProblemKind::NotFound => (404, "Not Found"),
            ProblemKind::NoSuchMethod => (405, "Method Not Allowed"),
            ProblemKind::NotAcceptable => (406, "Not Acceptable"),
            ProblemKind::TooSlow => (408, "Request Timeout"),
            ProblemKind::Conflict => (409, "Conflict"),
            ProblemKind::ConditionFailed => (412, "Precondition Failed"),
            ProblemKind::TooLarge => (413, "Payload Too Large"),
            ProblemKind::UnsupportedFormat => (415, "Unsupported Media Type"),
            ProblemKind::Misdirected => (421, "Misdirected Request"),
            ProblemKind::Unusable => (422, "Unprocessable Entity"),
            ProblemKind::Internal => (500, "Internal Server Error"),
            ProblemKind::Unavailable => (503, "Service Unavailable"),
        }
    }

    pub const fn refusal_kind(self) -> RefusalKind {
        match self {
            ProblemKind::Conflict => RefusalKind::Conflict,
            ProblemKind::NotFound => RefusalKind::Unknown,
            ProblemKind::Forbidden => RefusalKind::Forbidden,
            ProblemKind::Internal | ProblemKind::Unavailable => RefusalKind::Unavailable,
            ProblemKind::Malformed
            | ProblemKind::NotSignedIn
            | ProblemKind::NoSuchMethod
            | ProblemKind::NotAcceptable
            | ProblemKind::TooSlow
            | ProblemKind::ConditionFailed
            | ProblemKind::TooLarge
            | ProblemKind::UnsupportedFormat
            | ProblemKind::Misdirected
            | ProblemKind::Unusable => RefusalKind::Mismatch,
        }
    }
}

impl From<RefusalKind> for ProblemKind {
    fn from(kind: RefusalKind) -> ProblemKind {
        match kind {
            RefusalKind::Conflict => ProblemKind::Conflict,
            RefusalKind::Unknown => ProblemKind::NotFound,
            RefusalKind::Unavailable => ProblemKind::Unavailable,
            RefusalKind::Mismatch => ProblemKind::Unusable,
            RefusalKind::Forbidden => ProblemKind::Forbidden,
        }
    }
}

pub type ProblemCode = (&'static str, ProblemKind);

pub const MALFORMED: ProblemCode = ("malformed", ProblemKind::Malformed);
pub const UNUSABLE: ProblemCode = ("unusable", ProblemKind::Unusable);
pub const TOO_LARGE: ProblemCode = ("tooLarge", ProblemKind::TooLarge);
pub const TOO_SLOW: ProblemCode = ("tooSlow", ProblemKind::TooSlow);
pub const UNSUPPORTED_FORMAT: ProblemCode = ("unsupportedMediaType", ProblemKind::UnsupportedFormat);
pub const NO_SUCH_METHOD: ProblemCode = ("methodNotAllowed", ProblemKind::NoSuchMethod);
pub const NOT_ACCEPTABLE: ProblemCode = ("notAcceptable", ProblemKind::NotAcceptable);
pub const CONDITION_FAILED: ProblemCode = ("preconditionFailed", ProblemKind::ConditionFailed);
pub const NOT_FOUND: ProblemCode = ("notFound", ProblemKind::NotFound);
pub const TOO_MANY: ProblemCode = ("tooMany", ProblemKind::Unavailable);

/// Codes with which a door itself refuses a command. Such a refusal may be on record if its sender is known.
const AT_THE_DOOR: [ProblemCode; 10] = [
    MALFORMED,
    UNUSABLE,
    TOO_LARGE,
    TOO_SLOW,
    UNSUPPORTED_FORMAT,
    NO_SUCH_METHOD,
    NOT_ACCEPTABLE,
    CONDITION_FAILED,
    NOT_FOUND,
    TOO_MANY,
];

/// Returns the recorded refusal with this code and these words. A code that this version does not know counts as a
/// conflict.
pub fn refusal(code: &str, words: String) -> Refusal {
    let at_the_door = AT_THE_DOOR.into_iter().map(|(known, kind)| (known, kind.refusal_kind()));
    let found = CODES.into_iter().chain(at_the_door).find(|(known, _)| *known == code);
    let (code, kind) = found.unwrap_or(("refused", RefusalKind::Conflict));
    Refusal { code, kind, words }
}
