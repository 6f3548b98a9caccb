//! Limits of MQTT sessions. Each key has a share. A part is reserved for operators, who may connect later. Newcomers
//! are not refused. Beyond a limit, a session of the key with the most sessions is evicted: the one that has made no
//! progress for the longest time (safety S9). The memory for unread messages of all sessions is limited in the same
//! way. Clients without a session yet are in `pending_connections`.
//!
//! One rule differs from the slots of HTTP: a viewer may evict an operator's session. This happens if all 256
//! sessions are taken, an operator's key has the most sessions, and viewers have not filled their part.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::Notify;

use super::connection_budget::ConnectionBudget;

/// Maximum number of sessions. This is enough for every screen, sensor and script of a site. Each session needs
/// descriptors.
pub(in crate::doors) const CONNECTIONS: usize = 256;

/// Maximum number of sessions of one key, enough for every screen of a large site. The same number of sessions is
/// reserved for operators, who may connect later.
const SHARE: usize = CONNECTIONS / 4;

/// Maximum size of the unread messages of all sessions, in bytes.
const UNREAD: usize = 12 * 1024 * 1024;

/// Part of `UNREAD` for viewers, in bytes. The rest is room for messages to operators.
const VIEWERS_UNREAD: usize = UNREAD / 2;

/// A session with at most this many unread bytes is never evicted because of unread bytes.
const LITTLE_UNREAD: usize = 48 * 1024;

/// Unread bytes are noted in steps of this size. Smaller steps would lock the table for every message.
const STEP: usize = 16 * 1024;

#[derive(Clone, Debug)]
pub(in crate::doors) struct SessionOwner {
    pub(in crate::doors) who: Arc<str>,
    pub(in crate::doors) is_viewer: bool,
    /// Whether the owner has used a key. Without keys all clients have the same owner, which has no share.
    pub(in crate::doors) has_share: bool,
}

#[derive(Clone, Debug)]
pub(in crate::doors) struct SessionLimits(Arc<Mutex<SessionTable>>);

#[derive(Debug)]
struct SessionTable {
    /// Maximum number of all sessions. One key may have at most `share` of them. The same number is reserved for
    /// operators.
    most: usize,
    share: usize,
    opened: u64,
    sessions: HashMap<u64, Session>,
}

#[derive(Debug)]
struct Session {
    owner: SessionOwner,
    progress_ms: Arc<AtomicU64>,
    evict: Arc<Notify>,
    unread: UnreadBytes,
    /// When the client last read a large part of its waiting bytes, or all of them. In milliseconds of the caller's
    /// clock.
    read_ms: u64,
}

/// Bytes in the program's memory that wait until a client reads them.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::doors) struct UnreadBytes {
    /// Bytes that wait for this client alone.
    pub(in crate::doors) here: usize,
    /// Bytes that may wait for other clients too.
    pub(in crate::doors) shared: usize,
}

/// The permit for one session. The session counts until this value is dropped.
#[derive(Debug)]
pub(in crate::doors) struct SessionPermit {
    limits: SessionLimits,
    number: u64,
    progress_ms: Arc<AtomicU64>,
    evict: Arc<Notify>,
    /// Unread bytes when they were last noted, in multiples of `STEP`.
    unread: AtomicUsize,
}

impl UnreadBytes {
    const fn all(self) -> usize {
        self.here + self.shared
    }
}

impl SessionLimits {
    pub(in crate::doors) fn new(budget: ConnectionBudget) -> SessionLimits {
        let [most, share] = [CONNECTIONS, SHARE].map(|all| budget.scaled(all));
        SessionLimits(Arc::new(Mutex::new(SessionTable { most, share, opened: 0, sessions: HashMap::new() })))
    }

    /// Opens a session, and evicts another one if necessary. `now` is a time of the caller's clock.
    pub(in crate::doors) fn take(&self, owner: SessionOwner, now: Duration) -> SessionPermit {
        let (progress_ms, evict) = (Arc::new(AtomicU64::new(ms(now))), Arc::default());
        let mut table = self.table();
        if let Some(session) = table.session_to_evict(&owner).and_then(|number| table.sessions.remove(&number)) {
            session.evict.notify_one();
        }
        table.opened += 1;
        let number = table.opened;
        let (unread, read_ms) = (UnreadBytes::default(), ms(now));
        let session = Session { owner, progress_ms: Arc::clone(&progress_ms), evict: Arc::clone(&evict), unread, read_ms };
        table.sessions.insert(number, session);
        drop(table);
        SessionPermit { limits: self.clone(), number, progress_ms, evict, unread: AtomicUsize::new(0) }
    }

