//! Long messages on their way to one reader. Through the router goes but a number for each, since the router copies what it sends for
//! every reader; what all readers have in common stays here, and is put together again when the number comes. Whoever lags too far
//! behind loses the oldest, alone.

use std::collections::VecDeque;

use bytes::Bytes;

use super::limits::PARCELS_BYTES;

/// What goes through the router in the place of a long message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Label {
    pub(crate) number: u64,
    /// Nothing that it says was kept before this stamp.
    pub(crate) stamp: u64,
    pub(crate) length: u32,
}

/// The long messages that wait for one reader, the oldest first.
#[derive(Debug, Default)]
pub(crate) struct Parcels {
    waiting: VecDeque<(u64, Bytes)>,
    bytes: usize,
}

impl Parcels {
    /// One more; of more than there is room for the oldest are lost, but never the newest.
    pub(crate) fn push(&mut self, number: u64, payload: &Bytes) {
        self.waiting.push_back((number, payload.clone()));
        self.bytes += payload.len();
        while self.bytes > PARCELS_BYTES
            && self.waiting.len() > 1
            && let Some((_, lost)) = self.waiting.pop_front()
        {
            self.bytes -= lost.len();
        }
    }

    pub(crate) fn find(&self, number: u64) -> Option<Bytes> {
        self.waiting.iter().find(|(known, _)| *known == number).map(|(_, payload)| payload.clone())
    }

    pub(crate) fn remove(&mut self, number: u64) {
        let place = self.waiting.iter().position(|(known, _)| *known == number);
        if let Some((_, payload)) = place.and_then(|place| self.waiting.remove(place)) {
            self.bytes -= payload.len();
        }
    }

    pub(crate) const fn bytes(&self) -> usize {
        self.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parcel_waits_until_the_reader_has_it_once_for_each_time_that_it_is_on_its_way() {
        let mut parcels = Parcels::default();
        let payload = Bytes::from_static(b"long");
        for number in [1, 2, 2, 3] {
            parcels.push(number, &payload);
        }
        parcels.remove(2);
        assert_eq!((parcels.find(2), parcels.bytes()), (Some(payload), 12));
        parcels.remove(2);
        parcels.remove(7);
        assert_eq!((parcels.find(2), parcels.bytes()), (None, 8));
    }

    #[test]
    fn of_more_than_there_is_room_for_the_newest_are_there() {
        let mut parcels = Parcels::default();
        let long = Bytes::from(vec![7; PARCELS_BYTES / 4]);
        (1..=9).for_each(|number| parcels.push(number, &long));
        let there: Vec<u64> = (1..=9).filter(|number| parcels.find(*number).is_some()).collect();
        assert_eq!((there, parcels.bytes()), (vec![6, 7, 8, 9], PARCELS_BYTES));
        parcels.push(10, &Bytes::from(vec![7; 2 * PARCELS_BYTES]));
        assert_eq!((parcels.find(9), parcels.bytes()), (None, 2 * PARCELS_BYTES));
    }
}
