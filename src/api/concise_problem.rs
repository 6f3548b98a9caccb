//! Writes a refusal or an error as concise problem details in CBOR (RFC 9290). The contents are in `problem`. The
//! door decides when to use this form.

use std::collections::BTreeMap;

use serde::Serialize;

use super::cbor;
use super::luggage::LuggageJson;
use super::problem::ProblemJson;

/// URI of hallsweep's own entry; its value is a map, as the RFC requires.
pub const OURS: &str = "urn:hallsweep:problem";

/// Numbers of the standard entries (RFC 9290, section 2).
mod key {
    pub(super) const TITLE: i8 = -1;
    pub(super) const DETAIL: i8 = -2;
    pub(super) const RESPONSE_CODE: i8 = -4;
}

/// Hallsweep's own entry: the code for programs, `accepted` as false, and the record of the piece if a verdict or a
/// retake was refused.
#[derive(Serialize)]
struct Ours<'a> {
    code: &'a str,
    accepted: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    luggage: Option<&'a LuggageJson>,
}

/// Key of an entry: a number assigned by the RFC, or a URI.
#[derive(PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(untagged)]
enum Name {
    Standard(i8),
    Custom(&'static str),
}

#[derive(Serialize)]
#[serde(untagged)]
enum ProblemEntry<'a> {
    Text(&'a str),
    Number(u8),
    Ours(Ours<'a>),
}

pub fn written(problem: &ProblemJson<'_>, response_code: u8) -> Vec<u8> {
    let ours = Ours { code: problem.code, accepted: problem.accepted, luggage: problem.luggage.as_ref() };
    let entries = BTreeMap::from([
        (Name::Standard(key::TITLE), ProblemEntry::Text(problem.title)),
        (Name::Standard(key::DETAIL), ProblemEntry::Text(problem.detail)),
        (Name::Standard(key::RESPONSE_CODE), ProblemEntry::Number(response_code)),
        (Name::Custom(OURS), ProblemEntry::Ours(ours)),
    ]);
    cbor::written(&entries)
}

#[cfg(test)]
mod tests {
    use minicbor::Decoder;

    use super::*;
    use crate::api::problem::ProblemKind;

    #[test]
    fn a_problem_has_the_numbers_of_the_rfc_and_our_code_in_a_map_of_its_own() {
        let problem = ProblemJson::new(("moving", ProblemKind::Conflict), "the robot is moving: press STOP first");
        let bytes = written(&problem, 0x89);
        let mut decoder = Decoder::new(&bytes);
        assert_eq!(decoder.map().unwrap(), Some(4));
        assert_eq!((decoder.i8().unwrap(), decoder.u8().unwrap()), (-4, 0x89));
        assert_eq!((decoder.i8().unwrap(), decoder.str().unwrap()), (-2, "the robot is moving: press STOP first"));
        assert_eq!((decoder.i8().unwrap(), decoder.str().unwrap()), (-1, "Conflict"));
        assert_eq!((decoder.str().unwrap(), decoder.map().unwrap()), ("urn:hallsweep:problem", Some(2)));
        assert_eq!((decoder.str().unwrap(), decoder.str().unwrap()), ("code", "moving"));
        assert_eq!((decoder.str().unwrap(), decoder.bool().unwrap()), ("accepted", false));
        assert_eq!(decoder.position(), bytes.len());
    }
}
