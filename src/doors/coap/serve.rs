//! The loop of this door. It passes datagrams to the endpoint, and the endpoint's requests to the application. It
//! passes answers, changes and the time back to the endpoint, and the endpoint's output to the socket. Nothing is
//! interpreted here.

use std::sync::Arc;
use std::time::Duration;

use tokio::sync::watch;

use super::application::{self, Application, HALTED, Reply};
use super::change_feed::ChangeFeed;
use super::flood_filter::{FloodFilter, KindCounts};
use super::pending::{PendingAnswers, RequestKind, busy};
use super::socket::{BATCH, Socket};
use crate::runtime::clock::Clock;
use crate::runtime::figures::Connected;
use crate::runtime::handle::Gone;
use coap_endpoint::{Backlog, Code, Datagram, Endpoint, Response};
use hallsweep_core::snapshot::Snapshot;

/// Maximum wait for requests under way when the program ends. The HTTP door ends at the same time. The program must
/// end within two seconds.
const GRACE: Duration = Duration::from_millis(1500);

/// Maximum time for answering datagrams in one turn (safety S7). After that, more datagrams are received, and other
/// sockets of this thread get their turns.
const TURN: Duration = Duration::from_millis(1);

/// Maximum time in one turn for receiving datagrams. Answering urgent requests may take the same time once more.
/// `HEARING_BYTES` limits the bytes of each of the two.
const HEARING: Duration = Duration::from_millis(2);
const HEARING_BYTES: usize = 64 * 1024;

/// Maximum number of turns in a row in which only urgent requests are answered. In that many turns, more datagrams
/// are received than fit into the system's queue for a socket.
const HEARINGS: u32 = 20;

struct Driver<A> {
    socket: Socket,
    endpoint: Endpoint,
    application: A,
    pending: PendingAnswers,
    backlog: Backlog,
    filter: FloodFilter,
    observed: Vec<Connected>,
    /// Number of turns in a row in which only urgent requests were answered.
    hearings: u32,
    clock: Clock,
}

/// Serves until `shutdown`, then waits at most `GRACE` for requests under way. The endpoint derives all its random
/// numbers from `secret`.
pub async fn serve<A: Application>(
    socket: Socket,
    secret: [u8; 32],
    application: A,
    states: watch::Receiver<Arc<Snapshot>>,
    shutdown: impl Future<Output = ()>,
) {
    let clock = Clock::default();
    // The time since 1970 at which `clock` was zero. With it, the numbers of notifications continue to grow after a
    // restart.
    let now = clock.now();
    let began = Duration::from_millis(u64::try_from(now.wall.unix_ms).unwrap_or(0)).saturating_sub(now.since_start);
    let endpoint = Endpoint::new(secret).started_at(began).with_urgent(A::IS_STOP, HALTED);
    let (pending, backlog, filter) = (PendingAnswers::default(), Backlog::new(A::IS_STOP), FloodFilter::new(A::STOP_WORDS));
    let mut driver = Driver { socket, endpoint, application, pending, backlog, filter, observed: Vec::new(), hearings: 0, clock };
    let mut changes = ChangeFeed::of(states, clock);
    tokio::pin!(shutdown);
    loop {
        let (due, is_behind) = (driver.endpoint.poll_timeout(), !driver.backlog.is_empty());
        tokio::select! {
            biased;
            () = &mut shutdown => break,
            Some((exchange, answer)) = driver.pending.next() => {
                changes.again_for(&answer);
                driver.endpoint.handle_answer(exchange, answer, clock.since_start());
            }
            () = clock.reach(due) => driver.endpoint.handle_timeout(clock.since_start()),
            () = clock.reach(driver.filter.due()) => driver.loosen(),
            () = changes.next() => changes.tell(&mut driver.endpoint, &driver.application, clock.since_start()),
            () = async { if !is_behind { driver.socket.readable().await } } => driver.turn().await,
        }
        driver.settle(clock.since_start());
    }
    let _ = tokio::time::timeout(GRACE, driver.finish()).await;
}

impl<A: Application> Driver<A> {
    /// Handles received datagrams for a limited time. If more arrive than can be answered, receiving comes first. So
    /// a STOP that follows the datagrams of other senders is found (safety S1, S7).
    async fn turn(&mut self) {
        if self.backlog.has_urgent() {
            // Nothing is received while a STOP waits. Otherwise a datagram that came later could be handled before
            // that STOP.
            self.answer_urgent();
        } else if self.backlog.is_empty() && self.answer_as_they_come().await {
            self.hearings = 0;
        } else {
            self.hearings += 1;
            let is_all = self.hear().await;
            self.answer_urgent();
            if is_all || self.hearings >= HEARINGS {
                self.hearings = 0;
                self.catch_up();
            }
        }
        tokio::task::yield_now().await;
    }

