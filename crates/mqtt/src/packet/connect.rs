//! CONNECT (section 3.1): the client's name and options, and its will. Whether the client may connect is not decided
//! here.

use bytes::Bytes;

use super::properties::{Properties, Property, PropertyContext, that_go_on};
use super::reason::Reason;
use super::write::{Connack, Welcome, connack};
use super::{PacketFields, Qos, Version};
use crate::frame::Malformed;
use crate::limits::PROPERTIES;

/// Session expiry, in seconds, of a session that never ends (MQTT 5, section 3.1.2.11.2).
pub const FOR_EVER_S: u32 = u32::MAX;

/// The contents of a CONNECT, in the terms of MQTT 5. The flags of a CONNECT of MQTT 3.1.1 are translated.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Connect {
    /// The client id, which may be empty (section 3.1.3.1).
    pub client_id: String,
    /// Whether the client begins a new session, even if it has an old one.
    pub clean_start: bool,
    /// How long the session is stored after the connection, in seconds; [`FOR_EVER_S`] means for ever.
    pub session_expiry_s: u32,
    /// The client's longest silence in seconds; 0 means no limit.
    pub keep_alive_s: u16,
    /// The message to publish if the client goes without a normal DISCONNECT.
    pub will: Option<Will>,
    /// Limits on the packets for the client; in MQTT 3.1.1 there are none.
    pub reception: Reception,
    /// The version, the user name and the password. Name and password were not checked.
    pub credentials: Credentials,
}

/// Limits that a client sets on the packets that it receives (MQTT 5, section 3.1.2.11).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reception {
    /// Maximum number of messages of QoS 1 and 2 that may be unacknowledged at a time; never 0.
    pub receive_maximum: u16,
    /// Longest packet that the client accepts, in bytes.
    pub largest: u32,
    /// Maximum number of topic aliases that the broker may set for the client; 0 means none.
    pub aliases: u16,
    /// Whether the client wants reasons in words: Request Problem Information (MQTT 5, section 3.1.2.11.7).
    pub wants_words: bool,
}

/// The message that is published when its client goes without a normal DISCONNECT. Its form was checked.
/// `Broker::may_leave_will` decides whether its topic is allowed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Will {
    /// The topic, which is not empty and has no wildcards. Its length and its levels are not checked here.
    pub topic: String,
    /// The payload of at most 65,535 bytes, since its length is written in two bytes.
    pub payload: Bytes,
    /// The QoS at which the will is published. Subscribers get it at this QoS or a lower one.
    pub qos: Qos,
    /// Whether to retain the will when it is published, if there is room at that time.
    pub retain: bool,
    /// The time in seconds in which the client may come back before the will is published.
    pub delay_s: u32,
    /// How long after its publication the will expires, in seconds.
    pub expiry_s: Option<u32>,
    /// The properties of the will that are forwarded to subscribers, in the encoding of MQTT 5.
    pub properties: Bytes,
}

/// Why a CONNECT cannot be accepted. Send [`NoConnect::answer`] before closing the connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NoConnect {
    /// The protocol level of a version that is not supported, such as 3 for MQTT 3.1.
    #[error("the client uses protocol level {0}, but only 4 (MQTT 3.1.1) and 5 (MQTT 5) are supported")]
    Level(u8),
    /// The version of the CONNECT, and the error in it. Only a client of MQTT 5 is told the error.
    #[error("{1}")]
    Malformed(Version, Malformed),
    /// The client asks for enhanced authentication, which is not supported (MQTT 5, section 4.12).
    #[error("the client asks for enhanced authentication, but only a name and a password are supported")]
    Authentication,
}

