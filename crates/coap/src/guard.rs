//! Limits the datagrams sent to other machines. An address has to prove that it receives our datagrams. Until then it
//! gets at most three times the bytes that came from it. A network that sends too many requests is told to wait. The
//! rights of clients are decided by the application.

use std::net::SocketAddr;
use std::time::Duration;

use hashlink::LinkedHashMap;
use hmac::{Hmac, KeyInit, Mac};
use sha2::Sha256;
use subtle::ConstantTimeEq;

use super::limits::{AMPLIFICATION, ECHO_AGE, PEERS, PROVED, RATE, RATE_BURST};
use super::network::{Network, is_this_machine};

/// Length of the timestamp in an Echo option, in bytes.
const TIME: usize = 4;
const PROOF: usize = 8;

pub(super) struct Guard {
    secret: Vec<u8>,
    peers: LinkedHashMap<SocketAddr, Stranger>,
    networks: LinkedHashMap<Network, Bucket>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Stranger {
    /// Bytes received from the address.
    received: usize,
    /// Bytes sent to the address while it was not proved.
    sent: usize,
    /// When the address last proved that it receives our datagrams.
    proved: Option<Duration>,
}

/// A token bucket: how many requests a network may still send.
#[derive(Clone, Copy, Debug)]
struct Bucket {
    left: f64,
    since: Duration,
}

impl Guard {
    pub(super) fn new(secret: &[u8]) -> Guard {
        Guard { secret: secret.to_vec(), peers: LinkedHashMap::new(), networks: LinkedHashMap::new() }
    }

    pub(super) fn count(&self) -> usize {
        self.peers.len() + self.networks.len()
    }

    pub(super) fn received(&mut self, peer: SocketAddr, bytes: usize) {
        if is_this_machine(peer.ip()) {
            return;
        }
        let stranger = self.peers.entry(peer).or_insert_with(Stranger::default);
        stranger.received = stranger.received.saturating_add(bytes);
        self.peers.to_back(&peer);
        while self.peers.len() > PEERS {
            self.peers.pop_front();
        }
    }

    pub(super) fn is_too_much(&mut self, peer: SocketAddr, now: Duration) -> bool {
        if is_this_machine(peer.ip()) {
            return false;
        }
        let network = Network::of(peer.ip());
        let bucket = self.networks.entry(network).or_insert_with(|| Bucket { left: RATE_BURST, since: now });
        let gained = now.saturating_sub(bucket.since).as_secs_f64() * RATE;
        *bucket = Bucket { left: (bucket.left + gained).min(RATE_BURST), since: now };
        let is_too_much = bucket.left < 1.0;
        if !is_too_much {
            bucket.left -= 1.0;
        }
        self.networks.to_back(&network);
        while self.networks.len() > PEERS {
            self.networks.pop_front();
        }
        is_too_much
    }

    pub(super) fn is_proved(&self, peer: SocketAddr, now: Duration) -> bool {
        is_this_machine(peer.ip())
            || self.peers.get(&peer).and_then(|stranger| stranger.proved).is_some_and(|at| now <= at + PROVED)
    }

    pub(super) fn has_room(&self, peer: SocketAddr, length: usize, now: Duration) -> bool {
        let fits = |stranger: &Stranger| stranger.sent + length <= stranger.received.saturating_mul(AMPLIFICATION);
        self.is_proved(peer, now) || self.peers.get(&peer).is_some_and(fits)
    }

    /// Whether the guard's limit allows a datagram of this length. If so, counts its bytes as sent.
    pub(super) fn lets_out(&mut self, peer: SocketAddr, length: usize, now: Duration) -> bool {
        let (is_proved, may) = (self.is_proved(peer, now), self.has_room(peer, length, now));
        if let Some(stranger) = self.peers.get_mut(&peer).filter(|_| may && !is_proved) {
            stranger.sent = stranger.sent.saturating_add(length);
        }
        may
    }

    /// Returns the Echo value that the address has to send back to prove that it receives our datagrams (RFC 9175,
    /// section 2).
    pub(super) fn echo(&self, peer: SocketAddr, now: Duration) -> Vec<u8> {
        let time = u32::try_from(now.as_secs()).unwrap_or(u32::MAX).to_be_bytes();
        [&time[..], &self.proof(peer, time)].concat()
    }

