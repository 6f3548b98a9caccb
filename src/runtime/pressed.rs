//! STOPs for which there was no room in the queue of commands: counted by sender, so that each is on record and answered however many
//! come, and whether or not anybody waits for the answer (safety A6). They have halted the robot before they come here.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::{Notify, oneshot};

use super::handle::Answer;
use crate::core::command::{Door, Request};

/// So many senders are told apart: more than there are keys, at each of the doors. Of more the last stands for all.
const SENDERS: usize = 512;

/// After so many answers it is looked which of them nobody waits for. As many as are waited for there are places at the doors.
const ANSWERS: usize = 1024;

/// Where STOPs go in. Cheap to clone.
#[derive(Clone, Debug)]
pub(super) struct PressedIn(Arc<Shared>);

/// Where they come out; when this is dropped nobody is answered any more.
#[derive(Debug)]
pub(super) struct PressedOut(Arc<Shared>);

#[derive(Debug, Default)]
struct Shared {
    state: Mutex<State>,
    news: Notify,
}

#[derive(Debug, Default)]
struct State {
    /// By name, address and door.
    senders: BTreeMap<(Arc<str>, Arc<str>, Door), Pressed>,
    is_closed: bool,
}

/// The STOPs of one sender.
#[derive(Debug)]
pub(super) struct Pressed {
    /// The last one.
    pub(super) last: Request,
    /// How many there were.
    pub(super) count: u64,
    /// Where they are answered, as far as somebody waits for it.
    pub(super) answers: Vec<oneshot::Sender<Answer>>,
    looked: usize,
}

/// Both ends.
pub(super) fn pressed() -> (PressedIn, PressedOut) {
    let shared = Arc::new(Shared::default());
    (PressedIn(Arc::clone(&shared)), PressedOut(shared))
}

impl PressedIn {
    /// Puts a STOP in, and gives it back when nobody takes any out.
    pub(super) fn put(
        &self,
        request: Request,
        answer: oneshot::Sender<Answer>,
    ) -> Result<(), (Request, oneshot::Sender<Answer>)> {
        let mut state = self.0.state();
        if state.is_closed {
            return Err((request, answer));
        }
        state.put(request, answer);
        drop(state);
        self.0.news.notify_one();
        Ok(())
    }
}

impl PressedOut {
    /// All that were put in since the last time.
    pub(super) fn take(&self) -> impl Iterator<Item = Pressed> + use<> {
        std::mem::take(&mut self.0.state().senders).into_values()
    }

    /// Waits until there is something to take.
    pub(super) async fn news(&self) {
        self.0.news.notified().await;
    }
}

impl Drop for PressedOut {
    fn drop(&mut self) {
        *self.0.state() = State { senders: BTreeMap::new(), is_closed: true };
    }
}

impl Shared {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    fn put(&mut self, request: Request, answer: oneshot::Sender<Answer>) {
        let issuer = &request.issuer;
        let key = (Arc::clone(&issuer.who), Arc::clone(&issuer.from), issuer.door);
        let is_full = self.senders.len() >= SENDERS && !self.senders.contains_key(&key);
        let place = if is_full { self.senders.last_entry().map(|last| last.into_mut()) } else { None };
        let pressed = match place {
            Some(last) => last,
            None => self.senders.entry(key).or_insert(Pressed {
                last: request.clone(),
                count: 0,
                answers: Vec::new(),
                looked: ANSWERS,
            }),
        };
        (pressed.last, pressed.count) = (request, pressed.count + 1);
        if pressed.answers.len() >= pressed.looked {
            pressed.answers.retain(|answer| !answer.is_closed());
            pressed.looked = ANSWERS.max(2 * pressed.answers.len());
        }
        pressed.answers.push(answer);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::core::command::{Command, Issuer};
    use crate::runtime::within::within;

    fn stop(from: &str) -> Request {
        Request::new(Command::Stop, Issuer { from: from.into(), ..Issuer::operator(Door::Mqtt) })
    }

    fn counts(out: &PressedOut) -> Vec<(String, u64, usize)> {
        out.take().map(|pressed| (pressed.last.issuer.from.to_string(), pressed.count, pressed.answers.len())).collect()
    }

    /// Safety A5, A6.
    #[test]
    fn stops_of_one_sender_are_counted_together_and_answers_nobody_waits_for_are_forgotten() {
        let (into, out) = pressed();
        let mut waiting = Vec::new();
        for n in 0..100_000 {
            let (answer, answered) = oneshot::channel();
            into.put(stop("192.0.2.7"), answer).unwrap();
            waiting.extend((n % 100 == 0).then_some(answered));
        }
        let (answer, _answered) = oneshot::channel();
        into.put(stop("192.0.2.8"), answer).unwrap();
        let counts = counts(&out);
        assert_eq!((counts[0].1, &counts[1]), (100_000, &("192.0.2.8".to_owned(), 1, 1)));
        assert!((1000..=2000 + ANSWERS).contains(&counts[0].2), "{counts:?}");
        assert_eq!(out.take().count(), 0, "nothing twice");
    }

    /// Safety A5.
    #[test]
    fn exactly_so_many_senders_are_told_apart_and_none_is_left_out() {
        let (into, out) = pressed();
        for n in 0..2 * SENDERS {
            into.put(stop(&format!("{n:05}")), oneshot::channel().0).unwrap();
        }
        let counts = counts(&out);
        assert_eq!((counts.len(), counts.iter().map(|(_, count, _)| count).sum::<u64>()), (SENDERS, 2 * SENDERS as u64));
    }

    #[tokio::test]
    async fn whoever_takes_them_is_woken_and_when_nobody_does_nobody_waits() {
        let (into, out) = pressed();
        let (answer, answered) = oneshot::channel();
        into.put(stop("192.0.2.7"), answer).unwrap();
        within("the news", out.news()).await;
        drop(out);
        assert!(within("the end", answered).await.is_err());
        assert!(into.put(stop("192.0.2.7"), oneshot::channel().0).is_err(), "it is given back");
    }
}
