//! Reads the head of a PUBLISH (section 3.3). The topic is checked elsewhere, since many messages of a sender have
//! the same topic.

use super::properties::{Properties, PropertyContext};
use super::{PacketFields, Qos, Version};
use crate::frame::{Frame, Malformed};

/// A PUBLISH, whose parts are borrowed from the packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Publish<'a> {
    /// The bytes of its topic; empty in MQTT 5 when a topic alias stands for it.
    pub topic: &'a [u8],
    /// The bytes after the properties; they may be empty.
    pub payload: &'a [u8],
    /// The QoS of the packet. Readers may get the message at a lower QoS.
    pub qos: Qos,
    /// Its id; 0 at QoS 0.
    pub id: u16,
    /// The DUP flag: the packet may have been sent before.
    pub is_duplicate: bool,
    /// The RETAIN flag: the message replaces the topic's retained message, or removes it if the payload is empty
    /// (section 3.3.1.3).
    pub retain: bool,
    /// Its properties; empty in MQTT 3.1.1.
    pub properties: Properties<'a>,
}

/// Reads a PUBLISH; `packet` is the whole packet, and `frame` the frame of this packet.
///
/// # Errors
/// When the packet is malformed; its topic and its alias are not checked here.
pub fn read<'a>(frame: &Frame, packet: &'a [u8], version: Version) -> Result<Publish<'a>, Malformed> {
    let qos = Qos::of(frame.flags >> 1 & 3)?;
    let is_duplicate = frame.flags & 8 != 0;
    if is_duplicate && qos == Qos::Zero {
        return Err(Malformed::Duplicate);
    }
    let mut fields = PacketFields::new(&packet[frame.head..]);
    let topic = fields.bytes("topic")?;
    let id = if qos == Qos::Zero { 0 } else { fields.id()? };
    let properties = match version {
        Version::Three => Properties::default(),
        Version::Five => Properties::read(&mut fields, PropertyContext::Publish)?,
    };
    Ok(Publish { topic, payload: fields.rest(), qos, id, is_duplicate, retain: frame.flags & 1 != 0, properties })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::frame::frame;

    fn check(packet: &[u8], expected: Result<(u8, u16, &[u8]), Malformed>) {
        let frame = frame(packet, 100).unwrap().unwrap();
        assert_eq!(
            read(&frame, packet, Version::Three).map(|publish| (publish.qos as u8, publish.id, publish.payload)),
            expected,
            "{packet:?}"
        );
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

    #[test]
    fn the_properties_of_mqtt_5_stand_before_the_payload() {
        let packet = [0x32, 11, 0, 1, b'a', 0, 9, 5, 2, 0, 0, 0, 3, 7, 8];
        let read = |packet: &[u8]| {
            let frame = frame(packet, 100).unwrap().unwrap();
            read(&frame, packet, Version::Five)
                .map(|publish| (publish.payload.to_vec(), publish.properties.collect::<Vec<_>>().len()))
        };
        let mut whole = packet;
        whole[1] = 13;
        assert_eq!(read(&whole), Ok((vec![7, 8], 1)));
        assert_eq!(read(&[0x30, 4, 0, 1, b'a', 0]), Ok((vec![], 0)));
        assert_eq!(read(&[0x30, 3, 0, 1, b'a']), Err(Malformed::Short("properties")));
        assert_eq!(read(&[0x30, 5, 0, 1, b'a', 9, 2]), Err(Malformed::Short("properties")));
        assert_eq!(read(&[0x30, 6, 0, 1, b'a', 2, 0x0B, 1]), Err(Malformed::Property(0x0B)), "that is for the server to say");
    }
}
