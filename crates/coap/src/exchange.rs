//! Recognises repeated messages and stores their answers (RFC 7252, section 4.5). A repeated message gets the same
//! answer and has no second effect. The exception is an urgent message whose effect may have been undone since.
//! `reliable` retransmits our own messages.

use std::hash::{DefaultHasher, Hasher};
use std::net::SocketAddr;
use std::time::Duration;

use hashlink::LinkedHashMap;

use super::ExchangeId;
use super::limits::{EXCHANGE_LIFETIME, EXCHANGES};
use super::shares::Shares;

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct MessageKey {
    pub(super) peer: SocketAddr,
    pub(super) id: u16,
    /// Digest of the message's bytes. A sender may start its message ids from 0 again, or may use a port that another
    /// sender had before. The digest then shows that its message is new.
    pub(super) digest: u64,
}

impl MessageKey {
    pub(super) fn of(peer: SocketAddr, id: u16, datagram: &[u8]) -> MessageKey {
        let mut hasher = DefaultHasher::new();
        hasher.write(datagram);
        MessageKey { peer, id, digest: hasher.finish() }
    }
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum KnownMessage {
    Open(ExchangeId),
    /// The datagram that answered the message; empty if the message gets no answer.
    Answered(Vec<u8>),
}

/// The messages of the last `EXCHANGE_LIFETIME`. Commands from this machine and malformed urgent messages have a
/// separate table, so that a flood of other messages cannot push them out.
#[derive(Debug, Default)]
pub(super) struct Exchanges {
    reads: Table,
    commands: Table,
    /// Number of events so far that may have undone the effect of earlier urgent requests.
    pub(super) undone: u64,
}

#[derive(Clone, Debug)]
struct KnownExchange {
    since: Duration,
    message: KnownMessage,
    /// If set, the message counts as known only while `Exchanges::undone` has this value.
    good_while: Option<u64>,
}

/// Messages, oldest first. `shares` counts them for each sender.
#[derive(Debug, Default)]
struct Table {
    messages: LinkedHashMap<MessageKey, KnownExchange>,
    shares: Shares<MessageKey>,
}

impl Table {
    fn clear(&mut self, now: Duration) {
        while self.messages.front().is_some_and(|(_, entry)| is_over(entry.since, now)) {
            if let Some((key, _)) = self.messages.pop_front() {
                self.shares.forget_oldest(key.peer);
            }
        }
    }

    /// Adds a message. When there is no room, the sender with the most messages loses its oldest one.
    fn insert(&mut self, key: MessageKey, entry: KnownExchange) {
        if let Some(before) = self.messages.get_mut(&key) {
            // The message keeps its position, because `shares` lists the messages of a peer in the same order.
            *before = KnownExchange { since: before.since, ..entry };
            return;
        }
        self.messages.insert(key, entry);
        self.shares.add(key.peer, key);
        if self.messages.len() > EXCHANGES
            && let Some(oldest) = self.shares.take_from_the_largest()
        {
            self.messages.remove(&oldest);
        }
    }
}

impl Exchanges {
    pub(super) fn count(&self) -> usize {
        self.reads.messages.len() + self.commands.messages.len()
    }

    pub(super) fn known(&mut self, key: MessageKey, now: Duration) -> Option<&KnownMessage> {
        // Messages older than their lifetime are removed first, because their senders may use the ids again by now.
        for table in [&mut self.reads, &mut self.commands] {
            table.clear(now);
        }
        let undone = self.undone;
        let entry = self.entry(key).filter(|entry| entry.good_while.is_none_or(|good_while| good_while == undone))?;
        Some(&entry.message)
    }

    pub(super) fn open(&mut self, key: MessageKey, exchange: ExchangeId, is_command: bool, now: Duration) {
        let table = if is_command { &mut self.commands } else { &mut self.reads };
        table.insert(key, KnownExchange { since: now, message: KnownMessage::Open(exchange), good_while: None });
    }

    /// Marks a message that was just received. If the message is repeated after `undone` has changed, it takes effect
    /// again.
    pub(super) fn acts_again_when_undone(&mut self, key: MessageKey) {
        let undone = self.undone;
        if let Some(entry) = self.entry(key) {
            entry.good_while = Some(undone);
        }
    }

