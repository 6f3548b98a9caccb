//! The claim in the head of a report: its edition, mission, last entry and language. Everything else follows from the
//! claim and the journal. So a wrong claim yields a different report, and need not be trusted.

use std::fmt;

use crate::phrases::Language;
use hallsweep_core::units::{MissionId, Seq};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Claim {
    pub edition: u32,
    pub mission: MissionId,
    /// The last entry that the report covers. If the journal has a chain of digests, this entry is the last one of a
    /// page.
    pub until: Seq,
    pub language: Language,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the head of the file names no mission: the file is not a hallsweep report, or its beginning was changed")]
pub struct Unclear;

const AROUND: [&str; 2] = ["<meta name=\"hallsweep-report\" content=\"", "\">"];

impl Claim {
    /// The claim is within this number of bytes from the beginning of the report.
    pub const WITHIN: usize = 1024;

    pub fn read(page: &[u8]) -> Result<Claim, Unclear> {
        let beginning = String::from_utf8_lossy(&page[..page.len().min(Claim::WITHIN)]);
        let claim = beginning.split_once(AROUND[0]).and_then(|(_, rest)| rest.split_once(AROUND[1]));
        claim.and_then(|(claim, _)| read(claim)).ok_or(Unclear)
    }
}

impl fmt::Display for Claim {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Claim { edition, mission, until, language } = self;
        write!(f, "edition {edition}, mission {mission}, entry {until}, language {}", language.tag())
    }
}

fn read(text: &str) -> Option<Claim> {
    let rest = text.strip_prefix("edition ")?;
    let (edition, rest) = rest.split_once(", mission ")?;
    let (mission, rest) = rest.split_once(", entry ")?;
    let (until, language) = rest.split_once(", language ")?;
    let claim = Claim {
        edition: edition.parse().ok()?,
        mission: MissionId(mission.parse().ok()?),
        until: Seq(until.parse().ok()?),
        language: Language::tagged(language)?,
    };
    (claim.to_string() == text).then_some(claim)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_claim_is_read_as_it_was_written_and_otherwise_not_at_all() {
        for language in Language::ALL {
            let claim = Claim { edition: 1, mission: MissionId(3), until: Seq(4711), language };
            let page = format!("<!doctype html>\n{}{claim}{}\n", AROUND[0], AROUND[1]);
            assert_eq!(Claim::read(page.as_bytes()), Ok(claim));
        }
        for other in
            ["", "edition 1", "edition 1, mission 03, entry 1, language en", "edition 1, mission 3, entry 1, language de", "x"]
        {
            let page = format!("{}{other}{}", AROUND[0], AROUND[1]);
            assert_eq!(Claim::read(page.as_bytes()), Err(Unclear), "{other}");
        }
        assert_eq!(Claim::read(b"PK\x03\x04"), Err(Unclear));
    }
}
