//! Who may stay: so many clients at once, of whom each key has its share, and those who only look leave some to operators who are not
//! there yet. Nobody is turned away: where there is no seat left, one of whoever has most is given up, the one that has made no
//! progress for longest (safety S9). The same goes for the memory that all of them have in common, for what their clients do not read.
//! Connections that have not said who they are have no seat yet.

use std::collections::HashMap;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::Notify;

use super::connection_budget::ConnectionBudget;

/// Clients at once: every screen, sensor and script of a site. Each costs a descriptor.
pub(in crate::doors) const CONNECTIONS: usize = 256;

/// Of all clients, those whom one key may bring, every screen of a large site; and as many are kept from those who only look, for
/// operators who are not there yet.
const SHARE: usize = CONNECTIONS / 4;

/// What may wait for the clients of all connections together, in bytes, because they do not read it,
const UNREAD: usize = 12 * 1024 * 1024;

/// and for those of viewers, so that there is room for operators' still.
const VIEWERS_UNREAD: usize = UNREAD / 2;

/// A client for which no more than this waits gives way to nobody.
const LITTLE_UNREAD: usize = 48 * 1024;

/// What waits for a client is noted in steps of so many bytes.
const STEP: usize = 16 * 1024;

#[derive(Clone, Debug)]
pub(in crate::doors) struct Holder {
    /// The name of the key.
    pub(in crate::doors) who: Arc<str>,
    pub(in crate::doors) is_viewer: bool,
    /// Whether he has shown a key, and so has a share; where nobody shows one, all are one.
    pub(in crate::doors) has_share: bool,
}

/// All seats. Cheap to clone.
#[derive(Clone, Debug)]
pub(in crate::doors) struct Seats(Arc<Mutex<Seating>>);

#[derive(Debug)]
struct Seating {
    /// How many there are, of which one key has a share, and some are kept from viewers.
    most: usize,
    share: usize,
    given: u64,
    clients: HashMap<u64, SeatedClient>,
}

#[derive(Debug)]
struct SeatedClient {
    holder: Holder,
    progress_ms: Arc<AtomicU64>,
    give_way: Arc<Notify>,
    unread: Unread,
    /// When its client last took much, or all there was, of what waits for it.
    read_ms: u64,
}

/// What waits for a client, in bytes.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::doors) struct Unread {
    /// What nobody else has,
    pub(in crate::doors) here: usize,
    /// and what others may have as well.
    pub(in crate::doors) shared: usize,
}

/// A seat; free again when it is dropped.
#[derive(Debug)]
pub(in crate::doors) struct Seat {
    seats: Seats,
    number: u64,
    progress_ms: Arc<AtomicU64>,
    give_way: Arc<Notify>,
    /// What was noted of it last.
    unread: AtomicUsize,
}

impl Unread {
    const fn all(self) -> usize {
        self.here + self.shared
    }
}

impl Seats {
    /// As many as there is room for, all free.
    pub(in crate::doors) fn new(budget: ConnectionBudget) -> Seats {
        let [most, share] = [CONNECTIONS, SHARE].map(|all| budget.scaled(all));
        Seats(Arc::new(Mutex::new(Seating { most, share, given: 0, clients: HashMap::new() })))
    }

    /// A seat for whoever comes in `now`; somebody may have to give way for it.
    pub(in crate::doors) fn take(&self, holder: Holder, now: Duration) -> Seat {
        let (progress_ms, give_way) = (Arc::new(AtomicU64::new(ms(now))), Arc::default());
        let mut seating = self.seating();
        if let Some(client) = seating.least_needed(&holder).and_then(|number| seating.clients.remove(&number)) {
            client.give_way.notify_one();
        }
        seating.given += 1;
        let number = seating.given;
        let (unread, read_ms) = (Unread::default(), ms(now));
        let client =
            SeatedClient { holder, progress_ms: Arc::clone(&progress_ms), give_way: Arc::clone(&give_way), unread, read_ms };
        seating.clients.insert(number, client);
        drop(seating);
        Seat { seats: self.clone(), number, progress_ms, give_way, unread: AtomicUsize::new(0) }
    }

