//! Queues received datagrams when more arrive than can be answered, with urgent requests ahead of everything else. What
//! a datagram means is read in `inward`; sockets are not here.

use std::net::SocketAddr;

use super::limits::{COMMANDS_WAITING, READS_WAITING, SIGNS_WAITING, URGENT_WAITING};
use super::queue::{Datagram, Queue};
use super::request::Request;
use super::{lenient, message};

/// Datagrams that were received and wait to be handled, with a bounded room for each kind.
pub struct Backlog {
    is_urgent: fn(&Request) -> bool,
    urgent: Queue,
    commands: Queue,
    /// Acknowledgements, resets and everything else that asks for nothing.
    signs: Queue,
    reads: Queue,
    /// Counts datagrams taken that are not urgent, so that the three kinds take turns.
    turns: usize,
}

impl Backlog {
    /// An empty backlog; `is_urgent` says which requests are urgent, as in `Endpoint::with_urgent`.
    #[must_use]
    pub fn new(is_urgent: fn(&Request) -> bool) -> Backlog {
        let [urgent, commands] = [URGENT_WAITING, COMMANDS_WAITING].map(Queue::of);
        let [signs, reads] = [SIGNS_WAITING, READS_WAITING].map(Queue::of);
        Backlog { is_urgent, urgent, commands, signs, reads, turns: 0 }
    }

    /// Stores a datagram, or drops it when its sender already has more waiting than is left for others, so that
    /// nobody's flood displaces another's datagrams. An urgent request goes ahead of everything but the commands that
    /// came before it, since one of those could otherwise undo its effect. This holds for an urgent request that is
    /// dropped as well: those that wait take effect in its place.
    pub fn hear(&mut self, peer: SocketAddr, bytes: &[u8]) {
        let Some(code) = message::asks(bytes) else {
            if message::is_of_this_version(bytes) {
                self.signs.push(peer, bytes);
            }
            return;
        };
        if !lenient::is_command(code) {
            self.reads.push(peer, bytes);
        } else if lenient::requests(peer, bytes).any(|request| (self.is_urgent)(&request)) {
            self.urgent.push(peer, bytes);
            self.commands.put_first();
        } else {
            self.commands.push(peer, bytes);
        }
    }

    /// Whether nothing waits, urgent or not.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        [&self.urgent, &self.commands, &self.signs, &self.reads].into_iter().all(Queue::is_empty)
    }

    /// Whether an urgent request waits, or a command that has to be taken before one.
    #[must_use]
    pub fn has_urgent(&self) -> bool {
        self.commands.has_first() || !self.urgent.is_empty()
    }

    /// Removes the next urgent request, after the commands that came before it.
    pub fn take_urgent(&mut self) -> Option<Datagram> {
        self.commands.next_first().or_else(|| self.urgent.next())
    }

    /// Removes the next datagram. A command that came after an urgent request is not taken before it, unless a further
    /// urgent request follows that command and so takes effect after it.
    pub fn take(&mut self) -> Option<Datagram> {
        if let Some(urgent) = self.take_urgent() {
            return Some(urgent);
        }
        let mut kinds = [&mut self.commands, &mut self.signs, &mut self.reads];
        let (begin, count) = (self.turns, kinds.len());
        self.turns = self.turns.wrapping_add(1);
        (0..count).find_map(|n| kinds[begin.wrapping_add(n) % count].next())
    }
}