    pub(super) fn echoed(&mut self, peer: SocketAddr, echo: &[u8], now: Duration) {
        let Some((time, proof)) = echo.split_first_chunk::<TIME>().filter(|(_, proof)| proof.len() == PROOF) else { return };
        let age = now.as_secs().checked_sub(u64::from(u32::from_be_bytes(*time)));
        let is_fresh = age.is_some_and(|age| age <= ECHO_AGE.as_secs());
        let is_ours = is_fresh && bool::from(proof.ct_eq(&self.proof(peer, *time)));
        if let Some(stranger) = self.peers.get_mut(&peer).filter(|_| is_ours) {
            stranger.proved = Some(now);
        }
    }

    /// Renews the proof of a proved address that has acknowledged a message.
    pub(super) fn heard_us(&mut self, peer: SocketAddr, now: Duration) {
        if let Some(stranger) = self.peers.get_mut(&peer).filter(|stranger| stranger.proved.is_some()) {
            stranger.proved = Some(now);
        }
    }

    fn proof(&self, peer: SocketAddr, time: [u8; TIME]) -> [u8; PROOF] {
        let mut mac = Hmac::<Sha256>::new_from_slice(&self.secret).expect("a key of any length will do");
        mac.update(peer.to_string().as_bytes());
        mac.update(&time);
        let mut proof = [0; PROOF];
        proof.copy_from_slice(&mac.finalize().into_bytes()[..PROOF]);
        proof
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: Duration = Duration::from_secs(1000);

    fn stranger() -> SocketAddr {
        "192.0.2.7:5683".parse().unwrap()
    }

    #[test]
    fn a_stranger_gets_three_times_what_it_sent_until_it_proves_its_address() {
        let mut guard = Guard::new(&[7; 24]);
        assert!(!guard.lets_out(stranger(), 1, NOW));
        guard.received(stranger(), 20);
        assert!(guard.lets_out(stranger(), 60, NOW) && !guard.lets_out(stranger(), 1, NOW));
        let echo = guard.echo(stranger(), NOW);
        guard.echoed(stranger(), &echo, NOW + Duration::from_secs(5));
        assert!(guard.lets_out(stranger(), 100_000, NOW));
        assert!(!guard.is_proved(stranger(), NOW + PROVED * 2));
    }

    #[test]
    fn an_echo_of_another_address_time_or_secret_proves_nothing() {
        let mut guard = Guard::new(&[7; 24]);
        guard.received(stranger(), 1);
        let other = "192.0.2.8:5683".parse().unwrap();
        let old = guard.echo(stranger(), NOW);
        for (echo, now) in [
            (guard.echo(other, NOW), NOW),
            (Guard::new(&[8; 24]).echo(stranger(), NOW), NOW),
            (old.clone(), NOW + ECHO_AGE * 2),
            (old[..11].to_vec(), NOW),
            (guard.echo(stranger(), NOW + ECHO_AGE), NOW),
            (Vec::new(), NOW),
        ] {
            guard.echoed(stranger(), &echo, now);
            assert!(!guard.is_proved(stranger(), now), "{echo:?}");
        }
    }

    #[test]
    fn whoever_is_here_is_no_stranger() {
        let mut guard = Guard::new(&[7; 24]);
        for here in ["127.0.0.1:9", "[::1]:9", "[::ffff:127.0.0.1]:9"].map(|here| here.parse().unwrap()) {
            assert!(guard.lets_out(here, 1 << 20, NOW) && !(0..10_000).any(|_| guard.is_too_much(here, NOW)));
        }
        assert_eq!(guard.count(), 0);
    }

    #[test]
    fn a_network_that_asks_too_much_waits_a_moment() {
        let mut guard = Guard::new(&[7; 24]);
        assert_eq!((0..1000).filter(|_| !guard.is_too_much(stranger(), NOW)).count(), 400);
        assert!(!guard.is_too_much(stranger(), NOW + Duration::from_secs(1)));
        assert!(!guard.is_too_much("192.0.3.1:1".parse().unwrap(), NOW), "another network has its own share");
    }

    #[test]
    fn no_more_addresses_are_remembered_than_there_is_room_for() {
        let mut guard = Guard::new(&[7; 24]);
        for n in 0..20_000_u32 {
            let peer = SocketAddr::new(std::net::Ipv4Addr::from(0x0A00_0000 + n).into(), 5683);
            guard.received(peer, 10);
            guard.is_too_much(peer, NOW);
        }
        assert_eq!(guard.count(), 2 * PEERS);
    }
}
