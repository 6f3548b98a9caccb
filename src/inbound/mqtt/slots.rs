//! By which name the engine knows a client. The engine forgets no name it has ever heard, and takes some amiss, so it only ever
//! hears those of a few slots, which are given out again. A client's own name counts here: whoever comes with one that is present
//! takes the other's place, and whoever wants to be remembered gets the slot he had.

use std::collections::{BTreeSet, HashMap};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::watch;

use super::gate::turnstile::Session;

/// Clients that are remembered while they are away. Whoever comes when all are taken is not.
const REMEMBERED: usize = 128;

/// So long a newcomer of the same name waits for the other to leave.
const LEAVE_TIME: Duration = Duration::from_secs(2);

/// Whose client it is, and what it calls itself: nobody takes the place of somebody else's client.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Name {
    /// The name of whoever is signed in.
    pub(super) who: Arc<str>,
    /// The client's own name; empty: it has none.
    pub(super) client: String,
}

/// All slots. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub(super) struct Slots(Arc<Mutex<Table>>);

/// A client's place at the engine; free again when it is dropped.
#[derive(Debug)]
pub(super) struct Slot {
    slots: Slots,
    name: Name,
    number: usize,
    /// Whether the engine is to remember the client.
    pub(super) is_kept: bool,
    /// What is remembered of it; `None`: nothing is.
    pub(super) session: Option<Session>,
    leave: watch::Receiver<bool>,
    _gone: watch::Sender<()>,
}

#[derive(Debug, Default)]
struct Table {
    taken: BTreeSet<usize>,
    present: HashMap<Name, Present>,
    remembered: HashMap<Name, Remembered>,
}

#[derive(Debug)]
struct Present {
    number: usize,
    leave: watch::Sender<bool>,
    gone: watch::Receiver<()>,
}

#[derive(Debug, Default)]
struct Remembered {
    number: usize,
    session: Session,
}

impl Slots {
    /// A slot for a client that comes in; one of the same name is sent away first. `wants_memory`: what happens while it is away is
    /// to be kept for it.
    pub(super) async fn take(&self, name: Name, wants_memory: bool) -> Slot {
        if !name.client.is_empty() {
            while let Some(mut gone) = self.send_away(&name) {
                // It ends when the other's end of the channel is dropped with its slot; one that hangs is left to itself.
                if tokio::time::timeout(LEAVE_TIME, gone.changed()).await.is_err() {
                    self.table().present.remove(&name);
                }
            }
        }
        self.enter(name, wants_memory)
    }

    /// Asks the client of this name to leave; what ends when it has. `None` when nobody has this name.
    fn send_away(&self, name: &Name) -> Option<watch::Receiver<()>> {
        let table = self.table();
        let present = table.present.get(name)?;
        present.leave.send_replace(true);
        Some(present.gone.clone())
    }

    fn enter(&self, name: Name, wants_memory: bool) -> Slot {
        let mut table = self.table();
        let had = table.remembered.remove(&name);
        let is_kept = wants_memory && !name.client.is_empty() && (had.is_some() || table.remembered.len() < REMEMBERED);
        let number = had.as_ref().map_or_else(|| table.free(), |had| had.number);
        let session = had.filter(|_| is_kept).map(|had| had.session);
        if is_kept {
            table.remembered.insert(name.clone(), Remembered { number, session: Session::default() });
        }
        table.taken.insert(number);
        let (gone, gone_too) = watch::channel(());
        let (leave, asked) = watch::channel(false);
        if !name.client.is_empty() {
            table.present.insert(name.clone(), Present { number, leave, gone: gone_too });
        }
        drop(table);
        Slot { slots: self.clone(), name, number, is_kept, session, leave: asked, _gone: gone }
    }

    fn table(&self) -> MutexGuard<'_, Table> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Table {
    /// The least number that nobody has.
    fn free(&self) -> usize {
        (0..).zip(&self.taken).find(|(number, taken)| number != *taken).map_or(self.taken.len(), |(number, _)| number)
    }
}

impl Slot {
    /// The name for the engine.
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
        if let Some(remembered) = self.slots.table().remembered.get_mut(&self.name).filter(|_| self.is_kept) {
            remembered.session = session;
        }
    }
}

impl Drop for Slot {
    fn drop(&mut self) {
        let mut table = self.slots.table();
        let is_here = table.present.get(&self.name).is_some_and(|present| present.number == self.number);
        if is_here {
            table.present.remove(&self.name);
        }
        let is_remembered = table.remembered.get(&self.name).is_some_and(|remembered| remembered.number == self.number);
        if !is_remembered {
            table.taken.remove(&self.number);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::inbound::mqtt::gate::packet::Qos;

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
        assert_eq!(slots.table().present.len(), 1, "the newer one is there still");
        drop(newer);
        assert!(slots.table().present.is_empty() && slots.table().taken.is_empty());
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
        let session = Session { filters: [(Arc::from("a/#"), Qos::One)].into(), ..Session::default() };
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
            "the engine is told to forget by the same name"
        );
        drop(forgotten);
        assert_eq!(slots.take(name("next"), false).await.id(), id);
    }

    /// Safety A5.
    #[tokio::test]
    async fn only_so_many_are_remembered() {
        let slots = Slots::default();
        for number in 0..=REMEMBERED {
            let slot = slots.take(name(&number.to_string()), true).await;
            assert_eq!(slot.is_kept, number < REMEMBERED);
        }
        assert_eq!(slots.table().taken.len(), REMEMBERED);
    }
}
