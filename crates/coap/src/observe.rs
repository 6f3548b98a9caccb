//! Tracks observers: what was sent to each of them, and when to send more (RFC 7641). Observers of the same path and
//! query in the same format share one *subject*. The application provides the state of a subject. Nothing is queued:
//! an observer gets the newest state when its turn comes. Notifications are written and acknowledged elsewhere.
//!
//! ```text
//!   changed ──► sent as NON, at most every PACE ──► unchanged for SETTLED ──► sent again as CON
//!                └─ sent as CON when the last CON was CONFIRM_EVERY ago
//! ```

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use super::block::Block;
use super::knowledge::{Knowledge, Lack};
use super::limits::{
    BURST, CONFIRM_EVERY, OBSERVERS, OBSERVERS_BEYOND, OBSERVERS_OF_A_NETWORK, OBSERVERS_OF_A_PEER, PACE, PACE_OF_A_PEER,
    PACE_UNKNOWN, READING, REFRESH, SETTLED, TARGET, UNPROVED, UNPROVED_OBSERVERS,
};
use super::message::Token;
use super::network::{Network, is_this_machine};
use super::request::Request;
use super::response::Response;
use super::subject::{ObserverId, Subject, Target};

/// The acknowledgements of an observer. A new registration does not reset them. So an observer cannot keep its place
/// by registering again and again.
#[derive(Clone, Copy, Debug)]
pub(super) struct Acknowledging {
    /// When the observer was last asked for an acknowledgement. Before the first request, the time of its
    /// registration.
    asked: Duration,
    /// When the observer was first asked after its latest acknowledgement. `None` if no acknowledgement is
    /// outstanding.
    unanswered: Option<Duration>,
    is_proved: bool,
}

/// Identifies what is observed: a path, a query and a format.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SubjectId(u64);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Crowd {
    /// Only the new observation: its peer has too many observations, or its path is too long. No other observation is
    /// removed for it.
    Itself,
    Network(Network),
    /// All observations from other machines. No observation from this machine is removed for one from another
    /// machine.
    Beyond,
    All,
}

impl Crowd {
    pub(super) fn has(self, peer: SocketAddr) -> bool {
        match self {
            Crowd::Itself => false,
            Crowd::Network(network) => Network::of(peer.ip()) == network,
            Crowd::Beyond => !is_this_machine(peer.ip()),
            Crowd::All => true,
        }
    }
}

#[derive(Clone, Debug)]
pub(super) struct Notification {
    pub(super) peer: SocketAddr,
    pub(super) token: Token,
    pub(super) response: Arc<Response>,
    /// Index of the thing among the things of its subject.
    pub(super) thing: usize,
    pub(super) version: u64,
    /// Size exponent of the blocks that the observer wants: each has 2^(`exponent` + 4) bytes.
    pub(super) exponent: u8,
    pub(super) confirm: bool,
    /// The Observe number of 24 bits; `None` for the last notification.
    pub(super) sequence: Option<u32>,
}

#[derive(Debug, Default)]
pub(super) struct Observers {
    subjects: BTreeMap<SubjectId, Subject>,
    by_target: HashMap<Target, SubjectId>,
    observers: HashMap<ObserverId, Observer>,
    by_peer: HashMap<SocketAddr, Vec<ObserverId>>,
    due: BTreeSet<(Duration, ObserverId)>,
    counted: u64,
    /// What the wall clock showed at the endpoint's time zero, as the time since 1970. The Observe numbers follow
    /// this clock, so they continue after a restart.
    began: Duration,
}

#[derive(Debug)]
struct Observer {
    peer: SocketAddr,
    token: Token,
    subject: SubjectId,
    exponent: u8,
    knowledge: Knowledge,
    /// A body of which the observer was sent only the first block. The further blocks are read from this body, even
    /// if the state has changed since.
    begun: Option<Arc<Response>>,
    /// Whether the observer may still be reading `begun`.
    is_reading: bool,
    /// The message ids of the latest notifications. An observer rejects a notification by its id.
    ids: [Option<u16>; 4],
    sequence: u64,
    sent: Duration,
    acknowledging: Acknowledging,
    /// Round-trip time, once known.
    away: Option<Duration>,
    due: Option<Duration>,
}

