//! Serves one client. While there is little traffic, the hearing thread serves it, because waking another thread
//! takes longer than passing on a short message. Otherwise a task of its own serves it, on the gate's thread. Only
//! one of these two threads uses `client_io` at a time, and `client_io` works in the same way on both.
//!
//! ```text
//!   hear-mqtt  a message ─► Feeder::put wakes the publisher's service ─► ClientIo ─► Subscriber::put wakes a reader's ─► ClientIo ─► its socket
//!                             │ at once, while the allowance lasts           │ likewise
//!   mqtt-gate                 └──────────── else, the task of each ──────────┘
//! ```

use std::cell::RefCell;
use std::collections::VecDeque;
use std::future::poll_fn;
use std::pin::{Pin, pin};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, TryLockError};
use std::task::{Context, Poll, Wake, Waker};
use std::time::Duration;

use futures_util::task::AtomicWaker;
use tokio::task::yield_now;
use tokio::time::{Sleep, sleep_until};

use super::client_io::{ClientIo, TurnLength};
use crate::runtime::clock::Clock;
use mqtt_gate::Ended;

/// Share of the hearing thread's time that may be spent on serving clients (safety S7): 1 / `SHARE`.
const SHARE: u32 = 8;

/// Longest uninterrupted turn of serving, if that much time was saved up. A step that has begun is finished even if
/// this limit passes.
const LONGEST_TURN: Duration = Duration::from_micros(500);

/// Minimum saved time for beginning a turn of serving.
const SHORTEST_TURN: Duration = Duration::from_micros(100);

thread_local! {
    /// Woken services that this thread will run; `None` while this thread does not serve.
    static QUEUE: RefCell<Option<VecDeque<Arc<ClientService>>>> = const { RefCell::new(None) };
    static ALLOWANCE: RefCell<Allowance> = const { RefCell::new(Allowance { saved: LONGEST_TURN, at: Duration::ZERO }) };
}

pub(super) struct ClientService {
    /// `None` when the client is not served any more.
    io: Mutex<Option<ClientIo>>,
    task: AtomicWaker,
}

/// Time that the hearing thread may spend on serving clients. It grows by elapsed time / `SHARE`, up to
/// `LONGEST_TURN`.
#[derive(Debug)]
struct Allowance {
    saved: Duration,
    at: Duration,
}

/// While this value exists, services that this thread wakes are run on this thread. When it is dropped, the remaining
/// services are run by their own tasks.
struct ServiceQueue;

impl ClientService {
    pub(super) fn new(io: ClientIo) -> Arc<ClientService> {
        Arc::new(ClientService { io: Mutex::new(Some(io)), task: AtomicWaker::new() })
    }

    pub(super) async fn serve(self: &Arc<ClientService>, clock: Clock) -> Ended {
        let waker = Waker::from(Arc::clone(self));
        let mut alarm = Alarm(None);
        poll_fn(|cx| {
            self.task.register(cx.waker());
            let mut service = self.io();
            let Some(io) = service.as_mut() else { return Poll::Ready(Ended::Gone) };
            if let Poll::Ready(ended) = io.poll(TurnLength::Long, &mut Context::from_waker(&waker)) {
                return Poll::Ready(ended);
            }
            if io.wants_turn() {
                // `yield_now` lets all other tasks run first, including tasks woken by another thread. If the task
                // only woke itself, it would block them.
                let _ = pin!(yield_now()).poll(cx);
            }
            alarm.set(io.due(), clock, cx);
            Poll::Pending
        })
        .await
    }

    pub(super) fn close(&self) -> Option<ClientIo> {
        self.io().take()
    }

    /// Serves for one short turn on the calling thread. If the service needs its own task, that task is woken.
    fn serve_here(self: Arc<ClientService>) {
        let waker = Waker::from(Arc::clone(&self));
        let (wants_task, wants_turn) = match self.io.try_lock() {
            Ok(mut service) => service.as_mut().map_or((false, false), |io| {
                let _ = io.poll(TurnLength::Short, &mut Context::from_waker(&waker));
                (io.wants_task(), io.wants_turn())
            }),
            Err(TryLockError::WouldBlock | TryLockError::Poisoned(_)) => (true, false),
        };
        if wants_task {
            self.task.wake();
        } else if wants_turn {
            // This service runs again after the services that it has just woken.
            waker.wake();
        }
    }

