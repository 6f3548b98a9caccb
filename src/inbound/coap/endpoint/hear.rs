//! Hearing without answering, for when more comes than is answered: a STOP is found at once behind whatever others send, and all else
//! that wants an answer waits for its turn. What a datagram means is `inward`'s business.

use std::net::SocketAddr;

use super::{Endpoint, lenient, message};
use crate::core::units::Now;

impl Endpoint {
    /// Takes a datagram from the network: a STOP at once, but after the commands that came before it, of which one could else set
    /// in motion what it has halted; at once, too, what is not answered, because that costs less than to keep it. All else waits for
    /// `take_waiting`, or is lost when its sender has more there than is left for others (safety S1, S9).
    pub fn hear(&mut self, peer: SocketAddr, bytes: &[u8], now: Now) {
        let Some(code) = message::asks(bytes) else { return self.handle_datagram(peer, bytes, now) };
        if self.stop_in(peer, bytes).is_some() {
            while let Some((peer, earlier)) = self.commands.next() {
                self.handle_datagram(peer, &earlier, now);
            }
            return self.handle_datagram(peer, bytes, now);
        }
        let queue = if lenient::acts(code) { &mut self.commands } else { &mut self.looks };
        queue.push(peer, bytes);
    }

    /// Whether anything waits.
    #[must_use]
    pub fn is_behind(&self) -> bool {
        !(self.commands.is_empty() && self.looks.is_empty())
    }

    /// Takes the next command and the next look of those that wait.
    pub fn take_waiting(&mut self, now: Now) {
        for (peer, bytes) in [self.commands.next(), self.looks.next()].into_iter().flatten() {
            self.handle_datagram(peer, &bytes, now);
        }
    }
}