    fn table(&self) -> MutexGuard<'_, SessionTable> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl SessionTable {
    /// Returns the session to evict for a newcomer, or `None` if there is room.
    fn session_to_evict(&self, newcomer: &SessionOwner) -> Option<u64> {
        let own = self.count(|owner| owner.who == newcomer.who);
        if newcomer.has_share && own >= self.share {
            return self.least_active(|owner| owner.who == newcomer.who);
        }
        let is_among: fn(&SessionOwner) -> bool =
            if newcomer.is_viewer && self.count(|owner| owner.is_viewer) >= self.most - self.share {
                |owner| owner.is_viewer
            } else if self.sessions.len() >= self.most {
                |_| true
            } else {
                return None;
            };
        let mut counts: HashMap<&str, usize> = HashMap::new();
        for session in self.sessions.values().filter(|session| is_among(&session.owner)) {
            *counts.entry(&session.owner.who).or_default() += 1;
        }
        let (greediest, most) = counts.into_iter().max_by_key(|(_, count)| *count)?;
        let evicted = if own >= most { &*newcomer.who } else { greediest };
        self.least_active(|owner| &*owner.who == evicted)
    }

    /// Returns the session to evict if there are more than `UNREAD` unread bytes. It belongs to the key with the most
    /// unread bytes, and has read nothing for the longest time. If viewers exceed their part, it is a viewer's
    /// session. `replaced` is the size of the messages that wait for several clients and are no longer retained. A
    /// session with little unread is never evicted.
    fn reader_to_evict(&self, replaced: usize) -> Option<u64> {
        let unread = |is_among: fn(&SessionOwner) -> bool| {
            self.sessions.values().filter(|session| is_among(&session.owner)).map(|session| session.unread.here).sum::<usize>()
        };
        if unread(|_| true) + replaced <= UNREAD {
            return None;
        }
        let viewers = (unread(|owner| owner.is_viewer) > VIEWERS_UNREAD).then(|| self.least_read(|owner| owner.is_viewer));
        viewers.flatten().or_else(|| self.least_read(|_| true))
    }

    /// Returns the session that has read nothing for the longest time, of the key with the most unread bytes.
    /// Sessions with at most `LITTLE_UNREAD` unread bytes are skipped.
    fn least_read(&self, is_among: fn(&SessionOwner) -> bool) -> Option<u64> {
        let among = || {
            let all = self.sessions.iter().filter(|(_, session)| is_among(&session.owner));
            all.filter(|(_, session)| session.unread.all() > LITTLE_UNREAD)
        };
        let mut waits: HashMap<&str, usize> = HashMap::new();
        for (_, session) in among() {
            *waits.entry(&session.owner.who).or_default() += session.unread.all();
        }
        let (greediest, _) = waits.into_iter().max_by_key(|(_, waits)| *waits)?;
        let of_greediest = among().filter(|(_, session)| &*session.owner.who == greediest);
        of_greediest.min_by_key(|(number, session)| (session.read_ms, **number)).map(|(number, _)| *number)
    }

    fn count(&self, is_among: impl Fn(&SessionOwner) -> bool) -> usize {
        self.sessions.values().filter(|session| is_among(&session.owner)).count()
    }

    fn least_active(&self, is_among: impl Fn(&SessionOwner) -> bool) -> Option<u64> {
        let among = self.sessions.iter().filter(|(_, session)| is_among(&session.owner));
        among.min_by_key(|(number, session)| (session.progress_ms.load(Ordering::Relaxed), **number)).map(|(number, _)| *number)
    }
}

impl SessionPermit {
    pub(in crate::doors) fn note_progress(&self, now: Duration) {
        self.progress_ms.store(ms(now), Ordering::Relaxed);
    }