    fn io(&self) -> MutexGuard<'_, Option<ClientIo>> {
        self.io.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Wake for ClientService {
    fn wake(self: Arc<ClientService>) {
        let left = QUEUE.with_borrow_mut(|queue| match queue {
            Some(queue) => {
                queue.push_back(self);
                None
            }
            None => Some(self),
        });
        if let Some(service) = left {
            service.task.wake();
        }
    }
}

/// Runs `ring`, which may wake services. Then runs these services on this thread until the allowed time is used up.
/// The remaining services are run by their own tasks.
pub(super) fn serving_here(clock: Clock, ring: impl FnOnce()) {
    let began = clock.since_start();
    let Some(allowed) = ALLOWANCE.with_borrow_mut(|allowance| allowance.begin(began)) else { return ring() };
    let _queue = ServiceQueue::begin();
    ring();
    while let Some(service) = QUEUE.with_borrow_mut(|queue| queue.as_mut()?.pop_front()) {
        if clock.since_start() >= began + allowed {
            service.task.wake();
        } else {
            service.serve_here();
        }
    }
    ALLOWANCE.with_borrow_mut(|allowance| allowance.end(began, clock.since_start()));
}

impl ServiceQueue {
    fn begin() -> ServiceQueue {
        QUEUE.set(Some(VecDeque::new()));
        ServiceQueue
    }
}

impl Drop for ServiceQueue {
    fn drop(&mut self) {
        QUEUE.take().into_iter().flatten().for_each(|service| service.task.wake());
    }
}

impl Allowance {
    /// Returns the time allowed for a turn of serving now, or `None` if it is below `SHORTEST_TURN`.
    fn begin(&mut self, now: Duration) -> Option<Duration> {
        self.saved = (self.saved + now.saturating_sub(self.at) / SHARE).min(LONGEST_TURN);
        self.at = now;
        (self.saved >= SHORTEST_TURN).then_some(self.saved)
    }

    fn end(&mut self, began: Duration, now: Duration) {
        self.saved = self.saved.saturating_sub(now.saturating_sub(began));
        self.at = now;
    }
}

/// A timer that is not reset at each message. It may fire too early; then it is set again.
struct Alarm(Option<(Duration, Pin<Box<Sleep>>)>);

impl Alarm {
    /// Sets the timer to wake the task at `due`. An earlier time set before is kept, so the task may be woken too
    /// early.
    fn set(&mut self, due: Duration, clock: Clock, cx: &mut Context<'_>) {
        if self.0.as_ref().is_none_or(|(at, _)| *at > due) {
            self.0 = Some((due, Box::pin(sleep_until(clock.instant(due)))));
        }
        if let Some((_, sleep)) = &mut self.0
            && sleep.as_mut().poll(cx).is_ready()
        {
            self.0 = None;
            cx.waker().wake_by_ref();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Safety S7.
    #[test]
    fn no_more_than_a_part_of_the_time_is_spent_on_serving() {
        let mut allowance = Allowance { saved: LONGEST_TURN, at: Duration::ZERO };
        let (mut now, mut spent) = (Duration::from_secs(100), Duration::ZERO);
        let until = now + Duration::from_secs(10);
        while now < until {
            if let Some(allowed) = allowance.begin(now) {
                let took = allowed.min(Duration::from_micros(30));
                allowance.end(now, now + took);
                (now, spent) = (now + took, spent + took);
            } else {
                now += Duration::from_micros(7);
            }
        }
        assert!(spent <= Duration::from_secs(10) / SHARE + LONGEST_TURN && spent > Duration::from_secs(1), "{spent:?}");
    }

    /// If a turn takes longer than allowed, later turns must wait until that time is saved again.
    #[test]
    fn what_is_saved_has_an_end_and_what_took_too_long_is_made_up_for() {
        let mut allowance = Allowance { saved: Duration::ZERO, at: Duration::ZERO };
        let (now, took) = (Duration::from_secs(100), Duration::from_millis(3));
        assert_eq!(allowance.begin(now), Some(LONGEST_TURN));
        allowance.end(now, now + took);
        assert_eq!(allowance.begin(now + took + SHARE * SHORTEST_TURN - Duration::from_micros(8)), None);
        assert_eq!(allowance.begin(now + took + SHARE * SHORTEST_TURN), Some(SHORTEST_TURN));
    }
}
