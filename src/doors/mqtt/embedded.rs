//! Our own broker, from its start to its end: clients come in by TCP and by WebSocket and are shown to the gate; the router behind it
//! is started anew when the pulse says that it is ill. What a client may do is the gate's business.

use std::net::SocketAddr;
use std::sync::Arc;
use std::time::Duration;

use tokio::net::TcpStream;
use tokio::runtime::Handle;
use tokio::sync::{mpsc, watch};
use tokio::task::JoinSet;
use tokio::time::MissedTickBehavior;

use super::clients::Clients;
use super::incoming::{IncomingConnection, Origin};
use super::limits::APPETITE;
use super::router::{Router, RouterError};
use super::session::Health;
use super::suspicion::{Suspicion, is_greedy, memory_in_use};
use crate::access::Access;
use crate::doors::listeners::Listeners;
use crate::doors::write_timeout::WriteTimeoutStream;
use crate::runtime::clock::Clock;

/// How often it is looked whether messages come out of the router, and whether it was shown too much or has taken too much memory: in
/// this time it takes some ten mebibytes at the worst.
const GLANCE: Duration = Duration::from_millis(50);

/// After an accept has failed (as with too many open files) the next is tried this much later.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// A router is not started anew sooner than this after the last time: an illness that does not end with it is another's.
const REST: Duration = Duration::from_secs(5);

/// So long the last words may take to reach the clients when the program ends; it is to end within two seconds.
const LAST_WORDS: Duration = Duration::from_millis(500);

/// One that was shown too much is replaced no sooner than this after the last: in between, new topics and filters are refused.
const WORN_REST: Duration = Duration::from_secs(600);

/// The router that messages are routed by just now; closed when the program ends.
pub(super) type Running = watch::Receiver<Arc<Router>>;

/// How clients come to our own broker, and who says whether it is well.
pub struct Ways {
    /// By TCP,
    pub listeners: Listeners,
    /// where these are let in;
    pub access: Access,
    /// and by WebSocket.
    pub web_clients: mpsc::Receiver<IncomingConnection>,
    /// Where what they say is heard, and nothing else is done (safety S7); the listeners wait there, too.
    pub hearing: Handle,
    /// What our own session finds.
    pub health: watch::Receiver<Health>,
}

pub struct Embedded {
    clients: Clients,
    router: watch::Sender<Arc<Router>>,
    clock: Clock,
    /// Until then the router is left as it is.
    rests_until: Duration,
    /// When it was last replaced for having been shown too much.
    worn_at: Option<Duration>,
    /// The fewest bytes that the program was seen to have in use since this router began, or a little above the fewest of all,
    usual: usize,
    /// which are these.
    least: usize,
    suspicion: Suspicion,
}

enum Finding {
    /// It cannot go on; why.
    Broken(&'static str),
    Told(Health),
}

impl Embedded {
    /// Starts the router for these clients.
    pub async fn start(clients: Clients) -> Result<Embedded, RouterError> {
        let router = watch::Sender::new(Arc::new(Router::start().await?));
        Ok(Embedded {
            clients,
            router,
            clock: Clock::default(),
            rests_until: Duration::ZERO,
            worn_at: None,
            usual: usize::MAX,
            least: usize::MAX,
            suspicion: Suspicion::default(),
        })
    }

    /// Serves until `shutdown`; then every connection ends, when what was said before that has reached its client. All but the hearing
    /// is done where this is called.
    pub async fn serve(mut self, ways: Ways, shutdown: impl Future<Output = ()>) {
        let Ways { listeners, access, web_clients, mut health, hearing } = ways;
        let reception =
            Reception { clients: self.clients.clone(), access, router: self.router.subscribe(), work: Handle::current() };
        let reception = hearing.spawn(reception.receive(listeners, web_clients));
        let mut glances = tokio::time::interval(GLANCE);
        glances.set_missed_tick_behavior(MissedTickBehavior::Delay);
        tokio::pin!(shutdown);
        loop {
            tokio::select! {
                biased;
                () = &mut shutdown => break,
                finding = self.look(&mut health) => {
                    if let Some(why) = self.illness(&finding) {
                        self.renew(why).await;
                    }
                }
                _ = glances.tick() => {
                    self.suspicion.handle_came(self.clients.broker().came(), self.clock.now().since_start);
                    if let Some(why) = self.worn_out() {
                        self.renew(why).await;
                    }
                }
            }
        }
        // Every connection is told by this that it ends; the router is there still, for what they have to say.
        let _last = Arc::clone(&self.router.borrow());
        drop(self.router);
        if reception.await.is_err() {
            tracing::error!("whoever listened to MQTT clients has ended by a mistake of its own");
        }
    }

    async fn look(&self, health: &mut watch::Receiver<Health>) -> Finding {
        self.clock.reach(Some(self.rests_until)).await;
        let (ended, shut) = {
            let router = self.router.borrow();
            (router.ended(), router.shut())
        };
        tokio::select! {
            () = ended => Finding::Broken("it has ended"),
            () = shut => Finding::Broken("it lets nobody in"),
            told = told(health) => Finding::Told(told),
        }
    }

