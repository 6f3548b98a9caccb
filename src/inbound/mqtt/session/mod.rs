//! Our own MQTT client: it says what is new, hears commands at somebody else's broker, and comes back whenever the connection is
//! lost, for as long as the program runs. What is said is decided in `news`, what is heard in `orders`.

mod backoff;
mod conversation;
mod health;
mod hearing;
mod ledger;
mod line;
mod link;
mod lost;
mod pulse;
mod stand_in;
mod talk;
mod times;
mod tls;

pub use health::Health;
pub use hearing::Hearing;
pub use link::Link;
pub use times::Times;
pub use tls::{TlsError, believing};

use std::sync::Arc;

use tokio::sync::{mpsc, watch};

use super::publication::Publication;
use crate::core::rng::Stream;
use crate::core::world::snapshot::Snapshot;
use crate::runtime::clock::Clock;
use backoff::Backoff;
use health::Chart;
use lost::Lost;
use stand_in::{News, Orders};
use talk::Talk;

/// What stands on the topic of availability while the program is not there.
const OFFLINE: &str = "offline";

/// What a session is made of.
pub struct Parts {
    /// Where the broker is.
    pub link: Link,
    /// What is listened to.
    pub hearing: Hearing,
    /// What is said.
    pub news: News,
    /// Who takes commands.
    pub orders: Orders,
    /// The answers to commands.
    pub answers: mpsc::Receiver<Publication>,
    /// The state.
    pub states: watch::Receiver<Arc<Snapshot>>,
    /// Who is told how the broker is.
    pub health: watch::Sender<Health>,
    /// Where the spread of pauses and the words of the pulse come from.
    pub seed: u64,
    /// How long is waited for what.
    pub times: Times,
}

/// A client that keeps its connection to a broker.
pub struct Session {
    link: Link,
    /// The broker's address, for the records of commands.
    broker: Arc<str>,
    hearing: Hearing,
    news: News,
    orders: Orders,
    answers: mpsc::Receiver<Publication>,
    states: watch::Receiver<Arc<Snapshot>>,
    /// What may not have arrived on a connection that was lost.
    unacknowledged: Vec<Publication>,
    chart: Chart,
    backoff: Backoff,
    chance: Stream,
    clock: Clock,
    times: Times,
    is_lost: bool,
}

impl Session {
    /// A session that has not begun.
    #[must_use]
    pub fn new(parts: Parts) -> Session {
        Session {
            broker: parts.link.to_string().into(),
            link: parts.link,
            hearing: parts.hearing,
            news: parts.news,
            orders: parts.orders,
            answers: parts.answers,
            states: parts.states,
            unacknowledged: Vec::new(),
            chart: Chart::new(parts.health),
            backoff: Backoff::new(&parts.times, Stream::new(parts.seed, "mqtt pauses")),
            chance: Stream::new(parts.seed, "mqtt pulse"),
            clock: Clock::default(),
            times: parts.times,
            is_lost: false,
        }
    }

    /// Keeps the connection until `shutdown`, then takes leave, within a second.
    pub async fn run(mut self, shutdown: impl Future<Output = ()>) {
        tokio::pin!(shutdown);
        loop {
            let began = self.clock.now().since_start;
            let mut talk = Talk::begin(&mut self);
            let lost = tokio::select! {
                () = &mut shutdown => return talk.take_leave().await,
                lost = talk.go_on() => lost,
            };
            let was_open = talk.is_open();
            talk.end();
            self.handle_lost(&lost, was_open);
            let lasted = self.clock.now().since_start.saturating_sub(began);
            let pause = self.backoff.handle_ended(lasted, was_open);
            tokio::select! {
                () = &mut shutdown => return,
                () = tokio::time::sleep(pause) => {}
            }
        }
    }

    /// What is said when the program ends, and by the broker when it is gone without a word.
    fn offline(&self) -> Publication {
        Publication::kept(self.hearing.topics.availability(), OFFLINE)
    }

    /// The broker has greeted us and answered our subscription.
    fn handle_open(&mut self) {
        if std::mem::take(&mut self.is_lost) {
            tracing::info!(broker = %self.link, "the MQTT broker is back");
        }
        if !self.hearing.is_own {
            self.chart.handle_proof();
        }
    }

    /// One line when it is lost, and none for the attempts after that.
    fn handle_lost(&mut self, lost: &Lost, was_open: bool) {
        self.chart.handle_lost(&lost.to_string());
        if !std::mem::replace(&mut self.is_lost, true) {
            let what = if was_open { "is lost" } else { "cannot be reached" };
            tracing::warn!(broker = %self.link, reason = %lost, "the MQTT broker {what}; it is tried again until it answers");
        }
    }
}
