//! Queues received datagrams when more arrive than can be answered. Urgent requests go ahead of all other datagrams
//! except commands that arrived earlier. `inward` interprets the datagrams. Sockets are not handled here.

use std::net::SocketAddr;

use super::limits::{COMMANDS_WAITING, READS_WAITING, SIGNS_WAITING, URGENT_WAITING};
use super::queue::{Datagram, Queue};
use super::request::Request;
use super::{lenient, message};

/// Received datagrams that wait to be handled. Each kind of datagram has its own limit in bytes.
pub struct Backlog {
    is_urgent: fn(&Request) -> bool,
    urgent: Queue,
    commands: Queue,
    /// Acknowledgements, resets and other datagrams that request nothing.
    signs: Queue,
    reads: Queue,
    /// Counts the datagrams taken that were not urgent. The count decides whose turn is next: `commands`, `signs` or
    /// `reads`.
    turns: usize,
}

impl Backlog {
    /// Creates an empty backlog. `is_urgent` says which requests are urgent, as in `Endpoint::with_urgent`.
    #[must_use]
    pub fn new(is_urgent: fn(&Request) -> bool) -> Backlog {
        let [urgent, commands] = [URGENT_WAITING, COMMANDS_WAITING].map(Queue::of);
        let [signs, reads] = [SIGNS_WAITING, READS_WAITING].map(Queue::of);
        Backlog { is_urgent, urgent, commands, signs, reads, turns: 0 }
    }

    /// Stores a datagram. Drops it if the waiting datagrams of its sender take too much of the free room, so that a
    /// flood cannot push out the datagrams of other senders. An urgent request goes ahead of all datagrams except
    /// earlier commands: an earlier command that ran later could undo the effect of the request. Earlier commands go
    /// first even if the urgent request itself is dropped, because the urgent requests in the queue have the same
    /// effect.
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

    /// Whether no datagram waits, urgent or not.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        [&self.urgent, &self.commands, &self.signs, &self.reads].into_iter().all(Queue::is_empty)
    }

    /// Returns true if an urgent request is waiting, or if a command is waiting that must be handled before urgent requests.
    #[must_use]
    pub fn has_urgent(&self) -> bool {
        self.commands.has_first() || !self.urgent.is_empty()
    }

    /// Removes the next urgent request, after the commands that came before it.
    pub fn take_urgent(&mut self) -> Option<Datagram> {
        self.commands.next_first().or_else(|| self.urgent.next())
    }

    /// Removes the next datagram. A command that came after an urgent request is taken after it, unless a further
    /// urgent request has come after the command.
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
