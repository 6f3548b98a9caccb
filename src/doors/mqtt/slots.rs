//! By which name the router knows a client. The router forgets no name it has ever heard, and takes some amiss, so it only ever
//! hears those of a few slots, which are given out again. A client's own name counts here: whoever comes with one that is present
//! takes the other's place, and whoever wants to be remembered gets the slot he had.

use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::watch;

use mqtt_gate::Session;

/// Clients that are remembered while they are away; of more the one who has been away for longest is forgotten.
const REMEMBERED: usize = 128;

/// So long a newcomer of the same name waits for the other to leave.
const LEAVE_TIME: Duration = Duration::from_secs(2);

/// Whose client it is, and what it calls itself: nobody takes the place of somebody else's client.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Name {
    pub(super) who: Arc<str>,
    /// The client's own name; empty: it has none.
    pub(super) client: String,
}

/// All slots. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub(super) struct Slots(Arc<Mutex<Registry>>);

/// A client's place at the router; free again when it is dropped.
#[derive(Debug)]
pub(super) struct Slot {
    slots: Slots,
    name: Name,
    moment: u64,
    number: usize,
    /// Whether the router is to remember the client.
    pub(super) is_kept: bool,
    /// What is remembered of it; `None`: nothing is.
    pub(super) session: Option<Session>,
    leave: watch::Receiver<bool>,
    _gone: watch::Sender<()>,
}

#[derive(Debug, Default)]
struct Registry {
    /// Counts whoever has come, so that one is not taken for another of the same name.
    moments: u64,
    taken: BTreeSet<usize>,
    present: HashMap<Name, Present>,
    remembered: HashMap<Name, Remembered>,
}

#[derive(Debug)]
struct Present {
    moment: u64,
    leave: watch::Sender<bool>,
    gone: watch::Receiver<()>,
}

#[derive(Debug)]
struct Remembered {
    moment: u64,
    number: usize,
    session: Option<Session>,
}

impl Slots {
    /// A slot for a client; one of the same name is sent away first. `wants_memory`: what happens while it is away is kept.
    pub(super) async fn take(&self, name: Name, wants_memory: bool) -> Slot {
        let came = self.registry().next_moment();
        loop {
            let (moment, mut gone) = match self.enter(&name, wants_memory, came) {
                Ok(slot) => return slot,
                Err(present) => present,
            };
            // It ends when the other's end of the channel is dropped with its slot; one that hangs is left to itself, with all of it.
            if tokio::time::timeout(LEAVE_TIME, gone.changed()).await.is_err() {
                self.registry().give_up(&name, moment);
            }
        }
    }

    /// A slot, when nobody of this name is here; else he is asked to leave, and it is said when he came and what ends when he has gone.
    fn enter(&self, name: &Name, wants_memory: bool, came: u64) -> Result<Slot, (u64, watch::Receiver<()>)> {
        let mut registry = self.registry();
        let is_overtaken = registry.present.get(name).is_some_and(|present| present.moment > came);
        if let Some(present) = registry.present.get(name).filter(|_| !is_overtaken) {
            present.leave.send_replace(true);
            return Err((present.moment, present.gone.clone()));
        }
        let moment = came;
        // Whoever came later has the name. What this one has said before it left is to go its way all the same.
        let is_named = !name.client.is_empty() && !is_overtaken;
        let had = if is_named { registry.remembered.remove(name) } else { None };
        let is_kept = wants_memory && is_named && (had.is_some() || registry.has_memory());
        let number = had.as_ref().map_or_else(|| registry.free(), |had| had.number);
        let session = had.filter(|_| is_kept).and_then(|had| had.session);
        if is_kept {
            registry.remembered.insert(name.clone(), Remembered { moment, number, session: None });
        }
        registry.taken.insert(number);
        let (gone, gone_too) = watch::channel(());
        let (leave, asked) = watch::channel(is_overtaken);
        if is_named {
            registry.present.insert(name.clone(), Present { moment, leave, gone: gone_too });
        }
        drop(registry);
        Ok(Slot { slots: self.clone(), name: name.clone(), moment, number, is_kept, session, leave: asked, _gone: gone })
    }

    fn registry(&self) -> MutexGuard<'_, Registry> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Registry {
    fn next_moment(&mut self) -> u64 {
        self.moments += 1;
        self.moments
    }

    /// Whoever came then does not leave: he is not waited for, and what he has stays his until he does.
    fn give_up(&mut self, name: &Name, moment: u64) {
        self.present.retain(|known, present| known != name || present.moment != moment);
        self.remembered.retain(|known, remembered| known != name || remembered.moment != moment);
    }

    /// Whether one more can be remembered; of those who are away the one who has been for longest gives way.
    fn has_memory(&mut self) -> bool {
        if self.remembered.len() < REMEMBERED {
            return true;
        }
        let away = self.remembered.iter().filter(|(name, _)| !self.present.contains_key(*name));
        let oldest = away.min_by_key(|(_, remembered)| remembered.moment).map(|(name, _)| name.clone());
        let forgotten = oldest.and_then(|name| self.remembered.remove(&name));
        forgotten.is_some_and(|forgotten| self.taken.remove(&forgotten.number))
    }

    /// The least number that nobody has.
    fn free(&self) -> usize {
        (0..).zip(&self.taken).find(|(number, taken)| number != *taken).map_or(self.taken.len(), |(number, _)| number)
    }
}

impl Slot {
    /// The name for the router.
    pub(super) fn id(&self) -> String {
        format!("slot{}", self.number)
    }

    /// Waits until somebody of the same name wants the place.
    pub(super) async fn wanted(&mut self) {
        if self.leave.wait_for(|leave| *leave).await.is_err() {
            std::future::pending::<()>().await;
        }
    }

