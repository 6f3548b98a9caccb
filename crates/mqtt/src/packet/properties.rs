//! The properties of MQTT 5 (section 2.2.2), which a packet may have in addition to its fields. They are read
//! strictly, and not copied.

use bytes::{BufMut, BytesMut};

use super::PacketFields;
use crate::frame::{Malformed, length};

/// One property with its value, in the type of MQTT 5, table 2-4. Texts and bytes are borrowed from the packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names are those of the standard, table 2-4")]
pub enum Property<'a> {
    PayloadFormat(u8),
    MessageExpiry(u32),
    ContentType(&'a str),
    ResponseTopic(&'a str),
    CorrelationData(&'a [u8]),
    SubscriptionId(u32),
    SessionExpiry(u32),
    AssignedClientId(&'a str),
    ServerKeepAlive(u16),
    AuthenticationMethod(&'a str),
    AuthenticationData(&'a [u8]),
    RequestProblem(u8),
    WillDelay(u32),
    RequestResponse(u8),
    ReasonString(&'a str),
    ReceiveMaximum(u16),
    TopicAliasMaximum(u16),
    TopicAlias(u16),
    User(&'a str, &'a str),
    MaximumPacket(u32),
}

/// Where a property occurs: in one of the client's packets, or in the will of a CONNECT. Each place allows different
/// properties (MQTT 5, table 2-4).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names are those of the packets")]
pub enum PropertyContext {
    Connect,
    Will,
    Publish,
    Ack,
    Subscribe,
    Unsubscribe,
    Disconnect,
}

/// The properties of one packet, which have been checked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Properties<'a>(&'a [u8]);

impl<'a> Properties<'a> {
    /// Removes the properties from the beginning of `fields`, and returns them. Each of them must be known and
    /// allowed in this place. No property except the user property may occur twice.
    pub(super) fn read(fields: &mut PacketFields<'a>, place: PropertyContext) -> Result<Properties<'a>, Malformed> {
        let properties = Properties(split(fields)?);
        let (mut rest, mut seen) = (PacketFields::new(properties.0), 0_u64);
        while !rest.rest().is_empty() {
            let property = Property::read(&mut rest)?;
            let id = property.id();
            if !property.stands_in(place) {
                return Err(Malformed::Property(id));
            }
            if seen & 1 << id != 0 && !matches!(property, Property::User(..)) {
                return Err(Malformed::PropertyTwice(id));
            }
            seen |= 1 << id;
            property.check()?;
        }
        Ok(properties)
    }

    /// Removes the properties from the beginning of `fields`, and returns them. Does not check whether they are
    /// allowed there.
    #[cfg(test)]
    pub(crate) fn of_server(fields: &mut PacketFields<'a>) -> Properties<'a> {
        Properties(split(fields).unwrap())
    }

    pub(crate) const fn bytes(self) -> &'a [u8] {
        self.0
    }
}

/// Removes the properties from the beginning of `fields`, and returns them without the length that precedes them.
fn split<'a>(fields: &mut PacketFields<'a>) -> Result<&'a [u8], Malformed> {
    let wrong = Malformed::Short("properties");
    let (size, own) = length(fields.rest())?.ok_or(wrong)?;
    let (properties, rest) = fields.rest()[own..].split_at_checked(size).ok_or(wrong)?;
    *fields = PacketFields::new(rest);
    Ok(properties)
}

impl<'a> Iterator for Properties<'a> {
    type Item = Property<'a>;

    fn next(&mut self) -> Option<Property<'a>> {
        if self.0.is_empty() {
            return None;
        }
        let mut fields = PacketFields::new(self.0);
        let property = Property::read(&mut fields).ok();
        // An error ends the iteration. Properties that were checked have no errors.
        self.0 = if property.is_some() { fields.rest() } else { &[] };
        property
    }
}

impl<'a> Property<'a> {
    /// The identifier, which is the first byte of the property.
    const fn id(self) -> u8 {
        match self {
            Property::PayloadFormat(_) => 0x01,
            Property::MessageExpiry(_) => 0x02,
            Property::ContentType(_) => 0x03,
            Property::ResponseTopic(_) => 0x08,
            Property::CorrelationData(_) => 0x09,
            Property::SubscriptionId(_) => 0x0B,
            Property::SessionExpiry(_) => 0x11,
            Property::AssignedClientId(_) => 0x12,
            Property::ServerKeepAlive(_) => 0x13,
            Property::AuthenticationMethod(_) => 0x15,
            Property::AuthenticationData(_) => 0x16,
            Property::RequestProblem(_) => 0x17,
            Property::WillDelay(_) => 0x18,
            Property::RequestResponse(_) => 0x19,
            Property::ReasonString(_) => 0x1F,
            Property::ReceiveMaximum(_) => 0x21,
            Property::TopicAliasMaximum(_) => 0x22,
            Property::TopicAlias(_) => 0x23,
            Property::User(..) => 0x26,
            Property::MaximumPacket(_) => 0x27,
        }
    }

    pub(crate) fn read(fields: &mut PacketFields<'a>) -> Result<Property<'a>, Malformed> {
        const WHAT: &str = "properties";
        Ok(match fields.byte(WHAT)? {
            0x01 => Property::PayloadFormat(fields.byte(WHAT)?),
            0x02 => Property::MessageExpiry(fields.long(WHAT)?),
            0x03 => Property::ContentType(fields.text("content type")?),
            0x08 => Property::ResponseTopic(fields.text("response topic")?),
            0x09 => Property::CorrelationData(fields.bytes("correlation data")?),
            0x0B => Property::SubscriptionId(fields.variable(WHAT)?),
            0x11 => Property::SessionExpiry(fields.long(WHAT)?),
            0x12 => Property::AssignedClientId(fields.text("client id")?),
            0x13 => Property::ServerKeepAlive(fields.number(WHAT)?),
            0x15 => Property::AuthenticationMethod(fields.text("authentication method")?),
            0x16 => Property::AuthenticationData(fields.bytes("authentication data")?),
            0x17 => Property::RequestProblem(fields.byte(WHAT)?),
            0x18 => Property::WillDelay(fields.long(WHAT)?),
            0x19 => Property::RequestResponse(fields.byte(WHAT)?),
            0x1F => Property::ReasonString(fields.text("reason string")?),
            0x21 => Property::ReceiveMaximum(fields.number(WHAT)?),
            0x22 => Property::TopicAliasMaximum(fields.number(WHAT)?),
            0x23 => Property::TopicAlias(fields.number(WHAT)?),
            0x26 => Property::User(fields.text("user property")?, fields.text("user property")?),
            0x27 => Property::MaximumPacket(fields.long(WHAT)?),
            id => return Err(Malformed::Property(id)),
        })
    }

    pub(crate) fn write(self, out: &mut BytesMut) {
        out.put_u8(self.id());
        match self {
            Property::PayloadFormat(byte) | Property::RequestProblem(byte) | Property::RequestResponse(byte) => out.put_u8(byte),
            Property::MessageExpiry(number)
            | Property::SessionExpiry(number)
            | Property::WillDelay(number)
            | Property::MaximumPacket(number) => out.put_u32(number),
            Property::ServerKeepAlive(number)
            | Property::ReceiveMaximum(number)
            | Property::TopicAliasMaximum(number)
            | Property::TopicAlias(number) => out.put_u16(number),
            Property::SubscriptionId(number) => put_variable(out, number),
            Property::ContentType(text)
            | Property::ResponseTopic(text)
            | Property::AssignedClientId(text)
            | Property::AuthenticationMethod(text)
            | Property::ReasonString(text) => put_bytes(out, text.as_bytes()),
            Property::CorrelationData(bytes) | Property::AuthenticationData(bytes) => put_bytes(out, bytes),
            Property::User(name, value) => {
                put_bytes(out, name.as_bytes());
                put_bytes(out, value.as_bytes());
            }
        }
    }

    /// Whether a client may send this property in this place (MQTT 5, table 2-4).
    const fn stands_in(self, place: PropertyContext) -> bool {
        match self {
            Property::User(..) => true,
            Property::PayloadFormat(_)
            | Property::MessageExpiry(_)
            | Property::ContentType(_)
            | Property::ResponseTopic(_)
            | Property::CorrelationData(_) => matches!(place, PropertyContext::Publish | PropertyContext::Will),
            Property::SubscriptionId(_) => matches!(place, PropertyContext::Subscribe),
            Property::SessionExpiry(_) => matches!(place, PropertyContext::Connect | PropertyContext::Disconnect),
            Property::AuthenticationMethod(_)
            | Property::AuthenticationData(_)
            | Property::RequestProblem(_)
            | Property::RequestResponse(_)
            | Property::ReceiveMaximum(_)
            | Property::TopicAliasMaximum(_)
            | Property::MaximumPacket(_) => matches!(place, PropertyContext::Connect),
            Property::WillDelay(_) => matches!(place, PropertyContext::Will),
            Property::ReasonString(_) => matches!(place, PropertyContext::Ack | PropertyContext::Disconnect),
            Property::TopicAlias(_) => matches!(place, PropertyContext::Publish),
            Property::AssignedClientId(_) | Property::ServerKeepAlive(_) => false,
        }
    }

    /// Refuses values that are protocol errors, such as a maximum of 0 or a response topic with wildcards.
    fn check(self) -> Result<(), Malformed> {
        let is_good = match self {
            Property::PayloadFormat(flag) | Property::RequestProblem(flag) | Property::RequestResponse(flag) => flag <= 1,
            Property::SubscriptionId(number) | Property::MaximumPacket(number) => number > 0,
            Property::ReceiveMaximum(number) => number > 0,
            Property::ResponseTopic(topic) => !topic.is_empty() && !topic.contains(['+', '#']),
            Property::MessageExpiry(_)
            | Property::ContentType(_)
            | Property::CorrelationData(_)
            | Property::SessionExpiry(_)
            | Property::AssignedClientId(_)
            | Property::ServerKeepAlive(_)
            | Property::AuthenticationMethod(_)
            | Property::AuthenticationData(_)
            | Property::WillDelay(_)
            | Property::ReasonString(_)
            | Property::TopicAliasMaximum(_)
            | Property::TopicAlias(_)
            | Property::User(..) => true,
        };
        if is_good { Ok(()) } else { Err(Malformed::PropertyValue(self.id())) }
    }

    /// Whether this property is forwarded unchanged to the readers of a message (MQTT 5, section 3.3.2.3).
    pub(crate) const fn goes_on(self) -> bool {
        matches!(
            self,
            Property::PayloadFormat(_)
                | Property::ContentType(_)
                | Property::ResponseTopic(_)
                | Property::CorrelationData(_)
                | Property::User(..)
        )
    }
}

/// The encoding of the properties that are forwarded unchanged. Message expiry and topic alias are left out, because
/// they are written separately for each reader.
pub(crate) fn that_go_on<'a>(properties: impl IntoIterator<Item = Property<'a>>) -> BytesMut {
    let mut out = BytesMut::new();
    properties.into_iter().filter(|property| property.goes_on()).for_each(|property| property.write(&mut out));
    out
}

/// Number of bytes that encode this number as a variable byte integer (MQTT 5, section 1.5.5).
pub(crate) const fn variable_length(number: usize) -> usize {
    match number {
        0..=0x7F => 1,
        0x80..=0x3FFF => 2,
        0x4000..=0x1F_FFFF => 3,
        _ => 4,
    }
}

pub(crate) fn put_variable(out: &mut BytesMut, mut number: u32) {
    while number > 0x7F {
        out.put_u8((number & 0x7F) as u8 | 0x80);
        number >>= 7;
    }
    out.put_u8(number as u8);
}

fn put_bytes(out: &mut BytesMut, bytes: &[u8]) {
    out.put_u16(u16::try_from(bytes.len()).expect("it comes from a field with a two-byte length, or is short"));
    out.put_slice(bytes);
}
