//! Receipts for hand-overs. The code on a receipt names the entry of the hand-over and the beginning of its digest. The
//! digest covers all entries up to there, so a later change of the record no longer agrees with the receipt.

use std::sync::Arc;

use schemars::JsonSchema;
use serde::Serialize;

use super::time::rfc3339;
use crate::runtime::archive::{Archive, Head, Span, Unreadable};
use hallsweep_core::closing::HandOver;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{MissionId, Seq, WallTime};

/// Number of hexadecimal digits of the digest in a code.
const DIGITS: usize = 16;

#[derive(Clone, Debug, PartialEq)]
pub struct Receipt {
    pub seq: Seq,
    pub wall: WallTime,
    pub who: Arc<str>,
    pub over: HandOver,
    /// Such as `2-1041-9f86d081884c7d65`: mission, entry, beginning of the digest. `None` if the journal has no digests.
    pub code: Option<String>,
}

impl Receipt {
    /// Reads at most `most` receipts of a mission, oldest first. Entries that were declared lost have no receipt.
    pub fn all(archive: &dyn Archive, mission: MissionId, after: Seq, most: usize) -> Result<Vec<Receipt>, Unreadable> {
        let until = archive.lost_after()?.unwrap_or(Seq(u64::MAX));
        let mut receipts = Vec::new();
        for (seq, entry) in archive.hand_overs(mission, Span { after, until }, most)? {
            let entry = entry?;
            if let Fact::HandedOver { who, over } = entry.fact {
                let code = archive.head(mission, seq)?.map(|head| code(mission, seq, &head));
                receipts.push(Receipt { seq, wall: entry.wall, who, over, code });
            }
        }
        Ok(receipts)
    }

    /// Reads the mission and the entry from a code. `None` if the text is no code.
    pub fn named(code: &str) -> Option<(MissionId, Seq)> {
        let mut parts = code.split('-');
        let number = |part: Option<&str>| part?.parse().ok().filter(|number: &u64| Some(&*number.to_string()) == part);
        let (mission, seq, digits) = (number(parts.next())?, number(parts.next())?, parts.next()?);
        let is_digest = digits.len() == DIGITS && digits.bytes().all(|digit| digit.is_ascii_hexdigit());
        (is_digest && parts.next().is_none()).then_some((MissionId(mission), Seq(seq)))
    }
}

fn code(mission: MissionId, seq: Seq, head: &Head) -> String {
    format!("{mission}-{seq}-{}", &head.hex()[..DIGITS])
}

/// Receipt for a hand-over.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "Receipt")]
pub struct ReceiptJson {
    /// Number of the entry of the hand-over.
    pub seq: u64,
    /// Time of the hand-over, RFC 3339 with zone.
    pub time: String,
    /// Sender who handed the mission over.
    pub by: String,
    /// Name of the person or office that took over.
    pub to: String,
    /// Remark; null if there is none.
    pub note: Option<String>,
    /// Code that `hallsweep journal check --receipt` confirms; null if the journal is only in memory.
    pub code: Option<String>,
}

/// Receipts of a mission, the oldest first.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[schemars(rename = "ReceiptList")]
pub struct ReceiptListJson {
    pub mission: u64,
    pub receipts: Vec<ReceiptJson>,
    /// Address of the rest of the list; null at the end.
    pub next: Option<String>,
}

impl From<Receipt> for ReceiptJson {
    fn from(Receipt { seq, wall, who, over: HandOver { to, note }, code }: Receipt) -> ReceiptJson {
        let note = note.map(|note| note.text().to_owned());
        ReceiptJson { seq: seq.0, time: rfc3339(wall), by: who.to_string(), to: to.text().to_owned(), note, code }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_code_names_its_mission_and_its_entry_and_nothing_else_is_a_code() {
        let code = code(MissionId(2), Seq(1041), &Head { seq: Seq(1042), digest: [0xa5; 32] });
        assert_eq!(code, "2-1041-a5a5a5a5a5a5a5a5");
        assert_eq!(Receipt::named(&code), Some((MissionId(2), Seq(1041))));
        for wrong in [
            "",
            "2-1041",
            "2-1041-a5a5a5a5a5a5a5a",
            "2-1041-a5a5a5a5a5a5a5a5-",
            "x-1-a5a5a5a5a5a5a5a5",
            "2-1-gggggggggggggggg",
            "+2-1-a5a5a5a5a5a5a5a5",
        ] {
            assert_eq!(Receipt::named(wrong), None, "{wrong}");
        }
    }
}
