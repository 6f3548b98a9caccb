//! The endpoint on a test bench, with the test application behind it and a simulated clock. Datagrams are put in by
//! hand, and what comes out is collected. Networks and clients are not here.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::time::Duration;

use super::chance::Chance;
use coap_endpoint::{Answer, Backlog, Endpoint, ExchangeId};

use super::message::Message;
use super::server::{Said, Server};

/// A client on the endpoint's own machine.
pub(crate) fn here() -> SocketAddr {
    SocketAddr::from(([127, 0, 0, 1], 40_000))
}

/// A client on another machine.
pub(crate) fn stranger() -> SocketAddr {
    SocketAddr::from(([192, 0, 2, 7], 40_000))
}

#[derive(Clone, Debug)]
pub(crate) struct Out {
    pub(crate) at: Duration,
    pub(crate) peer: SocketAddr,
    pub(crate) bytes: Vec<u8>,
}

/// Timeouts handled in a row without time going on; an endpoint that asks for more is in a loop.
const CIRCLES: u32 = 1000;

pub(crate) struct Bench {
    pub(crate) endpoint: Endpoint,
    pub(crate) backlog: Backlog,
    pub(crate) server: Server,
    pub(crate) now: Duration,
    later: BTreeMap<(Duration, u64), (ExchangeId, Answer)>,
    asked: u64,
    out: Vec<Out>,
}

impl Bench {
    pub(crate) fn new() -> Bench {
        Bench::seeded(1)
    }

    pub(crate) fn seeded(seed: u64) -> Bench {
        Bench {
            endpoint: Endpoint::new(secret(seed)),
            backlog: Backlog::new(|_| false),
            server: Server::new(),
            now: Duration::from_secs(10),
            later: BTreeMap::new(),
            asked: 0,
            out: Vec::new(),
        }
    }

    /// The program ends and starts again, without any memory.
    pub(crate) fn restart(&mut self, seed: u64) {
        self.endpoint = Endpoint::new(secret(seed));
        self.later.clear();
    }

    pub(crate) fn deliver(&mut self, peer: SocketAddr, bytes: &[u8]) {
        self.endpoint.handle_datagram(peer, bytes, self.now);
        self.pump();
        self.run_until(self.now);
    }

    pub(crate) fn hear(&mut self, peer: SocketAddr, bytes: &[u8]) {
        self.backlog.hear(peer, bytes);
    }

    pub(crate) fn take_turn(&mut self) {
        if let Some((peer, bytes)) = self.backlog.take() {
            self.endpoint.handle_datagram(peer, &bytes, self.now);
            self.pump();
        }
    }

    pub(crate) fn catch_up(&mut self) -> usize {
        let mut turns = 0;
        while !self.backlog.is_empty() {
            self.take_turn();
            turns += 1;
        }
        turns
    }

    pub(crate) fn send(&mut self, message: &Message) -> Vec<Message> {
        self.send_from(here(), message)
    }

    pub(crate) fn send_from(&mut self, peer: SocketAddr, message: &Message) -> Vec<Message> {
        self.deliver(peer, &message.encoded());
        self.said_to(peer)
    }

    /// Sends a message that must be answered at once, and by one message.
    #[track_caller]
    pub(crate) fn ask(&mut self, message: &Message) -> Message {
        self.ask_from(here(), message)
    }

    #[track_caller]
    pub(crate) fn ask_from(&mut self, peer: SocketAddr, message: &Message) -> Message {
        let mut said = self.send_from(peer, message);
        assert_eq!(said.len(), 1, "one answer was expected to {message:?}: {said:?}");
        said.remove(0)
    }

    pub(crate) fn change(&mut self, happens: impl FnOnce(&mut Server)) {
        happens(&mut self.server);
        self.tell_changes();
        self.pump();
        self.run_until(self.now);
    }

    pub(crate) fn next_event(&self) -> Option<Duration> {
        let later = self.later.keys().next().map(|(at, _)| *at);
        [later, self.endpoint.poll_timeout()].into_iter().flatten().min()
    }

    /// Advances the clock step by step, and handles everything that is due meanwhile.
    pub(crate) fn run_until(&mut self, end: Duration) {
        let mut circles = 0;
        while let Some(at) = self.next_event().filter(|at| *at <= end) {
            circles = if at > self.now { 0 } else { circles + 1 };
            assert!(circles < CIRCLES, "at {:?} the endpoint asks for {at:?} again and again", self.now);
            self.now = self.now.max(at);
            self.answer_later();
            self.endpoint.handle_timeout(self.now);
            self.pump();
        }
        self.now = self.now.max(end);
    }

    pub(crate) fn wait(&mut self, time: Duration) {
        self.run_until(self.now + time);
    }

    /// Advances the clock, and returns what was sent meanwhile to the client on this machine.
    pub(crate) fn wait_ms(&mut self, time_ms: u64) -> Vec<Message> {
        self.wait(Duration::from_millis(time_ms));
        self.said_to(here())
    }

    pub(crate) fn take(&mut self) -> Vec<Out> {
        std::mem::take(&mut self.out)
    }

    pub(crate) fn said_to(&mut self, peer: SocketAddr) -> Vec<Message> {
        let (its, others) = self.take().into_iter().partition(|out: &Out| out.peer == peer);
        self.out = others;
        Vec::into_iter(its).map(|out: Out| Message::decoded(&out.bytes)).collect()
    }

    /// Answers requests and collects datagrams until nothing is left.
    fn pump(&mut self) {
        while let Some((exchange, request)) = self.endpoint.poll_request() {
            self.asked += 1;
            match self.server.answer(&request) {
                Said::Now(answer) => self.endpoint.handle_answer(exchange, answer, self.now),
                Said::Later(delay, answer) => drop(self.later.insert((self.now + delay, self.asked), (exchange, answer))),
            }
            self.tell_changes();
        }
        while let Some(transmit) = self.endpoint.poll_transmit() {
            self.out.push(Out { at: self.now, peer: transmit.peer, bytes: transmit.bytes });
        }
    }

    fn tell_changes(&mut self) {
        if !std::mem::take(&mut self.server.has_changed) {
            return;
        }
        for (subject, request) in self.endpoint.subjects() {
            let things = self.server.things(&request);
            self.endpoint.handle_change(subject, things, self.now);
        }
    }

    fn answer_later(&mut self) {
        while let Some(first) = self.later.first_entry().filter(|entry| entry.key().0 <= self.now) {
            let (exchange, answer) = first.remove();
            self.endpoint.handle_answer(exchange, answer, self.now);
        }
    }
}

fn secret(seed: u64) -> [u8; 32] {
    let mut chance = Chance::new(seed, "secret");
    let mut secret = [0; 32];
    secret.chunks_mut(8).for_each(|chunk| chunk.copy_from_slice(&chance.number().to_le_bytes()));
    secret
}
