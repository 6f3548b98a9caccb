//! CONNECT (section 3.1): who comes, and what it leaves behind. Whether it is let in is not decided here.

use bytes::Bytes;

use super::{Fields, Qos};
use crate::frame::Malformed;

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
    /// By what its sender can be known.
    pub credentials: Credentials,
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
    let credentials = Credentials { name, password, is_five: false };
    Ok(Connect { client_id, clean_session: flags & 2 != 0, keep_alive_s, will, credentials })
}

/// By what the sender of a CONNECT can be known, as far as that can be read of one that is wrong, or of another version.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Credentials {
    /// Its name.
    pub name: Option<String>,
    /// Its password.
    pub password: Option<Bytes>,
    /// Whether it speaks MQTT 5.
    pub is_five: bool,
}

impl std::fmt::Debug for Credentials {
    /// Without name and password, which are in no log.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Credentials").field("is_five", &self.is_five).finish_non_exhaustive()
    }
}

/// Reads the credentials in the body of a CONNECT, whatever else is wrong.
#[must_use]
pub fn credentials(body: &[u8]) -> Credentials {
    let mut credentials = Credentials::default();
    let _ = read_credentials(&mut Fields::new(body), &mut credentials);
    credentials
}

fn read_credentials(fields: &mut Fields<'_>, credentials: &mut Credentials) -> Result<(), Malformed> {
    fields.bytes("protocol")?;
    credentials.is_five = fields.byte("level")? == 5;
    let flags = fields.byte("flags")?;
    fields.number("keep alive")?;
    skip_properties(fields, credentials.is_five)?;
    fields.bytes("client id")?;
    if flags & 4 != 0 {
        skip_properties(fields, credentials.is_five)?;
        fields.bytes("topic of the will")?;
        fields.bytes("will")?;
    }
    if flags & 0x80 != 0 {
        credentials.name = Some(fields.text("name")?.to_owned());
    }
    if flags & 0x40 != 0 {
        credentials.password = Some(Bytes::copy_from_slice(fields.bytes("password")?));
    }
    Ok(())
}

