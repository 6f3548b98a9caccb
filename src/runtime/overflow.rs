//! Holds what did not fit into the full queue of commands: STOPs, and refusals that nobody waits for. STOPs and
//! refusals are counted by sender, so that any number of them is recorded (safety A5, A6). Each STOP is answered. A
//! STOP has already halted the robot before it comes here.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::{Notify, oneshot};

use hallsweep_core::asked::Asked;
use hallsweep_core::command::{Accepted, Door, Issuer, Request};
use hallsweep_core::refused::Refused;

pub(super) type Decision = Result<Accepted, Refused>;

/// Number of senders that are counted separately. It is higher than the number of keys times the number of doors.
/// Further senders share one count for each door.
const SENDERS: usize = 512;

/// Number of open answers of a sender at which the abandoned answers are dropped. An answer is abandoned if nobody
/// waits for it any more. The number of connections limits the number of other open answers.
const ANSWERS: usize = 1024;

/// The sending end. Cheap to clone.
#[derive(Clone, Debug)]
pub(super) struct OverflowIn(Arc<Inner>);

/// The receiving end. When it is dropped, nobody is answered any more.
#[derive(Debug)]
pub(super) struct OverflowOut(Arc<Inner>);

#[derive(Debug)]
struct Inner {
    /// `None` when the receiving end is gone.
    overflow: Mutex<Option<Overflow>>,
    news: Notify,
}

#[derive(Debug, Default)]
pub(super) struct Overflow {
    pub(super) stops: Senders<Request>,
    pub(super) refusals: Senders<(Issuer, Asked, Refused)>,
}

type Senders<T> = BTreeMap<SenderKey, Counted<T>>;

/// Name, address and door of a sender.
type SenderKey = (Arc<str>, Arc<str>, Door);

#[derive(Debug)]
pub(super) struct Counted<T> {
    pub(super) last: T,
    pub(super) count: u64,
    /// Channels of senders that may still wait for an answer.
    pub(super) answers: Vec<oneshot::Sender<Decision>>,
    /// Length of `answers` at which the abandoned answers are dropped next.
    look_at: usize,
}

pub(super) fn overflow() -> (OverflowIn, OverflowOut) {
    let inner = Arc::new(Inner { overflow: Mutex::new(Some(Overflow::default())), news: Notify::new() });
    (OverflowIn(Arc::clone(&inner)), OverflowOut(inner))
}

impl OverflowIn {
    /// Stores a STOP. Returns the STOP if the receiving end is gone.
    pub(super) fn put_stop(
        &self,
        stop: Request,
        answer: oneshot::Sender<Decision>,
    ) -> Option<(Request, oneshot::Sender<Decision>)> {
        let mut overflow = self.0.lock();
        let Some(Overflow { stops, .. }) = &mut *overflow else { return Some((stop, answer)) };
        put(stops, sender(&stop.issuer), stop, Some(answer));
        drop(overflow);
        self.0.news.notify_one();
        None
    }

    /// Stores a refusal by a door. If the receiving end is gone, the refusal is dropped, because nothing is recorded
    /// any more.
    pub(super) fn put_refusal(&self, issuer: Issuer, asked: Asked, refused: Refused) {
        if let Some(Overflow { refusals, .. }) = &mut *self.0.lock() {
            put(refusals, sender(&issuer), (issuer, asked, refused), None);
        }
        self.0.news.notify_one();
    }
}

impl OverflowOut {
    pub(super) fn take(&self) -> Overflow {
        self.0.lock().as_mut().map(std::mem::take).unwrap_or_default()
    }

    pub(super) async fn news(&self) {
        self.0.news.notified().await;
    }
}

impl Drop for OverflowOut {
    fn drop(&mut self) {
        *self.0.lock() = None;
    }
}

