//! Honest clients, a bad network and the endpoint on its bench, run together in simulated time: each step goes to the
//! next event of any of them. Nothing sleeps.

use std::net::SocketAddr;
use std::time::Duration;

use super::bench::Bench;
use super::client::Client;
use super::client::ask::Ask;
use super::client::exchange::Outcome;
use super::network::{Datagram, Network, Weather};
use super::server::Server;

/// Longest time of a single exchange: a long body in small blocks over a bad network.
const PATIENCE: Duration = Duration::from_secs(3600 * 3);

pub(crate) struct Scene {
    pub(crate) bench: Bench,
    pub(crate) clients: Vec<Client>,
    pub(crate) network: Network,
    seed: u64,
}

impl Scene {
    pub(crate) fn new(seed: u64, weather: Weather) -> Scene {
        Scene::crowd(seed, weather, 1)
    }

    /// A scene with this many clients, all on the endpoint's own machine.
    pub(crate) fn crowd(seed: u64, weather: Weather, clients: u16) -> Scene {
        let address = |n| SocketAddr::from(([127, 0, 0, 1], 40_000 + n));
        Scene {
            bench: Bench::seeded(seed),
            clients: (0..clients).map(|n| Client::new(address(n), seed)).collect(),
            network: Network::new(seed, weather),
            seed,
        }
    }

    pub(crate) const fn now(&self) -> Duration {
        self.bench.now
    }

    pub(crate) fn begin(&mut self, ask: Ask) -> Vec<u8> {
        self.begin_of(0, ask)
    }

    pub(crate) fn begin_of(&mut self, client: usize, ask: Ask) -> Vec<u8> {
        let now = self.now();
        let token = self.clients[client].ask(ask, now);
        self.settle();
        token
    }

    pub(crate) fn ask(&mut self, ask: Ask) -> Outcome {
        let token = self.begin(ask);
        let end = self.now() + PATIENCE;
        while self.clients[0].outcome(&token).is_none() {
            assert!(self.step(end), "an exchange that never ends");
        }
        self.clients[0].outcome(&token).cloned().expect("it has just been there")
    }

    pub(crate) fn change(&mut self, happens: impl FnOnce(&mut Server)) {
        self.bench.change(happens);
        self.settle();
    }

    pub(crate) fn wait(&mut self, time: Duration) {
        let end = self.now() + time;
        while self.step(end) {}
    }

    pub(crate) fn restart(&mut self) {
        self.bench.restart(self.seed + 1000);
    }

    /// Goes to the next event; `false` when `end` comes first.
    fn step(&mut self, end: Duration) -> bool {
        let clients = self.clients.iter().filter(|client| !client.is_off).filter_map(Client::poll_timeout).min();
        let next = [clients, self.network.next_arrival(), self.bench.next_event()].into_iter().flatten().min();
        let at = next.map_or(end, |at| at.clamp(self.now(), end));
        self.bench.run_until(at);
        while let Some(datagram) = self.network.arrived(at) {
            self.arrive(&datagram);
        }
        for client in self.clients.iter_mut().filter(|client| client.poll_timeout().is_some_and(|due| due <= at)) {
            client.handle_timeout(at);
        }
        self.settle();
        next.is_some_and(|next| next <= end)
    }

    fn arrive(&mut self, datagram: &Datagram) {
        if datagram.is_up {
            self.bench.deliver(datagram.client, &datagram.bytes);
            return;
        }
        let now = self.now();
        let place = usize::from(datagram.client.port() - 40_000);
        if let Some(client) = self.clients.get_mut(place).filter(|client| !client.is_off) {
            client.handle_datagram(&datagram.bytes, now);
        }
    }

    fn settle(&mut self) {
        let now = self.now();
        for out in self.bench.take() {
            self.network.carry(Datagram { client: out.peer, is_up: false, bytes: out.bytes }, now);
        }
        for client in self.clients.iter_mut() {
            while let Some(bytes) = client.poll_transmit(now) {
                if !client.is_off {
                    self.network.carry(Datagram { client: client.address, is_up: true, bytes }, now);
                }
            }
        }
    }
}
