//! Reads the contents of packets, strictly by MQTT 3.1.1 and 5, and writes packets. Only the reader of CONNECT
//! allocates, and no reader panics on any bytes. What a packet may do is not decided here.

pub mod ack;
pub mod connect;
pub mod disconnect;
pub mod filters;
pub mod properties;
pub mod publish;
pub mod reason;
pub mod write;

use super::frame::{Malformed, length};

/// The version of the protocol that a client uses. Its CONNECT determines the version for the connection.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Version {
    /// MQTT 3.1.1, which is level 4 in a CONNECT.
    #[default]
    Three,
    /// MQTT 5, which is level 5 in a CONNECT.
    Five,
}

/// Quality of service: how often a message is delivered (section 4.3).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Qos {
    /// At most once, without an acknowledgement (section 4.3.1).
    Zero,
    /// At least once: repeated in later connections until a PUBACK arrives (section 4.3.2).
    One,
    /// Exactly once, by PUBREC, PUBREL and PUBCOMP (section 4.3.3).
    Two,
}

impl Qos {
    /// The QoS encoded in two bits of a packet.
    ///
    /// # Errors
    /// `Malformed::Qos` for all but 0, 1 and 2.
    pub const fn of(number: u8) -> Result<Qos, Malformed> {
        match number {
            0 => Ok(Qos::Zero),
            1 => Ok(Qos::One),
            2 => Ok(Qos::Two),
            _ => Err(Malformed::Qos(number)),
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct PacketFields<'a>(&'a [u8]);

impl<'a> PacketFields<'a> {
    pub(crate) const fn new(body: &'a [u8]) -> PacketFields<'a> {
        PacketFields(body)
    }

    pub(super) fn byte(&mut self, what: &'static str) -> Result<u8, Malformed> {
        let (&byte, rest) = self.0.split_first().ok_or(Malformed::Short(what))?;
        self.0 = rest;
        Ok(byte)
    }

    pub(super) fn number(&mut self, what: &'static str) -> Result<u16, Malformed> {
        let (&bytes, rest) = self.0.split_first_chunk().ok_or(Malformed::Short(what))?;
        self.0 = rest;
        Ok(u16::from_be_bytes(bytes))
    }

    pub(super) fn long(&mut self, what: &'static str) -> Result<u32, Malformed> {
        let (&bytes, rest) = self.0.split_first_chunk().ok_or(Malformed::Short(what))?;
        self.0 = rest;
        Ok(u32::from_be_bytes(bytes))
    }

    /// Reads a variable byte integer: one to four bytes (section 1.5.5).
    pub(super) fn variable(&mut self, what: &'static str) -> Result<u32, Malformed> {
        let (number, own) = length(self.0)?.ok_or(Malformed::Short(what))?;
        self.0 = &self.0[own..];
        Ok(number as u32)
    }

    pub(super) fn id(&mut self) -> Result<u16, Malformed> {
        match self.number("packet id")? {
            0 => Err(Malformed::Id),
            id => Ok(id),
        }
    }

    pub(super) fn bytes(&mut self, what: &'static str) -> Result<&'a [u8], Malformed> {
        let length = usize::from(self.number(what)?);
        let (bytes, rest) = self.0.split_at_checked(length).ok_or(Malformed::Short(what))?;
        self.0 = rest;
        Ok(bytes)
    }

    pub(super) fn text(&mut self, what: &'static str) -> Result<&'a str, Malformed> {
        text(self.bytes(what)?, what)
    }

    pub(super) const fn rest(self) -> &'a [u8] {
        self.0
    }

    pub(super) const fn end(self) -> Result<(), Malformed> {
        if self.0.is_empty() { Ok(()) } else { Err(Malformed::Trailing(self.0.len())) }
    }
}

/// Checks that bytes are UTF-8 without U+0000 (MQTT 3.1.1, section 1.5.3, and MQTT 5, section 1.5.4). `what` names
/// the field in the error.
pub(crate) fn text<'a>(bytes: &'a [u8], what: &'static str) -> Result<&'a str, Malformed> {
    std::str::from_utf8(bytes).ok().filter(|_| !bytes.contains(&0)).ok_or(Malformed::Text(what))
}