pub(super) struct Registration<'a> {
    pub(super) request: &'a Request,
    pub(super) token: Token,
    /// Size exponent of the blocks that the observer wants: each has 2^(`exponent` + 4) bytes.
    pub(super) exponent: u8,
    /// The answer, which shows the present state.
    pub(super) shown: &'a Arc<Response>,
    /// Whether the answer is sure to arrive. It is if it acknowledges a CON, because the sender repeats a CON until
    /// the answer arrives.
    pub(super) is_sure: bool,
}

impl Observers {
    pub(super) fn new(began: Duration) -> Observers {
        Observers { began, ..Observers::default() }
    }

    pub(super) fn count(&self) -> usize {
        self.observers.len()
    }

    pub(super) fn subjects(&self) -> Vec<(SubjectId, Arc<Request>)> {
        self.subjects.iter().map(|(id, subject)| (*id, Arc::clone(&subject.request))).collect()
    }

    /// Registers an observer. Returns the Observe number for the answer, which shows the present state. Returns
    /// `None` if there are too many observations, or if there are many and this observer has not acknowledged for
    /// `UNPROVED`. The answer shows one thing, and the other things are sent to the observer afterwards. An answer
    /// that may be lost is sent again.
    pub(super) fn register(
        &mut self,
        registration: Registration<'_>,
        things: Vec<Arc<Response>>,
        before: Option<Acknowledging>,
        now: Duration,
    ) -> Option<u32> {
        let Registration { request, token, exponent, shown, is_sure } = registration;
        if self.crowd(request).is_some() {
            return None;
        }
        let is_crowded = self.observers.len() >= UNPROVED_OBSERVERS;
        let unanswered = before.filter(|before| !before.is_proved).and_then(|before| before.unanswered);
        if is_crowded && unanswered.is_some_and(|first| now >= first + UNPROVED) {
            return None;
        }
        let is_sure = is_sure && !is_crowded;
        let subject = self.subject(request);
        self.change(subject, things, now);
        self.counted += 1;
        let id = ObserverId(self.counted);
        let known = self.subjects.get_mut(&subject).expect("it was found or made just now");
        known.observers.insert(id);
        let mut observer = Observer {
            peer: request.peer,
            token,
            subject,
            exponent,
            knowledge: Knowledge::of(&known.things, shown, is_sure, now),
            begun: None,
            is_reading: false,
            ids: [None; 4],
            sequence: 0,
            sent: now,
            acknowledging: before.unwrap_or(Acknowledging { asked: now, unanswered: None, is_proved: false }),
            away: None,
            due: None,
        };
        observer.begin(shown);
        self.observers.insert(id, observer);
        self.by_peer.entry(request.peer).or_default().push(id);
        self.schedule(id, now);
        self.sequence(id, now)
    }

    pub(super) fn find(&self, peer: SocketAddr, token: Token) -> Option<ObserverId> {
        self.of_peer(peer).find(|id| self.observers.get(id).is_some_and(|observer| observer.token == token))
    }

    pub(super) fn acknowledging(&self, id: ObserverId) -> Option<Acknowledging> {
        self.observers.get(&id).map(|observer| observer.acknowledging)
    }

    /// The observation whose notification had this message id.
    pub(super) fn told_by(&self, peer: SocketAddr, id: u16) -> Option<ObserverId> {
        self.of_peer(peer).find(|whose| self.observers.get(whose).is_some_and(|observer| observer.ids.contains(&Some(id))))
    }

    pub(super) fn of_peer(&self, peer: SocketAddr) -> impl Iterator<Item = ObserverId> {
        self.by_peer.get(&peer).into_iter().flatten().copied()
    }

