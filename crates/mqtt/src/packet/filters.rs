//! SUBSCRIBE and UNSUBSCRIBE (sections 3.8 and 3.10): an id and filters. Whether a filter is a good one stands in `filter`.

use super::{Fields, Qos};
use crate::frame::Malformed;
use crate::limits::PACKET_FILTERS;

/// The filters of a SUBSCRIBE with the QoS that is wanted for each, or of an UNSUBSCRIBE.
#[derive(Clone, Copy, Debug)]
pub struct Filters<'a> {
    /// The packet's id.
    pub id: u16,
    fields: Fields<'a>,
    with_qos: bool,
}

impl<'a> Filters<'a> {
    /// Reads a SUBSCRIBE.
    ///
    /// # Errors
    /// When it is none.
    pub fn of_subscribe(body: &'a [u8]) -> Result<Filters<'a>, Malformed> {
        Filters::read(body, true)
    }

    /// Reads an UNSUBSCRIBE.
    ///
    /// # Errors
    /// When it is none.
    pub fn of_unsubscribe(body: &'a [u8]) -> Result<Filters<'a>, Malformed> {
        Filters::read(body, false)
    }

    fn read(body: &'a [u8], with_qos: bool) -> Result<Filters<'a>, Malformed> {
        let mut fields = Fields::new(body);
        let filters = Filters { id: fields.id()?, fields, with_qos };
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

    fn one(&mut self) -> Result<(&'a str, Qos), Malformed> {
        let filter = self.fields.text("filter")?;
        if filter.is_empty() {
            return Err(Malformed::Filters);
        }
        let qos = if self.with_qos { Qos::of(self.fields.byte("QoS")?)? } else { Qos::Zero };
        Ok((filter, qos))
    }
}

impl<'a> Iterator for Filters<'a> {
    type Item = (&'a str, Qos);

    fn next(&mut self) -> Option<(&'a str, Qos)> {
        self.one().ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_filters_of_a_subscribe_are_read() {
        let filters = Filters::of_subscribe(&[0, 7, 0, 1, b'a', 2, 0, 3, b'b', b'/', b'#', 0]).unwrap();
        assert_eq!(filters.id, 7);
        assert_eq!(filters.collect::<Vec<_>>(), [("a", Qos::Two), ("b/#", Qos::Zero)]);
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
            (&[0, 7, 0, 1, b'a'], Malformed::Short("QoS")),
        ];
        for (body, wrong) in cases {
            assert_eq!(Filters::of_subscribe(body).unwrap_err(), wrong, "{body:?}");
        }
    }

    /// A packet's work is bounded.
    #[test]
    fn a_packet_has_so_many_filters_and_more_are_not_even_read() {
        let of = |count: usize| [&[0, 7][..], &[0, 1, b'a'].repeat(count)].concat();
        assert_eq!(Filters::of_unsubscribe(&of(PACKET_FILTERS)).unwrap().count(), PACKET_FILTERS);
        let nonsense_behind = [of(PACKET_FILTERS + 1), vec![0, 1, 0xFF]].concat();
        assert_eq!(Filters::of_unsubscribe(&nonsense_behind).unwrap_err(), Malformed::ManyFilters);
    }

    #[test]
    fn an_unsubscribe_has_filters_alone() {
        let filters = Filters::of_unsubscribe(&[0, 7, 0, 1, b'a', 0, 1, b'b']).unwrap();
        assert_eq!(filters.map(|(filter, _)| filter).collect::<Vec<_>>(), ["a", "b"]);
        assert_eq!(Filters::of_unsubscribe(&[0, 7]).unwrap_err(), Malformed::Filters);
        assert_eq!(Filters::of_unsubscribe(&[0, 7, 0, 1, 0]).unwrap_err(), Malformed::Text("filter"));
    }
}
