//! The router's messages that a client has not acknowledged. The router ends a connection over an acknowledgement that it does not wait
//! for, or that comes out of order: it gets each when it is its turn. What was sent in an earlier connection is known again by its
//! print, since the router does not say that it sends it once more.

use std::collections::VecDeque;

use super::Ended;
use crate::limits::{OUTSTANDING, ROUTER_WINDOW};

/// What the router waits for, the oldest first.
#[derive(Debug, Default)]
pub(super) struct Outstanding {
    sent: VecDeque<Sent>,
    /// The prints of what was sent before this connection and not acknowledged.
    before: Vec<u64>,
}

#[derive(Clone, Copy, Debug)]
struct Sent {
    id: u16,
    /// Under which number it waits, a long one, as long as it is not acknowledged.
    parcel: Option<u64>,
    /// `None`: the client is not to see it.
    print: Option<u64>,
    /// Whether the client has acknowledged it.
    is_done: bool,
}

impl Outstanding {
    pub(super) const fn resumed(before: Vec<u64>) -> Outstanding {
        Outstanding { sent: VecDeque::new(), before }
    }

    pub(super) fn into_unacknowledged(self) -> Vec<u64> {
        let now = self.sent.iter().filter(|sent| !sent.is_done).filter_map(|sent| sent.print);
        now.chain(self.before).take(OUTSTANDING).collect()
    }

    /// The router sent a message of this print; without one the client is not to see it. Whether it was sent before.
    pub(super) fn sent(&mut self, (id, parcel): (u16, Option<u64>), print: Option<u64>) -> Result<bool, Ended> {
        if self.sent.len() >= OUTSTANDING {
            return Err(Ended::Router("more than it may send before it is acknowledged"));
        }
        self.sent.push_back(Sent { id, parcel, print, is_done: print.is_none() });
        let known = self.before.iter().position(|before| Some(*before) == print);
        if let Some(known) = known {
            self.before.swap_remove(known);
        }
        Ok(known.is_some())
    }

    /// The client acknowledged this; if the router does not wait for it, nothing happens. The number of the long message that it was.
    pub(super) fn acknowledged(&mut self, id: u16) -> Option<u64> {
        let sent = self.sent.iter_mut().find(|sent| sent.id == id && !sent.is_done)?;
        sent.is_done = true;
        sent.parcel
    }

    /// Whether the router may send more before the client acknowledges anything.
    pub(super) fn has_room(&self) -> bool {
        self.sent.len() < ROUTER_WINDOW
    }

    pub(super) fn next(&mut self) -> Option<u16> {
        let id = self.sent.front().filter(|sent| sent.is_done)?.id;
        self.sent.pop_front();
        Some(id)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn next(outstanding: &mut Outstanding) -> Vec<u16> {
        std::iter::from_fn(|| outstanding.next()).collect()
    }

    #[test]
    fn acknowledgements_reach_the_router_in_its_own_order() {
        let mut outstanding = Outstanding::default();
        for id in [99, 100, 1, 2] {
            outstanding.sent((id, None), Some(7)).unwrap();
        }
        outstanding.acknowledged(1);
        outstanding.acknowledged(100);
        assert_eq!(next(&mut outstanding), [0; 0]);
        outstanding.acknowledged(99);
        assert_eq!(next(&mut outstanding), [99, 100, 1]);
    }

    #[test]
    fn an_acknowledgement_of_nothing_is_swallowed() {
        let mut outstanding = Outstanding::default();
        outstanding.sent((1, None), Some(7)).unwrap();
        for id in [2, 0, 1, 1, u16::MAX] {
            outstanding.acknowledged(id);
        }
        assert_eq!(next(&mut outstanding), [1]);
        assert_eq!(next(&mut outstanding), [0; 0]);
    }

    #[test]
    fn what_was_sent_before_is_known_again_once() {
        let mut outstanding = Outstanding::default();
        for (id, print) in [(1, Some(10)), (2, Some(20)), (3, None), (4, Some(30))] {
            assert_eq!(outstanding.sent((id, None), print), Ok(false));
        }
        outstanding.acknowledged(2);
        let mut outstanding = Outstanding::resumed(outstanding.into_unacknowledged());
        let again = [10, 20, 30, 30].map(|print| outstanding.sent((1, None), Some(print)));
        assert_eq!(again, [Ok(true), Ok(false), Ok(true), Ok(false)]);
    }

    #[test]
    fn a_router_without_measure_is_found_out() {
        let mut outstanding = Outstanding::default();
        let sent = (0..1000).filter(|n| outstanding.sent((n % 100 + 1, None), Some(7)).is_ok()).count();
        assert_eq!(sent, OUTSTANDING);
    }
}