    pub(super) fn clear(&mut self) -> Vec<(SocketAddr, Token)> {
        let gone = std::mem::replace(self, Observers::new(self.began)).observers;
        gone.into_values().map(|observer| (observer.peer, observer.token)).collect()
    }

    pub(super) fn remove(&mut self, id: ObserverId) {
        let Some(observer) = self.observers.remove(&id) else { return };
        if let Some(due) = observer.due {
            self.due.remove(&(due, id));
        }
        if let Some(others) = self.by_peer.get_mut(&observer.peer) {
            others.retain(|other| *other != id);
            if others.is_empty() {
                self.by_peer.remove(&observer.peer);
            }
        }
        let Some(subject) = self.subjects.get_mut(&observer.subject) else { return };
        subject.observers.remove(&id);
        if subject.observers.is_empty() {
            self.by_target.remove(&Target::of(&subject.request));
            self.subjects.remove(&observer.subject);
        }
    }

    /// Takes the present state of a subject's things, and schedules notifications if something has changed. Many
    /// observers are notified in groups, a millisecond apart.
    pub(super) fn change(&mut self, subject: SubjectId, things: Vec<Arc<Response>>, now: Duration) {
        let Some(known) = self.subjects.get_mut(&subject) else { return };
        if known.take(things) {
            let observers: Vec<ObserverId> = known.observers.iter().copied().collect();
            for (place, observer) in observers.into_iter().enumerate() {
                let millis = u64::try_from(place / BURST).unwrap_or(u64::MAX);
                self.schedule(observer, now + Duration::from_millis(millis));
            }
        }
    }

    pub(super) fn due(&mut self, now: Duration) -> Option<ObserverId> {
        let (due, id) = *self.due.first().filter(|(due, _)| *due <= now)?;
        self.due.remove(&(due, id));
        if let Some(observer) = self.observers.get_mut(&id) {
            observer.due = None;
        }
        Some(id)
    }

    pub(super) fn notification(&mut self, id: ObserverId, now: Duration) -> Option<Notification> {
        let observer = self.observers.get(&id)?;
        let things = &self.subjects.get(&observer.subject)?.things;
        let (thing, is_news) = match observer.knowledge.lack(things, now) {
            Some(Lack::News(thing)) => (thing, true),
            Some(Lack::Unsure(thing)) => (thing, false),
            None if now >= observer.sent + REFRESH => (observer.knowledge.latest(), false),
            None => return None,
        };
        let told = things.get(thing)?;
        let (response, version) = (Arc::clone(&told.response), told.version);
        let is_far = observer.away.is_none() && !is_this_machine(observer.peer.ip());
        let is_last = !response.code.is_success();
        // If there are many observers, one that has not acknowledged anything yet is soon asked for an
        // acknowledgement, even while things change all the time.
        let Acknowledging { asked, is_proved, .. } = observer.acknowledging;
        let is_trusted = is_proved || self.observers.len() < UNPROVED_OBSERVERS;
        let confirm_at = asked + if is_trusted { CONFIRM_EVERY } else { SETTLED };
        let confirm = !is_news || is_far || is_last || now >= confirm_at;
        let (peer, token, exponent) = (observer.peer, observer.token, observer.exponent);
        let sequence = if is_last { None } else { self.sequence(id, now) };
        Some(Notification { peer, token, response, thing, version, exponent, confirm, sequence })
    }

    /// A notification of the thing's newest version. It replaces the notification of `version`, which is on its way.
    /// `None` if there is no newer version.
    pub(super) fn newer(&mut self, id: ObserverId, thing: usize, version: u64, now: Duration) -> Option<Notification> {
        let observer = self.observers.get(&id)?;
        let newest = self.subjects.get(&observer.subject)?.things.get(thing).filter(|newest| newest.version > version)?;
        let (response, version) = (Arc::clone(&newest.response), newest.version);
        let (peer, token, exponent) = (observer.peer, observer.token, observer.exponent);
        let sequence = if response.code.is_success() { self.sequence(id, now) } else { None };
        Some(Notification { peer, token, response, thing, version, exponent, confirm: true, sequence })
    }