    fn seating(&self) -> MutexGuard<'_, Seating> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Seating {
    /// The seat that is given up for a newcomer; `None` while there is one for him.
    fn least_needed(&self, newcomer: &Holder) -> Option<u64> {
        let own = self.count(|holder| holder.who == newcomer.who);
        if newcomer.has_share && own >= self.share {
            return self.stillest(|holder| holder.who == newcomer.who);
        }
        let is_among: fn(&Holder) -> bool =
            if newcomer.is_viewer && self.count(|holder| holder.is_viewer) >= self.most - self.share {
                |holder| holder.is_viewer
            } else if self.clients.len() >= self.most {
                |_| true
            } else {
                return None;
            };
        let mut counts: HashMap<&str, usize> = HashMap::new();
        for client in self.clients.values().filter(|client| is_among(&client.holder)) {
            *counts.entry(&client.holder.who).or_default() += 1;
        }
        let (greediest, most) = counts.into_iter().max_by_key(|(_, count)| *count)?;
        let gives = if own >= most { &*newcomer.who } else { greediest };
        self.stillest(|holder| &*holder.who == gives)
    }

    /// Whose client is to go when too much waits, `replaced` bytes of it for several: of whoever has most waiting the one that has
    /// read nothing for longest. Nobody for whom but little waits.
    fn least_read(&self, replaced: usize) -> Option<u64> {
        let unread = |is_among: fn(&Holder) -> bool| {
            self.clients.values().filter(|client| is_among(&client.holder)).map(|client| client.unread.here).sum::<usize>()
        };
        if unread(|_| true) + replaced <= UNREAD {
            return None;
        }
        let viewers = (unread(|holder| holder.is_viewer) > VIEWERS_UNREAD).then(|| self.stalest(|holder| holder.is_viewer));
        viewers.flatten().or_else(|| self.stalest(|_| true))
    }

    /// Of whichever of these has most waiting, the one that has read nothing for longest, of those for whom it is more than a little.
    fn stalest(&self, is_among: fn(&Holder) -> bool) -> Option<u64> {
        let among = || {
            let all = self.clients.iter().filter(|(_, client)| is_among(&client.holder));
            all.filter(|(_, client)| client.unread.all() > LITTLE_UNREAD)
        };
        let mut waits: HashMap<&str, usize> = HashMap::new();
        for (_, client) in among() {
            *waits.entry(&client.holder.who).or_default() += client.unread.all();
        }
        let (greediest, _) = waits.into_iter().max_by_key(|(_, waits)| *waits)?;
        let of_greediest = among().filter(|(_, client)| &*client.holder.who == greediest);
        of_greediest.min_by_key(|(number, client)| (client.read_ms, **number)).map(|(number, _)| *number)
    }

    fn count(&self, is_among: impl Fn(&Holder) -> bool) -> usize {
        self.clients.values().filter(|client| is_among(&client.holder)).count()
    }

    /// The seat of these in which nothing has happened for longest.
    fn stillest(&self, is_among: impl Fn(&Holder) -> bool) -> Option<u64> {
        let among = self.clients.iter().filter(|(_, client)| is_among(&client.holder));
        among.min_by_key(|(number, client)| (client.progress_ms.load(Ordering::Relaxed), **number)).map(|(number, _)| *number)
    }
}

impl Seat {
    pub(in crate::doors) fn moves(&self, now: Duration) {
        self.progress_ms.store(ms(now), Ordering::Relaxed);
    }

    /// So much waits for its client now, which has last taken much of it, or all, then. `replaced` says how much waits for clients
    /// beside what they have alone. When that is too much for all together, somebody has to give way.
    pub(in crate::doors) fn note_unread(&self, unread: Unread, read_at: Duration, replaced: impl FnOnce() -> usize) {
        let (before, noted) = (self.unread.load(Ordering::Relaxed), unread.all() / STEP);
        if noted == before {
            return;
        }
        self.unread.store(noted, Ordering::Relaxed);
        let mut replaced = if noted > before { replaced() } else { 0 };
        let mut seating = self.seats.seating();
        let Some(client) = seating.clients.get_mut(&self.number) else { return };
        (client.unread, client.read_ms) = (unread, ms(read_at));
        while noted > before
            && let Some(client) = seating.least_read(replaced).and_then(|number| seating.clients.remove(&number))
        {
            replaced = replaced.saturating_sub(client.unread.shared);
            client.give_way.notify_one();
        }
    }

