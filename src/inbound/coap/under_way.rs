//! Requests that were begun and are answered later: so many at once, and none for ever. What they do is the application's business.

use std::collections::HashMap;
use std::pin::Pin;
use std::time::Duration;

use tokio::task::{Id, JoinSet};

use super::application::broken;
use super::endpoint::ExchangeId;
use super::endpoint::code::Code;
use super::endpoint::limits::OPEN;
use super::endpoint::response::{Answer, Response};

/// Requests under way at once, each a command or a look at the disk; urgent ones are taken all the same.
const MOST: usize = 256;

/// Whoever asks for one more is told to ask again after so many seconds.
const BUSY_S: u32 = 2;

/// Nobody waits longer for an answer (RFC 7252, section 4.8.2: MAX_TRANSMIT_WAIT).
const PATIENCE: Duration = Duration::from_secs(93);

/// All of them.
#[derive(Default)]
pub(super) struct UnderWay {
    tasks: JoinSet<Answer>,
    exchanges: HashMap<Id, ExchangeId>,
}

impl UnderWay {
    /// Whether no more are to be begun but urgent ones.
    pub(super) fn is_full(&self) -> bool {
        self.tasks.len() >= MOST
    }

    /// Waits for an answer in the background. Of urgent ones beyond what the endpoint remembers the answer is given up, and not
    /// what they asked for.
    pub(super) fn add(&mut self, exchange: ExchangeId, answer: Pin<Box<dyn Future<Output = Answer> + Send>>) {
        if self.tasks.len() < OPEN {
            let bounded = async { tokio::time::timeout(PATIENCE, answer).await.unwrap_or_else(|_| slow()) };
            self.exchanges.insert(self.tasks.spawn(bounded).id(), exchange);
        }
    }

    /// The next that is answered; `None` when none is under way. May be dropped while it waits.
    pub(super) async fn next(&mut self) -> Option<(ExchangeId, Answer)> {
        let (id, answer) = self.tasks.join_next_with_id().await?.unwrap_or_else(|error| (error.id(), broken()));
        self.exchanges.remove(&id).map(|exchange| (exchange, answer))
    }
}

/// 5.03: too many requests are under way.
pub(super) fn busy() -> Answer {
    unavailable(format!("{MOST} requests are under way: ask again in {BUSY_S} seconds"))
}

fn slow() -> Answer {
    unavailable("it takes longer than anybody waits: look at the state before you repeat it".to_owned())
}

fn unavailable(words: String) -> Answer {
    Answer::once(Response { max_age: Some(BUSY_S), ..Response::refusal(Code::UNAVAILABLE, words) })
}