    pub(super) fn told(&mut self, id: ObserverId, notification: &Notification, message: u16, now: Duration) {
        let Some(observer) = self.observers.get_mut(&id) else { return };
        if let Some(subject) = self.subjects.get(&observer.subject) {
            observer.knowledge.told(&subject.things, notification.thing, notification.version, now);
        }
        observer.begin(&notification.response);
        observer.ids.rotate_right(1);
        observer.ids[0] = Some(message);
        observer.sent = now;
        if notification.confirm {
            observer.acknowledging.asked = now;
            observer.acknowledging.unanswered.get_or_insert(now);
        }
        self.schedule(id, now);
    }

    /// Notes that a notification was acknowledged. `away` is its round-trip time, if known.
    pub(super) fn acknowledged(&mut self, id: ObserverId, thing: usize, version: u64, away: Option<Duration>, now: Duration) {
        let Some(observer) = self.observers.get_mut(&id) else { return };
        observer.knowledge.acknowledged(thing, version);
        (observer.acknowledging.unanswered, observer.acknowledging.is_proved) = (None, true);
        // The round-trip time is smoothed, so that one slow answer does not slow down all notifications.
        observer.away = away.map(|away| observer.away.map_or(away, |before| (before * 7 + away) / 8)).or(observer.away);
        self.schedule(id, now);
    }

    /// Returns the body from which the requested further block is read: the body whose first block was sent in a
    /// notification, even if the state has changed since. `None` if this peer does not observe such a body.
    pub(super) fn read_on(&mut self, request: &Request, block: Block, now: Duration) -> Option<Arc<Response>> {
        let id = self.observer_of(request)?;
        let observer = self.observers.get_mut(&id)?;
        let begun = Arc::clone(observer.begun.as_ref()?);
        if block.within(begun.body.len()).is_none_or(|(block, _)| !block.more) {
            observer.is_reading = false;
            self.schedule(id, now);
        }
        Some(begun)
    }

    /// Ends the reading of an observed body, because the peer now reads the thing from the first block with a new
    /// request.
    pub(super) fn read_anew(&mut self, request: &Request) {
        let observer = self.observer_of(request).and_then(|id| self.observers.get_mut(&id));
        if let Some(observer) = observer {
            observer.begun = None;
        }
    }

    fn observer_of(&self, request: &Request) -> Option<ObserverId> {
        let is_this = |id: &ObserverId| {
            let subject = self.observers.get(id).and_then(|observer| self.subjects.get(&observer.subject));
            subject.is_some_and(|subject| Target::of(&subject.request) == Target::of(request))
        };
        self.of_peer(request.peer).find(is_this)
    }

    /// Schedules every observation of a peer again. Call this when no message to this peer is on its way any more.
    pub(super) fn wake(&mut self, peer: SocketAddr, now: Duration) {
        let ids: Vec<ObserverId> = self.of_peer(peer).collect();
        for id in ids {
            self.schedule(id, now);
        }
    }

    pub(super) fn timeout(&self) -> Option<Duration> {
        self.due.first().map(|(due, _)| *due)
    }