    /// It is free again, though its client is still taking its leave.
    pub(in crate::doors) fn give_back(&self) {
        self.seats.seating().clients.remove(&self.number);
    }

    pub(in crate::doors) async fn given_up(&self) {
        self.give_way.notified().await;
    }
}

impl Drop for Seat {
    fn drop(&mut self) {
        self.give_back();
    }
}

fn ms(duration: Duration) -> u64 {
    u64::try_from(duration.as_millis()).unwrap_or(u64::MAX)
}

#[cfg(test)]
mod tests {
    use futures_util::FutureExt;

    use super::*;

    fn viewer(who: &str) -> Holder {
        Holder { who: Arc::from(who), is_viewer: true, has_share: true }
    }

    fn operator(who: &str) -> Holder {
        Holder { is_viewer: false, ..viewer(who) }
    }

    fn here() -> Holder {
        Holder { has_share: false, ..operator("operator") }
    }

    /// So many seats, taken one millisecond after the other.
    fn crowd(seats: &Seats, holder: &Holder, count: usize) -> Vec<Seat> {
        (0..count).map(|n| seats.take(holder.clone(), Duration::from_millis(n as u64))).collect()
    }

    /// How many of these are somebody else's now.
    fn lost(crowd: &[Seat]) -> usize {
        let lost = crowd.iter().filter(|seat| seat.given_up().now_or_never().is_some());
        lost.inspect(|seat| seat.give_way.notify_one()).count()
    }

    const NOW: Duration = Duration::from_secs(100);

    /// Safety S9.
    #[test]
    fn whoever_has_his_share_gives_up_one_of_his_own() {
        for holder in [viewer("screen"), operator("panel")] {
            let seats = Seats::new(ConnectionBudget::default());
            let others = crowd(&seats, &operator("others"), SHARE);
            let own = crowd(&seats, &holder, SHARE);
            own[0].moves(NOW);
            let _newcomer = seats.take(holder, NOW);
            assert_eq!((lost(&own), lost(&own[1..2]), lost(&others)), (1, 1, 0));
        }
    }

    /// Safety S9.
    #[test]
    fn viewers_together_leave_seats_to_operators_and_to_each_other() {
        let seats = Seats::new(ConnectionBudget::default());
        // A fourth of all is kept.
        let viewers = CONNECTIONS - CONNECTIONS / 4;
        let keys = viewers / SHARE + 2;
        let crowds: Vec<_> = (0..keys).map(|key| crowd(&seats, &viewer(&key.to_string()), SHARE)).collect();
        assert_eq!(seats.seating().clients.len(), viewers);
        let operators = crowd(&seats, &operator("operator"), CONNECTIONS - viewers);
        let mut before = 0;
        for crowd in &crowds {
            before += lost(crowd);
        }
        assert_eq!(before, keys * SHARE - viewers, "no operator has driven one away");
        let late = seats.take(viewer("late"), NOW);
        assert_eq!((lost(&[late]), lost(&operators)), (0, 0));
    }

    /// Safety S9.
    #[test]
    fn when_all_seats_are_taken_whoever_has_most_gives_way_to_any_newcomer() {
        let seats = Seats::new(ConnectionBudget::default());
        let mut crowds: Vec<_> = (0..3).map(|key| crowd(&seats, &operator(&key.to_string()), SHARE - 1)).collect();
        crowds.push(crowd(&seats, &operator("most"), SHARE));
        let few = crowd(&seats, &viewer("few"), 3);
        assert_eq!(seats.seating().clients.len(), CONNECTIONS);
        let one = seats.take(viewer("few"), NOW);
        assert_eq!((lost(&crowds[3]), lost(&few)), (1, 0));
        let newcomers = [one, seats.take(operator("new"), NOW)];
        let lost = lost(&newcomers) + lost(&few);
        assert_eq!(lost, 0, "it was one of those who have as many as he who had most");
        assert_eq!(seats.seating().clients.len(), CONNECTIONS);
    }