    /// Notes how many bytes wait for the client. `read_at` is when the client last read a large part of them, or all.
    /// `replaced` returns the size of the messages that wait for several clients and are no longer retained. If the
    /// unread bytes of all sessions exceed `UNREAD`, sessions are evicted.
    pub(in crate::doors) fn note_unread(&self, unread: UnreadBytes, read_at: Duration, replaced: impl FnOnce() -> usize) {
        let (before, noted) = (self.unread.load(Ordering::Relaxed), unread.all() / STEP);
        if noted == before {
            return;
        }
        self.unread.store(noted, Ordering::Relaxed);
        let mut replaced = if noted > before { replaced() } else { 0 };
        let mut table = self.limits.table();
        let Some(session) = table.sessions.get_mut(&self.number) else { return };
        (session.unread, session.read_ms) = (unread, ms(read_at));
        while noted > before
            && let Some(session) = table.reader_to_evict(replaced).and_then(|number| table.sessions.remove(&number))
        {
            replaced = replaced.saturating_sub(session.unread.shared);
            session.evict.notify_one();
        }
    }

    /// Stops counting the session. The client may still be reading the reason why its session ends.
    pub(in crate::doors) fn release(&self) {
        self.limits.table().sessions.remove(&self.number);
    }

    pub(in crate::doors) async fn evicted(&self) {
        self.evict.notified().await;
    }
}

impl Drop for SessionPermit {
    fn drop(&mut self) {
        self.release();
    }
}

