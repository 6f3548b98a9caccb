//! Publications that were passed to the MQTT client library and are not acknowledged yet. Knows the room for more,
//! how long an acknowledgement has been missing, and what to publish again after a lost connection. Nothing is sent
//! here.

use std::collections::VecDeque;
use std::time::Duration;

use super::super::publication::Publication;
use super::link::IN_FLIGHT;

#[derive(Debug, Default)]
pub(super) struct Inflight {
    /// Publications in the order in which they were passed to the library. A publication gets its packet id when it
    /// is sent.
    open: VecDeque<(Option<u16>, Publication)>,
    /// When the present wait for an acknowledgement began: at the last acknowledgement, or when a publication was
    /// passed while none was open.
    since: Duration,
    /// Maximum number of unacknowledged publications that the broker accepts. `None` if the broker names no maximum.
    most: Option<usize>,
}

impl Inflight {
    pub(super) fn has_room(&self) -> bool {
        self.open.len() < self.most.map_or(IN_FLIGHT, |most| most.min(IN_FLIGHT))
    }

    pub(super) fn is_settled(&self) -> bool {
        self.open.is_empty()
    }

    pub(super) fn handle_greeted(&mut self, receive_maximum: Option<u16>) {
        self.most = receive_maximum.map(usize::from);
    }

    /// Call this when a publication was passed to the library. The library sends publications in the same order.
    pub(super) fn handle_given(&mut self, publication: Publication, now: Duration) {
        if self.open.is_empty() {
            self.since = now;
        }
        self.open.push_back((None, publication));
    }

    pub(super) fn handle_sent(&mut self, id: u16) {
        if let Some((under, _)) = self.open.iter_mut().find(|(under, _)| under.is_none()) {
            *under = Some(id);
        }
    }

    /// Call this when the broker has accepted or refused the publication with this id. Returns that publication.
    pub(super) fn handle_acknowledged(&mut self, id: u16, now: Duration) -> Option<Publication> {
        let place = self.open.iter().position(|(under, _)| *under == Some(id))?;
        self.since = now;
        self.open.remove(place).map(|(_, publication)| publication)
    }

    /// Returns since when an acknowledgement has been missing, or `None` if no acknowledgement is missing.
    /// `Times::acknowledgement` limits this time.
    pub(super) fn owed_since(&self) -> Option<Duration> {
        (!self.open.is_empty()).then_some(self.since)
    }

    /// Returns the publications that may not have arrived, oldest first.
    pub(super) fn into_unacknowledged(self) -> Vec<Publication> {
        self.open.into_iter().map(|(_, publication)| publication).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(seconds: u64) -> Duration {
        Duration::from_secs(seconds)
    }

    fn said(word: &str) -> Publication {
        Publication::passing(word.to_owned(), word.to_owned())
    }

    #[test]
    fn what_is_not_acknowledged_is_kept_in_order_whatever_is_acknowledged_between() {
        let mut inflight = Inflight::default();
        for (word, id) in [("a", 1), ("b", 2), ("c", 3)] {
            inflight.handle_given(said(word), at(1));
            inflight.handle_sent(id);
        }
        inflight.handle_given(said("d"), at(2));
        inflight.handle_acknowledged(2, at(3));
        inflight.handle_acknowledged(2, at(3));
        inflight.handle_acknowledged(9, at(3));
        assert_eq!(inflight.into_unacknowledged(), [said("a"), said("c"), said("d")]);
    }

    #[test]
    fn the_broker_owes_from_the_first_or_from_its_last_acknowledgement() {
        let mut inflight = Inflight::default();
        assert_eq!(inflight.owed_since(), None);
        inflight.handle_given(said("a"), at(5));
        inflight.handle_given(said("b"), at(6));
        assert_eq!(inflight.owed_since(), Some(at(5)));
        inflight.handle_sent(1);
        inflight.handle_sent(2);
        inflight.handle_acknowledged(1, at(8));
        assert_eq!(inflight.owed_since(), Some(at(8)));
        inflight.handle_acknowledged(2, at(9));
        assert!(inflight.is_settled() && inflight.owed_since().is_none());
    }

    #[test]
    fn there_is_room_for_so_many_and_again_when_one_is_acknowledged() {
        let mut inflight = Inflight::default();
        (0..IN_FLIGHT).for_each(|_| inflight.handle_given(said("a"), at(1)));
        inflight.handle_sent(1);
        assert!(!inflight.has_room());
        inflight.handle_acknowledged(1, at(1));
        assert!(inflight.has_room());
    }
}