    /// Keeps what is to be remembered of the client, for when it comes back.
    pub(super) fn remember(&self, session: Session) {
        let mut registry = self.slots.registry();
        if let Some(remembered) = registry.remembered.get_mut(&self.name).filter(|remembered| remembered.moment == self.moment) {
            remembered.session = Some(session);
        }
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        let mut registry = self.slots.registry();
        registry.present.retain(|_, present| present.moment != self.moment);
        if !registry.remembered.values().any(|remembered| remembered.moment == self.moment) {
            registry.taken.remove(&self.number);
        }
    }
}

#[cfg(test)]
mod tests {
    use futures_util::FutureExt;

    use super::*;
    use mqtt_gate::packet::Qos;

    fn name(client: &str) -> Name {
        Name { who: Arc::from("operator"), client: client.to_owned() }
    }

    #[tokio::test]
    async fn slots_are_given_out_again() {
        let slots = Slots::default();
        let (one, two) = (slots.take(name(""), false).await, slots.take(name("two"), false).await);
        assert_eq!([one.id(), two.id()], ["slot0", "slot1"]);
        drop(one);
        assert_eq!(slots.take(name("three"), false).await.id(), "slot0");
    }

    #[tokio::test(start_paused = true)]
    async fn whoever_comes_with_a_name_that_is_present_takes_its_place_when_it_has_left() {
        let slots = Slots::default();
        let mut old = slots.take(name("panel"), false).await;
        let leaving = tokio::spawn(async move { old.wanted().await });
        slots.take(name("panel"), false).await;
        assert!(leaving.await.is_ok());
        let hangs = slots.take(name("panel"), false).await;
        let newer = slots.take(name("panel"), false).await;
        drop(hangs);
        assert_eq!(slots.registry().present.len(), 1, "the newer one is there still");
        drop(newer);
        assert!(slots.registry().present.is_empty() && slots.registry().taken.is_empty());
    }

    /// One that has left already, and waits for its place still to pass on what it said, sends no newer one away.
    #[tokio::test(start_paused = true)]
    async fn whoever_came_before_takes_the_place_of_nobody_who_came_later() {
        let slots = Slots::default();
        let mut first = slots.take(name("panel"), true).await;
        let mut older = Box::pin(slots.take(name("panel"), true));
        assert!(older.as_mut().now_or_never().is_none());
        first.wanted().await;
        drop(first);
        let mut newer = slots.take(name("panel"), true).await;
        let mut older = older.await;
        older.wanted().await;
        assert!(!older.is_kept && older.id() != newer.id());
        let is_wanted = tokio::time::timeout(Duration::from_secs(9), newer.wanted()).await;
        assert!(is_wanted.is_err(), "nobody wants its place");
        drop(older);
        assert_eq!(slots.registry().present.len(), 1);
    }

    #[tokio::test]
    async fn nobody_takes_the_place_of_somebody_elses_client() {
        let slots = Slots::default();
        let _theirs = slots.take(name("panel"), false).await;
        let other = Name { who: Arc::from("viewer"), client: "panel".to_owned() };
        assert_eq!(slots.take(other, false).await.id(), "slot1", "nobody was waited for");
    }

    #[tokio::test]
    async fn who_wants_to_be_remembered_gets_the_slot_and_the_session_he_had() {
        let slots = Slots::default();
        let slot = slots.take(name("panel"), true).await;
        assert_eq!(slot.session, None, "he was never here");
        let session = Session::holding([(Arc::from("a/#"), Qos::One)]);
        slot.remember(session.clone());
        let id = slot.id();
        drop(slot);
        let between = slots.take(name("other"), false).await;
        assert_ne!(between.id(), id, "the slot is kept");
        let back = slots.take(name("panel"), true).await;
        assert_eq!((back.id(), back.session.clone()), (id.clone(), Some(session)));
        drop(back);
        let forgotten = slots.take(name("panel"), false).await;
        assert_eq!(
            (forgotten.id(), forgotten.session.clone()),
            (id.clone(), None),
            "the router is told to forget by the same name"
        );
        drop(forgotten);
        assert_eq!(slots.take(name("next"), false).await.id(), id);
    }

    /// Safety A5.
    #[tokio::test]
    async fn only_so_many_are_remembered_and_whoever_has_been_away_for_longest_is_forgotten() {
        let slots = Slots::default();
        for number in 0..=REMEMBERED {
            let slot = slots.take(name(&number.to_string()), true).await;
            assert!(slot.is_kept);
            slot.remember(Session::default());
        }
        assert_eq!(slots.registry().taken.len(), REMEMBERED);
        assert!(slots.take(name("1"), true).await.session.is_some());
        assert!(slots.take(name("0"), true).await.session.is_none(), "he was the first to go");
        let here: Vec<_> =
            futures_util::future::join_all((0..REMEMBERED).map(|n| slots.take(name(&format!("here {n}")), true))).await;
        assert!(here.iter().all(|slot| slot.is_kept));
        assert!(!slots.take(name("one more"), true).await.is_kept, "nobody is away");
    }

    #[tokio::test(start_paused = true)]
    async fn of_two_who_come_at_once_one_is_sent_away_and_none_of_them_shares_a_slot() {
        let slots = Slots::default();
        let (mut one, mut other) = (slots.take(name("panel"), true).await, None);
        tokio::select! {
            () = one.wanted() => drop(one),
            slot = slots.take(name("panel"), true) => other = Some(slot),
        }
        assert!(other.is_none(), "the second waited until the first was asked to leave");
        let hangs = slots.take(name("panel"), true).await;
        let newer = slots.take(name("panel"), true).await;
        assert_ne!(hangs.id(), newer.id(), "one that hangs keeps what it has");
        drop(hangs);
        assert!(slots.registry().present.contains_key(&name("panel")));
    }
}
