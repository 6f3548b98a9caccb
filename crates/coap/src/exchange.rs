//! Which messages came already, and what they were answered with (RFC 7252, section 4.5): a message that comes again gets the same
//! answer and has no second effect, unless it was urgent and what it did may have been undone since. Retransmitting what this side
//! sent stands in `reliable`.

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
    /// What it is: a sender that counts from 0 again, or has its port from another, is not taken for repeating itself.
    pub(super) digest: u64,
}

impl MessageKey {
    pub(super) fn of(peer: SocketAddr, id: u16, datagram: &[u8]) -> MessageKey {
        let mut hasher = DefaultHasher::new();
        hasher.write(datagram);
        MessageKey { peer, id, digest: hasher.finish() }
    }
}

/// What is known of a message that came before.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum KnownMessage {
    Open(ExchangeId),
    /// It was answered with this datagram; with nothing, when it is empty.
    Answered(Vec<u8>),
}

/// The messages of the last minutes. Those that only read and commands have a table each, so that a flood of the former does not
/// make the latter forgotten.
#[derive(Debug, Default)]
pub(super) struct Exchanges {
    reads: Table,
    commands: Table,
    /// How often what urgent requests did may have been undone so far.
    pub(super) undone: u64,
}

#[derive(Clone, Debug)]
struct KnownExchange {
    since: Duration,
    message: KnownMessage,
    /// The message stands for itself only while `undone` is this.
    good_while: Option<u64>,
}

/// Messages, oldest first, and whose they are.
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

    /// Remembers one more, in the place of the oldest of whoever has most when there is no room.
    fn insert(&mut self, key: MessageKey, entry: KnownExchange) {
        if let Some(before) = self.messages.get_mut(&key) {
            // In its old place: `shares` has the messages of a peer in the same order.
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
        // From here on the same id is another message.
        for table in [&mut self.reads, &mut self.commands] {
            table.clear(now);
        }
        let undone = self.undone;
        let entry = self.entry(key).filter(|entry| entry.good_while.is_none_or(|good_while| good_while == undone))?;
        Some(&entry.message)
    }

    /// Remembers a message that is to be answered, of which nothing was known.
    pub(super) fn open(&mut self, key: MessageKey, exchange: ExchangeId, is_command: bool, now: Duration) {
        let table = if is_command { &mut self.commands } else { &mut self.reads };
        table.insert(key, KnownExchange { since: now, message: KnownMessage::Open(exchange), good_while: None });
    }

    /// A message that was opened just now has to act anew when it comes again after `undone` has changed.
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

/// Whether what a message began is over (RFC 7252, section 4.8.2), so that it need not be remembered any more.
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

    /// Neither from another address nor from another program at the same: what was forgotten would act twice.
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