    /// Says which group of observations leaves no room for a new one; `None` if there is room. Observations from this
    /// machine never make room for observations from other machines.
    pub(super) fn crowd(&self, request: &Request) -> Option<Crowd> {
        let of_this_peer = self.by_peer.get(&request.peer).map_or(0, Vec::len);
        let target: usize = request.path.iter().chain(&request.queries).map(String::len).sum();
        if of_this_peer >= OBSERVERS_OF_A_PEER || target > TARGET {
            return Some(Crowd::Itself);
        }
        let is_full = self.observers.len() >= OBSERVERS;
        if is_this_machine(request.peer.ip()) {
            return is_full.then_some(Crowd::All);
        }
        let network = Network::of(request.peer.ip());
        let strangers = self.by_peer.iter().filter(|(peer, _)| !is_this_machine(peer.ip()));
        let of = strangers.map(|(peer, theirs)| (Network::of(peer.ip()) == network, theirs.len()));
        let (of_this_network, in_all) =
            of.fold((0, 0), |(own, all), (is_own, count)| (own + if is_own { count } else { 0 }, all + count));
        if of_this_network >= OBSERVERS_OF_A_NETWORK {
            return Some(Crowd::Network(network));
        }
        (is_full || in_all >= OBSERVERS_BEYOND).then_some(Crowd::Beyond)
    }

    fn subject(&mut self, request: &Request) -> SubjectId {
        let target = Target::of(request);
        if let Some(id) = self.by_target.get(&target) {
            return *id;
        }
        self.counted += 1;
        let id = SubjectId(self.counted);
        let subject = Subject::new(request);
        self.subjects.insert(id, subject);
        self.by_target.insert(target, id);
        id
    }

    /// Sets the time of an observer's next notification, not before `earliest`. If there is nothing new to send, the
    /// state is sent again before it is out of date.
    fn schedule(&mut self, id: ObserverId, earliest: Duration) {
        let Some(observer) = self.observers.get_mut(&id) else { return };
        let Some(subject) = self.subjects.get(&observer.subject) else { return };
        if let Some(due) = observer.due.take() {
            self.due.remove(&(due, id));
        }
        let of_this_peer = self.by_peer.get(&observer.peer).map_or(1, Vec::len);
        let pace = observer.pace().max(PACE_OF_A_PEER * u32::try_from(of_this_peer).unwrap_or(u32::MAX));
        let due = observer.knowledge.due(&subject.things, observer.sent, pace);
        let due = due.unwrap_or(observer.sent + REFRESH).max(earliest);
        observer.due = Some(due);
        self.due.insert((due, id));
    }

    /// The next Observe number of an observer. It follows the wall clock, 32 per millisecond, and is always higher
    /// than the last one. Numbers after a restart of the program follow the earlier ones (RFC 7641, section 4.4).
    fn sequence(&mut self, id: ObserverId, now: Duration) -> Option<u32> {
        let ticks = u64::try_from((self.began + now).as_micros() * 4 / 125).ok()?;
        let observer = self.observers.get_mut(&id)?;
        observer.sequence = ticks.max(observer.sequence + 1);
        u32::try_from(observer.sequence & 0x00FF_FFFF).ok()
    }
}

impl Observer {
    /// Notes that this response was sent to the observer, either whole or only its first block.
    fn begin(&mut self, response: &Arc<Response>) {
        self.is_reading = Block { exponent: self.exponent, ..Block::FIRST }.size() < response.body.len();
        if self.is_reading {
            self.begun = Some(Arc::clone(response));
        }
    }

    fn pace(&self) -> Duration {
        if self.is_reading {
            return READING;
        }
        if is_this_machine(self.peer.ip()) { PACE } else { self.away.map_or(PACE_UNKNOWN, |away| away.max(PACE)) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety S9: which observers a crowd includes.
    #[test]
    fn nobody_gives_way_to_another_network_or_from_this_machine_to_those_beyond_it() {
        let [here, near, far] = ["127.0.0.1:1", "192.0.2.1:1", "198.51.100.1:1"].map(|peer| peer.parse().expect("an address"));
        let network = Crowd::Network(Network::of("192.0.2.1".parse().expect("an address")));
        for (crowd, members) in [
            (Crowd::Itself, [false, false, false]),
            (network, [false, true, false]),
            (Crowd::Beyond, [false, true, true]),
            (Crowd::All, [true, true, true]),
        ] {
            assert_eq!([here, near, far].map(|peer| crowd.has(peer)), members, "{crowd:?}");
        }
    }
}