impl Inner {
    fn lock(&self) -> MutexGuard<'_, Option<Overflow>> {
        self.overflow.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T> Counted<T> {
    fn add(&mut self, one: T, answer: Option<oneshot::Sender<Decision>>) {
        (self.last, self.count) = (one, self.count + 1);
        if self.answers.len() >= self.look_at {
            self.answers.retain(|answer| !answer.is_closed());
            self.look_at = ANSWERS.max(2 * self.answers.len());
        }
        self.answers.extend(answer);
    }
}

fn sender(issuer: &Issuer) -> SenderKey {
    (issuer.key(), Arc::clone(&issuer.from), issuer.door)
}

fn put<T>(senders: &mut Senders<T>, sender: SenderKey, one: T, answer: Option<oneshot::Sender<Decision>>) {
    let is_told_apart = senders.len() < SENDERS || senders.contains_key(&sender);
    let sender = if is_told_apart { sender } else { (Arc::default(), Arc::default(), sender.2) };
    match senders.entry(sender) {
        Entry::Occupied(mut counted) => counted.get_mut().add(one, answer),
        Entry::Vacant(place) => {
            place.insert(Counted { last: one, count: 1, answers: Vec::from_iter(answer), look_at: ANSWERS });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::runtime::tests::within::within;
    use hallsweep_core::command::Command;

    fn issuer(from: &str) -> Issuer {
        Issuer { from: from.into(), ..Issuer::operator(Door("mqtt")) }
    }

    fn stop(from: &str) -> Request {
        Request::new(Command::Stop, issuer(from))
    }

    fn refuse(into: &OverflowIn, from: &str, n: usize) {
        into.put_refusal(issuer(from), Asked::Words(format!("START {n}")), Refused::NotAllowed("no".to_owned()));
    }

    fn counts<T>(senders: Senders<T>) -> Vec<(String, u64, usize)> {
        senders.into_iter().map(|((_, from, _), counted)| (from.to_string(), counted.count, counted.answers.len())).collect()
    }

    /// Safety A5, A6: stops of one sender are counted together. Answers for which nobody waits are dropped.
    #[test]
    fn stops_of_one_sender_are_counted_together_and_answers_nobody_waits_for_are_forgotten() {
        let (into, out) = overflow();
        let mut waiting = Vec::new();
        for n in 0..100_000 {
            let (answer, answered) = oneshot::channel();
            assert!(into.put_stop(stop("192.0.2.7"), answer).is_none());
            waiting.extend((n % 100 == 0).then_some(answered));
        }
        let (answer, _answered) = oneshot::channel();
        assert!(into.put_stop(stop("192.0.2.8"), answer).is_none());
        let counts = counts(out.take().stops);
        assert_eq!((counts[0].1, &counts[1]), (100_000, &("192.0.2.8".to_owned(), 1, 1)));
        assert!((1000..=2000 + ANSWERS).contains(&counts[0].2), "{counts:?}");
        assert!(out.take().stops.is_empty(), "nothing twice");
    }

    /// Safety A6: a STOP is never counted as a refusal, nor a refusal as a STOP.
    #[test]
    fn refusals_of_one_sender_are_counted_together_beside_the_stops() {
        let (into, out) = overflow();
        for n in 1..=1000 {
            refuse(&into, "192.0.2.7", n);
        }
        refuse(&into, "192.0.2.8", 7);
        assert!(into.put_stop(stop("192.0.2.7"), oneshot::channel().0).is_none());
        let Overflow { stops, refusals } = out.take();
        let asked: Vec<_> = refusals.values().map(|counted| (counted.last.1.to_string(), counted.count)).collect();
        assert_eq!(asked, [("START 1000".to_owned(), 1000), ("START 7".to_owned(), 1)]);
        assert_eq!(counts(stops), [("192.0.2.7".to_owned(), 1, 1)]);
    }

    /// Safety A5: only `SENDERS` senders are counted separately. All others share a count without a name.
    #[test]
    fn exactly_so_many_senders_are_told_apart_and_those_beyond_are_counted_under_no_name_of_these() {
        let (into, out) = overflow();
        for n in 0..2 * SENDERS {
            let from = format!("{n:05}");
            assert!(into.put_stop(stop(&from), oneshot::channel().0).is_none());
            refuse(&into, &from, n);
        }
        let Overflow { stops, refusals } = out.take();
        for counts in [counts(stops), counts(refusals)] {
            let (others, told_apart): (Vec<_>, Vec<_>) = counts.into_iter().partition(|(from, _, _)| from.is_empty());
            assert!(told_apart.len() == SENDERS && told_apart.iter().all(|(_, count, _)| *count == 1), "{told_apart:?}");
            assert_eq!(others.iter().map(|(_, count, _)| *count).collect::<Vec<_>>(), [SENDERS as u64]);
        }
    }

    #[tokio::test]
    async fn whoever_takes_them_is_woken_and_when_nobody_does_nobody_waits() {
        let (into, out) = overflow();
        let (answer, answered) = oneshot::channel();
        assert!(into.put_stop(stop("192.0.2.7"), answer).is_none());
        within("the news of a stop", out.news()).await;
        refuse(&into, "192.0.2.7", 1);
        within("the news of a refusal", out.news()).await;
        drop(out);
        assert!(within("the end", answered).await.is_err());
        assert!(into.put_stop(stop("192.0.2.7"), oneshot::channel().0).is_some(), "it is given back");
    }
}