impl NoConnect {
    /// The bytes to send before the connection is closed. Empty for a malformed CONNECT of MQTT 3.1.1, which has no
    /// return code for such an error.
    #[must_use]
    pub fn answer(self) -> Vec<u8> {
        let five = |reason: Reason| Connack { words: Some(&self.to_string()), ..Connack::of(reason) }.written(u32::MAX);
        match self {
            NoConnect::Level(_) => connack(Welcome::Version, false).to_vec(),
            NoConnect::Malformed(Version::Three, _) => Vec::new(),
            NoConnect::Malformed(Version::Five, wrong) => five(wrong.reason()),
            NoConnect::Authentication => five(Reason::AuthenticationMethod),
        }
    }
}

impl Default for Reception {
    /// The defaults of the standard: no limits, and no topic aliases.
    fn default() -> Reception {
        Reception { receive_maximum: u16::MAX, largest: u32::MAX, aliases: 0, wants_words: true }
    }
}

impl Connect {
    /// The version by which all later packets of the client are read.
    #[must_use]
    pub const fn version(&self) -> Version {
        self.credentials.version
    }
}

impl std::fmt::Debug for Connect {
    /// Leaves out name and password, which must not be logged.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Connect({:?})", self.client_id)
    }
}

/// Reads the body of a CONNECT. The contents are copied, since they outlive the packet.
///
/// # Errors
/// When the client uses another version or asks for enhanced authentication, or when the packet is malformed.
pub fn read(body: &[u8]) -> Result<Connect, NoConnect> {
    let mut fields = PacketFields::new(body);
    let version = version(&mut fields)?;
    let connect = read_of(version, &mut fields).map_err(|wrong| NoConnect::Malformed(version, wrong))?;
    connect.ok_or(NoConnect::Authentication)
}

/// Reads a CONNECT of this version; `None` if it asks for enhanced authentication.
fn read_of(version: Version, fields: &mut PacketFields<'_>) -> Result<Option<Connect>, Malformed> {
    let flags = flags(fields.byte("flags")?, version)?;
    let clean_start = flags & 2 != 0;
    let keep_alive_s = fields.number("keep alive")?;
    let (mut session_expiry_s, mut reception, mut is_known) = (0, Reception::default(), true);
    match version {
        Version::Three => session_expiry_s = if clean_start { 0 } else { FOR_EVER_S },
        Version::Five => {
            let (mut has_data, mut has_method) = (false, false);
            for property in Properties::read(fields, PropertyContext::Connect)? {
                if let Property::SessionExpiry(seconds) = property {
                    session_expiry_s = seconds;
                } else if let Property::ReceiveMaximum(most) = property {
                    reception.receive_maximum = most;
                } else if let Property::MaximumPacket(largest) = property {
                    reception.largest = largest;
                } else if let Property::TopicAliasMaximum(most) = property {
                    reception.aliases = most;
                } else if let Property::RequestProblem(flag) = property {
                    reception.wants_words = flag == 1;
                }
                has_method |= matches!(property, Property::AuthenticationMethod(_));
                has_data |= matches!(property, Property::AuthenticationData(_));
            }
            if has_data && !has_method {
                return Err(Malformed::PropertyValue(0x16));
            }
            is_known = !has_method;
        }
    }
    let client_id = fields.text("client id")?.to_owned();
    let will = if flags & 4 == 0 { None } else { Some(will(fields, flags, version)?) };
    let name = if flags & 0x80 == 0 { None } else { Some(fields.text("name")?.to_owned()) };
    let password = if flags & 0x40 == 0 { None } else { Some(Bytes::copy_from_slice(fields.bytes("password")?)) };
    fields.end()?;
    let credentials = Credentials { name, password, version };
    let connect = Connect { client_id, clean_start, session_expiry_s, keep_alive_s, will, reception, credentials };
    Ok(is_known.then_some(connect))
}

/// The credentials in a CONNECT. As many as possible are read, even if the CONNECT is malformed or of another
/// version.
#[derive(Clone, Default, PartialEq, Eq)]
pub struct Credentials {
    /// The user name; `None` if the CONNECT has none, or it could not be read.
    pub name: Option<String>,
    /// The password, which need not be text.
    pub password: Option<Bytes>,
    /// The version in the CONNECT; 3.1.1 stands for any version but 5.
    pub version: Version,
}

