//! Where packets begin and end in a stream of bytes (MQTT 3.1.1, section 2.2, and MQTT 5, section 2.1.1), and the
//! errors that a packet can have. The contents of packets are read in `packet`.

use super::limits::{ALIASES, PACKET_FILTERS};
use super::packet::reason::Reason;

/// The kinds of packets, with their numbers in the upper half of the first byte (MQTT 3.1.1, section 2.2.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
#[expect(missing_docs, reason = "the names are those of the standard, section 2.2.1")]
pub enum PacketKind {
    Connect = 1,
    Connack,
    Publish,
    Puback,
    Pubrec,
    Pubrel,
    Pubcomp,
    Subscribe,
    Suback,
    Unsubscribe,
    Unsuback,
    Pingreq,
    Pingresp,
    Disconnect,
    /// MQTT 5 only.
    Auth,
}

/// The packet at the head of a stream, when it has arrived completely: its kind, and where its parts are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// The kind, from the upper half of the first byte, where 0 is malformed.
    pub kind: PacketKind,
    /// The four flag bits in the lower half of the first byte. They have been checked, except in a PUBLISH.
    pub flags: u8,
    /// Length of the fixed header in bytes, 2 to 5. The body begins after it.
    pub head: usize,
    /// Length of the whole packet in bytes, the fixed header included.
    pub length: usize,
}

