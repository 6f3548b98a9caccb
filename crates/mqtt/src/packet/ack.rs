//! Packets that answer another packet by its id: PUBACK, PUBREC, PUBREL and PUBCOMP.

use super::properties::{Properties, PropertyContext};
use super::{PacketFields, Version};
use crate::frame::{Malformed, PacketKind};

/// A PUBACK, PUBREC, PUBREL or PUBCOMP.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ack {
    /// The id of the packet that this one answers, never 0.
    pub id: u16,
    /// The reason code. 0 means success, the only result in MQTT 3.1.1.
    pub reason: u8,
}

impl Ack {
    /// Whether this packet refuses the packet that it answers: codes from 0x80 on are refusals (MQTT 5, section 2.4).
    #[must_use]
    pub const fn is_refusal(self) -> bool {
        self.reason >= 0x80
    }
}

/// Reads the body of an acknowledgement. A missing reason means success (MQTT 5, section 3.4.2.1).
///
/// # Errors
/// When the body is malformed. In MQTT 3.1.1 the body must be an id alone.
pub fn read(body: &[u8], kind: PacketKind, version: Version) -> Result<Ack, Malformed> {
    let mut fields = PacketFields::new(body);
    let id = fields.id()?;
    if version == Version::Three || fields.rest().is_empty() {
        return fields.end().map(|()| Ack { id, reason: 0 });
    }
    let reason = reason(&mut fields, kind)?;
    if !fields.rest().is_empty() {
        Properties::read(&mut fields, PropertyContext::Ack)?;
    }
    fields.end().map(|()| Ack { id, reason })
}

/// Reads a reason code and checks that this kind of packet may have it (section 3.4.2.1 and its counterparts).
fn reason(fields: &mut PacketFields<'_>, kind: PacketKind) -> Result<u8, Malformed> {
    match fields.byte("reason")? {
        reason @ (0x00 | 0x92) => Ok(reason),
        reason if matches!(kind, PacketKind::Pubrel | PacketKind::Pubcomp) => Err(Malformed::Reason(reason)),
        reason @ (0x10 | 0x80 | 0x83 | 0x87 | 0x90 | 0x91 | 0x97 | 0x99) => Ok(reason),
        reason => Err(Malformed::Reason(reason)),
    }
}

#[cfg(test)]
pub(crate) fn read_suback(body: &[u8]) -> Result<(u16, &[u8]), Malformed> {
    let mut fields = PacketFields::new(body);
    Ok((fields.id()?, fields.rest()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_acknowledgement_is_an_id_and_nothing_else() {
        let three = |body: &[u8]| read(body, PacketKind::Puback, Version::Three).map(|ack| ack.id);
        assert_eq!(three(&[1, 2]), Ok(0x0102));
        assert_eq!(three(&[0, 0]), Err(Malformed::Id));
        assert_eq!(three(&[1]), Err(Malformed::Short("packet id")));
        assert_eq!(three(&[0, 1, 0]), Err(Malformed::Trailing(1)));
        assert_eq!(read_suback(&[0, 9, 1, 0x80]), Ok((9, &[1, 0x80][..])));
    }
    #[test]
    fn in_mqtt_5_a_reason_and_properties_may_follow() {
        let five = |body: &[u8]| read(body, PacketKind::Pubrec, Version::Five).map(|ack| (ack.id, ack.reason));
        assert_eq!(five(&[1, 2]), Ok((0x0102, 0)));
        assert_eq!(five(&[1, 2, 0x97]), Ok((0x0102, 0x97)));
        assert_eq!(five(&[1, 2, 0x10, 0]), Ok((0x0102, 0x10)));
        assert_eq!(five(&[1, 2, 0, 4, 0x1F, 0, 1, b'x']), Ok((0x0102, 0)));
        assert_eq!(five(&[1, 2, 7]), Err(Malformed::Reason(7)));
        assert_eq!(read(&[1, 2, 0x97], PacketKind::Pubrel, Version::Five), Err(Malformed::Reason(0x97)));
        assert_eq!(read(&[1, 2, 0x92], PacketKind::Pubcomp, Version::Five), Ok(Ack { id: 0x0102, reason: 0x92 }));
        assert_eq!(five(&[1, 2, 0, 0, 0]), Err(Malformed::Trailing(1)));
        assert_eq!(five(&[1, 2, 0, 2, 1, 1]), Err(Malformed::Property(1)));
    }
}
