//! SUBSCRIBE and UNSUBSCRIBE (sections 3.8 and 3.10): an id and filters. Whether a filter is valid is checked in
//! `filter`.

use super::properties::{Properties, Property, PropertyContext};
use super::{PacketFields, Qos, Version};
use crate::frame::Malformed;
use crate::limits::PACKET_FILTERS;

/// The filters of a SUBSCRIBE, each with its options, or the filters of an UNSUBSCRIBE. The constructor has read all
/// of them once as a check, so reading them again cannot fail.
#[derive(Clone, Copy, Debug)]
pub struct Filters<'a> {
    /// The packet's id, which its answer repeats; never 0.
    pub id: u16,
    /// The subscription id, which messages of these subscriptions carry (MQTT 5).
    pub subscription_id: Option<u32>,
    fields: PacketFields<'a>,
    /// The version by which the options after each filter are read; `None` if there are no options.
    options: Option<Version>,
}

/// The options of a subscription (MQTT 5, section 3.8.3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// The highest QoS at which messages are sent.
    pub qos: Qos,
    /// No Local: messages that the subscriber published itself are left out.
    pub no_local: bool,
    /// Retain As Published: messages keep the RETAIN flag with which they were published. Without this option, only
    /// messages that are sent because they were retained have the flag.
    pub as_published: bool,
    /// When the SUBSCRIBE is answered with the retained messages.
    pub kept: RetainHandling,
}

/// When a SUBSCRIBE is answered with the retained messages (MQTT 5, section 3.8.3.1).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RetainHandling {
    /// Each time, even for a filter that the client holds. This is the only mode of MQTT 3.1.1.
    Always,
    /// Only when the client did not hold the filter before.
    New,
    /// Never, so the client gets only messages published from now on.
    Never,
}

impl Options {
    /// Options with this QoS, and otherwise as in MQTT 3.1.1.
    #[must_use]
    pub const fn at(qos: Qos) -> Options {
        Options { qos, no_local: false, as_published: false, kept: RetainHandling::Always }
    }

    fn read(byte: u8, version: Version) -> Result<Options, Malformed> {
        if version == Version::Three {
            return Qos::of(byte).map(Options::at);
        }
        let kept = match byte >> 4 {
            0 => RetainHandling::Always,
            1 => RetainHandling::New,
            2 => RetainHandling::Never,
            _ => return Err(Malformed::Options(byte)),
        };
        let qos = Qos::of(byte & 3)?;
        Ok(Options { qos, no_local: byte & 4 != 0, as_published: byte & 8 != 0, kept })
    }
}