    /// Safety S9: where nobody signs in.
    #[test]
    fn without_keys_nobody_has_a_share_and_the_stillest_gives_way() {
        let seats = Seats::new(ConnectionBudget::default());
        let all = crowd(&seats, &here(), CONNECTIONS);
        assert_eq!(lost(&all), 0);
        for seat in &all[..CONNECTIONS - 1] {
            seat.moves(NOW);
        }
        let _newcomer = seats.take(here(), NOW);
        assert_eq!((lost(&all), lost(&all[CONNECTIONS - 1..])), (1, 1));
    }

    /// For so many of these so many bytes wait, of which they read some one millisecond after the other.
    fn pile_up(crowd: &[Seat], here: usize) {
        for (n, seat) in (0..).zip(crowd) {
            seat.note_unread(Unread { here, ..Unread::default() }, Duration::from_millis(n), || 0);
        }
    }

    fn unread_here(seats: &Seats) -> usize {
        seats.seating().clients.values().map(|client| client.unread.here).sum()
    }

    const MUCH: usize = 8 * LITTLE_UNREAD;

    /// Safety A5, S9.
    #[test]
    fn when_too_much_is_unread_whoever_has_read_nothing_for_longest_gives_way() {
        let seats = Seats::new(ConnectionBudget::default());
        let all = crowd(&seats, &here(), CONNECTIONS);
        pile_up(&all[..1], LITTLE_UNREAD);
        pile_up(&all[1..UNREAD / MUCH], MUCH);
        assert_eq!(lost(&all), 0);
        pile_up(&all[UNREAD / MUCH..], MUCH);
        assert_eq!(lost(&all[..1]), 0, "little waits for it");
        let left = seats.seating().clients.len() - 1;
        assert_eq!(lost(&all[..CONNECTIONS - left]), CONNECTIONS - left - 1, "those who read last are there still");
        let unread = unread_here(&seats);
        assert!(unread <= UNREAD && unread > UNREAD - 2 * MUCH, "{unread}");
    }

    /// Safety A5, S9.
    #[test]
    fn what_viewers_do_not_read_harms_no_operator() {
        let seats = Seats::new(ConnectionBudget::default());
        let screens = crowd(&seats, &operator("screens"), SHARE);
        pile_up(&screens, LITTLE_UNREAD);
        let viewers = ["one", "two", "three"].map(|key| crowd(&seats, &viewer(key), SHARE));
        viewers.iter().for_each(|viewers| pile_up(viewers, MUCH / 2));
        pile_up(&screens[..4], MUCH);
        assert_eq!(lost(&screens), 0);
        assert!(unread_here(&seats) <= UNREAD);
    }

    /// Safety A5: what was replaced while it was on its way counts, and what all have in common does not.
    #[test]
    fn what_several_wait_for_counts_when_it_is_kept_no_more() {
        let seats = Seats::new(ConnectionBudget::default());
        let all = crowd(&seats, &here(), SHARE);
        let shared = Unread { shared: MUCH, ..Unread::default() };
        all.iter().for_each(|seat| seat.note_unread(shared, NOW, || 0));
        assert_eq!(lost(&all), 0);
        all[5].note_unread(Unread { here: MUCH, ..shared }, NOW + NOW, || UNREAD);
        assert_eq!((lost(&all[..1]), lost(&all)), (1, 1), "one is enough");
    }

    #[test]
    fn a_seat_that_is_left_is_free() {
        let seats = Seats::new(ConnectionBudget::default());
        for _ in 0..3 {
            assert_eq!(lost(&crowd(&seats, &here(), CONNECTIONS)), 0);
        }
        assert!(seats.seating().clients.is_empty());
    }
}