/// What MQTT 5 has before some fields (section 2.2.2).
fn skip_properties(fields: &mut Fields<'_>, is_five: bool) -> Result<(), Malformed> {
    let mut length = 0;
    for place in 0..if is_five { 4 } else { 0 } {
        let byte = fields.byte("properties")?;
        length |= usize::from(byte & 0x7F) << (7 * place);
        if byte & 0x80 == 0 {
            break;
        }
    }
    (0..length).try_for_each(|_| fields.byte("properties").map(drop))
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A body: protocol, level, flags, 60 s, and these fields.
    fn body(protocol: &str, level: u8, flags: u8, fields: &[&[u8]]) -> Vec<u8> {
        let field = |bytes: &[u8]| [&u16::try_from(bytes.len()).unwrap().to_be_bytes(), bytes].concat();
        let fields = fields.iter().flat_map(|bytes| field(bytes));
        [field(protocol.as_bytes()), vec![level, flags, 0, 60]].concat().into_iter().chain(fields).collect()
    }

    #[test]
    fn all_of_a_connect_is_read() {
        let connect = read(&body("MQTT", 4, 0xEC, &[b"id", b"a/b", b"gone", b"me", &[0xFF]])).unwrap();
        assert_eq!((&*connect.client_id, connect.clean_session, connect.keep_alive_s), ("id", false, 60));
        let will = Will { topic: "a/b".to_owned(), payload: Bytes::from("gone"), qos: Qos::One, retain: true };
        assert_eq!((connect.will, connect.credentials.name.as_deref()), (Some(will), Some("me")));
        assert_eq!(connect.credentials.password.as_deref(), Some(&[0xFF][..]));
        assert!(read(&body("MQTT", 4, 2, &[b""])).unwrap().clean_session);
    }

    #[test]
    fn another_version_is_told_in_its_own_words() {
        let five = read(&body("MQTT", 5, 2, &[b"", b"x"])).unwrap_err();
        assert_eq!((five, five.answer()), (NoConnect::Five, &[0x20, 3, 0, 0x84, 0][..]));
        for (protocol, level) in [("MQIsdp", 3), ("MQTT", 3), ("MQTT", 6), ("MQTT", 0x84), ("MQIsdp", 4)] {
            let other = read(&body(protocol, level, 2, &[b"id"])).unwrap_err();
            assert_eq!((other, other.answer()), (NoConnect::Level(level), &[0x20, 2, 0, 1][..]));
        }
    }

    /// Who asks is known whatever else is wrong.
    #[test]
    fn who_sends_a_connect_is_read_although_it_is_wrong_or_of_another_version() {
        let me = |is_five| Credentials { name: Some("me".to_owned()), password: Some(Bytes::from("secret")), is_five };
        let fields: [&[u8]; 5] = [b"id", b"a/b", b"gone", b"me", b"secret"];
        for (protocol, level) in [("MQTT", 4), ("MQIsdp", 3), ("MQTT", 7), ("HTTP", 4)] {
            for flags in [0xEC, 0xC7, 0xFE] {
                assert_eq!(credentials(&body(protocol, level, flags, &fields)), me(false), "{protocol} {level} {flags:#x}");
            }
        }
        let wrong = body("MQTT", 4, 0xC2, &[&[0xC3], b"me", b"secret", b"more"]);
        assert_eq!(credentials(&wrong), me(false));
        let mut five = body("MQTT", 5, 0xC2, &[]);
        five.extend([&[5, 0x11, 0, 0, 0, 9][..], &[0, 2], b"id", &[0, 2], b"me", &[0, 6], b"secret"].concat());
        assert_eq!(credentials(&five), me(true));
        let mut with_will = body("MQTT", 5, 0xC6, &[]);
        with_will.extend([&[0, 0, 0][..], &[2, 1, 1], &[0, 1, b'a', 0, 0], &[0, 2], b"me", &[0, 6], b"secret"].concat());
        assert_eq!(credentials(&with_will), me(true));
        for end in 0..five.len() {
            assert_eq!(credentials(&five[..end]).password, None, "{end}");
        }
    }

    #[test]
    fn a_connect_that_is_wrong_anywhere_is_wrong() {
        let wrong: [(Vec<u8>, Malformed); 13] = [
            (body("HTTP", 4, 2, &[b"id"]), Malformed::Protocol),
            (body("MQTT", 4, 3, &[b"id"]), Malformed::ConnectFlags(3)),
            (body("MQTT", 4, 0x0A, &[b"id"]), Malformed::ConnectFlags(0x0A)),
            (body("MQTT", 4, 0x22, &[b"id"]), Malformed::ConnectFlags(0x22)),
            (body("MQTT", 4, 0x1E, &[b"id", b"a", b""]), Malformed::ConnectFlags(0x1E)),
            (body("MQTT", 4, 0x42, &[b"id", b"p"]), Malformed::ConnectFlags(0x42)),
            (body("MQTT", 4, 6, &[b"id", b"a/#", b""]), Malformed::Topic),
            (body("MQTT", 4, 6, &[b"id", b"", b""]), Malformed::Topic),
            (body("MQTT", 4, 6, &[b"id", b"a"]), Malformed::Short("will")),
            (body("MQTT", 4, 2, &[&[0xC3]]), Malformed::Text("client id")),
            (body("MQTT", 4, 2, &[b"a\0"]), Malformed::Text("client id")),
            (body("MQTT", 4, 2, &[b"id", b"more"]), Malformed::Trailing(6)),
            (body("MQTT", 4, 0x82, &[b"id"]), Malformed::Short("name")),
        ];
        for (body, expected) in wrong {
            assert_eq!(read(&body), Err(expected.into()), "{body:?}");
        }
        let whole = body("MQTT", 4, 0xEC, &[b"id", b"a/b", b"gone", b"me", b"secret"]);
        for end in 0..whole.len() {
            assert!(read(&whole[..end]).is_err(), "{end}");
        }
    }
}
