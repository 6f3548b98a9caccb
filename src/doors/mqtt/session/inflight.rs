//! Publications that were passed to the client and are not acknowledged yet: the room for more, how long the broker has owed an
//! acknowledgement, and what to publish again when the connection is lost. Nothing is sent here.

use std::collections::VecDeque;
use std::time::Duration;

use super::super::publication::Publication;
use super::link::IN_FLIGHT;

#[derive(Debug, Default)]
pub(super) struct Inflight {
    /// Publications in the order in which they were passed. Each has a packet id once it was sent.
    open: VecDeque<(Option<u16>, Publication)>,
    /// Time of the last acknowledgement, or when the first publication was passed.
    since: Duration,
    /// Maximum number of publications that the broker leaves unacknowledged, if it sends one.
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

    /// A publication was passed to the client, which sends publications in the same order.
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

    /// The broker has accepted or refused the publication with this id, which is returned.
    pub(super) fn handle_acknowledged(&mut self, id: u16, now: Duration) -> Option<Publication> {
        let place = self.open.iter().position(|(under, _)| *under == Some(id))?;
        self.since = now;
        self.open.remove(place).map(|(_, publication)| publication)
    }

    /// Since when the broker has owed an acknowledgement. `Times::acknowledgement` limits how long it may.
    pub(super) fn owed_since(&self) -> Option<Duration> {
        (!self.open.is_empty()).then_some(self.since)
    }

    /// Publications that may not have arrived, oldest first.
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
