//! DISCONNECT (section 3.14): how a client ends its connection.

use super::properties::{Properties, Property, PropertyContext};
use super::{PacketFields, Version};
use crate::frame::Malformed;

/// A client's DISCONNECT. A DISCONNECT of MQTT 3.1.1 has no fields, and is a normal end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Disconnect {
    /// The reason code. 0 means a normal end, which discards the will.
    pub reason: u8,
    /// The new time for which the session is to be stored, in seconds. `None` means that the time in the CONNECT
    /// stays valid.
    pub session_expiry_s: Option<u32>,
}

/// Reads the body of a DISCONNECT; an empty one is a normal end (MQTT 5, section 3.14.2.1).
///
/// # Errors
/// When the body is malformed. In MQTT 3.1.1 it must be empty.
pub fn read(body: &[u8], version: Version) -> Result<Disconnect, Malformed> {
    let mut fields = PacketFields::new(body);
    let mut disconnect = Disconnect { reason: 0, session_expiry_s: None };
    if version == Version::Three || body.is_empty() {
        return fields.end().map(|()| disconnect);
    }
    disconnect.reason = match fields.byte("reason")? {
        reason @ (0x00 | 0x04 | 0x80..=0x83 | 0x90 | 0x93..=0x99) => reason,
        reason => return Err(Malformed::Reason(reason)),
    };
    if !fields.rest().is_empty() {
        let mut properties = Properties::read(&mut fields, PropertyContext::Disconnect)?;
        disconnect.session_expiry_s =
            properties.find_map(|property| if let Property::SessionExpiry(seconds) = property { Some(seconds) } else { None });
    }
    fields.end().map(|()| disconnect)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_farewell_is_read_strictly() {
        let (three, five) = (|body: &[u8]| read(body, Version::Three), |body: &[u8]| read(body, Version::Five));
        let said = |reason, session_expiry_s| Ok(Disconnect { reason, session_expiry_s });
        assert_eq!((three(&[]), five(&[])), (said(0, None), said(0, None)));
        assert_eq!(three(&[0]), Err(Malformed::Trailing(1)));
        assert_eq!(five(&[4]), said(4, None));
        assert_eq!(five(&[0, 5, 0x11, 0, 0, 0, 9]), said(0, Some(9)));
        assert_eq!(five(&[0x8E]), Err(Malformed::Reason(0x8E)), "that is for the server to say");
        assert_eq!(five(&[0, 3, 0x21, 0, 1]), Err(Malformed::Property(0x21)));
        assert_eq!(five(&[0, 0, 0]), Err(Malformed::Trailing(1)));
    }
}
