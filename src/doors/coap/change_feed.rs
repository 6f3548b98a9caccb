//! Tells the loop of this door, at a limited rate, that there is a newer state. Also tells the endpoint which
//! subjects may be sent to observers again; a subject is what several observers watch. The endpoint finds out which
//! subjects have changed.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use tokio::sync::watch;

use super::application::{self, Application};
use crate::doors::update_interval;
use crate::runtime::clock::Clock;
use coap_endpoint::{Answer, Endpoint, SubjectId, limits::PACE};
use hallsweep_core::snapshot::Snapshot;

pub(super) struct ChangeFeed {
    states: watch::Receiver<Arc<Snapshot>>,
    clock: Clock,
    /// No change is reported before this time. `None` once this time has passed.
    next: Option<Duration>,
    paces: Paces<SubjectId>,
}

/// When each subject may be sent again. A representation is always sent as a whole, so a large map is sent less often
/// than a small one. A subject that is skipped now is sent later.
#[derive(Debug)]
struct Paces<K> {
    next: BTreeMap<K, Duration>,
    /// Earliest time at which a skipped subject may be sent.
    passed_over: Option<Duration>,
}

impl ChangeFeed {
    pub(super) fn of(states: watch::Receiver<Arc<Snapshot>>, clock: Clock) -> ChangeFeed {
        ChangeFeed { states, clock, next: None, paces: Paces { next: BTreeMap::new(), passed_over: None } }
    }

    /// Waits until there is a newer state, or until a skipped subject may be sent. Safe to cancel.
    pub(super) async fn next(&mut self) {
        if self.next.is_some() {
            self.clock.reach(self.next).await;
            self.next = None;
        }
        tokio::select! {
            changed = self.states.changed() => if changed.is_err() {
                std::future::pending::<()>().await;
            },
            () = self.clock.reach(self.paces.passed_over) => {}
        }
        self.next = Some(self.clock.since_start() + PACE);
    }

    /// Call this after an answer was made. If the answer is observed, the state is reported once more, because it may
    /// have changed since the answer was made.
    pub(super) fn again_for(&mut self, answer: &Answer) {
        if !answer.observed.is_empty() {
            self.states.mark_changed();
        }
    }

    pub(super) fn tell(&mut self, endpoint: &mut Endpoint, application: &impl Application, now: Duration) {
        application::changed(application);
        let subjects = endpoint.subjects();
        for (subject, request) in self.paces.due(subjects, now) {
            if let Some(things) = application::things(application, &request) {
                self.paces.shown(subject, things.iter().map(|thing| thing.body.len()).sum(), now);
                endpoint.handle_change(subject, things, now);
            }
        }
    }
}

impl<K: Copy + Ord> Paces<K> {
    fn due<T>(&mut self, subjects: Vec<(K, T)>, now: Duration) -> Vec<(K, T)> {
        // Forgets the subjects that nobody observes any more.
        let next = std::mem::take(&mut self.next);
        self.next = subjects.iter().filter_map(|(id, _)| Some((*id, *next.get(id)?))).filter(|(_, next)| *next > now).collect();
        self.passed_over = self.next.values().min().copied();
        subjects.into_iter().filter(|(id, _)| !self.next.contains_key(id)).collect()
    }

    fn shown(&mut self, subject: K, bytes: usize, now: Duration) {
        self.next.insert(subject, now + update_interval::for_size(bytes));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_large_is_written_more_seldom_and_always_once_more_after_the_last_change() {
        let mut paces = Paces { next: BTreeMap::new(), passed_over: None };
        let (robot, map) = (1, 2);
        let mut written = BTreeMap::from([(robot, 0), (map, 0)]);
        for tick in 0..100 {
            let now = PACE * tick;
            for (subject, bytes) in paces.due(vec![(robot, 100), (map, 500_000)], now) {
                *written.entry(subject).or_default() += 1;
                paces.shown(subject, bytes, now);
            }
        }
        assert_eq!(written, BTreeMap::from([(robot, 100), (map, 4)]));
        let later = paces.passed_over.expect("the map has changed since it was written");
        assert_eq!(paces.due(vec![(map, 0)], later), [(map, 0)]);
        assert_eq!(paces.passed_over, None);
    }

    #[test]
    fn a_subject_that_nobody_observes_any_more_is_forgotten() {
        let mut paces = Paces { next: BTreeMap::new(), passed_over: None };
        paces.shown(1, 500_000, Duration::ZERO);
        assert_eq!(paces.due(Vec::<(u64, ())>::new(), PACE), []);
        assert_eq!((paces.next.len(), paces.passed_over), (0, None));
    }
}
