//! Where packets begin and end in a stream of bytes (section 2.2, in both versions), and what can be wrong with one. What is in a packet
//! is read in `packet`.

use super::limits::{ALIASES, PACKET_FILTERS};
use super::packet::reason::Reason;

/// The kinds of packets.
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
    /// Of MQTT 5 alone.
    Auth,
}

/// The packet at the head of a stream: its kind, and where its parts are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// What it is.
    pub kind: PacketKind,
    /// The four flags beside the kind; those of all kinds but PUBLISH are as they must be.
    pub flags: u8,
    /// Bytes before the body.
    pub head: usize,
    /// Bytes in all.
    pub length: usize,
}

/// What is wrong with a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Malformed {
    /// No packet begins so.
    #[error("no packet begins with the byte {0:#04x}")]
    Kind(u8),
    /// The length does not end.
    #[error("the length of a packet has more than four bytes")]
    Length,
    /// Too long for this sender.
    #[error("a packet of {length} bytes is longer than the {limit} that are taken")]
    TooLong {
        /// Its length in bytes.
        length: usize,
        /// The most.
        limit: usize,
    },
    /// It ends within something.
    #[error("a packet ends within its {0}")]
    Short(&'static str),
    /// It goes on where it should end.
    #[error("{0} bytes follow the end of a packet")]
    Trailing(usize),
    /// Text that is none.
    #[error("the {0} of a packet is not UTF-8, or has a U+0000 in it")]
    Text(&'static str),
    /// A QoS beyond 2, or flags beside it.
    #[error("{0:#04x} is no QoS")]
    Qos(u8),
    /// Marked as a duplicate of what is never sent twice.
    #[error("a PUBLISH of QoS 0 is marked as a duplicate")]
    Duplicate,
    /// The packet id 0.
    #[error("a packet has the id 0")]
    Id,
    /// A topic to publish on that is empty or has wildcards.
    #[error("a PUBLISH has an empty topic, or one with wildcards")]
    Topic,
    /// A SUBSCRIBE or UNSUBSCRIBE of nothing.
    #[error("a packet names no filter, or an empty one")]
    Filters,
    /// A SUBSCRIBE or UNSUBSCRIBE of too many.
    #[error("a packet names more than {PACKET_FILTERS} filters")]
    ManyFilters,
    /// Flags of a CONNECT that contradict each other.
    #[error("the flags {0:#04x} of a CONNECT contradict each other")]
    ConnectFlags(u8),
    /// A property that is none, or cannot stand there.
    #[error("the property {0:#04x} is not known, or cannot stand where it does")]
    Property(u8),
    /// A property that stands there once, and did already.
    #[error("the property {0:#04x} stands in a packet twice")]
    PropertyTwice(u8),
    /// A property that cannot say what it says.
    #[error("the property {0:#04x} says what it cannot say")]
    PropertyValue(u8),
    /// Options of a subscription that do not exist.
    #[error("{0:#04x} are no options of a subscription")]
    Options(u8),
    /// Whoever shares a subscription with others cannot leave out what is its own.
    #[error("a shared subscription has the option No Local")]
    SharedNoLocal,
    /// A topic alias beyond those that are taken.
    #[error("a PUBLISH has the topic alias {0}, and at most {ALIASES} are taken, from 1 on")]
    Alias(u16),
    /// A topic alias that stands for no topic.
    #[error("a PUBLISH has no topic, and its topic alias stands for none")]
    NoTopic,
    /// A session that ended with its connection is to last now.
    #[error("a DISCONNECT asks for a session that its CONNECT has not asked for")]
    SessionExpiry,
    /// A reason that there is not.
    #[error("the packet cannot have the reason {0:#04x}")]
    Reason(u8),
    /// A CONNECT of some other protocol.
    #[error("a CONNECT is for a protocol that is not MQTT")]
    Protocol,
}

impl Malformed {
    /// What one of MQTT 5 is told: whether it is the form that is wrong, or what is said in it (section 4.13).
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

    /// The flags of this kind; `None`: they tell something.
    const fn flags(self) -> Option<u8> {
        if matches!(self, PacketKind::Publish) {
            return None;
        }
        Some(if matches!(self, PacketKind::Pubrel | PacketKind::Subscribe | PacketKind::Unsubscribe) { 2 } else { 0 })
    }

    /// The first byte of such a packet, its flags as they must be; those of a PUBLISH are all clear.
    #[must_use]
    pub const fn first_byte(self) -> u8 {
        let flags = match self.flags() {
            Some(flags) => flags,
            None => 0,
        };
        (self as u8) << 4 | flags
    }
}

/// The packet at the head of a stream, once it is there whole; `limit` in bytes for the whole of it.
///
/// # Errors
/// As soon as it is seen that no packet can begin so, or that it would be too long.
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

/// The remaining length at the head of this, and in how many bytes it is written.
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
