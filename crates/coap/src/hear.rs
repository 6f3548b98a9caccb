//! Hearing without answering, for when more comes than is answered: what has come waits in the order in which it is taken, a STOP
//! before all else. What a datagram means is `inward`'s business; sockets are not here.

use std::net::SocketAddr;

use super::limits::{COMMANDS_WAITING, LOOKS_WAITING, SIGNS_WAITING, STOPS_WAITING};
use super::queue::{Datagram, Queue};
use super::request::Request;
use super::{lenient, message};

/// What was heard and waits to be taken.
pub struct Backlog {
    is_stop: fn(&Request) -> bool,
    stops: Queue,
    commands: Queue,
    /// Acknowledgements, rejections and what else asks for nothing.
    signs: Queue,
    looks: Queue,
    /// How often one was taken that is no STOP: those of the three kinds take turns.
    turns: usize,
}

impl Backlog {
    /// Room for what comes; `is_stop` says which requests are a STOP, as in `Endpoint::with_stop`.
    #[must_use]
    pub fn new(is_stop: fn(&Request) -> bool) -> Backlog {
        let [stops, commands] = [STOPS_WAITING, COMMANDS_WAITING].map(Queue::of);
        let [signs, looks] = [SIGNS_WAITING, LOOKS_WAITING].map(Queue::of);
        Backlog { is_stop, stops, commands, signs, looks, turns: 0 }
    }

    /// Keeps a datagram, or loses it when its sender has more there than is left for others (safety S9). A STOP is taken before all
    /// else, but for the commands that came before it, of which one could else set in motion what it has halted (safety S1): that
    /// goes for a STOP that is lost too, in whose place those that wait halt.
    pub fn hear(&mut self, peer: SocketAddr, bytes: &[u8]) {
        let Some(code) = message::asks(bytes) else {
            if message::is_of_this_version(bytes) {
                self.signs.push(peer, bytes);
            }
            return;
        };
        if !lenient::acts(code) {
            self.looks.push(peer, bytes);
        } else if lenient::requests(peer, bytes).any(|request| (self.is_stop)(&request)) {
            self.stops.push(peer, bytes);
            self.commands.put_first();
        } else {
            self.commands.push(peer, bytes);
        }
    }

    /// Whether nothing waits.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        [&self.stops, &self.commands, &self.signs, &self.looks].into_iter().all(Queue::is_empty)
    }

    /// Whether a STOP waits, or a command that is to be taken before one.
    #[must_use]
    pub fn is_urgent(&self) -> bool {
        self.commands.has_first() || !self.stops.is_empty()
    }

    /// The next STOP that waits, after the commands that came before it.
    pub fn take_urgent(&mut self) -> Option<Datagram> {
        self.commands.next_first().or_else(|| self.stops.next())
    }

    /// The next to be taken. No command that came after a STOP is taken before it, but for those that a further STOP follows: that halts
    /// what they begin.
    pub fn take(&mut self) -> Option<Datagram> {
        if let Some(urgent) = self.take_urgent() {
            return Some(urgent);
        }
        let mut kinds = [&mut self.commands, &mut self.signs, &mut self.looks];
        let (begin, count) = (self.turns, kinds.len());
        self.turns = self.turns.wrapping_add(1);
        (0..count).find_map(|n| kinds[begin.wrapping_add(n) % count].next())
    }
}