/// Why a packet is malformed. Each of these errors ends the connection (MQTT 5, section 4.13).
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Malformed {
    /// The first byte has an unknown kind, or flags that its kind must not have (MQTT 3.1.1, section 2.2.2).
    #[error("no packet begins with the byte {0:#04x}")]
    Kind(u8),
    /// The length has more than four bytes (MQTT 3.1.1, section 2.2.3).
    #[error("the length of a packet has more than four bytes")]
    Length,
    /// The packet, or the properties of a will, are longer than this broker accepts: see `limits`.
    #[error("a packet of {length} bytes is longer than the limit of {limit} bytes")]
    TooLong {
        /// The length of the packet or of the properties, in bytes.
        length: usize,
        /// The limit in bytes.
        limit: usize,
    },
    /// The packet ends within the field with this name.
    #[error("a packet ends within its {0}")]
    Short(&'static str),
    /// The number of extra bytes after the last field. In a PUBLISH such bytes are the payload, so they are no error.
    #[error("{0} bytes follow the end of a packet")]
    Trailing(usize),
    /// A field with this name is not a valid text by MQTT 5, section 1.5.4.
    #[error("the {0} of a packet is not UTF-8, or has a U+0000 in it")]
    Text(&'static str),
    /// A byte with a QoS of 3. In a SUBSCRIBE of MQTT 3.1.1, also a byte with any bit set that does not belong to the
    /// QoS.
    #[error("{0:#04x} is not a QoS")]
    Qos(u8),
    /// The DUP flag is set at QoS 0, at which no message is sent twice (section 3.3.1.1).
    #[error("a PUBLISH of QoS 0 is marked as a duplicate")]
    Duplicate,
    /// The packet id 0, which means that there is no id (MQTT 3.1.1, section 2.3.1).
    #[error("a packet has the id 0")]
    Id,
    /// The topic of a PUBLISH or of a will is empty or has wildcards (section 3.3.2.1).
    #[error("a PUBLISH has an empty topic, or one with wildcards")]
    Topic,
    /// A SUBSCRIBE or UNSUBSCRIBE names no filter, or an empty filter. It has to name at least one (sections
    /// 3.8.3 and 3.10.3).
    #[error("a packet names no filter, or an empty one")]
    Filters,
    /// More filters than this broker accepts in one packet. The standard sets no limit.
    #[error("a packet names more than {PACKET_FILTERS} filters")]
    ManyFilters,
    /// Invalid flags of a CONNECT: the reserved bit, a QoS of 3, or flags of a will without a will. In MQTT 3.1.1,
    /// also a password without a name (section 3.1.2).
    #[error("the flags {0:#04x} of a CONNECT contradict each other")]
    ConnectFlags(u8),
    /// The identifier of an unknown property, or of a property that this packet must not have (MQTT 5, table 2-4).
    #[error("the property {0:#04x} is unknown or not allowed in this packet")]
    Property(u8),
    /// The identifier of a property that occurs twice. Only the user property may occur twice (MQTT 5, section
    /// 2.2.2.2).
    #[error("the property {0:#04x} occurs twice in a packet")]
    PropertyTwice(u8),
    /// A value that its property cannot have, such as a Receive Maximum of 0, or Authentication Data without a
    /// Method.
    #[error("the property {0:#04x} has an invalid value")]
    PropertyValue(u8),
    /// A Retain Handling of 3 or a reserved bit (MQTT 5, section 3.8.3.1).
    #[error("{0:#04x} are not valid options of a subscription")]
    Options(u8),
    /// Shared subscriptions cannot have the option No Local (MQTT 5, section 3.8.3.1).
    #[error("a shared subscription has the option No Local")]
    SharedNoLocal,
    /// A topic alias of 0, or above the Topic Alias Maximum that the CONNACK announced.
    #[error("a PUBLISH has the topic alias {0}, but only 1 to {ALIASES} are allowed")]
    Alias(u16),
    /// An empty topic without an alias, or with an alias that was not set in this connection.
    #[error("a PUBLISH has no topic, and its topic alias is unset or unknown")]
    NoTopic,
    /// A DISCONNECT asks for a session although its CONNECT asked for none (MQTT 5, section 3.14.2.2.2).
    #[error("a DISCONNECT asks for a session that its CONNECT has not asked for")]
    SessionExpiry,
    /// A reason code that packets of this kind do not have (MQTT 5, table 2-6).
    #[error("the packet cannot have the reason {0:#04x}")]
    Reason(u8),
    /// The protocol name is neither `MQTT` nor the `MQIsdp` of MQTT 3.1 (section 3.1.2.1).
    #[error("a CONNECT is for a protocol that is not MQTT")]
    Protocol,
}

impl Malformed {
    /// The reason code for a client of MQTT 5. It says whether the form or the contents of the packet are wrong
    /// (section 4.13).
    #[must_use]
    pub const fn reason(self) -> Reason {
        match self {
            Malformed::TooLong { .. } => Reason::TooLarge,
            Malformed::Alias(_) => Reason::TopicAlias,
            Malformed::ManyFilters => Reason::Quota,
            Malformed::PropertyTwice(_)
            | Malformed::PropertyValue(_)
            | Malformed::Duplicate
            | Malformed::Filters
            | Malformed::Options(_)
            | Malformed::SharedNoLocal
            | Malformed::NoTopic
            | Malformed::SessionExpiry
            | Malformed::Id => Reason::Protocol,
            Malformed::Topic => Reason::Topic,
            Malformed::Kind(_)
            | Malformed::Length
            | Malformed::Short(_)
            | Malformed::Trailing(_)
            | Malformed::Text(_)
            | Malformed::Qos(_)
            | Malformed::Property(_)
            | Malformed::Reason(_)
            | Malformed::ConnectFlags(_)
            | Malformed::Protocol => Reason::Malformed,
        }
    }
}

impl PacketKind {
    fn of(first: u8) -> Option<PacketKind> {
        let kinds = [
            PacketKind::Connect,
            PacketKind::Connack,
            PacketKind::Publish,
            PacketKind::Puback,
            PacketKind::Pubrec,
            PacketKind::Pubrel,
            PacketKind::Pubcomp,
            PacketKind::Subscribe,
            PacketKind::Suback,
            PacketKind::Unsubscribe,
            PacketKind::Unsuback,
            PacketKind::Pingreq,
            PacketKind::Pingresp,
            PacketKind::Disconnect,
            PacketKind::Auth,
        ];
        kinds
            .get(usize::from(first >> 4).wrapping_sub(1))
            .copied()
            .filter(|kind| kind.flags().is_none_or(|flags| flags == first & 15))
    }

    /// The flags that a packet of this kind must have; `None` for a PUBLISH, whose flags carry information.
    const fn flags(self) -> Option<u8> {
        if matches!(self, PacketKind::Publish) {
            return None;
        }
        Some(if matches!(self, PacketKind::Pubrel | PacketKind::Subscribe | PacketKind::Unsubscribe) { 2 } else { 0 })
    }

    /// The first byte of a packet of this kind, with the flags that it must have. The flags of a PUBLISH are all
    /// clear.
    #[must_use]
    pub const fn first_byte(self) -> u8 {
        let flags = match self.flags() {
            Some(flags) => flags,
            None => 0,
        };
        (self as u8) << 4 | flags
    }
}

/// Finds the packet at the head of a stream; `None` until all of it has arrived. `limit` is the maximum length of the
/// whole packet in bytes.
///
/// # Errors
/// When the first bytes cannot begin a valid packet, or when the packet is longer than `limit`.
pub fn frame(stream: &[u8], limit: usize) -> Result<Option<Frame>, Malformed> {
    let Some(&first) = stream.first() else { return Ok(None) };
    let kind = PacketKind::of(first).ok_or(Malformed::Kind(first))?;
    let Some((body, bytes)) = length(&stream[1..])? else { return Ok(None) };
    let head = 1 + bytes;
    let length = head + body;
    if length > limit {
        return Err(Malformed::TooLong { length, limit });
    }
    Ok((stream.len() >= length).then_some(Frame { kind, flags: first & 15, head, length }))
}

/// Reads the remaining length at the head of these bytes. Returns it with the number of bytes that encode it, 4 at
/// most. `None` if the length has not arrived completely.
pub(crate) fn length(bytes: &[u8]) -> Result<Option<(usize, usize)>, Malformed> {
    let mut length = 0;
    for (place, &byte) in bytes.iter().take(4).enumerate() {
        length |= usize::from(byte & 0x7F) << (7 * place);
        if byte & 0x80 == 0 {
            return Ok(Some((length, place + 1)));
        }
    }
    if bytes.len() >= 4 { Err(Malformed::Length) } else { Ok(None) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_packet_is_seen_when_it_is_there_whole() {
        let stream = [0x30, 5, 0, 1, b'a', 7, 8, 0xC0, 0];
        for end in 0..7 {
            assert_eq!(frame(&stream[..end], 100), Ok(None), "{end}");
        }
        assert_eq!(frame(&stream, 100), Ok(Some(Frame { kind: PacketKind::Publish, flags: 0, head: 2, length: 7 })));
        assert_eq!(frame(&stream[7..], 2), Ok(Some(Frame { kind: PacketKind::Pingreq, flags: 0, head: 2, length: 2 })));
    }

    #[test]
    fn a_long_length_is_read_and_one_too_long_is_refused_before_its_bytes_come() {
        let head = [0x3D, 0xFF, 0xFF, 0xFF, 0x7F];
        assert_eq!(frame(&head, 268_435_460), Ok(None));
        assert_eq!(frame(&head, 1000), Err(Malformed::TooLong { length: 268_435_460, limit: 1000 }));
        assert_eq!(frame(&head[..4], 1000), Ok(None));
        assert_eq!(frame(&[0x30, 0x80, 0x80, 0x80, 0x80], 1000), Err(Malformed::Length));
        assert_eq!(frame(&[0x30, 98], 100), Ok(None));
        assert_eq!(frame(&[0x30, 99], 100), Err(Malformed::TooLong { length: 101, limit: 100 }));
    }

    #[test]
    fn only_the_flags_of_the_standard_are_taken() {
        let good = (0_u8..=255).filter(|first| frame(&[*first], 100).is_ok());
        let others = [0x10, 0x20, 0x40, 0x50, 0x62, 0x70, 0x82, 0x90, 0xA2, 0xB0, 0xC0, 0xD0, 0xE0, 0xF0];
        let mut expected: Vec<u8> = (0x30..=0x3F).chain(others).collect();
        expected.sort_unstable();
        assert_eq!(good.collect::<Vec<_>>(), expected);
    }
}