impl<'a> Filters<'a> {
    /// Reads the body of a SUBSCRIBE, which names `limits::PACKET_FILTERS` filters at most.
    ///
    /// # Errors
    /// When any part of the body is malformed; none of its filters is then accepted.
    pub fn of_subscribe(body: &'a [u8], version: Version) -> Result<Filters<'a>, Malformed> {
        Filters::read(body, version, PropertyContext::Subscribe)
    }

    /// Reads the body of an UNSUBSCRIBE, whose filters have no options.
    ///
    /// # Errors
    /// When any part of the body is malformed; none of its filters is then removed.
    pub fn of_unsubscribe(body: &'a [u8], version: Version) -> Result<Filters<'a>, Malformed> {
        Filters::read(body, version, PropertyContext::Unsubscribe)
    }

    fn read(body: &'a [u8], version: Version, place: PropertyContext) -> Result<Filters<'a>, Malformed> {
        let mut fields = PacketFields::new(body);
        let (id, mut subscription_id) = (fields.id()?, None);
        if version == Version::Five {
            let mut properties = Properties::read(&mut fields, place)?;
            subscription_id =
                properties.find_map(|property| if let Property::SubscriptionId(id) = property { Some(id) } else { None });
        }
        let options = (place == PropertyContext::Subscribe).then_some(version);
        let filters = Filters { id, subscription_id, fields, options };
        let mut unread = filters;
        let mut count = 0_usize;
        while !unread.fields.rest().is_empty() {
            unread.one()?;
            count += 1;
            if count > PACKET_FILTERS {
                return Err(Malformed::ManyFilters);
            }
        }
        if count == 0 { Err(Malformed::Filters) } else { Ok(filters) }
    }

    fn one(&mut self) -> Result<(&'a str, Options), Malformed> {
        let filter = self.fields.text("filter")?;
        if filter.is_empty() {
            return Err(Malformed::Filters);
        }
        let options = match self.options {
            Some(version) => Options::read(self.fields.byte("options")?, version)?,
            None => Options::at(Qos::Zero),
        };
        if options.no_local && filter.starts_with("$share/") {
            return Err(Malformed::SharedNoLocal);
        }
        Ok((filter, options))
    }
}

impl<'a> Iterator for Filters<'a> {
    type Item = (&'a str, Options);

    fn next(&mut self) -> Option<(&'a str, Options)> {
        self.one().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_filters_of_a_subscribe_are_read() {
        let filters = Filters::of_subscribe(&[0, 7, 0, 1, b'a', 2, 0, 3, b'b', b'/', b'#', 0], Version::Three).unwrap();
        assert_eq!(filters.id, 7);
        assert_eq!(filters.collect::<Vec<_>>(), [("a", Options::at(Qos::Two)), ("b/#", Options::at(Qos::Zero))]);
    }

    #[test]
    fn a_subscribe_that_is_wrong_anywhere_is_wrong() {
        let cases: [(&[u8], Malformed); 7] = [
            (&[0, 7], Malformed::Filters),
            (&[0, 0, 0, 1, b'a', 0], Malformed::Id),
            (&[0, 7, 0, 0, 0], Malformed::Filters),
            (&[0, 7, 0, 1, b'a', 3], Malformed::Qos(3)),
            (&[0, 7, 0, 1, b'a', 0x41], Malformed::Qos(0x41)),
            (&[0, 7, 0, 1, b'a', 0, 0, 1, 0xFF, 0], Malformed::Text("filter")),
            (&[0, 7, 0, 1, b'a'], Malformed::Short("options")),
        ];
        for (body, wrong) in cases {
            assert_eq!(Filters::of_subscribe(body, Version::Three).unwrap_err(), wrong, "{body:?}");
        }
    }

    #[test]
    fn a_subscribe_of_mqtt_5_has_options_and_a_number() {
        let filters =
            Filters::of_subscribe(&[0, 7, 3, 0x0B, 0x80, 1, 0, 1, b'a', 0x2E, 0, 1, b'b', 0x10], Version::Five).unwrap();
        assert_eq!(filters.subscription_id, Some(128));
        let a = Options { qos: Qos::Two, no_local: true, as_published: true, kept: RetainHandling::Never };
        let b = Options { kept: RetainHandling::New, ..Options::at(Qos::Zero) };
        assert_eq!(filters.collect::<Vec<_>>(), [("a", a), ("b", b)]);
        let wrong = |body: &[u8]| Filters::of_subscribe(body, Version::Five).unwrap_err();
        assert_eq!(wrong(&[0, 7, 0, 0, 1, b'a', 0x30]), Malformed::Options(0x30));
        assert_eq!(wrong(&[0, 7, 0, 0, 1, b'a', 0x40]), Malformed::Options(0x40));
        assert_eq!(wrong(&[0, 7, 0, 0, 1, b'a', 3]), Malformed::Qos(3));
        assert_eq!(wrong(&[0, 7, 2, 0x0B, 0, 0, 1, b'a', 0]), Malformed::PropertyValue(0x0B));
        assert_eq!(wrong(&[&[0, 7, 0, 0, 10][..], b"$share/g/a", &[4]].concat()), Malformed::SharedNoLocal);
        let unsubscribe = Filters::of_unsubscribe(&[0, 7, 0, 0, 1, b'a'], Version::Five).unwrap();
        assert_eq!(unsubscribe.map(|(filter, _)| filter).collect::<Vec<_>>(), ["a"]);
    }

    /// The work for one packet is bounded.
    #[test]
    fn a_packet_has_so_many_filters_and_more_are_not_even_read() {
        let of = |count: usize| [&[0, 7][..], &[0, 1, b'a'].repeat(count)].concat();
        assert_eq!(Filters::of_unsubscribe(&of(PACKET_FILTERS), Version::Three).unwrap().count(), PACKET_FILTERS);
        let nonsense_behind = [of(PACKET_FILTERS + 1), vec![0, 1, 0xFF]].concat();
        assert_eq!(Filters::of_unsubscribe(&nonsense_behind, Version::Three).unwrap_err(), Malformed::ManyFilters);
    }

    #[test]
    fn an_unsubscribe_has_filters_alone() {
        let filters = Filters::of_unsubscribe(&[0, 7, 0, 1, b'a', 0, 1, b'b'], Version::Three).unwrap();
        assert_eq!(filters.map(|(filter, _)| filter).collect::<Vec<_>>(), ["a", "b"]);
        assert_eq!(Filters::of_unsubscribe(&[0, 7], Version::Three).unwrap_err(), Malformed::Filters);
        assert_eq!(Filters::of_unsubscribe(&[0, 7, 0, 1, 0], Version::Three).unwrap_err(), Malformed::Text("filter"));
    }
}
