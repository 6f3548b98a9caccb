//! Client ids. When two clients use the same id, the older one is disconnected. A client can ask to be remembered for
//! some time after it has left; this is done if there is room. The gate decides what is remembered about a client.

use std::cmp::Reverse;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use tokio::sync::{Notify, watch};

use crate::runtime::clock::Clock;
use mqtt_gate::Session;

/// Maximum number of clients that are remembered now or have a reserved place for later. When the maximum is reached,
/// an absent client is forgotten: of the owner with the most remembered clients, the client that connected first.
const REMEMBERED: usize = 128;

/// Maximum time that a new client waits until an older client with the same name has left.
const LEAVE_TIME: Duration = Duration::from_secs(2);

/// Owner and id of a client. The owner is part of the name, so that a client cannot replace a client of another
/// owner.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(super) struct Name {
    pub(super) who: Arc<str>,
    /// The id that the client sent; empty if it sent none.
    pub(super) client: String,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Memory {
    /// Whether the client wants to continue its remembered session: its CONNECT does not ask for a clean start.
    pub(super) resumes: bool,
    /// Whether the client asks to be remembered after it has left: its CONNECT has a session expiry above 0 s.
    pub(super) wants: bool,
}

#[derive(Clone, Debug, Default)]
pub(super) struct ClientIds(Arc<Ids>);

#[derive(Debug, Default)]
struct Ids {
    registry: Mutex<Registry>,
    /// Wakes `keep` when a session was remembered, because that session may be the next to expire.
    has_gone: Notify,
    clock: Clock,
}

/// The id of a connected client. The id is free again when this value is dropped.
#[derive(Debug)]
pub(super) struct ClientId {
    ids: ClientIds,
    name: Name,
    moment: u64,
    leave: watch::Receiver<bool>,
    /// Whether the client asked to be remembered and got one of the `REMEMBERED` places.
    is_remembered: bool,
    _gone: watch::Sender<()>,
}

#[derive(Debug, Default)]
struct Registry {
    /// Number of arrivals so far. The number of an arrival tells clients with the same name apart.
    moments: u64,
    present: HashMap<Name, Present>,
    remembered: HashMap<Name, RememberedSession>,
}

#[derive(Debug)]
struct Present {
    moment: u64,
    resumes: bool,
    leave: watch::Sender<bool>,
    gone: watch::Receiver<()>,
}

#[derive(Debug)]
struct RememberedSession {
    moment: u64,
    session: Option<Session>,
}

impl ClientIds {
    /// Takes the id for a client; returns the id and the client's remembered session. An older client with the same
    /// name is disconnected first.
    pub(super) async fn take(&self, name: Name, memory: Memory) -> (ClientId, Option<Session>) {
        let came = {
            let mut registry = self.registry();
            registry.moments += 1;
            registry.moments
        };
        loop {
            let (moment, mut gone) = match self.enter(&name, memory, came) {
                Ok(taken) => return taken,
                Err(present) => present,
            };
            // The wait ends when the older client drops its id, which closes this channel. If the older client hangs,
            // the wait ends after `LEAVE_TIME`. The hanging client keeps its resources until it leaves.
            if tokio::time::timeout(LEAVE_TIME, gone.changed()).await.is_err() {
                let mut registry = self.registry();
                registry.present.retain(|known, present| *known != name || present.moment != moment);
                registry.remembered.retain(|known, remembered| *known != name || remembered.moment != moment);
            }
        }
    }

    /// Takes the id if no earlier client with this name is connected. Otherwise asks the earlier client to leave, and
    /// returns an error. The error has that client's arrival number, and a channel that closes when that client has
    /// left.
    fn enter(&self, name: &Name, memory: Memory, came: u64) -> Result<(ClientId, Option<Session>), (u64, watch::Receiver<()>)> {
        let mut registry = self.registry();
        let is_overtaken = registry.present.get(name).is_some_and(|present| present.moment > came);
        if let Some(present) = registry.present.get(name).filter(|_| !is_overtaken) {
            present.leave.send_replace(true);
            return Err((present.moment, present.gone.clone()));
        }
        let moment = came;
        // If `is_overtaken`, a later client has the name already. This client still gets a `ClientId`, which is not
        // registered, because the messages that it sent before leaving are still processed.
        let is_named = !name.client.is_empty() && !is_overtaken;
        let mut had = if is_named { registry.remembered.remove(name) } else { None };
        let session = had.as_mut().filter(|_| memory.resumes).and_then(|had| had.session.take());
        let mut gives_way = None;
        let is_remembered = memory.wants && is_named && registry.has_memory(&mut gives_way);
        if is_remembered {
            registry.remembered.insert(name.clone(), RememberedSession { moment, session: None });
        }
        let (gone, gone_too) = watch::channel(());
        let (leave, asked) = watch::channel(is_overtaken);
        if is_named {
            registry.present.insert(name.clone(), Present { moment, resumes: memory.resumes, leave, gone: gone_too });
        }
        drop(registry);
        self.end(had.into_iter().chain(gives_way));
        Ok((ClientId { ids: self.clone(), name: name.clone(), moment, leave: asked, is_remembered, _gone: gone }, session))
    }

