//! The head of a PUBLISH (section 3.3). Whether its topic is one, is asked apart, since senders use few topics and send much.

use super::{Fields, Qos};
use crate::frame::{Frame, Malformed};

/// A PUBLISH.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Publish<'a> {
    /// The bytes of its topic.
    pub topic: &'a [u8],
    /// What is said.
    pub payload: &'a [u8],
    /// How often it comes.
    pub qos: Qos,
    /// Its id; 0 at QoS 0.
    pub id: u16,
    /// Whether it may have been sent before.
    pub is_duplicate: bool,
    /// Whether it is to be kept.
    pub retain: bool,
}

/// Reads a PUBLISH; `packet` is the whole of it.
///
/// # Errors
/// When it is none.
pub fn read<'a>(frame: &Frame, packet: &'a [u8]) -> Result<Publish<'a>, Malformed> {
    let qos = Qos::of(frame.flags >> 1 & 3)?;
    let is_duplicate = frame.flags & 8 != 0;
    if is_duplicate && qos == Qos::Zero {
        return Err(Malformed::Duplicate);
    }
    let mut fields = Fields::new(&packet[frame.head..]);
    let topic = fields.bytes("topic")?;
    let id = if qos == Qos::Zero { 0 } else { fields.id()? };
    Ok(Publish { topic, payload: fields.rest(), qos, id, is_duplicate, retain: frame.flags & 1 != 0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::frame;

    fn check(packet: &[u8], expected: Result<(u8, u16, &[u8]), Malformed>) {
        let frame = frame(packet, 100).unwrap().unwrap();
        assert_eq!(read(&frame, packet).map(|publish| (publish.qos as u8, publish.id, publish.payload)), expected, "{packet:?}");
    }

    #[test]
    fn the_head_of_a_publish_is_read_strictly() {
        check(&[0x30, 4, 0, 1, b'a', 7], Ok((0, 0, &[7])));
        check(&[0x3B, 5, 0, 1, b'a', 0, 9], Ok((1, 9, &[])));
        check(&[0x34, 5, 0, 1, b'a', 0, 0], Err(Malformed::Id));
        check(&[0x36, 5, 0, 1, b'a', 0, 9], Err(Malformed::Qos(3)));
        check(&[0x38, 3, 0, 1, b'a'], Err(Malformed::Duplicate));
        check(&[0x30, 3, 0, 2, b'a'], Err(Malformed::Short("topic")));
        check(&[0x30, 1, 0], Err(Malformed::Short("topic")));
        check(&[0x32, 4, 0, 1, b'a', 1], Err(Malformed::Short("packet id")));
    }
}
