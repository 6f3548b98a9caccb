//! Hearing without answering, for when more comes than is answered: what has come waits in the order in which it is taken,
//! urgent requests before all else. What a datagram means is `inward`'s business; sockets are not here.

use std::net::SocketAddr;

use super::limits::{COMMANDS_WAITING, READS_WAITING, SIGNS_WAITING, URGENT_WAITING};
use super::queue::{Datagram, Queue};
use super::request::Request;
use super::{lenient, message};

/// What was heard and waits to be taken.
pub struct Backlog {
    is_urgent: fn(&Request) -> bool,
    urgent: Queue,
    commands: Queue,
    /// Acknowledgements, rejections and what else asks for nothing.
    signs: Queue,
    reads: Queue,
    /// How often one was taken that is not urgent: those of the three kinds take turns.
    turns: usize,
}

impl Backlog {
    /// Room for what comes; `is_urgent` says which requests are urgent, as in `Endpoint::with_urgent`.
    #[must_use]
    pub fn new(is_urgent: fn(&Request) -> bool) -> Backlog {
        let [urgent, commands] = [URGENT_WAITING, COMMANDS_WAITING].map(Queue::of);
        let [signs, reads] = [SIGNS_WAITING, READS_WAITING].map(Queue::of);
        Backlog { is_urgent, urgent, commands, signs, reads, turns: 0 }
    }

    /// Keeps a datagram, or loses it when its sender has more there than is left for others: nobody's flood keeps out another. An
    /// urgent request is taken before all else, but for the commands that came before it, of which one could else undo what it has
    /// done: that goes for an urgent request that is lost too, in whose place those that wait take effect.
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

    /// Whether nothing waits.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        [&self.urgent, &self.commands, &self.signs, &self.reads].into_iter().all(Queue::is_empty)
    }

    /// Whether an urgent request waits, or a command that is to be taken before one.
    #[must_use]
    pub fn has_urgent(&self) -> bool {
        self.commands.has_first() || !self.urgent.is_empty()
    }

    /// The next urgent request that waits, after the commands that came before it.
    pub fn take_urgent(&mut self) -> Option<Datagram> {
        self.commands.next_first().or_else(|| self.urgent.next())
    }

    /// The next to be taken. No command that came after an urgent request is taken before it, but for those that a further urgent
    /// request follows, which then takes effect after them.
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