impl std::fmt::Debug for Credentials {
    /// Leaves out name and password, which must not be logged.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Credentials").field("version", &self.version).finish_non_exhaustive()
    }
}

/// Reads the credentials in the body of a CONNECT, even if it is malformed.
#[must_use]
pub fn credentials(body: &[u8]) -> Credentials {
    let mut credentials = Credentials::default();
    let _ = read_credentials(&mut PacketFields::new(body), &mut credentials);
    credentials
}

fn read_credentials(fields: &mut PacketFields<'_>, credentials: &mut Credentials) -> Result<(), Malformed> {
    fields.bytes("protocol")?;
    if fields.byte("level")? == 5 {
        credentials.version = Version::Five;
    }
    let flags = fields.byte("flags")?;
    fields.number("keep alive")?;
    skip_properties(fields, credentials.version)?;
    fields.bytes("client id")?;
    if flags & 4 != 0 {
        skip_properties(fields, credentials.version)?;
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

/// Skips the properties that MQTT 5 has before some fields (section 2.2.2).
fn skip_properties(fields: &mut PacketFields<'_>, version: Version) -> Result<(), Malformed> {
    let mut length = 0;
    for place in 0..if version == Version::Five { 4 } else { 0 } {
        let byte = fields.byte("properties")?;
        length |= usize::from(byte & 0x7F) << (7 * place);
        if byte & 0x80 == 0 {
            break;
        }
    }
    (0..length).try_for_each(|_| fields.byte("properties").map(drop))
}

fn version(fields: &mut PacketFields<'_>) -> Result<Version, NoConnect> {
    let mut begin = || Ok((fields.bytes("protocol")?, fields.byte("level")?));
    let (protocol, level) = begin().map_err(|wrong| NoConnect::Malformed(Version::Three, wrong))?;
    match (protocol, level) {
        (b"MQTT", 4) => Ok(Version::Three),
        (b"MQTT", 5) => Ok(Version::Five),
        (b"MQTT" | b"MQIsdp", level) => Err(NoConnect::Level(level)),
        _ => Err(NoConnect::Malformed(Version::Three, Malformed::Protocol)),
    }
}

/// Refuses flags that contradict each other, by sections 3.1.2.3 to 3.1.2.9.
fn flags(flags: u8, version: Version) -> Result<u8, Malformed> {
    let will_without_a_will = flags & 4 == 0 && flags & 0x38 != 0;
    let password_without_a_name = version == Version::Three && flags & 0x80 == 0 && flags & 0x40 != 0;
    let is_wrong = flags & 1 != 0 || flags & 0x18 == 0x18 || will_without_a_will || password_without_a_name;
    if is_wrong { Err(Malformed::ConnectFlags(flags)) } else { Ok(flags) }
}

fn will(fields: &mut PacketFields<'_>, flags: u8, version: Version) -> Result<Will, Malformed> {
    let properties = match version {
        Version::Three => Properties::default(),
        Version::Five => Properties::read(fields, PropertyContext::Will)?,
    };
    let topic = fields.text("topic of the will")?;
    if topic.is_empty() || topic.contains(['+', '#']) {
        return Err(Malformed::Topic);
    }
    let payload = Bytes::copy_from_slice(fields.bytes("will")?);
    let length = properties.bytes().len();
    if length > PROPERTIES {
        return Err(Malformed::TooLong { length, limit: PROPERTIES });
    }
    let (mut delay_s, mut expiry_s) = (0, None);
    for property in properties {
        if let Property::WillDelay(seconds) = property {
            delay_s = seconds;
        } else if let Property::MessageExpiry(seconds) = property {
            expiry_s = Some(seconds);
        }
    }
    Ok(Will {
        topic: topic.to_owned(),
        payload,
        qos: Qos::of(flags >> 3 & 3)?,
        retain: flags & 0x20 != 0,
        delay_s,
        expiry_s,
        properties: that_go_on(properties).freeze(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Builds the body of a CONNECT: protocol, level, flags, a keep alive of 60 s, and these fields.
    fn body(protocol: &str, level: u8, flags: u8, fields: &[&[u8]]) -> Vec<u8> {
        let field = |bytes: &[u8]| [&u16::try_from(bytes.len()).unwrap().to_be_bytes(), bytes].concat();
        let fields = fields.iter().flat_map(|bytes| field(bytes));
        [field(protocol.as_bytes()), vec![level, flags, 0, 60]].concat().into_iter().chain(fields).collect()
    }

    #[test]
    fn all_of_a_connect_is_read() {
        let connect = read(&body("MQTT", 4, 0xEC, &[b"id", b"a/b", b"gone", b"me", &[0xFF]])).unwrap();
        assert_eq!((&*connect.client_id, connect.clean_start, connect.keep_alive_s), ("id", false, 60));
        let will = connect.will.unwrap();
        assert_eq!((&*will.topic, &*will.payload, will.qos, will.retain), ("a/b", &b"gone"[..], Qos::One, true));
        assert_eq!((connect.credentials.name.as_deref(), connect.session_expiry_s), (Some("me"), FOR_EVER_S));
        assert_eq!(connect.credentials.password.as_deref(), Some(&[0xFF][..]));
        let clean = read(&body("MQTT", 4, 2, &[b""])).unwrap();
        assert_eq!((clean.clean_start, clean.session_expiry_s, clean.version()), (true, 0, Version::Three));
    }

    /// Builds the body of a CONNECT of MQTT 5. `properties` come before the client id, and `of_will` are the
    /// properties of a will.
    fn five(flags: u8, properties: &[Property<'_>], of_will: &[Property<'_>]) -> Vec<u8> {
        let mut out = bytes::BytesMut::from(&body("MQTT", 5, flags, &[])[..]);
        let put = |out: &mut bytes::BytesMut, properties: &[Property<'_>]| {
            let mut written = bytes::BytesMut::new();
            properties.iter().for_each(|property| property.write(&mut written));
            super::super::properties::put_variable(out, u32::try_from(written.len()).unwrap());
            out.extend_from_slice(&written);
        };
        put(&mut out, properties);
        out.extend_from_slice(&[0, 2, b'i', b'd']);
        if flags & 4 != 0 {
            put(&mut out, of_will);
            out.extend_from_slice(&[0, 1, b'a', 0, 1, b'w']);
        }
        out.to_vec()
    }

    #[test]
    fn all_of_a_connect_of_mqtt_5_is_read() {
        let properties = [
            Property::SessionExpiry(60),
            Property::ReceiveMaximum(3),
            Property::MaximumPacket(100),
            Property::TopicAliasMaximum(5),
            Property::RequestProblem(0),
            Property::RequestResponse(1),
            Property::User("a", "b"),
            Property::User("a", "c"),
        ];
        let of_will = [Property::WillDelay(7), Property::MessageExpiry(9), Property::User("x", "y"), Property::PayloadFormat(1)];
        let connect = read(&five(6, &properties, &of_will)).unwrap();
        assert_eq!((connect.version(), connect.session_expiry_s, connect.clean_start), (Version::Five, 60, true));
        let reception = Reception { receive_maximum: 3, largest: 100, aliases: 5, wants_words: false };
        let will = connect.will.unwrap();
        assert_eq!((connect.reception, will.delay_s, will.expiry_s), (reception, 7, Some(9)));
        assert_eq!(&will.properties[..], &that_go_on([Property::User("x", "y"), Property::PayloadFormat(1)])[..]);
        let least = read(&five(0, &[], &[])).unwrap();
        assert_eq!((least.session_expiry_s, least.reception, least.clean_start), (0, Reception::default(), false));
        let mut with_password = five(0x42, &[], &[]);
        with_password.extend_from_slice(&[0, 1, b'p']);
        assert_eq!(read(&with_password).unwrap().credentials.password.as_deref(), Some(&b"p"[..]), "a name is not needed");
    }

    #[test]
    fn another_version_is_told_in_its_own_words() {
        for (protocol, level) in [("MQIsdp", 3), ("MQTT", 3), ("MQTT", 6), ("MQTT", 0x84), ("MQIsdp", 4), ("MQIsdp", 5)] {
            let other = read(&body(protocol, level, 2, &[b"id"])).unwrap_err();
            assert_eq!((other, &other.answer()[..]), (NoConnect::Level(level), &[0x20, 2, 0, 1][..]));
        }
    }

    #[test]
    fn what_is_wrong_in_mqtt_5_is_told_with_a_reason() {
        let method = Property::AuthenticationMethod("SCRAM");
        let cases: [(Vec<u8>, u8); 9] = [
            (five(2, &[method, Property::AuthenticationData(b"x")], &[]), 0x8C),
            (five(2, &[Property::AuthenticationData(b"x")], &[]), 0x82),
            (five(2, &[Property::ReceiveMaximum(0)], &[]), 0x82),
            (five(2, &[Property::MaximumPacket(0)], &[]), 0x82),
            (five(2, &[Property::SessionExpiry(1), Property::SessionExpiry(1)], &[]), 0x82),
            (five(2, &[Property::TopicAlias(1)], &[]), 0x81),
            (five(6, &[], &[Property::ResponseTopic("a/#")]), 0x82),
            (five(3, &[], &[]), 0x81),
            (five(2, &[], &[])[..10].to_vec(), 0x81),
        ];
        for (body, reason) in cases {
            let answer = read(&body).unwrap_err().answer();
            assert_eq!((answer[0], answer[2], answer[3]), (0x20, 0, reason), "{body:?}");
        }
    }

    /// Credentials are read even if other parts of the CONNECT are wrong.
    #[test]
    fn who_sends_a_connect_is_read_although_it_is_wrong_or_of_another_version() {
        let me = |version| Credentials { name: Some("me".to_owned()), password: Some(Bytes::from("secret")), version };
        let fields: [&[u8]; 5] = [b"id", b"a/b", b"gone", b"me", b"secret"];
        for (protocol, level) in [("MQTT", 4), ("MQIsdp", 3), ("MQTT", 7), ("HTTP", 4)] {
            for flags in [0xEC, 0xC7, 0xFE] {
                assert_eq!(
                    credentials(&body(protocol, level, flags, &fields)),
                    me(Version::Three),
                    "{protocol} {level} {flags:#x}"
                );
            }
        }
        let wrong = body("MQTT", 4, 0xC2, &[&[0xC3], b"me", b"secret", b"more"]);
        assert_eq!(credentials(&wrong), me(Version::Three));
        let mut five = body("MQTT", 5, 0xC2, &[]);
        five.extend([&[5, 0x11, 0, 0, 0, 9][..], &[0, 2], b"id", &[0, 2], b"me", &[0, 6], b"secret"].concat());
        assert_eq!(credentials(&five), me(Version::Five));
        let mut with_will = body("MQTT", 5, 0xC6, &[]);
        with_will.extend([&[0, 0, 0][..], &[2, 1, 1], &[0, 1, b'a', 0, 0], &[0, 2], b"me", &[0, 6], b"secret"].concat());
        assert_eq!(credentials(&with_will), me(Version::Five));
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
            assert_eq!(read(&body), Err(NoConnect::Malformed(Version::Three, expected)), "{body:?}");
        }
        let whole = body("MQTT", 4, 0xEC, &[b"id", b"a/b", b"gone", b"me", b"secret"]);
        for end in 0..whole.len() {
            assert!(read(&whole[..end]).is_err(), "{end}");
        }
    }
}