fn ms(duration: Duration) -> u64 {
    u64::try_from(duration.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use futures_util::FutureExt;

    use super::*;

    fn viewer(who: &str) -> SessionOwner {
        SessionOwner { who: Arc::from(who), is_viewer: true, has_share: true }
    }

    fn operator(who: &str) -> SessionOwner {
        SessionOwner { is_viewer: false, ..viewer(who) }
    }

    fn here() -> SessionOwner {
        SessionOwner { has_share: false, ..operator("operator") }
    }

    /// Opens this many sessions, one in each millisecond.
    fn crowd(limits: &SessionLimits, owner: &SessionOwner, count: usize) -> Vec<SessionPermit> {
        (0..count).map(|n| limits.take(owner.clone(), Duration::from_millis(n as u64))).collect()
    }

    fn lost(crowd: &[SessionPermit]) -> usize {
        let lost = crowd.iter().filter(|permit| permit.evicted().now_or_never().is_some());
        lost.inspect(|permit| permit.evict.notify_one()).count()
    }

    const NOW: Duration = Duration::from_secs(100);

    /// Safety S9.
    #[test]
    fn whoever_has_his_share_gives_up_one_of_his_own() {
        for owner in [viewer("screen"), operator("panel")] {
            let limits = SessionLimits::new(ConnectionBudget::default());
            let others = crowd(&limits, &operator("others"), SHARE);
            let own = crowd(&limits, &owner, SHARE);
            own[0].note_progress(NOW);
            let _newcomer = limits.take(owner, NOW);
            assert_eq!((lost(&own), lost(&own[1..2]), lost(&others)), (1, 1, 0));
        }
    }

    /// Safety S9.
    #[test]
    fn viewers_together_leave_sessions_to_operators_and_to_each_other() {
        let limits = SessionLimits::new(ConnectionBudget::default());
        // A fourth of all sessions is reserved for operators.
        let viewers = CONNECTIONS - CONNECTIONS / 4;
        let keys = viewers / SHARE + 2;
        let crowds: Vec<_> = (0..keys).map(|key| crowd(&limits, &viewer(&key.to_string()), SHARE)).collect();
        assert_eq!(limits.table().sessions.len(), viewers);
        let operators = crowd(&limits, &operator("operator"), CONNECTIONS - viewers);
        let mut before = 0;
        for crowd in &crowds {
            before += lost(crowd);
        }
        assert_eq!(before, keys * SHARE - viewers, "no operator has driven one away");
        let late = limits.take(viewer("late"), NOW);
        assert_eq!((lost(&[late]), lost(&operators)), (0, 0));
    }

    /// Safety S9.
    #[test]
    fn when_all_sessions_are_open_whoever_has_most_gives_way_to_any_newcomer() {
        let limits = SessionLimits::new(ConnectionBudget::default());
        let mut crowds: Vec<_> = (0..3).map(|key| crowd(&limits, &operator(&key.to_string()), SHARE - 1)).collect();
        crowds.push(crowd(&limits, &operator("most"), SHARE));
        let few = crowd(&limits, &viewer("few"), 3);
        assert_eq!(limits.table().sessions.len(), CONNECTIONS);
        let one = limits.take(viewer("few"), NOW);
        assert_eq!((lost(&crowds[3]), lost(&few)), (1, 0));
        let newcomers = [one, limits.take(operator("new"), NOW)];
        let lost = lost(&newcomers) + lost(&few);
        assert_eq!(lost, 0, "it was one of those who have as many as he who had most");
        assert_eq!(limits.table().sessions.len(), CONNECTIONS);
    }

    /// Safety S9: without keys.
    #[test]
    fn without_keys_nobody_has_a_share_and_the_least_active_gives_way() {
        let limits = SessionLimits::new(ConnectionBudget::default());
        let all = crowd(&limits, &here(), CONNECTIONS);
        assert_eq!(lost(&all), 0);
        for permit in &all[..CONNECTIONS - 1] {
            permit.note_progress(NOW);
        }
        let _newcomer = limits.take(here(), NOW);
        assert_eq!((lost(&all), lost(&all[CONNECTIONS - 1..])), (1, 1));
    }

    /// Notes `here` unread bytes for each session. The first session has read nothing for the longest time.
    fn pile_up(crowd: &[SessionPermit], here: usize) {
        for (n, permit) in (0..).zip(crowd) {
            permit.note_unread(UnreadBytes { here, ..UnreadBytes::default() }, Duration::from_millis(n), || 0);
        }
    }

    fn unread_here(limits: &SessionLimits) -> usize {
        limits.table().sessions.values().map(|session| session.unread.here).sum()
    }

    const MUCH: usize = 8 * LITTLE_UNREAD;

    /// Safety A5, S9.
    #[test]
    fn when_too_much_is_unread_whoever_has_read_nothing_for_longest_gives_way() {
        let limits = SessionLimits::new(ConnectionBudget::default());
        let all = crowd(&limits, &here(), CONNECTIONS);
        pile_up(&all[..1], LITTLE_UNREAD);
        pile_up(&all[1..UNREAD / MUCH], MUCH);
        assert_eq!(lost(&all), 0);
        pile_up(&all[UNREAD / MUCH..], MUCH);
        assert_eq!(lost(&all[..1]), 0, "little waits for it");
        let left = limits.table().sessions.len() - 1;
        assert_eq!(lost(&all[..CONNECTIONS - left]), CONNECTIONS - left - 1, "those who read last are there still");
        let unread = unread_here(&limits);
        assert!(unread <= UNREAD && unread > UNREAD - 2 * MUCH, "{unread}");
    }

    /// Safety A5, S9.
    #[test]
    fn what_viewers_do_not_read_harms_no_operator() {
        let limits = SessionLimits::new(ConnectionBudget::default());
        let screens = crowd(&limits, &operator("screens"), SHARE);
        pile_up(&screens, LITTLE_UNREAD);
        let viewers = ["one", "two", "three"].map(|key| crowd(&limits, &viewer(key), SHARE));
        viewers.iter().for_each(|viewers| pile_up(viewers, MUCH / 2));
        pile_up(&screens[..4], MUCH);
        assert_eq!(lost(&screens), 0);
        assert!(unread_here(&limits) <= UNREAD);
    }

    /// Safety A5: a message that waits for several clients counts once it is no longer retained. Retained messages do
    /// not count.
    #[test]
    fn what_several_wait_for_counts_when_it_is_kept_no_more() {
        let limits = SessionLimits::new(ConnectionBudget::default());
        let all = crowd(&limits, &here(), SHARE);
        let shared = UnreadBytes { shared: MUCH, ..UnreadBytes::default() };
        all.iter().for_each(|permit| permit.note_unread(shared, NOW, || 0));
        assert_eq!(lost(&all), 0);
        all[5].note_unread(UnreadBytes { here: MUCH, ..shared }, NOW + NOW, || UNREAD);
        assert_eq!((lost(&all[..1]), lost(&all)), (1, 1), "one is enough");
    }

    #[test]
    fn a_session_that_has_ended_makes_room() {
        let limits = SessionLimits::new(ConnectionBudget::default());
        for _ in 0..3 {
            assert_eq!(lost(&crowd(&limits, &here(), CONNECTIONS)), 0);
        }
        assert!(limits.table().sessions.is_empty());
    }
}
