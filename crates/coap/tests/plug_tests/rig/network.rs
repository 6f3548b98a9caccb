//! The network between clients and the endpoint, in simulated time: it loses, duplicates and delays datagrams, and thus
//! reorders them, by a seed. What is in a datagram is not its business.

use std::collections::BTreeMap;
use std::net::SocketAddr;
use std::time::Duration;

use super::chance::Chance;

#[derive(Clone, Copy, Debug)]
pub(crate) struct Weather {
    /// Share of datagrams that are lost.
    pub(crate) loss: f64,
    /// Share of datagrams that come twice.
    pub(crate) double: f64,
    /// Least and greatest delay; a faster datagram overtakes.
    pub(crate) delay_ms: (u64, u64),
}

impl Weather {
    /// Nothing is lost, and order is kept.
    pub(crate) const FAIR: Weather = Weather { loss: 0.0, double: 0.0, delay_ms: (1, 1) };

    /// This share is lost in each direction, some datagrams come twice, and some overtake others.
    pub(crate) const fn foul(loss: f64) -> Weather {
        Weather { loss, double: 0.05, delay_ms: (1, 200) }
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Datagram {
    pub(crate) client: SocketAddr,
    pub(crate) is_up: bool,
    pub(crate) bytes: Vec<u8>,
}

pub(crate) struct Network {
    pub(crate) weather: Weather,
    chance: Chance,
    flying: BTreeMap<(Duration, u64), Datagram>,
    counted: u64,
}

impl Network {
    pub(crate) fn new(seed: u64, weather: Weather) -> Network {
        Network { weather, chance: Chance::new(seed, "network"), flying: BTreeMap::new(), counted: 0 }
    }

    pub(crate) fn carry(&mut self, datagram: Datagram, now: Duration) {
        let copies = if self.chance.happens(self.weather.double) { 2 } else { 1 };
        for _ in 0..copies {
            if !self.chance.happens(self.weather.loss) {
                let (least, most) = self.weather.delay_ms;
                let delay = Duration::from_millis(least + self.chance.below(most - least + 1));
                self.counted += 1;
                self.flying.insert((now + delay, self.counted), datagram.clone());
            }
        }
    }

    pub(crate) fn next_arrival(&self) -> Option<Duration> {
        self.flying.keys().next().map(|(at, _)| *at)
    }

    pub(crate) fn arrived(&mut self, now: Duration) -> Option<Datagram> {
        let first = self.flying.first_entry().filter(|entry| entry.key().0 <= now)?;
        Some(first.remove())
    }
}