    /// Handles each datagram completely before the next is read. Returns whether the queue was empty. Reading several
    /// datagrams before answering would make clients send in bursts, and all would wait between the bursts.
    async fn answer_as_they_come(&mut self) -> bool {
        let until = self.clock.since_start() + TURN;
        for _ in 0..BATCH {
            let now = self.clock.since_start();
            if now > until {
                return false;
            }
            let Some((peer, bytes)) = self.socket.read().await else { return true };
            self.endpoint.handle_undone(self.application.undone());
            self.endpoint.handle_datagram(peer, bytes, now);
            self.settle(now);
        }
        false
    }

    /// Receives for at most `HEARING`, without answering. Returns whether the queue was empty.
    async fn hear(&mut self) -> bool {
        let (until, mut bytes_heard, mut kinds) = (self.clock.since_start() + HEARING, 0, [0; 4]);
        let is_all = loop {
            let Some((peer, bytes)) = self.socket.read().await else { break true };
            bytes_heard += bytes.len();
            kinds[self.filter.kind(bytes)] += 1;
            self.backlog.hear(peer, bytes);
            if bytes_heard >= HEARING_BYTES || self.clock.since_start() > until {
                break false;
            }
        };
        if !is_all && is_flood(kinds, bytes_heard) && self.filter.tighten(kinds, self.clock.since_start()) {
            self.socket.attach(&self.filter);
        }
        is_all
    }

    fn answer_urgent(&mut self) {
        let (until, mut bytes) = (self.clock.since_start() + HEARING, 0);
        while let Some(datagram) = self.backlog.take_urgent() {
            self.answer(&datagram);
            bytes += datagram.1.len();
            if bytes >= HEARING_BYTES || self.clock.since_start() > until {
                return;
            }
        }
    }

    fn loosen(&mut self) {
        if self.filter.loosen(self.clock.since_start()) {
            self.socket.attach(&self.filter);
        }
    }

    fn catch_up(&mut self) {
        let until = self.clock.since_start() + TURN;
        while let Some(datagram) = self.backlog.take() {
            self.answer(&datagram);
            if self.clock.since_start() > until {
                return;
            }
        }
    }

    fn answer(&mut self, (peer, bytes): &Datagram) {
        let now = self.clock.since_start();
        self.endpoint.handle_undone(self.application.undone());
        self.endpoint.handle_datagram(*peer, bytes, now);
        self.settle(now);
    }

    /// Passes requests to the application and datagrams to the network, until none are left. When the maximum number
    /// of commands is under way, further commands are refused.
    fn settle(&mut self, now: Duration) {
        while let Some((exchange, request)) = self.endpoint.poll_request() {
            let (kind, asked) = (RequestKind::of(request.method), &self.application);
            let is_full = self.pending.is_full(kind) && !A::IS_STOP(&request);
            let said = if is_full && kind == RequestKind::Command {
                asked.note_busy(&request);
                Reply::Now(busy())
            } else {
                application::answer(asked, &request)
            };
            match said {
                Reply::Now(answer) => self.endpoint.handle_answer(exchange, answer, now),
                Reply::Later(_) if is_full => self.endpoint.handle_answer(exchange, busy(), now),
                Reply::Later(answer) => self.pending.add(exchange, kind, answer),
            }
        }
        std::iter::from_fn(|| self.endpoint.poll_refused()).for_each(|refusal| self.application.note(refusal));
        while let Some(transmit) = self.endpoint.poll_transmit() {
            self.socket.send(&transmit);
        }
        self.observed.resize_with(self.endpoint.observers(), || self.application.observed());
    }

    async fn finish(&mut self) {
        self.endpoint.close(&Response::refusal(Code::UNAVAILABLE, Gone.to_string()));
        self.settle(self.clock.since_start());
        while let Some((exchange, answer)) = self.pending.next().await {
            self.endpoint.handle_answer(exchange, answer, self.clock.since_start());
            self.settle(self.clock.since_start());
        }
    }
}

/// Whether the datagrams of an overloaded turn are a flood: more than harmless clients send. A few datagrams in a
/// whole turn are no flood. In such a turn this thread had to wait for other threads, and a filter would drop
/// datagrams of innocent clients.
fn is_flood(heard: KindCounts, bytes: usize) -> bool {
    heard.iter().sum::<usize>() >= BATCH || bytes >= HEARING_BYTES
}

#[cfg(test)]
#[path = "serve_tests.rs"]
mod tests;