    /// Why the router has to be started anew, if it has to.
    fn illness(&mut self, finding: &Finding) -> Option<&'static str> {
        let now = self.clock.now().since_start;
        match *finding {
            Finding::Broken(why) => Some(why),
            Finding::Told(health) if self.suspicion.handle_told(health, now) => Some("it does not pass messages on"),
            Finding::Told(Health::Ill) => {
                tracing::warn!(
                    "the MQTT broker keeps our own messages waiting, though it passes others on: it has too much to do"
                );
                None
            }
            Finding::Told(Health::Well | Health::Unproven) => None,
        }
    }

    /// Why another router is needed, though this one is not ill.
    fn worn_out(&mut self) -> Option<&'static str> {
        if let Some(in_use) = memory_in_use() {
            let in_use = in_use.saturating_sub(self.clients.held_bytes());
            // What the router before had is given back to the system a little later, or kept for what comes: that is not usual.
            self.least = self.least.min(in_use);
            self.usual = self.usual.min(in_use).min(self.least + APPETITE / 4);
            if in_use - self.usual <= APPETITE / 2 {
                self.clients.broker().forget_fed();
            }
            let broker = self.clients.broker();
            if is_greedy(in_use - self.usual, broker.fed_bytes(), (broker.filters(), self.clients.count())) {
                return Some("it takes too much memory");
            }
        }
        let now = self.clock.now().since_start;
        let is_worn_out = self.clients.broker().is_exhausted() && self.worn_at.is_none_or(|last| now >= last + WORN_REST);
        if is_worn_out {
            self.worn_at = Some(now);
        }
        is_worn_out.then_some("too many different topics were shown to it")
    }

    /// Ends the router and starts another in its place. Whoever was connected has to come again; what is kept is kept by the gate.
    async fn renew(&mut self, why: &str) {
        let end = self.router.borrow().end();
        end.await;
        self.usual = usize::MAX;
        match Router::start().await {
            Ok(router) => {
                tracing::warn!(why, "the MQTT broker was started anew: its clients have to connect again");
                self.clients.broker().renew();
                self.suspicion.renew();
                self.router.send_replace(Arc::new(router));
            }
            Err(error) => tracing::error!(%error, why, "the MQTT broker is to be started anew, and cannot be"),
        }
        self.rests_until = self.clock.now().since_start + REST;
    }
}

/// Lets clients in, on the thread that hears.
struct Reception {
    clients: Clients,
    access: Access,
    router: Running,
    /// Where all else is done.
    work: Handle,
}

impl Reception {
    /// Lets clients in until there are no routers any more, and then waits until they have left; whoever takes long is cut off.
    async fn receive(self, mut listeners: Listeners, mut web_clients: mpsc::Receiver<IncomingConnection>) {
        let mut clients = JoinSet::new();
        let mut router = self.router.clone();
        let (clock, mut accepts_at) = (Clock::default(), Duration::ZERO);
        loop {
            tokio::select! {
                // In any order: neither a flood of connections nor one of web clients keeps the others out.
                changed = router.changed() => if changed.is_err() { break },
                Some(_) = clients.join_next() => {}
                accepted = accept_at(&mut listeners, clock, accepts_at) => match accepted {
                    Ok((stream, address)) => self.receive_one(&mut clients, incoming(stream, address, &self.access)),
                    Err(error) => {
                        tracing::warn!(%error, relieved = self.clients.relieve(), "an MQTT connection could not be accepted");
                        // Meanwhile those come in who have their connection already.
                        accepts_at = clock.now().since_start + ACCEPT_PAUSE;
                    }
                },
                Some(incoming) = web_clients.recv() => self.receive_one(&mut clients, incoming),
            }
        }
        drop(listeners);
        let ended = async { while clients.join_next().await.is_some() {} };
        if tokio::time::timeout(LAST_WORDS, ended).await.is_err() {
            tracing::debug!(cut = clients.len(), "some MQTT clients were cut off");
        }
    }

    fn receive_one(&self, clients: &mut JoinSet<()>, incoming: IncomingConnection) {
        let waiting = self.clients.let_wait(incoming.origin.from);
        clients.spawn(self.clients.clone().attend(incoming, waiting, (self.router.clone(), self.work.clone())));
    }
}

/// The next connection, but none before then.
async fn accept_at(listeners: &mut Listeners, clock: Clock, then: Duration) -> std::io::Result<(TcpStream, SocketAddr)> {
    clock.reach(Some(then)).await;
    listeners.accept().await
}

fn incoming(stream: TcpStream, address: SocketAddr, access: &Access) -> IncomingConnection {
    if let Err(error) = stream.set_nodelay(true) {
        tracing::debug!(%error, "small packets of a connection will be held back");
    }
    let origin = Origin { from: address.ip(), caller: None, access: access.clone() };
    let (reader, writer) = stream.into_split();
    IncomingConnection { reader: Box::new(reader), writer: Box::new(WriteTimeoutStream::new(writer)), origin }
}

/// Waits until our own session says how the broker is. It says so again while it is ill.
async fn told(health: &mut watch::Receiver<Health>) -> Health {
    if health.changed().await.is_err() {
        return std::future::pending().await;
    }
    *health.borrow_and_update()
}

#[cfg(test)]
#[path = "embedded_tests.rs"]
mod tests;
