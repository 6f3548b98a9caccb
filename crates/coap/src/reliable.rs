//! Our messages that need an acknowledgement (RFC 7252, section 4.2). Each peer gets one at a time. A message is
//! repeated up to four times: first after 2 to 3 seconds, and then after twice as long each time. The contents of the
//! messages are not known here.

use std::collections::{BTreeSet, HashMap, VecDeque};
use std::net::SocketAddr;
use std::time::Duration;

use super::chance::Chance;
use super::limits::{ACK_SPREAD, ACK_TIMEOUT, MAX_RETRANSMIT, RELIABLE_PEERS, WAITING};
use super::message::Outgoing;
use super::subject::ObserverId;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum About {
    /// A separate answer, or an observer's last message.
    Answer,
    /// A notification: its observer, the index of the thing and its version.
    Notification(ObserverId, usize, u64),
}

#[derive(Clone, Debug)]
pub(super) struct Sent {
    pub(super) id: u16,
    pub(super) about: About,
    pub(super) bytes: Vec<u8>,
    pub(super) first: Duration,
    due: Duration,
    wait: Duration,
    tries: u32,
}

#[derive(Clone, Debug)]
pub(super) enum Late {
    Again(SocketAddr, Sent),
    GivenUp(SocketAddr, Sent),
}

/// All messages that wait for their acknowledgement, or for the acknowledgement of the message before them.
#[derive(Debug)]
pub(super) struct Reliable {
    peers: HashMap<SocketAddr, PeerQueue>,
    due: BTreeSet<(Duration, SocketAddr)>,
    chance: Chance,
}

#[derive(Debug, Default)]
struct PeerQueue {
    sent: Option<Sent>,
    /// Answers that wait for their turn. They have no message ids yet.
    waiting: VecDeque<Outgoing>,
}

impl Reliable {
    pub(super) fn new(chance: Chance) -> Reliable {
        Reliable { peers: HashMap::new(), due: BTreeSet::new(), chance }
    }

    pub(super) fn count(&self) -> usize {
        self.peers.values().map(|queue| queue.waiting.len() + usize::from(queue.sent.is_some())).sum()
    }

    pub(super) fn is_full(&self) -> bool {
        self.peers.len() >= RELIABLE_PEERS
    }

    pub(super) fn is_busy(&self, peer: SocketAddr) -> bool {
        self.peers.get(&peer).is_some_and(|queue| queue.sent.is_some())
    }

    pub(super) fn about(&self, peer: SocketAddr) -> Option<About> {
        self.peers.get(&peer)?.sent.as_ref().map(|sent| sent.about)
    }

    /// Notes that a message was sent. No other message may be on its way to this peer.
    pub(super) fn sent(&mut self, peer: SocketAddr, id: u16, about: About, bytes: Vec<u8>, now: Duration) {
        let wait = ACK_TIMEOUT.mul_f64(1.0 + ACK_SPREAD * self.chance.fraction());
        let due = now + wait;
        let queue = self.peers.entry(peer).or_default();
        debug_assert!(queue.sent.is_none(), "one at a time");
        queue.sent = Some(Sent { id, about, bytes, first: now, due, wait, tries: 0 });
        self.due.insert((due, peer));
    }

    /// Queues an answer until its turn comes, or returns it if too many wait.
    pub(super) fn wait(&mut self, peer: SocketAddr, waiting: Outgoing) -> Result<(), Outgoing> {
        let queue = self.peers.entry(peer).or_default();
        if queue.waiting.len() >= WAITING {
            return Err(waiting);
        }
        queue.waiting.push_back(waiting);
        Ok(())
    }

    /// The next waiting answer for this peer, if no message is on its way there.
    pub(super) fn next(&mut self, peer: SocketAddr) -> Option<Outgoing> {
        let queue = self.peers.get_mut(&peer).filter(|queue| queue.sent.is_none())?;
        let next = queue.waiting.pop_front();
        if next.is_none() {
            self.peers.remove(&peer);
        }
        next
    }

    /// Removes a message that was acknowledged or rejected. Returns the message, and whether it was sent only once.
    pub(super) fn settled(&mut self, peer: SocketAddr, id: u16) -> Option<(Sent, bool)> {
        let queue = self.peers.get_mut(&peer)?;
        let sent = queue.sent.take_if(|sent| sent.id == id)?;
        self.due.remove(&(sent.due, peer));
        let once = sent.tries == 0;
        Some((sent, once))
    }

