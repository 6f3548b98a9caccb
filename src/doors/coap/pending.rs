//! Requests that are answered later. Their number is bounded, and each has a time limit. The application carries them
//! out.

use std::collections::HashMap;
use std::pin::Pin;
use std::time::Duration;

use tokio::task::{Id, JoinSet};

use super::application::broken;
use coap_endpoint::{Answer, Code, ExchangeId, Method, Response, limits::OPEN};

/// Maximum number of commands under way. Urgent commands are accepted beyond it.
pub(super) const COMMANDS: usize = 256;

/// Maximum number of disk reads under way. It is separate from `COMMANDS`, because anybody may read, and a disk that
/// hangs must not block commands.
pub(super) const READS: usize = 64;

/// Seconds after which a refused client should try again.
const BUSY_S: u32 = 2;

/// Maximum time until a request is answered (RFC 7252, section 4.8.2: MAX_TRANSMIT_WAIT).
const PATIENCE: Duration = Duration::from_secs(93);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RequestKind {
    /// A request that changes nothing. It begins when its future is polled for the first time.
    Read,
    Command,
}

#[derive(Default)]
pub(super) struct PendingAnswers {
    tasks: JoinSet<Answer>,
    exchanges: HashMap<Id, (ExchangeId, RequestKind)>,
    reads: usize,
}

impl RequestKind {
    pub(super) const fn of(method: Method) -> RequestKind {
        if method.is_safe() { RequestKind::Read } else { RequestKind::Command }
    }
}

impl PendingAnswers {
    /// Whether the maximum number of requests of this kind is under way. Urgent requests may begin nevertheless.
    pub(super) fn is_full(&self, kind: RequestKind) -> bool {
        match kind {
            RequestKind::Read => self.reads >= READS,
            RequestKind::Command => self.tasks.len() - self.reads >= COMMANDS,
        }
    }

    /// Waits for an answer in the background. Beyond `OPEN` answers, an urgent command is still carried out, but its
    /// answer is dropped.
    pub(super) fn add(&mut self, exchange: ExchangeId, kind: RequestKind, answer: Pin<Box<dyn Future<Output = Answer> + Send>>) {
        if self.tasks.len() < OPEN {
            let slow = "the request was not answered in time: read the state before you repeat the request";
            let bounded = async {
                let answered = tokio::time::timeout(PATIENCE, answer).await;
                answered.unwrap_or_else(|_| unavailable(slow.to_owned()))
            };
            self.exchanges.insert(self.tasks.spawn(bounded).id(), (exchange, kind));
            self.reads += usize::from(kind == RequestKind::Read);
        }
    }

    /// Waits for the next answer. Returns `None` when no request is under way. Safe to cancel.
    pub(super) async fn next(&mut self) -> Option<(ExchangeId, Answer)> {
        let (id, answer) = self.tasks.join_next_with_id().await?.unwrap_or_else(|error| (error.id(), broken()));
        let (exchange, kind) = self.exchanges.remove(&id)?;
        self.reads -= usize::from(kind == RequestKind::Read);
        Some((exchange, answer))
    }
}

pub(super) fn busy() -> Answer {
    unavailable(format!("too many requests are under way: ask again in {BUSY_S} seconds"))
}

fn unavailable(words: String) -> Answer {
    Answer::once(Response { max_age: Some(BUSY_S), ..Response::refusal(Code::UNAVAILABLE, words) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use coap_endpoint::Endpoint;

    /// Safety A5.
    #[tokio::test]
    async fn reads_and_commands_have_places_of_their_own_and_beyond_all_of_them_nothing_is_waited_for() {
        let mut endpoint = Endpoint::new([7; 32]);
        endpoint.handle_datagram(([127, 0, 0, 1], 1).into(), b"\x40\x02\x00\x01\xB4take", Duration::ZERO);
        let exchange = endpoint.poll_request().expect("it is one").0;
        let mut pending = PendingAnswers::default();
        let mut begin = |kind, count: usize| {
            (0..count).for_each(|_| pending.add(exchange, kind, Box::pin(std::future::pending())));
            [RequestKind::Read, RequestKind::Command].map(|kind| pending.is_full(kind))
        };
        assert_eq!(begin(RequestKind::Read, READS - 1), [false, false]);
        assert_eq!(begin(RequestKind::Read, 1), [true, false]);
        assert_eq!(begin(RequestKind::Command, COMMANDS - 1), [true, false]);
        assert_eq!(begin(RequestKind::Command, 1), [true, true]);
        begin(RequestKind::Command, 2 * OPEN);
        assert_eq!((pending.tasks.len(), pending.exchanges.len()), (OPEN, OPEN));
    }
}
