//! The engine's messages that a client has not acknowledged. The engine ends a connection over an acknowledgement that it does not wait
//! for, or that comes out of order: it gets each when it is its turn.

use std::collections::VecDeque;

use super::Ended;
use crate::inbound::mqtt::gate::limits::OUTSTANDING;

/// What the engine waits for, the oldest first, and whether the client has acknowledged it.
#[derive(Debug, Default)]
pub(super) struct Outstanding(VecDeque<(u16, bool)>);

impl Outstanding {
    /// The engine sent this; `is_done` when the client is not to see it.
    pub(super) fn sent(&mut self, id: u16, is_done: bool) -> Result<(), Ended> {
        if self.0.len() >= OUTSTANDING {
            return Err(Ended::Engine("more than it may send before it is acknowledged"));
        }
        self.0.push_back((id, is_done));
        Ok(())
    }

    /// The client acknowledged this; if the engine does not wait for it, nothing happens.
    pub(super) fn acknowledged(&mut self, id: u16) {
        if let Some((_, is_done)) = self.0.iter_mut().find(|(waiting, is_done)| *waiting == id && !is_done) {
            *is_done = true;
        }
    }

    /// What the engine is to be told next.
    pub(super) fn next(&mut self) -> Option<u16> {
        let (id, _) = *self.0.front().filter(|(_, is_done)| *is_done)?;
        self.0.pop_front();
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
    fn acknowledgements_reach_the_engine_in_its_own_order() {
        let mut outstanding = Outstanding::default();
        for id in [99, 100, 1, 2] {
            outstanding.sent(id, false).unwrap();
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
        outstanding.sent(1, false).unwrap();
        for id in [2, 0, 1, 1, u16::MAX] {
            outstanding.acknowledged(id);
        }
        assert_eq!(next(&mut outstanding), [1]);
        assert_eq!(next(&mut outstanding), [0; 0]);
    }

    #[test]
    fn an_engine_without_measure_is_found_out() {
        let mut outstanding = Outstanding::default();
        let sent = (0..1000).filter(|n| outstanding.sent(n % 100 + 1, false).is_ok()).count();
        assert_eq!(sent, OUTSTANDING);
    }
}
