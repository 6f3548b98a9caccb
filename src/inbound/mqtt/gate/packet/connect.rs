//! CONNECT (section 3.1): who comes, and what it leaves behind. Whether it is let in is not decided here.

use bytes::Bytes;

use super::{Fields, Qos};
use crate::inbound::mqtt::gate::frame::Malformed;

/// A CONNECT of MQTT 3.1.1.
#[derive(Clone, PartialEq, Eq)]
pub struct Connect {
    /// By what name it calls itself; may be empty.
    pub client_id: String,
    /// Whether nothing is remembered of it.
    pub clean_session: bool,
    /// Its longest silence in seconds; 0: it may be silent for ever.
    pub keep_alive_s: u16,
    /// What is published when it goes without a word.
    pub will: Option<Will>,
    /// Its name.
    pub name: Option<String>,
    /// Its password.
    pub password: Option<Bytes>,
}

/// A last will.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Will {
    /// Where: a topic without wildcards.
    pub topic: String,
    /// What.
    pub payload: Bytes,
    /// How often it comes to those who subscribed.
    pub qos: Qos,
    /// Whether it is kept.
    pub retain: bool,
}

/// Why a CONNECT is not one to go on with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoConnect {
    /// It speaks MQTT 5.
    #[error("it speaks MQTT 5, and only 3.1.1 is spoken here")]
    Five,
    /// It speaks some other version.
    #[error("it speaks level {0} of the protocol, and only 4, which is MQTT 3.1.1, is spoken here")]
    Level(u8),
    /// It is malformed.
    #[error(transparent)]
    Malformed(#[from] Malformed),
}

impl NoConnect {
    /// What the client is told before the connection is closed; of MQTT 5, in MQTT 5.
    #[must_use]
    pub const fn answer(self) -> &'static [u8] {
        match self {
            NoConnect::Five => &[0x20, 3, 0, 0x84, 0],
            NoConnect::Level(_) => &[0x20, 2, 0, 1],
            NoConnect::Malformed(_) => &[],
        }
    }
}

impl std::fmt::Debug for Connect {
    /// Without name and password, which are in no log.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Connect({:?})", self.client_id)
    }
}

/// Reads the body of a CONNECT.
///
/// # Errors
/// When it is of another version, or wrong.
pub fn read(body: &[u8]) -> Result<Connect, NoConnect> {
    let mut fields = Fields::new(body);
    version(&mut fields)?;
    let flags = flags(fields.byte("flags")?)?;
    let keep_alive_s = fields.number("keep alive")?;
    let client_id = fields.text("client id")?.to_owned();
    let will = if flags & 4 == 0 { None } else { Some(will(&mut fields, flags)?) };
    let name = if flags & 0x80 == 0 { None } else { Some(fields.text("name")?.to_owned()) };
    let password = if flags & 0x40 == 0 { None } else { Some(Bytes::copy_from_slice(fields.bytes("password")?)) };
    fields.end()?;
    Ok(Connect { client_id, clean_session: flags & 2 != 0, keep_alive_s, will, name, password })
}

fn version(fields: &mut Fields<'_>) -> Result<(), NoConnect> {
    let protocol = fields.bytes("protocol")?;
    if protocol != b"MQTT" && protocol != b"MQIsdp" {
        return Err(Malformed::Protocol.into());
    }
    match (protocol, fields.byte("level")?) {
        (b"MQTT", 4) => Ok(()),
        (b"MQTT", 5) => Err(NoConnect::Five),
        (_, level) => Err(NoConnect::Level(level)),
    }
}

/// The flags, when they do not contradict each other.
fn flags(flags: u8) -> Result<u8, Malformed> {
    let will_without_a_will = flags & 4 == 0 && flags & 0x38 != 0;
    let password_without_a_name = flags & 0x80 == 0 && flags & 0x40 != 0;
    let is_wrong = flags & 1 != 0 || flags & 0x18 == 0x18 || will_without_a_will || password_without_a_name;
    if is_wrong { Err(Malformed::ConnectFlags(flags)) } else { Ok(flags) }
}

fn will(fields: &mut Fields<'_>, flags: u8) -> Result<Will, Malformed> {
    let topic = fields.text("topic of the will")?;
    if topic.is_empty() || topic.contains(['+', '#']) {
        return Err(Malformed::Topic);
    }
    let payload = Bytes::copy_from_slice(fields.bytes("will")?);
    Ok(Will { topic: topic.to_owned(), payload, qos: Qos::of(flags >> 3 & 3)?, retain: flags & 0x20 != 0 })
}