    /// Forgets clients whose remembered time is over, and publishes their last wills. Never returns.
    pub(super) async fn keep(&self) {
        let clock = self.0.clock;
        loop {
            let of_remembered = |remembered: &RememberedSession| remembered.session.as_ref().and_then(Session::poll_timeout);
            let due = self.registry().remembered.values().filter_map(of_remembered).min();
            tokio::select! {
                () = clock.reach(due) => {}
                () = self.0.has_gone.notified() => {}
            }
            self.handle_timeout(clock.since_start());
        }
    }

    fn handle_timeout(&self, now: Duration) {
        let mut wills = Vec::new();
        let mut is_over = |remembered: &mut RememberedSession| {
            let Some(session) = &mut remembered.session else { return false };
            let (is_over, will) = session.handle_timeout(now);
            wills.extend(will);
            is_over
        };
        let over: Vec<_> = self.registry().remembered.extract_if(|_, remembered| is_over(remembered)).collect();
        // Publishes the wills after releasing the registry's lock, because newcomers need that lock.
        wills.into_iter().for_each(|will| will.publish(now));
        self.end(over.into_iter().map(|(_, remembered)| remembered));
    }

    fn end(&self, forgotten: impl IntoIterator<Item = RememberedSession>) {
        let now = self.0.clock.since_start();
        forgotten.into_iter().filter_map(|remembered| remembered.session).for_each(|session| session.end(now));
    }

    fn registry(&self) -> MutexGuard<'_, Registry> {
        self.0.registry.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Registry {
    /// Whether one more client can be remembered. If another client must be forgotten for that, its session is put
    /// into `gives_way`.
    fn has_memory(&mut self, gives_way: &mut Option<RememberedSession>) -> bool {
        if self.remembered.len() < REMEMBERED {
            return true;
        }
        let mut counts: HashMap<&str, usize> = HashMap::new();
        self.remembered.keys().for_each(|name| *counts.entry(&name.who).or_default() += 1);
        let away = self.remembered.iter().filter(|(name, _)| !self.present.contains_key(*name));
        let oldest =
            away.min_by_key(|(name, remembered)| (Reverse(counts[&*name.who]), remembered.moment)).map(|(name, _)| name.clone());
        *gives_way = oldest.and_then(|name| self.remembered.remove(&name));
        gives_way.is_some()
    }
}

impl ClientId {
    /// Waits until another client with the same name arrives.
    pub(super) async fn wanted(&mut self) {
        if self.leave.wait_for(|leave| *leave).await.is_err() {
            std::future::pending::<()>().await;
        }
    }

    /// Remembers the client's session until the client returns. Pass `None` if the client does not want to be
    /// remembered.
    pub(super) fn remember(&self, session: Option<Session>) {
        let mut registry = self.ids.registry();
        let is_ours = |remembered: &RememberedSession| remembered.moment == self.moment;
        let forgotten = match registry.remembered.get_mut(&self.name).filter(|remembered| is_ours(remembered)) {
            Some(remembered) if session.is_some() => std::mem::replace(&mut remembered.session, session),
            Some(_) => registry.remembered.remove(&self.name).and_then(|remembered| remembered.session),
            // The registry has no entry for this session. If a later client with the same name resumes, this
            // session's will is not published.
            None => {
                let later = registry.present.get(&self.name).filter(|present| present.moment > self.moment);
                session.map(|mut session| {
                    if later.is_some_and(|later| later.resumes) {
                        session.withdraw_will();
                    }
                    session
                })
            }
        };
        drop(registry);
        let moment = self.moment;
        self.ids.end(forgotten.map(|session| RememberedSession { moment, session: Some(session) }));
        self.ids.0.has_gone.notify_one();
    }

    pub(super) const fn is_remembered(&self) -> bool {
        self.is_remembered
    }
}

impl Drop for ClientId {
    fn drop(&mut self) {
        self.ids.registry().present.retain(|_, present| present.moment != self.moment);
    }
}

#[cfg(test)]
mod tests {
    use futures_util::FutureExt;

    use super::*;

    fn name(client: &str) -> Name {
        Name { who: Arc::from("operator"), client: client.to_owned() }
    }

    const ANEW: Memory = Memory { resumes: false, wants: false };
    const AGAIN: Memory = Memory { resumes: true, wants: true };

    async fn is_remembered(ids: &ClientIds, client: &str) -> bool {
        let (id, session) = ids.take(name(client), AGAIN).await;
        id.remember(Some(Session::default()));
        session.is_some()
    }

