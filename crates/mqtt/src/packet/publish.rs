//! The head of a PUBLISH (section 3.3). Whether its topic is one, is asked apart, since senders use few topics and send much.

use super::{Fields, Qos};
use crate::frame::{Frame, Malformed};
use crate::parcels::Label;

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

/// The flag of a PUBLISH that is padded on its way through the router, which takes it for that of a duplicate and passes it on.
pub(crate) const PADDED: u8 = 8;

/// So many bytes a label has at least, with its mark.
pub(crate) const LABEL: usize = 8 + 8 + 4 + 1;

/// Reads a PUBLISH of the router, without its padding. With a label it has no payload of its own.
pub(crate) fn read_padded<'a>(frame: &Frame, packet: &'a [u8]) -> Result<(Publish<'a>, Option<Label>), Malformed> {
    let is_padded = frame.flags & PADDED != 0;
    let mut publish = read(&Frame { flags: frame.flags & !PADDED, ..*frame }, packet)?;
    let mut label = None;
    if is_padded {
        let padding = publish.payload.last().map_or(0, |padding| usize::from(*padding));
        let length = match padding {
            0 => {
                label = Some(read_label(publish.payload).ok_or(Malformed::Short("label"))?);
                0
            }
            _ => publish.payload.len().checked_sub(padding).ok_or(Malformed::Short("padding"))?,
        };
        publish.payload = &publish.payload[..length];
    }
    Ok((publish, label))
}

fn read_label(bytes: &[u8]) -> Option<Label> {
    let (number, rest) = bytes.split_first_chunk()?;
    let (stamp, rest) = rest.split_first_chunk()?;
    let (length, _) = rest.split_first_chunk()?;
    let (number, stamp) = (u64::from_be_bytes(*number), u64::from_be_bytes(*stamp));
    Some(Label { number, stamp, length: u32::from_be_bytes(*length) })
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