    pub(super) fn answered(&mut self, key: MessageKey, datagram: &[u8]) {
        if let Some(entry) = self.entry(key) {
            entry.message = KnownMessage::Answered(datagram.to_vec());
        }
    }

    fn entry(&mut self, key: MessageKey) -> Option<&mut KnownExchange> {
        self.reads.messages.get_mut(&key).or_else(|| self.commands.messages.get_mut(&key))
    }
}

/// Whether a message is so old that its sender may have used its id again. Such a message can be forgotten (RFC 7252,
/// section 4.8.2).
pub(super) fn is_over(since: Duration, now: Duration) -> bool {
    now > since + EXCHANGE_LIFETIME
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(id: u16) -> MessageKey {
        MessageKey::of("127.0.0.1:1".parse().unwrap(), id, b"message")
    }

    #[test]
    fn a_message_is_known_for_its_lifetime_and_not_longer() {
        let mut exchanges = Exchanges::default();
        exchanges.open(key(1), ExchangeId(1), false, Duration::ZERO);
        exchanges.answered(key(1), b"x");
        assert_eq!(exchanges.known(key(1), EXCHANGE_LIFETIME), Some(&KnownMessage::Answered(b"x".to_vec())));
        assert_eq!(exchanges.known(key(1), EXCHANGE_LIFETIME + Duration::from_millis(1)), None);
        assert_eq!(exchanges.known(key(2), Duration::ZERO), None);
    }

    #[test]
    fn another_message_under_the_same_id_is_another_message() {
        let mut exchanges = Exchanges::default();
        exchanges.open(key(1), ExchangeId(1), true, Duration::ZERO);
        let other = MessageKey::of(key(1).peer, 1, b"other");
        assert_eq!(exchanges.known(other, Duration::ZERO), None);
    }

    #[test]
    fn a_flood_of_reads_does_not_make_a_command_forgotten() {
        let mut exchanges = Exchanges::default();
        exchanges.open(key(0), ExchangeId(1), true, Duration::ZERO);
        for port in 1..=60_000 {
            let peer = format!("127.0.0.2:{port}").parse().unwrap();
            exchanges.open(MessageKey::of(peer, 9, b"read"), ExchangeId(2), false, Duration::ZERO);
        }
        assert_eq!(exchanges.known(key(0), Duration::ZERO), Some(&KnownMessage::Open(ExchangeId(1))));
        assert_eq!(exchanges.count(), EXCHANGES + 1);
    }

    /// A flood from another address, or from another port of the same address, must not push out a command. A
    /// repeated copy of a forgotten command would take effect a second time.
    #[test]
    fn nobodys_flood_of_commands_makes_those_of_another_forgotten() {
        for flood in ["127.0.0.7:1", "127.0.0.1:2"] {
            let mut exchanges = Exchanges::default();
            (0..9).for_each(|id| exchanges.open(key(id), ExchangeId(1), true, Duration::ZERO));
            let peer: SocketAddr = flood.parse().unwrap();
            for number in 0..3 * EXCHANGES {
                let (id, port) = (u16::try_from(number).unwrap(), peer.port() + u16::try_from(number % 100).unwrap());
                exchanges.open(
                    MessageKey::of(SocketAddr::new(peer.ip(), port), id, b"command"),
                    ExchangeId(2),
                    true,
                    Duration::ZERO,
                );
            }
            assert!((0..9).all(|id| exchanges.known(key(id), Duration::ZERO).is_some()), "{flood}");
            assert_eq!(exchanges.count(), EXCHANGES);
            assert_eq!(exchanges.known(key(0), EXCHANGE_LIFETIME * 2), None);
            assert_eq!(exchanges.count(), 0, "and nothing is left of anybody");
        }
    }

    #[test]
    fn an_id_that_is_used_again_is_the_new_message() {
        let mut exchanges = Exchanges::default();
        exchanges.open(key(1), ExchangeId(1), true, Duration::ZERO);
        exchanges.answered(key(1), b"old");
        let later = EXCHANGE_LIFETIME * 2;
        assert_eq!(exchanges.known(key(1), later), None);
        exchanges.open(key(1), ExchangeId(1), false, later);
        assert_eq!(exchanges.known(key(1), later), Some(&KnownMessage::Open(ExchangeId(1))));
        assert_eq!(exchanges.count(), 1);
    }
}