    #[tokio::test(start_paused = true)]
    async fn whoever_comes_with_a_name_that_is_present_takes_its_place_when_it_has_left() {
        let ids = ClientIds::default();
        let (mut old, _) = ids.take(name("panel"), ANEW).await;
        let leaving = tokio::spawn(async move { old.wanted().await });
        ids.take(name("panel"), ANEW).await;
        assert!(leaving.await.is_ok());
        let (hangs, _) = ids.take(name("panel"), ANEW).await;
        let (newer, _) = ids.take(name("panel"), ANEW).await;
        drop(hangs);
        assert_eq!(ids.registry().present.len(), 1, "the newer one is there still");
        drop(newer);
        assert!(ids.registry().present.is_empty());
    }

    /// An older client that still waits for the id, although it has already left, does not disconnect a newer client.
    #[tokio::test(start_paused = true)]
    async fn whoever_came_before_takes_the_place_of_nobody_who_came_later() {
        let ids = ClientIds::default();
        let (mut first, _) = ids.take(name("panel"), AGAIN).await;
        let mut older = Box::pin(ids.take(name("panel"), AGAIN));
        assert!(older.as_mut().now_or_never().is_none());
        first.wanted().await;
        drop(first);
        let (mut newer, _) = ids.take(name("panel"), AGAIN).await;
        let (mut older, _) = older.await;
        older.wanted().await;
        let is_wanted = tokio::time::timeout(Duration::from_secs(9), newer.wanted()).await;
        assert!(is_wanted.is_err(), "nobody wants its place");
        older.remember(Some(Session::default()));
        drop(older);
        assert_eq!(ids.registry().present.len(), 1);
        drop(newer);
        assert!(!is_remembered(&ids, "panel").await, "what it would have remembered is another's");
    }

    #[tokio::test]
    async fn nobody_takes_the_place_of_somebody_elses_client() {
        let ids = ClientIds::default();
        let _theirs = ids.take(name("panel"), ANEW).await;
        let other = Name { who: Arc::from("viewer"), client: "panel".to_owned() };
        assert!(ids.take(other, ANEW).now_or_never().is_some(), "nobody was waited for");
    }

    #[tokio::test]
    async fn who_wants_to_be_remembered_is_until_he_wants_it_no_more() {
        let ids = ClientIds::default();
        assert!(!is_remembered(&ids, "panel").await, "he was never here");
        assert!(!is_remembered(&ids, "other").await);
        assert!(is_remembered(&ids, "panel").await && is_remembered(&ids, "panel").await);
        let (id, session) = ids.take(name("panel"), ANEW).await;
        id.remember(Some(Session::default()));
        drop(id);
        assert!(session.is_none() && !is_remembered(&ids, "panel").await);
        assert!(!is_remembered(&ids, "").await && !is_remembered(&ids, "").await, "whoever has no name cannot be known again");
    }

    /// Safety A5.
    #[tokio::test]
    async fn only_so_many_are_remembered_and_whoever_has_been_away_for_longest_is_forgotten() {
        let ids = ClientIds::default();
        for number in 0..=REMEMBERED {
            assert!(!is_remembered(&ids, &number.to_string()).await);
        }
        assert_eq!(ids.registry().remembered.len(), REMEMBERED);
        assert!(is_remembered(&ids, "1").await);
        assert!(!is_remembered(&ids, "0").await, "he was the first to go");
        let here: Vec<_> =
            futures_util::future::join_all((0..REMEMBERED).map(|n| ids.take(name(&format!("here {n}")), AGAIN))).await;
        assert_eq!(ids.registry().remembered.len(), here.len());
        assert!(!is_remembered(&ids, "one more").await && !is_remembered(&ids, "one more").await, "nobody is away");
    }

    /// Safety A5, S9.
    #[tokio::test]
    async fn nobody_is_forgotten_because_of_another_who_has_more() {
        let ids = ClientIds::default();
        assert!(!is_remembered(&ids, "panel").await);
        for number in 0..2 * REMEMBERED {
            let name = Name { who: Arc::from("viewer"), client: number.to_string() };
            let (id, _) = ids.take(name, AGAIN).await;
            assert!(id.is_remembered());
            id.remember(Some(Session::default()));
        }
        assert_eq!(ids.registry().remembered.len(), REMEMBERED);
        assert!(is_remembered(&ids, "panel").await);
    }

    #[tokio::test(start_paused = true)]
    async fn of_two_who_come_at_once_one_is_sent_away() {
        let ids = ClientIds::default();
        let ((mut one, _), mut other) = (ids.take(name("panel"), AGAIN).await, None);
        tokio::select! {
            () = one.wanted() => drop(one),
            id = ids.take(name("panel"), AGAIN) => other = Some(id),
        }
        assert!(other.is_none(), "the second waited until the first was asked to leave");
        let hangs = ids.take(name("panel"), AGAIN).await;
        let _newer = ids.take(name("panel"), AGAIN).await;
        drop(hangs);
        assert!(ids.registry().present.contains_key(&name("panel")));
    }
}
