//! Receipts for hand-overs. The code on a receipt names the entry of the hand-over and the beginning of the digest of its
//! page. That digest covers all earlier entries, so a later change of the record no longer agrees with the receipt.

use std::sync::Arc;

use super::end;
use crate::api::receipt::ReceiptJson;
use crate::api::time::rfc3339;
use crate::runtime::archive::{Archive, Head, Span, Unreadable};
use hallsweep_core::command::Note;
use hallsweep_core::state::fact::Fact;
use hallsweep_core::units::{MissionId, Seq, WallTime};

/// Number of hexadecimal digits of the digest in a code.
const DIGITS: usize = 16;

#[derive(Clone, Debug, PartialEq)]
pub struct Receipt {
    pub wall: WallTime,
    pub who: Arc<str>,
    pub to: Note,
    pub note: Option<Note>,
    /// Such as `2-1041-9f86d081884c7d65`: mission, entry, beginning of the digest. `None` if the journal has no digests.
    pub code: Option<String>,
}

/// The number of the entry of a hand-over, and its receipt.
pub type ReceiptOf = (Seq, Result<Receipt, Unreadable>);

impl Receipt {
    /// Reads at most `most` receipts of a mission, oldest first, each with the number of its entry. Entries that were
    /// declared lost have no receipt.
    pub fn all(archive: &dyn Archive, mission: MissionId, after: Seq, most: usize) -> Result<Vec<ReceiptOf>, Unreadable> {
        let mut receipts = Vec::new();
        for (seq, entry) in archive.hand_overs(mission, Span { after, until: end(archive)? }, most)? {
            let code = archive.head(mission, seq)?.map(|head| code(mission, seq, &head));
            receipts.push(match entry.map(|entry| (entry.wall, entry.fact)) {
                Ok((wall, Fact::HandedOver { who, to, note })) => (seq, Ok(Receipt { wall, who, to, note, code })),
                Ok(_) => continue,
                Err(unreadable) => (seq, Err(unreadable)),
            });
        }
        Ok(receipts)
    }

    /// Returns the receipt of this entry; `None` if the entry is no hand-over of this mission.
    pub fn of(archive: &dyn Archive, mission: MissionId, seq: Seq) -> Result<Option<Receipt>, Unreadable> {
        let first = Receipt::all(archive, mission, Seq(seq.0.saturating_sub(1)), 1)?.pop();
        first.filter(|(found, _)| *found == seq).map(|(_, receipt)| receipt).transpose()
    }

    /// Reads the mission and the entry from a code. `None` if the text is no code.
    pub fn parse_code(code: &str) -> Option<(MissionId, Seq)> {
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

impl From<(Seq, Receipt)> for ReceiptJson {
    fn from((seq, Receipt { wall, who, to, note, code }): (Seq, Receipt)) -> ReceiptJson {
        let note = note.map(|note| note.text().to_owned());
        ReceiptJson { seq: seq.0, time: rfc3339(wall), by: who.to_string(), to: to.text().to_owned(), note, code }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::archive::Happened;
    use crate::runtime::tests::partial_archive::PartialArchive;
    use hallsweep_core::state::fact::Entry;

    #[test]
    fn a_code_names_its_mission_and_its_entry_and_nothing_else_is_a_code() {
        let code = code(MissionId(2), Seq(1041), &Head { seq: Seq(1042), digest: [0xa5; 32] });
        assert_eq!(code, "2-1041-a5a5a5a5a5a5a5a5");
        assert_eq!(Receipt::parse_code(&code), Some((MissionId(2), Seq(1041))));
        for wrong in [
            "",
            "2-1041",
            "2-1041-a5a5a5a5a5a5a5a",
            "2-1041-a5a5a5a5a5a5a5a5-",
            "x-1-a5a5a5a5a5a5a5a5",
            "2-1-gggggggggggggggg",
            "+2-1-a5a5a5a5a5a5a5a5",
            "02-1-a5a5a5a5a5a5a5a5",
        ] {
            assert_eq!(Receipt::parse_code(wrong), None, "{wrong}");
        }
    }

    /// Four hand-overs. The second cannot be read, and the fourth was declared lost.
    struct Damaged;

    impl PartialArchive for Damaged {
        fn entries(&self, _: MissionId) -> Vec<Happened> {
            let fact = Fact::HandedOver { who: "anna".into(), to: Note::new("police").expect("a sound name"), note: None };
            let entry = |seq| match seq {
                2 => Err(Unreadable("a mouse was at it".to_owned())),
                _ => Ok(Entry { wall: WallTime::default(), fact: fact.clone() }),
            };
            (1..=4).map(|seq| (Seq(seq), entry(seq))).collect()
        }

        fn lost_after(&self) -> Option<Seq> {
            Some(Seq(3))
        }
    }

    #[test]
    fn a_damaged_receipt_hides_no_other_and_a_lost_hand_over_has_none() {
        let receipts = Receipt::all(&Damaged, MissionId(1), Seq(0), 9).unwrap();
        let sound: Vec<(u64, bool)> = receipts.iter().map(|(seq, receipt)| (seq.0, receipt.is_ok())).collect();
        assert_eq!(sound, [(1, true), (2, false), (3, true)]);
        assert_eq!(receipts[0].1.as_ref().unwrap().code, None, "this archive has no digests");
        assert!(Receipt::of(&Damaged, MissionId(1), Seq(3)).unwrap().is_some());
        assert!(Receipt::of(&Damaged, MissionId(1), Seq(2)).is_err());
        assert_eq!(Receipt::of(&Damaged, MissionId(1), Seq(4)).unwrap(), None);
    }
}