    /// Finds the peer that has left a retransmitted notification unacknowledged for longest, among the peers that
    /// `is_meant` accepts. Returns the peer and the observer of this notification.
    pub(super) fn most_silent(&self, is_meant: impl Fn(SocketAddr) -> bool) -> Option<(SocketAddr, ObserverId)> {
        let sent =
            self.peers.iter().filter_map(|(peer, queue)| Some((*peer, queue.sent.as_ref().filter(|sent| sent.tries > 0)?)));
        let silent = sent.filter_map(|(peer, sent)| match sent.about {
            About::Notification(observer, ..) => is_meant(peer).then_some((sent.first, peer, observer)),
            About::Answer => None,
        });
        silent.min().map(|(_, peer, observer)| (peer, observer))
    }

    pub(super) fn withdraw(&mut self, peer: SocketAddr, observer: ObserverId) {
        let Some(queue) = self.peers.get_mut(&peer) else { return };
        let is_its = |sent: &mut Sent| matches!(sent.about, About::Notification(whose, ..) if whose == observer);
        if let Some(sent) = queue.sent.take_if(is_its) {
            self.due.remove(&(sent.due, peer));
        }
    }

    /// Returns the next message that was not acknowledged in time. If the message must be repeated, the caller sends it
    /// and this function notes `now` as the time of sending. Call `replace` if there is newer content.
    pub(super) fn late(&mut self, now: Duration) -> Option<Late> {
        let (due, peer) = *self.due.first().filter(|(due, _)| *due <= now)?;
        self.due.remove(&(due, peer));
        let queue = self.peers.get_mut(&peer)?;
        if queue.sent.as_ref()?.tries >= MAX_RETRANSMIT {
            return queue.sent.take().map(|sent| Late::GivenUp(peer, sent));
        }
        let sent = queue.sent.as_mut()?;
        sent.tries += 1;
        sent.wait *= 2;
        sent.due = now + sent.wait;
        self.due.insert((sent.due, peer));
        Some(Late::Again(peer, sent.clone()))
    }

    /// Replaces a message on its way by a newer one. The number of retransmissions is kept (RFC 7641, section 4.5.2).
    pub(super) fn replace(&mut self, peer: SocketAddr, id: u16, about: About, bytes: Vec<u8>) {
        if let Some(sent) = self.peers.get_mut(&peer).and_then(|queue| queue.sent.as_mut()) {
            (sent.id, sent.about, sent.bytes) = (id, about, bytes);
        }
    }

    pub(super) fn timeout(&self) -> Option<Duration> {
        self.due.first().map(|(due, _)| *due)
    }
}

#[cfg(test)]
mod tests {
    use super::super::chance::Purpose;
    use super::super::code::Code;
    use super::super::message::Token;
    use super::*;

    fn peer() -> SocketAddr {
        "127.0.0.1:1".parse().unwrap()
    }

    fn answer() -> Outgoing {
        Outgoing::new(Code::CONTENT, Token::default(), 0)
    }

    fn reliable() -> Reliable {
        Reliable::new(Chance::new(1, Purpose::Spread))
    }

    #[test]
    fn what_is_never_acknowledged_is_sent_five_times_in_all_and_then_given_up() {
        let mut reliable = reliable();
        reliable.sent(peer(), 7, About::Answer, vec![1], Duration::ZERO);
        let (mut before, mut gap) = (Duration::ZERO, None::<Duration>);
        for _ in 0..MAX_RETRANSMIT {
            let at = reliable.timeout().unwrap();
            assert!(reliable.late(at.saturating_sub(Duration::from_millis(1))).is_none());
            assert!(matches!(reliable.late(at), Some(Late::Again(_, sent)) if sent.id == 7));
            assert!(gap.is_none_or(|gap| at - before == gap * 2), "twice as long each time");
            assert!(gap.is_some() || (2.0..=3.0).contains(&at.as_secs_f64()));
            (gap, before) = (Some(at - before), at);
        }
        assert!(matches!(reliable.late(reliable.timeout().unwrap()), Some(Late::GivenUp(..))));
        assert_eq!((reliable.timeout(), reliable.is_busy(peer())), (None, false));
    }

    #[test]
    fn an_acknowledgement_ends_it_and_lets_the_next_one_go() {
        let mut reliable = reliable();
        reliable.sent(peer(), 7, About::Answer, vec![1], Duration::ZERO);
        assert!(reliable.wait(peer(), answer()).is_ok());
        assert!(reliable.next(peer()).is_none(), "one at a time");
        assert!(reliable.settled(peer(), 8).is_none(), "another id");
        assert!(reliable.settled(peer(), 7).is_some_and(|(_, once)| once));
        assert!(reliable.next(peer()).is_some() && reliable.next(peer()).is_none());
        assert_eq!((reliable.count(), reliable.timeout()), (0, None));
    }

    #[test]
    fn only_so_many_answers_wait_for_one_peer() {
        let mut reliable = reliable();
        reliable.sent(peer(), 7, About::Answer, vec![1], Duration::ZERO);
        assert_eq!((0..100).filter(|_| reliable.wait(peer(), answer()).is_ok()).count(), WAITING);
    }
}
